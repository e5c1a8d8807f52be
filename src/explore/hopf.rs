//! Hopf points over two parameters, located by solutions, and the curves that they make.
//!
//! A map begins with a grid. An edge of the grid, between two neighbouring points, has a Hopf point where a mode is
//! unstable at one end and no mode near its frequency is at the other. The *rate* at a point of the edge is the largest
//! growth rate near that frequency, so that it needs no link between modes, which is in doubt where two of them
//! coalesce. Each round solves one point of each such edge: by regula falsi that halves the rate of an end which stays
//! (the Illinois algorithm, Dowell and Jarratt, BIT 11 (1971), 168), or in the middle where the rate at the stable end
//! is 0, as it is without damping, or where halving every further interval is just enough: with light damping the rate
//! rises so steeply behind the Hopf point that regula falsi is slow. Two Hopf points of near frequencies on the edges
//! of one cell are joined by a line.

use serde::Serialize;

use super::design::DesignKind;
use super::result::{PointMode, PointResult};
use super::study::Study;

/// Modes are near each other where their frequencies differ by less than this part.
const NEAR: f64 = 0.05;
/// An interval is small enough that is this part of its edge.
const WIDTH: f64 = 2e-3;
/// Points of an edge at most.
const MAX_STEPS: usize = 12;
/// No step goes nearer to an end of the interval than this part of it.
const MARGIN: f64 = 0.02;
/// A rate is 0 that is smaller than this part of the larger one at the ends of the edge.
const SMALL: f64 = 1e-3;

/// A point at which a mode turns unstable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HopfPoint {
    /// Number of the nominal mode, from 1; none where it was not recognised.
    pub nominal: Option<usize>,
    /// Values of the two parameters.
    pub values: [f64; 2],
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

/// Hopf points over the plane of two parameters.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct HopfCurves {
    /// The points.
    pub points: Vec<HopfPoint>,
    /// Places of two points in the list that a line joins.
    pub lines: Vec<[usize; 2]>,
    /// Edges of the grid on which a mode turns unstable and its Hopf point is not found: a point of the edge has
    /// failed, or has no mode near the frequency.
    pub n_not_found: usize,
}

/// The points of a map as they come.
#[derive(Debug, Clone)]
pub struct HopfSearch {
    /// Levels of the two parameters.
    levels: [Vec<f64>; 2],
    /// None before the grid is finished.
    edges: Option<Vec<Edge>>,
}

/// The search on one edge.
#[derive(Debug, Clone)]
struct Edge {
    /// Places of the grid's points.
    grid: [usize; 2],
    nominal: Option<usize>,
    /// Frequency of the unstable mode, Hz.
    hertz: f64,
    /// The interval; the first is nearer to the first point of the grid.
    ends: [End; 2],
    /// The end that the last step has moved.
    moved: Option<usize>,
    /// Smaller rates are 0.
    least: f64,
    /// Whether the rate at the stable end is 0.
    is_flat: bool,
    /// Places of its own points among all.
    asked: Vec<usize>,
    is_open: bool,
}

#[derive(Debug, Clone, Copy)]
struct End {
    /// From 0 to 1 along the edge.
    place: f64,
    rate: f64,
    hertz: f64,
}

impl HopfSearch {
    /// None for a design that is no map.
    pub(super) fn new(study: &Study) -> Option<HopfSearch> {
        let is_map = matches!(study.design.kind, DesignKind::Map { .. });
        study.plane().filter(|_| is_map).map(|levels| HopfSearch { levels, edges: None })
    }

    /// Adds the points of the next round; none at the end. `points` are those of the design so far, which are finished.
    pub(super) fn next(&mut self, points: &[PointResult]) -> Vec<Vec<f64>> {
        match &mut self.edges {
            None => self.edges = Some(edges(&self.levels, points)),
            Some(edges) => edges.iter_mut().filter(|edge| edge.is_open).for_each(|edge| edge.take(points)),
        }
        let mut added = Vec::new();
        for edge in self.edges.iter_mut().flatten().filter(|edge| edge.is_open) {
            edge.asked.push(points.len() + added.len());
            added.push(at(edge.grid, points, edge.next_place()).to_vec());
        }
        added
    }

