//! Sparse square matrices on one rank, compressed by rows.

/// A pattern: the columns of each row, rising.
#[derive(Debug, Clone, PartialEq)]
pub struct SparsityPattern {
    /// Where each row starts, and the end of the last.
    pub offsets: Vec<usize>,
    /// Columns, row after row.
    pub columns: Vec<u32>,
}

/// A matrix: a pattern and a value for each of its places.
#[derive(Debug, Clone, PartialEq)]
pub struct Sparse {
    /// Where the values are.
    pub pattern: SparsityPattern,
    /// The values, in the order of the pattern's columns.
    pub values: Vec<f64>,
}

impl SparsityPattern {
    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Columns of a row.
    pub fn row(&self, i: usize) -> &[u32] {
        &self.columns[self.offsets[i]..self.offsets[i + 1]]
    }

    /// Where an entry is among all; none where it is not in the pattern.
    pub fn place(&self, i: u32, j: u32) -> Option<usize> {
        self.row(i as usize).binary_search(&j).ok().map(|k| self.offsets[i as usize] + k)
    }

    /// The smallest pattern that holds all of these and their transposes, and the diagonal.
    pub fn symmetric_union(n: usize, patterns: &[&SparsityPattern]) -> SparsityPattern {
        let transposed: Vec<SparsityPattern> = patterns.iter().map(|pattern| pattern.transposed()).collect();
        let (mut offsets, mut columns) = (vec![0], Vec::new());
        for i in 0..n {
            let first = columns.len();
            columns.push(i as u32);
            patterns.iter().copied().chain(&transposed).for_each(|pattern| columns.extend_from_slice(pattern.row(i)));
            columns[first..].sort_unstable();
            let mut kept = first;
            for k in first..columns.len() {
                if k == first || columns[k] != columns[kept - 1] {
                    columns[kept] = columns[k];
                    kept += 1;
                }
            }
            columns.truncate(kept);
            offsets.push(kept);
        }
        SparsityPattern { offsets, columns }
    }

    fn transposed(&self) -> SparsityPattern {
        let n = self.n_rows();
        let mut offsets = vec![0; n + 1];
        self.columns.iter().for_each(|&j| offsets[j as usize + 1] += 1);
        (0..n).for_each(|j| offsets[j + 1] += offsets[j]);
        let (mut next, mut columns) = (offsets.clone(), vec![0; self.columns.len()]);
        for i in 0..n {
            for &j in self.row(i) {
                columns[next[j as usize]] = i as u32;
                next[j as usize] += 1;
            }
        }
        SparsityPattern { offsets, columns }
    }
}

impl Sparse {
    /// From entries in any order; those of one place add up.
    ///
    /// # Panics
    /// Where an entry is outside `n` rows and columns.
    pub fn new(n: usize, items: &[(u32, u32, f64)]) -> Sparse {
        let mut starts = vec![0_usize; n + 1];
        items.iter().for_each(|&(i, ..)| starts[i as usize + 1] += 1);
        (0..n).for_each(|i| starts[i + 1] += starts[i]);
        let (mut next, mut sorted) = (starts.clone(), vec![(0, 0.0); items.len()]);
        for &(i, j, value) in items {
            sorted[next[i as usize]] = (j, value);
            next[i as usize] += 1;
        }
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::<f64>::new());
        for i in 0..n {
            let row = &mut sorted[starts[i]..starts[i + 1]];
            row.sort_by_key(|&(j, _)| j);
            for same in row.chunk_by(|a, b| a.0 == b.0) {
                columns.push(same[0].0);
                values.push(same.iter().map(|(_, value)| value).sum());
            }
            offsets.push(columns.len());
        }
        Sparse { pattern: SparsityPattern { offsets, columns }, values }
    }

    /// Entries of a row: column and value.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let range = self.pattern.offsets[i]..self.pattern.offsets[i + 1];
        self.pattern.columns[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// Whether of no two entries (i, j) and (j, i) off the diagonal both are there, and there are some.
    pub fn is_triangle(&self) -> bool {
        let mut any = false;
        for i in 0..self.pattern.n_rows() as u32 {
            for &j in self.pattern.row(i as usize).iter().filter(|&&j| j != i) {
                if self.pattern.place(j, i).is_some() {
                    return false;
                }
                any = true;
            }
        }
        any
    }

    /// The values on a larger pattern, zero elsewhere.
    ///
    /// # Panics
    /// Where the pattern does not hold this one's.
    pub fn on(&self, pattern: &SparsityPattern) -> Vec<f64> {
        let mut values = vec![0.0; pattern.columns.len()];
        for i in 0..self.pattern.n_rows() {
            for (j, value) in self.row(i) {
                values[pattern.place(i as u32, j).expect("a larger pattern")] = value;
            }
        }
        values
    }
}

/// `(A + A^T) / 2` of values on a symmetric pattern, and the largest `|a_ij - a_ji|`.
pub fn symmetric_part(pattern: &SparsityPattern, values: &[f64]) -> (Vec<f64>, f64) {
    let (mut part, mut largest) = (values.to_vec(), 0.0_f64);
    for i in 0..pattern.n_rows() {
        for at in pattern.offsets[i]..pattern.offsets[i + 1] {
            let other = values[pattern.place(pattern.columns[at], i as u32).expect("a symmetric pattern")];
            part[at] = 0.5 * (values[at] + other);
            largest = largest.max((values[at] - other).abs());
        }
    }
    (part, largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_of_one_place_add_up_and_rows_rise() {
        let a = Sparse::new(3, &[(2, 1, 4.0), (0, 2, 1.0), (0, 0, 5.0), (0, 2, 2.0)]);
        assert_eq!(a.row(0).collect::<Vec<_>>(), [(0, 5.0), (2, 3.0)]);
        assert_eq!((a.row(1).count(), a.row(2).collect::<Vec<_>>()), (0, vec![(1, 4.0)]));
        assert!(a.is_triangle());
        assert!(!Sparse::new(2, &[(0, 1, 1.0), (1, 0, 2.0)]).is_triangle());
        assert!(!Sparse::new(2, &[(0, 0, 1.0)]).is_triangle());
    }

    #[test]
    fn a_union_holds_all_and_their_transposes() {
        let (a, b) = (Sparse::new(3, &[(0, 1, 2.0)]), Sparse::new(3, &[(2, 0, 8.0), (1, 1, 1.0)]));
        let union = SparsityPattern::symmetric_union(3, &[&a.pattern, &b.pattern]);
        assert_eq!([0, 1, 2].map(|i| union.row(i).to_vec()), [vec![0, 1, 2], vec![0, 1], vec![0, 2]]);
        assert_eq!(b.on(&union), [0.0, 0.0, 0.0, 0.0, 1.0, 8.0, 0.0]);
        let (part, largest) = symmetric_part(&union, &b.on(&union));
        assert_eq!((part, largest), (vec![0.0, 0.0, 4.0, 0.0, 1.0, 4.0, 0.0], 8.0));
    }
}
