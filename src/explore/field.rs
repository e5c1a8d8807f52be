//! The tables of a study's file that describe random fields over contact points.
//!
//! ```text
//! Z(x) = sum_i sqrt(lambda_i) phi_i(x) xi_i      the parameters NAME.1, NAME.2 ... are the xi_i
//! gap(x) + deviation Z(x)                        of = "gap"
//! stiffness(x) exp(deviation Z(x))               of = "stiffness"
//! ```

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use super::distribution::Distribution;
use super::key::matches;
use super::random_field::Kernel;
use super::study::{OneOrMore, Parameter};

/// What a random field changes at a contact point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FieldQuantity {
    /// Its gap, by a sum.
    Gap,
    /// Its contact stiffness, by a factor.
    Stiffness,
}

/// A random field over the points of contacts, as the file of a study describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Its name; its parameters are `NAME.1`, `NAME.2` and so on.
    pub name: String,
    /// Names of the contacts, in which `*` stands for any text. One field covers the points of all of them.
    pub contacts: Vec<String>,
    /// What it changes.
    pub quantity: FieldQuantity,
    /// Standard deviation: of a gap in the mesh's unit, of a stiffness that of its natural logarithm.
    pub deviation: f64,
    /// Correlation length in the mesh's unit.
    pub correlation_length: f64,
    /// How the correlation falls with the distance.
    pub kernel: Kernel,
    /// Number of its Karhunen-Loeve modes, which is that of its parameters.
    pub n_modes: usize,
    /// The place of its first parameter among those of the study.
    pub first: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FieldTable {
    contact: OneOrMore,
    of: FieldQuantity,
    deviation: f64,
    correlation_length: f64,
    kernel: Kernel,
    modes: usize,
}

/// Modes of a field at most.
const MAX_MODES: usize = 20;

impl Field {
    /// The field of a table, whose first parameter has this place.
    fn new(name: &str, table: &FieldTable, first: usize) -> Result<Field, String> {
        let FieldTable { deviation, correlation_length, kernel, modes, of, .. } = *table;
        let is_positive = |value: f64| value > 0.0 && value.is_finite();
        let mistakes = [
            (!is_positive(deviation)).then_some("deviation is not above 0"),
            (!is_positive(correlation_length)).then_some("correlation_length is not above 0"),
            (!(1..=MAX_MODES).contains(&modes)).then_some("modes is not from 1 to 20"),
            table.contact.texts().is_empty().then_some("contact is an empty list. Name the contacts"),
        ];
        if let Some(what) = mistakes.into_iter().flatten().next() {
            return Err(what.to_owned());
        }
        let (name, contacts) = (name.to_owned(), table.contact.texts().to_vec());
        Ok(Field { name, contacts, quantity: of, deviation, correlation_length, kernel, n_modes: modes, first })
    }

    /// The coefficients of its modes among the values of all parameters.
    pub fn coefficients<'v>(&self, values: &'v [f64]) -> &'v [f64] {
        &values[self.first..self.first + self.n_modes]
    }

    /// Whether it covers a contact of this name.
    pub fn covers(&self, contact: &str) -> bool {
        self.contacts.iter().any(|pattern| matches(pattern, contact))
    }

    /// The first of its names that is of none of these contacts.
    pub fn pattern_without<'c>(&self, contacts: impl Iterator<Item = &'c str> + Clone) -> Option<&str> {
        let is_missing = |pattern: &&String| !contacts.clone().any(|contact| matches(pattern, contact));
        self.contacts.iter().find(is_missing).map(String::as_str)
    }

    /// Its parameters: independent standard normal variables.
    fn parameters(&self) -> impl Iterator<Item = Parameter> {
        let distribution =
            Distribution::Normal { mean: 0.0, deviation: 1.0, from: f64::NEG_INFINITY, to: f64::INFINITY };
        (1..=self.n_modes).map(move |i| Parameter {
            name: format!("{}.{i}", self.name),
            keys: Vec::new(),
            is_factor: false,
            distribution: distribution.clone(),
        })
    }
}

/// The fields of the tables in the order of the file; their parameters follow the study's others.
///
/// # Errors
/// What is wrong, with the place in the text.
pub(super) fn fields(
    tables: BTreeMap<Spanned<String>, FieldTable>,
    parameters: &mut Vec<Parameter>,
) -> Result<Vec<Field>, (usize, String)> {
    let mut tables: Vec<(Spanned<String>, FieldTable)> = tables.into_iter().collect();
    tables.sort_by_key(|(name, _)| name.span().start);
    let mut fields = Vec::new();
    for (name, table) in tables {
        let wrong = |what: String| (name.span().start, format!("field {:?}: {what}", name.get_ref()));
        let field = Field::new(name.get_ref(), &table, parameters.len()).map_err(wrong)?;
        let own: Vec<Parameter> = field.parameters().collect();
        if let Some(twice) = own.iter().find(|own| parameters.iter().any(|other| other.name == own.name)) {
            return Err(wrong(format!("there is a parameter {:?} already. Give the field another name", twice.name)));
        }
        parameters.extend(own);
        fields.push(field);
    }
    Ok(fields)
}

#[cfg(test)]
mod tests {
    use super::super::study::parse;

    const TEXT: &str = "model = \"brake.toml\"\n[design]\nkind = \"sobol\"\npoints = 8\n\
        [parameter.mu]\nkey = \"friction\"\nuniform = [0.3, 0.6]\n\
        [field.film]\ncontact = \"disc / *\"\nof = \"gap\"\ndeviation = 0.002\ncorrelation_length = 15\n\
        kernel = \"gaussian\"\nmodes = 3\n";

    #[test]
    fn a_field_has_a_normal_parameter_for_each_mode() {
        let study = parse(TEXT, "explore.toml".as_ref()).unwrap();
        let names: Vec<&str> = study.parameters.iter().map(|own| own.name.as_str()).collect();
        assert_eq!(names, ["mu", "film.1", "film.2", "film.3"]);
        assert!(study.parameters[1].is_of_field() && !study.parameters[0].is_of_field());
        assert!((study.parameters[3].distribution.quantile(0.975) - 1.96).abs() < 1e-3);
        let [film] = &study.fields[..] else { panic!("one field") };
        assert_eq!(film.coefficients(&[0.4, 1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
        assert!(film.covers("disc / pad") && !film.covers("pin"));
        assert_eq!(film.pattern_without(["pin"].into_iter()), Some("disc / *"));
    }

    #[test]
    fn mistakes_have_their_line() {
        for (old, new, parts) in [
            ("modes = 3", "modes = 21", ["explore.toml:8", "modes is not from 1 to 20"]),
            ("0.002", "-1", ["explore.toml:8", "deviation is not above 0"]),
            ("= 15", "= 0", ["explore.toml:8", "correlation_length is not above 0"]),
            ("\"disc / *\"", "[]", ["explore.toml:8", "contact is an empty list"]),
            ("gaussian", "gausian", ["explore.toml:13", "expected `gaussian` or `exponential`"]),
            ("parameter.mu", "parameter.\"film.2\"", ["explore.toml:8", "a parameter \"film.2\" already"]),
            ("[design]", "contacts = 12\n[design]", ["field \"film\"", "a random field needs full contact"]),
        ] {
            let message = parse(&TEXT.replacen(old, new, 1), "explore.toml".as_ref()).unwrap_err().to_string();
            assert!(parts.iter().all(|part| message.contains(part)), "{parts:?} in {message}");
        }
    }
}