    /// What was found, from all points of the design.
    fn curves(&self, points: &[PointResult]) -> HopfCurves {
        let (edges, not_found): (Vec<&Edge>, Vec<&Edge>) =
            self.edges.iter().flatten().partition(|edge| edge.width() <= WIDTH);
        let point = |edge: &&Edge| {
            let share = edge.crossing();
            let [a, b] = edge.ends;
            let frequency_hz = a.hertz + share * (b.hertz - a.hertz);
            let values = at(edge.grid, points, a.place + share * (b.place - a.place));
            HopfPoint { nominal: edge.nominal, values, frequency_hz }
        };
        let points: Vec<HopfPoint> = edges.iter().map(point).collect();
        let [n, m] = [self.levels[0].len(), self.levels[1].len()];
        let mut lines = Vec::new();
        for corner in (0..n - 1).flat_map(|i| (0..m - 1).map(move |j| i * m + j)) {
            let corners = [corner, corner + 1, corner + m, corner + m + 1];
            let is_own = |k: &usize| edges[*k].grid.iter().all(|end| corners.contains(end));
            let mut own: Vec<usize> = (0..edges.len()).filter(is_own).collect();
            own.sort_by(|a, b| points[*a].frequency_hz.total_cmp(&points[*b].frequency_hz));
            while let [a, b, ..] = own[..] {
                let are_near = near(points[a].frequency_hz, points[b].frequency_hz);
                own.drain(..if are_near { 2 } else { 1 });
                lines.extend(are_near.then_some([a, b]));
            }
        }
        HopfCurves { points, lines, n_not_found: not_found.len() }
    }
}

impl Edge {
    /// The search for a Hopf point of a mode that is unstable at one end; none where one near it is at the other.
    fn new(grid: [usize; 2], points: &[PointResult], unstable_end: usize, mode: &PointMode) -> Option<Edge> {
        let hertz = mode.frequency();
        let ends = grid.map(|end| rate(&points[end], hertz, 0.0));
        let [Some(first), Some(second)] = ends else { return None };
        let least = SMALL * first.rate.abs().max(second.rate.abs());
        let ends = [first, End { place: 1.0, ..second }];
        let [unstable, stable] = [ends[unstable_end].rate, ends[1 - unstable_end].rate];
        let (nominal, is_flat) = (mode.link.map(|link| link.nominal), stable >= -least);
        let edge = Edge { grid, nominal, hertz, ends, moved: None, least, is_flat, asked: Vec::new(), is_open: true };
        (unstable > 0.0 && stable <= 0.0).then_some(edge)
    }

    /// Reads the result of the point that was asked for last.
    fn take(&mut self, points: &[PointResult]) {
        let Some(&number) = self.asked.last() else { return };
        let place = self.next_place();
        let Some(found) = rate(&points[number], self.hertz, place) else {
            self.is_open = false;
            return;
        };
        if !self.is_flat && found.rate.abs() <= self.least {
            self.ends = [found; 2];
        } else {
            let own = usize::from((found.rate > 0.0) == (self.ends[1].rate > 0.0));
            if self.moved == Some(own) {
                self.ends[1 - own].rate *= 0.5;
            }
            (self.ends[own], self.moved) = (found, Some(own));
        }
        self.is_open = self.width() > WIDTH && self.asked.len() < MAX_STEPS;
    }

    fn width(&self) -> f64 {
        self.ends[1].place - self.ends[0].place
    }

    /// Where the line through the rates of both ends is zero, from 0 to 1 between them; the middle where one is 0.
    fn crossing(&self) -> f64 {
        let [a, b] = self.ends.map(|end| end.rate);
        if self.is_flat || a == b { 0.5 } else { a / (a - b) }
    }

    /// The place of the point that is asked for last: where the line is zero, or the middle where so many halves as
    /// there are steps after it would not be enough.
    fn next_place(&self) -> f64 {
        let n_after = MAX_STEPS.saturating_sub(self.asked.len());
        let must_halve = self.width() > WIDTH * 2f64.powi(n_after as i32);
        let share = if must_halve { 0.5 } else { self.crossing().clamp(MARGIN, 1.0 - MARGIN) };
        self.ends[0].place + share * self.width()
    }
}

