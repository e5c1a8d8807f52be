//! The entries of a matrix: lent to closures, never longer.

use std::marker::PhantomData;
use std::ptr;

use squeal_sys as sys;

use super::error::check;
use super::{Int, Matrix};
use crate::Result;

/// Some columns of this rank's rows, compressed by rows.
#[derive(Clone, Copy)]
pub(in crate::native) struct Part<'a> {
    /// Where each row starts, and the end of the last.
    pub offsets: &'a [Int],
    /// Columns, counted within the part.
    pub columns: &'a [Int],
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

/// The values of a sequential matrix, from PETSc's Get to its Restore; none where there is no matrix.
struct Lent<'a> {
    raw: sys::Mat,
    array: *mut f64,
    n: usize,
    matrix: PhantomData<&'a mut Matrix>,
}

impl Lent<'_> {
    fn new(raw: sys::Mat) -> Result<Self> {
        let mut lent = Lent { raw, array: ptr::null_mut(), n: 0, matrix: PhantomData };
        if raw.is_null() {
            return Ok(lent);
        }
        let mut info = sys::MatInfo::default();
        // SAFETY: the matrix is alive, sequential, and lent to none but this.
        unsafe {
            check(sys::MatGetInfo(raw, sys::MatInfoType::MAT_LOCAL, &mut info))?;
            check(sys::MatSeqAIJGetArray(raw, &mut lent.array))?;
        }
        lent.n = info.nz_used as usize;
        Ok(lent)
    }

    fn values(&mut self) -> &mut [f64] {
        match self.n {
            0 => &mut [],
            // SAFETY: the array has as many values as the matrix entries, until it is given back.
            n => unsafe { std::slice::from_raw_parts_mut(self.array, n) },
        }
    }
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        if !self.raw.is_null() && !self.array.is_null() {
            // SAFETY: the array is this matrix's, and is given back once.
            unsafe { sys::MatSeqAIJRestoreArray(self.raw, &mut self.array) };
        }
    }
}

impl Matrix {
    /// Changes the values of several matrices: `change` has for each those in columns of this rank and those in all
    /// others, in the order of the [`Rows`](super::Rows) that it was made of.
    ///
    /// # Errors
    /// PETSc's.
    pub fn change_values(matrices: &mut [&mut Matrix], change: impl FnOnce(&mut [[&mut [f64]; 2]])) -> Result<()> {
        let mut lent = Vec::new();
        for matrix in matrices.iter_mut() {
            lent.push(matrix.lend()?);
        }
        let mut values: Vec<_> = lent.iter_mut().map(|parts| parts.each_mut().map(Lent::values)).collect();
        change(&mut values);
        drop(lent);
        matrices.iter_mut().try_for_each(|matrix| matrix.finish())
    }

    /// The values of the one or two sequential matrices behind this one.
    fn lend(&mut self) -> Result<[Lent<'_>; 2]> {
        let (own, other, _) = self.sequential()?;
        Ok([Lent::new(own)?, Lent::new(other)?])
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

    /// Visits the rows of this rank in their order: global number, columns and values of the stored entries. Not
    /// collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn visit_rows(&self, mut visit: impl FnMut(usize, &[Int], &[f64])) -> Result<()> {
        let (first, raw) = (self.first_row()? as Int, self.raw());
        for row in first..first + self.n_local() as Int {
            let (mut n, mut columns, mut values) = (0, ptr::null(), ptr::null());
            // SAFETY: the arrays have n entries between Get and Restore; they may be null where n is 0.
            unsafe {
                check(sys::MatGetRow(raw, row, &mut n, &mut columns, &mut values))?;
                match n {
                    0 => visit(row as usize, &[], &[]),
                    _ => visit(
                        row as usize,
                        std::slice::from_raw_parts(columns, n as usize),
                        std::slice::from_raw_parts(values, n as usize),
                    ),
                }
                check(sys::MatRestoreRow(raw, row, &mut n, &mut columns, &mut values))?;
            }
        }
        Ok(())
    }

    /// The entries by columns where they are stored densely. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn dense_values(&self) -> Result<Option<Vec<f64>>> {
        self.with_dense_values(<[f64]>::to_vec)
    }

    /// Changes the entries by columns of a matrix that is stored densely. Not collective.
    ///
    /// # Errors
    /// PETSc's, where it is not.
    pub fn change_dense_values(&mut self, change: impl FnOnce(&mut [f64])) -> Result<()> {
        let mut pointer = ptr::null_mut();
        // SAFETY: the array is valid between Get and Restore, for `n_local` columns of as many rows.
        unsafe {
            check(sys::MatDenseGetArray(self.raw(), &mut pointer))?;
            change(std::slice::from_raw_parts_mut(pointer, self.n_local() * self.n_local()));
            check(sys::MatDenseRestoreArray(self.raw(), &mut pointer))
        }
    }

    /// Lends the entries by columns where they are stored densely. Not collective.
    pub(in crate::native) fn with_dense_values<T>(&self, look: impl FnOnce(&[f64]) -> T) -> Result<Option<T>> {
        if !self.is_dense()? {
            return Ok(None);
        }
        let mut pointer = ptr::null();
        // SAFETY: the array is valid between Get and Restore, for `n_local` columns of as many rows.
        unsafe {
            check(sys::MatDenseGetArrayRead(self.raw(), &mut pointer))?;
            let outcome = look(std::slice::from_raw_parts(pointer, self.n_local() * self.n_local()));
            check(sys::MatDenseRestoreArrayRead(self.raw(), &mut pointer))?;
            Ok(Some(outcome))
        }
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
