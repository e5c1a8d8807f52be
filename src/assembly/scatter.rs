//! From element matrices straight into the values of a sparse matrix.
//!
//! All rows of a node have the same columns, those of its neighbours' free displacements. So an entry stands at
//!
//! ```text
//! start of the row + first column of the neighbour + place of the axis among its free ones
//! ```
//!
//! in one of two arrays: PETSc keeps the columns of this rank and those of other ranks apart. What an element needs of
//! this is found once ([`Places::find`]) for all its matrices.

use super::{DofMap, Pattern};
use crate::native::Rows;

/// Where the entries of each pair of nodes stand in the rows of a matrix.
pub struct Scatter<'a> {
    pattern: &'a Pattern,
    dofs: &'a DofMap,
    /// For each pair the columns before it in its part of the row.
    columns: Vec<u32>,
    /// Where the rows start in the values of this rank's columns and in those of other ranks'.
    starts: [Vec<usize>; 2],
}

impl<'a> Scatter<'a> {
    /// Lays out the rows of this rank for matrices that couple all displacements of neighbours. Not collective.
    pub fn new(pattern: &'a Pattern, dofs: &'a DofMap) -> (Scatter<'a>, Rows) {
        let first = dofs.owned().start;
        let mut rows = Rows::default();
        let mut columns = Vec::with_capacity(pattern.neighbours().len());
        let (mut own, mut other) = (Vec::new(), Vec::new());
        for node in dofs.owned_nodes() {
            own.clear();
            other.clear();
            for &neighbour in &pattern.neighbours()[pattern.pairs(node)] {
                let (part, shift) = if dofs.owns(neighbour) { (&mut own, first) } else { (&mut other, 0) };
                columns.push(part.len() as u32);
                part.extend(dofs.node_dofs(neighbour).into_iter().filter(|&e| e >= 0).map(|e| e - shift));
            }
            for _ in dofs.node_dofs(node).iter().filter(|&&e| e >= 0) {
                rows.push(&own, &other);
            }
        }
        let starts = [&rows.own, &rows.other].map(|part| part.offsets.iter().map(|&start| start as usize).collect());
        (Scatter { pattern, dofs, columns, starts }, rows)
    }

    /// Whether this rank owns the node.
    pub fn owns(&self, node: u32) -> bool {
        self.dofs.owns(node)
    }
}

/// Where an element's entries stand.
#[derive(Default)]
pub struct Places {
    nodes: Vec<Neighbour>,
    rows: Vec<Row>,
    /// The element's nodes that this rank owns, by their numbers in the element.
    own: Vec<usize>,
    /// For each of these and each node of the element the pair, and the columns before it.
    pairs: Vec<u32>,
    columns: Vec<u32>,
    /// Whether this rank owns all nodes and none is constrained: by far most elements.
    is_plain: bool,
}

/// A node of an element as neighbour of the others.
struct Neighbour {
    dofs: [i32; 3],
    is_own: bool,
}

/// A row of an element's matrix that this rank owns.
struct Row {
    /// Its number in the element's matrix.
    number: usize,
    /// Where the columns of its node start in [`Places::columns`].
    first: usize,
    /// Where it starts in the two arrays of values.
    starts: [usize; 2],
}

impl Places {
    /// Finds the places of an element's nodes.
    ///
    /// # Panics
    /// Where two of the nodes do not couple in the pattern.
    pub fn find(&mut self, scatter: &Scatter, nodes: &[u32]) {
        let Scatter { pattern, dofs, columns, starts } = scatter;
        self.clear();
        self.nodes.extend(nodes.iter().map(|&n| Neighbour { dofs: dofs.node_dofs(n), is_own: dofs.owns(n) }));
        self.is_plain = self.nodes.iter().all(|node| node.is_own && node.dofs.iter().all(|&e| e >= 0));
        for (a, &node) in nodes.iter().enumerate().filter(|&(_, &n)| dofs.owns(n)) {
            let first = self.columns.len();
            let pairs = pattern.pairs(node);
            let neighbours = &pattern.neighbours()[pairs.clone()];
            for other in nodes {
                let pair = pairs.start + neighbours.binary_search(other).expect("the pattern holds all couplings");
                self.pairs.push(pair as u32);
                self.columns.push(columns[pair]);
            }
            self.own.push(a);
            for (i, dof) in dofs.node_dofs(node).into_iter().enumerate().filter(|&(_, e)| e >= 0) {
                let row = (dof - dofs.owned().start) as usize;
                self.rows.push(Row { number: 3 * a + i, first, starts: starts.each_ref().map(|s| s[row]) });
            }
        }
    }

    fn clear(&mut self) {
        self.nodes.clear();
        self.rows.clear();
        self.own.clear();
        self.pairs.clear();
        self.columns.clear();
    }

