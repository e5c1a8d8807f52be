//! Points that close in on the boundary between stable and unstable.
//!
//! A point has the coordinates `u_i`, the probability that parameter i has a smaller value; so the unit cube is the
//! space of the parameters, scaled. The first points are those of a Sobol sequence. Then rounds follow:
//!
//! - Two points are *neighbours* where no other point lies between them: no other point forms an angle above 120
//!   degrees with the two. A point that has failed separates others, too. With 90 degrees that is the Gabriel graph
//!   (Gabriel and Sokal, Systematic Zoology 18 (1969)), which leaves gaps along the boundary: of two tight pairs, the
//!   stable point of the one and the unstable point of the other form 90 degrees with a third.
//! - Between neighbours of opposite verdict lies the boundary. A round bisects the seven widest of such pairs that are
//!   wider than the resolution, but none whose middle is nearer to one of the same round than half its width; and it
//!   has the next point of the sequence, which may meet another part of the boundary. A single last point bisects.
//! - Where all points have one verdict, a round has the next [`ROUND`] points of the sequence.
//!
//! A round depends on the verdicts before it and on nothing else: neither on the number of ranks nor on interruptions.

use serde::Serialize;

use super::design::{AdaptiveRule, Design, DesignKind};
use super::distribution::Distribution;
use super::result::PointResult;
use super::study::Study;
use crate::Result;

/// The cosine of 120 degrees.
const WIDEST_COSINE: f64 = -0.5;
/// Points of a round.
const ROUND: usize = 8;

/// Two neighbours of opposite verdict; between them is the boundary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BoundaryPair {
    /// Number of the stable point.
    pub stable: usize,
    /// Number of the unstable point.
    pub unstable: usize,
    /// Their distance in the unit cube.
    pub distance: f64,
    /// Values of the parameters in their middle.
    pub middle: Vec<f64>,
}

/// The points of an adaptive design as they come.
#[derive(Debug, Clone)]
pub struct BoundarySearch {
    design: Design,
    rule: AdaptiveRule,
    distributions: Vec<Distribution>,
    /// Of all points so far, the nominal one not among them.
    coordinates: Vec<Vec<f64>>,
    /// How many of them are of the sequence.
    n_of_sequence: usize,
}

/// A pair of points by their places.
struct Edge {
    ends: [usize; 2],
    square: f64,
}

impl BoundarySearch {
    /// With the points of the start; none for a design that is not adaptive.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for more dimensions than the Sobol sequence has.
    pub(super) fn new(study: &Study) -> Result<Option<BoundarySearch>> {
        let DesignKind::Adaptive(rule) = study.design.kind else { return Ok(None) };
        let distributions: Vec<Distribution> = study.parameters.iter().map(|own| own.distribution.clone()).collect();
        let coordinates = study.design.sobol(rule.n_start, distributions.len())?;
        let n_of_sequence = rule.n_start;
        Ok(Some(BoundarySearch { design: study.design.clone(), rule, distributions, coordinates, n_of_sequence }))
    }

    /// Adds the points of the next round, and gives the values of their parameters; none at the end. `points` are those
    /// of the design so far, which are finished.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for more points than the Sobol sequence has.
    ///
    /// # Panics
    /// Where there are fewer points than were given.
    pub(super) fn next(&mut self, points: &[PointResult]) -> Result<Vec<Vec<f64>>> {
        let n = ROUND.min(self.rule.n_points - self.coordinates.len());
        if n == 0 {
            return Ok(Vec::new());
        }
        let verdicts: Vec<Option<bool>> = points.iter().map(verdict).collect();
        let has = |own: bool| verdicts.contains(&Some(own));
        let mut added = Vec::new();
        if has(true) && has(false) {
            added = self.middles(&verdicts, (n - 1).max(1));
            if added.is_empty() {
                return Ok(added);
            }
        }
        let n_more = if added.is_empty() { n } else { (n - added.len()).min(1) };
        let all = self.design.sobol(self.n_of_sequence + n_more, self.distributions.len())?;
        added.extend_from_slice(&all[self.n_of_sequence..]);
        self.n_of_sequence = all.len();
        self.coordinates.extend(added.iter().cloned());
        Ok(added.iter().map(|point| self.values(point)).collect())
    }

    /// Neighbours of opposite verdict at the end, the widest apart first.
    fn boundary(&self, points: &[PointResult]) -> Vec<BoundaryPair> {
        let verdicts: Vec<Option<bool>> = points.iter().map(verdict).collect();
        let pair = |edge: Edge| {
            let [stable, unstable] = edge.ends.map(|end| end + 1);
            let middle = self.values(&self.middle(edge.ends));
            BoundaryPair { stable, unstable, distance: edge.square.sqrt(), middle }
        };
        self.opposite(&verdicts).into_iter().filter(|edge| self.are_neighbours(edge)).map(pair).collect()
    }

    fn values(&self, point: &[f64]) -> Vec<f64> {
        self.distributions.iter().zip(point).map(|(own, u)| own.quantile(*u)).collect()
    }

