//! The distributing coupling: the mean rigid motion of a cloud of nodes, formulation.md section 5.
//!
//! ```text
//!   w^_n = w_n / sum w,   x_bar = sum w^_n x_n,   r_n = x_n - x_bar
//!   T    = sum w^_n ((r_n . r_n) I - r_n r_n^T)              the cloud's inertia, per unit of mass
//!   phi  = T^-1 sum w^_n r_n x u_n                           = sum_n P_n u_n,   P_n = w^_n T^-1 [r_n]x
//!   u_R  = sum w^_n u_n + phi x (x_R - x_bar)                = sum_n U_n u_n,   U_n = w^_n I - [x_R - x_bar]x P_n
//! ```
//!
//! This is the rigid motion that fits the displacements best in the weighted least-squares sense. Transposed, the
//! blocks spread a force `F` and a moment `M` at the reference point over the cloud, `f_n = U_n^T F + P_n^T M`, without
//! stiffening it: the nodal forces have the resultant `F` and the moment `M` about `x_R` exactly.
//!
//! A collinear cloud can turn about its line unseen: `T` is singular, and that is an error, not a small number.

use crate::algebra::{cofactor_columns, dot, product, scale, skew, sub};

/// Nodes with weights, e.g. a surface's points with their contact areas. Both slices have the same length.
#[derive(Debug, Clone, Copy)]
pub struct Cloud<'a> {
    /// Coordinates, m.
    pub nodes: &'a [[f64; 3]],
    /// Weights: none negative, not all zero; only their ratios matter.
    pub weights: &'a [f64],
}

impl Cloud<'_> {
    /// `x_bar = sum w_n x_n / sum w`, m; not finite where there is no weight.
    pub fn centroid(&self) -> [f64; 3] {
        let total: f64 = self.weights.iter().sum();
        [0, 1, 2].map(|i| self.nodes.iter().zip(self.weights).map(|(x, w)| w * x[i]).sum::<f64>() / total)
    }
}

/// Why a cloud has no mean rigid motion.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CouplingError {
    /// There are no nodes, or all weights are zero.
    #[error("the cloud is empty: it has no node with a positive weight")]
    Empty,
    /// A weight is negative or not a finite number.
    #[error("node {node} of the cloud has the weight {weight}; weights are finite and not negative")]
    Weight {
        /// Index within the cloud.
        node: usize,
        /// The weight.
        weight: f64,
    },
    /// The nodes lie on one line or in one point, so their rotation is undetermined.
    #[error(
        "the cloud's nodes lie on a line (thickness squared over length squared is {ratio:.1e}): its rotation is \
         undetermined; couple at least three nodes that span a plane"
    )]
    Collinear {
        /// `det T / (tr T / 2)^3`, about (thickness/length)^2 of a thin cloud.
        ratio: f64,
    },
}

/// Clouds with `det T / (tr T / 2)^3` below this count as collinear: a thickness of 1e-5 lengths.
const COLLINEAR: f64 = 1e-10;

/// Clouds smaller than this many times their distance from the origin count as a point: their shape is round-off.
const POINT: f64 = 1e-12;

/// The mean rigid motion of a cloud as a linear function of its nodes' displacements.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanMotion {
    /// `U_n`, one 3x3 block a node: `u_R = sum_n U_n u_n`, the displacement of the reference point; no unit.
    pub displacement: Vec<[[f64; 3]; 3]>,
    /// `P_n`, one 3x3 block a node: `phi = sum_n P_n u_n`, the rotation, rad; 1/m.
    pub rotation: Vec<[[f64; 3]; 3]>,
}

impl MeanMotion {
    /// The displacement of the reference point (m) and the rotation (rad) for nodal displacements `u` (m).
    ///
    /// # Panics
    /// If `u` has not one entry a node.
    pub fn evaluate(&self, u: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
        assert_eq!(u.len(), self.displacement.len());
        let sum = |blocks: &[[[f64; 3]; 3]]| {
            let mut total = [0.0; 3];
            for (block, &un) in blocks.iter().zip(u) {
                for i in 0..3 {
                    total[i] += dot(block[i], un);
                }
            }
            total
        };
        (sum(&self.displacement), sum(&self.rotation))
    }

    /// The motion as six linear functionals: displacement x, y, z (no unit), then rotation x, y, z (1/m), each a row on
    /// the nodes' dofs, three a node.
    pub fn rows(&self) -> [Vec<f64>; 6] {
        let of = |blocks: &[[[f64; 3]; 3]], i: usize| blocks.iter().flat_map(|block| block[i]).collect();
        std::array::from_fn(|r| of(if r < 3 { &self.displacement } else { &self.rotation }, r % 3))
    }

