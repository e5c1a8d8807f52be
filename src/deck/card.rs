//! A keyword line: its name and its parameters.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use crate::model::{Place, located, names};
use crate::{Error, Result};

/// A parameter of a keyword line.
#[derive(Debug, Clone, PartialEq)]
struct Parameter {
    /// Capital letters, without blanks.
    name: String,
    /// What follows the equals sign, without quotes and, unless quoted, without blanks; the case is kept.
    value: Option<String>,
}

/// A keyword line.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// The keyword in capital letters, without asterisk and blanks: `SOLIDSECTION`.
    pub name: String,
    /// The keyword as it stands in the file, with its asterisk.
    pub spelled: String,
    /// Where it stands.
    pub place: Place,
    parameters: Vec<Parameter>,
    file: PathBuf,
}

impl Card {
    /// Reads a keyword line, in any case and with any blanks.
    ///
    /// # Errors
    /// [`Error::Input`] where it has no keyword, a parameter twice, or a quote without its end.
    pub fn parse(text: &str, place: Place, file: &Path) -> Result<Card> {
        let fields = quoted_fields(text);
        let spelled = fields.first().map_or("", |field| field.trim()).to_owned();
        let name = plain(spelled.trim_start_matches('*')).to_ascii_uppercase();
        let mut card = Card { name, spelled, place, parameters: Vec::new(), file: file.to_owned() };
        if card.name.is_empty() {
            return Err(card.error("an asterisk without a keyword. Comments begin with two asterisks"));
        }
        if text.matches('"').count() % 2 == 1 {
            return Err(card.error("a quotation mark without its end"));
        }
        for field in fields.iter().skip(1).filter(|field| !field.trim().is_empty()) {
            let parameter = parameter(field);
            if card.parameters.iter().any(|other| other.name == parameter.name) {
                return Err(card.error(format_args!("the parameter {} is there twice. Keep one", parameter.name)));
            }
            card.parameters.push(parameter);
        }
        Ok(card)
    }

    /// Whether a parameter is there, with or without a value.
    pub fn has(&self, name: &str) -> bool {
        self.parameters.iter().any(|parameter| parameter.name == name)
    }

    /// Names of all parameters.
    pub fn parameters(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().map(|parameter| parameter.name.as_str())
    }

    /// The value of a parameter as it is spelled; none where it is missing or has no value.
    pub fn value(&self, name: &str) -> Option<&str> {
        let parameter = self.parameters.iter().find(|parameter| parameter.name == name)?;
        parameter.value.as_deref().filter(|value| !value.is_empty())
    }

    /// The value of a parameter in capital letters.
    pub fn word(&self, name: &str) -> Option<String> {
        self.value(name).map(str::to_uppercase)
    }

    /// The value of a parameter that must be there.
    ///
    /// # Errors
    /// [`Error::Input`] where it is missing.
    pub fn required(&self, name: &str) -> Result<&str> {
        self.value(name).ok_or_else(|| self.error(format_args!("{name}= is missing ({})", self.spelled)))
    }

    /// The name of a file: all that follows the equals sign.
    ///
    /// # Errors
    /// [`Error::Input`] where it is missing.
    pub fn file_name(&self, name: &str) -> Result<String> {
        self.required(name).map(str::to_owned)
    }

    /// A number as value of a parameter; none where the parameter is missing.
    ///
    /// # Errors
    /// [`Error::Input`] where it is no finite number.
    pub fn number(&self, name: &str) -> Result<Option<f64>> {
        let Some(text) = self.value(name) else { return Ok(None) };
        match super::row::real(text) {
            Some(value) => Ok(Some(value)),
            None => Err(self.error(format_args!("{name}={text} is no number ({})", self.spelled))),
        }
    }

    /// One of a list of words as value of a parameter, by its index; the first where the parameter is missing.
    ///
    /// # Errors
    /// [`Error::Input`] for any other word.
    pub fn choice(&self, name: &str, words: &[&str]) -> Result<usize> {
        let Some(word) = self.word(name) else { return Ok(0) };
        words.iter().position(|known| *known == word).ok_or_else(|| {
            let advice = names::advice(&word, words.iter().copied());
            self.error(format_args!("{name}={word} is not supported ({}). {advice}", self.spelled))
        })
    }

    /// `file:line: message`.
    pub fn error(&self, message: impl Display) -> Error {
        Error::Input(located(&self.file, self.place.line as usize, message))
    }
}

fn parameter(field: &str) -> Parameter {
    let (name, value) = match field.split_once('=') {
        Some((name, value)) => (name, Some(value)),
        None => (field, None),
    };
    Parameter { name: plain(name).to_ascii_uppercase(), value: value.map(label) }
}

/// A name or value: what stands between quotes as it is, anything else without its blanks.
pub fn label(text: &str) -> String {
    match text.contains('"') {
        true => text.trim().replace('"', ""),
        false => plain(text),
    }
}

fn plain(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

/// Splits at commas outside quotes.
fn quoted_fields(text: &str) -> Vec<&str> {
    let mut inside = false;
    let is_end = |c: char| {
        inside ^= c == '"';
        c == ',' && !inside
    };
    text.split(is_end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn card(text: &str) -> Result<Card> {
        Card::parse(text, Place { file: 0, line: 3 }, Path::new("brake.inp"))
    }

    #[test]
    fn case_blanks_and_order_of_parameters_do_not_matter() {
        let one = card("*Solid Section, ELSET=disc, Material=Iron").unwrap();
        let two = card("* SOLIDSECTION ,material = I ron,  elset= disc ,").unwrap();
        for card in [&one, &two] {
            assert_eq!(card.name, "SOLIDSECTION");
            assert_eq!((card.value("ELSET"), card.value("MATERIAL")), (Some("disc"), Some("Iron")));
        }
        assert_eq!(two.word("MATERIAL").as_deref(), Some("IRON"));
        assert!(one.has("ELSET") && !one.has("NAME") && one.value("NAME").is_none());
    }

    #[test]
    fn quotes_keep_blanks_and_commas() {
        let card = card("*SURFACE, NAME=\"pad, inner face\", TYPE=ELEMENT").unwrap();
        assert_eq!(card.value("NAME"), Some("pad, inner face"));
        assert_eq!(card.choice("TYPE", &["ELEMENT", "NODE"]).unwrap(), 0);
    }

    #[test]
    fn what_is_wrong_has_its_place() {
        let refused = |text: &str| card(text).unwrap_err().to_string();
        assert!(refused("*").starts_with("brake.inp:3: an asterisk without a keyword"));
        assert!(refused("*NSET, NSET=A, nset=B").contains("the parameter NSET is there twice"));
        assert!(refused("*NSET, NSET=\"A").contains("quotation mark"));
        let surface = card("*SURFACE, TYPE=CUTTING").unwrap();
        assert!(surface.required("NAME").unwrap_err().to_string().contains("NAME= is missing (*SURFACE)"));
        let message = surface.choice("TYPE", &["ELEMENT", "NODE"]).unwrap_err().to_string();
        assert!(message.contains("TYPE=CUTTING is not supported") && message.contains("ELEMENT, NODE"), "{message}");
        assert!(card("*CONTACT PAIR, ADJUST=no").unwrap().number("ADJUST").is_err());
    }
}
