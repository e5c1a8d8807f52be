//! Linear elements: stiffness, damping and mass that act on linear functionals of displacements.
//!
//! ```text
//!   q = G u                        r rows on the dofs of the element's nodes
//!   K = G^T diag(k) G,   C = G^T diag(c) G,   M = G^T diag(m) G
//! ```
//!
//! Connectors, ties, rigid sets, equations and point masses are such elements; they differ in their rows alone. A
//! connector has the motion of one cloud relative to another, `q = [u_R, phi]_second - [u_R, phi]_first`, both taken at
//! one common reference point. So a rigid motion of both clouds together gives `q = 0` and no force; and since `K` is
//! symmetric, whatever force it gives has neither resultant nor moment. (Two reference points, each in its own cloud,
//! would break both where a spring is transverse to the line between them.)

/// `G^T diag(w) G`, row-major and exactly symmetric, from the rows of G and a weight for each.
///
/// Dense over all columns: meant for rows of tens of nodes.
///
/// # Panics
/// Where there is no row, or rows differ in length.
pub fn weighted_product(rows: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    let n = rows[0].len();
    let mut matrix = vec![0.0; n * n];
    for (row, &w) in rows.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
        assert_eq!(row.len(), n);
        for (line, &left) in matrix.chunks_exact_mut(n).zip(row).filter(|(_, left)| **left != 0.0) {
            // (w g_i) g_j and (w g_j) g_i round differently: w (g_i g_j) keeps the matrix exactly symmetric
            line.iter_mut().zip(row).for_each(|(entry, right)| *entry += w * (left * right));
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{cross, norm};
    use crate::element::coupling::{Cloud, mean_motion};
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
            let [first, second] = self.clouds().map(|cloud| mean_motion(cloud, self.reference).unwrap().rows());
            let minus = |row: &Vec<f64>| row.iter().map(|entry| -entry).collect::<Vec<_>>();
            let rows: Vec<Vec<f64>> = first.iter().zip(&second).map(|(a, b)| [minus(a), b.clone()].concat()).collect();
            DMatrix::from_row_slice(36, 36, &weighted_product(&rows, &STIFFNESS))
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
}
