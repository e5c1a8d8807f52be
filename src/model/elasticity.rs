//! Elasticity matrices from engineering constants.
//!
//! Voigt order xx yy zz xy yz zx, engineering shear strains, so that `sigma = C eps` and `C = S^-1`. The laws take any
//! numbers: constants outside their thermodynamic bounds give a matrix that is not positive definite, which one test
//! ([`is_positive_definite`]) finds.

#![allow(non_snake_case)] // symbols of the formulas

use crate::element::voigt;
use nalgebra::{Matrix3, Matrix6, Vector3};

/// Compliance of an orthotropic material in its own axes, 1/Pa.
///
/// `young` along x, y, z; `poisson` and `shear` for xy, yz, zx, where `nu_xy = -eps_y/eps_x` under a stress along x:
///
/// `S_xx = 1/E_x`, `S_xy = -nu_xy/E_x`, `S_yz = -nu_yz/E_y`, `S_zx = -nu_zx/E_z`, and `1/G` on the shears' diagonal.
pub fn orthotropic_compliance(young: [f64; 3], poisson: [f64; 3], shear: [f64; 3]) -> Matrix6<f64> {
    let mut S = Matrix6::zeros();
    for i in 0..3 {
        let j = (i + 1) % 3;
        S[(i, i)] = 1.0 / young[i];
        S[(i, j)] = -poisson[i] / young[i];
        S[(j, i)] = S[(i, j)];
        S[(i + 3, i + 3)] = 1.0 / shear[i];
    }
    S
}

/// Compliance of an isotropic material, 1/Pa: orthotropic with `G = E / (2 (1 + nu))`.
pub fn isotropic_compliance(young: f64, poisson: f64) -> Matrix6<f64> {
    orthotropic_compliance([young; 3], [poisson; 3], [young / (2.0 * (1.0 + poisson)); 3])
}

/// Constants of a material that is isotropic across its z axis.
#[derive(Clone, Copy)]
pub struct Transverse {
    /// Young's modulus across the axis, Pa.
    pub young: f64,
    /// Young's modulus along the axis, Pa.
    pub young_axial: f64,
    /// Poisson's ratio within the plane.
    pub poisson: f64,
    /// Strain across the axis over strain along it, with opposite sign, under a stress along the axis.
    pub poisson_axial: f64,
    /// Shear modulus between axis and plane, Pa.
    pub shear_axial: f64,
}

/// Compliance of a transversely isotropic material about its z axis, 1/Pa.
///
/// Orthotropic with `nu_yz / E = nu_zy / E_z` (symmetry) and `G_xy = E / (2 (1 + nu))` (isotropy within the plane).
pub fn transverse_compliance(constants: &Transverse) -> Matrix6<f64> {
    let c = constants;
    let poisson_yz = c.poisson_axial * c.young / c.young_axial;
    let shear_xy = c.young / (2.0 * (1.0 + c.poisson));
    orthotropic_compliance(
        [c.young, c.young, c.young_axial],
        [c.poisson, poisson_yz, c.poisson_axial],
        [shear_xy, c.shear_axial, c.shear_axial],
    )
}

/// Inverse of a compliance, `C = S^-1`; none where S is not positive definite.
pub fn from_compliance(compliance: &Matrix6<f64>) -> Option<Matrix6<f64>> {
    if !is_positive_definite(compliance) {
        return None;
    }
    compliance.cholesky().map(|factor| symmetric(&factor.inverse()))
}

/// The smallest and the largest of the three Young's moduli, Pa: the inverse diagonal of the compliance.
pub fn youngs(elasticity: &Matrix6<f64>) -> [f64; 2] {
    let compliance = elasticity.try_inverse().unwrap_or_else(Matrix6::zeros);
    let all = [0, 1, 2].map(|i| 1.0 / compliance[(i, i)]);
    [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max)]
}

/// Whether a symmetric matrix is positive definite beyond rounding.
///
/// Cholesky on the matrix scaled to a unit diagonal, `A_ij / sqrt(A_ii A_jj)`, with pivots above 1e-12.
pub fn is_positive_definite(matrix: &Matrix6<f64>) -> bool {
    let diagonal = matrix.diagonal();
    if !diagonal.iter().all(|&d| d > 0.0) {
        return false;
    }
    let scaled = Matrix6::from_fn(|i, j| matrix[(i, j)] / (diagonal[i] * diagonal[j]).sqrt());
    let pivots = scaled.cholesky().map(|factor| factor.l().diagonal());
    pivots.is_some_and(|l| l.iter().all(|&l_ii| l_ii * l_ii > 1e-12))
}

