//! Where something stands in the files of a model.

use std::fmt::Display;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::located;
use crate::Error;

/// A line of one of a model's files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Place {
    /// Index in the list of files.
    pub file: u16,
    /// Line, from 1.
    pub line: u32,
}

impl Place {
    /// `file:line: message`.
    ///
    /// # Panics
    /// Where the list does not have the file.
    pub fn error(self, files: &[PathBuf], message: impl Display) -> Error {
        Error::Input(self.message(files, message))
    }

    /// The text of [`Place::error`].
    ///
    /// # Panics
    /// Where the list does not have the file.
    pub fn message(self, files: &[PathBuf], message: impl Display) -> String {
        located(&files[usize::from(self.file)], self.line as usize, message)
    }
}
