//! Which nodes couple.

use std::ops::Range;

use super::Connectivity;
use crate::contact::GapOperator;
use crate::mesh::Numbering;

/// The graph of coupled nodes in CSR form: for each node of this rank its neighbours and itself, by rising number.
#[derive(Debug, Clone)]
pub struct Pattern {
    owned: Range<u32>,
    offsets: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Pattern {
    /// The graph of everything that couples nodes. Every node couples with itself. Not collective.
    pub fn new(nodes: &Numbering, couplings: &[&dyn Connectivity]) -> Pattern {
        let owned = nodes.owned();
        let (starts, members) = invert(&owned, couplings);
        let mut pattern = Pattern { owned: owned.clone(), offsets: vec![0], neighbours: Vec::new() };
        let mut seen = vec![u32::MAX; nodes.n_local()];
        for (row, node) in owned.enumerate() {
            let first = pattern.neighbours.len();
            seen[node as usize] = node;
            pattern.neighbours.push(node);
            for &(family, e) in &members[starts[row]..starts[row + 1]] {
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

    /// Places of the pairs (`node`, neighbour) among all pairs.
    ///
    /// # Panics
    /// Where this rank does not own the node.
    #[inline]
    pub fn pairs(&self, node: u32) -> Range<usize> {
        let row = (node - self.owned.start) as usize;
        self.offsets[row]..self.offsets[row + 1]
    }

    /// The second nodes of all pairs; within a node's [`Pattern::pairs`] they rise.
    pub fn neighbours(&self) -> &[u32] {
        &self.neighbours
    }
}

/// Contact points couple the nodes that their relative displacement depends on.
impl Connectivity for GapOperator {
    fn len(&self) -> usize {
        GapOperator::len(self)
    }

    fn nodes(&self, a: usize) -> &[u32] {
        self.point(a).0
    }
}

/// For each node of this rank the (family, member) pairs that touch it.
fn invert(owned: &Range<u32>, couplings: &[&dyn Connectivity]) -> (Vec<usize>, Vec<(u32, u32)>) {
    let rows = |nodes: &[u32], visit: &mut dyn FnMut(usize)| {
        nodes.iter().filter(|n| owned.contains(n)).for_each(|n| visit((n - owned.start) as usize));
    };
    let mut starts = vec![0_usize; owned.len() + 1];
    for family in couplings {
        (0..family.len()).for_each(|e| rows(family.nodes(e), &mut |row| starts[row + 1] += 1));
    }
    for row in 0..owned.len() {
        starts[row + 1] += starts[row];
    }
    let mut next = starts.clone();
    let mut members = vec![(0, 0); starts[owned.len()]];
    for (f, family) in couplings.iter().enumerate() {
        for e in 0..family.len() {
            rows(family.nodes(e), &mut |row| {
                members[next[row]] = (f as u32, e as u32);
                next[row] += 1;
            });
        }
    }
    (starts, members)
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Connectivity for [[u32; 3]; 2] {
        fn len(&self) -> usize {
            2
        }
        fn nodes(&self, e: usize) -> &[u32] {
            &self[e]
        }
    }

    #[test]
    fn a_rank_has_the_rows_of_its_own_nodes() {
        let triangles = [[4, 0, 1], [1, 3, 4]];
        let row = |pattern: &Pattern, node: u32| pattern.neighbours()[pattern.pairs(node)].to_vec();
        let all = Pattern::new(&Numbering::even(5, 0, 1), &[&triangles]);
        let rows: [&[u32]; 5] = [&[0, 1, 4], &[0, 1, 3, 4], &[2], &[1, 3, 4], &[0, 1, 3, 4]];
        (0..5).for_each(|n| assert_eq!(row(&all, n), rows[n as usize]));
        let some = Pattern::new(&Numbering::whole(5, 2..4), &[&triangles]);
        assert_eq!([row(&some, 2), row(&some, 3)], [rows[2], rows[3]]);
        assert_eq!(some.neighbours().len(), 4);
    }
}
