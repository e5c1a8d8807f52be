//! Rigid sets.
//!
//! Three base nodes far apart stand for the set, so that no dofs are added:
//!
//! ```text
//!   q_n  = u_n - (u_R + phi x (x_n - x_R))      n not in the base: three rows on four nodes
//!   q_ij = e_ij . (u_j - u_i)                   the base's three distances
//! ```
//!
//! with the motion `u_R, phi` that fits the base best. Rigid motions give `q = 0`. With the largest Young's
//! modulus E and size h of the elements beside the set and the length L of the base the penalties are `1e4 E h` for a
//! node and `1e4 E L` for a distance: the set's own strain is about 1e-4 of that of the elements beside it.

use crate::algebra::{cross, norm, sub};
use crate::element::coupling::{Cloud, mean_motion};
use crate::mesh::Mesh;

use super::JointElement;
use super::neighbours::Neighbours;
use super::rows::Rows;
use crate::model::PENALTY;

/// The nodes of a rigid set.
#[derive(Debug, Clone)]
pub struct RigidNodes {
    /// All of them, by rising number.
    pub nodes: Vec<u32>,
    /// Three of them, far apart.
    pub base: [u32; 3],
}

/// Three nodes far apart: the farthest from the mean of all, the farthest from that, and the farthest from the line
/// between the two. `labels` order equal distances, so that the choice does not depend on the number of ranks.
///
/// # Errors
/// A text where the nodes lie on a line.
pub fn base(nodes: &[u32], x: &[[f64; 3]], labels: &[u32]) -> Result<[u32; 3], String> {
    let mut ordered = nodes.to_vec();
    ordered.sort_by_key(|&n| labels[n as usize]);
    let at = |n: u32| x[n as usize];
    let sum = |i: usize| ordered.iter().map(|&n| at(n)[i]).sum::<f64>();
    let centre = [0, 1, 2].map(|i| sum(i) / ordered.len() as f64);
    let first = farthest(&ordered, |n| norm(sub(at(n), centre)));
    let second = farthest(&ordered, |n| norm(sub(at(n), at(first))));
    let along = sub(at(second), at(first));
    let third = farthest(&ordered, |n| norm(cross(sub(at(n), at(first)), along)));
    let base = [first, second, third];
    let positions = base.map(at);
    match mean_motion(Cloud { nodes: &positions, weights: &[1.0; 3] }, centre) {
        Ok(_) => Ok(base),
        Err(_) => {
            Err("its nodes lie on a line, so that a rotation is undetermined; name nodes that span a plane".into())
        }
    }
}

/// The first node of those with the largest measure.
fn farthest(nodes: &[u32], measure: impl Fn(u32) -> f64) -> u32 {
    let larger = |best: (u32, f64), next: (u32, f64)| if next.1 > best.1 { next } else { best };
    let all = nodes.iter().map(|&n| (n, measure(n)));
    all.reduce(larger).map_or(0, |(n, _)| n)
}

/// The elements of a rigid set: its base, then a node each.
pub fn elements(mesh: &Mesh, set: &RigidNodes, neighbours: &Neighbours) -> Vec<JointElement> {
    let around = neighbours.around(&set.nodes);
    let x = set.base.map(|n| mesh.nodes[n as usize]);
    let sides = [[0, 1], [1, 2], [2, 0]];
    let length = sides.iter().map(|&[i, j]| norm(sub(x[j], x[i]))).fold(0.0, f64::max);
    let mut distances = Rows::new(3);
    for (row, [i, j]) in sides.into_iter().enumerate() {
        let apart = sub(x[j], x[i]);
        let direction = apart.map(|component| component / norm(apart));
        distances.add(row, set.base[j], direction);
        distances.add(row, set.base[i], direction.map(|component| -component));
    }
    let followers = set.nodes.iter().filter(|n| !set.base.contains(n)).map(|&n| {
        let rows = follower(n, mesh.nodes[n as usize], set.base, &x);
        JointElement::springs(rows, vec![PENALTY * around.young * around.size; 3])
    });
    let base = JointElement::springs(distances, vec![PENALTY * around.young * length; 3]);
    std::iter::once(base).chain(followers).collect()
}

/// `u_n - (u_R + phi x (x_n - x_R))`
fn follower(node: u32, at: [f64; 3], base: [u32; 3], x: &[[f64; 3]; 3]) -> Rows {
    let mut rows = Rows::new(3);
    rows.add_block(0, node, 1.0, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let motion = mean_motion(Cloud { nodes: x, weights: &[1.0; 3] }, at).expect("a base spans a plane");
    base.iter().zip(&motion.displacement).for_each(|(&n, block)| rows.add_block(0, n, -1.0, block));
    rows
}
