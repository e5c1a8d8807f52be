//! Blocks of vectors: one pass over a matrix or a factor for many right-hand sides.
//!
//! Why not SLEPc's BV, which has products and orthogonalisation of blocks: its columns are those of a PETSc matrix or
//! vectors, and each pass over a factor would copy them into MUMPS's packed right-hand sides and back. Here the columns
//! lie packed, as MUMPS and BLAS read them: 0.022 s a right-hand side with 32 at once on the full demo brake (two
//! ranks, single precision) in place of 0.045 s with 8, and `dgemm` with 28 to 39 Gflop/s. Figures:
//! docs/engineering-log.md, "Factorisation and orderings" and "Modes of large models".

mod noise;
mod orthonormal;
mod product;
#[cfg(test)]
mod tests;

pub use noise::Noise;
pub use orthonormal::Orthonormal;

use std::ops::Range;

use crate::Result;
use crate::native::lapack;
use crate::native::{Comm, Factor, Matrix, Vector};

/// Columns distributed over the ranks by rows, column-major on each.
#[derive(Clone)]
pub struct Block {
    comm: Comm,
    n_local: usize,
    n_columns: usize,
    values: Vec<f64>,
}

impl Block {
    /// Right-hand sides in a pass over a factor: on the full demo brake, two ranks, single precision, 0.045 s each with
    /// 8, 0.022 s with 32, 0.024 s with 64.
    pub const AT_ONCE: usize = 32;

    /// A block of zeros with `n_local` rows on this rank. Not collective.
    pub fn zeros(comm: &Comm, n_local: usize, n_columns: usize) -> Block {
        Block { comm: comm.clone(), n_local, n_columns, values: vec![0.0; n_local * n_columns] }
    }

    /// A block without columns, with room for some. Not collective.
    pub fn with_room(comm: &Comm, n_local: usize, n_columns: usize) -> Block {
        Block { comm: comm.clone(), n_local, n_columns: 0, values: Vec::with_capacity(n_local * n_columns) }
    }

    /// Columns one after the other, `n_local` values each on this rank. Not collective.
    ///
    /// # Panics
    /// Where the values do not fill whole columns.
    pub fn from_columns(comm: &Comm, n_local: usize, values: Vec<f64>) -> Block {
        let n_columns = values.len() / n_local.max(1);
        assert_eq!(values.len(), n_columns * n_local);
        Block { comm: comm.clone(), n_local, n_columns, values }
    }

    /// All values of this rank, column by column. Not collective.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The communicator.
    pub fn comm(&self) -> &Comm {
        &self.comm
    }

    /// Number of rows on this rank. Not collective.
    pub fn n_local(&self) -> usize {
        self.n_local
    }

    /// Number of columns. Not collective.
    pub fn n_columns(&self) -> usize {
        self.n_columns
    }

