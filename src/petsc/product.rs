//! Products of sparse matrices with blocks of vectors.
//!
//! Some columns at a time are stored by rows, so that an entry of the matrix is read once for all of them and what it is multiplied by lies side by
//! side. PETSc's MatMatMult reads the matrix once for four columns, and plans its exchange of others' entries with every call.

use super::matrix::Part;
use super::{Block, Matrix};
use crate::Result;

/// Columns at a time.
const STRIP: usize = 8;

/// A row of a strip.
type Row = [f64; STRIP];

impl Matrix {
    /// `self X`.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn times(&self, x: &Block) -> Result<Block> {
        let ghosts = self.ghost_columns(x)?;
        let mut product = Block::zeros(x.comm(), x.n_local(), x.n_columns());
        self.with_parts(|parts| {
            for first in (0..x.n_columns()).step_by(STRIP) {
                let columns = first..(first + STRIP).min(x.n_columns());
                let mut rows = vec![[0.0; STRIP]; x.n_local()];
                let own = columns.clone().map(|j| x.column(j));
                let other = columns.clone().map(|j| ghosts.get(j).map_or(&[][..], |ghosts| ghosts));
                add_product(&parts[0], &by_rows(own), &mut rows);
                add_product(&parts[1], &by_rows(other), &mut rows);
                for (place, j) in columns.enumerate() {
                    product.column_mut(j).iter_mut().zip(&rows).for_each(|(y, row)| *y = row[place]);
                }
            }
        })?;
        Ok(product)
    }

    /// For each column what other ranks own of it and this rank's rows need; nothing on one rank.
    fn ghost_columns(&self, x: &Block) -> Result<Vec<Vec<f64>>> {
        if self.comm().size() == 1 {
            return Ok(Vec::new());
        }
        let bring = |j: usize| {
            let column = x.vector(j)?;
            self.ghosts(&column)?.run(&column, <[f64]>::to_vec)
        };
        (0..x.n_columns()).map(bring).collect()
    }
}

/// Columns of one length, at most [`STRIP`], by rows; zeros stand for those that lack.
fn by_rows<'a>(columns: impl Iterator<Item = &'a [f64]> + Clone) -> Vec<Row> {
    let n_rows = columns.clone().next().map_or(0, <[f64]>::len);
    let mut rows = vec![[0.0; STRIP]; n_rows];
    for (place, column) in columns.enumerate() {
        rows.iter_mut().zip(column).for_each(|(row, x)| row[place] = *x);
    }
    rows
}

/// `Y += A X`
fn add_product(a: &Part, x: &[Row], y: &mut [Row]) {
    for (bounds, y) in a.offsets.windows(2).zip(y) {
        let entries = bounds[0] as usize..bounds[1] as usize;
        let mut sum = *y;
        for (&column, value) in a.columns[entries.clone()].iter().zip(&a.values[entries]) {
            let x = &x[column as usize];
            sum.iter_mut().zip(x).for_each(|(sum, x)| *sum += value * x);
        }
        *y = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_is_multiplied_row_by_row() {
        // A = [1 0 2; 0 0 0; 0 3 0], columns x and 10 x
        let a = Part { offsets: &[0, 2, 2, 3], columns: &[0, 2, 1], values: &[1.0, 2.0, 3.0] };
        let x = by_rows([[1.0, 2.0, 3.0].as_slice(), &[10.0, 20.0, 30.0]].into_iter());
        let mut y = vec![[1.0; STRIP]; 3];
        add_product(&a, &x, &mut y);
        assert_eq!(y.iter().map(|row| row[0]).collect::<Vec<_>>(), [8.0, 1.0, 7.0]);
        assert_eq!(y.iter().map(|row| row[1]).collect::<Vec<_>>(), [71.0, 1.0, 61.0]);
        assert!(y.iter().all(|row| row[2..] == [1.0; STRIP - 2]));
    }
}
