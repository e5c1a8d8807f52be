//! Where each node's three displacements stand among the equations.

use std::ops::Range;

use crate::mesh::Numbering;

/// Equation numbers of the nodes that this rank has: `-1` where a displacement is held.
///
/// Equations are numbered in the order of the nodes' global numbers, so that each rank owns a contiguous range.
#[derive(Debug, Clone)]
pub struct DofMap {
    equations: Vec<[i32; 3]>,
    /// Numbers of the nodes that do not depend on the number of ranks.
    labels: Vec<u32>,
    owned_nodes: Range<u32>,
    owned: Range<i32>,
    n_global: usize,
}

impl DofMap {
    /// Numbers the free displacements. `held[n]` says which displacements of this rank's node n are held at zero; the rank must
    /// have every node of the model with a held displacement. Not collective.
    ///
    /// # Panics
    /// Where there is not one entry a node.
    pub fn new(nodes: &Numbering, held: &[[bool; 3]]) -> DofMap {
        assert_eq!(nodes.n_local(), held.len());
        let mut n_held = 0;
        let mut equations = Vec::with_capacity(held.len());
        for (&global, held) in nodes.global().iter().zip(held) {
            // All displacements of nodes before this one, and of its axes before this one, less those that are held.
            equations.push([0, 1, 2].map(|i| {
                n_held += i32::from(held[i]);
                if held[i] { -1 } else { 3 * global as i32 + i as i32 - n_held }
            }));
        }
        let n_global = 3 * nodes.n_global() - n_held as usize;
        let owned = range(&equations, nodes.owned());
        DofMap { equations, labels: nodes.labels().to_vec(), owned_nodes: nodes.owned(), owned, n_global }
    }

    /// Equation numbers of a node's three displacements, -1 where held.
    #[inline]
    pub fn equations(&self, node: u32) -> [i32; 3] {
        self.equations[node as usize]
    }

    /// Whether this rank owns the node.
    #[inline]
    pub fn owns(&self, node: u32) -> bool {
        self.owned_nodes.contains(&node)
    }

    /// A number for each of this rank's equations that does not depend on the number of ranks: `3 label + axis` with the node's
    /// label ([`Numbering::labels`]).
    pub fn labels(&self) -> Vec<u64> {
        let of = |node: u32| {
            let free = (0..3).filter(move |&i| self.equations(node)[i] >= 0);
            free.map(move |i| 3 * u64::from(self.labels[node as usize]) + i as u64)
        };
        self.owned_nodes().flat_map(of).collect()
    }

    /// The nodes of this rank, in the order of their equations.
    pub fn owned_nodes(&self) -> Range<u32> {
        self.owned_nodes.clone()
    }

    /// This rank's equations.
    pub fn owned(&self) -> Range<i32> {
        self.owned.clone()
    }

    /// Number of this rank's equations.
    pub fn n_local(&self) -> usize {
        self.owned.len()
    }

    /// Number of equations over all ranks.
    pub fn n_global(&self) -> usize {
        self.n_global
    }

    /// Number of nodes that this rank has.
    pub fn n_nodes(&self) -> usize {
        self.equations.len()
    }

    /// Appends the equations of several nodes, three each.
    pub fn indices_into(&self, nodes: &[u32], out: &mut Vec<i32>) {
        out.extend(nodes.iter().flat_map(|&n| self.equations(n)));
    }

    /// Equations of all nodes that this rank has, in the order of the nodes.
    pub fn all(&self) -> impl Iterator<Item = i32> + '_ {
        self.equations.as_flattened().iter().copied().filter(|&e| e >= 0)
    }

    /// Nodal displacements (zero where held) from the values of [`DofMap::all`].
    pub fn nodal(&self, values: &[f64]) -> Vec<[f64; 3]> {
        let mut values = values.iter();
        let mut next = |e: i32| if e < 0 { 0.0 } else { *values.next().expect("a value for each equation") };
        self.equations.iter().map(|e| e.map(&mut next)).collect()
    }
}

/// The equations of a range of nodes.
fn range(equations: &[[i32; 3]], nodes: Range<u32>) -> Range<i32> {
    let own = equations[nodes.start as usize..nodes.end as usize].as_flattened();
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
    fn equations_follow_the_nodes_and_skip_held_displacements() {
        let held = [[false; 3], [true, false, true], [false; 3]];
        let map = DofMap::new(&Numbering::whole(3, 1..3), &held);
        assert_eq!([0, 1, 2].map(|n| map.equations(n)), [[0, 1, 2], [-1, 3, -1], [4, 5, 6]]);
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
