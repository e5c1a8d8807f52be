//! Strain and stress for output.

use super::table::{Table, physical_gradients};

impl<const N: usize, const Q: usize> Table<N, Q> {
    /// `sum_q w B_q u / sum_q w`, the mean over the points of the rule (Voigt xx yy zz xy yz zx, engineering shear).
    pub(super) fn mean_strain(&self, x: &[[f64; 3]; N], u: &[[f64; 3]; N]) -> [f64; 6] {
        let total: f64 = self.weights.iter().sum();
        let mut mean = [0.0; 6];
        for q in 0..Q {
            let strain = strain(u, &physical_gradients(x, &self.gradients[q]).0);
            (0..6).for_each(|r| mean[r] += self.weights[q] / total * strain[r]);
        }
        mean
    }
}

/// `sum_a B_a u_a` from the gradients `dN_a/dx`.
pub(super) fn strain<const N: usize>(u: &[[f64; 3]; N], g: &[[f64; 3]; N]) -> [f64; 6] {
    // h_ij = du_i/dx_j = sum_a u_a,i dN_a/dx_j
    let h = |i: usize, j: usize| (0..N).map(|a| u[a][i] * g[a][j]).sum::<f64>();
    [h(0, 0), h(1, 1), h(2, 2), h(0, 1) + h(1, 0), h(1, 2) + h(2, 1), h(2, 0) + h(0, 2)]
}

/// `D strain`, Pa.
pub(super) fn stress(elasticity: &[[f64; 6]; 6], strain: &[f64; 6]) -> [f64; 6] {
    elasticity.map(|d| (0..6).map(|c| d[c] * strain[c]).sum())
}

/// Equivalent stress of von Mises, Pa, of a stress in Voigt order xx yy zz xy yz zx.
///
/// `sqrt(((xx-yy)^2 + (yy-zz)^2 + (zz-xx)^2)/2 + 3 (xy^2 + yz^2 + zx^2))`
pub fn von_mises(stress: &[f64; 6]) -> f64 {
    let [xx, yy, zz, xy, yz, zx] = *stress;
    let differences = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * differences + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{cross, dot};
    use crate::element::samples::{Random, curved, distorted, triclinic};
    use crate::element::solid::mean_stress;
    use crate::element::{ElementKind, Shape};

    #[test]
    fn a_linear_field_has_its_constant_stress_in_any_element_and_a_rigid_motion_none() {
        let mut random = Random::seeded(31);
        for kind in ElementKind::ALL {
            let x = curved(kind.shape(), &mut random, 0.05);
            let h = [random.vector(), random.vector(), random.vector()];
            let d = triclinic(&mut random);
            let u: Vec<[f64; 3]> = x.iter().map(|&p| h.map(|row| dot(row, p))).collect();
            let exact = [h[0][0], h[1][1], h[2][2], h[0][1] + h[1][0], h[1][2] + h[2][1], h[2][0] + h[0][2]];
            let stress = mean_stress(kind, &x, &d, &u);
            for r in 0..6 {
                let expected: f64 = (0..6).map(|c| d[r][c] * exact[c]).sum();
                assert!((stress[r] - expected).abs() < 1e-12 * d[r][r], "{kind:?}");
            }
            let turn = random.vector();
            let u: Vec<[f64; 3]> = x.iter().map(|&p| cross(turn, p)).collect();
            assert!(mean_stress(kind, &x, &d, &u).iter().all(|s| s.abs() < 1e-12), "{kind:?}");
        }
    }

    #[test]
    fn bending_of_a_straight_tetrahedron_has_the_stress_at_its_centre() {
        // Pure bending u = (x y, -x^2/2, 0) with poisson = 0: stress xx = E y, all others zero.
        let young = 200.0;
        let d =
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { [young, 0.5 * young][i / 3] } else { 0.0 }));
        let x = distorted(Shape::Tetrahedron10, &mut Random::seeded(32));
        let u: Vec<[f64; 3]> = x.iter().map(|&[px, py, _]| [px * py, -0.5 * px * px, 0.0]).collect();
        let stress = mean_stress(ElementKind::C3D10, &x, &d, &u);
        let height: f64 = x[..4].iter().map(|p| p[1]).sum::<f64>() / 4.0;
        assert!((stress[0] - young * height).abs() < 1e-10 && stress[1..].iter().all(|s| s.abs() < 1e-10));
    }

    #[test]
    fn von_mises_of_tension_is_the_tension_of_shear_root_three_and_of_pressure_nothing() {
        assert_eq!(von_mises(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 5.0);
        assert!((von_mises(&[0.0, 0.0, 0.0, 0.0, 2.0, 0.0]) - 2.0 * 3.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(von_mises(&[7.0, 7.0, 7.0, 0.0, 0.0, 0.0]), 0.0);
    }
}
