//! Sums of matrices with expressions of a parameter: `K(p) = sum_i f_i(p) K_i`, and M, C and G alike, as a TOML file
//! gives them. `[[structural]]` has the terms of structural damping G, the imaginary part of the stiffness.
//!
//! ```toml
//! parameter = "v"
//!
//! [[mass]]
//! file = "M.mtx"                # factor = "1" where it is left out
//!
//! [[damping]]
//! file = "C1.mtx"
//! factor = "v"
//!
//! [[stiffness]]
//! file = "K0.mtx"
//! factor = "9.81"
//!
//! [[stiffness]]
//! file = "K2.mtx"
//! factor = "v^2"
//! ```
//!
//! An expression has `+ - * / ^`, brackets, numbers, the parameter, `pi`, and functions such as `sin`, `sqrt`, `exp`,
//! `abs`.

use std::f64::consts::PI;
use std::path::Path;

use exmex::prelude::*;
use exmex::{FloatOpsFactory, MakeOperators, Operator};
use serde::Deserialize;
use toml::Spanned;

use super::Role;
use super::combined::Term;
use crate::model::utf8;
use crate::{Error, Result};

/// The operators and functions of expressions, with `pi` by its usual name.
#[derive(Debug, Clone)]
struct Operators;

impl MakeOperators<f64> for Operators {
    fn make<'a>() -> Vec<Operator<'a, f64>> {
        let mut all = FloatOpsFactory::<f64>::make();
        all.push(Operator::make_constant("pi", PI));
        all
    }
}

type Expression = FlatEx<f64, Operators>;

/// A factor of a matrix: an expression of the parameter.
#[derive(Debug, Clone)]
pub struct Coefficient {
    expression: Expression,
    text: String,
    /// `file:line: `, where it is of a file.
    place: String,
}

impl Coefficient {
    /// The factor 1.
    pub fn one() -> Coefficient {
        Coefficient { expression: Expression::parse("1").expect("a number"), text: "1".into(), place: String::new() }
    }

    /// Reads an expression in one parameter.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn parse(text: &str, parameter: &str) -> std::result::Result<Coefficient, String> {
        if !Expression::parse(parameter).is_ok_and(|expression| expression.var_names() == [parameter]) {
            return Err(format!(
                "{parameter:?} is no name for a parameter: give one that means nothing else, such as \"p\""
            ));
        }
        let expression = Expression::parse(text).map_err(|reason| {
            format!("{text:?} is no expression in {parameter} (such as \"1 - 2*{parameter}\"): {reason}")
        })?;
        match expression.var_names().iter().find(|name| *name != parameter) {
            Some(name) => Err(format!("{text:?} has the unknown name {name:?}: the parameter is {parameter:?}")),
            None => Ok(Coefficient { expression, text: text.into(), place: String::new() }),
        }
    }

    /// The value at a value of the parameter.
    ///
    /// # Errors
    /// [`Error::Input`] where it is not finite.
    pub fn at(&self, parameter: f64) -> Result<f64> {
        let values = vec![parameter; self.expression.var_names().len()];
        match self.expression.eval(&values) {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(value) => Err(Error::input(format!(
                "{}the factor {:?} is {value} at the value {parameter} of the parameter. Give other values of it",
                self.place, self.text
            ))),
            Err(reason) => {
                Err(Error::input(format!("{}the factor {:?} at {parameter}: {reason}", self.place, self.text)))
            }
        }
    }

    /// Whether the parameter is in it.
    pub fn varies(&self) -> bool {
        !self.expression.var_names().is_empty()
    }
}

/// The keys of a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    parameter: String,
    title: Option<String>,
    mass: Vec<RawTerm>,
    #[serde(default)]
    damping: Vec<RawTerm>,
    stiffness: Vec<RawTerm>,
    #[serde(default)]
    structural: Vec<RawTerm>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTerm {
    file: String,
    factor: Option<Spanned<String>>,
}

/// The sums that make a family of eigenproblems.
#[derive(Debug, Clone)]
pub struct MatrixFamily {
    /// A line for titles.
    pub title: String,
    /// Name of the parameter.
    pub parameter: String,
    /// All terms.
    pub terms: Vec<Term>,
}

/// Reads a family; its files are looked for beside it.
///
/// # Errors
/// [`Error::Input`] with file and line.
pub fn read(path: &Path) -> Result<MatrixFamily> {
    let place = path.display();
    let bytes = std::fs::read(path).map_err(|reason| Error::input(format!("{place}: cannot be read: {reason}")))?;
    let text = utf8(path, &bytes)?;
    if text.contains("[mesh]") || text.trim_start().starts_with("mesh") {
        let what = "this is a model file, not a family of matrices";
        return Err(Error::input(format!("{place}: {what}. Give --part NAME for the modes of one of its parts")));
    }
    let line = |offset: usize| 1 + text[..offset.min(text.len())].matches('\n').count();
    let keys: Keys = toml::from_str(text).map_err(|error| {
        let at = line(error.span().map_or(0, |span| span.start));
        let advice =
            "A family has parameter = \"p\" and tables [[mass]], [[damping]], [[stiffness]], [[structural]] with file and factor";
        Error::input(format!("{place}:{at}: {}. {advice}", error.message().trim_end()))
    })?;
    let mut terms = Vec::new();
    for (role, list) in Role::ALL.into_iter().zip([&keys.mass, &keys.damping, &keys.stiffness, &keys.structural]) {
        for RawTerm { file, factor } in list {
            let factor = match factor {
                None => Coefficient::one(),
                Some(factor) => {
                    let place = format!("{place}:{}: ", line(factor.span().start));
                    let own = Coefficient::parse(factor.get_ref(), &keys.parameter)
                        .map_err(|what| Error::input(format!("{place}{what}")))?;
                    Coefficient { place, ..own }
                }
            };
            terms.push(Term { role, file: path.parent().unwrap_or(Path::new("")).join(file), factor });
        }
    }
    if keys.mass.is_empty() || keys.stiffness.is_empty() {
        return Err(Error::input(format!("{place}: a family needs a [[mass]] and a [[stiffness]]")));
    }
    let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    Ok(MatrixFamily { title: keys.title.unwrap_or(stem), parameter: keys.parameter, terms })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_have_one_parameter() {
        let value = |text: &str| Coefficient::parse(text, "v").unwrap().at(3.0).unwrap();
        assert_eq!([value("v^2"), value("9.81"), value("1 - 4*v/3"), value("-v")], [9.0, 9.81, -3.0, -3.0]);
        assert!(Coefficient::parse("2*w", "v").unwrap_err().contains("\"w\""));
        assert!(Coefficient::parse("2*", "v").is_err());
        assert!(Coefficient::parse("1/(v-3)", "v").unwrap().at(3.0).is_err());
        assert!(Coefficient::parse("v", "v").unwrap().varies() && !Coefficient::one().varies());
    }

    #[test]
    fn expressions_have_pi_and_refuse_it_as_a_parameter() {
        let value = |text: &str, parameter: &str| Coefficient::parse(text, parameter).unwrap().at(0.5).unwrap();
        assert_eq!(value("2*pi*v", "v"), PI);
        assert_eq!(value("pi*pin", "pin"), 0.5 * PI);
        for name in ["pi", "e", "sin", "2", "a+b", ""] {
            let message = Coefficient::parse("1", name).unwrap_err();
            assert!(message.contains("is no name for a parameter"), "{name}: {message}");
        }
    }
}
