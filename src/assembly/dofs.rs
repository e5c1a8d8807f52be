//! The numbers of the free dofs.

use std::ops::Range;

use crate::mesh::Numbering;

/// The numbers of the three dofs of each node that this rank has: `-1` where a dof is constrained.
///
/// Free dofs are numbered in the order of the nodes' global numbers, so that each rank owns a contiguous range.
#[derive(Debug, Clone)]
pub struct DofMap {
    dofs: Vec<[i32; 3]>,
    /// Numbers of the nodes that do not depend on the number of ranks.
    labels: Vec<u32>,
    owned_nodes: Range<u32>,
    owned: Range<i32>,
    n_global: usize,
}

impl DofMap {
    /// Numbers the free displacements. `constrained[n]` says which displacements of this rank's node n are constrained;
    /// the rank must have every node of the model with a constrained dof. Not collective.
    ///
    /// # Panics
    /// Where there is not one entry a node.
    pub fn new(nodes: &Numbering, constrained: &[[bool; 3]]) -> DofMap {
        assert_eq!(nodes.n_local(), constrained.len());
        let mut n_constrained = 0;
        let mut dofs = Vec::with_capacity(constrained.len());
        for (&global, constrained) in nodes.global().iter().zip(constrained) {
            // All displacements of nodes before this one, and of its axes before this one, less those that are
            // constrained.
            dofs.push([0, 1, 2].map(|i| {
                n_constrained += i32::from(constrained[i]);
                if constrained[i] { -1 } else { 3 * global as i32 + i as i32 - n_constrained }
            }));
        }
        let n_global = 3 * nodes.n_global() - n_constrained as usize;
        let owned = range(&dofs, nodes.owned());
        DofMap { dofs, labels: nodes.labels().to_vec(), owned_nodes: nodes.owned(), owned, n_global }
    }

    /// The numbers of a node's three dofs, -1 where constrained.
    #[inline]
    pub fn node_dofs(&self, node: u32) -> [i32; 3] {
        self.dofs[node as usize]
    }

    /// Whether this rank owns the node.
    #[inline]
    pub fn owns(&self, node: u32) -> bool {
        self.owned_nodes.contains(&node)
    }

    /// A number for each of this rank's dofs that does not depend on the number of ranks: `3 label + axis` with the
    /// node's label ([`Numbering::labels`]).
    pub fn labels(&self) -> Vec<u64> {
        let of = |node: u32| {
            let free = (0..3).filter(move |&i| self.node_dofs(node)[i] >= 0);
            free.map(move |i| 3 * u64::from(self.labels[node as usize]) + i as u64)
        };
        self.owned_nodes().flat_map(of).collect()
    }

    /// The nodes of this rank, in the order of their dofs.
    pub fn owned_nodes(&self) -> Range<u32> {
        self.owned_nodes.clone()
    }

    /// This rank's dofs.
    pub fn owned(&self) -> Range<i32> {
        self.owned.clone()
    }

    /// Number of this rank's dofs.
    pub fn n_local(&self) -> usize {
        self.owned.len()
    }

    /// Number of dofs over all ranks.
    pub fn n_global(&self) -> usize {
        self.n_global
    }

    /// Number of nodes that this rank has.
    pub fn n_nodes(&self) -> usize {
        self.dofs.len()
    }

    /// Appends the dofs of several nodes, three each.
    pub fn indices_into(&self, nodes: &[u32], out: &mut Vec<i32>) {
        out.extend(nodes.iter().flat_map(|&n| self.node_dofs(n)));
    }

    /// Dofs of all nodes that this rank has, in the order of the nodes.
    pub fn all(&self) -> impl Iterator<Item = i32> + '_ {
        self.dofs.as_flattened().iter().copied().filter(|&e| e >= 0)
    }

    /// Nodal displacements (zero where constrained) from the values of [`DofMap::all`].
    pub fn nodal(&self, values: &[f64]) -> Vec<[f64; 3]> {
        let mut values = values.iter();
        let mut next = |e: i32| if e < 0 { 0.0 } else { *values.next().expect("a value for each dof") };
        self.dofs.iter().map(|e| e.map(&mut next)).collect()
    }
}

/// The dofs of a range of nodes.
fn range(dofs: &[[i32; 3]], nodes: Range<u32>) -> Range<i32> {
    let own = dofs[nodes.start as usize..nodes.end as usize].as_flattened();
    let mut free = own.iter().copied().filter(|&e| e >= 0);
    match (free.next(), own.iter().max()) {
        (Some(first), Some(last)) => first..last + 1,
        _ => 0..0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_follow_the_nodes_and_skip_constrained_dofs() {
        let constrained = [[false; 3], [true, false, true], [false; 3]];
        let map = DofMap::new(&Numbering::whole(3, 1..3), &constrained);
        assert_eq!([0, 1, 2].map(|n| map.node_dofs(n)), [[0, 1, 2], [-1, 3, -1], [4, 5, 6]]);
        assert_eq!((map.owned(), map.n_global(), map.owned_nodes()), (3..7, 7, 1..3));
        assert_eq!(map.all().collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5, 6]);
        let values = [9.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(map.nodal(&values), [[9.0, 1.0, 2.0], [0.0, 3.0, 0.0], [4.0, 5.0, 6.0]]);
    }

    #[test]
    fn a_rank_without_free_displacements_has_no_equations() {
        let map = DofMap::new(&Numbering::whole(2, 1..2), &[[false; 3], [true; 3]]);
        assert_eq!((map.owned(), map.n_global()), (0..0, 3));
    }
}
