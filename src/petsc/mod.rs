//! The only `unsafe` code of this crate: owning handles on PETSc, SLEPc, MUMPS and METIS.
//!
//! * [`Session`] starts MPI, PETSc and SLEPc and ends them; every handle holds the session through its [`Comm`], so that
//!   finalisation comes last by construction.
//! * [`Vector`], [`Matrix`] own one PETSc object each, [`Factor`] what MUMPS has of one matrix. Borrowed arrays exist only inside closures.
//! * [`nonlinear`] runs SNES, [`eigen`] runs PEP on what the caller's trait objects compute; callbacks are registered
//!   inside `solve` and forgotten when it returns. Errors and panics inside them come out of `solve`.
//! * Every call goes through one checked door (`error::check`), which turns PETSc's frames into an error.
//!
//! Everything that takes a handle is collective over its communicator unless it says otherwise.

mod block;
pub mod dense;
mod dense_factor;
pub mod eigen;
pub mod error;
mod factor;
pub mod linear;
mod matrix;
pub mod memory;
mod metis;
mod mumps;
mod noise;
pub mod nonlinear;
mod ordering;
mod pattern;
mod product;
mod session;
mod vector;

pub use block::Block;
pub use factor::{Factor, FactorKind, FactorStats};
pub use matrix::Matrix;
pub use metis::partition;
pub use mumps::Precision;
pub use noise::Noise;
pub use pattern::{Csr, Rows};
pub use session::{Comm, Session, libraries};
pub use vector::{Gather, Vector};

/// PETSc's "work it out": a macro in its headers.
const DETERMINE: i32 = -1;
/// PETSc's "choose for me".
const DEFAULT: i32 = -2;
