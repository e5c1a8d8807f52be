//! A data line: fields between commas.

use std::fmt::Display;
use std::path::Path;

use super::card::label;
use crate::model::{Place, located};
use crate::{Error, Result};

/// A data line of a deck.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    /// Its text without blanks at its ends.
    pub text: &'a str,
    /// Where it stands.
    pub place: Place,
    /// The file that it stands in.
    pub file: &'a Path,
}

impl<'a> Row<'a> {
    /// The fields without blanks at their ends; a comma at the end of the line begins no field.
    pub fn fields(&self) -> impl Iterator<Item = &'a str> + Clone + use<'a> {
        self.text.strip_suffix(',').unwrap_or(self.text).split(',').map(str::trim)
    }

    /// A field; empty where the line has fewer.
    pub fn field(&self, i: usize) -> &'a str {
        self.fields().nth(i).unwrap_or_default()
    }

    /// Whether the line goes on: it ends with a comma.
    pub fn is_continued(&self) -> bool {
        self.text.ends_with(',')
    }

    /// A name in the field, which must not be empty; its case is kept.
    ///
    /// # Errors
    /// [`Error::Input`] where the field is empty.
    pub fn name(&self, i: usize, what: &str) -> Result<String> {
        match label(self.field(i)) {
            name if name.is_empty() => Err(self.error(format_args!("{what} is missing"))),
            name => Ok(name),
        }
    }

    /// A finite number in the field.
    ///
    /// # Errors
    /// [`Error::Input`] where there is none.
    pub fn real(&self, i: usize, what: &str) -> Result<f64> {
        match self.field(i) {
            "" => Err(self.error(format_args!("{what} is missing"))),
            text => real(text).ok_or_else(|| self.error(format_args!("{what} is {text:?}, not a number"))),
        }
    }

    /// A number in the field, or what stands for an empty field.
    ///
    /// # Errors
    /// [`Error::Input`] for anything but a number or nothing.
    pub fn real_or(&self, i: usize, default: f64, what: &str) -> Result<f64> {
        if self.field(i).is_empty() { Ok(default) } else { self.real(i, what) }
    }

    /// Numbers from a field on; empty fields are 0.
    ///
    /// # Errors
    /// [`Error::Input`] for anything but numbers.
    pub fn reals<const N: usize>(&self, first: usize, what: &str) -> Result<[f64; N]> {
        let mut values = [0.0; N];
        for (i, value) in values.iter_mut().enumerate() {
            *value = self.real_or(first + i, 0.0, what)?;
        }
        Ok(values)
    }

    /// The number of a node or element in a text.
    ///
    /// # Errors
    /// [`Error::Input`] for anything but a whole number from 1.
    pub fn number(&self, text: &str, what: &str) -> Result<u32> {
        number(text).ok_or_else(|| match text {
            "" => self.error(format_args!("{what} is missing")),
            _ => self.error(format_args!("{what} is {text:?}, not a whole number from 1 to {}", u32::MAX)),
        })
    }

    /// `file:line: message`.
    pub fn error(&self, message: impl Display) -> Error {
        Error::Input(located(self.file, self.place.line as usize, message))
    }
}

/// A finite number, with the exponents of Fortran, too.
pub fn real(text: &str) -> Option<f64> {
    let value: f64 = match text.parse() {
        Ok(value) => value,
        Err(_) => text.replace(['d', 'D'], "e").parse().ok()?,
    };
    value.is_finite().then_some(value)
}

/// The number of a node or element.
pub fn number(text: &str) -> Option<u32> {
    text.parse().ok().filter(|&number| number > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(text: &str) -> Row<'_> {
        Row { text, place: Place { file: 0, line: 7 }, file: Path::new("a.inp") }
    }

    #[test]
    fn empty_fields_are_zero_and_a_last_comma_continues() {
        assert_eq!(row("1, 2.5D-3,, 4").reals::<4>(1, "x").unwrap(), [2.5e-3, 0.0, 4.0, 0.0]);
        assert_eq!(row("1,2,").fields().collect::<Vec<_>>(), ["1", "2"]);
        assert!(row("1,2,").is_continued() && !row("1,2").is_continued());
        assert_eq!(row("EALL, P3, 1.").real_or(5, 7.0, "x").unwrap(), 7.0);
        assert_eq!(row(" my set , S1").name(0, "set").unwrap(), "myset");
    }

    #[test]
    fn numbers_are_numbers() {
        assert_eq!(
            [real("1e3"), real("1.D+3"), real("nan"), real("1e999"), real("x")],
            [Some(1e3), Some(1e3), None, None, None]
        );
        assert_eq!(
            [number("12"), number("0"), number("-1"), number("1.5"), number("5000000000")],
            [Some(12), None, None, None, None]
        );
        let message = row("1,x").real(1, "the friction coefficient").unwrap_err().to_string();
        assert_eq!(message, "a.inp:7: the friction coefficient is \"x\", not a number");
        assert!(row("1").real(1, "y").unwrap_err().to_string().ends_with("y is missing"));
    }
}
