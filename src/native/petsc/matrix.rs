//! Distributed sparse matrices (AIJ).

use std::cell::OnceCell;
use std::ptr;

use squeal_sys as sys;

use super::error::check;
use super::{Gather, Rows, Vector};
use crate::Result;
use crate::native::Comm;

/// A distributed sparse matrix of doubles; each rank holds whole rows.
pub struct Matrix {
    raw: sys::Mat,
    comm: Comm,
    n_local: usize,
    /// Brings the entries of vectors that other ranks own and this rank's rows need; made with the first product.
    ghosts: OnceCell<Gather>,
}

/// Some columns of this rank's rows, compressed by rows.
#[derive(Clone, Copy)]
pub(in crate::native) struct Part<'a> {
    /// Where each row starts, and the end of the last.
    pub offsets: &'a [i32],
    /// Columns, counted within the part.
    pub columns: &'a [i32],
    /// The entries.
    pub values: &'a [f64],
}

impl Part<'_> {
    /// Visits the entries: row and column, counted within the part, and value.
    fn visit(&self, mut visit: impl FnMut(usize, usize, f64)) {
        for (row, bounds) in self.offsets.windows(2).enumerate() {
            let entries = bounds[0] as usize..bounds[1] as usize;
            let pairs = self.columns[entries.clone()].iter().zip(&self.values[entries]);
            pairs.for_each(|(&column, &value)| visit(row, column as usize, value));
        }
    }
}

/// The part of a rank that needs no columns of others.
const NOTHING: Part = Part { offsets: &[], columns: &[], values: &[] };

impl Drop for Matrix {
    fn drop(&mut self) {
        // SAFETY: this handle owns the matrix and the session is alive.
        unsafe { sys::MatDestroy(&mut self.raw) };
    }
}

impl Matrix {
    /// A square matrix of zeros on the rows of this rank.
    ///
    /// # Errors
    /// PETSc's.
    pub fn zeros(comm: &Comm, mut rows: Rows) -> Result<Matrix> {
        let n = rows.own.offsets.len() as i32 - 1;
        // Never read: PETSc wants values even where it is to copy the pattern alone.
        let mut unused = [vec![0.0; rows.own.columns.len()], vec![0.0; rows.other.columns.len()]];
        let [v, other_v] = unused.each_mut().map(|values| values.as_mut_ptr());
        let (i, j) = (rows.own.offsets.as_mut_ptr(), rows.own.columns.as_mut_ptr());
        let (other_i, other_j) = (rows.other.offsets.as_mut_ptr(), rows.other.columns.as_mut_ptr());
        let (decide, mut borrowed) = (super::DETERMINE, ptr::null_mut());
        // SAFETY: the first matrix stands on our arrays, which outlive it; the copy has its own.
        unsafe {
            let code = match comm.size() {
                1 => sys::MatCreateSeqAIJWithArrays(comm.raw(), n, n, i, j, v, &mut borrowed),
                _ => sys::MatCreateMPIAIJWithSplitArrays(
                    comm.raw(),
                    n,
                    n,
                    decide,
                    decide,
                    i,
                    j,
                    v,
                    other_i,
                    other_j,
                    other_v,
                    &mut borrowed,
                ),
            };
            check(code)?;
            let borrowed = Matrix { raw: borrowed, comm: comm.clone(), n_local: n as usize, ghosts: OnceCell::new() };
            borrowed.copy(sys::MatDuplicateOption::MAT_DO_NOT_COPY_VALUES)
        }
    }

    /// A matrix of zeros on the same pattern, of which there is one copy for both.
    ///
    /// # Errors
    /// PETSc's.
    pub fn zeros_like(&self) -> Result<Matrix> {
        self.copy(sys::MatDuplicateOption::MAT_SHARE_NONZERO_PATTERN)
    }

