//! Elasticity matrices: laws from engineering constants, rotation into global axes, the check that energy is positive.
//!
//! All are 6x6, row-major, in Voigt order xx yy zz xy yz zx with engineering shear strains, Pa. A law with axes of its own
//! is written down as a compliance in those axes,
//!
//! ```text
//!   strain = S stress:   S_ii = 1/E_i,   S_ij = -nu_ij/E_i,   shears 1/G_ij
//!   nu_ij: contraction along j per unit of extension along i, under stress along i alone;  nu_ij/E_i = nu_ji/E_j
//! ```
//!
//! inverted (the normal part is a 3x3, shears are apart), and rotated by [`rotate`]. The laws take any numbers: constants
//! outside their thermodynamic bounds give a matrix that [`check`] refuses, so there is one place that decides.

mod rotation;
mod validity;

pub use rotation::{frame, frame_about, rotate};
pub use validity::{MaterialError, check};

use super::algebra::cofactor_columns;

/// Isotropic elasticity from Young's modulus (Pa) and Poisson's ratio.
///
/// `D_ij = lambda + 2 G delta_ij` for the normal part and `G` for the shears,
/// `lambda = E nu / ((1 + nu)(1 - 2 nu))`, `G = E / (2 (1 + nu))`. Valid for `E > 0`, `-1 < nu < 1/2`.
pub fn isotropic(young: f64, poisson: f64) -> [[f64; 6]; 6] {
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let shear = young / (2.0 * (1.0 + poisson));
    let mut d = [[0.0; 6]; 6];
    for i in 0..3 {
        for j in 0..3 {
            d[i][j] = lambda;
        }
        d[i][i] += 2.0 * shear;
        d[3 + i][3 + i] = shear;
    }
    d
}

/// Constants of a material that is isotropic in the plane normal to an axis, such as a pressed friction lining.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransverselyIsotropic {
    /// Young's modulus in the plane, Pa.
    pub young: f64,
    /// Poisson's ratio within the plane.
    pub poisson: f64,
    /// Young's modulus along the axis, Pa.
    pub young_axial: f64,
    /// Contraction in the plane per unit of axial extension under axial stress, `strain_p = -nu_zp stress_z / E_z`.
    pub poisson_axial: f64,
    /// Shear modulus between the axis and the plane, Pa.
    pub shear_axial: f64,
}

impl TransverselyIsotropic {
    /// The elasticity in global axes, with the material's axis along `axis` (any length but zero).
    ///
    /// In axes with z along the axis: `S_xx = S_yy = 1/E`, `S_xy = -nu/E`, `S_zz = 1/E_z`, `S_xz = S_yz = -nu_zp/E_z`,
    /// shears `2 (1 + nu)/E`, `1/G_z`, `1/G_z`. A zero axis gives entries that are not numbers, which [`check`] refuses.
    pub fn elasticity(&self, axis: [f64; 3]) -> [[f64; 6]; 6] {
        let (plane, axial) = (1.0 / self.young, 1.0 / self.young_axial);
        let (across, along) = (-self.poisson * plane, -self.poisson_axial * axial);
        let normal = [[plane, across, along], [across, plane, along], [along, along, axial]];
        let shear_plane = 0.5 * self.young / (1.0 + self.poisson);
        let local = from_compliance(&normal, [shear_plane, self.shear_axial, self.shear_axial]);
        rotate(&local, &frame_about(axis))
    }
}

/// Constants of a material with three planes of symmetry, in its own axes x, y, z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orthotropic {
    /// Young's moduli along x, y, z, Pa.
    pub young: [f64; 3],
    /// `strain_y = -nu_xy stress_x / E_x` under stress along x.
    pub poisson_xy: f64,
    /// `strain_z = -nu_yz stress_y / E_y` under stress along y.
    pub poisson_yz: f64,
    /// `strain_z = -nu_xz stress_x / E_x` under stress along x.
    pub poisson_xz: f64,
    /// Shear modulus of the xy plane, Pa.
    pub shear_xy: f64,
    /// Shear modulus of the yz plane, Pa.
    pub shear_yz: f64,
    /// Shear modulus of the zx plane, Pa.
    pub shear_zx: f64,
}

impl Orthotropic {
    /// The elasticity in global axes; the rows of `axes` are the material's x, y, z in global coordinates (see [`frame`]).
    pub fn elasticity(&self, axes: &[[f64; 3]; 3]) -> [[f64; 6]; 6] {
        let [sx, sy, sz] = self.young.map(|young| 1.0 / young);
        let (xy, yz, xz) = (-self.poisson_xy * sx, -self.poisson_yz * sy, -self.poisson_xz * sx);
        let normal = [[sx, xy, xz], [xy, sy, yz], [xz, yz, sz]];
        let local = from_compliance(&normal, [self.shear_xy, self.shear_yz, self.shear_zx]);
        rotate(&local, axes)
    }
}

/// The elasticity from its 21 independent entries: the upper triangle row by row, Pa.
///
/// Order: row xx (6 entries, xx..zx), row yy (5), row zz (4), row xy (3), row yz (2), row zx (1). The axes are global;
/// [`rotate`] brings another frame's matrix there.
pub fn full(upper: &[f64; 21]) -> [[f64; 6]; 6] {
    let mut d = [[0.0; 6]; 6];
    let mut entries = upper.iter();
    for i in 0..6 {
        for (j, &entry) in (i..6).zip(&mut entries) {
            d[i][j] = entry;
            d[j][i] = entry;
        }
    }
    d
}

