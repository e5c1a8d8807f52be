//! The geometric stiffness: what the stress of an equilibrium adds to the stiffness about it.
//!
//! The Green-Lagrange strain has a part that is quadratic in the displacement gradient, on which the stress does work:
//!
//! ```text
//!   E_ij = (u_i,j + u_j,i + u_k,i u_k,j) / 2
//!   K_g,ab = sum_q w detJ (grad N_a . sigma_q grad N_b) I         3x3 block of nodes a, b
//! ```
//!
//! One number for each pair of nodes, as of the mass. Tension stiffens, compression softens.

use super::table::{Table, physical_gradients};
use crate::algebra::dot;
use crate::element::voigt;

impl<const N: usize, const Q: usize> Table<N, Q> {
    /// The numbers `K_g,ab` with the stress (Pa) that `stress` has for the gradients `dN_a/dx` of a point.
    pub(super) fn geometric(&self, x: &[[f64; 3]; N], stress: impl Fn(&[[f64; 3]; N]) -> [f64; 6]) -> [[f64; N]; N] {
        let (mut gradients, mut factors, mut stresses) = ([[[0.0; 3]; N]; Q], [0.0; Q], [[0.0; 6]; Q]);
        for q in 0..Q {
            let (physical, det) = physical_gradients(x, &self.gradients[q]);
            stresses[q] = stress(&physical);
            gradients[q] = physical;
            factors[q] = self.weights[q] * det;
        }
        sum_geometric(&gradients, &factors, &stresses)
    }
}

/// `sum_q f_q grad N_a . sigma_q grad N_b`, exactly symmetric.
pub fn sum_geometric<const N: usize, const Q: usize>(
    gradients: &[[[f64; 3]; N]; Q],
    factors: &[f64; Q],
    stresses: &[[f64; 6]; Q],
) -> [[f64; N]; N] {
    let mut sum = [[0.0; N]; N];
    for q in 0..Q {
        let sigma = voigt::INDEX.map(|row| row.map(|v| factors[q] * stresses[q][v]));
        let tractions = gradients[q].map(|gradient| sigma.map(|row| dot(row, gradient)));
        for a in 0..N {
            for b in a..N {
                sum[a][b] += dot(gradients[q][a], tractions[b]);
            }
        }
    }
    for a in 1..N {
        for b in 0..a {
            sum[a][b] = sum[b][a];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use crate::algebra::{cross, dot};
    use crate::element::ElementKind;
    use crate::element::samples::{Random, curved, triclinic};
    use crate::element::solid::{geometric_stiffness, stiffness};

    type Fill<'a> = &'a dyn Fn(&mut [f64]);

    fn filled(n: usize, fill: Fill) -> DMatrix<f64> {
        let mut k = vec![0.0; 9 * n * n];
        fill(&mut k);
        DMatrix::from_row_slice(3 * n, 3 * n, &k)
    }

    fn vector(u: &[[f64; 3]]) -> DVector<f64> {
        DVector::from_row_slice(u.as_flattened())
    }

    /// `K_g (theta x r) = theta x f` with the internal forces `f = K u`, of any displacements; of C3D8R of a linear
    /// field, as hourglass forces have no stress.
    #[test]
    fn a_rigid_rotation_turns_the_internal_forces() {
        let mut random = Random::seeded(41);
        for kind in ElementKind::ALL {
            let (x, d) = (curved(kind.shape(), &mut random, 0.05), triclinic(&mut random));
            let gradient = [random.vector(), random.vector(), random.vector()];
            let bend = if kind == ElementKind::C3D8R { 0.0 } else { 0.3 };
            let mut displace = |p: [f64; 3]| {
                let noise = random.vector().map(|value| bend * value);
                [0, 1, 2].map(|i| dot(gradient[i], p) + noise[i])
            };
            let u: Vec<[f64; 3]> = x.iter().map(|&p| displace(p)).collect();
            let kg = filled(x.len(), &|k| geometric_stiffness(kind, &x, &d, &u, k));
            let k = filled(x.len(), &|k| stiffness(kind, &x, &d, k));
            assert!((&kg - kg.transpose()).norm() < 1e-13 * kg.norm(), "{kind:?}");
            let theta = [0.3, -0.5, 0.8];
            let turned = kg * vector(&x.iter().map(|&p| cross(theta, p)).collect::<Vec<_>>());
            let forces = k * vector(&u);
            let exact: Vec<[f64; 3]> = forces.as_slice().as_chunks().0.iter().map(|&f| cross(theta, f)).collect();
            assert!((turned - vector(&exact)).norm() < 1e-12 * forces.norm(), "{kind:?}");
        }
    }

    /// Under a uniform stress a displacement of linear gradient H has the energy `V sigma_jk H_ij H_ik / 2`.
    #[test]
    fn a_uniform_stress_does_its_work_on_the_quadratic_strain() {
        let mut random = Random::seeded(42);
        for kind in ElementKind::ALL {
            let (x, d) = (curved(kind.shape(), &mut random, 0.0), triclinic(&mut random));
            let h = [random.vector(), random.vector(), random.vector()];
            let tension: Vec<[f64; 3]> = x.iter().map(|p| [p[0], 0.0, 0.0]).collect();
            let kg = filled(x.len(), &|k| geometric_stiffness(kind, &x, &d, &tension, k));
            let u = vector(&x.iter().map(|&p| h.map(|row| dot(row, p))).collect::<Vec<_>>());
            // The stress of the strain e_x e_x is the first column of D.
            let s = [d[0][0], d[1][0], d[2][0], d[3][0], d[4][0], d[5][0]];
            let sigma = [[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]];
            let density: f64 = h.iter().map(|row| dot(*row, sigma.map(|line| dot(line, *row)))).sum();
            let exact = density * crate::element::solid::volume(kind.shape(), &x);
            let found = u.dot(&(&kg * &u));
            // Reduced rules have not the exact volume of a hexahedron that is no parallelepiped.
            assert!((found - exact).abs() < 2e-2 * exact.abs().max(1e-3 * kg.norm()), "{kind:?}: {found} {exact}");
        }
    }
}
