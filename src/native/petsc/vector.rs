//! Distributed vectors, and gathering of chosen entries.

use std::mem::ManuallyDrop;
use std::ops::Deref;
use std::ptr;

use squeal_sys as sys;

use super::error::check;
use super::{Int, int};
use crate::Result;
use crate::native::Comm;

/// A distributed vector of doubles.
pub struct Vector {
    raw: sys::Vec,
    comm: Comm,
    n_local: usize,
}

impl Drop for Vector {
    fn drop(&mut self) {
        // SAFETY: this handle owns the vector and the session is alive.
        unsafe { sys::VecDestroy(&mut self.raw) };
    }
}

/// A vector that PETSc owns, for the length of a callback.
pub(in crate::native) struct Borrowed(ManuallyDrop<Vector>);

impl Deref for Borrowed {
    type Target = Vector;
    fn deref(&self) -> &Vector {
        &self.0
    }
}

impl Borrowed {
    pub(in crate::native) fn new(raw: sys::Vec, comm: &Comm) -> Result<Borrowed> {
        let mut n_local = 0;
        // SAFETY: `raw` comes from PETSc in a callback.
        check(unsafe { sys::VecGetLocalSize(raw, &mut n_local) })?;
        Ok(Borrowed(ManuallyDrop::new(Vector { raw, comm: comm.clone(), n_local: n_local as usize })))
    }
    pub(in crate::native) fn get_mut(&mut self) -> &mut Vector {
        &mut self.0
    }
}

impl Drop for Borrowed {
    fn drop(&mut self) {
        // SAFETY: only the communicator's count is ours; the vector stays PETSc's.
        unsafe { ptr::drop_in_place(&raw mut self.0.comm) };
    }
}

impl Vector {
    /// A vector of zeros with `n_local` entries on this rank.
    ///
    /// # Errors
    /// PETSc's.
    pub fn zeros(comm: &Comm, n_local: usize) -> Result<Vector> {
        let mut raw = ptr::null_mut();
        let n = int("a vector's rows on this rank", n_local)? as Int;
        // SAFETY: sizes are consistent over the ranks by contract; PETSc sums them.
        check(unsafe { sys::VecCreateMPI(comm.raw(), n, super::DETERMINE, &mut raw) })?;
        Ok(Vector { raw, comm: comm.clone(), n_local })
    }

    /// A vector with the values that this rank holds. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn from_local(comm: &Comm, local: &[f64]) -> Result<Vector> {
        let mut vector = Vector::zeros(comm, local.len())?;
        vector.local_mut(|values| values.copy_from_slice(local))?;
        Ok(vector)
    }

    pub(in crate::native) fn raw(&self) -> sys::Vec {
        self.raw
    }

    /// The communicator.
    pub fn comm(&self) -> &Comm {
        &self.comm
    }

    /// Number of entries on this rank. Not collective.
    pub fn n_local(&self) -> usize {
        self.n_local
    }

    /// A new vector of the same layout with the same values.
    ///
    /// # Errors
    /// PETSc's.
    pub fn duplicate(&self) -> Result<Vector> {
        let mut copy = Vector::zeros(&self.comm, self.n_local)?;
        copy.copy_from(self)?;
        Ok(copy)
    }

    /// `self = other`.
    ///
    /// # Errors
    /// PETSc's, where layouts differ.
    pub fn copy_from(&mut self, other: &Vector) -> Result<()> {
        // SAFETY: both handles are alive.
        check(unsafe { sys::VecCopy(other.raw, self.raw) })
    }

    /// `self += a x`.
    ///
    /// # Errors
    /// PETSc's, where layouts differ.
    pub fn axpy(&mut self, a: f64, x: &Vector) -> Result<()> {
        // SAFETY: both handles are alive and distinct.
        check(unsafe { sys::VecAXPY(self.raw, a, x.raw) })
    }

    /// `self . x`. Collective.
    ///
    /// # Errors
    /// PETSc's, where layouts differ.
    pub fn dot(&self, x: &Vector) -> Result<f64> {
        let mut product = 0.0;
        // SAFETY: both handles are alive.
        check(unsafe { sys::VecDot(self.raw, x.raw, &mut product) })?;
        Ok(product)
    }

    /// `self *= a`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn scale(&mut self, a: f64) -> Result<()> {
        // SAFETY: the handle is alive.
        check(unsafe { sys::VecScale(self.raw, a) })
    }

    /// Euclidean norm.
    ///
    /// # Errors
    /// PETSc's.
    pub fn norm(&self) -> Result<f64> {
        let mut value = 0.0;
        // SAFETY: the handle is alive.
        check(unsafe { sys::VecNorm(self.raw, sys::NormType::NORM_2, &mut value) })?;
        Ok(value)
    }

    /// Reads this rank's entries. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn local<T>(&self, read: impl FnOnce(&[f64]) -> T) -> Result<T> {
        let mut pointer = ptr::null();
        // SAFETY: the array is valid between Get and Restore, for `n_local` entries.
        check(unsafe { sys::VecGetArrayRead(self.raw, &mut pointer) })?;
        let value =
            read(if self.n_local == 0 { &[] } else { unsafe { std::slice::from_raw_parts(pointer, self.n_local) } });
        check(unsafe { sys::VecRestoreArrayRead(self.raw, &mut pointer) })?;
        Ok(value)
    }

    /// Changes this rank's entries. Collective, as PETSc forgets cached norms.
    ///
    /// # Errors
    /// PETSc's.
    pub fn local_mut<T>(&mut self, write: impl FnOnce(&mut [f64]) -> T) -> Result<T> {
        let mut pointer = ptr::null_mut();
        // SAFETY: the array is valid and exclusive between Get and Restore, for `n_local` entries.
        check(unsafe { sys::VecGetArray(self.raw, &mut pointer) })?;
        let value = write(if self.n_local == 0 {
            &mut []
        } else {
            unsafe { std::slice::from_raw_parts_mut(pointer, self.n_local) }
        });
        check(unsafe { sys::VecRestoreArray(self.raw, &mut pointer) })?;
        Ok(value)
    }

    /// This rank's entries as a copy. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn to_vec(&self) -> Result<Vec<f64>> {
        self.local(<[f64]>::to_vec)
    }
}

