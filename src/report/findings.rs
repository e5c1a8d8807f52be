//! What the results say about squeal: the instabilities, each with where it begins, the modes that it is made of, and
//! its partner.
//!
//! An instability is a branch with a growing mode. Where modes were not followed over friction, growing modes of
//! neighbouring friction values belong together when their frequencies lie within 2 % of each other.

use std::f64::consts::TAU;

use crate::results::{ModeData, Results};
use crate::tracking::{Branch, Hopf};

/// A mode among the results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Index of its value.
    pub value: usize,
    /// Index among the value's modes.
    pub mode: usize,
}

impl Place {
    /// What the page and its figures call the mode.
    pub fn name(self) -> String {
        format!("{}-{}", self.value, self.mode)
    }
}

/// A growing mode, followed over friction.
#[derive(Debug, Clone, PartialEq)]
pub struct Instability {
    /// Its branch of the diagram, if it lies on one.
    pub branch: Option<usize>,
    /// Its growing modes, by friction.
    pub modes: Vec<Place>,
    /// That of them which grows fastest, among those that are explained if there are any.
    pub worst: Place,
    /// The growth rate there, 1/s.
    pub growth_rate: f64,
    /// The friction values between which it grows.
    pub ranges: Vec<Range>,
}

/// An interval of friction on which a mode grows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Where it begins.
    pub from: End,
    /// Where it ends.
    pub to: End,
    /// Hz, where it begins.
    pub frequency: f64,
}

/// The end of a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// A Hopf point: the growth rate passes zero there.
    Hopf(f64),
    /// The mode grows here, and does not at the neighbouring value (the second number); what lies in between is
    /// unknown.
    Seen(f64, f64),
    /// The mode grows here, and it is the first or the last value.
    Edge(f64),
}

/// Frequencies of one instability at neighbouring friction values differ by less than this, relative; only where modes
/// were not followed.
const SAME: f64 = 0.02;
/// Eigenvalues of the same mode in the diagram and among the values agree to this, relative.
const ROUNDING: f64 = 1e-9;

/// The results with what is read off them.
pub struct Findings<'a> {
    /// The results.
    pub results: &'a Results,
    /// For each value and each of its modes the branch that it lies on.
    pub branch_of: Vec<Vec<Option<usize>>>,
    /// Indices of the values asked for, by friction.
    pub asked: Vec<usize>,
    /// All instabilities, the strongest first.
    pub instabilities: Vec<Instability>,
}

impl<'a> Findings<'a> {
    /// Reads the results.
    pub fn new(results: &'a Results) -> Findings<'a> {
        let values = &results.values;
        let mut asked: Vec<usize> = (0..values.len()).filter(|&v| values[v].asked).collect();
        asked.sort_by(|&a, &b| values[a].friction.total_cmp(&values[b].friction));
        let branch_of = values.iter().map(|value| vec![None; value.modes.len()]).collect();
        let mut findings = Findings { results, branch_of, asked, instabilities: Vec::new() };
        for (b, branch) in findings.branches().iter().enumerate() {
            for place in findings.places_on(branch).collect::<Vec<_>>() {
                findings.branch_of[place.value][place.mode] = Some(b);
            }
        }
        findings.instabilities = findings.find();
        findings
    }

    /// The branches, if modes were followed.
    pub fn branches(&self) -> &'a [Branch] {
        self.results.diagram.as_ref().map_or(&[][..], |diagram| &diagram.branches)
    }

