//! How much the modes of two results are alike in shape.

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::algebra::complex::{orthonormal, product};

/// Modes are one group where their eigenvalues are closer than this, relative.
const ONE_EIGENVALUE: f64 = 1e-3;
/// A direction of which so little is left beyond the others of its group adds nothing.
const NEGLIGIBLE: f64 = 1e-6;

/// The modal assurance criterion of every mode of A with every mode of B.
///
/// Modes of nearly one eigenvalue are a group, whose shapes may be any basis of the space that they span. Mode j of B
/// is compared with the group of mode i of A, and mode i with the group of j; the larger value counts, so that it does
/// not matter which of both results has split the doublet:
///
/// ```text
/// mac_ij = max(|P_I y_j|^2 / |y_j|^2, |P_J x_i|^2 / |x_i|^2)        P: orthogonal projection on the span of a group
/// ```
///
/// For groups of one that is `|x^H y|^2 / ((x^H x) (y^H y))`.
pub struct MacTable {
    table: DMatrix<f64>,
}

impl MacTable {
    /// Compares all modes of A and B, given by eigenvalues and shapes at the same places.
    ///
    /// # Panics
    /// Where a result has not as many eigenvalues as shapes, or shapes have not the same length.
    pub fn new([lambdas_a, lambdas_b]: [&[Complex64]; 2], [a, b]: [&[Vec<Complex64>]; 2]) -> MacTable {
        assert_eq!((lambdas_a.len(), lambdas_b.len()), (a.len(), b.len()));
        let mut table = DMatrix::zeros(a.len(), b.len());
        for group in groups_of_near(lambdas_a, ONE_EIGENVALUE) {
            let basis = orthonormal(group.iter().map(|&i| &a[i]), NEGLIGIBLE);
            for (j, y) in b.iter().enumerate() {
                let share = share(&basis, y);
                group.iter().for_each(|&i| table[(i, j)] = share);
            }
        }
        for group in groups_of_near(lambdas_b, ONE_EIGENVALUE) {
            let basis = orthonormal(group.iter().map(|&j| &b[j]), NEGLIGIBLE);
            for (i, x) in a.iter().enumerate() {
                let share = share(&basis, x);
                group.iter().for_each(|&j| table[(i, j)] = share.max(table[(i, j)]));
            }
        }
        MacTable { table }
    }

    /// Of mode i of A and mode j of B: between 0 and 1.
    pub fn mac(&self, i: usize, j: usize) -> f64 {
        self.table[(i, j)]
    }
}

/// The distance of two eigenvalues relative to the larger one.
pub fn distance(a: Complex64, b: Complex64) -> f64 {
    (a - b).norm() / a.norm().max(b.norm()).max(f64::MIN_POSITIVE)
}

/// The modes of nearly one eigenvalue, relative to the larger one; each mode is in one group. Neighbours are linked.
pub fn groups_of_near(lambdas: &[Complex64], tolerance: f64) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in 0..lambdas.len() {
        let is_linked = |group: &Vec<usize>| group.iter().any(|&k| distance(lambdas[i], lambdas[k]) <= tolerance);
        let (linked, mut others): (Vec<_>, Vec<_>) = groups.into_iter().partition(is_linked);
        others.push(linked.into_iter().flatten().chain([i]).collect());
        groups = others;
    }
    groups
}

/// The modal assurance criterion of a shape with the span of others, `|P y|^2 / |y|^2`, P the orthogonal projection on
/// it.
pub fn mac_with_span<'a>(y: &[Complex64], span: impl Iterator<Item = &'a Vec<Complex64>>) -> f64 {
    share(&orthonormal(span, NEGLIGIBLE), y)
}

