//! Numbers of a model file by their key paths.
//!
//! A path is `material.lining.young_axial` or `contact."disc / inner pad".law.linear`: names of keys with dots between
//! them, in quotes where a name has dots or spaces. Items of a list are called by the names that messages give them, or
//! by their numbers from 1; the three numbers of a vector are also `x`, `y` and `z`. A `*` stands for any text, so that
//! `load.*.force` are the forces of all loads.

use toml_edit::{Item, Value};

use crate::model::names;
use crate::{Error, Result};

/// A key path.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyPath {
    text: String,
    segments: Vec<String>,
}

/// A step into a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Step {
    Key(String),
    Index(usize),
}

/// A place in a document.
pub(super) type Address = Vec<Step>;

impl KeyPath {
    /// Reads a path.
    ///
    /// ```
    /// use squeal::explore::KeyPath;
    ///
    /// assert_eq!(KeyPath::parse("contact.'disc / *'.friction")?.segments(), ["contact", "disc / *", "friction"]);
    /// # Ok::<(), squeal::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] for a path with an empty segment, or a quote that is not closed.
    pub fn parse(text: &str) -> Result<KeyPath> {
        let mut segments = vec![String::new()];
        let mut quote = None;
        for c in text.chars() {
            match (c, quote) {
                ('"' | '\'', None) => quote = Some(c),
                (c, Some(open)) if c == open => quote = None,
                ('.', None) => segments.push(String::new()),
                (c, _) => segments.last_mut().expect("begins with one").push(c),
            }
        }
        if quote.is_some() || segments.iter().any(|segment| segment.trim().is_empty()) {
            let advice = "Give one such as material.lining.young or contact.\"disc / pad\".law.linear";
            return Err(Error::input(format!("{text:?} is no key of a model file. {advice}")));
        }
        Ok(KeyPath { text: text.to_owned(), segments: segments.iter().map(|s| s.trim().to_owned()).collect() })
    }

    /// The names between the dots.
    pub fn segments(&self) -> &[String] {
        &self.segments
    }

    /// The path as it was given.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The numbers that the path names: one a match; all numbers of a list where `is_group`.
    ///
    /// # Errors
    /// [`Error::Input`] with advice where nothing matches, or what matches is no number.
    pub(super) fn find(&self, document: &Item, is_group: bool) -> Result<Vec<Address>> {
        let mut places: Vec<Address> = vec![Vec::new()];
        for (depth, segment) in self.segments.iter().enumerate() {
            let below: Vec<(Vec<String>, Address)> =
                places.iter().flat_map(|place| children(at(document, place), place)).collect();
            let is_match = |labels: &Vec<String>| labels.iter().any(|label| matches(segment, label));
            let found: Vec<Address> =
                below.iter().filter(|(labels, _)| is_match(labels)).map(|(_, place)| place.clone()).collect();
            if found.is_empty() {
                let mut known: Vec<&str> = below.iter().map(|(labels, _)| labels[0].as_str()).collect();
                known.sort_unstable();
                known.dedup();
                let above = match depth {
                    0 => "the model file".to_owned(),
                    _ => self.segments[..depth].join("."),
                };
                let is_proposed = places.iter().any(|place| at(document, place).as_str() == Some("auto"));
                let advice = match is_proposed {
                    true => {
                        "It is \"auto\": write the number that `squeal check` prints, such as { linear = 2e13 }".into()
                    }
                    false => names::advice(segment, known),
                };
                return Err(self.error(&format!("{above} has no {segment:?}"), &advice));
            }
            places = found;
        }
        let numbers = places.iter().map(|place| self.numbers(document, place, is_group)).collect::<Result<Vec<_>>>()?;
        Ok(numbers.concat())
    }

