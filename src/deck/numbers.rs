//! Indices of nodes or elements by their numbers in a deck.

use std::collections::HashMap;

/// A table where the numbers are dense, a map where they are not.
#[derive(Default)]
pub struct Numbers {
    table: Vec<u32>,
    map: HashMap<u32, u32>,
}

/// Mark of a number that nothing has.
const NOTHING: u32 = u32::MAX;
/// Numbers up to so many times their count are dense.
const SPARSEST: usize = 8;
/// Numbers below this are always dense.
const SMALL: usize = 1 << 16;

impl Numbers {
    /// Makes space for numbers that follow.
    pub fn reserve(&mut self, numbers: &[u32]) {
        let size = numbers.iter().max().map_or(0, |&largest| largest as usize + 1);
        if size > self.table.len() && size <= SMALL.max(SPARSEST * (self.table.len() + numbers.len())) {
            self.table.resize(size, NOTHING);
        }
    }

    /// Gives a number its index, unless it has one: then returns that.
    pub fn insert(&mut self, number: u32, index: u32) -> Option<u32> {
        if let Some(known) = self.get(number) {
            return Some(known);
        }
        match self.table.get_mut(number as usize) {
            Some(place) => *place = index,
            None => _ = self.map.insert(number, index),
        }
        None
    }

    /// The index of a number.
    pub fn get(&self, number: u32) -> Option<u32> {
        let in_table = self.table.get(number as usize).copied().filter(|&index| index != NOTHING);
        in_table.or_else(|| self.map.get(&number).copied())
    }

    /// The indices of the numbers of a range that there are.
    pub fn range(&self, first: u32, last: u32, step: u32) -> Vec<u32> {
        let is_in = |number: &u32| (first..=last).contains(number) && (number - first).is_multiple_of(step);
        let end = last.min((self.table.len() as u32).saturating_sub(1));
        let dense = (first..=end).step_by(step as usize).filter(|_| !self.table.is_empty());
        let dense =
            dense.filter_map(|number| self.table.get(number as usize)).copied().filter(|&index| index != NOTHING);
        let mut sparse: Vec<(u32, u32)> = self.map.iter().map(|(n, i)| (*n, *i)).filter(|(n, _)| is_in(n)).collect();
        sparse.sort_unstable();
        dense.chain(sparse.into_iter().map(|(_, index)| index)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dense_and_sparse_numbers_have_their_indices() {
        let mut numbers = Numbers::default();
        for (index, list) in [[1, 2, 7], [4_000_000_000, 90_000_000, 5]].iter().enumerate() {
            numbers.reserve(list);
            for (i, &number) in list.iter().enumerate() {
                assert_eq!(numbers.insert(number, (3 * index + i) as u32), None);
            }
        }
        assert!(numbers.table.len() < 100);
        assert_eq!(numbers.insert(7, 99), Some(2));
        assert_eq!([7, 4_000_000_000, 5, 3].map(|n| numbers.get(n)), [Some(2), Some(3), Some(5), None]);
        assert_eq!(numbers.range(1, 7, 2), [0, 5, 2]);
        assert_eq!(numbers.range(1, u32::MAX, 1), [0, 1, 5, 2, 4, 3]);
        assert!(Numbers::default().range(1, u32::MAX, 1).is_empty());
    }

    #[test]
    fn a_table_grows_to_a_map_and_keeps_what_it_has() {
        let mut numbers = Numbers::default();
        numbers.insert(100_000, 0);
        numbers.reserve(&(1..=100_001).collect::<Vec<_>>());
        assert_eq!((numbers.get(100_000), numbers.insert(100_000, 5)), (Some(0), Some(0)));
    }
}