    /// Nodal forces (N) that carry a force (N) and a moment (N m) at the reference point: `f_n = U_n^T F + P_n^T M`.
    pub fn spread(&self, force: [f64; 3], moment: [f64; 3]) -> Vec<[f64; 3]> {
        let blocks = self.displacement.iter().zip(&self.rotation);
        let share = |u: &[[f64; 3]; 3], p: &[[f64; 3]; 3], i: usize| {
            (0..3).map(|k| u[k][i] * force[k] + p[k][i] * moment[k]).sum()
        };
        blocks.map(|(u, p)| std::array::from_fn(|i| share(u, p, i))).collect()
    }
}

/// The mean rigid motion of a cloud, its displacement taken at the point `reference` (m, anywhere).
///
/// # Errors
/// [`CouplingError`]: no weight, a bad weight, or a cloud on a line. It does not name the cloud; the caller does.
///
/// # Panics
/// If nodes and weights differ in number.
pub fn mean_motion(cloud: Cloud, reference: [f64; 3]) -> Result<MeanMotion, CouplingError> {
    let weights = normalised(cloud)?;
    let centre = cloud.centroid();
    let arms: Vec<[f64; 3]> = cloud.nodes.iter().map(|&x| sub(x, centre)).collect();
    let inverse = inverse_inertia(&arms, &weights, cloud.nodes)?;
    let lever = skew(sub(reference, centre));
    let mut motion = MeanMotion { displacement: Vec::new(), rotation: Vec::new() };
    for (&r, &w) in arms.iter().zip(&weights) {
        // P_n = w^ T^-1 [r]x,   U_n = w^ I - [x_R - x_bar]x P_n
        let p = product(&inverse, &skew(scale(w, r)));
        let turned = product(&lever, &p);
        let entry = |i: usize, j: usize| {
            if i == j { w - turned[i][j] } else { -turned[i][j] }
        };
        motion.displacement.push(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))));
        motion.rotation.push(p);
    }
    Ok(motion)
}

/// `w^_n = w_n / sum w`, checked.
fn normalised(cloud: Cloud) -> Result<Vec<f64>, CouplingError> {
    assert_eq!(cloud.nodes.len(), cloud.weights.len(), "one weight a node");
    let bad = |w: &f64| !w.is_finite() || *w < 0.0;
    if let Some(node) = cloud.weights.iter().position(bad) {
        return Err(CouplingError::Weight { node, weight: cloud.weights[node] });
    }
    let total: f64 = cloud.weights.iter().sum();
    if total > 0.0 { Ok(cloud.weights.iter().map(|w| w / total).collect()) } else { Err(CouplingError::Empty) }
}

