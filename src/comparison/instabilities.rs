//! The modes of a reference that grow, and what becomes of them in another model of the same brake.

use num_complex::Complex64;
use serde::Serialize;

use super::{ComparedMode, Comparison, ComparisonAtValue, ModePair};
use crate::results::{ModeData, Results, Value};

/// A mode of a reference that grows at some friction value, followed over all friction values asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceInstability {
    /// Friction value, and number of the mode at it, from 0.
    pub places: Vec<(f64, usize)>,
}

/// A mode at one friction value, in the reference or in another model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// Hz.
    #[serde(rename = "frequency_hz")]
    pub frequency: f64,
    /// 1/s.
    #[serde(rename = "growth_rate_per_s")]
    pub growth_rate: f64,
    /// Whether it grows.
    pub unstable: bool,
    /// MAC with the reference's mode.
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

/// The modes that are the points of a branch, at the friction values asked for, where they are in the band.
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
            Some(CurvePoint::new(friction, &ComparedMode::new(i, &value.modes[i]), 1.0))
        };
        self.places.iter().filter_map(point).collect()
    }

    /// Its partners in the second of two results that were compared; none where there is no partner.
    pub fn in_other(&self, comparison: &Comparison) -> Vec<CurvePoint> {
        let point = |&(friction, i): &(f64, usize)| {
            let at = comparison.values.iter().find(|at| at.friction == friction)?;
            let ModePair { b, mac, .. } = at.pairs.iter().find(|pair| pair.a.mode == i + 1)?;
            Some(CurvePoint::new(friction, b, *mac))
        };
        self.places.iter().filter_map(point).collect()
    }
}

/// Modes of the second result that grow without their partner in the first one growing, or without any.
pub fn spurious(comparison: &Comparison) -> Vec<CurvePoint> {
    let at_one = |at: &ComparisonAtValue| {
        let paired = at.pairs.iter().filter(|pair| !pair.a.unstable).map(|pair| (&pair.b, pair.mac));
        let all = paired.chain(at.unmatched[1].iter().map(|mode| (mode, 0.0)));
        let unstable = all.filter(|(mode, _)| mode.unstable);
        unstable.map(|(mode, mac)| CurvePoint::new(at.friction, mode, mac)).collect::<Vec<_>>()
    };
    comparison.values.iter().flat_map(at_one).collect()
}

impl CurvePoint {
    fn new(friction: f64, mode: &ComparedMode, mac: f64) -> CurvePoint {
        let ComparedMode { frequency, growth_rate, unstable, .. } = *mode;
        CurvePoint { friction, frequency, growth_rate, unstable, mac }
    }
}
