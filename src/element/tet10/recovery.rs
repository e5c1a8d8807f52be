//! Strain and stress for output.
//!
//! Stress is best at the four points of the stiffness rule and worst at the nodes, so it is evaluated at the points and
//! carried to the nodes by the linear field through the four values:
//!
//! ```text
//!   s_q(l) = (l_q - a)/(b - a)        point q has l_q = b, all other l = a;  sum_q s_q = 1
//!   stress(node) = sum_q s_q(node) stress_q
//! ```

use super::shape::{GRADIENTS_4, NODES, gradients};
use super::stiffness::physical_gradients;
use crate::element::quadrature::TETRAHEDRON_4;

/// Strain (Voigt xx yy zz xy yz zx, engineering shear) at reference coordinates `at` for nodal displacements `u`.
///
/// `strain = sum_a B_a u_a`; `x` and `u` in m.
pub fn strain(x: &[[f64; 3]; 10], u: &[[f64; 3]; 10], at: [f64; 3]) -> [f64; 6] {
    strain_from(x, u, &gradients(at))
}

fn strain_from(x: &[[f64; 3]; 10], u: &[[f64; 3]; 10], reference: &[[f64; 3]; 10]) -> [f64; 6] {
    let (g, _) = physical_gradients(x, reference);
    // h_ij = du_i/dx_j = sum_a u_a,i dN_a/dx_j
    let h = |i: usize, j: usize| (0..10).map(|a| u[a][i] * g[a][j]).sum::<f64>();
    [h(0, 0), h(1, 1), h(2, 2), h(0, 1) + h(1, 0), h(1, 2) + h(2, 1), h(2, 0) + h(0, 2)]
}

/// Stress (Pa, Voigt xx yy zz xy yz zx) at the ten nodes, extrapolated linearly from the points of the stiffness rule.
///
/// `x` and the nodal displacements `u` in m. Exact for a quadratic displacement on straight edges. Neighbouring
/// elements give different values at a shared node: average them for a smooth picture, but not across parts.
pub fn stress_at_nodes(x: &[[f64; 3]; 10], elasticity: &[[f64; 6]; 6], u: &[[f64; 3]; 10]) -> [[f64; 6]; 10] {
    let at_points: [[f64; 6]; 4] = std::array::from_fn(|q| {
        let e = strain_from(x, u, &GRADIENTS_4[q]);
        elasticity.map(|d| (0..6).map(|c| d[c] * e[c]).sum())
    });
    let a = TETRAHEDRON_4[0].at[0];
    let b = 1.0 - 3.0 * a;
    NODES.map(|[l1, l2, l3]| {
        // s_q = (l_q - a)/(b - a)
        let s = [1.0 - l1 - l2 - l3, l1, l2, l3].map(|l| (l - a) / (b - a));
        std::array::from_fn(|r| (0..4).map(|q| s[q] * at_points[q][r]).sum())
    })
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
    use crate::element::samples::{Random, curved_tet, straight_tet, triclinic};

    #[test]
    fn linear_field_has_its_constant_strain_everywhere_in_a_curved_element() {
        let mut random = Random::seeded(31);
        let x = curved_tet(&mut random, 0.08);
        let h = [random.vector(), random.vector(), random.vector()];
        let u = x.map(|p| h.map(|row| dot(row, p)));
        let exact = [h[0][0], h[1][1], h[2][2], h[0][1] + h[1][0], h[1][2] + h[2][1], h[2][0] + h[0][2]];
        for _ in 0..20 {
            let e = strain(&x, &u, random.in_tetrahedron());
            assert!((0..6).all(|r| (e[r] - exact[r]).abs() < 1e-12));
        }
        let d = triclinic(&mut random);
        for stress in stress_at_nodes(&x, &d, &u) {
            for r in 0..6 {
                let expected: f64 = (0..6).map(|c| d[r][c] * exact[c]).sum();
                assert!((stress[r] - expected).abs() < 1e-12 * d[r][r]);
            }
        }
    }

    #[test]
    fn bending_of_a_straight_element_gives_the_exact_linear_stress_at_the_nodes() {
        // Pure bending u = (x y, -x^2/2, 0) with poisson = 0, D = diag(E, E, E, G, G, G): stress xx = E y, all others
        // zero.
        let (young, shear) = (200.0, 100.0);
        let d = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { [young, shear][i / 3] } else { 0.0 }));
        let x = straight_tet(&mut Random::seeded(32));
        let u = x.map(|[px, py, _]| [px * py, -0.5 * px * px, 0.0]);
        let stress = stress_at_nodes(&x, &d, &u);
        for a in 0..10 {
            assert!((stress[a][0] - young * x[a][1]).abs() < 1e-10);
            assert!(stress[a][1..].iter().all(|s| s.abs() < 1e-10));
        }
    }

    #[test]
    fn rigid_motion_has_no_strain() {
        let mut random = Random::seeded(33);
        let x = curved_tet(&mut random, 0.08);
        let turn = random.vector();
        let e = strain(&x, &x.map(|p| cross(turn, p)), [0.3, 0.2, 0.4]);
        assert!(e.iter().all(|v| v.abs() < 1e-13));
    }

    #[test]
    fn von_mises_of_tension_is_the_tension_of_shear_root_three_and_of_pressure_nothing() {
        assert_eq!(von_mises(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 5.0);
        assert!((von_mises(&[0.0, 0.0, 0.0, 0.0, 2.0, 0.0]) - 2.0 * 3.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(von_mises(&[7.0, 7.0, 7.0, 0.0, 0.0, 0.0]), 0.0);
    }
}