/// The largest growth rate near a frequency, Hz, not above 0 where that mode counts as stable, at a place of an edge;
/// none where the point has no such mode.
fn rate(point: &PointResult, hertz: f64, place: f64) -> Option<End> {
    let own = point.modes()?.iter().filter(|mode| near(mode.frequency(), hertz));
    let larger =
        |a: &&PointMode, b: &&PointMode| a.unstable.cmp(&b.unstable).then(a.growth_rate().total_cmp(&b.growth_rate()));
    let mode = own.max_by(larger)?;
    let rate = if mode.unstable { mode.growth_rate().max(0.0) } else { mode.growth_rate().min(0.0) };
    Some(End { place, rate, hertz: mode.frequency() })
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < NEAR * a.max(b)
}

/// The edges of a grid that a mode turns unstable on. The last parameter varies first.
fn edges([rows, columns]: &[Vec<f64>; 2], points: &[PointResult]) -> Vec<Edge> {
    let (n, m) = (rows.len(), columns.len());
    let along = (0..n).flat_map(|i| (1..m).map(move |j| [i * m + j - 1, i * m + j]));
    let across = (1..n).flat_map(|i| (0..m).map(move |j| [(i - 1) * m + j, i * m + j]));
    let mut found: Vec<Edge> = Vec::new();
    for grid in along.chain(across) {
        for (end, number) in grid.into_iter().enumerate() {
            for mode in points[number].modes().unwrap_or_default().iter().filter(|mode| mode.unstable) {
                let is_known = found.iter().any(|edge| edge.grid == grid && near(edge.hertz, mode.frequency()));
                found.extend((!is_known).then(|| Edge::new(grid, points, end, mode)).flatten());
            }
        }
    }
    found
}

/// The values at a place of an edge.
fn at(grid: [usize; 2], points: &[PointResult], place: f64) -> [f64; 2] {
    let [a, b] = grid.map(|end| &points[end].values);
    [0, 1].map(|k| a[k] + place * (b[k] - a[k]))
}

