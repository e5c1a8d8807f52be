//! Which nodes couple, and sums of 3 x 3 blocks on that pattern.

use super::{Connectivity, DofMap};

/// The graph of coupled nodes in CSR form: for each node its neighbours and itself, sorted.
#[derive(Debug, Clone)]
pub struct Pattern {
    offsets: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Pattern {
    /// The graph of everything that couples nodes. Every node couples with itself.
    pub fn new(n_nodes: usize, couplings: &[&dyn Connectivity]) -> Pattern {
        let (starts, members) = invert(n_nodes, couplings);
        let mut pattern = Pattern { offsets: vec![0], neighbours: Vec::new() };
        let mut seen = vec![u32::MAX; n_nodes];
        for node in 0..n_nodes as u32 {
            let first = pattern.neighbours.len();
            seen[node as usize] = node;
            pattern.neighbours.push(node);
            for &(family, e) in &members[starts[node as usize]..starts[node as usize + 1]] {
                for &other in couplings[family as usize].nodes(e as usize) {
                    if seen[other as usize] != node {
                        seen[other as usize] = node;
                        pattern.neighbours.push(other);
                    }
                }
            }
            pattern.neighbours[first..].sort_unstable();
            pattern.offsets.push(pattern.neighbours.len());
        }
        pattern
    }

    /// The nodes that couple with `node`, itself included, sorted.
    pub fn row(&self, node: u32) -> &[u32] {
        &self.neighbours[self.offsets[node as usize]..self.offsets[node as usize + 1]]
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The graph without loops in 32-bit CSR form, for a partitioner.
    pub fn graph(&self) -> (Vec<i32>, Vec<i32>) {
        let mut offsets = vec![0];
        let mut neighbours = Vec::with_capacity(self.neighbours.len());
        for node in 0..self.n_nodes() as u32 {
            neighbours.extend(self.row(node).iter().filter(|&&n| n != node).map(|&n| n as i32));
            offsets.push(neighbours.len() as i32);
        }
        (offsets, neighbours)
    }
}

/// For each node the (family, member) pairs that touch it.
fn invert(n_nodes: usize, couplings: &[&dyn Connectivity]) -> (Vec<usize>, Vec<(u32, u32)>) {
    let mut starts = vec![0_usize; n_nodes + 1];
    for family in couplings {
        for e in 0..family.len() {
            family.nodes(e).iter().for_each(|&n| starts[n as usize + 1] += 1);
        }
    }
    for n in 0..n_nodes {
        starts[n + 1] += starts[n];
    }
    let mut next = starts.clone();
    let mut members = vec![(0, 0); starts[n_nodes]];
    for (f, family) in couplings.iter().enumerate() {
        for e in 0..family.len() {
            for &n in family.nodes(e) {
                members[next[n as usize]] = (f as u32, e as u32);
                next[n as usize] += 1;
            }
        }
    }
    (starts, members)
}

/// Sums of 3 x 3 blocks on the rows of the nodes that this rank owns, for T matrices on one pattern.
pub struct BlockRows<'a, const T: usize> {
    pattern: &'a Pattern,
    /// For each node the position of its first block (only rows of this rank have room).
    first: Vec<usize>,
    blocks: [Vec<[f64; 9]>; T],
}

/// Sparse matrices on one pattern: offsets, global column numbers, and the values of each.
pub struct Csr<const T: usize> {
    /// Where each row starts.
    pub offsets: Vec<i32>,
    /// Global column numbers, sorted within each row.
    pub columns: Vec<i32>,
    /// Values of each matrix.
    pub values: [Vec<f64>; T],
}

impl<'a, const T: usize> BlockRows<'a, T> {
    /// Zeros for the rows of this rank.
    pub fn new(pattern: &'a Pattern, dofs: &DofMap) -> Self {
        let mut first = vec![0; pattern.n_nodes()];
        let mut n_blocks = 0;
        for node in dofs.owned_nodes() {
            first[node as usize] = n_blocks;
            n_blocks += pattern.row(node).len();
        }
        BlockRows { pattern, first, blocks: std::array::from_fn(|_| vec![[0.0; 9]; n_blocks]) }
    }

    /// Adds dense row-major `(3n)^2` matrices; rows of other ranks are skipped.
    ///
    /// # Panics
    /// Where two of the nodes do not couple in the pattern.
    pub fn add(&mut self, dofs: &DofMap, nodes: &[u32], matrices: [&[f64]; T]) {
        let width = 3 * nodes.len();
        for (a, &row) in nodes.iter().enumerate().filter(|&(_, &n)| dofs.owns(n)) {
            let (neighbours, first) = (self.pattern.row(row), self.first[row as usize]);
            for (b, column) in nodes.iter().enumerate() {
                let position = neighbours.binary_search(column).expect("the pattern holds all couplings");
                for (blocks, matrix) in self.blocks.iter_mut().zip(matrices) {
                    let block = &mut blocks[first + position];
                    for i in 0..3 {
                        let from = &matrix[(3 * a + i) * width + 3 * b..][..3];
                        (0..3).for_each(|j| block[3 * i + j] += from[j]);
                    }
                }
            }
        }
    }

    /// Rows and columns of free displacements, with explicit zeros.
    pub fn csr(self, dofs: &DofMap) -> Csr<T> {
        let room = 9 * self.blocks[0].len();
        let mut csr = Csr { offsets: vec![0], columns: Vec::with_capacity(room), values: [const { Vec::new() }; T] };
        csr.values.iter_mut().for_each(|values| values.reserve_exact(room));
        // Equation, block and component of each column of a node's rows.
        let mut order: Vec<(i32, usize, usize)> = Vec::new();
        for node in dofs.owned_nodes() {
            let first = self.first[node as usize];
            order.clear();
            for (position, &other) in self.pattern.row(node).iter().enumerate() {
                let equations = dofs.equations(other).into_iter().enumerate();
                order.extend(equations.filter(|&(_, e)| e >= 0).map(|(j, e)| (e, first + position, j)));
            }
            order.sort_unstable();
            for i in (0..3).filter(|&i| dofs.equations(node)[i] >= 0) {
                csr.columns.extend(order.iter().map(|&(equation, ..)| equation));
                for (values, blocks) in csr.values.iter_mut().zip(&self.blocks) {
                    values.extend(order.iter().map(|&(_, position, j)| blocks[position][3 * i + j]));
                }
                csr.offsets.push(csr.columns.len() as i32);
            }
        }
        csr
    }
}