/// Whether no eigenvalue of a symmetric matrix is negative beyond rounding, 1e-12 of the largest.
pub fn is_positive_semidefinite(matrix: &Matrix6<f64>) -> bool {
    let eigenvalues = matrix.symmetric_eigenvalues();
    eigenvalues.min() >= -1e-12 * eigenvalues.max()
}

/// The symmetric part, `(A + A^T) / 2`.
pub fn symmetric(matrix: &Matrix6<f64>) -> Matrix6<f64> {
    (matrix + matrix.transpose()) * 0.5
}

/// Elasticity in global axes of a material whose axes are the columns of `axes`: `C' = T C T^T`.
///
/// T takes stresses, `sigma' = R sigma R^T`; its transpose takes the strains back, as the work is the same in both
/// axes. It is Bond's matrix: Auld, *Acoustic Fields and Waves in Solids* I (1973), section 3.D (there in the order yz
/// zx xy).
pub fn rotate(elasticity: &Matrix6<f64>, axes: &Matrix3<f64>) -> Matrix6<f64> {
    let mut T = Matrix6::zeros();
    for (column, [i, j]) in voigt::PAIRS.into_iter().enumerate() {
        let mut sigma = Matrix3::zeros();
        sigma[(i, j)] = 1.0;
        sigma[(j, i)] = 1.0;
        let turned = axes * sigma * axes.transpose();
        for (row, [k, l]) in voigt::PAIRS.into_iter().enumerate() {
            T[(row, column)] = turned[(k, l)];
        }
    }
    symmetric(&(T * elasticity * T.transpose()))
}

/// Right-handed unit axes (columns) whose z axis is the unit vector `axis`.
pub fn axes_about(axis: [f64; 3]) -> Matrix3<f64> {
    let z = Vector3::from(axis);
    // The global axis farthest from z gives the best-conditioned perpendicular.
    let x = Vector3::ith(z.iamin(), 1.0);
    let y = z.cross(&x).normalize();
    Matrix3::from_columns(&[y.cross(&z), y, z])
}

