//! Distributed sparse matrices (AIJ).

use std::cell::OnceCell;
use std::ptr;

use squeal_sys as sys;

use super::error::check;
use super::{Gather, Int, Rows, Vector};
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
    /// [`Error::Input`](crate::Error::Input) where there are more rows, or entries on a rank, than PETSc's 32-bit
    /// numbers count; PETSc's.
    pub fn zeros(comm: &Comm, mut rows: Rows) -> Result<Matrix> {
        let n_rows = comm.sum(rows.n_rows());
        comm.agree(rows.check(n_rows))?;
        let n = rows.n_rows() as Int;
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

    /// The matrix of the columns that this rank owns, that of others' columns, and the global numbers of the latter's;
    /// the last two are null on one rank.
    pub(super) fn sequential(&self) -> Result<(sys::Mat, sys::Mat, *const Int)> {
        let (mut own, mut other, mut numbers) = (self.raw, ptr::null_mut(), ptr::null());
        if self.comm.size() > 1 {
            // SAFETY: the matrix is of the parallel type; it keeps its two parts and the numbers.
            check(unsafe { sys::MatMPIAIJGetSeqAIJ(self.raw, &mut own, &mut other, &mut numbers) })?;
        }
        Ok((own, other, numbers))
    }

    /// What brings the entries of a vector like `from` that other ranks own and this rank's rows need. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(in crate::native) fn ghosts(&self, from: &Vector) -> Result<&Gather> {
        if self.ghosts.get().is_none() {
            let gather = Gather::of(from, self.other_columns()?)?;
            return Ok(self.ghosts.get_or_init(|| gather));
        }
        Ok(self.ghosts.get().expect("looked at above"))
    }

    /// Global numbers of the columns that this rank's rows have and other ranks own. Not collective.
    pub(super) fn other_columns(&self) -> Result<&[Int]> {
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

    /// Stores all entries, also zeros, without column numbers: worth it where most are not zero. On one rank; on
    /// several nothing changes.
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

    /// Adds a dense row-major block at the global `indices` (both ways). Negative indices and rows of other ranks are
    /// skipped. Not collective; [`Matrix::finish`] is.
    ///
    /// # Errors
    /// PETSc's, where an entry is outside the pattern.
    pub fn add_block(&mut self, indices: &[i32], block: &[f64]) -> Result<()> {
        debug_assert_eq!(block.len(), indices.len() * indices.len());
        let indices: Vec<Int> = indices.iter().map(|&i| i as Int).collect();
        let n = indices.len() as Int;
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

    /// `y = self^T x`.
    ///
    /// # Errors
    /// PETSc's.
    pub(in crate::native) fn multiply_transpose(&self, x: &Vector, y: &mut Vector) -> Result<()> {
        // SAFETY: all handles are alive and x is not y.
        check(unsafe { sys::MatMultTranspose(self.raw, x.raw(), y.raw()) })
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
