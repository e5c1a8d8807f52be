//! Files of matrices as bytes and lines: gzip is undone, and every line has its number.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use flate2::bufread::MultiGzDecoder;

use crate::{Error, Result};

/// What gzip files begin with (RFC 1952).
const GZIP: [u8; 2] = [0x1f, 0x8b];
/// Bytes by which a format is recognised.
const HEAD: usize = 16;
/// Read at a time.
const BUFFER: usize = 1 << 18;

/// An open file, its compression undone.
pub struct MatrixFile {
    path: PathBuf,
    head: Vec<u8>,
    reader: Box<dyn BufRead>,
}

impl MatrixFile {
    /// Opens a file, and undoes gzip.
    ///
    /// # Errors
    /// [`Error::Input`] where it cannot be read.
    pub fn open(path: &Path) -> Result<MatrixFile> {
        let fail = |reason: io::Error| Error::input(format!("{}: {}", path.display(), in_words(&reason)));
        let mut raw = BufReader::with_capacity(BUFFER, File::open(path).map_err(fail)?);
        let is_gzip = raw.fill_buf().map_err(fail)?.starts_with(&GZIP);
        let mut reader: Box<dyn BufRead> = match is_gzip {
            true => Box::new(BufReader::with_capacity(BUFFER, MultiGzDecoder::new(raw))),
            false => Box::new(raw),
        };
        let mut head = Vec::new();
        reader.by_ref().take(HEAD as u64).read_to_end(&mut head).map_err(fail)?;
        Ok(MatrixFile { path: path.to_owned(), reader: Box::new(Cursor::new(head.clone()).chain(reader)), head })
    }

    /// The first bytes.
    pub fn head(&self) -> &[u8] {
        &self.head
    }

    /// The file as messages name it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Fills the whole of a buffer.
    ///
    /// # Errors
    /// [`Error::Input`] where the file ends before, or cannot be read.
    pub fn fill(&mut self, buffer: &mut [u8]) -> Result<()> {
        self.reader
            .read_exact(buffer)
            .map_err(|reason| Error::input(format!("{}: {}", self.path.display(), in_words(&reason))))
    }

    /// Whether nothing is left.
    ///
    /// # Errors
    /// [`Error::Input`] where the file cannot be read.
    pub fn is_at_end(&mut self) -> Result<bool> {
        let rest = self.reader.fill_buf();
        rest.map(<[u8]>::is_empty)
            .map_err(|reason| Error::input(format!("{}: {}", self.path.display(), in_words(&reason))))
    }
}

/// The system's reason, for people.
fn in_words(reason: &io::Error) -> String {
    match reason.kind() {
        io::ErrorKind::UnexpectedEof => "the file is cut off: it ends before its data do. Copy it again".into(),
        io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData => {
            format!("the compressed data are damaged ({reason}). Copy the file again")
        }
        _ => format!("cannot be read: {reason}"),
    }
}

/// A text file line by line.
pub struct Lines {
    source: MatrixFile,
    line: Vec<u8>,
    number: usize,
}

impl Lines {
    /// The lines of an open file.
    pub fn new(source: MatrixFile) -> Lines {
        Lines { source, line: Vec::new(), number: 0 }
    }

    /// Goes to the next line; false at the end.
    ///
    /// # Errors
    /// [`Error::Input`] where the file cannot be read, or the line is no text.
    pub fn advance(&mut self) -> Result<bool> {
        self.line.clear();
        self.number += 1;
        let n = self.source.reader.read_until(b'\n', &mut self.line).map_err(|reason| self.error(in_words(&reason)))?;
        match std::str::from_utf8(&self.line) {
            Ok(_) => Ok(n > 0),
            Err(_) => {
                Err(self.error("here are bytes that are no text. Give a matrix as text, gzipped text or PETSc binary"))
            }
        }
    }

    /// The line, without the white space around it.
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.line).expect("checked when it was read").trim()
    }

    /// An error at this line.
    pub fn error(&self, message: impl Display) -> Error {
        Error::input(format!("{}:{}: {message}", self.source.path.display(), self.number))
    }

    /// A finite number; Fortran's exponents (1.0D+3) too.
    ///
    /// # Errors
    /// [`Error::Input`] for anything else.
    pub fn number(&self, text: &str) -> Result<f64> {
        let value = text.parse::<f64>().or_else(|_| text.replace(['D', 'd'], "e").parse());
        match value {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(self.error(format!("{text} is no finite number"))),
            Err(_) => Err(self.error(format!("{text:?} is no number"))),
        }
    }

    /// A whole number.
    ///
    /// # Errors
    /// [`Error::Input`] for anything else.
    pub fn whole(&self, text: &str) -> Result<i64> {
        text.parse().map_err(|_| self.error(format!("{text:?} is no whole number")))
    }
}
