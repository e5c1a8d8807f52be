//! The modes of a reference that grow, and what becomes of them in another model of the same brake.

use num_complex::Complex64;
use serde::Serialize;

use super::Comparison;
use crate::results::{ModeData, Results, Value};

/// A mode of a reference that grows at some friction, followed over all frictions asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceInstability {
    /// Friction, and number of the mode at it, from 0.
    pub places: Vec<(f64, usize)>,
}

/// A mode at one friction, in the reference or in another model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Friction of the swept pairs.
    pub friction: f64,
    /// Hz.
    pub frequency: f64,
    /// 1/s.
    pub growth_rate: f64,
    /// Whether it grows.
    pub unstable: bool,
    /// What it has in common with the reference's mode.
    pub mac: f64,
}

/// The `n` instabilities of the lowest frequencies: branches where modes were followed, else single modes of a single
/// friction.
pub fn lowest(reference: &Results, n: usize) -> Vec<ReferenceInstability> {
    let asked: Vec<&Value> = reference.values.iter().filter(|value| value.asked).collect();
    let mut found = match &reference.diagram {
        Some(diagram) => diagram
            .branches
            .iter()
            .map(|branch| along(branch.points.iter().map(|p| (p.value, p.lambda)), &asked))
            .collect(),
        None => asked.iter().flat_map(|value| (0..value.modes.len()).map(|i| vec![(*value, i)])).collect::<Vec<_>>(),
    };
    let first_unstable = |places: &[(&Value, usize)]| {
        let mut modes = places.iter().map(|(value, i)| &value.modes[*i]);
        modes.find(|mode| mode.unstable).map(ModeData::frequency)
    };
    found.retain(|places| first_unstable(places).is_some());
    found.sort_by(|a, b| first_unstable(a).partial_cmp(&first_unstable(b)).expect("frequencies are numbers"));
    found.truncate(n);
    let places = |found: Vec<(&Value, usize)>| found.into_iter().map(|(value, i)| (value.friction, i)).collect();
    found.into_iter().map(|one| ReferenceInstability { places: places(one) }).collect()
}

/// The modes that are the points of a branch, at the frictions asked for, where they are in the band.
fn along<'r>(points: impl Iterator<Item = (f64, Complex64)>, asked: &[&'r Value]) -> Vec<(&'r Value, usize)> {
    let place = |(friction, lambda): (f64, Complex64)| {
        let value = asked.iter().find(|value| value.friction == friction)?;
        let i = value.modes.iter().position(|mode| mode.lambda == lambda)?;
        Some((*value, i))
    };
    points.filter_map(place).collect()
}

impl ReferenceInstability {
    /// The instability in the reference itself.
    pub fn of(&self, reference: &Results) -> Vec<CurvePoint> {
        let point = |&(friction, i): &(f64, usize)| {
            let value = reference.values.iter().find(|value| value.friction == friction)?;
            let mode = &value.modes[i];
            let (frequency, growth_rate) = (mode.frequency(), mode.growth_rate());
            Some(CurvePoint { friction, frequency, growth_rate, unstable: mode.unstable, mac: 1.0 })
        };
        self.places.iter().filter_map(point).collect()
    }

    /// Its partners in the second of two results that were compared; none where there is no partner.
    pub fn in_other(&self, comparison: &Comparison) -> Vec<CurvePoint> {
        let point = |&(friction, i): &(f64, usize)| {
            let at = comparison.frictions.iter().find(|at| at.friction == friction)?;
            let pair = at.pairs.iter().find(|pair| pair.modes[0] == i)?;
            let (frequency, growth_rate) = (pair.frequencies[1], pair.growth_rates[1]);
            Some(CurvePoint { friction, frequency, growth_rate, unstable: pair.unstable[1], mac: pair.mac })
        };
        self.places.iter().filter_map(point).collect()
    }
}

/// Modes of the second result that grow without their partner in the first one growing, or without any: friction, Hz,
/// 1/s.
pub fn spurious(comparison: &Comparison) -> Vec<[f64; 3]> {
    let at_one = |at: &super::ComparisonAtValue| {
        let pairs = at.pairs.iter().filter(|pair| pair.unstable == [false, true]);
        let paired = pairs.map(|pair| [at.friction, pair.frequencies[1], pair.growth_rates[1]]);
        let lone = at.unmatched[1].iter().filter(|lone| lone.unstable);
        paired.chain(lone.map(|lone| [at.friction, lone.frequency, lone.growth_rate])).collect::<Vec<_>>()
    };
    comparison.frictions.iter().flat_map(at_one).collect()
}