    /// The Hopf points, if modes were followed.
    pub fn hopf(&self) -> &'a [Hopf] {
        self.results.diagram.as_ref().map_or(&[][..], |diagram| &diagram.hopf)
    }

    /// A mode.
    ///
    /// # Panics
    /// Where there is none at that place.
    pub fn mode(&self, place: Place) -> &'a ModeData {
        &self.results.values[place.value].modes[place.mode]
    }

    /// The friction of a mode.
    ///
    /// # Panics
    /// Where there is none at that place.
    pub fn friction(&self, place: Place) -> f64 {
        self.results.values[place.value].friction
    }

    /// The modes of a branch, as far as they are in the band.
    fn places_on(&self, branch: &'a Branch) -> impl Iterator<Item = Place> + 'a {
        let values = &self.results.values;
        branch.points.iter().filter_map(|point| {
            let value = values.iter().position(|value| value.friction == point.value)?;
            let same = |mode: &ModeData| (mode.lambda - point.lambda).norm() <= ROUNDING * point.lambda.norm();
            let mode = values[value].modes.iter().position(same)?;
            Some(Place { value, mode })
        })
    }

    fn find(&self) -> Vec<Instability> {
        let growing = |branch| self.places_on(branch).filter(|&place| self.mode(place).unstable).collect();
        let branches = self.branches().iter().enumerate();
        let followed = branches.filter_map(|(b, branch)| self.instability(Some(b), growing(branch)));
        let is_alone = |place: Place| self.branch_of[place.value][place.mode].is_none();
        let others = self.groups(is_alone).into_iter().filter_map(|modes| self.instability(None, modes));
        let mut found: Vec<Instability> = followed.chain(others).collect();
        found.sort_by(|a, b| b.growth_rate.total_cmp(&a.growth_rate));
        found
    }

    fn instability(&self, branch: Option<usize>, mut modes: Vec<Place>) -> Option<Instability> {
        modes.sort_by(|&a, &b| self.friction(a).total_cmp(&self.friction(b)));
        let is_explained = |place: &Place| !self.mode(*place).sources.is_empty() || self.mode(*place).shape.is_some();
        let any_explained = modes.iter().any(is_explained);
        let growth = |place: &Place| self.mode(*place).growth_rate();
        let candidates = modes.iter().filter(|place| !any_explained || is_explained(place));
        let worst = *candidates.max_by(|a, b| growth(a).total_cmp(&growth(b)))?;
        let ranges = branch.map_or_else(|| self.seen_ranges(&modes), |b| self.followed_ranges(b, &modes));
        Some(Instability { branch, worst, growth_rate: growth(&worst), ranges, modes })
    }

    /// Ranges between the Hopf points of a branch.
    fn followed_ranges(&self, b: usize, modes: &[Place]) -> Vec<Range> {
        let own: Vec<&Hopf> = self.hopf().iter().filter(|hopf| hopf.branch == b).collect();
        let mut ranges = Vec::new();
        let (first, last) = (modes[0], modes[modes.len() - 1]);
        let mut open = own.first().is_none_or(|hopf| !hopf.onset).then(|| {
            let at = self.friction(first);
            (End::Edge(at), self.mode(first).frequency())
        });
        for hopf in own {
            match (hopf.onset, open.take()) {
                (true, _) => open = Some((End::Hopf(hopf.value), hopf.omega / TAU)),
                (false, Some((from, frequency))) => ranges.push(Range { from, to: End::Hopf(hopf.value), frequency }),
                (false, None) => {}
            }
        }
        let rest = open.map(|(from, frequency)| Range { from, to: End::Edge(self.friction(last)), frequency });
        ranges.extend(rest);
        ranges
    }

    /// Ranges of modes that were not followed: runs of values asked for.
    fn seen_ranges(&self, modes: &[Place]) -> Vec<Range> {
        let friction_values: Vec<f64> = self.asked.iter().map(|&v| self.results.values[v].friction).collect();
        let grows = |i: usize| modes.iter().find(|&&place| self.friction(place) == friction_values[i]);
        let mut ranges: Vec<Range> = Vec::new();
        for (i, &mu) in friction_values.iter().enumerate() {
            let Some(&place) = grows(i) else { continue };
            let to = if i + 1 == friction_values.len() { End::Edge(mu) } else { End::Seen(mu, friction_values[i + 1]) };
            match (i > 0 && grows(i - 1).is_some(), ranges.last_mut()) {
                (true, Some(range)) => range.to = to,
                _ => {
                    let from = if i == 0 { End::Edge(mu) } else { End::Seen(mu, friction_values[i - 1]) };
                    ranges.push(Range { from, to, frequency: self.mode(place).frequency() });
                }
            }
        }
        ranges
    }

    /// Growing modes at the requested friction values that are `wanted`, those together which have about the same
    /// frequency.
    fn groups(&self, wanted: impl Fn(Place) -> bool) -> Vec<Vec<Place>> {
        let mut groups: Vec<Vec<Place>> = Vec::new();
        for &value in &self.asked {
            let places = (0..self.results.values[value].modes.len()).map(|mode| Place { value, mode });
            for place in places.filter(|&place| self.mode(place).unstable && wanted(place)) {
                let frequency = self.mode(place).frequency();
                let near = |group: &Vec<Place>| {
                    let last = group[group.len() - 1];
                    last.value != value && (self.mode(last).frequency() / frequency - 1.0).abs() < SAME
                };
                match groups.iter_mut().find(|group| near(group)) {
                    Some(group) => group.push(place),
                    None => groups.push(vec![place]),
                }
            }
        }
        groups
    }

    /// The first Hopf point at which an instability begins.
    pub fn onset(&self, instability: &Instability) -> Option<&'a Hopf> {
        let branch = instability.branch?;
        self.hopf().iter().find(|hopf| hopf.branch == branch && hopf.onset)
    }
}

