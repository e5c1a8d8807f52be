//! Symmetric sparsity patterns on one rank, compressed by rows, and values on them.

/// A pattern with the diagonal and with (j, i) where it has (i, j): the columns of each row, rising.
#[derive(Debug, Clone, PartialEq)]
pub struct SparsityPattern {
    /// Where each row starts, and the end of the last.
    pub offsets: Vec<usize>,
    /// Columns, row after row.
    pub columns: Vec<u32>,
}

impl SparsityPattern {
    /// The smallest pattern that contains all of these places.
    ///
    /// # Panics
    /// Where a place is outside `n` rows and columns.
    pub fn new(n: usize, places: impl Iterator<Item = (u32, u32)> + Clone) -> SparsityPattern {
        let all = || places.clone().flat_map(|(i, j)| [(i, j), (j, i)]).chain((0..n as u32).map(|i| (i, i)));
        let mut starts = vec![0_usize; n + 1];
        all().for_each(|(i, _)| starts[i as usize + 1] += 1);
        (0..n).for_each(|i| starts[i + 1] += starts[i]);
        let (mut next, mut repeated) = (starts.clone(), vec![0_u32; starts[n]]);
        for (i, j) in all() {
            repeated[next[i as usize]] = j;
            next[i as usize] += 1;
        }
        let (mut offsets, mut columns) = (vec![0], Vec::new());
        for row in starts.windows(2) {
            let row = &mut repeated[row[0]..row[1]];
            row.sort_unstable();
            columns.extend(row.chunk_by(|a, b| a == b).map(|same| same[0]));
            offsets.push(columns.len());
        }
        SparsityPattern { offsets, columns }
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.offsets.len() - 1
    }

    /// All places: row, column, and the index among all.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        let row =
            move |i: usize| (self.offsets[i]..self.offsets[i + 1]).map(move |at| (i, self.columns[at] as usize, at));
        (0..self.n_rows()).flat_map(row)
    }

    /// The index of a place among all.
    ///
    /// # Panics
    /// Where it is not in the pattern.
    fn index(&self, i: usize, j: u32) -> usize {
        let row = self.offsets[i]..self.offsets[i + 1];
        row.start + self.columns[row].binary_search(&j).expect("a place of the pattern")
    }

    /// Values on the pattern, from entries in any order; those of one place add up.
    ///
    /// # Panics
    /// Where an entry is not in the pattern.
    pub fn values(&self, items: &[(u32, u32, f64)]) -> Vec<f64> {
        let mut values = vec![0.0; self.columns.len()];
        items.iter().for_each(|&(i, j, value)| values[self.index(i as usize, j)] += value);
        values
    }

    /// `(A + A^T) / 2`, and the largest `|a_ij - a_ji|`.
    pub fn symmetric_part(&self, values: &[f64]) -> (Vec<f64>, f64) {
        let (mut part, mut largest) = (values.to_vec(), 0.0_f64);
        for (i, j, at) in self.places() {
            let other = values[self.index(j, i as u32)];
            part[at] = 0.5 * (values[at] + other);
            largest = largest.max((values[at] - other).abs());
        }
        (part, largest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_has_all_places_their_transposes_and_the_diagonal() {
        let pattern = SparsityPattern::new(3, [(2, 0), (0, 1), (2, 0), (1, 1)].into_iter());
        assert_eq!(
            (pattern.offsets.as_slice(), pattern.columns.as_slice()),
            (&[0, 3, 5, 7][..], &[0, 1, 2, 0, 1, 0, 2][..])
        );
    }

    #[test]
    fn entries_of_one_place_add_up() {
        let pattern = SparsityPattern::new(3, [(2, 0), (0, 1)].into_iter());
        let values = pattern.values(&[(2, 0, 5.0), (1, 1, 1.0), (2, 0, 3.0)]);
        assert_eq!(values, [0.0, 0.0, 0.0, 0.0, 1.0, 8.0, 0.0]);
        assert_eq!(pattern.symmetric_part(&values), (vec![0.0, 0.0, 4.0, 0.0, 1.0, 4.0, 0.0], 8.0));
    }
}
