//! The gap operator `g = B u`: the relative displacements at the contact points.
//!
//! Row block `a` of B says which nodes the relative motion at contact point `a` depends on, and how:
//!
//! ```text
//! g_a = sum_n B_an u_n        B_an: 3 x 3
//! ```
//!
//! A point of a slave surface has `+N_i I` at the nodes that it moves with and `-N_j I` at the nodes of the master's
//! facet. A reference node that follows a cloud of nodes needs full blocks, a super-element has retained points for
//! nodes: other gap operators, the same contact code.

use super::surface_points::Interpolated;
use crate::algebra::product;

/// The blocks of B, compressed by points.
#[derive(Debug, Clone)]
pub struct GapOperator {
    /// Point `a` owns the entries `offsets[a]..offsets[a + 1]`.
    offsets: Vec<usize>,
    /// The node of each entry.
    nodes: Vec<u32>,
    /// The block of each entry.
    blocks: Vec<[[f64; 3]; 3]>,
}

impl Default for GapOperator {
    fn default() -> Self {
        GapOperator { offsets: vec![0], nodes: Vec::new(), blocks: Vec::new() }
    }
}

impl GapOperator {
    /// A gap operator without points.
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends a point. Blocks of a node that comes more than once are added up, so that nodes are distinct
    /// within a point; the order of first appearance is kept.
    ///
    /// # Panics
    /// Where `nodes` and `blocks` differ in length.
    pub fn push(&mut self, nodes: &[u32], blocks: &[[[f64; 3]; 3]]) {
        assert_eq!(nodes.len(), blocks.len(), "one block a node");
        let first = self.nodes.len();
        for (node, block) in nodes.iter().zip(blocks) {
            match self.nodes[first..].iter().position(|n| n == node) {
                Some(k) => add(&mut self.blocks[first + k], block),
                None => {
                    self.nodes.push(*node);
                    self.blocks.push(*block);
                }
            }
        }
        self.offsets.push(self.nodes.len());
    }

    /// Appends a point of a slave surface: `g = sum_i N_i u_slave_i - sum_j N_j u_master_j`.
    pub fn push_projection(&mut self, slave: &Interpolated, master: &Interpolated) {
        let blocks = slave.shape.iter().map(|&n| diagonal(n)).chain(master.shape.iter().map(|&n| diagonal(-n)));
        self.push(&[&slave.nodes[..], &master.nodes].concat(), &blocks.collect::<Vec<_>>());
    }

    /// Nodes and blocks of point `a`.
    ///
    /// # Panics
    /// Where `a >= len()`, as all methods that take a point.
    pub fn point(&self, a: usize) -> (&[u32], &[[[f64; 3]; 3]]) {
        let range = self.offsets[a]..self.offsets[a + 1];
        (&self.nodes[range.clone()], &self.blocks[range])
    }

    /// Relative displacement `g_a = sum_n B_an u_n`, with `displacement(n)` giving `u_n`.
    pub fn gap(&self, a: usize, displacement: impl Fn(u32) -> [f64; 3]) -> [f64; 3] {
        let mut g = [0.0; 3];
        let (nodes, blocks) = self.point(a);
        for (&n, b) in nodes.iter().zip(blocks) {
            let u = displacement(n);
            for i in 0..3 {
                for j in 0..3 {
                    g[i] += b[i][j] * u[j];
                }
            }
        }
        g
    }

    /// Spreads a force on the point over its nodes, `f_n = B_an^T f`: calls `add(n, f_n)` once for each node.
    pub fn spread(&self, a: usize, force: [f64; 3], mut add: impl FnMut(u32, [f64; 3])) {
        let (nodes, blocks) = self.point(a);
        for (&n, b) in nodes.iter().zip(blocks) {
            add(n, [0, 1, 2].map(|j| (0..3).map(|i| b[i][j] * force[i]).sum()));
        }
    }