impl Study {
    /// The Hopf points of a map, from all of its points; empty for another design.
    pub(super) fn hopf(&self, points: &[PointResult]) -> HopfCurves {
        let Some(mut search) = HopfSearch::new(self) else { return HopfCurves::default() };
        let mut n = search.levels.iter().map(Vec::len).product();
        while n <= points.len() {
            match search.next(&points[..n]).len() {
                0 => return search.curves(points),
                n_added => n += n_added,
            }
        }
        HopfCurves::default()
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;
    use std::f64::consts::TAU;

    use super::super::Outcome;
    use super::*;

    fn study(n_levels: usize) -> Study {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("explore.toml");
        let text = format!(
            "model = \"m.toml\"\n[design]\nkind = \"map\"\nlevels = {n_levels}\n\
             [parameter.p]\nkey = \"k.a\"\nuniform = [0, 2]\n[parameter.q]\nkey = \"k.b\"\nuniform = [10, 30]\n"
        );
        std::fs::write(&path, text).unwrap();
        super::super::read(&path).unwrap()
    }

    /// A point with modes of these frequencies (Hz) and growth rates; none: it has failed.
    fn point(values: &[f64], modes: Option<&[[f64; 2]]>) -> PointResult {
        let mode = |&[hertz, growth]: &[f64; 2]| PointMode {
            lambda: Complex64::new(growth, TAU * hertz),
            unstable: growth > 1e-9,
            backward_error: 0.0,
            link: None,
        };
        let failed = || Outcome::Failed("no equilibrium".into());
        let outcome = modes.map_or_else(failed, |modes| Outcome::Modes(modes.iter().map(mode).collect()));
        PointResult { values: values.to_vec(), outcome }
    }

    /// The Hopf points of a study, and the number of its points.
    fn run(study: &Study, modes: impl Fn(f64, f64) -> Option<Vec<[f64; 2]>>) -> (HopfCurves, usize) {
        let mut search = HopfSearch::new(study).unwrap();
        let distributions: Vec<_> = study.parameters.iter().map(|own| &own.distribution).collect();
        let mut added = study.design.points(&distributions, &[1.0, 20.0]).unwrap();
        let mut points: Vec<PointResult> = Vec::new();
        while !added.is_empty() {
            points.extend(added.iter().map(|values| point(values, modes(values[0], values[1]).as_deref())));
            added = search.next(&points);
        }
        assert_eq!(study.hopf(&points), search.curves(&points), "the points tell the search again");
        (study.hopf(&points), points.len())
    }

    /// Damped and undamped modes whose growth rate is positive within an ellipse: `1 - r^2`, and its root, which is 0
    /// outside. Both cross all edges near the ellipse.
    #[test]
    fn points_lie_on_the_curve_whatever_the_growth_rate_is_like_there() {
        let inside = |p: f64, q: f64| 1.0 - ((p - 1.0) / 0.7).powi(2) - ((q - 20.0) / 6.0).powi(2);
        let study = study(6);
        let growths = [
            |x: f64| 50.0 * x,
            |x: f64| 300.0 * x.max(0.0).sqrt(),
            |x: f64| 200.0 * x.max(0.0).sqrt() - 20.0,
            // Lightly damped: regula falsi alone does not get there in twelve steps.
            |x: f64| 200.0 * x.max(0.0).sqrt() - 2.0,
            |x: f64| 200.0 * x.max(0.0).sqrt() - 0.2,
        ];
        for growth in growths {
            let (found, n_points) = run(&study, |p, q| Some(vec![[1000.0 + p, growth(inside(p, q))], [3000.0, -1.0]]));
            let off = (growth(0.0) / 200.0).powi(2);
            assert_eq!(found.n_not_found, 0);
            for HopfPoint { values: [p, q], frequency_hz, .. } in &found.points {
                // An interval of 2e-3 of an edge of 0.4 and 4: the slope of `inside` is at most 3 an edge's half.
                assert!((inside(*p, *q) - off).abs() < 5e-3, "{p} {q}: {}", inside(*p, *q));
                assert!((frequency_hz - 1000.0 - p).abs() < 0.01);
            }
            let ends = |i: usize| found.lines.iter().flatten().filter(|end| **end == i).count();
            assert!(
                found.points.len() >= 8 && (0..found.points.len()).all(|i| ends(i) == 2),
                "a closed curve: {found:?}"
            );
            assert!(n_points < 36 + 13 * found.points.len(), "{n_points} points");
        }
    }

    #[test]
    fn curves_of_two_modes_cross_and_are_not_joined() {
        let study = study(5);
        let (found, n_points) = run(&study, |p, q| Some(vec![[1000.0, p - 0.8], [2000.0, (q - 18.0) / 10.0]]));
        let (slow, fast): (Vec<&HopfPoint>, Vec<&HopfPoint>) =
            found.points.iter().partition(|own| own.frequency_hz < 1500.0);
        assert_eq!((slow.len(), fast.len(), found.lines.len()), (5, 5, 8));
        assert!(slow.iter().all(|own| (own.values[0] - 0.8).abs() < 1e-9), "a linear rate");
        assert_eq!(n_points, 25 + 10, "needs one step");
        let is_one_mode = |[a, b]: &[usize; 2]| near(found.points[*a].frequency_hz, found.points[*b].frequency_hz);
        assert!(found.lines.iter().all(is_one_mode));
    }

    #[test]
    fn an_edge_with_a_lost_mode_or_a_failed_point_has_none() {
        let study = study(3);
        let (found, n_points) = run(&study, |p, _| (p < 1.5).then(|| vec![[1000.0, p - 0.5]]));
        assert!(found.points.len() == 3 && n_points < 50, "the failed points are no ends: {found:?}");
        assert_eq!(found.n_not_found, 0);
        // Between the points of the grid there is no mode.
        let (found, n_points) = run(&study, |p, q| {
            Some(if p.fract() == 0.0 && q % 10.0 == 0.0 { vec![[1000.0, p - 0.5]] } else { vec![] })
        });
        assert_eq!((found, n_points), (HopfCurves { n_not_found: 3, ..HopfCurves::default() }, 12));
    }
}