impl End {
    /// The friction, as well as it is known.
    pub fn value(self) -> f64 {
        match self {
            End::Hopf(mu) | End::Seen(mu, _) | End::Edge(mu) => mu,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::testing;

    #[test]
    fn instabilities_are_branches_between_hopf_points_the_strongest_first() {
        let results = testing::results();
        let findings = Findings::new(&results);
        let [strong, weak] = &findings.instabilities[..] else { panic!("{:?}", findings.instabilities) };
        assert!(strong.growth_rate > weak.growth_rate);
        let [range] = &strong.ranges[..] else { panic!("{:?}", strong.ranges) };
        assert_eq!(range.from, End::Hopf(findings.onset(strong).unwrap().value));
        assert_eq!(range.to, End::Edge(0.8));
        let [range] = &weak.ranges[..] else { panic!("{:?}", weak.ranges) };
        assert!(matches!((range.from, range.to), (End::Hopf(a), End::Hopf(b)) if a < b && b < 0.8), "{range:?}");
        for one in &findings.instabilities {
            assert_eq!(one.growth_rate, findings.mode(one.worst).growth_rate());
            assert!(findings.branches()[one.branch.unwrap()].worst().lambda.re >= one.growth_rate);
        }
    }

    #[test]
    fn modes_that_were_not_followed_belong_together_by_their_frequency() {
        let results = testing::results();
        let followed: Vec<Place> = Findings::new(&results).instabilities.iter().map(|one| one.worst).collect();
        let alone = Results { diagram: None, ..results.clone() };
        let findings = Findings::new(&alone);
        let seen: Vec<Place> = findings.instabilities.iter().map(|one| one.worst).collect();
        assert_eq!(seen, followed);
        assert!(findings.instabilities.iter().all(|one| one.branch.is_none()));
        let [strong, weak] = &findings.instabilities[..] else { unreachable!() };
        assert!(matches!(strong.ranges[0].from, End::Seen(mu, before) if before < mu));
        assert!(matches!(strong.ranges[0].to, End::Edge(0.8)));
        assert!(matches!(weak.ranges[0].to, End::Seen(mu, beyond) if beyond > mu));
    }

    #[test]
    fn every_mode_of_the_band_lies_on_its_branch() {
        let results = testing::results();
        let findings = Findings::new(&results);
        for (value, row) in results.values.iter().zip(&findings.branch_of) {
            for (mode, branch) in value.modes.iter().zip(row) {
                let branch = &findings.branches()[branch.unwrap()];
                let point = branch.points.iter().find(|point| point.value == value.friction);
                assert_eq!(point.unwrap().lambda, mode.lambda);
            }
        }
    }
}