    /// The middles of at most n pairs.
    fn middles(&self, verdicts: &[Option<bool>], n: usize) -> Vec<Vec<f64>> {
        let mut middles: Vec<Vec<f64>> = Vec::new();
        for edge in self.opposite(verdicts) {
            if middles.len() == n || edge.square <= self.rule.resolution.powi(2) {
                break;
            }
            let middle = self.middle(edge.ends);
            let is_apart = middles.iter().all(|other| square(other, &middle) >= 0.25 * edge.square);
            if is_apart && self.are_neighbours(&edge) {
                middles.push(middle);
            }
        }
        middles
    }

    /// All pairs of a stable and an unstable point, the widest first.
    fn opposite(&self, verdicts: &[Option<bool>]) -> Vec<Edge> {
        let of = |own: bool| verdicts.iter().enumerate().filter(move |(_, v)| **v == Some(own)).map(|(i, _)| i);
        let edge =
            |i: usize, j: usize| Edge { ends: [i, j], square: square(&self.coordinates[i], &self.coordinates[j]) };
        let mut edges: Vec<Edge> =
            of(false).flat_map(|i| of(true).map(move |j| (i, j))).map(|(i, j)| edge(i, j)).collect();
        edges.sort_by(|a, b| b.square.total_cmp(&a.square).then(a.ends.cmp(&b.ends)));
        edges
    }

    fn middle(&self, [i, j]: [usize; 2]) -> Vec<f64> {
        self.coordinates[i].iter().zip(&self.coordinates[j]).map(|(a, b)| 0.5 * (a + b)).collect()
    }

    fn are_neighbours(&self, edge: &Edge) -> bool {
        let [a, b] = edge.ends.map(|end| &self.coordinates[end]);
        // cos(angle) = (|a - p|^2 + |b - p|^2 - |a - b|^2) / (2 |a - p| |b - p|)
        let is_between = |p: &Vec<f64>| {
            let (to_a, to_b) = (square(a, p), square(b, p));
            to_a + to_b - edge.square < 2.0 * WIDEST_COSINE * (to_a * to_b).sqrt()
        };
        !self.coordinates.iter().any(is_between)
    }
}

impl Study {
    /// Neighbours of opposite verdict among the finished points of an adaptive design, the widest apart first.
    pub(super) fn boundary(&self, points: &[PointResult]) -> Vec<BoundaryPair> {
        let Ok(Some(mut refinement)) = BoundarySearch::new(self) else { return Vec::new() };
        while refinement.coordinates.len() < points.len() {
            let n = refinement.coordinates.len();
            match refinement.next(&points[..n]) {
                Ok(added) if !added.is_empty() => {}
                _ => return Vec::new(),
            }
        }
        refinement.boundary(points)
    }
}

/// Whether a point is unstable; none where it has failed.
fn verdict(point: &PointResult) -> Option<bool> {
    point.modes().map(|_| point.is_unstable())
}

