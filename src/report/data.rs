//! What the page's program reads: one value of JSON, the values as `--json` prints them.

use serde::Serialize;

use super::drawing::{self, Face, Outer, Shapes};
use super::findings::{Findings, Instability};
use crate::output::json::ValueDocument;
use crate::results::Pair;

/// Everything that the page shows on demand.
#[derive(Serialize)]
pub struct Data<'a> {
    pairs: &'a [Pair],
    values: Vec<ValueDocument<'a>>,
    /// Indices of the requested values.
    asked: &'a [usize],
    /// For each value and each of its modes the branch, from 0.
    branch_of: &'a [Vec<Option<usize>>],
    instabilities: Vec<InstabilityData>,
    surface: Option<Outer>,
    #[serde(flatten)]
    shapes: Shapes,
    faces: Vec<Face>,
}

#[derive(Serialize)]
struct InstabilityData {
    /// Its modes at the requested values.
    modes: Vec<String>,
    worst: String,
}

impl<'a> Data<'a> {
    /// Gathers it.
    pub fn new(findings: &'a Findings) -> Data<'a> {
        let results = findings.results;
        Data {
            pairs: &results.about.pairs,
            values: results.values.iter().map(|value| ValueDocument::new(value, &results.about)).collect(),
            asked: &findings.asked,
            branch_of: &findings.branch_of,
            instabilities: findings.instabilities.iter().map(|one| instability(findings, one)).collect(),
            surface: drawing::outer(&results.surface, &results.about.parts),
            shapes: drawing::shapes(findings),
            faces: drawing::faces(findings),
        }
    }
}

fn instability(findings: &Findings, one: &Instability) -> InstabilityData {
    let asked = one.modes.iter().filter(|place| findings.results.values[place.value].asked);
    InstabilityData { modes: asked.map(|place| place.name()).collect(), worst: one.worst.name() }
}
