//! Complex vectors of any length.

use num_complex::Complex64;

/// `x^H y`
pub fn product(x: &[Complex64], y: &[Complex64]) -> Complex64 {
    assert_eq!(x.len(), y.len());
    x.iter().zip(y).map(|(x, y)| x.conj() * y).sum()
}

/// `|x|`
pub fn norm(x: &[Complex64]) -> f64 {
    product(x, x).re.sqrt()
}

/// An orthonormal basis of the span of some vectors, by Gram-Schmidt, twice for rounding. A vector of which no more
/// than a fraction `negligible` is left beyond those before it adds nothing.
pub fn orthonormal<'a>(vectors: impl Iterator<Item = &'a Vec<Complex64>>, negligible: f64) -> Vec<Vec<Complex64>> {
    let mut basis: Vec<Vec<Complex64>> = Vec::new();
    for vector in vectors {
        let (mut q, whole) = (vector.clone(), norm(vector));
        for _ in 0..2 {
            for e in &basis {
                let overlap = product(e, &q);
                q.iter_mut().zip(e).for_each(|(q, e)| *q -= overlap * e);
            }
        }
        let rest = norm(&q);
        if rest > negligible * whole {
            basis.push(q.into_iter().map(|z| z / rest).collect());
        }
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_basis_is_orthonormal_and_lacks_what_depends_on_the_others() {
        let c = Complex64::new;
        let vectors = [vec![c(3.0, 0.0), c(0.0, 4.0)], vec![c(0.0, 6.0), c(-8.0, 0.0)], vec![c(1.0, 0.0), c(0.0, 0.0)]];
        let basis = orthonormal(vectors.iter(), 1e-6);
        assert_eq!(basis.len(), 2, "the second is i times twice the first");
        assert!((norm(&basis[0]) - 1.0).abs() < 1e-15 && (norm(&basis[1]) - 1.0).abs() < 1e-15);
        assert!(product(&basis[0], &basis[1]).norm() < 1e-15);
    }
}
