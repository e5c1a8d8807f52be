//! A spring and damper between the mean rigid motions of two clouds: guide pins, bushings, clips.
//!
//! ```text
//!   q = [u_R, phi]_second - [u_R, phi]_first = G u           6 rows on the dofs of both clouds
//!   K = G^T diag(k_x, k_y, k_z, kappa_x, kappa_y, kappa_z) G,    C likewise
//! ```
//!
//! Both motions are taken at one common reference point. So a rigid motion of both clouds together gives `q = 0` and no
//! force; and since `K` is symmetric, whatever force it gives has neither resultant nor moment. (Two reference points,
//! each in its own cloud, would break both where a spring is transverse to the line between them.)

use super::coupling::{Cloud, CouplingError, MeanMotion, mean_motion};

/// Which cloud of a connector cannot be coupled, and why.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{} cloud of the connector: {source}", if *.cloud == 0 { "first" } else { "second" })]
pub struct ConnectorError {
    /// 0 or 1.
    pub cloud: usize,
    /// What is wrong with it.
    pub source: CouplingError,
}

/// The relative motion `q = G u` of two clouds.
#[derive(Debug, Clone, PartialEq)]
pub struct RelativeMotion {
    /// The six rows of `G`: displacement x, y, z (no unit), rotation x, y, z (1/m). Columns are the dofs of the first
    /// cloud's nodes in order, then of the second's, three a node; a node in both clouds has two sets, to be added.
    pub rows: [Vec<f64>; 6],
}

/// The motion of the second cloud relative to the first, both as rigid bodies seen at `reference` (m).
///
/// # Errors
/// [`ConnectorError`] where a cloud has no mean rigid motion.
///
/// # Panics
/// If nodes and weights of a cloud differ in number.
pub fn relative_motion(clouds: [Cloud; 2], reference: [f64; 3]) -> Result<RelativeMotion, ConnectorError> {
    let motion =
        |cloud: usize| mean_motion(clouds[cloud], reference).map_err(|source| ConnectorError { cloud, source });
    let (first, second) = (motion(0)?, motion(1)?);
    let row = |r: usize| {
        let blocks = |motion: &MeanMotion, sign: f64| -> Vec<f64> {
            let of_nodes = if r < 3 { &motion.displacement } else { &motion.rotation };
            of_nodes.iter().flat_map(|block| block[r % 3]).map(|entry| sign * entry).collect()
        };
        [blocks(&first, -1.0), blocks(&second, 1.0)].concat()
    };
    Ok(RelativeMotion { rows: std::array::from_fn(row) })
}