    /// The places of the number, or the numbers, at a place.
    fn numbers(&self, document: &Item, place: &Address, is_group: bool) -> Result<Vec<Address>> {
        let item = at(document, place);
        if number(item).is_some() {
            return Ok(vec![place.clone()]);
        }
        if item.is_array() && is_group {
            let each = children(item, place).into_iter().map(|(_, below)| self.numbers(document, &below, true));
            return Ok(each.collect::<Result<Vec<_>>>()?.concat());
        }
        let labels: Vec<String> = children(item, place).into_iter().map(|(labels, _)| labels.join(" or ")).collect();
        let below = labels.iter().map(String::as_str).collect::<Vec<_>>();
        let advice = match item.is_array() {
            true => format!("Add the number's place, {}, or factor = true for all of them", names::list(&below)),
            false if below.is_empty() => "Name a key with a number".to_owned(),
            false => format!("Add one of {}", names::list(&below)),
        };
        Err(self.error("this is no number", &advice))
    }

    fn error(&self, what: &str, advice: &str) -> Error {
        Error::input(format!("key {}: {what}. {advice}", self.text))
    }
}

/// The item at a place.
///
/// # Panics
/// Where the place is of another document.
pub(super) fn at<'d>(document: &'d Item, place: &[Step]) -> &'d Item {
    let step = |item: &'d Item, step: &Step| match step {
        Step::Key(key) => item.get(key.as_str()),
        Step::Index(i) => item.get(*i),
    };
    place.iter().fold(document, |item, one| step(item, one).expect("a place of this document"))
}

/// The number at an item.
pub(super) fn number(item: &Item) -> Option<f64> {
    item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64))
}

/// Changes the number at a place; comments and spaces stay.
///
/// # Panics
/// Where the place is of another document.
pub(super) fn set(document: &mut Item, place: &[Step], new: f64) {
    let step = |item, step: &Step| match step {
        Step::Key(key) => Item::get_mut(item, key.as_str()),
        Step::Index(i) => Item::get_mut(item, *i),
    };
    let item = place.iter().fold(document, |item, one| step(item, one).expect("a place of this document"));
    let value = item.as_value_mut().expect("a number");
    let decor = value.decor().clone();
    *value = Value::from(new);
    *value.decor_mut() = decor;
}

/// What is below an item: names, the usual one first, and places.
fn children(item: &Item, place: &[Step]) -> Vec<(Vec<String>, Address)> {
    let below = |step: Step| [place, &[step]].concat();
    if let Some(table) = item.as_table_like() {
        return table.iter().map(|(key, _)| (vec![key.to_owned()], below(Step::Key(key.to_owned())))).collect();
    }
    let n = item.as_array_of_tables().map(|list| list.len()).or(item.as_array().map(|list| list.len()));
    (0..n.unwrap_or(0)).map(|i| (labels(&item[i], i, n), below(Step::Index(i)))).collect()
}

/// Names of an item of a list.
fn labels(item: &Item, i: usize, n: Option<usize>) -> Vec<String> {
    let mut labels: Vec<String> = item_name(item).into_iter().collect();
    if n == Some(3) && number(item).is_some() {
        labels.push(["x", "y", "z"][i].to_owned());
    }
    labels.push((i + 1).to_string());
    labels
}

/// What messages call a table of a list: its name, or what it is on.
fn item_name(item: &Item) -> Option<String> {
    let text = |key: &str| item.get(key).and_then(Item::as_str).map(str::to_owned);
    let pair = || Some(format!("{} / {}", text("slave")?, text("master")?));
    let between = || {
        let both: Vec<&str> = item.get("between")?.as_array()?.iter().filter_map(Value::as_str).collect();
        Some(both.join(" / "))
    };
    let on = || ["on", "nodes", "part"].into_iter().find_map(text);
    text("name").or_else(pair).or_else(between).or_else(on)
}

