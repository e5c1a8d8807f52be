//! A cursor over a Gmsh file that reads numbers as text or as little-endian bytes, and knows where it is when it
//! cannot.

use crate::{Error, Result};
use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;

/// Characters of a word in a message.
const LONGEST_WORD: usize = 60;

/// The cursor.
pub struct Scan<'a> {
    file: &'a Path,
    bytes: &'a [u8],
    at: usize,
    /// Where the last thing read began, which errors are about.
    last: usize,
    /// Whether numbers are bytes.
    pub binary: bool,
    section: &'a str,
}

impl<'a> Scan<'a> {
    /// At the beginning of a file's bytes, reading text.
    pub fn new(file: &'a Path, bytes: &'a [u8]) -> Self {
        Scan { file, bytes, at: 0, last: 0, binary: false, section: "" }
    }

    /// An error at what was read last: `file:line: message`, or with the byte's offset in a binary file.
    pub fn error(&self, message: impl Display) -> Error {
        let file = self.file.display();
        if self.binary {
            return Error::Input(format!("{file}: byte {}: {message}", self.last));
        }
        let line = 1 + self.bytes[..self.last].iter().filter(|&&byte| byte == b'\n').count();
        Error::Input(format!("{file}:{line}: {message}"))
    }

    fn truncated(&mut self) -> Error {
        self.last = self.at;
        let section = self.section;
        self.error(format_args!("the file ends inside ${section}. It is truncated: write the mesh again"))
    }

    /// Goes into the next section and says its name; none at the end of the file.
    pub fn open_section(&mut self) -> Result<Option<&'a str>> {
        self.skip_space();
        self.last = self.at;
        if self.at == self.bytes.len() {
            return Ok(None);
        }
        let line = self.line()?;
        match line.strip_prefix('$') {
            Some(name) => {
                self.section = name.trim_end();
                Ok(Some(self.section))
            }
            None => Err(self.error(format_args!(
                "expected a section such as $Nodes, found {:?}. Is this a Gmsh mesh? CAD files such as STEP are meshed with \
                 Gmsh first; a deck needs no mesh file",
                line.chars().take(40).collect::<String>()
            ))),
        }
    }

    /// Leaves the section, which must end here.
    pub fn close_section(&mut self) -> Result<()> {
        self.skip_space();
        if self.at == self.bytes.len() {
            return Err(self.truncated());
        }
        self.last = self.at;
        let (section, rest) = (self.section, &self.bytes[self.at..]);
        let end = rest.strip_prefix(b"$End").and_then(|rest| rest.strip_prefix(section.as_bytes()));
        if end.is_none() {
            let what =
                format_args!("expected $End{section}: the section holds more than it announces. Write the mesh again");
            return Err(self.error(what));
        }
        self.at += 4 + section.len();
        Ok(())
    }

    /// Leaves a section that nobody reads.
    pub fn skip_section(&mut self) -> Result<()> {
        let end = format!("$End{}", self.section);
        let rest = &self.bytes[self.at..];
        match rest.windows(end.len()).position(|window| window == end.as_bytes()) {
            Some(position) => self.at += position + end.len(),
            None => return Err(self.truncated()),
        }
        Ok(())
    }

    /// The rest of the line as text.
    pub fn line(&mut self) -> Result<&'a str> {
        self.last = self.at;
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        let line = std::str::from_utf8(&rest[..end]);
        let line = line.map_err(|_| self.error("this is no text. Is this a Gmsh mesh?"))?;
        self.at += (end + 1).min(rest.len());
        Ok(line.trim_end())
    }

    /// A C `int`.
    pub fn int(&mut self) -> Result<i32> {
        if self.binary { Ok(i32::from_le_bytes(self.take()?)) } else { self.word("a whole number") }
    }

    /// A C `size_t` of 8 bytes.
    pub fn size(&mut self) -> Result<u64> {
        if self.binary { Ok(u64::from_le_bytes(self.take()?)) } else { self.word("a whole number, 0 or above") }
    }

    /// The number of things that follow, each at least one byte long: a count that cannot be is an error and not an
    /// allocation.
    pub fn count(&mut self) -> Result<usize> {
        let count = self.size()?;
        match usize::try_from(count) {
            Ok(count) if count <= self.bytes.len() - self.at => Ok(count),
            _ => Err(self.truncated()),
        }
    }

    /// A C `double`.
    pub fn double(&mut self) -> Result<f64> {
        if self.binary { Ok(f64::from_le_bytes(self.take()?)) } else { self.word("a number") }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        self.last = self.at;
        match self.bytes[self.at..].first_chunk() {
            Some(chunk) => {
                self.at += N;
                Ok(*chunk)
            }
            None => Err(self.truncated()),
        }
    }

    fn word<T: FromStr>(&mut self, expected: &str) -> Result<T> {
        self.skip_space();
        self.last = self.at;
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if end == 0 {
            return Err(self.truncated());
        }
        let word = String::from_utf8_lossy(&rest[..end]);
        let value = word.parse().map_err(|_| {
            let section = self.section;
            // A binary file may be one word.
            let found: String = word.chars().take(LONGEST_WORD).collect();
            self.error(format_args!("expected {expected} in ${section}, found {found:?}. Write the mesh again"))
        })?;
        self.at += end;
        Ok(value)
    }

    fn skip_space(&mut self) {
        let rest = &self.bytes[self.at..];
        self.at += rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
    }
}
