//! Named states of a brake: forward and reverse, hot and cold, new, bedded in and worn.
//!
//! ```toml
//! model = "brake.toml"
//!
//! [[state]]
//! name = "new"
//!
//! [[state]]
//! name = "hot, reverse"
//! set = { "rotation.disc.speed" = -5.0, "contact.'disc / *'.friction" = 0.35 }
//! factor = { "material.lining.young" = 0.6 }
//!
//! [[state]]
//! name = "bedded in"
//! wear = { distance = 2e4, steps = 10 }          # or { until_uniform = 0.05 }
//!
//! [[state]]
//! name = "measured"
//! gap = "film.csv"
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;
use toml_edit::{DocumentMut, Item, value};

use super::design_table::beside;
use super::key::{KeyPath, at, number, set};
use crate::model::{located, utf8};
use crate::{Error, Result};

/// A study of named states.
#[derive(Debug, Clone, PartialEq)]
pub struct States {
    /// The file, as messages name it.
    pub file: PathBuf,
    /// The model file.
    pub model: PathBuf,
    /// Friction values; the model's own where there are none.
    pub friction_values: Option<Vec<f64>>,
    /// Frequency band, Hz; the model's own where there is none.
    pub band: Option<[f64; 2]>,
    /// The states, in the order of the file; the others are compared with the first.
    pub states: Vec<State>,
}

/// A state: what differs from the model file.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Its name.
    pub name: String,
    /// Numbers of the model file that it replaces.
    pub numbers: Vec<(KeyPath, f64)>,
    /// Numbers of the model file that it multiplies.
    pub factors: Vec<(KeyPath, f64)>,
    /// The gap field of all contacts that wear, or slide where none wears.
    pub gap: Option<PathBuf>,
    /// Wear before its modes are found.
    pub wear: Option<StateWear>,
}

