//! The only `unsafe` code of this crate: owning handles on MPI, LAPACK, PETSc, SLEPc, MUMPS and METIS, and the
//! [`Allocator`].
//!
//! | module | what it does |
//! |---|---|
//! | [`mpi`] | the session (MPI, PETSc and SLEPc from start to end) and the communicator |
//! | [`lapack`] | small dense matrices: products, factors, eigenvalues |
//! | [`petsc`] | vectors, distributed sparse matrices, KSP, SNES, PEP |
//! | [`direct`] | factors by MUMPS, orderings and partitions by METIS |
//! | [`block`] | blocks of vectors and the sparse kernels that multiply them |
//! | [`machine`] | memory that is left |
//! | [`blas`] | the kernels of OpenBLAS |
//! | [`signals`] | SIGINT and SIGTERM, received by one thread |
//!
//! Every handle holds the session through its [`Comm`], so that finalisation comes last by construction; there is one
//! session at a time. Every code that a library returns is looked at: PETSc's and SLEPc's by `petsc::error::check`,
//! MPI's by [`Comm`], those of LAPACK, MUMPS and METIS where they are called. Destructors alone discard theirs. Errors
//! and panics inside callbacks of PETSc come out of the call that runs them. Everything that takes a handle is
//! collective over its communicator unless it says otherwise.

mod allocator;
pub mod blas;
pub mod block;
pub mod direct;
pub mod lapack;
pub mod machine;
mod mck;
pub mod mpi;
pub mod petsc;
pub mod signals;

pub use allocator::Allocator;
pub use block::{Block, Noise, Orthonormal};
pub use direct::{Factor, FactorKind, FactorStats, Lists, Precision, partition};
pub use mck::Mck;
pub use mpi::{Comm, MaxLoc, Session, all_libraries, libraries, unused_options};
pub use petsc::{Csr, Gather, Matrix, Rows, Vector};

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    fn text_of(folder: &Path) -> String {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        entries.map(|path| if path.is_dir() { text_of(&path) } else { fs::read_to_string(path).unwrap() }).collect()
    }

    #[test]
    fn every_function_that_is_bound_is_called() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let text = text_of(&root.join("src/native"));
        let names = fs::read_to_string(root.join("sys/functions.txt")).unwrap();
        let is_called = |name: &str| {
            let mut after = text.match_indices(name).map(|(at, _)| (&text[..at], &text[at + name.len()..]));
            after.any(|(before, after)| {
                // In the table of `datum.rs` the names stand alone.
                (before.ends_with("sys::") || before.ends_with("=> "))
                    && !after.starts_with(|c: char| c.is_alphanumeric() || c == '_')
            })
        };
        let unused: Vec<&str> = names.lines().filter(|name| !is_called(name)).collect();
        assert!(unused.is_empty(), "bound and not called: {unused:?}");
    }
}
