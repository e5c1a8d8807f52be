//! The text of a model file and where its errors are: offsets to lines, the toml crate's messages to ours.

use super::names;
use crate::{Error, Result};
use serde::de::DeserializeOwned;
use std::fmt::Display;
use std::ops::Range;
use std::path::Path;

/// A place in the file, in bytes.
pub type Span = Range<usize>;

/// The text of a model file.
#[derive(Clone, Copy)]
pub struct ModelText<'a> {
    /// The file, as messages name it.
    pub file: &'a Path,
    /// Its whole text.
    pub text: &'a str,
}

/// The form of all messages about the model file: `file:line: message`.
pub fn located(file: &Path, line: usize, message: impl Display) -> String {
    format!("{}:{line}: {message}", file.display())
}

/// The bytes of a file as text.
///
/// # Errors
/// [`Error::Input`] with the line of the first byte that is not UTF-8.
pub fn utf8<'a>(file: &Path, bytes: &'a [u8]) -> Result<&'a str> {
    std::str::from_utf8(bytes).map_err(|reason| {
        let line = 1 + bytes[..reason.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
        Error::input(located(file, line, "here is a byte that is not UTF-8. Save the file as UTF-8 text"))
    })
}

impl ModelText<'_> {
    /// Line of an offset, from 1.
    pub fn line(&self, offset: usize) -> usize {
        let before = &self.text.as_bytes()[..offset.min(self.text.len())];
        1 + before.iter().filter(|&&byte| byte == b'\n').count()
    }

    /// What stands at a place, as the user wrote it.
    pub fn text_at(&self, span: &Span) -> &str {
        self.text.get(span.clone()).unwrap_or_default()
    }

    /// An error at a place of the file.
    pub fn error(&self, span: &Span, message: impl Display) -> Error {
        Error::Input(located(self.file, self.line(span.start), message))
    }

    /// Reads the text into `T`.
    ///
    /// # Errors
    /// [`Error::Input`] for wrong syntax, unknown, doubled or missing keys, and values of the wrong type.
    pub fn deserialize<T: DeserializeOwned>(&self) -> Result<T> {
        toml::from_str(self.text).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            self.error(&span, self.translate(error.message(), &span))
        })
    }

    /// The toml crate's message in the user's terms.
    fn translate(&self, message: &str, span: &Span) -> String {
        let table = self.table_at(span.start);
        let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        if message.starts_with("unknown field") {
            let (key, known) = (quoted[0], &quoted[1..]);
            let advice = names::advice(key, known.iter().copied());
            format!("unknown key {key:?} ({table}). {advice}")
        } else if message.starts_with("missing field") {
            format!("{:?} is missing ({table}). Add {}", quoted[0], sample(quoted[0]))
        } else if message.starts_with("duplicate key") {
            let key = self.text[span.clone()].trim_matches(['[', ']']);
            format!("{key:?} is given twice ({table}). Keep one of them")
        } else if message.contains("escape") || message.contains("unicode") {
            let advice = "In double quotes \\ begins an escape. Write a path with / or in single quotes";
            format!("{} ({table}). {advice}", message.trim_end())
        } else {
            let message = message.replace("f64", "a number").replace("usize", "a whole number");
            format!("{} ({table}). Correct it; squeal example explains every key", message.trim_end())
        }
    }

    /// Header of the table that holds an offset, as it stands in the file.
    fn table_at(&self, offset: usize) -> &str {
        let end = self.text[offset..].find('\n').map_or(self.text.len(), |i| offset + i);
        let mut lines = self.text[..end].lines().rev();
        lines.find_map(header).unwrap_or("top of the file")
    }
}

/// The line's table header, if it is one (rows of arrays begin with a bracket, too, but go on with a number).
fn header(line: &str) -> Option<&str> {
    let line = line.split('#').next().unwrap_or("").trim();
    let inner = line.strip_prefix('[')?.strip_suffix(']')?;
    let name = inner.strip_prefix('[').and_then(|i| i.strip_suffix(']')).unwrap_or(inner);
    let is_name = name.starts_with(|c: char| c.is_alphabetic()) && !name.contains([',', '=']);
    is_name.then_some(line)
}

/// What a missing key would look like.
fn sample(key: &str) -> &'static str {
    match key {
        "mesh" => "[mesh] with file = \"brake.msh\" and unit = \"mm\"",
        "file" => "file = \"brake.msh\"",
        "unit" => "unit = \"mm\" (or m, cm, um, in, ft), the unit of the mesh's coordinates",
        "density" => "density in kg/m3, such as 7850",
        "material" => "material = the name of a [material.<name>]",
        "nodes" => "nodes = the name of a physical surface, curve or point",
        "axes" => "axes = \"xyz\", or those that are held",
        "part" => "part = the name of the turning part",
        "axis" => "axis = [0, 0, 1], the direction of the axis",
        "speed" => "speed in rad/s, such as 5.0",
        "slave" => "slave = the name of the pad's surface",
        "master" => "master = the name of the surface that the slave meets",
        "law" => "law = { linear = 2e13 } in N/m3, or law = \"auto\"",
        "friction" => "friction = 0.5, or 0 for none",
        "between" => "between = [\"one set\", \"other set\"]",
        "stiffness" => "stiffness = [x, y, z] in N/m",
        "on" => "on = the name of a physical surface, curve or point",
        "stability" => "[stability] with band = [0, 6000] in Hz",
        "band" => "band = [lowest, highest] in Hz",
        "contacts" => "contacts = 104, the number of reference pairs",
        _ => "it; squeal example explains every key",
    }
}