fn square(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::super::{Outcome, PointMode};
    use super::*;

    fn study(rule: AdaptiveRule, n_parameters: usize) -> Study {
        let place = tempfile::tempdir().unwrap();
        let design = format!(
            "kind = \"adaptive\"\npoints = {}\nstart = {}\nresolution = {}\nseed = 2\n",
            rule.n_points, rule.n_start, rule.resolution
        );
        let parameter = |i: usize| format!("[parameter.p{i}]\nkey = \"k{i}.a\"\nuniform = [{i}, {}]\n", i + 1);
        let parameters: String = (0..n_parameters).map(parameter).collect();
        let path = place.path().join("explore.toml");
        std::fs::write(&path, format!("model = \"m.toml\"\n[design]\n{design}{parameters}")).unwrap();
        super::super::read(&path).unwrap()
    }

    /// A point with one mode of a growth rate; none: it has failed.
    fn point(values: &[f64], growth: Option<f64>) -> PointResult {
        let mode = |growth: f64| PointMode {
            lambda: Complex64::new(growth, 1e3),
            unstable: growth > 0.0,
            backward_error: 0.0,
            link: None,
        };
        let failed = || Outcome::Failed("no equilibrium".into());
        let outcome = growth.map_or_else(failed, |growth| Outcome::Modes(vec![mode(growth)]));
        PointResult { values: values.to_vec(), outcome }
    }

    /// All points of a study.
    fn run(study: &Study, growth: impl Fn(&[f64]) -> Option<f64>) -> Vec<PointResult> {
        let mut refinement = BoundarySearch::new(study).unwrap().unwrap();
        let mut added: Vec<Vec<f64>> = refinement.coordinates.iter().map(|point| refinement.values(point)).collect();
        let mut points = Vec::new();
        while !added.is_empty() {
            points.extend(added.iter().map(|values| point(values, growth(values))));
            added = refinement.next(&points).unwrap();
        }
        points
    }

    const RULE: AdaptiveRule = AdaptiveRule { n_points: 160, n_start: 16, resolution: 0.02 };

    /// Hoffmann's model is unstable above mu = 3/4, whatever the stiffness; here mu = 0.4 + 0.5 u.
    #[test]
    fn hoffmanns_boundary_is_found_to_the_resolution() {
        let study = study(RULE, 2);
        let hoffmann = |p: &[f64]| {
            let mu = 0.4 + 0.5 * p[0];
            Some(4.0 * mu / 3.0 - 1.0)
        };
        let points = run(&study, hoffmann);
        let boundary = study.boundary(&points);
        let error = |pair: &BoundaryPair| (0.4 + 0.5 * pair.middle[0] - 0.75).abs();
        let widest = boundary[0].distance;
        assert!(points.len() <= 160 && widest < 0.2, "{} points, {widest}", points.len());
        assert!(boundary.iter().all(|pair| error(pair) <= 0.25 * pair.distance + 1e-12));
        // The other parameter is from 1 to 2; near its ends there are no pairs.
        let covers = |y: f64| boundary.iter().any(|pair| (pair.middle[1] - y).abs() < 0.1 && pair.distance < 0.1);
        assert!((3..10).all(|i| covers(1.0 + 0.1 * f64::from(i))), "{boundary:?}");
    }

    #[test]
    fn one_parameter_is_bisected_to_the_resolution_and_no_further() {
        let study = study(AdaptiveRule { n_points: 100, n_start: 4, resolution: 1e-3 }, 1);
        let points = run(&study, |p| Some(p[0] - 0.337));
        let boundary = study.boundary(&points);
        assert_eq!(boundary.len(), 1);
        assert!(boundary[0].distance <= 1e-3 && (boundary[0].middle[0] - 0.337).abs() <= 5e-4, "{boundary:?}");
        assert!(points.len() <= 4 + 2 * 9, "{}", points.len());
        assert!(!points[boundary[0].stable - 1].is_unstable() && points[boundary[0].unstable - 1].is_unstable());
    }

    #[test]
    fn a_round_bisects_and_has_the_next_point_of_the_sequence() {
        let study = study(RULE, 2);
        let mut refinement = BoundarySearch::new(&study).unwrap().unwrap();
        let start: Vec<Vec<f64>> = refinement.coordinates.iter().map(|point| refinement.values(point)).collect();
        let points: Vec<PointResult> = start.iter().map(|values| point(values, Some(values[0] - 0.5))).collect();
        let added = refinement.next(&points).unwrap();
        assert!((2..=ROUND).contains(&added.len()));
        assert_eq!(refinement.coordinates.last(), study.design.sobol(17, 2).unwrap().last());
    }

    #[test]
    fn a_single_last_point_bisects() {
        let study = study(AdaptiveRule { n_points: 5, n_start: 4, resolution: 1e-3 }, 1);
        let points = run(&study, |p| Some(p[0] - 0.337));
        let mut start: Vec<f64> = points[..4].iter().map(|point| point.values[0]).collect();
        start.sort_by(f64::total_cmp);
        let above = start.iter().position(|p| *p > 0.337).unwrap();
        let middle = 0.5 * (start[above - 1] + start[above]);
        assert!(points.len() == 5 && (points[4].values[0] - middle).abs() < 1e-12, "{start:?} {points:?}");
    }

    #[test]
    fn where_all_is_stable_the_sequence_goes_on_to_the_last_point() {
        let study = study(AdaptiveRule { n_points: 37, ..RULE }, 2);
        let points = run(&study, |_| Some(-1.0));
        let expected = study.design.sobol(37, 2).unwrap();
        assert_eq!(points.len(), 37);
        assert!(points.iter().zip(&expected).all(|(point, u)| (point.values[0] - u[0]).abs() < 1e-12));
        assert_eq!(study.boundary(&points), []);
    }

    #[test]
    fn a_point_that_fails_is_not_tried_again() {
        let study = study(AdaptiveRule { n_points: 100, n_start: 4, resolution: 1e-3 }, 1);
        // Nothing is known around the boundary.
        let points = run(&study, |p| ((p[0] - 0.5).abs() > 0.1).then_some(p[0] - 0.5));
        assert!(points.len() < 30, "{}", points.len());
        let mut values: Vec<f64> = points.iter().map(|point| point.values[0]).collect();
        values.sort_by(f64::total_cmp);
        assert!(values.windows(2).all(|pair| pair[1] - pair[0] > 1e-6));
    }

    #[test]
    fn a_circle_is_found_and_the_same_points_have_the_same_boundary() {
        let study = study(RULE, 2);
        let circle = |p: &[f64]| Some((p[0] - 0.5).hypot(p[1] - 1.5) - 0.3);
        let points = run(&study, circle);
        let again = run(&study, circle);
        assert!(points == again && study.boundary(&points) == study.boundary(&again));
        let off = |pair: &BoundaryPair| ((pair.middle[0] - 0.5).hypot(pair.middle[1] - 1.5) - 0.3).abs();
        assert!(study.boundary(&points).iter().all(|pair| off(pair) < 0.6 * pair.distance));
    }
}