    /// Adds a dense row-major `(3n)^2` matrix of the element to the two arrays of values of a matrix; nothing where it
    /// is empty. Rows and columns of constrained dofs are left out, and rows of other ranks.
    ///
    /// # Panics
    /// Where sizes do not fit.
    pub fn add(&self, matrix: &[f64], [own, other]: &mut [&mut [f64]; 2]) {
        if matrix.is_empty() {
            return;
        }
        let n = self.nodes.len();
        assert_eq!(matrix.len(), 9 * n * n);
        for row in &self.rows {
            let line = matrix[3 * n * row.number..][..3 * n].chunks_exact(3);
            let columns = &self.columns[row.first..][..n];
            if self.is_plain {
                let values = &mut own[row.starts[0]..];
                line.zip(columns).for_each(|(entries, &column)| add_three(&mut values[column as usize..], entries));
                continue;
            }
            for (entries, (&column, node)) in line.zip(columns.iter().zip(&self.nodes)) {
                let (values, start) =
                    if node.is_own { (&mut **own, row.starts[0]) } else { (&mut **other, row.starts[1]) };
                let values = &mut values[start + column as usize..];
                let free = entries.iter().zip(node.dofs).filter(|(_, e)| *e >= 0);
                values.iter_mut().zip(free).for_each(|(value, (entry, _))| *value += entry);
            }
        }
    }

    /// The rows of a dense `n^2` matrix of the element that this rank owns: the places of their pairs in the pattern,
    /// and the entries.
    pub fn pairs<'a>(&'a self, matrix: &'a [f64]) -> impl Iterator<Item = (u32, f64)> + 'a {
        let n = self.nodes.len();
        let lines = self.own.iter().flat_map(move |a| &matrix[a * n..][..n]);
        self.pairs.iter().copied().zip(lines.copied())
    }
}

/// `values += entries` of a free node.
#[inline]
fn add_three(values: &mut [f64], entries: &[f64]) {
    let (values, entries) = (values.first_chunk_mut::<3>(), entries.first_chunk::<3>());
    let (values, entries) = (values.expect("three free displacements"), entries.expect("three axes"));
    (0..3).for_each(|j| values[j] += entries[j]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::axes::AxisSum;
    use crate::mesh::Numbering;

    const TRIANGLES: [[u32; 3]; 2] = [[4, 0, 1], [1, 3, 4]];
    const CONSTRAINED: [[bool; 3]; 5] = [[false; 3], [true, false, true], [false; 3], [false, true, false], [false; 3]];

    /// A dense matrix, no two entries alike.
    fn element(e: usize, n: usize) -> Vec<f64> {
        (0..n * n).map(|at| (1 + at + 1000 * e) as f64).collect()
    }

    /// The rows as a dense matrix of `n` columns.
    fn dense(rows: &Rows, [own, other]: [&[f64]; 2], first: i32, n: usize) -> Vec<Vec<f64>> {
        let mut dense = vec![vec![0.0; n]; rows.own.offsets.len() - 1];
        for (part, values, shift) in [(&rows.own, own, first), (&rows.other, other, 0)] {
            for (row, ends) in dense.iter_mut().zip(part.offsets.windows(2)) {
                let range = ends[0] as usize..ends[1] as usize;
                assert!(part.columns[range.clone()].is_sorted());
                range.for_each(|at| row[(part.columns[at] + shift) as usize] = values[at]);
            }
        }
        dense
    }

    /// What both sums must give: entry by entry, without a pattern.
    fn expected(dofs: &DofMap, entry: impl Fn(usize, [usize; 2], [usize; 2]) -> f64) -> Vec<Vec<f64>> {
        let mut sum = vec![vec![0.0; dofs.n_global()]; dofs.n_local()];
        for (e, nodes) in TRIANGLES.iter().enumerate() {
            for at in 0..81 {
                let [(a, i), (b, j)] = [at / 9, at % 9].map(|dof| (dof / 3, dof % 3));
                let [row, column] = [dofs.node_dofs(nodes[a])[i], dofs.node_dofs(nodes[b])[j]];
                if dofs.owned().contains(&row) && column >= 0 {
                    sum[(row - dofs.owned().start) as usize][column as usize] += entry(e, [a, i], [b, j]);
                }
            }
        }
        sum
    }

    #[test]
    fn sums_are_those_of_every_entry_by_itself() {
        for owned in [0..5, 0..2, 2..4, 3..5, 2..2] {
            let numbering = Numbering::whole(5, owned);
            let (pattern, dofs) = (Pattern::new(&numbering, &[&TRIANGLES]), DofMap::new(&numbering, &CONSTRAINED));
            let (scatter, rows) = Scatter::new(&pattern, &dofs);
            let mut mass = AxisSum::new(&pattern, &dofs);
            let mut places = Places::default();
            let [mut own, mut other] = [&rows.own, &rows.other].map(|part| vec![0.0; part.columns.len()]);
            for (e, nodes) in TRIANGLES.iter().enumerate() {
                places.find(&scatter, nodes);
                places.add(&element(e, 9), &mut [&mut own, &mut other]);
                mass.add(&places, &element(e, 3));
            }
            let n = dofs.n_global();
            let k = expected(&dofs, |e, [a, i], [b, j]| element(e, 9)[9 * (3 * a + i) + 3 * b + j]);
            assert_eq!(dense(&rows, [&own, &other], dofs.owned().start, n), k);
            let rows = mass.rows();
            let [mut own, mut other] = [&rows.own, &rows.other].map(|part| vec![0.0; part.columns.len()]);
            mass.values_into(&mut [&mut own, &mut other]);
            let m = expected(&dofs, |e, [a, i], [b, j]| if i == j { element(e, 3)[3 * a + b] } else { 0.0 });
            assert_eq!(dense(&rows, [&own, &other], dofs.owned().start, n), m);
        }
    }
}
