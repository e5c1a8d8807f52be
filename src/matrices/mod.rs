//! Matrices from files and into files: the quadratic eigenproblem `(lambda^2 M + lambda C + K + i G) x = 0` of any
//! program.
//!
//! ```text
//! files --read--> Entries --CombinedTerms--> one numbering, pattern, scaling --distribute--> M, C, K, G on all ranks
//! ```
//!
//! [`read`] recognises a format by its content: Matrix Market, PETSc binary, Abaqus's and CalculiX's text, each also
//! gzipped. Every matrix is a sum `A(p) = sum_i f_i(p) A_i` of files with expressions of one parameter ([`family`]); a
//! single file is the sum with one term.
//!
//! [`CombinedTerms`] puts the files together on the root: rows that have names (nodes and degrees of freedom) are
//! matched by them, constrained ones are left out, and the whole is scaled: `D P(lambda) D`, D diagonal, has the same
//! eigenvalues, and its entries are of one size also where metres meet radians. The entries of D are powers of two, so
//! that scaling rounds nothing.

mod abaqus;
mod combined;
mod distribute;
mod entries;
pub mod family;
mod lines;
mod market;
mod petsc_binary;
mod sparse;
pub mod write;

pub use combined::{CombinedTerms, Names, Term};
pub use distribute::{ExternalMatrices, Sums, Symmetry};
pub use entries::{Dof, Entries, Naming, Storage};

use std::path::Path;

use crate::Result;
use lines::{Lines, MatrixFile};

/// Which of the four matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// M.
    Mass,
    /// C.
    Damping,
    /// K.
    Stiffness,
    /// G, the imaginary part of the stiffness.
    Structural,
}

impl Role {
    /// All of them, in the order M, C, K, G.
    pub const ALL: [Role; 4] = [Role::Mass, Role::Damping, Role::Stiffness, Role::Structural];

    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Role::Mass => "mass",
            Role::Damping => "damping",
            Role::Stiffness => "stiffness",
            Role::Structural => "structural damping",
        }
    }
}

/// Reads a square real matrix; of a substructure's file that of this role.
///
/// # Errors
/// [`crate::Error::Input`] with file and line, whatever is wrong.
pub fn read(path: &Path, role: Role) -> Result<Entries> {
    let source = MatrixFile::open(path)?;
    if let Some(width) = petsc_binary::index_width(source.head()) {
        return petsc_binary::read(source, width);
    }
    let mut lines = Lines::new(source);
    while lines.advance()? {
        if lines.text().to_lowercase().starts_with(market::BANNER) {
            return market::read(&mut lines);
        }
        if lines.text().to_lowercase().starts_with(&market::BANNER[1..]) {
            return Err(lines.error("the header of a Matrix Market file begins with two percent signs: %%MatrixMarket"));
        }
        if !lines.text().is_empty() {
            return abaqus::read(&mut lines, role);
        }
    }
    Err(lines.error("the file is empty"))
}
