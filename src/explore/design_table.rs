//! The tables of a study's file that choose its points.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::correlation::Correlation;
use super::design::{AdaptiveRule, Design, DesignKind};
use super::distribution::Distribution;
use super::study::Parameter;
use crate::model::names;
use crate::{Error, Result};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DesignTable {
    pub kind: Spanned<String>,
    points: Option<usize>,
    levels: Option<usize>,
    start: Option<usize>,
    resolution: Option<f64>,
    file: Option<String>,
    #[serde(default)]
    seed: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CorrelationTable {
    between: [String; 2],
    coefficient: f64,
}

/// Kinds of designs by their names.
const KINDS: [&str; 8] = ["grid", "map", "one-at-a-time", "list", "latin-hypercube", "sobol", "saltelli", "adaptive"];
/// Levels of a parameter in a grid where none are given.
const GRID_LEVELS: usize = 5;
/// An adaptive design starts with this part of its points where no number is given,
const START_SHARE: usize = 4;
/// and with no fewer than these.
const MIN_START: usize = 8;
/// It has no more points than these: each round compares all pairs of opposite verdict.
const MAX_ADAPTIVE: usize = 4096;
/// Its resolution where none is given.
const RESOLUTION: f64 = 0.01;

/// A path of the file, seen from the current directory.
pub(super) fn beside(file: &Path, name: &str) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(name)
}

/// The design of a table.
///
/// # Errors
/// [`Error::Input`] for keys that are missing, or do not go together, and files that cannot be read.
pub(super) fn design(table: &DesignTable, parameters: &[Parameter], path: &Path) -> Result<Design> {
    let count = |given: Option<usize>, key: &str| {
        let missing = || Error::input(format!("kind {:?} needs {key}, a number above 0", table.kind.get_ref()));
        given.filter(|n| *n > 0).ok_or_else(missing)
    };
    let own = |keys: &[&str]| {
        let given = [
            ("points", table.points.is_some()),
            ("levels", table.levels.is_some()),
            ("start", table.start.is_some()),
            ("resolution", table.resolution.is_some()),
            ("file", table.file.is_some()),
        ];
        let extra = given.iter().find(|(key, is_given)| *is_given && !keys.contains(key));
        extra.map_or(Ok(()), |(key, _)| {
            Err(Error::input(format!("{key} does not go with kind {:?}", table.kind.get_ref())))
        })
    };
    let kind = match table.kind.get_ref().as_str() {
        "grid" | "one-at-a-time" => own(&["levels"]).and_then(|()| {
            Ok(if table.kind.get_ref() == "grid" {
                DesignKind::Grid { n_levels: count(table.levels.or(Some(GRID_LEVELS)), "levels")? }
            } else {
                DesignKind::OneAtATime { n_levels: count(table.levels.or(Some(2)), "levels")? }
            })
        }),
        "list" => own(&["file"]).and_then(|()| {
            let missing = || Error::input("kind \"list\" needs file, a CSV file with a column for each parameter");
            let file = table.file.as_ref().ok_or_else(missing)?;
            Ok(DesignKind::List(read_points(&beside(path, file), parameters)?))
        }),
        "map" => own(&["levels"]).and_then(|()| map(count(table.levels.or(Some(GRID_LEVELS)), "levels")?, parameters)),
        "adaptive" => own(&["points", "start", "resolution"])
            .and_then(|()| adaptive(table, count(table.points, "points")?, parameters)),
        kind => own(&["points"]).and_then(|()| match kind {
            "latin-hypercube" => Ok(DesignKind::LatinHypercube { n_points: count(table.points, "points")? }),
            "sobol" => Ok(DesignKind::Sobol { n_points: count(table.points, "points")? }),
            "saltelli" => Ok(DesignKind::Saltelli { n_base: count(table.points, "points")? }),
            other => Err(Error::input(format!("there is no kind {other:?}. {}", names::advice(other, KINDS)))),
        }),
    };
    Ok(Design { kind: kind?, seed: table.seed, correlation: None })
}

