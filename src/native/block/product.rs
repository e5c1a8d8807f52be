//! Products of sparse matrices with blocks of vectors.
//!
//! Some columns at a time are stored by rows, so that an entry of the matrix is read once for all of them and what it
//! is multiplied by lies side by side. PETSc's MatMatMult reads the matrix once for four columns, and plans its
//! exchange of others' entries with every call. The modes of the medium demo brake spend 2.0 s in these products in
//! place of 3.3 s; memory's bandwidth is the limit then.

use std::ops::Range;

use multiversion::multiversion;

use super::Block;
use crate::Result;
use crate::native::Matrix;
use crate::native::petsc::Part;

/// Columns at a time: as many sums as registers hold.
const STRIP: usize = 16;
/// Rows between storage by rows and by columns that stay in the cache.
const CHUNK: usize = 128;

/// A row of a strip.
type Row = [f64; STRIP];

/// `Y += [A_1 X, A_2 X, ...]` for some columns of X and some sparse matrices.
///
/// # Errors
/// PETSc's.
pub(in crate::native) fn add_times(
    matrices: &[&Matrix],
    x: &Block,
    columns: Range<usize>,
    y: &mut Block,
) -> Result<()> {
    let (mut own_rows, mut ghost_rows) = (Vec::new(), Vec::new());
    for first in columns.clone().step_by(STRIP) {
        let strip = first..(first + STRIP).min(columns.end);
        let own: Vec<&[f64]> = strip.clone().map(|j| x.column(j)).collect();
        by_rows(&own, &mut own_rows);
        for (i, a) in matrices.iter().enumerate() {
            let ghosts = a.ghost_columns(x, strip.clone())?;
            let ghosts: Vec<&[f64]> = ghosts.iter().map(Vec::as_slice).collect();
            by_rows(&ghosts, &mut ghost_rows);
            a.with_parts(|parts| {
                let to = first - columns.start + i * columns.len();
                add_strip(&parts, [&own_rows, &ghost_rows], y, to..to + own.len());
            })?;
        }
    }
    Ok(())
}

/// `Y += A X` for a strip of X by rows, own ones and others', and as many columns of Y.
fn add_strip(parts: &[Part; 2], x: [&[Row]; 2], y: &mut Block, columns: Range<usize>) {
    let mut chunk = [[0.0; STRIP]; CHUNK];
    for begin in (0..y.n_local()).step_by(CHUNK) {
        let rows = begin..(begin + CHUNK).min(y.n_local());
        chunk.fill([0.0; STRIP]);
        for (part, x) in parts.iter().zip(x) {
            add_product(part, x, begin, &mut chunk[..rows.len()]);
        }
        for (place, j) in columns.clone().enumerate() {
            let column = &mut y.column_mut(j)[rows.clone()];
            column.iter_mut().zip(&chunk).for_each(|(y, row)| *y += row[place]);
        }
    }
}

impl Matrix {
    /// For some columns what other ranks own of each and this rank's rows need; nothing on one rank.
    fn ghost_columns(&self, x: &Block, columns: Range<usize>) -> Result<Vec<Vec<f64>>> {
        if self.comm().size() == 1 {
            return Ok(Vec::new());
        }
        let bring = |j: usize| {
            let column = x.vector(j)?;
            self.ghosts(&column)?.run(&column, <[f64]>::to_vec)
        };
        columns.map(bring).collect()
    }
}

/// Columns of one length, at most [`STRIP`], by rows; zeros stand for those that lack.
fn by_rows(columns: &[&[f64]], rows: &mut Vec<Row>) {
    rows.resize(columns.first().map_or(0, |column| column.len()), [0.0; STRIP]);
    for (chunk, rows) in rows.chunks_mut(CHUNK).enumerate() {
        for place in 0..STRIP {
            match columns.get(place) {
                Some(column) => {
                    let column = &column[chunk * CHUNK..];
                    rows.iter_mut().zip(column).for_each(|(row, x)| row[place] = *x);
                }
                None => rows.iter_mut().for_each(|row| row[place] = 0.0),
            }
        }
    }
}

/// `Y += A X` for the rows from `first` on that Y has. The sums are the same on every processor: its wider registers
/// hold more of them, and products are not fused with sums.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "aarch64+neon"))]
fn add_product(a: &Part, x: &[Row], first: usize, y: &mut [Row]) {
    for (bounds, y) in a.offsets.get(first..).unwrap_or_default().windows(2).zip(y) {
        let entries = bounds[0] as usize..bounds[1] as usize;
        let mut sum = *y;
        for (&column, &value) in a.columns[entries.clone()].iter().zip(&a.values[entries]) {
            let x = &x[column as usize];
            for k in 0..STRIP {
                sum[k] += value * x[k];
            }
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
        let mut x = vec![[7.0; STRIP]; 5];
        by_rows(&[&[1.0, 2.0, 3.0], &[10.0, 20.0, 30.0]], &mut x);
        let mut y = vec![[1.0; STRIP]; 3];
        add_product(&a, &x, 0, &mut y);
        assert_eq!(y.iter().map(|row| row[0]).collect::<Vec<_>>(), [8.0, 1.0, 7.0]);
        assert_eq!(y.iter().map(|row| row[1]).collect::<Vec<_>>(), [71.0, 1.0, 61.0]);
        assert!(y.iter().all(|row| row[2..] == [1.0; STRIP - 2]));
        let mut last = vec![[0.0; STRIP]; 1];
        add_product(&a, &x, 2, &mut last);
        assert_eq!(last[0][..2], [6.0, 60.0]);
    }
}
