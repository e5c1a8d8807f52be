//! PETSc and SLEPc: vectors, matrices, and what KSP, SNES and PEP solve on the caller's trait objects.
//!
//! [`Vector`] and [`Matrix`] own one PETSc object each; their arrays are lent to closures. [`linear`], [`nonlinear`]
//! and [`eigen`] register callbacks inside `solve`, which are forgotten when it returns. Every call goes through one
//! checked door, [`error`]'s `check`, but the destructors: nobody could act on their codes.

pub mod eigen;
mod entries;
pub mod error;
mod line_search;
pub mod linear;
mod matrix;
pub mod nonlinear;
mod pattern;
mod vector;

pub(in crate::native) use entries::Part;
pub use matrix::Matrix;
pub(in crate::native) use pattern::int;
pub use pattern::{Csr, Rows};
pub use vector::{Gather, Vector};

/// PETSc's integers: 32 bits, or 64 where it was configured so.
pub type Int = squeal_sys::PetscInt;

/// PETSc's code of an error in a library that it calls: a macro in its headers.
pub(in crate::native) const PETSC_ERR_LIB: i32 = 76;
/// PETSc's "work it out": a macro in its headers.
pub(in crate::native) const DETERMINE: Int = -1;
/// PETSc's "choose for me".
pub(in crate::native) const DEFAULT: Int = -2;