impl RelativeMotion {
    /// `G^T diag(k) G`, row-major on the columns of [`RelativeMotion::rows`] and exactly symmetric; `k` along x, y, z,
    /// then about them: of stiffness (N/m and N m/rad) the connector's `K`, of damping (N s/m and N m s/rad) its `C`.
    ///
    /// Dense over all nodes of both clouds: meant for the tens of nodes of a pin or bore.
    pub fn weighted_product(&self, k: [f64; 6]) -> Vec<f64> {
        let n = self.rows[0].len();
        let mut matrix = vec![0.0; n * n];
        for (row, k) in self.rows.iter().zip(k) {
            if k == 0.0 {
                continue;
            }
            for (i, line) in matrix.chunks_exact_mut(n).enumerate() {
                for (entry, g) in line.iter_mut().zip(row) {
                    // (k g_i) g_j and (k g_j) g_i round differently: k (g_i g_j) keeps the matrix exactly symmetric
                    *entry += k * (row[i] * g);
                }
            }
        }
        matrix
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{cross, norm};
    use crate::element::samples::{Random, rigid_displacement};
    use nalgebra::{DMatrix, DVector};

    /// Along and about x, y, z.
    const STIFFNESS: [f64; 6] = [1e6, 2e6, 5e5, 3e2, 4e2, 50.0];

    struct Case {
        nodes: [Vec<[f64; 3]>; 2],
        weights: [Vec<f64>; 2],
        reference: [f64; 3],
    }

    impl Case {
        fn random(random: &mut Random) -> Self {
            let mut nodes = |n: usize, z: f64| -> Vec<[f64; 3]> {
                (0..n).map(|_| random.vector()).map(|v| [0.1 * v[0], 0.1 * v[1], z + 0.05 * v[2]]).collect()
            };
            let nodes = [nodes(5, 0.0), nodes(7, 0.3)];
            let weights = [vec![1.0, 2.0, 3.0, 1.0, 2.0], vec![0.5; 7]];
            Case { nodes, weights, reference: random.vector() }
        }

        fn clouds(&self) -> [Cloud<'_>; 2] {
            [0, 1].map(|c| Cloud { nodes: &self.nodes[c], weights: &self.weights[c] })
        }

        fn all_nodes(&self) -> Vec<[f64; 3]> {
            self.nodes.concat()
        }

        fn stiffness(&self) -> DMatrix<f64> {
            let motion = relative_motion(self.clouds(), self.reference).unwrap();
            DMatrix::from_row_slice(36, 36, &motion.weighted_product(STIFFNESS))
        }
    }

    fn rigid(nodes: &[[f64; 3]], shift: [f64; 3], turn: [f64; 3], origin: [f64; 3]) -> DVector<f64> {
        DVector::from_iterator(3 * nodes.len(), nodes.iter().flat_map(|&x| rigid_displacement(shift, turn, origin, x)))
    }

    #[test]
    fn rigid_motion_of_both_clouds_gives_no_force() {
        let mut random = Random::seeded(71);
        let case = Case::random(&mut random);
        let k = case.stiffness();
        let u = rigid(&case.all_nodes(), random.vector(), random.vector(), random.vector());
        assert!((&k * &u).norm() < 1e-12 * k.norm() * u.norm());
    }

    #[test]
    fn any_force_is_balanced_in_resultant_and_moment() {
        let mut random = Random::seeded(72);
        let case = Case::random(&mut random);
        let u = DVector::from_fn(36, |_, _| random.signed());
        let f = case.stiffness() * u;
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for (n, &x) in case.all_nodes().iter().enumerate() {
            let nodal = [f[3 * n], f[3 * n + 1], f[3 * n + 2]];
            let turning = cross(x, nodal);
            for i in 0..3 {
                force[i] += nodal[i];
                moment[i] += turning[i];
            }
        }
        assert!(norm(force) < 1e-12 * f.norm() && norm(moment) < 1e-12 * f.norm());
    }

    #[test]
    fn six_springs_make_a_symmetric_matrix_of_rank_six() {
        let case = Case::random(&mut Random::seeded(73));
        let k = case.stiffness();
        assert_eq!(k, k.transpose());
        let mut eigenvalues: Vec<f64> = k.symmetric_eigenvalues().iter().copied().collect();
        eigenvalues.sort_by(f64::total_cmp);
        let largest = eigenvalues[35];
        assert!(eigenvalues[..30].iter().all(|e| e.abs() < 1e-13 * largest));
        assert!(eigenvalues[30..].iter().all(|e| *e > 1e-6 * largest));
    }

    #[test]
    fn relative_rigid_motion_stores_the_energy_of_each_spring() {
        // Second cloud moves by (shift, turn) at the reference point, first stands: energy = sum k shift^2 + kappa
        // turn^2.
        let mut random = Random::seeded(74);
        let case = Case::random(&mut random);
        let (shift, turn) = (random.vector(), random.vector());
        let mut u = DVector::zeros(36);
        u.rows_mut(15, 21).copy_from(&rigid(&case.nodes[1], shift, turn, case.reference));
        let energy = u.dot(&(case.stiffness() * &u));
        let motion = shift.into_iter().chain(turn);
        let exact: f64 = STIFFNESS.into_iter().zip(motion).map(|(k, q)| k * q * q).sum();
        assert!((energy / exact - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_collinear_cloud_is_named() {
        let case = Case::random(&mut Random::seeded(75));
        let line = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let [first, _] = case.clouds();
        let error = relative_motion([first, Cloud { nodes: &line, weights: &[1.0; 3] }], [0.0; 3]).unwrap_err();
        assert_eq!(error.cloud, 1);
        assert!(error.to_string().starts_with("second cloud"));
    }
}
