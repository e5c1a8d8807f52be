//! Matrices that are the same on each axis and couple none, as the mass of tetrahedra: one number for each pair of
//! nodes.

use super::scatter::Places;
use super::{DofMap, Pattern};
use crate::native::Rows;

/// The sum of such matrices over elements.
pub struct AxisSum<'a> {
    pattern: &'a Pattern,
    dofs: &'a DofMap,
    values: Vec<f64>,
}

impl<'a> AxisSum<'a> {
    /// Zeros for all pairs.
    pub fn new(pattern: &'a Pattern, dofs: &'a DofMap) -> AxisSum<'a> {
        AxisSum { pattern, dofs, values: vec![0.0; pattern.neighbours().len()] }
    }

    /// Adds a dense row-major `n^2` matrix of an element; nothing where it is empty.
    pub fn add(&mut self, places: &Places, matrix: &[f64]) {
        if !matrix.is_empty() {
            places.pairs(matrix).for_each(|(pair, value)| self.values[pair as usize] += value);
        }
    }

    /// The rows of this rank: axis by axis of each node the columns of its neighbours' same axis.
    pub fn rows(&self) -> Rows {
        let mut rows = Rows::default();
        let first = self.dofs.owned().start;
        let [mut own, mut other] = [Vec::new(), Vec::new()];
        for (node, i) in self.owned_dofs() {
            own.clear();
            other.clear();
            self.visit(node, i, |is_own, dof, _| match is_own {
                true => own.push(dof - first),
                false => other.push(dof),
            });
            rows.push(&own, &other);
        }
        rows
    }

    /// The values on [`AxisSum::rows`].
    ///
    /// # Panics
    /// Where the arrays have another size.
    pub fn values_into(&self, [own, other]: &mut [&mut [f64]; 2]) {
        let (mut own, mut other) = (own.iter_mut(), other.iter_mut());
        for (node, i) in self.owned_dofs() {
            self.visit(node, i, |is_own, _, value| {
                let next = if is_own { own.next() } else { other.next() };
                *next.expect("room for every value") = value;
            });
        }
        assert!(own.len() == 0 && other.len() == 0, "a value for all the room");
    }

    /// Nodes and axes of this rank's dofs, in their order.
    fn owned_dofs(&self) -> impl Iterator<Item = (u32, usize)> {
        let all = self.dofs.owned_nodes().flat_map(|node| [0, 1, 2].map(|i| (node, i)));
        all.filter(|&(node, i)| self.dofs.node_dofs(node)[i] >= 0)
    }

    /// Visits the entries of a row: whether this rank owns the column, its dof, and the value.
    #[inline]
    fn visit(&self, node: u32, i: usize, mut visit: impl FnMut(bool, i32, f64)) {
        let pairs = self.pattern.pairs(node);
        for (&neighbour, &value) in self.pattern.neighbours()[pairs.clone()].iter().zip(&self.values[pairs]) {
            let dof = self.dofs.node_dofs(neighbour)[i];
            if dof >= 0 {
                visit(self.dofs.owns(neighbour), dof, value);
            }
        }
    }
}
