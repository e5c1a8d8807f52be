//! Which nodes a rank has, and an order of nodes in which neighbours are near each other.

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// The nodes that a rank has, by their *local* numbers, and their *global* numbers among all nodes.
///
/// Local numbers rise with global ones, so that whatever is ordered by local numbers is ordered alike on all ranks. The
/// nodes that the rank owns follow one another; every node has one owner.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Numbering {
    pub(super) global: Vec<u32>,
    pub(super) owned: Range<u32>,
    pub(super) n_global: usize,
    pub(super) labels: Vec<u32>,
}

impl Numbering {
    /// From the global numbers of the nodes that the rank has, rising, and of those that it owns. `labels` has for
    /// every global number one that does not depend on the number of ranks.
    ///
    /// # Panics
    /// Where the rank has not all of its own.
    pub fn new(global: Vec<u32>, owned: Range<u32>, labels: &[u32]) -> Numbering {
        let place = |node: u32| global.partition_point(|&n| n < node) as u32;
        let local = place(owned.start)..place(owned.end);
        assert_eq!(local.len(), owned.len(), "a rank has all nodes that it owns");
        let own = global.iter().map(|&n| labels[n as usize]).collect();
        Numbering { global, owned: local, n_global: labels.len(), labels: own }
    }

    /// Every rank has all nodes; this one owns a range of them.
    ///
    /// # Panics
    /// Where the range goes beyond the nodes.
    pub fn whole(n_nodes: usize, owned: Range<u32>) -> Numbering {
        let all: Vec<u32> = (0..n_nodes as u32).collect();
        Numbering::new(all.clone(), owned, &all)
    }

    /// Every rank has all nodes and owns an equal share: for models small enough to be everywhere.
    pub fn even(n_nodes: usize, rank: usize, size: usize) -> Numbering {
        let start = |rank: usize| (rank * n_nodes / size) as u32;
        Numbering::whole(n_nodes, start(rank)..start(rank + 1))
    }

    /// Local numbers of the nodes that this rank owns.
    pub fn owned(&self) -> Range<u32> {
        self.owned.clone()
    }

    /// Whether this rank owns a node, by its local number.
    #[inline]
    pub fn owns(&self, node: u32) -> bool {
        self.owned.contains(&node)
    }

    /// Global numbers of the nodes that this rank has, rising.
    pub fn global(&self) -> &[u32] {
        &self.global
    }

    /// For each node that this rank has a number that is the same on any number of ranks: its place in the mesh's file.
    pub fn labels(&self) -> &[u32] {
        &self.labels
    }

    /// Number of nodes that this rank has.
    pub fn n_local(&self) -> usize {
        self.global.len()
    }

    /// Number of nodes over all ranks.
    pub fn n_global(&self) -> usize {
        self.n_global
    }
}

/// Up to this many nodes stay in the order in which they came.
const LEAF: usize = 8;

/// Orders nodes by owner, and those of an owner so that nodes near each other in space are near each other in the list:
/// the box of the nodes is halved across its longest side, and so are the halves. Returns the nodes in the new order.
///
/// # Panics
/// Where there are fewer owners than nodes.
pub fn order(nodes: &[[f64; 3]], owner: &[u32]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..nodes.len() as u32).collect();
    order.sort_by_key(|&n| owner[n as usize]);
    for own in order.chunk_by_mut(|&a, &b| owner[a as usize] == owner[b as usize]) {
        halve(nodes, own);
    }
    order
}

fn halve(nodes: &[[f64; 3]], chosen: &mut [u32]) {
    if chosen.len() <= LEAF {
        return chosen.sort_unstable();
    }
    let axis = longest_side(nodes, chosen);
    let x = |n: u32| nodes[n as usize][axis];
    let middle = chosen.len() / 2;
    chosen.select_nth_unstable_by(middle, |&a, &b| x(a).total_cmp(&x(b)).then(a.cmp(&b)));
    let (low, high) = chosen.split_at_mut(middle);
    halve(nodes, low);
    halve(nodes, high);
}

/// The axis along which the box around some nodes is longest.
fn longest_side(nodes: &[[f64; 3]], chosen: &[u32]) -> usize {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &n in chosen {
        for i in 0..3 {
            low[i] = low[i].min(nodes[n as usize][i]);
            high[i] = high[i].max(nodes[n as usize][i]);
        }
    }
    let length = |i: usize| high[i] - low[i];
    (1..3).fold(0, |best, i| if length(i) > length(best) { i } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_shares_cover_all_nodes_once() {
        let owned: Vec<u32> = (0..3).flat_map(|rank| Numbering::even(10, rank, 3).owned()).collect();
        assert_eq!(owned, (0..10).collect::<Vec<_>>());
        assert!(Numbering::even(10, 2, 3).owns(9) && !Numbering::even(10, 1, 3).owns(9));
    }

    #[test]
    fn owners_come_one_after_the_other_and_neighbours_stay_together() {
        // A line of points in an order that jumps about; every third one belongs to another owner.
        let nodes: Vec<[f64; 3]> = (0..64).map(|n| [f64::from(n * 37 % 64), 0.0, 0.0]).collect();
        let owner: Vec<u32> = (0..64).map(|n| u32::from(n % 3 == 0)).collect();
        let order = order(&nodes, &owner);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..64).collect::<Vec<_>>());
        assert!(order.is_sorted_by_key(|&n| owner[n as usize]));
        let own: Vec<f64> = order[..42].iter().map(|&n| nodes[n as usize][0]).collect();
        let (low, high) = own.split_at(21);
        assert!(low.iter().all(|a| high.iter().all(|b| a < b)), "the first cut is in the middle of the line");
    }
}