/// Brings chosen entries of a distributed vector to every rank that asks for them.
pub struct Gather {
    scatter: sys::VecScatter,
    target: Vector,
}

impl Drop for Gather {
    fn drop(&mut self) {
        // SAFETY: this handle owns the scatter; `target` is dropped after.
        unsafe { sys::VecScatterDestroy(&mut self.scatter) };
    }
}

impl Gather {
    /// Prepares the gathering of the global `indices` (each rank its own list) of vectors laid out like `from`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(from: &Vector, indices: &[i32]) -> Result<Gather> {
        Gather::of(from, &indices.iter().map(|&i| i as Int).collect::<Vec<_>>())
    }

    /// The same, of PETSc's own numbers.
    pub(super) fn of(from: &Vector, indices: &[Int]) -> Result<Gather> {
        let (mut target, mut set, mut scatter) = (ptr::null_mut(), ptr::null_mut(), ptr::null_mut());
        let n = int("gathered entries", indices.len())? as Int;
        // SAFETY: PETSc copies the indices; the index set is destroyed once the scatter holds what it needs.
        unsafe {
            let own = sys::squeal_comm_self();
            check(sys::VecCreateSeq(own, n, &mut target))?;
            check(sys::ISCreateGeneral(own, n, indices.as_ptr(), sys::PetscCopyMode::PETSC_COPY_VALUES, &mut set))?;
            check(sys::VecScatterCreate(from.raw, set, target, ptr::null_mut(), &mut scatter))?;
            check(sys::ISDestroy(&mut set))?;
        }
        Ok(Gather { scatter, target: Vector { raw: target, comm: from.comm.clone(), n_local: indices.len() } })
    }

    /// The chosen entries of `from`, in the order of the indices.
    ///
    /// # Errors
    /// PETSc's.
    pub fn run<T>(&self, from: &Vector, read: impl FnOnce(&[f64]) -> T) -> Result<T> {
        let (insert, forward) = (sys::InsertMode::INSERT_VALUES, sys::ScatterMode::SCATTER_FORWARD);
        // SAFETY: all handles are alive.
        unsafe {
            check(sys::VecScatterBegin(self.scatter, from.raw, self.target.raw, insert, forward))?;
            check(sys::VecScatterEnd(self.scatter, from.raw, self.target.raw, insert, forward))?;
        }
        self.target.local(read)
    }
}