/// An adaptive design of at most so many points.
fn adaptive(table: &DesignTable, n_points: usize, parameters: &[Parameter]) -> Result<DesignKind> {
    if n_points > MAX_ADAPTIVE {
        let what = format!("kind \"adaptive\" has at most {MAX_ADAPTIVE} points, not {n_points}");
        return Err(Error::input(format!("{what}. Give fewer points, or kind = \"sobol\"")));
    }
    let n_start = table.start.unwrap_or((n_points / START_SHARE).max(MIN_START).min(n_points));
    let resolution = table.resolution.unwrap_or(RESOLUTION);
    let is_valid = (1..=n_points).contains(&n_start) && resolution > 0.0 && resolution < 1.0;
    if !is_valid {
        let what = "kind \"adaptive\" has start from 1 to points, and a resolution between 0 and 1";
        return Err(Error::input(what));
    }
    require_ranges("adaptive", parameters)?;
    Ok(DesignKind::Adaptive(AdaptiveRule { n_points, n_start, resolution }))
}

/// A map of two parameters.
fn map(n_levels: usize, parameters: &[Parameter]) -> Result<DesignKind> {
    require_ranges("map", parameters)?;
    if parameters.len() != 2 || n_levels < 2 {
        let what = format!("kind \"map\" has two parameters and two or more levels, not {}", parameters.len());
        return Err(Error::input(format!("{what} and {n_levels}. Give these, or kind = \"grid\"")));
    }
    Ok(DesignKind::Map { n_levels })
}

/// That no parameter has a list of values.
fn require_ranges(kind: &str, parameters: &[Parameter]) -> Result<()> {
    let list = parameters.iter().find(|own| matches!(own.distribution, Distribution::Values(_)));
    let what = |own: &Parameter| format!("kind {kind:?} looks between points, and parameter {:?} has a list", own.name);
    let refused = |own| Err(Error::input(format!("{}. Give it a range or a distribution", what(own))));
    list.map_or(Ok(()), refused)
}

/// A design with the correlations of its parameters.
///
/// # Errors
/// [`Error::Input`] for unknown names, and coefficients that cannot be.
pub(super) fn correlated(design: Design, tables: &[CorrelationTable], parameters: &[Parameter]) -> Result<Design> {
    if tables.is_empty() {
        return Ok(design);
    }
    if !matches!(design.kind, DesignKind::Sobol { .. } | DesignKind::LatinHypercube { .. }) {
        let what = "[[correlation]] goes with the kinds \"sobol\" and \"latin-hypercube\" alone";
        return Err(Error::input(what));
    }
    let place = |name: &String| {
        let names = || parameters.iter().map(|own| own.name.as_str());
        let unknown = || Error::input(format!("correlation: no parameter {name:?}. {}", names::advice(name, names())));
        names().position(|own| own == name).ok_or_else(unknown)
    };
    let pair =
        |table: &CorrelationTable| Ok(([place(&table.between[0])?, place(&table.between[1])?], table.coefficient));
    let pairs = tables.iter().map(pair).collect::<Result<Vec<_>>>()?;
    let correlation = Correlation::new(parameters.len(), &pairs).filter(|_| pairs.iter().all(|([i, j], _)| i != j));
    let impossible = || Error::input("no parameters can have these correlations. Give coefficients between -1 and 1");
    Ok(Design { correlation: Some(correlation.ok_or_else(impossible)?), ..design })
}

/// Points of a CSV file, whose columns are called as the parameters.
fn read_points(path: &Path, parameters: &[Parameter]) -> Result<Vec<Vec<f64>>> {
    let wrong = |what: String| Error::input(format!("{}: {what}", path.display()));
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path).map_err(|reason| wrong(reason.to_string()))?;
    let heads = reader.headers().map_err(|reason| wrong(reason.to_string()))?.clone();
    let column = |parameter: &Parameter| {
        heads.iter().position(|head| head == parameter.name).ok_or_else(|| {
            wrong(format!("there is no column {:?}. {}", parameter.name, names::advice(&parameter.name, heads.iter())))
        })
    };
    let columns = parameters.iter().map(column).collect::<Result<Vec<_>>>()?;
    let mut points = Vec::new();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(|reason| wrong(reason.to_string()))?;
        let number = |&column: &usize| {
            let text = record.get(column).unwrap_or_default();
            let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| wrong(format!("row {} has {text:?} in place of a number", row + 2)))
        };
        points.push(columns.iter().map(number).collect::<Result<Vec<_>>>()?);
    }
    Ok(points)
}
