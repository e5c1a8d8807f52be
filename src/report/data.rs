//! What the page's program reads: one value of JSON.

use std::collections::BTreeMap;

use serde::Serialize;

use super::drawing::{self, Face, Outer, Shapes};
use super::findings::{Findings, Instability, Place};
use super::words;
use crate::output::explain;
use crate::results::Source;
use crate::results::{ModeData, Value};

/// Everything that the page shows on demand.
#[derive(Serialize)]
pub struct Data<'a> {
    parts: Vec<&'a str>,
    pairs: Vec<PairData<'a>>,
    values: Vec<ValueData<'a>>,
    /// Indices of the values asked for.
    asked: &'a [usize],
    instabilities: Vec<InstabilityData>,
    /// By the mode's name.
    explained: BTreeMap<String, Vec<SourceData<'a>>>,
    surface: Option<Outer>,
    #[serde(flatten)]
    shapes: Shapes,
    faces: Vec<Face>,
}

#[derive(Serialize)]
struct PairData<'a> {
    name: &'a str,
    sliding: bool,
}

#[derive(Serialize)]
struct ValueData<'a> {
    friction: f64,
    /// Frequency in Hz, growth rate in 1/s, damping ratio, backward error, whether unstable, branch from 1 or null.
    modes: Vec<(f64, f64, f64, f64, bool, Option<usize>)>,
    /// Open, stick, slip; normal and tangential force in N, closed area in m2, peak pressure in Pa.
    pairs: Vec<[f64; 7]>,
    checks: Vec<&'a str>,
    /// Label, whether converged, iterations, last residual.
    steps: Vec<(&'a str, bool, usize, f64)>,
    /// Hz, expected, found.
    count: Option<(f64, usize, usize)>,
    seconds: f64,
}

#[derive(Serialize)]
struct InstabilityData {
    name: String,
    /// Its modes at the frictions asked for.
    modes: Vec<String>,
    worst: String,
    /// Its branch and its partner's.
    branches: Vec<usize>,
}

#[derive(Serialize)]
struct SourceData<'a> {
    kind: &'static str,
    name: &'a str,
    kinetic: f64,
    strain: f64,
    fed: f64,
    damped: f64,
    /// How growth rate (1/s) and frequency (rad/s) follow friction, and a factor on damping, stiffness and mass.
    slopes: [Option<[f64; 2]>; 4],
}

impl<'a> Data<'a> {
    /// Gathers it.
    pub fn new(findings: &'a Findings) -> Data<'a> {
        let about = &findings.results.about;
        let instabilities = findings.instabilities.iter();
        let rows = findings.results.values.iter().zip(&findings.branch_of);
        Data {
            parts: about.parts.iter().map(|part| part.name.as_str()).collect(),
            pairs: about.pairs.iter().map(|pair| PairData { name: &pair.name, sliding: pair.sliding }).collect(),
            values: rows.map(|(value, branches)| value_row(value, branches)).collect(),
            asked: &findings.asked,
            explained: explained(findings),
            instabilities: instabilities.map(|one| instability_row(findings, one)).collect(),
            surface: drawing::outer(findings.results),
            shapes: drawing::shapes(findings),
            faces: drawing::faces(findings),
        }
    }
}

fn value_row<'a>(value: &'a Value, branches: &[Option<usize>]) -> ValueData<'a> {
    let mode = |(mode, branch): (&ModeData, &Option<usize>)| {
        let numbers = (mode.frequency(), mode.growth_rate(), mode.damping_ratio());
        (numbers.0, numbers.1, numbers.2, mode.backward_error, mode.unstable, branch.map(|b| b + 1))
    };
    let pairs = value.pairs.iter().map(|forces| {
        let counts = [forces.counts.open, forces.counts.stick, forces.counts.slip].map(|n| n as f64);
        let [open, stick, slip] = counts;
        [open, stick, slip, forces.normal, forces.tangential, forces.closed_area, forces.peak_pressure]
    });
    let steps = value.steps.iter().map(|step| {
        let last = step.iterations.last().map_or(f64::NAN, |it| it.residual);
        (step.label.as_str(), step.converged, step.iterations.len().saturating_sub(1), last)
    });
    ValueData {
        friction: value.friction,
        modes: value.modes.iter().zip(branches).map(mode).collect(),
        pairs: pairs.collect(),
        checks: value.checks.lines().collect(),
        steps: steps.collect(),
        count: value.count.map(|count| (count.below, count.expected, count.found)),
        seconds: value.seconds,
    }
}

fn instability_row(findings: &Findings, one: &Instability) -> InstabilityData {
    let partner = findings.onset(one).and_then(|hopf| hopf.partner).map(|partner| partner.branch);
    let asked = one.modes.iter().filter(|place| findings.results.values[place.value].asked);
    InstabilityData {
        name: words::frequency(findings.mode(one.worst).frequency()),
        modes: asked.map(|place| place.name()).collect(),
        worst: one.worst.name(),
        branches: one.branch.into_iter().chain(partner).collect(),
    }
}

fn explained<'a>(findings: &'a Findings) -> BTreeMap<String, Vec<SourceData<'a>>> {
    let places = findings.results.values.iter().enumerate();
    let modes = places.flat_map(|(value, row)| (0..row.modes.len()).map(move |mode| Place { value, mode }));
    let told = modes.filter(|&place| !findings.mode(place).sources.is_empty());
    told.map(|place| (place.name(), findings.mode(place).sources.iter().map(source_row).collect())).collect()
}

fn source_row(source: &Source) -> SourceData<'_> {
    let (share, s) = (source.share, source.sensitivity);
    let slopes = [source.friction, s.map(|s| s.damping), s.map(|s| s.stiffness), s.map(|s| s.mass)];
    SourceData {
        kind: explain::kind(source.kind),
        name: &source.name,
        kinetic: share.kinetic,
        strain: share.strain,
        fed: share.fed,
        damped: share.damped,
        slopes: slopes.map(|slope| slope.map(|z| [z.re, z.im])),
    }
}
