//! Which mode shapes of a study are kept, and which of them matter most.

use super::instability::Instability;
use super::result::{PointMode, PointResult};

/// Shapes are kept of so many unstable modes of a point.
const MAX_SHAPES: usize = 3;
/// One shape of each point of a study may take so much, bytes.
const MAX_BYTES: usize = 1 << 28;
/// A shape takes so much at a node, bytes: the complex displacements along three axes in single precision.
const BYTES_AT_A_NODE: usize = 24;

/// Whether a study of so many points keeps shapes at so many nodes: not where they would fill disks.
pub fn keeps_shapes(n_points: usize, n_nodes: usize) -> bool {
    n_points.saturating_mul(n_nodes * BYTES_AT_A_NODE) <= MAX_BYTES
}

/// A mode at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ModePlace {
    /// Number of the point.
    pub point: usize,
    /// Place among the modes of the point, from 0.
    pub mode: usize,
}

/// The places of those modes of a point whose shapes are kept, the largest growth rate first: of at most three unstable
/// modes, or of the mode of largest growth rate where none is unstable.
pub fn shaped_modes(modes: &[PointMode]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..modes.len()).collect();
    places.sort_by(|&a, &b| modes[b].growth_rate().total_cmp(&modes[a].growth_rate()).then(b.cmp(&a)));
    let unstable: Vec<usize> = places.iter().copied().filter(|&i| modes[i].unstable).take(MAX_SHAPES).collect();
    if unstable.is_empty() { places.into_iter().take(1).collect() } else { unstable }
}

/// All modes whose shapes are kept, those that matter most first: that of the nominal point, and of each instability
/// the strongest; then the first one of each other point; then the others; each by growth rate.
pub fn by_weight(points: &[PointResult], instabilities: &[Instability]) -> Vec<ModePlace> {
    let strongest: Vec<ModePlace> = instabilities
        .iter()
        .filter_map(|own| Some(ModePlace { point: own.worst, mode: own.worst_mode(points)? }))
        .collect();
    let mut weighted: Vec<(usize, f64, ModePlace)> = Vec::new();
    for (point, own) in points.iter().enumerate() {
        let modes = own.modes().unwrap_or_default();
        for (rank, mode) in shaped_modes(modes).into_iter().enumerate() {
            let place = ModePlace { point, mode };
            let is_first = (point, rank) == (0, 0) || strongest.contains(&place);
            let class = if is_first { 0 } else { 1 + rank.min(1) };
            weighted.push((class, modes[mode].growth_rate(), place));
        }
    }
    weighted.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)).then(a.2.cmp(&b.2)));
    weighted.into_iter().map(|(_, _, place)| place).collect()
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::explore::{Link, Outcome};

    /// Modes by growth rates, unstable above 0; each is the nominal mode of the same place.
    fn modes(growth_rates: &[f64]) -> Vec<PointMode> {
        let mode = |(nominal, &growth): (usize, &f64)| PointMode {
            lambda: Complex64::new(growth, 1e3),
            unstable: growth > 0.0,
            backward_error: 0.0,
            link: Some(Link { nominal, share: 1.0, doubtful: false }),
        };
        (1..).zip(growth_rates).map(mode).collect()
    }

    #[test]
    fn shapes_are_those_of_the_fastest_unstable_modes_or_of_the_one_that_decays_least() {
        let places = |growth_rates: &[f64]| shaped_modes(&modes(growth_rates));
        assert_eq!(places(&[-3.0, -1.0, -2.0]), [1]);
        assert_eq!(places(&[-3.0, 1.0, -2.0, 4.0]), [3, 1]);
        assert_eq!(places(&[5.0, 1.0, 2.0, 4.0, 3.0]), [0, 3, 4]);
        assert_eq!(places(&[]), [0; 0]);
        // By another criterion a mode that grows may count as stable.
        let mut own = modes(&[5.0, 1.0]);
        own[0].unstable = false;
        assert_eq!(shaped_modes(&own), [1]);
    }

    #[test]
    fn shapes_are_kept_up_to_a_quarter_of_a_gigabyte() {
        assert!(keeps_shapes(256, 6779) && keeps_shapes(11_184_810, 1) && keeps_shapes(10_000, 0));
        assert!(!keeps_shapes(11_184_811, 1) && !keeps_shapes(10_000, 1857) && !keeps_shapes(usize::MAX, 2));
    }

    #[test]
    fn the_nominal_point_and_the_strongest_of_each_instability_come_first() {
        let point = |growth_rates: &[f64]| PointResult { values: vec![], outcome: Outcome::Modes(modes(growth_rates)) };
        let failed = PointResult { values: vec![], outcome: Outcome::Failed("lost".into()) };
        let points = [point(&[-1.0, -2.0]), failed, point(&[9.0, 2.0]), point(&[8.0, 1.0]), point(&[-3.0, -4.0])];
        let solved: Vec<(usize, &PointResult)> = points.iter().enumerate().filter(|(i, _)| *i != 1).collect();
        let all = super::super::instability::instabilities(&points[0], &solved, &solved, None);
        assert_eq!(all.len(), 2);
        let order: Vec<(usize, usize)> = by_weight(&points, &all).iter().map(|own| (own.point, own.mode)).collect();
        assert_eq!(order, [(2, 0), (2, 1), (0, 0), (3, 0), (4, 0), (3, 1)]);
    }
}