    /// Expands a point's 3 x 3 block to its nodes, `out = B_a^T D B_a`.
    ///
    /// `out` becomes row-major, `3n x 3n`, with the dofs x, y, z of the `n` nodes in the order of
    /// [`GapOperator::point`].
    pub fn expand_into(&self, a: usize, d: &[[f64; 3]; 3], out: &mut Vec<f64>) {
        let (_, blocks) = self.point(a);
        let width = 3 * blocks.len();
        out.clear();
        out.resize(width * width, 0.0);
        for (column, right) in blocks.iter().enumerate() {
            let db = product(d, right);
            for (row, left) in blocks.iter().enumerate() {
                for i in 0..3 {
                    for j in 0..3 {
                        // (B_m^T D B_n)_ij = sum_k B_m,ki (D B_n)_kj
                        out[(3 * row + i) * width + 3 * column + j] = (0..3).map(|k| left[k][i] * db[k][j]).sum();
                    }
                }
            }
        }
    }
}

/// `factor I`.
fn diagonal(factor: f64) -> [[f64; 3]; 3] {
    [[factor, 0.0, 0.0], [0.0, factor, 0.0], [0.0, 0.0, factor]]
}

/// `sum += block`.
fn add(sum: &mut [[f64; 3]; 3], block: &[[f64; 3]; 3]) {
    for i in 0..3 {
        for j in 0..3 {
            sum[i][j] += block[i][j];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::dot;
    use proptest::prelude::*;

    type Block = [[f64; 3]; 3];

    fn block() -> impl Strategy<Value = Block> {
        prop::array::uniform3(prop::array::uniform3(-1.0..1.0))
    }

    fn vector() -> impl Strategy<Value = [f64; 3]> {
        prop::array::uniform3(-1.0..1.0)
    }

    #[test]
    fn blocks_of_a_repeated_node_are_added() {
        let mut gap_operator = GapOperator::new();
        gap_operator.push(&[7, 3, 7], &[diagonal(1.0), diagonal(-0.25), diagonal(-0.75)]);
        let (nodes, blocks) = gap_operator.point(0);
        assert_eq!(nodes, [7, 3]);
        assert_eq!(blocks, [diagonal(0.25), diagonal(-0.25)]);
    }

    #[test]
    fn points_keep_to_their_own_entries() {
        let mut gap_operator = GapOperator::new();
        assert!(gap_operator.is_empty());
        gap_operator.push(&[1], &[diagonal(2.0)]);
        gap_operator.push(&[1, 2], &[diagonal(3.0), diagonal(4.0)]);
        assert_eq!(gap_operator.len(), 2);
        assert_eq!(gap_operator.gap(0, |_| [1.0, 0.0, 0.0]), [2.0, 0.0, 0.0]);
        assert_eq!(gap_operator.gap(1, |_| [1.0, 0.0, 0.0]), [7.0, 0.0, 0.0]);
    }

    proptest! {
        #[test]
        fn spreading_is_the_transpose_of_the_gap(
            blocks in prop::collection::vec(block(), 4),
            u in prop::collection::vec(vector(), 4),
            force in vector(),
        ) {
            let mut gap_operator = GapOperator::new();
            gap_operator.push(&[0, 1, 2, 3], &blocks);
            // f.(B u) = (B^T f).u
            let left = dot(force, gap_operator.gap(0, |n| u[n as usize]));
            let mut right = 0.0;
            gap_operator.spread(0, force, |n, f| right += dot(f, u[n as usize]));
            prop_assert!((left - right).abs() < 1e-13);
        }

        #[test]
        fn the_expanded_block_acts_as_gap_then_block_then_spread(
            blocks in prop::collection::vec(block(), 3),
            u in prop::collection::vec(vector(), 3),
            d in block(),
        ) {
            let mut gap_operator = GapOperator::new();
            gap_operator.push(&[0, 1, 2], &blocks);
            let g = gap_operator.gap(0, |n| u[n as usize]);
            let force = [0, 1, 2].map(|i| dot(d[i], g));
            let mut k = Vec::new();
            gap_operator.expand_into(0, &d, &mut k);
            let flat = u.concat();
            gap_operator.spread(0, force, |n, f| {
                for i in 0..3 {
                    let row = 3 * n as usize + i;
                    let ku: f64 = (0..9).map(|c| k[row * 9 + c] * flat[c]).sum();
                    assert!((ku - f[i]).abs() < 1e-13);
                }
            });
        }
    }
}
