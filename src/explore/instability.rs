//! The modes that are unstable at some points.

use serde::Serialize;

use super::predicted::Prediction;
use super::result::{PointMode, PointResult};
use super::sensitivity::Estimate;
use super::statistics::Probability;

/// A mode that is unstable at one point at least.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Instability {
    /// Number of the nominal mode, from 1; none for modes that were not recognised.
    pub nominal: Option<usize>,
    /// Its frequency at the nominal point, Hz.
    pub nominal_frequency_hz: Option<f64>,
    /// Its growth rate there, 1/s.
    pub nominal_growth_rate_per_s: Option<f64>,
    /// That it is unstable.
    pub probability: Probability,
    /// The same from points and derivatives together, where its interval is narrower.
    pub by_derivatives: Option<Estimate>,
    /// Smallest and largest frequency where it is unstable, Hz.
    pub frequency_range_hz: [f64; 2],
    /// Its largest growth rate, 1/s.
    pub largest_growth_rate_per_s: f64,
    /// The point of that.
    pub worst: usize,
}

impl Instability {
    /// The place of its mode among those of the point where it grows fastest.
    pub fn worst_mode(&self, points: &[PointResult]) -> Option<usize> {
        let own = |mode: &PointMode| mode.unstable && mode.link.map(|link| link.nominal) == self.nominal;
        let modes = points.get(self.worst)?.modes()?.iter().enumerate().filter(|(_, mode)| own(mode));
        modes.max_by(|a, b| a.1.growth_rate().total_cmp(&b.1.growth_rate())).map(|(place, _)| place)
    }
}

/// The modes of the nominal point that are unstable anywhere, the most probable first, and those that are no mode of
/// it. Points have their numbers; `solved` are all that have modes, `sample` those of them that count for
/// probabilities.
pub(super) fn instabilities(
    nominal: &PointResult,
    solved: &[(usize, &PointResult)],
    sample: &[(usize, &PointResult)],
    prediction: Option<&Prediction>,
) -> Vec<Instability> {
    let unstable = |points: &[(usize, &PointResult)], of: Option<usize>| -> Vec<(usize, PointMode)> {
        let own = |mode: &&PointMode| mode.unstable && mode.link.map(|link| link.nominal) == of;
        let modes = |(number, point): &(usize, &PointResult)| {
            let number = *number;
            point.modes().into_iter().flatten().filter(own).map(move |mode| (number, *mode)).collect::<Vec<_>>()
        };
        points.iter().flat_map(modes).collect()
    };
    let n_nominal = nominal.modes().map_or(0, <[PointMode]>::len);
    let instability = |of: Option<usize>| {
        let found = unstable(solved, of);
        let (worst, largest) =
            found.iter().max_by(|a, b| a.1.growth_rate().total_cmp(&b.1.growth_rate())).map(|(n, mode)| (*n, *mode))?;
        let mut where_unstable: Vec<usize> = unstable(sample, of).iter().map(|(number, _)| *number).collect();
        where_unstable.dedup();
        let frequencies = || found.iter().map(|(_, mode)| mode.frequency());
        let own = of.and_then(|number| nominal.modes()?.get(number - 1));
        let probability = Probability::of(where_unstable.len(), sample.len());
        let by_derivatives = |mode| prediction?.probability((of? - 1, mode), sample, probability);
        Some(Instability {
            nominal: of,
            nominal_frequency_hz: own.map(PointMode::frequency),
            nominal_growth_rate_per_s: own.map(PointMode::growth_rate),
            probability,
            by_derivatives: own.and_then(by_derivatives),
            frequency_range_hz: [
                frequencies().fold(f64::INFINITY, f64::min),
                frequencies().fold(f64::NEG_INFINITY, f64::max),
            ],
            largest_growth_rate_per_s: largest.growth_rate(),
            worst,
        })
    };
    let mut all: Vec<Instability> = (1..=n_nominal).map(Some).chain([None]).filter_map(instability).collect();
    all.sort_by(|a, b| b.probability.value.total_cmp(&a.probability.value));
    all
}
