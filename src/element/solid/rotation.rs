//! The inertia of a solid of revolution seen from the fixed frame: its material flows through the mesh.
//!
//! A particle that is at `x` has the velocity `v + Du/Dt`, with the flow `v = Omega x r` and
//! `Du/Dt = du/dt + u'`, `u' = (v . grad) u`. The kinetic energy `rho |v + du/dt + u'|^2 / 2` gives
//!
//! ```text
//!   h_ab = integral of rho N_a N_b',   s_ab = integral of rho N_a' N_b'          N' = v . grad N
//!   M u.. + (h - h^T) u. + (K - s) u
//! ```
//!
//! each number times the 3 x 3 identity, since u has Cartesian components of the fixed frame. `h - h^T` is skew by
//! construction; on a solid of revolution it is `2h`, as the flow is tangent to its surface. The particle's path is a
//! circle, so that a rigid translation has neither, and `s` of a tilt is the centrifugal couple.

use super::table::{Table, physical_gradients};
use crate::algebra::dot;

/// Row-major `n x n` numbers, the same on each axis.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvectiveInertia {
    /// `h - h^T`, kg/s: skew.
    pub gyroscopic: Vec<f64>,
    /// `s`, kg/s2: symmetric, positive semidefinite. It softens: the stiffness is `K - s`.
    pub softening: Vec<f64>,
}

impl<const N: usize, const P: usize> Table<N, P> {
    /// As [`super::convective_inertia`].
    pub(super) fn convective_inertia(
        &self,
        x: &[[f64; 3]; N],
        density: f64,
        flow: impl Fn([f64; 3]) -> [f64; 3],
    ) -> ConvectiveInertia {
        let (mut gyroscopic, mut softening) = (vec![0.0; N * N], vec![0.0; N * N]);
        for q in 0..P {
            let n = &self.shapes[q];
            let point = [0, 1, 2].map(|i| (0..N).map(|a| n[a] * x[a][i]).sum());
            let velocity = flow(point);
            let (gradients, det) = physical_gradients(x, &self.gradients[q]);
            let along = gradients.map(|gradient| dot(velocity, gradient));
            let mass = density * self.weights[q] * det;
            for a in 0..N {
                for b in 0..N {
                    gyroscopic[N * a + b] += mass * (n[a] * along[b] - along[a] * n[b]);
                    softening[N * a + b] += mass * (along[a] * along[b]);
                }
            }
        }
        ConvectiveInertia { gyroscopic, softening }
    }
}

#[cfg(test)]
mod tests {
    use crate::algebra::{cross, dot};
    use crate::element::samples::{Random, distorted};
    use crate::element::solid::{convective_inertia, mass_properties};
    use crate::element::{ElementKind, Shape};

    /// `sum_ab u_a . a_ab w_b`.
    fn form(a: &[f64], u: &[[f64; 3]], w: &[[f64; 3]]) -> f64 {
        let n = u.len();
        (0..n * n).map(|at| a[at] * dot(u[at / n], w[at % n])).sum()
    }

    #[test]
    fn rigid_motions_have_the_gyroscopic_moment_and_the_centrifugal_couple_of_their_mass() {
        let mut random = Random::seeded(51);
        let shapes: Vec<Shape> = ElementKind::ALL.map(ElementKind::shape).to_vec();
        for shape in shapes {
            let x = distorted(shape, &mut random);
            let (omega, density) = ([0.0, 0.0, 7.0], 3.0);
            let found = convective_inertia(shape, &x, density, |p| cross(omega, p));
            let n = x.len();
            let skew = (0..n * n).map(|at| found.gyroscopic[at] + found.gyroscopic[n * (at % n) + at / n]);
            assert!(skew.into_iter().all(|sum| sum == 0.0), "{shape:?}");
            let shift = vec![[0.4, -0.2, 0.9]; n];
            assert!(
                form(&found.softening, &shift, &shift).abs() < 1e-11
                    && form(&found.gyroscopic, &shift, &shift).abs() < 1e-11
            );
            // Tilts about x and y: u' = theta x v, so that s is rho |theta x v|^2 and h is rho (a x r) . (b x v).
            let tilt = |theta: [f64; 3]| x.iter().map(|&p| cross(theta, p)).collect::<Vec<_>>();
            let (a, b) = (tilt([1.0, 0.0, 0.0]), tilt([0.0, 1.0, 0.0]));
            let s = mass_properties(shape, &x, density).second_moment;
            // e_x x v = (0, -v_z, v_y) = (0, 0, 7 x).
            let couple = 49.0 * s[0][0];
            assert!((form(&found.softening, &a, &a) - couple).abs() < 1e-12 * couple, "{shape:?}");
            // (e_x x r) . (e_y x v) - (e_x x v) . (e_y x r) = (0, -z, y) . (0, 0, 7 y) - (0, 0, 7 x) . (z, 0, -x).
            let moment = 7.0 * (s[0][0] + s[1][1]);
            assert!((form(&found.gyroscopic, &a, &b) - moment).abs() < 1e-12 * moment, "{shape:?}");
        }
    }
}