    fn copy(&self, what: sys::MatDuplicateOption) -> Result<Matrix> {
        let mut raw = ptr::null_mut();
        // SAFETY: the handle is alive.
        check(unsafe { sys::MatDuplicate(self.raw, what, &mut raw) })?;
        let copy = Matrix { raw, comm: self.comm.clone(), n_local: self.n_local, ghosts: OnceCell::new() };
        copy.set_option(sys::MatOption::MAT_IGNORE_OFF_PROC_ENTRIES, true)?;
        copy.set_option(sys::MatOption::MAT_NEW_NONZERO_LOCATION_ERR, true)?;
        Ok(copy)
    }

    /// Changes the values of several matrices: `change` has for each those in columns of this rank and those in all others, in the
    /// order of the [`Rows`] that it was made of.
    ///
    /// # Errors
    /// PETSc's.
    pub fn change_values(matrices: &mut [&mut Matrix], change: impl FnOnce(&mut [[&mut [f64]; 2]])) -> Result<()> {
        let mut values = Vec::new();
        for matrix in matrices.iter_mut() {
            values.push(matrix.values()?);
        }
        change(&mut values);
        matrices.iter_mut().try_for_each(|matrix| matrix.finish())
    }

    /// The values of the one or two sequential matrices behind this one.
    fn values<'a>(&mut self) -> Result<[&'a mut [f64]; 2]> {
        let (own, other, _) = self.sequential()?;
        Ok([values(own)?, values(other)?])
    }

    /// The matrix of the columns that this rank owns, that of others' columns, and the global numbers of the latter's; the last two are null
    /// on one rank.
    fn sequential(&self) -> Result<(sys::Mat, sys::Mat, *const i32)> {
        let (mut own, mut other, mut numbers) = (self.raw, ptr::null_mut(), ptr::null());
        if self.comm.size() > 1 {
            // SAFETY: the matrix is of the parallel type; it keeps its two parts and the numbers.
            check(unsafe { sys::MatMPIAIJGetSeqAIJ(self.raw, &mut own, &mut other, &mut numbers) })?;
        }
        Ok((own, other, numbers))
    }

    /// Lends this rank's rows: the columns that it owns, and all others. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(in crate::native) fn with_parts<T>(&self, look: impl FnOnce([Part; 2]) -> T) -> Result<T> {
        let (own, other, _) = self.sequential()?;
        with_part(own, |own| match other.is_null() {
            true => Ok(look([own, NOTHING])),
            false => with_part(other, |other| Ok(look([own, other]))),
        })
    }

    /// What brings the entries of a vector like `from` that other ranks own and this rank's rows need. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(in crate::native) fn ghosts(&self, from: &Vector) -> Result<&Gather> {
        if self.ghosts.get().is_none() {
            let gather = Gather::new(from, self.other_columns()?)?;
            return Ok(self.ghosts.get_or_init(|| gather));
        }
        Ok(self.ghosts.get().expect("looked at above"))
    }

    /// Global numbers of the columns that this rank's rows have and other ranks own. Not collective.
    fn other_columns(&self) -> Result<&[i32]> {
        let (_, other, numbers) = self.sequential()?;
        if other.is_null() {
            return Ok(&[]);
        }
        let (mut rows, mut n) = (0, 0);
        // SAFETY: there are as many numbers as columns, and the matrix keeps them.
        unsafe {
            check(sys::MatGetSize(other, &mut rows, &mut n))?;
            Ok(if n == 0 { &[] } else { std::slice::from_raw_parts(numbers, n as usize) })
        }
    }

    /// Global number of this rank's first row. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(in crate::native) fn first_row(&self) -> Result<usize> {
        let (mut first, mut end) = (0, 0);
        // SAFETY: the handle is alive.
        check(unsafe { sys::MatGetOwnershipRange(self.raw, &mut first, &mut end) })?;
        Ok(first as usize)
    }

    /// Visits the stored entries of this rank's rows: global row and column, value. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(in crate::native) fn visit_entries(&self, mut visit: impl FnMut(usize, usize, f64)) -> Result<()> {
        let (first, others) = (self.first_row()?, self.other_columns()?);
        self.with_parts(|[own, other]| {
            own.visit(|row, column, value| visit(first + row, first + column, value));
            other.visit(|row, column, value| visit(first + row, others[column] as usize, value));
        })
    }

    /// A full square matrix of `n` rows from its values by rows, on one rank.
    ///
    /// # Errors
    /// PETSc's.
    ///
    /// # Panics
    /// Where the values are not `n x n`, or the communicator has several ranks.
    pub fn dense(comm: &Comm, n: usize, values: &[f64]) -> Result<Matrix> {
        assert_eq!((values.len(), comm.size()), (n * n, 1));
        let (mut rows, columns) = (Rows::default(), (0..n as i32).collect::<Vec<_>>());
        (0..n).for_each(|_| rows.push(&columns, &[]));
        let mut matrix = Matrix::zeros(comm, rows)?;
        Matrix::change_values(&mut [&mut matrix], |all| all[0][0].copy_from_slice(values))?;
        matrix.store_dense()?;
        Ok(matrix)
    }

    /// A diagonal matrix, on one rank.
    ///
    /// # Errors
    /// PETSc's.
    ///
    /// # Panics
    /// Where the communicator has several ranks.
    pub fn diagonal(comm: &Comm, values: &[f64]) -> Result<Matrix> {
        assert_eq!(comm.size(), 1);
        let mut rows = Rows::default();
        (0..values.len() as i32).for_each(|i| rows.push(&[i], &[]));
        let mut matrix = Matrix::zeros(comm, rows)?;
        Matrix::change_values(&mut [&mut matrix], |all| all[0][0].copy_from_slice(values))?;
        Ok(matrix)
    }

    /// Stores all entries, also zeros, without column numbers: worth it where most are not zero. On one rank; on several nothing changes.
    ///
    /// # Errors
    /// PETSc's.
    pub fn store_dense(&mut self) -> Result<()> {
        if self.comm.size() > 1 {
            return Ok(());
        }
        // SAFETY: the handle is alive, and PETSc replaces what it stands for.
        check(unsafe {
            sys::MatConvert(self.raw, c"seqdense".as_ptr(), sys::MatReuse::MAT_INPLACE_MATRIX, &mut self.raw)
        })
    }

    /// Whether all entries are stored, also zeros: [`Matrix::store_dense`]. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn is_dense(&self) -> Result<bool> {
        let mut is_dense = sys::PetscBool::PETSC_FALSE;
        // SAFETY: the handle is alive and the name static.
        check(unsafe { sys::PetscObjectTypeCompare(self.raw.cast(), c"seqdense".as_ptr(), &mut is_dense) })?;
        Ok(is_dense == sys::PetscBool::PETSC_TRUE)
    }

    /// The entries by columns where they are stored densely. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn dense_values(&self) -> Result<Option<Vec<f64>>> {
        self.with_dense_values(<[f64]>::to_vec)
    }

    /// Lends the entries by columns where they are stored densely. Not collective.
    pub(in crate::native) fn with_dense_values<T>(&self, look: impl FnOnce(&[f64]) -> T) -> Result<Option<T>> {
        if !self.is_dense()? {
            return Ok(None);
        }
        let mut pointer = ptr::null();
        // SAFETY: the array is valid between Get and Restore, for `n_local` columns of as many rows.
        unsafe {
            check(sys::MatDenseGetArrayRead(self.raw, &mut pointer))?;
            let outcome = look(std::slice::from_raw_parts(pointer, self.n_local * self.n_local));
            check(sys::MatDenseRestoreArrayRead(self.raw, &mut pointer))?;
            Ok(Some(outcome))
        }
    }

    fn set_option(&self, option: sys::MatOption, on: bool) -> Result<()> {
        let flag = if on { sys::PetscBool::PETSC_TRUE } else { sys::PetscBool::PETSC_FALSE };
        // SAFETY: the handle is alive.
        check(unsafe { sys::MatSetOption(self.raw, option, flag) })
    }

    /// States that the matrix is symmetric, which halves the cost of its factor. It is not checked.
    ///
    /// # Errors
    /// PETSc's.
    pub fn declare_symmetric(&mut self) -> Result<()> {
        self.set_option(sys::MatOption::MAT_SYMMETRIC, true)
    }

    pub(in crate::native) fn raw(&self) -> sys::Mat {
        self.raw
    }

    /// The communicator.
    pub fn comm(&self) -> &Comm {
        &self.comm
    }

    /// Number of rows on this rank. Not collective.
    pub fn n_local(&self) -> usize {
        self.n_local
    }

    /// Visits the rows of this rank in their order: global number, columns and values of the stored entries. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn visit_rows(&self, mut visit: impl FnMut(usize, &[i32], &[f64])) -> Result<()> {
        let first = self.first_row()? as i32;
        for row in first..first + self.n_local as i32 {
            let (mut n, mut columns, mut values) = (0, ptr::null(), ptr::null());
            // SAFETY: the arrays have n entries between Get and Restore; they may be null where n is 0.
            unsafe {
                check(sys::MatGetRow(self.raw, row, &mut n, &mut columns, &mut values))?;
                match n {
                    0 => visit(row as usize, &[], &[]),
                    _ => visit(
                        row as usize,
                        std::slice::from_raw_parts(columns, n as usize),
                        std::slice::from_raw_parts(values, n as usize),
                    ),
                }
                check(sys::MatRestoreRow(self.raw, row, &mut n, &mut columns, &mut values))?;
            }
        }
        Ok(())
    }

    /// Number of stored entries over all ranks.
    ///
    /// # Errors
    /// PETSc's.
    pub fn n_entries(&self) -> Result<f64> {
        let mut info = sys::MatInfo::default();
        // SAFETY: `info` is plain data that PETSc fills.
        check(unsafe { sys::MatGetInfo(self.raw, sys::MatInfoType::MAT_GLOBAL_SUM, &mut info) })?;
        Ok(info.nz_used)
    }

    /// A copy with its own values.
    ///
    /// # Errors
    /// PETSc's.
    pub fn duplicate(&self) -> Result<Matrix> {
        let mut copy = self.zeros_like()?;
        copy.copy_from(self)?;
        Ok(copy)
    }

    /// `self = other` on the same pattern.
    ///
    /// # Errors
    /// PETSc's.
    pub fn copy_from(&mut self, other: &Matrix) -> Result<()> {
        // SAFETY: both handles are alive.
        check(unsafe { sys::MatCopy(other.raw, self.raw, sys::MatStructure::SAME_NONZERO_PATTERN) })
    }

    /// `self += a x`, where x's pattern lies within this one's.
    ///
    /// # Errors
    /// PETSc's.
    pub fn axpy(&mut self, a: f64, x: &Matrix) -> Result<()> {
        // SAFETY: both handles are alive and distinct.
        check(unsafe { sys::MatAXPY(self.raw, a, x.raw, sys::MatStructure::SUBSET_NONZERO_PATTERN) })
    }

    /// Adds a dense row-major block at the global `indices` (both ways). Negative indices and rows of other ranks are skipped.
    /// Not collective; [`Matrix::finish`] is.
    ///
    /// # Errors
    /// PETSc's, where an entry is outside the pattern.
    pub fn add_block(&mut self, indices: &[i32], block: &[f64]) -> Result<()> {
        debug_assert_eq!(block.len(), indices.len() * indices.len());
        let n = indices.len() as i32;
        let (i, add) = (indices.as_ptr(), sys::InsertMode::ADD_VALUES);
        // SAFETY: the arrays have n and n * n entries.
        check(unsafe { sys::MatSetValues(self.raw, n, i, n, i, block.as_ptr(), add) })
    }

    /// Ends a series of [`Matrix::add_block`].
    ///
    /// # Errors
    /// PETSc's.
    pub fn finish(&mut self) -> Result<()> {
        let last = sys::MatAssemblyType::MAT_FINAL_ASSEMBLY;
        // SAFETY: the handle is alive.
        check(unsafe { sys::MatAssemblyBegin(self.raw, last) })?;
        check(unsafe { sys::MatAssemblyEnd(self.raw, last) })
    }

    /// `y = self x`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn multiply(&self, x: &Vector, y: &mut Vector) -> Result<()> {
        // SAFETY: all handles are alive and x is not y.
        check(unsafe { sys::MatMult(self.raw, x.raw(), y.raw()) })
    }

    /// Two numbers that no other values have: another matrix, or this one after a change, has others. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn version(&self) -> Result<[i64; 2]> {
        let (mut id, mut state) = (0, 0);
        // SAFETY: the handle is alive.
        unsafe {
            check(sys::PetscObjectGetId(self.raw.cast(), &mut id))?;
            check(sys::PetscObjectStateGet(self.raw.cast(), &mut state))?;
        }
        Ok([id, state])
    }

    /// Largest absolute row sum.
    ///
    /// # Errors
    /// PETSc's.
    pub fn norm_inf(&self) -> Result<f64> {
        let mut value = 0.0;
        // SAFETY: the handle is alive.
        check(unsafe { sys::MatNorm(self.raw, sys::NormType::NORM_INFINITY, &mut value) })?;
        Ok(value)
    }
}

