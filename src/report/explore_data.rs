//! What the program of the page of a study of many parameters reads: one value of JSON.

use std::collections::BTreeMap;

use serde::Serialize;

use super::drawing::{Outer, outer, packed_shape};
use crate::explore::{HopfCurves, ModePlace, Outcome, PointMode, PointResult, Study};
use crate::results::Exploration;

/// The modes of all points are on the page where they are no more than these; else the unstable ones alone.
pub(super) const MAX_MODES: usize = 100_000;

/// What the scripts draw.
#[derive(Serialize)]
pub(super) struct Data<'a> {
    parameters: Vec<&'a str>,
    points: Vec<PointData<'a>>,
    /// Levels of each of two parameters, where the design is their grid.
    grid: Option<[Vec<f64>; 2]>,
    /// Hopf points on a map, and the pairs of them that lines join.
    hopf: &'a HopfCurves,
    surface: Option<Outer>,
    /// Shapes by the numbers of their points and modes, "point-mode".
    shapes: BTreeMap<String, String>,
}

#[derive(Serialize)]
struct PointData<'a> {
    values: &'a [f64],
    growth: Option<f64>,
    frequency: Option<f64>,
    unstable: bool,
    failure: Option<&'a str>,
    modes: Vec<ModeDatum>,
}

/// Number from 1, frequency, growth rate, whether it is unstable, number of the nominal mode, whether that is doubtful.
#[derive(Debug, PartialEq, Serialize)]
struct ModeDatum(usize, f64, f64, bool, Option<usize>, bool);

impl<'a> Data<'a> {
    /// Gathers it.
    pub(super) fn new(study: &'a Study, found: &'a Exploration) -> Data<'a> {
        let is_shortened = is_shortened(&found.points);
        let shapes: BTreeMap<String, String> =
            found.shapes.iter().map(|own| (name(own.place), packed_shape(&own.shape))).collect();
        let point = |(number, point): (usize, &'a PointResult)| PointData {
            values: &point.values,
            growth: point.critical().map(PointMode::growth_rate),
            frequency: point.critical().map(PointMode::frequency),
            unstable: point.is_unstable(),
            failure: reason(point),
            modes: mode_data(point, |mode| {
                !is_shortened || shapes.contains_key(&name(ModePlace { point: number, mode }))
            }),
        };
        Data {
            parameters: study.parameters.iter().map(|own| own.name.as_str()).collect(),
            points: found.points.iter().enumerate().map(point).collect(),
            grid: study.plane(),
            hopf: &found.answers.hopf,
            surface: outer(&found.surface, &found.about.parts),
            shapes,
        }
    }
}

/// The name of a mode among the shapes: the number of its point, and its own from 1.
fn name(place: ModePlace) -> String {
    format!("{}-{}", place.point, place.mode + 1)
}

/// Whether the points have so many modes that stable ones are left out.
pub(super) fn is_shortened(points: &[PointResult]) -> bool {
    points.iter().filter_map(PointResult::modes).map(<[PointMode]>::len).sum::<usize>() > MAX_MODES
}

/// The modes of a point that are unstable or wanted by their places, with their numbers in modes.csv.
fn mode_data(point: &PointResult, is_wanted: impl Fn(usize) -> bool) -> Vec<ModeDatum> {
    let datum = |(place, mode): (usize, &PointMode)| {
        let (nominal, doubtful) = (mode.link.map(|link| link.nominal), mode.link.is_some_and(|link| link.doubtful));
        ModeDatum(place + 1, mode.frequency(), mode.growth_rate(), mode.unstable, nominal, doubtful)
    };
    let modes = point.modes().unwrap_or_default().iter().enumerate();
    modes.filter(|(place, mode)| mode.unstable || is_wanted(*place)).map(datum).collect()
}

/// Why a point has no modes.
pub(super) fn reason(point: &PointResult) -> Option<&str> {
    match &point.outcome {
        Outcome::Failed(reason) => Some(reason),
        Outcome::Modes(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;

    #[test]
    fn stable_modes_that_are_not_wanted_are_left_out_and_the_others_keep_their_numbers() {
        let mode = |growth: f64| PointMode {
            lambda: Complex64::new(growth, 1e3),
            unstable: growth > 0.0,
            backward_error: 0.0,
            link: None,
        };
        let modes = Outcome::Modes([-1.0, 2.0, -3.0, 4.0].map(mode).into());
        let point = PointResult { values: Vec::new(), outcome: modes };
        let numbers = |wanted: &[usize]| -> Vec<usize> {
            mode_data(&point, |place| wanted.contains(&place)).iter().map(|datum| datum.0).collect()
        };
        assert_eq!((numbers(&[0, 2]), numbers(&[2]), numbers(&[])), (vec![1, 2, 3, 4], vec![2, 3, 4], vec![2, 4]));
        let is_shortened = |n: usize| is_shortened(&vec![point.clone(); n]);
        assert!(!is_shortened(MAX_MODES / 4) && is_shortened(MAX_MODES / 4 + 1));
        assert_eq!(name(ModePlace { point: 7, mode: 0 }), "7-1");
    }
}