/// `|P y|^2 / |y|^2` with P the projection on an orthonormal basis.
fn share(basis: &[Vec<Complex64>], y: &[Complex64]) -> f64 {
    let inside: f64 = basis.iter().map(|e| product(e, y).norm_sqr()).sum();
    inside / product(y, y).re.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::complex::norm;
    use proptest::prelude::*;

    fn c(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    fn alone(x: &[Complex64], y: &[Complex64]) -> f64 {
        let lambda = [c(0.0, 1.0)];
        MacTable::new([&lambda, &lambda], [&[x.to_vec()], &[y.to_vec()]]).mac(0, 0)
    }

    fn vector() -> impl Strategy<Value = Vec<Complex64>> {
        prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64).prop_map(|(re, im)| c(re, im)), 6)
            .prop_filter("a shape is not zero", |x| norm(x) > 0.1)
    }

    proptest! {
        #[test]
        fn a_shape_is_itself_whatever_its_scale(x in vector(), re in -9.0..9.0_f64, im in 0.1..9.0_f64) {
            prop_assert!((alone(&x, &x) - 1.0).abs() < 1e-14);
            let scaled: Vec<Complex64> = x.iter().map(|z| z * c(re, im)).collect();
            prop_assert!((alone(&x, &scaled) - 1.0).abs() < 1e-13);
        }

        #[test]
        fn it_is_the_textbook_formula_and_symmetric(x in vector(), y in vector()) {
            let mac = product(&x, &y).norm_sqr() / (product(&x, &x).re * product(&y, &y).re);
            prop_assert!((alone(&x, &y) - mac).abs() < 1e-14 && (alone(&y, &x) - mac).abs() < 1e-14);
        }

        /// A doublet turned by any angle and phase is the same doublet.
        #[test]
        fn a_doublet_is_a_subspace(x in vector(), y in vector(), angle in 0.0..6.3_f64, phase in 0.0..6.3_f64) {
            prop_assume!(alone(&x, &y) < 0.99);
            let (sin, cos) = angle.sin_cos();
            let turned = |s: f64, t: f64| -> Vec<Complex64> {
                x.iter().zip(&y).map(|(x, y)| x * s + y * t * Complex64::cis(phase)).collect()
            };
            let lambdas = [c(0.0, 1.0), c(0.0, 1.0004)];
            let split = [c(0.0, 1.0), c(0.0, 1.004)];
            let (own, other) = ([x.clone(), y.clone()], [turned(cos, sin), turned(-sin, cos)]);
            for others in [lambdas, split] {
                let mac_table = MacTable::new([&lambdas, &others], [&own, &other]);
                let all = (0..4).map(|k| mac_table.mac(k / 2, k % 2));
                prop_assert!(all.into_iter().all(|mac| (mac - 1.0).abs() < 1e-9));
            }
        }
    }

    #[test]
    fn orthogonal_shapes_have_nothing_in_common() {
        assert_eq!(alone(&[c(1.0, 0.0), c(0.0, 1.0)], &[c(1.0, 0.0), c(0.0, -1.0)]), 0.0);
        assert!((alone(&[c(1.0, 0.0), c(0.0, 0.0)], &[c(1.0, 0.0), c(1.0, 0.0)]) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn a_growing_and_a_decaying_mode_of_one_frequency_are_two() {
        let lambdas = [c(-0.1, 5.0), c(0.1, 5.0), c(0.0, 5.4)];
        assert_eq!(groups_of_near(&lambdas, ONE_EIGENVALUE), [[0], [1], [2]]);
        assert_eq!(
            groups_of_near(&[c(0.0, 1.0), c(0.0, 2.0), c(0.0, 1.0005), c(0.0, 1.001)], ONE_EIGENVALUE),
            [vec![1], vec![0, 2, 3]]
        );
    }

    #[test]
    fn a_shape_is_like_itself_and_like_its_plane() {
        let shapes = [[1.0, 0.0, -1.0, 0.0], [0.0, 2.0, 0.0, -2.0]].map(|shape| shape.map(|u| c(u, 0.0)).to_vec());
        let mac = |y: [f64; 4], span: &[Vec<Complex64>]| mac_with_span(&y.map(|u| c(u, 0.0)), span.iter());
        let both = [3.0, 3.0, -3.0, -3.0];
        assert!((mac(both, &shapes[..1]) - 0.5).abs() < 1e-15 && (mac(both, &shapes) - 1.0).abs() < 1e-15);
        assert!((mac([-5.0, 0.0, 5.0, 0.0], &shapes[..1]) - 1.0).abs() < 1e-15);
        assert!(mac([1.0; 4], &shapes) < 1e-15);
        let twice = [shapes[0].clone(), shapes[0].clone()];
        assert!((mac(both, &twice) - 0.5).abs() < 1e-15, "a direction counts once");
    }
}
