//! Errors that a person can act on, what kind each of them is, and the exit code that follows.
//!
//! Code decides by [`Error::kind`] or by a variant's fields, never by the text, which is for people alone.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// What went wrong: where, why, and what to do about it.
///
/// ```
/// use squeal::{Error, ErrorKind};
///
/// let error = Error::input("brake.toml:12: young must be above 0, not -1");
/// assert_eq!((error.kind(), error.exit_code()), (ErrorKind::Input, 2));
/// ```
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The input (model file, mesh, command line) cannot be analysed as it stands.
    #[error("{0}")]
    Input(String),
    /// An iteration did not converge.
    #[error("{what}")]
    NotConverged {
        /// Which iteration, and what may help.
        what: String,
        /// Relative residuals of its steps; empty where the iteration has none to show.
        history: Vec<f64>,
    },
    /// A matrix to be factorised, or updated, is singular.
    #[error(
        "the matrix is singular ({found_by}): a part is unconstrained, or the load has reached a limit point. \
         `squeal check` shows free parts"
    )]
    Singular {
        /// Library or step that found it, with its code.
        found_by: String,
    },
    /// Memory is short.
    #[error(
        "too little memory: {what}. A coarser mesh, other programs closed, a higher limit or a machine with more \
         memory help"
    )]
    OutOfMemory {
        /// What needs memory, and what limits it.
        what: String,
        /// Memory that it needs, MB over all ranks, where that is known.
        needed_mb: Option<f64>,
    },
    /// LAPACK: an iteration that failed (`info` > 0), or a wrong argument (`info` < 0).
    #[error("LAPACK's {routine} failed with info = {info} on a matrix of {n_rows} rows")]
    Lapack {
        /// The routine's name.
        routine: &'static str,
        /// Its code.
        info: i32,
        /// Rows of the matrix.
        n_rows: usize,
    },
    /// PETSc or SLEPc reported an error.
    #[error("PETSc error {code}: {message}{}", lines(.frames))]
    Petsc {
        /// PETSc's code.
        code: i32,
        /// Its message.
        message: String,
        /// Functions that the error passed through, the innermost first.
        frames: Vec<Frame>,
    },
    /// MUMPS reported an error that is neither a singular matrix nor short memory.
    #[error("MUMPS's {phase} failed with INFOG(1) = {code}, INFOG(2) = {detail}: {}", mumps_meaning(*.code))]
    Mumps {
        /// Analysis, factorisation or solution.
        phase: &'static str,
        /// INFOG(1).
        code: i32,
        /// INFOG(2).
        detail: i32,
    },
    /// Another library failed, and gives a reason in words alone.
    #[error("{library}: {reason}")]
    Library {
        /// The library's name.
        library: &'static str,
        /// Its reason.
        reason: String,
    },
    /// A file could not be read or written.
    #[error("{path}: {source}", path = .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A signal has ended the work before its end.
    #[error("{text}")]
    Interrupted {
        /// Number of the signal.
        signal: i32,
        /// How far the work has come, and how it is continued.
        text: String,
    },
    /// An error of one rank that all ranks have agreed to return.
    #[error("{text}")]
    Agreed {
        /// The kind of the rank's own error.
        kind: ErrorKind,
        /// Its text.
        text: String,
    },
}

/// What kind of error it is: all that callers decide by, the same on every rank after
/// [`Comm::agree`](crate::native::Comm::agree).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ErrorKind {
    /// The user's input. Exit code 2.
    Input,
    /// An iteration did not converge. Exit code 3.
    NotConverged,
    /// A singular matrix. Exit code 1.
    Singular,
    /// Too little memory for this model. Exit code 2.
    OutOfMemory,
    /// A file. Exit code 1.
    Io,
    /// A library. Exit code 1.
    Library,
    /// A signal. Exit code 128 and the signal's number, as shells have it.
    Interrupted {
        /// Number of the signal.
        signal: i32,
    },
}

/// A function that an error of PETSc passed through.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// Name of the function.
    pub function: String,
    /// Source file.
    pub file: String,
    /// Line.
    pub line: i32,
}

impl fmt::Display for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "in {} ({}:{})", self.function, self.file, self.line)
    }
}

/// Frames, each on a line of its own.
fn lines(frames: &[Frame]) -> String {
    frames.iter().map(|frame| format!("\n    {frame}")).collect()
}

/// MUMPS's codes in words.
fn mumps_meaning(code: i32) -> &'static str {
    match code {
        _ if Error::MUMPS_WORKSPACE.contains(&code) => "its workspace was too small even after enlarging",
        -16 => "the matrix is empty",
        _ => "see MUMPS's manual, INFOG(1)",
    }
}

/// Result of everything in this crate that can fail.
pub type Result<T> = std::result::Result<T, Error>;

impl ErrorKind {
    /// Exit codes of what a signal ends begin here.
    pub const SIGNAL: i32 = 128;

    /// The process's exit code.
    pub fn exit_code(self) -> i32 {
        match self {
            ErrorKind::Input | ErrorKind::OutOfMemory => 2,
            ErrorKind::NotConverged => 3,
            ErrorKind::Singular | ErrorKind::Io | ErrorKind::Library => 1,
            ErrorKind::Interrupted { signal } => ErrorKind::SIGNAL + signal,
        }
    }
}

