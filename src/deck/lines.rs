//! The lines of a deck and of the files that it includes: comments and blank lines left out, continued keyword lines
//! put together, each with its place.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use super::card::Card;
use super::row::Row;
use crate::model::Place;
use crate::{Error, Result};

/// Bytes of a line above which the file is taken for something else.
const LONGEST_LINE: u64 = 1 << 16;
/// Files that may include one another in a chain.
const DEEPEST_INCLUDE: usize = 32;

/// A file that is being read.
struct Source {
    reader: BufReader<File>,
    /// Its place in the list of files.
    file: u16,
    /// Lines read so far.
    line: u32,
}

/// What the current line is.
#[derive(Clone, Copy, PartialEq)]
enum Current {
    /// It has been used, or there is none yet.
    Used,
    Keyword,
    Data,
    End,
}

/// Reads a deck line by line, through its includes.
pub struct Lines {
    /// The deck, and the files it has included so far.
    pub files: Vec<PathBuf>,
    /// Lines read in all files.
    pub n_lines: usize,
    open: Vec<Source>,
    bytes: Vec<u8>,
    text: String,
    place: Place,
    current: Current,
}

impl Lines {
    /// Opens a deck.
    ///
    /// # Errors
    /// [`Error::Input`] where it cannot be read.
    pub fn open(deck: &Path) -> Result<Lines> {
        let mut lines = Lines {
            files: Vec::new(),
            n_lines: 0,
            open: Vec::new(),
            bytes: Vec::new(),
            text: String::new(),
            place: Place::default(),
            current: Current::Used,
        };
        lines.push(deck).map_err(|reason| {
            Error::input(format!(
                "{}: cannot read the deck: {reason}. Name an input file such as brake.inp",
                deck.display()
            ))
        })?;
        Ok(lines)
    }

    fn push(&mut self, path: &Path) -> std::io::Result<()> {
        let reader = BufReader::with_capacity(1 << 18, File::open(path)?);
        if path.is_dir() {
            return Err(std::io::ErrorKind::IsADirectory.into());
        }
        let file = u16::try_from(self.files.len()).map_err(|_| std::io::Error::other("too many files"))?;
        self.files.push(path.to_owned());
        self.open.push(Source { reader, file, line: 0 });
        Ok(())
    }

    /// The next keyword line; data lines before it are passed over.
    ///
    /// # Errors
    /// [`Error::Input`] with the place of a line that cannot be read.
    pub fn card(&mut self) -> Result<Option<Card>> {
        loop {
            match self.look()? {
                Current::End => return Ok(None),
                Current::Keyword => {
                    self.current = Current::Used;
                    let card = self.continued()?;
                    if card.name == "INCLUDE" {
                        self.include(&card)?;
                        continue;
                    }
                    return Ok(Some(card));
                }
                _ => self.current = Current::Used,
            }
        }
    }

    /// The next data line of the keyword; none where another keyword or the end follows.
    ///
    /// # Errors
    /// As [`Lines::card`].
    pub fn row(&mut self) -> Result<Option<Row<'_>>> {
        while self.look()? == Current::Keyword && is_include(&self.text) {
            self.current = Current::Used;
            let card = self.continued()?;
            self.include(&card)?;
        }
        if self.current != Current::Data {
            return Ok(None);
        }
        self.current = Current::Used;
        let file = &self.files[usize::from(self.place.file)];
        Ok(Some(Row { text: &self.text, place: self.place, file }))
    }

    /// An error at a place.
    pub fn error(&self, place: Place, message: impl std::fmt::Display) -> Error {
        place.error(&self.files, message)
    }

    /// Reads the next line that counts, unless it is there.
    fn look(&mut self) -> Result<Current> {
        while self.current == Current::Used {
            self.current = self.next()?;
        }
        Ok(self.current)
    }

    /// Reads a line of the innermost file; a file that ends gives way to the one that includes it.
    fn next(&mut self) -> Result<Current> {
        let Some(source) = self.open.last_mut() else { return Ok(Current::End) };
        self.bytes.clear();
        let read = std::io::Read::take(&mut source.reader, LONGEST_LINE).read_until(b'\n', &mut self.bytes);
        source.line += 1;
        self.place = Place { file: source.file, line: source.line };
        let n = read.map_err(|reason| self.place.error(&self.files, reason))?;
        if n == 0 {
            self.open.pop();
            return Ok(Current::Used);
        }
        self.n_lines += 1;
        self.check()?;
        let line = self.bytes.trim_ascii();
        if line.is_empty() || line.starts_with(b"**") {
            return Ok(Current::Used);
        }
        self.text.clear();
        self.text.push_str(&String::from_utf8_lossy(line));
        Ok(if line[0] == b'*' { Current::Keyword } else { Current::Data })
    }

    /// Refuses what is no text.
    fn check(&self) -> Result<()> {
        if self.bytes.contains(&0) {
            let what = "here is a zero byte: the file is binary. Name a text file with keywords such as *NODE";
            return Err(self.error(self.place, what));
        }
        if self.bytes.len() as u64 == LONGEST_LINE && !self.bytes.ends_with(b"\n") {
            let what =
                format!("the line has more than {LONGEST_LINE} bytes. Is this an input file of Abaqus or CalculiX?");
            return Err(self.error(self.place, what));
        }
        Ok(())
    }

    /// The keyword line with the lines that continue it: each but the last ends with a comma.
    fn continued(&mut self) -> Result<Card> {
        let (mut text, place) = (self.text.clone(), self.place);
        while text.ends_with(',') && self.look()? == Current::Data {
            self.current = Current::Used;
            text.push_str(&self.text);
        }
        Card::parse(&text, place, &self.files[usize::from(place.file)])
    }

    /// Goes on with the file that `*INCLUDE` names: relative to the deck, or to the file that names it.
    fn include(&mut self, card: &Card) -> Result<()> {
        let named = card.file_name("INPUT")?;
        let folder = |file: &Path| file.parent().unwrap_or(Path::new("")).join(&named);
        let candidates = [folder(&self.files[0]), folder(&self.files[usize::from(card.place.file)])];
        let path = candidates.iter().find(|path| path.exists()).unwrap_or(&candidates[0]).clone();
        let opens_itself = self.open.iter().any(|source| self.files[usize::from(source.file)] == path);
        if opens_itself || self.open.len() >= DEEPEST_INCLUDE {
            return Err(card.error(format_args!("{named} includes itself. Remove one *INCLUDE")));
        }
        self.push(&path).map_err(|reason| {
            card.error(format_args!("cannot read the included file {}: {reason}. Correct INPUT=", path.display()))
        })
    }
}

fn is_include(text: &str) -> bool {
    let keyword = text.split(',').next().unwrap_or_default();
    let mut letters = keyword.bytes().filter(|byte| !byte.is_ascii_whitespace());
    let mut wanted = b"*INCLUDE".iter();
    letters.all(|byte| wanted.next() == Some(&byte.to_ascii_uppercase())) && wanted.next().is_none()
}
