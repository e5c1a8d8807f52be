//! What counts as an unstable mode.

use std::fmt::{self, Display};

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// What counts as an unstable mode, by its eigenvalue `lambda = a + i omega`.
///
/// ```
/// use num_complex::Complex64;
/// use squeal::model::InstabilityCriterion;
///
/// let lambda = Complex64::new(4.0, 1e4);
/// assert!(lambda.re > InstabilityCriterion::default().limit(lambda, 0.0));
/// assert!(lambda.re < InstabilityCriterion::DampingRatio(-0.001).limit(lambda, 0.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "expected { damping_ratio = -0.001 } or { growth_rate = 5.0 }")]
pub enum InstabilityCriterion {
    /// `a > limit`, 1/s.
    GrowthRate(f64),
    /// `-a / |lambda| < limit`, a fraction, not above 0.
    DampingRatio(f64),
}

/// Growth rates up to this fraction of `|lambda|` are rounding, whatever the criterion.
const ROUNDING: f64 = 1e-6;

impl Default for InstabilityCriterion {
    /// All growth that is not rounding.
    fn default() -> Self {
        InstabilityCriterion::DampingRatio(-ROUNDING)
    }
}

impl InstabilityCriterion {
    /// What is wrong with the limit and how it is given; none where nothing is.
    pub fn mistake(self) -> Option<&'static str> {
        match self {
            InstabilityCriterion::GrowthRate(limit) => {
                let is_valid = limit >= 0.0 && limit.is_finite();
                (!is_valid).then_some("growth_rate must be 0 or above. Give 1/s, such as 5.0")
            }
            InstabilityCriterion::DampingRatio(limit) => {
                let is_valid = limit > -1.0 && limit <= 0.0;
                (!is_valid)
                    .then_some("damping_ratio must be above -1 and not above 0. Give a fraction: -0.001 is -0.1 %")
            }
        }
    }

    /// Its key in a model file, and the limit.
    pub fn entry(self) -> (&'static str, f64) {
        match self {
            InstabilityCriterion::GrowthRate(limit) => ("growth_rate", limit),
            InstabilityCriterion::DampingRatio(limit) => ("damping_ratio", limit),
        }
    }

    /// The growth rate (1/s) above which an eigenvalue is unstable. A real eigenvalue is a divergence only above
    /// `rigid` (1/s): the double zero of a rigid-body motion may come out as a small real pair.
    pub fn limit(self, lambda: Complex64, rigid: f64) -> f64 {
        let limit = match self {
            InstabilityCriterion::GrowthRate(limit) => limit,
            InstabilityCriterion::DampingRatio(limit) => -limit * lambda.norm(),
        };
        let limit = limit.max(ROUNDING * lambda.norm());
        if lambda.im == 0.0 { limit.max(rigid) } else { limit }
    }
}

/// `damping ratio below -0.1 %`, `growth rate above 5 /s`.
impl Display for InstabilityCriterion {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            InstabilityCriterion::GrowthRate(limit) => write!(f, "growth rate above {limit} /s"),
            // Twelve digits, so that -0.001 is -0.1 %.
            InstabilityCriterion::DampingRatio(limit) => {
                write!(f, "damping ratio below {} %", (limit * 1e14).round() / 1e12)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_unstable_above_its_growth_rate_or_below_its_damping_ratio() {
        let exceeds = |criterion: InstabilityCriterion, re: f64, im: f64| {
            let lambda = Complex64::new(re, im);
            lambda.re > criterion.limit(lambda, 1.0)
        };
        let growth = InstabilityCriterion::GrowthRate(5.0);
        assert_eq!([4.9, 5.1].map(|a| exceeds(growth, a, 1e4)), [false, true]);
        let damping = InstabilityCriterion::DampingRatio(-0.001);
        assert_eq!([9.9, 10.1].map(|a| exceeds(damping, a, 1e4)), [false, true]);
        assert_eq!([0.0099, 0.0101].map(|a| exceeds(InstabilityCriterion::default(), a, 1e4)), [false, true]);
    }

    #[test]
    fn a_real_eigenvalue_diverges_above_the_noise_of_a_rigid_motion() {
        let criterion = InstabilityCriterion::default();
        let exceeds = |re: f64| re > criterion.limit(Complex64::new(re, 0.0), 1.0);
        assert_eq!([0.9, 1.1].map(exceeds), [false, true]);
    }

    #[test]
    fn rounding_is_no_growth_whatever_the_limit() {
        let lambda = Complex64::new(0.0099, 1e4);
        assert!(lambda.re < InstabilityCriterion::GrowthRate(0.0).limit(lambda, 0.0));
    }

    #[test]
    fn limits_that_mean_nothing_are_refused_and_others_are_printed_with_their_unit() {
        use InstabilityCriterion::{DampingRatio, GrowthRate};
        for wrong in [GrowthRate(-1.0), GrowthRate(f64::NAN), DampingRatio(0.001), DampingRatio(-1.0)] {
            assert!(wrong.mistake().is_some(), "{wrong}");
        }
        let texts = [InstabilityCriterion::default(), DampingRatio(-0.001), GrowthRate(5.0)].map(|criterion| {
            assert_eq!(criterion.mistake(), None);
            criterion.to_string()
        });
        assert_eq!(texts, ["damping ratio below -0.0001 %", "damping ratio below -0.1 %", "growth rate above 5 /s"]);
    }
}