/// The values of a sequential matrix; none where there is no matrix.
fn values<'a>(raw: sys::Mat) -> Result<&'a mut [f64]> {
    let (mut info, mut pointer) = (sys::MatInfo::default(), ptr::null_mut());
    if raw.is_null() {
        return Ok(&mut []);
    }
    // SAFETY: PETSc's array has as many entries as the matrix, and stays where it is as long as the matrix lives.
    unsafe {
        check(sys::MatGetInfo(raw, sys::MatInfoType::MAT_LOCAL, &mut info))?;
        check(sys::MatSeqAIJGetArray(raw, &mut pointer))?;
        let array = pointer;
        check(sys::MatSeqAIJRestoreArray(raw, &mut pointer))?;
        let n = info.nz_used as usize;
        Ok(if n == 0 { &mut [] } else { std::slice::from_raw_parts_mut(array, n) })
    }
}

/// Lends a sequential matrix.
fn with_part<T>(raw: sys::Mat, look: impl FnOnce(Part) -> Result<T>) -> Result<T> {
    let (no, mut done) = (sys::PetscBool::PETSC_FALSE, sys::PetscBool::PETSC_FALSE);
    let (mut n, mut offsets, mut columns, mut values) = (0, ptr::null(), ptr::null(), ptr::null());
    // SAFETY: the arrays belong to the matrix and stay where they are until they are given back.
    unsafe {
        check(sys::MatGetRowIJ(raw, 0, no, no, &mut n, &mut offsets, &mut columns, &mut done))?;
        check(sys::MatSeqAIJGetArrayRead(raw, &mut values))?;
        let offsets_read = std::slice::from_raw_parts(offsets, n as usize + 1);
        let n_entries = offsets_read[n as usize] as usize;
        let part = match n_entries {
            0 => Part { offsets: offsets_read, ..NOTHING },
            _ => Part {
                offsets: offsets_read,
                columns: std::slice::from_raw_parts(columns, n_entries),
                values: std::slice::from_raw_parts(values, n_entries),
            },
        };
        let outcome = look(part);
        check(sys::MatSeqAIJRestoreArrayRead(raw, &mut values))?;
        check(sys::MatRestoreRowIJ(raw, 0, no, no, &mut n, &mut offsets, &mut columns, &mut done))?;
        outcome
    }
}