/// `T^-1` with `T = sum w^ ((r.r) I - r r^T)`; an error where the cloud is a line or a point.
fn inverse_inertia(arms: &[[f64; 3]], weights: &[f64], nodes: &[[f64; 3]]) -> Result<[[f64; 3]; 3], CouplingError> {
    let mut t = [[0.0; 3]; 3];
    for (&r, w) in arms.iter().zip(weights) {
        for i in 0..3 {
            for j in 0..3 {
                t[i][j] += w * (if i == j { dot(r, r) } else { 0.0 } - r[i] * r[j]);
            }
        }
    }
    let (cofactors, det) = cofactor_columns(&t);
    let half_trace = 0.5 * (t[0][0] + t[1][1] + t[2][2]); // = sum w^ r.r
    let ratio = det / half_trace.powi(3);
    let distance_squared = nodes.iter().map(|&x| dot(x, x)).fold(0.0, f64::max);
    // written so that a NaN (0/0 of a point, or a coordinate) fails
    let spans = ratio > COLLINEAR && half_trace > POINT * POINT * distance_squared;
    if !spans {
        return Err(CouplingError::Collinear { ratio });
    }
    // T^-1 = cof(T)^T / det T, and the rows of cof(T)^T are the cofactor columns
    Ok(cofactors.map(|column| scale(1.0 / det, column)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{cross, norm};
    use crate::element::samples::{Random, rigid_displacement};

    fn random_cloud(random: &mut Random, n: usize) -> (Vec<[f64; 3]>, Vec<f64>) {
        let nodes = (0..n).map(|_| random.vector().map(|v| 0.3 + 0.05 * v)).collect();
        (nodes, (0..n).map(|_| 0.1 + random.unit()).collect())
    }

    #[test]
    fn rigid_motions_are_reproduced_exactly() {
        let mut random = Random::seeded(61);
        for n in [3, 4, 30] {
            let (nodes, weights) = random_cloud(&mut random, n);
            let (reference, shift, turn) = (random.vector(), random.vector(), random.vector());
            let motion = mean_motion(Cloud { nodes: &nodes, weights: &weights }, reference).unwrap();
            let u: Vec<_> = nodes.iter().map(|&x| rigid_displacement(shift, turn, reference, x)).collect();
            let (displacement, rotation) = motion.evaluate(&u);
            assert!(norm(sub(displacement, shift)) < 1e-12, "{n} nodes");
            assert!(norm(sub(rotation, turn)) < 1e-11, "{n} nodes");
        }
    }

    #[test]
    fn transposed_blocks_spread_force_and_moment_exactly() {
        let mut random = Random::seeded(62);
        let (nodes, weights) = random_cloud(&mut random, 17);
        let (reference, force, moment) = (random.vector(), random.vector(), random.vector());
        let motion = mean_motion(Cloud { nodes: &nodes, weights: &weights }, reference).unwrap();
        let (mut resultant, mut about_reference) = ([0.0; 3], [0.0; 3]);
        for (f, &x) in motion.spread(force, moment).iter().zip(&nodes) {
            let turning = cross(sub(x, reference), *f);
            for i in 0..3 {
                resultant[i] += f[i];
                about_reference[i] += turning[i];
            }
        }
        assert!(norm(sub(resultant, force)) < 1e-12);
        assert!(norm(sub(about_reference, moment)) < 1e-12);
    }

    #[test]
    fn motion_is_the_weighted_least_squares_fit() {
        // The residual u_n - rigid(x_n) is orthogonal, in the weights, to every rigid motion.
        let mut random = Random::seeded(63);
        let (nodes, weights) = random_cloud(&mut random, 9);
        let motion = mean_motion(Cloud { nodes: &nodes, weights: &weights }, [0.3; 3]).unwrap();
        let u: Vec<_> = nodes.iter().map(|_| random.vector()).collect();
        let (shift, turn) = motion.evaluate(&u);
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for n in 0..9 {
            let residual = sub(u[n], rigid_displacement(shift, turn, [0.3; 3], nodes[n]));
            let turning = cross(nodes[n], residual);
            for i in 0..3 {
                force[i] += weights[n] * residual[i];
                moment[i] += weights[n] * turning[i];
            }
        }
        assert!(norm(force) < 1e-12 && norm(moment) < 1e-12);
    }

    #[test]
    fn a_force_at_the_centroid_is_shared_by_weight() {
        let nodes = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
        let motion = mean_motion(Cloud { nodes: &nodes, weights: &[2.0; 4] }, [0.0; 3]).unwrap();
        for f in motion.spread([0.0, 0.0, 8.0], [0.0; 3]) {
            assert!(norm(sub(f, [0.0, 0.0, 2.0])) < 1e-15);
        }
    }

    #[test]
    fn clouds_on_a_line_or_in_a_point_are_refused_wherever_they_are() {
        let mut random = Random::seeded(64);
        for _ in 0..50 {
            let (start, along) = (random.vector(), random.vector().map(|v| 1e-3 * v));
            let line: Vec<[f64; 3]> = (0..5).map(|n| std::array::from_fn(|i| start[i] + n as f64 * along[i])).collect();
            for nodes in [&line[..], &line[..2], &line[..1], &[start; 4]] {
                let cloud = Cloud { nodes, weights: &[0.7; 5][..nodes.len()] };
                assert!(matches!(mean_motion(cloud, start), Err(CouplingError::Collinear { .. })));
            }
        }
    }

    #[test]
    fn thin_but_plane_clouds_are_accepted() {
        let nodes = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-3, 0.0]];
        assert!(mean_motion(Cloud { nodes: &nodes, weights: &[1.0; 3] }, [0.0; 3]).is_ok());
    }

    #[test]
    fn missing_and_bad_weights_are_named() {
        let nodes = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let with = |weights: &[f64]| mean_motion(Cloud { nodes: &nodes, weights }, [0.0; 3]);
        assert_eq!(with(&[0.0; 3]), Err(CouplingError::Empty));
        assert_eq!(with(&[1.0, -1.0, 1.0]), Err(CouplingError::Weight { node: 1, weight: -1.0 }));
        assert_eq!(mean_motion(Cloud { nodes: &[], weights: &[] }, [0.0; 3]), Err(CouplingError::Empty));
    }
}
