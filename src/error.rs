//! Errors that a person can act on, and the exit code each of them leads to.

use std::path::{Path, PathBuf};

/// What went wrong: where, why, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The input (model file, mesh, command line) cannot be analysed as it stands. Exit code 2.
    #[error("{0}")]
    Input(String),
    /// An iteration did not converge; the text tells step and history. Exit code 3.
    #[error("{0}")]
    NotConverged(String),
    /// A file could not be read or written. Exit code 1 (2 where it is the user's input).
    #[error("{path}: {source}", path = .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// PETSc, SLEPc, MUMPS or METIS reported an error. Exit code 1.
    #[error("{0}")]
    Library(String),
    /// A signal has ended the work before its end. Exit code 128 and the signal's number, as shells have it.
    #[error("{text}")]
    Interrupted {
        /// Number of the signal.
        signal: i32,
        /// How far the work has come, and how it goes on.
        text: String,
    },
    /// What all ranks know to have gone wrong on one of them, with that error's exit code.
    #[error("{text}")]
    Agreed {
        /// The exit code.
        code: i32,
        /// What the rank said.
        text: String,
    },
}

/// Result of everything in this crate that can fail.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Exit codes of what a signal ends begin here.
    pub const SIGNAL: i32 = 128;

    /// The process's exit code: 2 for input, 3 for no convergence, 128 and its number for a signal, 1 for everything else.
    pub fn exit_code(&self) -> i32 {
        match self {
            Error::Input(_) => 2,
            Error::NotConverged(_) => 3,
            Error::Io { .. } | Error::Library(_) => 1,
            Error::Interrupted { signal, .. } => Error::SIGNAL + signal,
            Error::Agreed { code, .. } => *code,
        }
    }

    /// An input error.
    pub fn input(message: impl Into<String>) -> Self {
        Error::Input(message.into())
    }

    /// Attaches the file's path to an input/output error.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Error + '_ {
        move |source| Error::Io { path: path.to_owned(), source }
    }
}