/// Right-handed unit axes (columns) with x along `x_axis` and y in the plane of both; none where they are parallel.
///
/// Both arguments are unit vectors.
pub fn axes_from(x_axis: [f64; 3], y_axis: [f64; 3]) -> Option<Matrix3<f64>> {
    let x = Vector3::from(x_axis);
    let z = x.cross(&Vector3::from(y_axis));
    if z.norm() < 1e-6 {
        return None;
    }
    let z = z.normalize();
    Some(Matrix3::from_columns(&[x, z.cross(&x), z]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LINING: Transverse =
        Transverse { young: 9e9, young_axial: 1.5e9, poisson: 0.25, poisson_axial: 0.10, shear_axial: 2e9 };

    fn close(a: &Matrix6<f64>, b: &Matrix6<f64>) -> bool {
        (a - b).norm() <= 1e-12 * b.norm()
    }

    #[test]
    fn isotropic_elasticity_is_that_of_lame() {
        let (E, nu) = (210e9, 0.3);
        let C = from_compliance(&isotropic_compliance(E, nu)).unwrap();
        let lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let G = E / (2.0 * (1.0 + nu));
        let lame = Matrix6::from_fn(|i, j| match (i < 3 && j < 3, i == j) {
            (true, true) => lambda + 2.0 * G,
            (true, false) => lambda,
            (false, true) => G,
            (false, false) => 0.0,
        });
        assert!(close(&C, &lame));
    }

    proptest! {
        #[test]
        fn turned_axes_turn_the_tensor_of_fourth_order(
            entries in prop::collection::vec(-1.0..1.0, 36),
            first in prop::array::uniform3(0.1..1.0),
            second in prop::array::uniform3(-1.0..-0.1),
        ) {
            let A = Matrix6::from_column_slice(&entries);
            let C = A * A.transpose() + Matrix6::identity();
            let unit = |v: [f64; 3]| Vector3::from(v).normalize().into();
            prop_assume!(axes_from(unit(first), unit(second)).is_some());
            let R = axes_from(unit(first), unit(second)).unwrap();
            prop_assert!((R.transpose() * R - Matrix3::identity()).norm() < 1e-14 && R.determinant() > 0.0);
            let turned = rotate(&C, &R);
            for (I, [i, j]) in voigt::PAIRS.into_iter().enumerate() {
                for (J, [k, l]) in voigt::PAIRS.into_iter().enumerate() {
                    // C'_ijkl = R_ip R_jq R_kr R_ls C_pqrs
                    let term = |n: usize| {
                        let (p, q, r, s) = (n / 27, n / 9 % 3, n / 3 % 3, n % 3);
                        R[(i, p)] * R[(j, q)] * R[(k, r)] * R[(l, s)] * C[(voigt::INDEX[p][q], voigt::INDEX[r][s])]
                    };
                    prop_assert!((turned[(I, J)] - (0..81).map(term).sum::<f64>()).abs() < 1e-12);
                }
            }
        }

        #[test]
        fn a_matrix_is_positive_definite_where_its_smallest_eigenvalue_is(
            entries in prop::collection::vec(-1.0..1.0, 36),
            shift in -1.0..3.0,
            unit in prop::sample::select(vec![1e-3, 1.0, 1e12]),
        ) {
            let A = Matrix6::from_column_slice(&entries);
            let C = (A * A.transpose() - shift * Matrix6::identity()) * unit;
            prop_assert_eq!(is_positive_definite(&C), C.symmetric_eigenvalues().min() > 0.0);
        }
    }

    #[test]
    fn isotropic_elasticity_does_not_change_when_turned() {
        let C = from_compliance(&isotropic_compliance(210e9, 0.3)).unwrap();
        let axes = axes_about(Vector3::new(1.0, -2.0, 0.5).normalize().into());
        assert!((axes.determinant() - 1.0).abs() < 1e-14);
        assert!(close(&rotate(&C, &axes), &C));
    }

    #[test]
    fn turning_the_axis_from_z_to_x_permutes_a_transverse_material() {
        let C = from_compliance(&transverse_compliance(&LINING)).unwrap();
        let turned = rotate(&C, &axes_about([1.0, 0.0, 0.0]));
        // z -> x, and the plane keeps its own constants: zz -> xx, yz and zx -> xy and zx, xy -> yz.
        let from = [2, 0, 1, 5, 3, 4];
        assert!(close(&turned, &Matrix6::from_fn(|i, j| C[(from[i], from[j])])));
    }

    #[test]
    fn a_pull_along_a_tilted_axis_gives_the_axial_modulus_and_contraction() {
        let axis = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let C = rotate(&from_compliance(&transverse_compliance(&LINING)).unwrap(), &axes_about(axis.into()));
        let stress = axis * axis.transpose();
        let strain = C
            .cholesky()
            .unwrap()
            .solve(&nalgebra::Vector6::from_fn(|v, _| stress[(voigt::PAIRS[v][0], voigt::PAIRS[v][1])]));
        let mut E = Matrix3::zeros();
        for (v, [i, j]) in voigt::PAIRS.into_iter().enumerate() {
            E[(i, j)] = if v < 3 { strain[v] } else { strain[v] / 2.0 };
            E[(j, i)] = E[(i, j)];
        }
        let across = Vector3::new(2.0, 1.0, 2.0) / 3.0;
        let (along, across) = (axis.dot(&(E * axis)), across.dot(&(E * across)));
        assert!((along * LINING.young_axial - 1.0).abs() < 1e-12);
        assert!((across / along + LINING.poisson_axial).abs() < 1e-12);
    }

    #[test]
    fn turned_axes_of_an_orthotropic_material_swap_its_constants() {
        let C = from_compliance(&orthotropic_compliance([150e9, 120e9, 10e9], [0.28, 0.3, 0.02], [45e9, 4e9, 5e9]));
        let C = C.unwrap();
        let axes = axes_from([0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]).unwrap();
        let from = [1, 0, 2, 3, 5, 4];
        assert!(close(&rotate(&C, &axes), &Matrix6::from_fn(|i, j| C[(from[i], from[j])])));
        assert!(axes_from([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]).is_none());
    }

    #[test]
    fn impossible_constants_are_not_positive_definite() {
        assert!(from_compliance(&isotropic_compliance(1e9, 0.5)).is_none());
        assert!(from_compliance(&isotropic_compliance(1e9, 0.49999)).is_some());
        assert!(from_compliance(&isotropic_compliance(f64::NAN, 0.3)).is_none());
        let lining = Transverse { poisson_axial: 0.3, ..LINING };
        assert!(from_compliance(&transverse_compliance(&lining)).is_none());
    }
}
