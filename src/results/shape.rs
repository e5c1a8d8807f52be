//! Shapes of modes: displacements turned and scaled alike.

use num_complex::Complex64;

use super::Shape;

impl Shape {
    /// Displacements x, y, z of the nodes one after the other, divided by a complex number.
    pub fn over(re: &[f64], im: &[f64], divisor: Complex64) -> Shape {
        let turned: Vec<Complex64> = re.iter().zip(im).map(|(&a, &b)| Complex64::new(a, b) / divisor).collect();
        let of = |part: fn(&Complex64) -> f64| {
            let component = |v: &[Complex64], i: usize| part(&v[i]) as f32;
            turned.chunks_exact(3).map(|v| [0, 1, 2].map(|i| component(v, i))).collect()
        };
        Shape { re: of(|z| z.re), im: of(|z| z.im) }
    }
}

/// Base64 that the shapes of a page may take, bytes: a page of this size opens at once.
const PAGE_BYTES: usize = 10_000_000;
/// Base64 of a node's displacement: six numbers of 16 bits.
const NODE_BYTES: usize = 16;

/// So many shapes of a surface with `n_nodes` fit on a page; one in any case.
pub fn n_on_page(n_nodes: usize) -> usize {
    (PAGE_BYTES / (NODE_BYTES * n_nodes.max(1))).max(1)
}

/// The displacement of largest modulus; 1 where nothing moves.
pub fn largest(re: &[f64], im: &[f64]) -> Complex64 {
    let all = re.iter().zip(im).map(|(&a, &b)| Complex64::new(a, b));
    let most = all.fold(Complex64::ZERO, |most, z| if z.norm_sqr() > most.norm_sqr() { z } else { most });
    if most == Complex64::ZERO { Complex64::ONE } else { most }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_displacement_becomes_one() {
        let (re, im) = ([0.0, 3.0, 0.0, 1.0, 0.0, 0.0], [0.0, 4.0, 0.0, 0.0, 2.5, 0.0]);
        let shape = Shape::over(&re, &im, largest(&re, &im));
        assert_eq!((shape.re[0], shape.im[0]), ([0.0, 1.0, 0.0], [0.0; 3]));
        // (1, 2.5 i, 0) / (3 + 4 i)
        assert_eq!((shape.re[1], shape.im[1]), ([0.12, 0.4, 0.0], [-0.16, 0.3, 0.0]));
        assert_eq!(largest(&[0.0], &[0.0]), Complex64::ONE);
    }

    #[test]
    fn shapes_of_a_page_take_ten_megabytes_or_are_one() {
        assert_eq!([6250, 62_500, 312_500, 1_000_000].map(n_on_page), [100, 10, 2, 1]);
    }
}
