//! The retained coordinates `q_b = B u` of a super-element: linear functionals of the displacements, three a retained
//! point.

use crate::assembly::{DofMap, System};
use crate::contact::{GapOperator, Interface};
use crate::native::{Block, Comm};

/// The rows of B as far as this rank's equations go.
pub struct Functionals {
    comm: Comm,
    n_local: usize,
    /// (Equation from this rank's first on, coefficient) by row.
    rows: Vec<Vec<(usize, f64)>>,
}

impl Functionals {
    /// Three rows for each point of the gap operator.
    pub fn new(gap_operator: &GapOperator, system: &System) -> Functionals {
        let rows = (0..gap_operator.len()).flat_map(|a| point_rows(gap_operator, a, &system.dofs)).collect();
        Functionals { comm: system.k.comm().clone(), n_local: system.dofs.n_local(), rows }
    }

    /// Number of functionals.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Number of functionals that are not zero: those of held displacements alone are. Collective.
    pub fn rank(&self) -> usize {
        let mut entries: Vec<f64> = self.rows.iter().map(|row| row.len() as f64).collect();
        self.comm.sum_all(&mut entries);
        entries.iter().filter(|&&n| n > 0.0).count()
    }

    /// Columns of `B^T`. Not collective.
    pub fn transposed(&self, range: std::ops::Range<usize>) -> Block {
        let mut columns = Block::zeros(&self.comm, self.n_local, range.len());
        for (j, row) in self.rows[range].iter().enumerate() {
            let column = columns.column_mut(j);
            row.iter().for_each(|&(i, b)| column[i] += b);
        }
        columns
    }

    /// `B X`, column-major, the same on every rank. Collective.
    pub fn apply(&self, x: &Block) -> Vec<f64> {
        let mut product = Vec::with_capacity(self.len() * x.n_columns());
        for j in 0..x.n_columns() {
            let column = x.column(j);
            product.extend(self.rows.iter().map(|row| row.iter().map(|&(i, b)| b * column[i]).sum::<f64>()));
        }
        self.comm.sum_all(&mut product);
        product
    }

    /// `(I - Psi B) u`, with Psi the first columns of a basis. Collective.
    pub(super) fn hold(&self, basis: &Block, u: &mut Block) {
        let moved = self.apply(u);
        u.axpy(-1.0, &basis.leading_combined(self.len(), &moved, u.n_columns()));
    }
}

/// The three rows of a point.
fn point_rows(gap_operator: &GapOperator, a: usize, dofs: &DofMap) -> [Vec<(usize, f64)>; 3] {
    let owned = dofs.owned();
    let (nodes, blocks) = gap_operator.point(a);
    std::array::from_fn(|i| {
        let entries = nodes.iter().zip(blocks).flat_map(|(&n, block)| dofs.node_dofs(n).into_iter().zip(block[i]));
        let own = entries.filter(|(equation, b)| owned.contains(equation) && *b != 0.0);
        own.map(|(equation, b)| ((equation - owned.start) as usize, b)).collect()
    })
}

/// The retained points: the slave's side of every sliding contact point, then the master's, then the mean motion of
/// each list of loaded nodes. Also the contact points that the first two belong to.
pub fn retained(interface: &Interface, loaded: &[Vec<u32>]) -> (GapOperator, Vec<usize>) {
    let sliding = interface.pairs.iter().filter(|pair| pair.is_sliding());
    let contacts: Vec<usize> = sliding.flat_map(|pair| pair.points.clone()).collect();
    let mut gap_operator = GapOperator::new();
    for &a in &contacts {
        let (nodes, blocks) = interface.gap_operator.point(a);
        let n = interface.points[a].nodes.len();
        gap_operator.push(&nodes[..n], &blocks[..n]);
    }
    for &a in &contacts {
        let (nodes, blocks) = interface.gap_operator.point(a);
        let n = interface.points[a].nodes.len();
        let masters: Vec<_> = blocks[n..].iter().map(|block| block.map(|row| row.map(|b| -b))).collect();
        gap_operator.push(&nodes[n..], &masters);
    }
    for nodes in loaded {
        let share = 1.0 / nodes.len() as f64;
        let block = [[share, 0.0, 0.0], [0.0, share, 0.0], [0.0, 0.0, share]];
        gap_operator.push(nodes, &vec![block; nodes.len()]);
    }
    (gap_operator, contacts)
}
