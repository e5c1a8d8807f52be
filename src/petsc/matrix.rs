//! Distributed sparse matrices (AIJ).

use std::ptr;

use squeal_sys as sys;

use super::error::check;
use super::{Comm, Vector};
use crate::Result;

/// A distributed sparse matrix of doubles; each rank holds whole rows.
pub struct Matrix {
    raw: sys::Mat,
    comm: Comm,
    n_local: usize,
}

impl Drop for Matrix {
    fn drop(&mut self) {
        // SAFETY: this handle owns the matrix and the session is alive.
        unsafe { sys::MatDestroy(&mut self.raw) };
    }
}

impl Matrix {
    /// A square matrix from this rank's rows in CSR form with global column numbers, sorted within each row.
    ///
    /// # Errors
    /// PETSc's.
    pub fn from_csr(comm: &Comm, offsets: &[i32], columns: &[i32], values: &[f64]) -> Result<Matrix> {
        let n_local = offsets.len() as i32 - 1;
        let mut raw = ptr::null_mut();
        // SAFETY: PETSc copies the three arrays; of the two preallocations the one that fits the type acts.
        unsafe {
            check(sys::MatCreate(comm.raw(), &mut raw))?;
            check(sys::MatSetSizes(raw, n_local, n_local, super::DETERMINE, super::DETERMINE))?;
            check(sys::MatSetType(raw, c"aij".as_ptr()))?;
            let (i, j, v) = (offsets.as_ptr(), columns.as_ptr(), values.as_ptr());
            check(sys::MatSeqAIJSetPreallocationCSR(raw, i, j, v))?;
            check(sys::MatMPIAIJSetPreallocationCSR(raw, i, j, v))?;
        }
        let matrix = Matrix { raw, comm: comm.clone(), n_local: n_local as usize };
        matrix.set_option(sys::MatOption::MAT_IGNORE_OFF_PROC_ENTRIES, true)?;
        matrix.set_option(sys::MatOption::MAT_NEW_NONZERO_LOCATION_ERR, true)?;
        Ok(matrix)
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
        let offsets: Vec<i32> = (0..=n).map(|i| (i * n) as i32).collect();
        let columns: Vec<i32> = (0..n).flat_map(|_| 0..n as i32).collect();
        Matrix::from_csr(comm, &offsets, &columns, values)
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

    pub(super) fn raw(&self) -> sys::Mat {
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
        let mut raw = ptr::null_mut();
        // SAFETY: the handle is alive.
        check(unsafe { sys::MatDuplicate(self.raw, sys::MatDuplicateOption::MAT_COPY_VALUES, &mut raw) })?;
        let copy = Matrix { raw, comm: self.comm.clone(), n_local: self.n_local };
        copy.set_option(sys::MatOption::MAT_IGNORE_OFF_PROC_ENTRIES, true)?;
        copy.set_option(sys::MatOption::MAT_NEW_NONZERO_LOCATION_ERR, true)?;
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