/// Whether a name is of a pattern, in which `*` is any text.
pub(super) fn matches(pattern: &str, name: &str) -> bool {
    let Some((head, rest)) = pattern.split_once('*') else { return pattern == name };
    let Some(tail) = name.strip_prefix(head) else { return false };
    (0..=tail.len()).any(|i| tail.is_char_boundary(i) && matches(rest, &tail[i..]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use toml_edit::DocumentMut;

    const TEXT: &str = "[material.lining]\nyoung = 8e9 # Pa\ndensity = 2600\n[material.iron]\nyoung = [1.0, 2.0, 3.0]\n\
        [[contact]]\nname = \"disc / inner\"\nlaw = { linear = 2e13 }\n\
        [[contact]]\nslave = \"a\"\nmaster = \"b\"\nlaw = { cubic = [1.0, 2.0] }\n\
        [[load]]\non = \"piston\"\nforce = [0, 0, 4000]\n[[load]]\non = \"seal\"\npressure = 1e5\n";

    fn item() -> Item {
        TEXT.parse::<DocumentMut>().unwrap().as_item().clone()
    }

    fn found(path: &str, is_group: bool) -> Vec<f64> {
        let document = item();
        let places = KeyPath::parse(path).unwrap().find(&document, is_group).unwrap();
        places.iter().map(|place| number(at(&document, place)).unwrap()).collect()
    }

    #[test]
    fn numbers_are_found_by_names_numbers_and_patterns() {
        assert_eq!(found("material.lining.young", false), [8e9]);
        assert_eq!(found("contact.\"disc / inner\".law.linear", false), [2e13]);
        assert_eq!(found("contact.'a / b'.law.cubic.2", false), [2.0]);
        assert_eq!(found("load.piston.force.z", false), [4000.0]);
        assert_eq!(found("load.1.force.3", false), [4000.0]);
        assert_eq!(found("load.*.force", true), [0.0, 0.0, 4000.0]);
        assert_eq!(found("material.*.young", true), [8e9, 1.0, 2.0, 3.0]);
        assert_eq!(found("contact.disc*.law.lin*", false), [2e13]);
    }

    #[test]
    fn what_is_not_there_is_an_error_with_advice() {
        let message = |path: &str| {
            let path = KeyPath::parse(path).unwrap();
            path.find(&item(), false).unwrap_err().to_string()
        };
        assert!(message("material.linign.young").contains("material has no \"linign\". Did you mean \"lining\"?"));
        assert!(message("materials.x").contains("the model file has no \"materials\". Did you mean \"material\"?"));
        let proposed: DocumentMut = "[[contact]]\nname = \"pad\"\nlaw = \"auto\"\n".parse().unwrap();
        let error = KeyPath::parse("contact.pad.law.linear").unwrap().find(proposed.as_item(), false).unwrap_err();
        assert!(
            error.to_string().ends_with(
                "has no \"linear\". It is \"auto\": write the number that `squeal check` \
                                             prints, such as { linear = 2e13 }"
            ),
            "{error}"
        );
        assert!(message("load.*.moment").contains("load.* has no \"moment\""));
        assert!(message("load.piston.force").contains("x or 1, y or 2, z or 3, or factor = true"));
        assert!(message("material.lining").contains("no number. Add one of young, density"));
        assert!(message("load.seal.on").contains("Name a key with a number"));
        for broken in ["", "a..b", "a.'b", "a."] {
            assert!(KeyPath::parse(broken).is_err(), "{broken}");
        }
    }

    #[test]
    fn patterns_stand_for_any_text() {
        assert!(matches("*", "") && matches("disc / *", "disc / pad") && matches("*pad*", "a pad b"));
        assert!(!matches("disc", "discs") && !matches("*pad", "pads") && matches("a*b*c", "axxbyyc"));
    }

    #[test]
    fn a_change_leaves_comments_alone() {
        let mut document = TEXT.parse::<DocumentMut>().unwrap();
        let place = KeyPath::parse("material.lining.young").unwrap().find(document.as_item(), false).unwrap();
        set(document.as_item_mut(), &place[0], 7.5e9);
        assert!(document.to_string().contains("young = 7500000000.0 # Pa"));
    }
}