    /// This rank's values of column `j`. Not collective.
    pub fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.n_local..(j + 1) * self.n_local]
    }

    /// This rank's values of column `j`. Not collective.
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.n_local..(j + 1) * self.n_local]
    }

    /// All values of this rank. Not collective.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Column `j` as a vector.
    ///
    /// # Errors
    /// PETSc's.
    pub fn vector(&self, j: usize) -> Result<Vector> {
        Vector::from_local(&self.comm, self.column(j))
    }

    /// A part of the columns. Not collective.
    pub fn columns(&self, range: Range<usize>) -> Block {
        let values = self.values[range.start * self.n_local..range.end * self.n_local].to_vec();
        Block { comm: self.comm.clone(), n_local: self.n_local, n_columns: range.len(), values }
    }

    /// Appends the columns of another block. Not collective.
    pub fn append(&mut self, other: &Block) {
        // Exactly, not twice as much: a basis may take gigabytes.
        self.values.reserve_exact(other.values.len());
        self.values.extend_from_slice(&other.values);
        self.n_columns += other.n_columns;
    }

    /// `A self`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn multiplied_by(&self, a: &Matrix) -> Result<Block> {
        let mut product = self.like(self.n_columns);
        product.add_products(&[a], self, 0..self.n_columns)?;
        Ok(product)
    }

    /// Adds the products of some matrices with some columns of another block, side by side, to the first columns.
    ///
    /// # Errors
    /// PETSc's.
    ///
    /// # Panics
    /// Where there are fewer columns.
    pub fn add_products(&mut self, matrices: &[&Matrix], x: &Block, columns: Range<usize>) -> Result<()> {
        let Some(first) = matrices.first() else { return Ok(()) };
        if !first.is_dense()? {
            return product::add_times(matrices, x, columns, self);
        }
        let n = self.n_local;
        let (x, sizes) = (&x.values[columns.start * n..columns.end * n], [n, n, columns.len()]);
        for (i, a) in matrices.iter().enumerate() {
            let to = &mut self.values[i * x.len()..][..x.len()];
            a.with_dense_values(|a| lapack::add_product(false, sizes, a, x, to))?;
        }
        Ok(())
    }

    /// `A^T self`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn multiplied_by_transpose(&self, a: &Matrix) -> Result<Block> {
        let mut product = self.like(self.n_columns);
        let sizes = [self.n_local, self.n_local, self.n_columns];
        if a.with_dense_values(|a| lapack::multiply(true, sizes, a, &self.values, &mut product.values))?.is_none() {
            let mut y = Vector::zeros(&self.comm, self.n_local)?;
            for j in 0..self.n_columns {
                a.multiply_transpose(&self.vector(j)?, &mut y)?;
                y.local(|y| product.column_mut(j).copy_from_slice(y))?;
            }
        }
        Ok(product)
    }

    /// `A^-1 self`, many columns in each pass over the factor.
    ///
    /// # Errors
    /// PETSc's, and MUMPS's with its code.
    pub fn solved_by(&self, factor: &Factor) -> Result<Block> {
        self.solution(factor, false)
    }

    /// `A^-T self` with the factor of A.
    ///
    /// # Errors
    /// PETSc's, and MUMPS's with its code.
    pub fn solved_by_transpose(&self, factor: &Factor) -> Result<Block> {
        self.solution(factor, true)
    }

    fn solution(&self, factor: &Factor, transposed: bool) -> Result<Block> {
        if let Some(dense) = factor.dense() {
            let mut solution = self.clone();
            dense.solve(&mut solution.values, transposed);
            return Ok(solution);
        }
        let mut solution = self.like(self.n_columns);
        for first in (0..self.n_columns).step_by(Block::AT_ONCE) {
            let columns = first..(first + Block::AT_ONCE).min(self.n_columns);
            let rows = columns.start * self.n_local..columns.end * self.n_local;
            let (b, x) = (&self.values[rows.clone()], &mut solution.values[rows]);
            factor.solve_columns(b, x, columns.len(), transposed)?;
        }
        Ok(solution)
    }

    /// `self^T other`, column-major, the same on every rank.
    pub fn gram(&self, other: &Block) -> Vec<f64> {
        self.leading_gram(self.n_columns, other)
    }

    /// As [`Block::gram`] with a block that has few rows other than zero: the others are left out.
    pub fn gram_of_few_rows(&self, other: &Block) -> Vec<f64> {
        let is_there = |&row: &usize| (0..other.n_columns).any(|j| other.values[j * other.n_local + row] != 0.0);
        let rows: Vec<usize> = (0..other.n_local).filter(is_there).collect();
        match rows.len() {
            n if 2 * n > self.n_local => self.gram(other),
            _ => self.of_rows(&rows).gram(&other.of_rows(&rows)),
        }
    }

    /// Some rows of this rank. Not collective.
    pub fn of_rows(&self, rows: &[usize]) -> Block {
        let values = (0..self.n_columns).flat_map(|j| rows.iter().map(move |row| self.column(j)[*row])).collect();
        Block { comm: self.comm.clone(), n_local: rows.len(), n_columns: self.n_columns, values }
    }

    /// Lengths of the columns.
    pub fn lengths(&self) -> Vec<f64> {
        let square = |j: usize| self.column(j).iter().map(|x| x * x).sum();
        let mut squares: Vec<f64> = (0..self.n_columns).map(square).collect();
        self.comm.sum_all(&mut squares);
        squares.into_iter().map(f64::sqrt).collect()
    }

    /// `self coefficients`, with column-major coefficients of as many rows as this block has columns. Not collective.
    ///
    /// # Panics
    /// Where the coefficients do not fill whole columns.
    pub fn combined(&self, coefficients: &[f64], n_columns: usize) -> Block {
        self.leading_combined(self.n_columns, coefficients, n_columns)
    }

    /// Keeps the first `n` columns. Not collective.
    pub fn truncate(&mut self, n: usize) {
        self.values.truncate(n * self.n_local);
        self.n_columns = self.n_columns.min(n);
    }

    /// Overwrites the columns from `first` on. Not collective.
    ///
    /// # Panics
    /// Where there are fewer.
    pub fn set_columns(&mut self, first: usize, columns: &Block) {
        self.values[first * self.n_local..][..columns.values.len()].copy_from_slice(&columns.values);
    }

    /// The first `n` columns of `self`, transposed, times `other`: column-major, the same on every rank.
    pub fn leading_gram(&self, n: usize, other: &Block) -> Vec<f64> {
        let mut product = vec![0.0; n * other.n_columns];
        let sizes = [n, self.n_local, other.n_columns];
        lapack::multiply(true, sizes, &self.values[..n * self.n_local], &other.values, &mut product);
        self.comm.sum_all(&mut product);
        product
    }

    /// The first `n` columns of `self` times column-major coefficients of n rows. Not collective.
    ///
    /// # Panics
    /// Where the coefficients do not fill whole columns.
    pub fn leading_combined(&self, n: usize, coefficients: &[f64], n_columns: usize) -> Block {
        let mut product = self.like(n_columns);
        let sizes = [self.n_local, n, n_columns];
        lapack::multiply(false, sizes, &self.values[..n * self.n_local], coefficients, &mut product.values);
        product
    }

    /// `self = self coefficients` with a column-major square matrix, a strip of rows at a time, so that no second block
    /// is needed. Not collective.
    ///
    /// # Panics
    /// Where the matrix is not square of as many rows as this block has columns.
    pub fn transform(&mut self, coefficients: &[f64]) {
        const STRIP: usize = 1024;
        let (n, columns) = (self.n_local, self.n_columns);
        let (mut strip, mut product) = (Vec::new(), Vec::new());
        for first in (0..n).step_by(STRIP) {
            let rows = first..(first + STRIP).min(n);
            strip.clear();
            (0..columns).for_each(|j| strip.extend_from_slice(&self.values[j * n..][rows.clone()]));
            product.resize(strip.len(), 0.0);
            lapack::multiply(false, [rows.len(), columns, columns], &strip, coefficients, &mut product);
            for j in 0..columns {
                self.values[j * n..][rows.clone()].copy_from_slice(&product[j * rows.len()..][..rows.len()]);
            }
        }
    }

    /// Zeros in the same layout.
    fn like(&self, n_columns: usize) -> Block {
        Block::zeros(&self.comm, self.n_local, n_columns)
    }

    /// `self -= other coefficients`, with column-major coefficients. Not collective.
    ///
    /// # Panics
    /// Where the coefficients do not have as many rows as `other` has columns.
    pub fn subtract(&mut self, other: &Block, coefficients: &[f64]) {
        let sizes = [self.n_local, other.n_columns, self.n_columns];
        lapack::subtract_product(sizes, &other.values, coefficients, &mut self.values);
    }

    /// `self += a other`. Not collective.
    pub fn axpy(&mut self, a: f64, other: &Block) {
        self.values.iter_mut().zip(&other.values).for_each(|(x, y)| *x += a * y);
    }
}
