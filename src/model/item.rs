//! One table of the model file while its values are checked: what it is called in messages, and the checks of single
//! values.

use super::keys::Text;
use super::source::{ModelText, Span};
use super::{Place, names};
use crate::{Error, Result};
use std::collections::HashMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// A number and where it stands.
pub type Number = Spanned<f64>;
/// Three numbers and where they stand.
pub type Vector = Spanned<[f64; 3]>;

/// Reads the tables of one kind, each of which has a name that no other has: `called` gives it, `read` takes it.
pub fn named<T, R>(
    source: ModelText,
    kind: &str,
    tables: &[Spanned<T>],
    called: impl Fn(&T) -> String,
    read: impl Fn(&Item, String, &T) -> Result<R>,
) -> Result<Vec<R>> {
    let mut lines: HashMap<String, usize> = HashMap::new();
    let read = |table: &Spanned<T>| {
        let name = called(table.get_ref());
        let item = Item::new(source, format!("{kind} {name:?}"), table.span());
        if let Some(line) = lines.insert(name.clone(), item.line()) {
            return Err(item.error_here(format_args!("the name is taken by line {line}"), "Give each its own name"));
        }
        read(&item, name, table.get_ref())
    };
    tables.iter().map(read).collect()
}

/// A table of the file.
pub struct Item<'a> {
    source: ModelText<'a>,
    /// What messages call it: `material "iron"`.
    name: String,
    /// Where it begins.
    span: Span,
}

impl<'a> Item<'a> {
    /// The table at `span`, called `name` in messages.
    pub fn new(source: ModelText<'a>, name: String, span: Span) -> Self {
        Item { source, name, span }
    }

    /// Line of the table's header.
    pub fn line(&self) -> usize {
        self.source.line(self.span.start)
    }

    /// A path of the file, seen from the current directory.
    pub fn beside(&self, path: &str) -> PathBuf {
        self.source.file.parent().unwrap_or(Path::new("")).join(path)
    }

    /// Where the table's header stands.
    pub fn place(&self) -> Place {
        Place { file: 0, line: self.line() as u32 }
    }

    /// `file:line: what (name). advice`, at a value of the table.
    pub fn error(&self, at: &Span, what: impl Display, advice: impl Display) -> Error {
        self.source.error(at, format_args!("{what} ({}). {advice}", self.name))
    }

    /// The same, at the table's header.
    pub fn error_here(&self, what: impl Display, advice: impl Display) -> Error {
        self.error(&self.span, what, advice)
    }

    /// Refuses the table where something does not hold.
    pub fn require(&self, holds: bool, what: impl Display, advice: impl Display) -> Result<()> {
        self.require_at(&self.span, holds, what, advice)
    }

    /// The same, at a value of the table.
    pub fn require_at(&self, at: &Span, holds: bool, what: impl Display, advice: impl Display) -> Result<()> {
        if holds { Ok(()) } else { Err(self.error(at, what, advice)) }
    }

    /// One of the things that have names, by its name; `kind` is what messages call it.
    pub fn find<'k, T>(
        &self,
        kind: &str,
        wanted: &Text,
        known: &'k [T],
        name: impl Fn(&'k T) -> &'k str,
    ) -> Result<&'k T> {
        let text = wanted.get_ref();
        known.iter().find(|item| name(item) == text).ok_or_else(|| {
            let advice = names::advice(text, known.iter().map(name));
            self.error(&wanted.span(), format_args!("unknown {kind} {text:?}"), advice)
        })
    }

    /// The value of a key that this table must have.
    pub fn required<'v, T>(&self, value: &'v Option<T>, key: &str, advice: &str) -> Result<&'v T> {
        value.as_ref().ok_or_else(|| self.error_here(format_args!("{key} is missing"), advice))
    }

    /// A number above zero.
    pub fn positive(&self, value: &Number, key: &str, advice: &str) -> Result<f64> {
        self.check(value, *value.get_ref() > 0.0, key, "must be above 0", advice)
    }

    /// A number above zero, where there is one.
    pub fn positive_if_given(&self, value: &Option<Number>, key: &str, advice: &str) -> Result<Option<f64>> {
        value.as_ref().map(|value| self.positive(value, key, advice)).transpose()
    }

    /// A point (m), where there is one; `unit` is metres per unit of the mesh.
    pub fn point(&self, value: &Option<Vector>, key: &str, unit: f64) -> Result<Option<[f64; 3]>> {
        let point = value.as_ref().map(|value| self.finite(value, key)).transpose()?;
        Ok(point.map(|point| point.map(|x| x * unit)))
    }

    /// A number that is zero or above.
    pub fn not_negative(&self, value: &Number, key: &str, advice: &str) -> Result<f64> {
        self.check(value, *value.get_ref() >= 0.0, key, "must be 0 or above", advice)
    }

    /// The loss factor of a stiffness; 0 where it is not given.
    pub fn loss_factor(&self, value: &Option<Number>) -> Result<f64> {
        let advice = "Give the imaginary over the real part of the stiffness, such as 0.02";
        value.as_ref().map_or(Ok(0.0), |value| self.not_negative(value, "loss_factor", advice))
    }

    /// A number for which `holds` (and which is finite).
    pub fn check(&self, value: &Number, holds: bool, key: &str, must: &str, advice: &str) -> Result<f64> {
        let (at, number) = (value.span(), *value.get_ref());
        let what = format_args!("{key} {must}, not {}", self.source.text_at(&at));
        self.require_at(&at, number.is_finite() && holds, what, advice)?;
        Ok(number)
    }

    /// Numbers that are finite.
    pub fn finite<const N: usize>(&self, values: &Spanned<[f64; N]>, key: &str) -> Result<[f64; N]> {
        self.each(values, |x| x.is_finite(), key, "must be finite", "Give numbers")
    }

    /// Numbers that all satisfy `holds` (and are finite).
    pub fn each<const N: usize>(
        &self,
        values: &Spanned<[f64; N]>,
        holds: impl Fn(f64) -> bool,
        key: &str,
        must: &str,
        advice: &str,
    ) -> Result<[f64; N]> {
        match values.get_ref().iter().find(|x| !x.is_finite() || !holds(**x)) {
            None => Ok(*values.get_ref()),
            Some(bad) => Err(self.error(&values.span(), format_args!("{key} {must}, not {bad}"), advice)),
        }
    }

    /// A vector that is not zero, scaled to length 1.
    pub fn direction(&self, value: &Vector, key: &str) -> Result<[f64; 3]> {
        let v = self.finite(value, key)?;
        // Scaled before it is squared, so that no length over- or underflows.
        let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let what = format_args!("{key} has no direction: it is zero");
        self.require_at(&value.span(), largest > 0.0, what, "Give a vector such as [0, 0, 1]")?;
        let v = v.map(|x| x / largest);
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        Ok(v.map(|x| x / length))
    }

    /// A band of frequencies in Hz: not negative, not empty.
    pub fn band(&self, value: &Spanned<[f64; 2]>) -> Result<[f64; 2]> {
        let [low, high] = self.finite(value, "band")?;
        let wrong = if low < 0.0 { "begins below 0" } else { "is empty" };
        let what = format_args!("band {wrong}: [{low}, {high}]");
        let holds = 0.0 <= low && low < high;
        self.require_at(&value.span(), holds, what, "Give [lowest, highest] in Hz, 0 <= lowest < highest")?;
        Ok([low, high])
    }
}
