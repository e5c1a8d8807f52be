//! Where each node's three displacements stand among the equations.

use std::ops::Range;

/// Equation numbers by node: `-1` where a displacement is held. Each rank owns a contiguous range of equations.
#[derive(Debug, Clone)]
pub struct DofMap {
    equations: Vec<[i32; 3]>,
    owner: Vec<u32>,
    owned: Range<i32>,
    n_global: usize,
    rank: u32,
}

impl DofMap {
    /// Numbers the free displacements rank by rank, within a rank in the order of the nodes.
    ///
    /// `owner[n]` is the rank of node n, `held[n]` which of its displacements are held at zero.
    ///
    /// # Panics
    /// Where the two lists differ in length.
    pub fn new(owner: Vec<u32>, held: &[[bool; 3]], rank: usize, size: usize) -> DofMap {
        assert_eq!(owner.len(), held.len());
        let mut count = vec![0_i32; size + 1];
        for (&rank, held) in owner.iter().zip(held) {
            count[rank as usize + 1] += held.iter().filter(|&&h| !h).count() as i32;
        }
        for r in 0..size {
            count[r + 1] += count[r];
        }
        let owned = count[rank]..count[rank + 1];
        let n_global = count[size] as usize;
        let mut next = count;
        let number = |(&rank, held): (&u32, &[bool; 3])| {
            held.map(|h| {
                if h {
                    return -1;
                }
                let equation = next[rank as usize];
                next[rank as usize] += 1;
                equation
            })
        };
        let equations = owner.iter().zip(held).map(number).collect();
        DofMap { equations, owner, owned, n_global, rank: rank as u32 }
    }

    /// Equation numbers of a node's three displacements, -1 where held.
    pub fn equations(&self, node: u32) -> [i32; 3] {
        self.equations[node as usize]
    }

    /// Whether this rank owns the node.
    pub fn owns(&self, node: u32) -> bool {
        self.owner[node as usize] == self.rank
    }

    /// A number for each of this rank's equations that does not depend on the number of ranks: `3 node + axis`.
    pub fn labels(&self) -> Vec<u64> {
        let of = |node: u32| {
            let free = (0..3).filter(move |&i| self.equations(node)[i] >= 0);
            free.map(move |i| 3 * u64::from(node) + i as u64)
        };
        self.owned_nodes().flat_map(of).collect()
    }

    /// The nodes of this rank, in the order of their equations.
    pub fn owned_nodes(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.owner.len() as u32).filter(|&n| self.owns(n))
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

    /// Number of nodes over all ranks.
    pub fn n_nodes(&self) -> usize {
        self.equations.len()
    }

    /// Appends the equations of several nodes, three each.
    pub fn indices_into(&self, nodes: &[u32], out: &mut Vec<i32>) {
        out.extend(nodes.iter().flat_map(|&n| self.equations(n)));
    }

    /// Nodal displacements (zero where held) from the values of all equations.
    pub fn nodal(&self, values: &[f64]) -> Vec<[f64; 3]> {
        let value = |e: i32| if e < 0 { 0.0 } else { values[e as usize] };
        self.equations.iter().map(|e| e.map(value)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_contiguous_by_rank_and_skip_held_displacements() {
        let held = [[false; 3], [true, false, true], [false; 3]];
        let map = DofMap::new(vec![1, 0, 1], &held, 1, 2);
        assert_eq!(map.equations(0), [1, 2, 3]);
        assert_eq!(map.equations(1), [-1, 0, -1]);
        assert_eq!(map.owned(), 1..7);
        assert_eq!(map.owned_nodes().collect::<Vec<_>>(), [0, 2]);
        let values = [9.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(map.nodal(&values), [[1.0, 2.0, 3.0], [0.0, 9.0, 0.0], [4.0, 5.0, 6.0]]);
    }
}