impl Error {
    /// MUMPS's codes of a workspace that pivoting has outgrown: a larger one may do, or pivots of higher precision.
    pub(crate) const MUMPS_WORKSPACE: [i32; 6] = [-8, -9, -11, -12, -14, -15];

    /// What kind of error it is; of an [`Error::Agreed`] the kind of the error agreed on.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Error::Input(_) => ErrorKind::Input,
            Error::NotConverged { .. } => ErrorKind::NotConverged,
            Error::Singular { .. } => ErrorKind::Singular,
            Error::OutOfMemory { .. } => ErrorKind::OutOfMemory,
            // A positive code of LAPACK's eigensolvers, its only errors that get here, counts what did not converge.
            Error::Lapack { info, .. } if *info > 0 => ErrorKind::NotConverged,
            Error::Lapack { .. } | Error::Petsc { .. } | Error::Mumps { .. } | Error::Library { .. } => {
                ErrorKind::Library
            }
            Error::Io { .. } => ErrorKind::Io,
            Error::Interrupted { signal, .. } => ErrorKind::Interrupted { signal: *signal },
            Error::Agreed { kind, .. } => *kind,
        }
    }

    /// The process's exit code.
    pub fn exit_code(&self) -> i32 {
        self.kind().exit_code()
    }

    /// Whether single precision may be the reason: a pivot that rounding has made zero, or a workspace that pivoting
    /// has outgrown.
    pub fn is_numerical(&self) -> bool {
        match self {
            Error::Mumps { code, .. } => Error::MUMPS_WORKSPACE.contains(code),
            _ => self.kind() == ErrorKind::Singular,
        }
    }

    /// Whether all ranks have it together: they agreed on it, or it is of a kind that every rank decides alike. Any
    /// other error may be one rank's alone, while the others wait for it.
    pub fn is_of_all_ranks(&self) -> bool {
        use ErrorKind::{Input, Interrupted, NotConverged, OutOfMemory};
        let is_alike = matches!(self.kind(), Input | NotConverged | OutOfMemory | Interrupted { .. });
        is_alike || matches!(self, Error::Agreed { .. })
    }

    /// Relative residuals of an iteration that did not converge, where it has any.
    pub fn history(&self) -> &[f64] {
        match self {
            Error::NotConverged { history, .. } => history,
            _ => &[],
        }
    }

    /// An input error.
    pub fn input(message: impl Into<String>) -> Self {
        Error::Input(message.into())
    }

    /// An iteration without a history of residuals.
    pub fn not_converged(what: impl Into<String>) -> Self {
        Error::NotConverged { what: what.into(), history: Vec::new() }
    }

    /// Attaches a library's name to its reason.
    pub fn library<R: fmt::Display>(library: &'static str) -> impl FnOnce(R) -> Error {
        move |reason| Error::Library { library, reason: reason.to_string() }
    }

    /// Attaches the file's path to an input/output error.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Error + '_ {
        move |source| Error::Io { path: path.to_owned(), source }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mumps(code: i32) -> Error {
        Error::Mumps { phase: "factorisation", code, detail: 0 }
    }

    #[test]
    fn exit_codes_follow_the_kind() {
        let agreed = |error: &Error| Error::Agreed { kind: error.kind(), text: error.to_string() };
        let singular = Error::Singular { found_by: "LAPACK".into() };
        let short = Error::OutOfMemory { what: "the factor".into(), needed_mb: Some(1.0) };
        let stopped = Error::Interrupted { signal: 15, text: "stopped".into() };
        let qr = |info| Error::Lapack { routine: "dsyev", info, n_rows: 3 };
        let all = [Error::input("x"), Error::not_converged("y"), singular, short, stopped, mumps(-9), qr(1), qr(-1)];
        assert_eq!(all.each_ref().map(Error::exit_code), [2, 3, 1, 2, 143, 1, 3, 1]);
        assert!(all.iter().all(|error| agreed(error).kind() == error.kind() && agreed(error).is_of_all_ranks()));
        assert_eq!(all.each_ref().map(Error::is_of_all_ranks), [true, true, false, true, true, false, true, false]);
    }

    #[test]
    fn only_pivots_and_workspace_are_numerical() {
        assert!(Error::Singular { found_by: String::new() }.is_numerical() && mumps(-9).is_numerical());
        assert!(Error::Agreed { kind: ErrorKind::Singular, text: String::new() }.is_numerical());
        let petsc = Error::Petsc { code: 76, message: String::new(), frames: Vec::new() };
        let short = Error::OutOfMemory { what: String::new(), needed_mb: None };
        for error in [mumps(-16), mumps(-53), petsc, short, Error::not_converged("")] {
            assert!(!error.is_numerical(), "{error:?}");
        }
    }

    #[test]
    fn frames_of_petsc_stand_below_its_message() {
        let frame = Frame { function: "VecNorm".into(), file: "rvector.c".into(), line: 7 };
        let error = Error::Petsc { code: 62, message: "Invalid argument".into(), frames: vec![frame] };
        assert_eq!(error.to_string(), "PETSc error 62: Invalid argument\n    in VecNorm (rvector.c:7)");
    }
}
