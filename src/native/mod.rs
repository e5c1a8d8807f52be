//! The only `unsafe` code of this crate: owning handles on MPI, LAPACK, PETSc, SLEPc, MUMPS and METIS.
//!
//! | module | what it does |
//! |---|---|
//! | [`mpi`] | the session (MPI, PETSc and SLEPc from start to end) and the communicator |
//! | [`lapack`] | small dense matrices: products, factors, eigenvalues |
//! | [`petsc`] | vectors, distributed sparse matrices, KSP, SNES, PEP |
//! | [`direct`] | factors by MUMPS, orderings and partitions by METIS |
//! | [`block`] | blocks of vectors and the sparse kernels that multiply them |
//! | [`machine`] | memory that is left |
//!
//! Every handle holds the session through its [`Comm`], so that finalisation comes last by construction. Errors and panics inside callbacks of
//! PETSc come out of the call that runs them. Everything that takes a handle is collective over its communicator unless it says otherwise.

pub mod block;
pub mod direct;
pub mod lapack;
pub mod machine;
pub mod mpi;
pub mod petsc;

pub use block::{Block, Noise};
pub use direct::{Factor, FactorKind, FactorStats, Precision, partition};
pub use mpi::{Comm, Session, libraries};
pub use petsc::{Csr, Gather, Matrix, Rows, Vector};