/// Inverse of a compliance whose normal part is `normal` and whose shear moduli (xy, yz, zx) are `shear`.
fn from_compliance(normal: &[[f64; 3]; 3], shear: [f64; 3]) -> [[f64; 6]; 6] {
    // S^-1 = cof(S)^T / det S, and cof S is symmetric with S
    let (cofactors, det) = cofactor_columns(normal);
    let mut d = [[0.0; 6]; 6];
    for i in 0..3 {
        for j in i..3 {
            d[i][j] = cofactors[j][i] / det;
            d[j][i] = d[i][j];
        }
        d[3 + i][3 + i] = shear[i];
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::samples::Random;
    use nalgebra::Matrix6;

    const LINING: TransverselyIsotropic =
        TransverselyIsotropic { young: 8e9, poisson: 0.25, young_axial: 2e9, poisson_axial: 0.08, shear_axial: 1.7e9 };

    fn matrix(d: &[[f64; 6]; 6]) -> Matrix6<f64> {
        Matrix6::from_fn(|i, j| d[i][j])
    }

    fn distance(a: &[[f64; 6]; 6], b: &[[f64; 6]; 6]) -> f64 {
        (matrix(a) - matrix(b)).norm() / matrix(b).norm()
    }

    #[test]
    fn isotropic_tension_extends_by_young_and_contracts_by_poisson() {
        let compliance = matrix(&isotropic(210e9, 0.3)).try_inverse().unwrap();
        assert!((compliance[(0, 0)] * 210e9 - 1.0).abs() < 1e-14);
        assert!((compliance[(1, 0)] / compliance[(0, 0)] + 0.3).abs() < 1e-14);
        assert!((compliance[(3, 3)] * 210e9 / 2.6 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn transversely_isotropic_constants_are_those_of_axial_and_plane_tension_about_any_axis() {
        // Axis y: tension along y contracts x and z by poisson_axial; tension along x contracts z by poisson.
        let compliance = matrix(&LINING.elasticity([0.0, 3.0, 0.0])).try_inverse().unwrap();
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-13, "{a} is not {b}");
        close(compliance[(1, 1)], 1.0 / 2e9);
        close(compliance[(0, 1)] / compliance[(1, 1)], -0.08);
        close(compliance[(2, 1)] / compliance[(1, 1)], -0.08);
        close(compliance[(0, 0)], 1.0 / 8e9);
        close(compliance[(2, 0)] / compliance[(0, 0)], -0.25);
        close(compliance[(3, 3)], 1.0 / 1.7e9);
        close(compliance[(4, 4)], 1.0 / 1.7e9);
        close(compliance[(5, 5)], 2.5 / 8e9);
    }

    #[test]
    fn transversely_isotropic_with_equal_constants_is_isotropic_about_any_axis() {
        let mut random = Random::seeded(41);
        let same = TransverselyIsotropic {
            young: 70e9,
            poisson: 0.33,
            young_axial: 70e9,
            poisson_axial: 0.33,
            shear_axial: 70e9 / 2.66,
        };
        for _ in 0..10 {
            assert!(distance(&same.elasticity(random.vector()), &isotropic(70e9, 0.33)) < 1e-14);
        }
    }

    #[test]
    fn orthotropic_compliance_holds_the_engineering_constants() {
        let law = Orthotropic {
            young: [140e9, 10e9, 9e9],
            poisson_xy: 0.3,
            poisson_yz: 0.4,
            poisson_xz: 0.25,
            shear_xy: 5e9,
            shear_yz: 3e9,
            shear_zx: 4e9,
        };
        let d = law.elasticity(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let s = matrix(&d).try_inverse().unwrap();
        let expected =
            [(0, 0, 1.0 / 140e9), (1, 0, -0.3 / 140e9), (2, 0, -0.25 / 140e9), (2, 1, -0.4 / 10e9), (2, 2, 1.0 / 9e9)];
        for (i, j, value) in expected.into_iter().chain([(3, 3, 0.2e-9), (4, 4, 1.0 / 3e9), (5, 5, 0.25e-9)]) {
            assert!((s[(i, j)] / value - 1.0).abs() < 1e-13, "S[{i}][{j}]");
        }
        check(&d).unwrap();
    }

    #[test]
    fn full_reads_the_upper_triangle_row_by_row() {
        let d = full(&std::array::from_fn(|n| n as f64));
        assert_eq!(d[0], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(d[1], [1.0, 6.0, 7.0, 8.0, 9.0, 10.0]);
        assert_eq!(d[5], [5.0, 10.0, 14.0, 17.0, 19.0, 20.0]);
    }

    #[test]
    fn constants_outside_their_bounds_are_refused() {
        for (young, poisson) in [(-1.0, 0.3), (0.0, 0.3), (1.0, 0.5), (1.0, 0.6), (1.0, -1.0), (f64::NAN, 0.3)] {
            assert!(check(&isotropic(young, poisson)).is_err(), "E = {young}, nu = {poisson}");
        }
        // nu_zp^2 E/E_z (as seen from the plane) beyond (1 - nu)/2
        let wild = TransverselyIsotropic { poisson_axial: 0.5, ..LINING };
        assert!(check(&wild.elasticity([0.0, 0.0, 1.0])).is_err());
        assert!(check(&LINING.elasticity([0.0; 3])).is_err());
    }
}
