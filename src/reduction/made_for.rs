//! Moduli and densities that the basis of a super-element is made for, and how well it holds there.

use super::part_change::PartChange;

/// Error of a frequency, relative, below which a sample agrees with the basis.
pub const SMALL_ERROR: f64 = 1e-4;
/// So many samples in succession that agree end the work.
pub const AGREEING_SAMPLES: usize = 2;
/// Error of a frequency, relative, from which on tests of a Galerkin super-element give a warning.
const LARGE_TEST_ERROR: f64 = 0.01;

/// Moduli and densities of parts that the basis of a super-element is made for.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MadeFor {
    /// File of the study by whose parameters they are chosen.
    pub study: String,
    /// Points of the study that the basis is made of.
    #[serde(default)]
    pub n_samples: usize,
    /// Coordinates that they gave.
    pub sample_coordinates: usize,
    /// Largest relative error of a frequency at each of them, estimated before its vectors joined a Craig-Bampton
    /// basis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sample_errors: Vec<f64>,
    /// The same at other points of the study, by the full model's residuals, of a Galerkin super-element.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub test_errors: Vec<f64>,
    /// Friction coefficient there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub test_friction: Option<f64>,
    /// Ranges of the factors on parts over the samples, of parts that change.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartRange>,
}

impl MadeFor {
    /// Where the last samples do not agree with the basis, or the tests with the full model.
    pub fn warning(&self) -> Option<String> {
        let largest = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
        let last = &self.sample_errors[self.sample_errors.len().saturating_sub(AGREEING_SAMPLES)..];
        let (sampled, tested) = (largest(last), largest(&self.test_errors));
        let percent = |error: f64| format!("{:.2} %", 100.0 * error);
        let study = &self.study;
        let by_samples = || {
            let what = format!("frequencies at the last samples of {study} still differ by {}", percent(sampled));
            format!("{what}: narrow the ranges of its parameters, or raise --limit of squeal reduce")
        };
        let by_tests = || {
            let what = format!("frequencies at other points of {study} differ from the model's by {}", percent(tested));
            format!("{what}: narrow the ranges of its parameters, or give squeal reduce more --samples")
        };
        let is_sampled_badly = (sampled >= SMALL_ERROR).then(by_samples);
        is_sampled_badly.or_else(|| (tested >= LARGE_TEST_ERROR).then(by_tests))
    }
}

/// Ranges of the factors on a part.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PartRange {
    /// Name of the part.
    pub part: String,
    /// Of its stiffness.
    pub stiffness: [f64; 2],
    /// Of its mass.
    pub mass: [f64; 2],
}

impl PartRange {
    /// A part as it is.
    pub fn nominal(part: &str) -> PartRange {
        PartRange { part: part.to_owned(), stiffness: [1.0; 2], mass: [1.0; 2] }
    }

    /// The ranges over some changes of all parts; those of parts that do not change are left out.
    pub fn over<'a>(changes: impl IntoIterator<Item = &'a [(String, PartChange)]>) -> Vec<PartRange> {
        let mut ranges: Vec<PartRange> = Vec::new();
        for (part, change) in changes.into_iter().flatten() {
            match ranges.iter_mut().find(|range| range.part == *part) {
                Some(range) => range.include(change),
                None => {
                    let mut range = PartRange::nominal(part);
                    range.include(change);
                    ranges.push(range);
                }
            }
        }
        ranges.retain(|range| *range != PartRange::nominal(&range.part));
        ranges
    }

    /// Whether it is farther outside another one than by half of that one's width, and by 5 %.
    pub fn is_far_outside(&self, other: &PartRange) -> bool {
        let far = |[from, to]: [f64; 2], own: [f64; 2]| {
            let margin = (0.5 * (own[1] - own[0])).max(0.05);
            from < own[0] - margin || to > own[1] + margin
        };
        far(self.stiffness, other.stiffness) || far(self.mass, other.mass)
    }

    /// Widens the ranges to those with a change.
    fn include(&mut self, change: &PartChange) {
        let widen = |[from, to]: [f64; 2], value: f64| [from.min(value), to.max(value)];
        (self.stiffness, self.mass) = (widen(self.stiffness, change.stiffness), widen(self.mass, change.mass));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Rayleigh;

    fn change(stiffness: f64, mass: f64) -> PartChange {
        PartChange { stiffness, mass, rayleigh: Rayleigh::default(), loss_factor: 0.0 }
    }

    #[test]
    fn ranges_are_those_of_the_parts_that_change() {
        let at = |stiffness, mass| [("disc".to_owned(), change(1.0, 1.0)), ("pad".to_owned(), change(stiffness, mass))];
        let found = PartRange::over([&at(0.7, 1.0)[..], &at(0.9, 1.3)]);
        assert_eq!(found, [PartRange { part: "pad".into(), stiffness: [0.7, 1.0], mass: [1.0, 1.3] }]);
        assert!(PartRange::over([&at(1.0, 1.0)[..]]).is_empty());
    }

    #[test]
    fn far_outside_is_half_a_width_and_5_percent() {
        let range = |stiffness: [f64; 2]| PartRange { stiffness, ..PartRange::nominal("pad") };
        let is_far = |stiffness, own| range(stiffness).is_far_outside(&range(own));
        assert!(
            !is_far([0.61, 1.39], [0.8, 1.2]) && is_far([0.59, 1.0], [0.8, 1.2]) && is_far([1.0, 1.41], [0.8, 1.2])
        );
        assert!(!is_far([0.96, 1.04], [1.0, 1.0]) && is_far([0.94, 1.0], [1.0, 1.0]));
        let heavy = PartRange { mass: [1.0, 1.1], ..PartRange::nominal("pad") };
        assert!(heavy.is_far_outside(&PartRange::nominal("pad")) && !heavy.is_far_outside(&heavy));
    }

    #[test]
    fn samples_and_tests_that_disagree_give_a_warning() {
        let sampled = |errors: &[f64]| MadeFor { sample_errors: errors.to_vec(), ..MadeFor::default() }.warning();
        assert_eq!(sampled(&[0.1, 9e-5, 2e-5]), None);
        let text = sampled(&[0.1, 5e-5, 0.0123, 2e-5]).unwrap();
        assert!(text.contains("still differ by 1.23 %") && text.contains("raise --limit"), "{text}");
        let tested = |errors: &[f64]| MadeFor { test_errors: errors.to_vec(), ..MadeFor::default() }.warning();
        assert_eq!(tested(&[0.009, 0.002]), None);
        assert!(tested(&[0.03, 0.002]).unwrap().contains("differ from the model's by 3.00 %"));
        assert_eq!(MadeFor::default().warning(), None);
    }
}