/// Wear of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StateWear {
    /// Over a sliding distance (m), in so many steps.
    Distance(f64, usize),
    /// Until `p v` differs by no more than this fraction.
    Uniform(f64),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    model: String,
    friction: Option<Vec<f64>>,
    band: Option<[f64; 2]>,
    state: Vec<Spanned<StateTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StateTable {
    name: String,
    #[serde(default)]
    set: BTreeMap<String, f64>,
    #[serde(default)]
    factor: BTreeMap<String, f64>,
    gap: Option<String>,
    wear: Option<WearTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WearTable {
    distance: Option<f64>,
    steps: Option<usize>,
    until_uniform: Option<f64>,
}

/// Steps of wear over a distance where none are given.
const STEPS: usize = 10;

impl States {
    /// Reads and checks the file of named states; the model that it names is looked for beside it.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line.
    pub fn read(path: &Path) -> Result<States> {
        let bytes = std::fs::read(path)
            .map_err(|reason| Error::input(format!("{}: cannot read the file of states: {reason}", path.display())))?;
        States::parse(utf8(path, &bytes)?, path)
    }

    fn parse(text: &str, path: &Path) -> Result<States> {
        let line = |offset: usize| 1 + text[..offset.min(text.len())].matches('\n').count();
        let fail = |offset: usize, what: String| Error::input(located(path, line(offset), what));
        let keys: Keys = toml::from_str(text).map_err(|error| {
            let advice = "States have a model, and [[state]] with name, set, factor, gap and wear";
            fail(error.span().map_or(0, |span| span.start), format!("{}. {advice}", error.message().trim_end()))
        })?;
        let mut states: Vec<State> = Vec::new();
        for raw in &keys.state {
            let own = state(raw.get_ref(), path);
            let taken = states.iter().any(|other| folder(&other.name) == folder(&raw.get_ref().name));
            let own = if taken { Err("the name is taken by another state".to_owned()) } else { own };
            let what = |what: String| format!("state {:?}: {what}", raw.get_ref().name);
            states.push(own.map_err(|reason| fail(raw.span().start, what(reason)))?);
        }
        if states.is_empty() {
            return Err(fail(0, "there is no state. Add [[state]] with a name".into()));
        }
        let Keys { friction: friction_values, band, .. } = keys;
        Ok(States { file: path.to_owned(), model: beside(path, &keys.model), friction_values, band, states })
    }
}

impl State {
    /// The name of its folder: letters and digits of its name, others as hyphens.
    pub fn folder(&self) -> String {
        folder(&self.name)
    }

    /// The text of the model file in this state; `worn` are the contacts that a gap field is for.
    ///
    /// # Errors
    /// [`Error::Input`] where the text is no TOML, or a key matches no number of it.
    pub fn text(&self, model: &str, worn: &[String]) -> Result<String> {
        let of_state = |error: Error| Error::input(format!("state {:?}: {error}", self.name));
        let mut document: DocumentMut =
            model.parse().map_err(|reason| Error::input(format!("no model file: {reason}")))?;
        let numbers = self.numbers.iter().map(|change| (change, false));
        for ((key, new), is_factor) in numbers.chain(self.factors.iter().map(|change| (change, true))) {
            for place in key.find(document.as_item(), is_factor).map_err(of_state)? {
                let own = number(at(document.as_item(), &place)).expect("a number was found");
                set(document.as_item_mut(), &place, if is_factor { new * own } else { *new });
            }
        }
        if let Some(gap) = &self.gap {
            let gap = std::path::absolute(gap).map_err(Error::io(gap))?;
            let contacts = document.get_mut("contact").and_then(Item::as_array_of_tables_mut);
            for contact in contacts.into_iter().flat_map(|list| list.iter_mut()) {
                let text = |key: &str| contact.get(key).and_then(Item::as_str).unwrap_or_default().to_owned();
                let pair = format!("{} / {}", text("slave"), text("master"));
                if worn.iter().any(|name| *name == text("name") || *name == pair) {
                    contact.insert("gap", value(gap.display().to_string()));
                }
            }
        }
        Ok(document.to_string())
    }
}

fn state(raw: &StateTable, path: &Path) -> std::result::Result<State, String> {
    let changes = |list: &BTreeMap<String, f64>| {
        let change = |(key, value): (&String, &f64)| Ok((KeyPath::parse(key)?, *value));
        list.iter().map(change).collect::<Result<Vec<_>>>().map_err(|error| error.to_string())
    };
    let wear = raw.wear.as_ref().map(wear).transpose()?;
    match (
        folder(&raw.name).trim_matches('-').is_empty(),
        raw.set.values().chain(raw.factor.values()).all(|x| x.is_finite()),
    ) {
        (true, _) => Err("a name has letters or digits".into()),
        (_, false) => Err("a value is not finite".into()),
        _ => Ok(State {
            name: raw.name.clone(),
            numbers: changes(&raw.set)?,
            factors: changes(&raw.factor)?,
            gap: raw.gap.as_ref().map(|gap| beside(path, gap)),
            wear,
        }),
    }
}

fn wear(raw: &WearTable) -> std::result::Result<StateWear, String> {
    let is_positive = |value: f64| value > 0.0 && value.is_finite();
    match (raw.distance, raw.steps.unwrap_or(STEPS), raw.until_uniform) {
        (Some(distance), steps @ 1.., None) if is_positive(distance) => Ok(StateWear::Distance(distance, steps)),
        (None, _, Some(tolerance)) if is_positive(tolerance) && raw.steps.is_none() => {
            Ok(StateWear::Uniform(tolerance))
        }
        _ => Err("give wear = { distance = METRES, steps = N } or { until_uniform = 0.05 }, numbers above 0".into()),
    }
}

fn folder(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "model = \"brake.toml\"\nfriction = [0.2, 0.4]\n\
        [[state]]\nname = \"new\"\n\
        [[state]]\nname = \"hot, reverse\"\nset = { \"rotation.1.speed\" = -5.0 }\nfactor = { \"material.lining.young\" = 0.5 }\n\
        [[state]]\nname = \"worn\"\ngap = \"worn.csv\"\nwear = { distance = 1e4 }\n\
        [[state]]\nname = \"bedded in\"\nwear = { until_uniform = 0.05 }\n";

    fn message(old: &str, new: &str) -> String {
        assert!(TEXT.contains(old));
        States::parse(&TEXT.replacen(old, new, 1), "a/states.toml".as_ref()).unwrap_err().to_string()
    }

    #[test]
    fn a_file_is_read() {
        let found = States::parse(TEXT, "a/states.toml".as_ref()).unwrap();
        assert_eq!((found.model.as_path(), found.friction_values), ("a/brake.toml".as_ref(), Some(vec![0.2, 0.4])));
        let [new, hot, worn, bedded] = &found.states[..] else { panic!("four states") };
        assert_eq!((new.name.as_str(), new.wear, new.numbers.len()), ("new", None, 0));
        assert_eq!((hot.folder().as_str(), hot.numbers[0].1, hot.factors[0].1), ("hot--reverse", -5.0, 0.5));
        assert_eq!((worn.wear, worn.gap.as_deref()), (Some(StateWear::Distance(1e4, 10)), Some("a/worn.csv".as_ref())));
        assert_eq!(bedded.wear, Some(StateWear::Uniform(0.05)));
    }

    #[test]
    fn mistakes_are_reported_with_their_line() {
        assert!(
            message("name = \"worn\"", "name = \"new\"").contains("a/states.toml:9: state \"new\": the name is taken")
        );
        assert!(message("distance = 1e4", "distance = 0").contains("give wear = { distance"));
        assert!(message("distance = 1e4", "distance = 1, until_uniform = 1").contains("give wear = { distance"));
        assert!(message("name = \"worn\"", "name = \"!\"").contains("a name has letters or digits"));
        assert!(message("gap =", "gaps =").contains("unknown field `gaps`"));
        assert!(message("rotation.1.speed", "rotation..speed").contains("is no key of a model file"));
    }

    #[test]
    fn a_state_is_the_model_file_with_its_numbers_and_gaps() {
        let found = States::parse(TEXT, "a/states.toml".as_ref()).unwrap();
        let model = "[material.lining]\nyoung = 8e9 # Pa\n[[rotation]]\npart = \"disc\"\nspeed = 5.0\n\
            [[contact]]\nslave = \"pad\"\nmaster = \"disc\"\n[[contact]]\nname = \"back\"\n";
        let text = |state: &State| state.text(model, &["pad / disc".to_owned()]).unwrap();
        assert_eq!(text(&found.states[0]), model);
        let hot = text(&found.states[1]);
        assert!(hot.contains("speed = -5.0") && hot.contains("young = 4000000000.0 # Pa"), "{hot}");
        let worn = text(&found.states[2]);
        assert_eq!(worn.matches("gap = ").count(), 1);
        let [at, back] = ["gap = ", "name = \"back\""].map(|what| worn.find(what).unwrap());
        assert!(at < back && worn.contains("a/worn.csv"), "{worn}");
        let error = found.states[1].text("[material.iron]\nyoung = 1.0\n", &[]).unwrap_err().to_string();
        assert!(error.contains("state \"hot, reverse\": key rotation.1.speed"), "{error}");
    }
}
