//! Probabilities from points and derivatives together.
//!
//! A mode is *predicted* to be unstable where its growth rate of first order, from the nominal point's derivatives, is
//! above the limit of the criterion. How probable that is costs no analysis, so that the points serve only to
//! count how often it is wrong:
//!
//! ```text
//! P(unstable) = P(predicted) + P(unstable, not predicted) - P(predicted, not unstable)
//! ```
//!
//! The first term is of 16 384 points of the distributions, the two others are fractions of the study's points, none of
//! which has failed. The sum has no bias, whatever the derivatives are; its interval is narrow where they are seldom
//! wrong. The interval of the difference is made of Wilson's intervals of both fractions, with the correlation of
//! events that exclude each other. Sources: Glynn and Szechtman, *Some new perspectives on the method of control
//! variates* (2002); Zou and Donner, Statistics in Medicine 27 (2008), 1693, equations 4 and 5.

use super::design::{Design, DesignKind};
use super::distribution::Distribution;
use super::gradient::{Gradient, first_order};
use super::result::{PointMode, PointResult};
use super::sensitivity::Estimate;
use super::statistics::Probability;
use super::study::Study;
use crate::model::InstabilityCriterion;

/// Points of the first term.
const N_PREDICTED: usize = 1 << 14;

/// Many points of a study's distributions, at which growth rates of first order are evaluated.
pub(super) struct Prediction<'a> {
    gradients: &'a [Gradient],
    nominal: &'a [f64],
    criterion: InstabilityCriterion,
    cloud: Vec<Vec<f64>>,
}

impl<'a> Prediction<'a> {
    /// None without derivatives, or where the points of the study do not represent distributions that are known: a list
    /// does not. `criterion` is what the points' modes are unstable by.
    pub fn new(
        study: &Study,
        gradients: &'a [Gradient],
        nominal: &'a [f64],
        criterion: InstabilityCriterion,
    ) -> Option<Prediction<'a>> {
        let is_drawn = study.design.is_sample() && !matches!(study.design.kind, DesignKind::List(_));
        if gradients.is_empty() || !is_drawn {
            return None;
        }
        let design = Design { kind: DesignKind::Sobol { n_points: N_PREDICTED }, ..study.design.clone() };
        let distributions: Vec<&Distribution> = study.parameters.iter().map(|own| &own.distribution).collect();
        Some(Prediction { gradients, nominal, criterion, cloud: design.points(&distributions, nominal).ok()? })
    }

    /// The probability that a nominal mode, with its number from 0, is unstable, with its interval of 95 %. `plain` is
    /// that of the points alone; none where its interval is no wider, or a parameter has no derivative.
    pub fn probability(
        &self,
        mode: (usize, &PointMode),
        sample: &[(usize, &PointResult)],
        plain: Probability,
    ) -> Option<Estimate> {
        let limit = self.criterion.limit(mode.1.lambda, 0.0);
        let is_predicted = |values: &[f64]| Some(first_order(mode, self.gradients, self.nominal, values)? > limit);
        let is_unstable = |point: &PointResult| {
            let is_own = |own: &PointMode| own.unstable && own.link.is_some_and(|link| link.nominal == mode.0 + 1);
            point.modes().into_iter().flatten().any(is_own)
        };
        let cloud: Vec<bool> = self.cloud.iter().map(|values| is_predicted(values)).collect::<Option<_>>()?;
        let predicted = cloud.iter().filter(|is| **is).count() as f64 / cloud.len() as f64;
        let pair = |(_, point): &(usize, &PointResult)| Some((is_unstable(point), is_predicted(&point.values)?));
        let pairs: Vec<(bool, bool)> = sample.iter().map(pair).collect::<Option<_>>()?;
        let share = |of: (bool, bool)| Probability::of(pairs.iter().filter(|pair| **pair == of).count(), pairs.len());
        let (missed, false_alarm) = (share((true, false)), share((false, true)));
        let estimate = corrected(predicted, missed, false_alarm);
        (estimate.high - estimate.low < plain.high - plain.low).then_some(estimate)
    }
}

/// `P + p_1 - p_2` within 0 and 1, and its interval, P being known and the events of p_1 and p_2 excluding each other:
///
/// ```text
/// below^2 = a^2 + b^2 - 2 r a b,  a = p_1 - low_1,  b = high_2 - p_2
/// above^2 = c^2 + d^2 - 2 r c d,  c = high_1 - p_1, d = p_2 - low_2,  r = - sqrt(p_1 p_2 / ((1 - p_1) (1 - p_2)))
/// ```
fn corrected(predicted: f64, missed: Probability, false_alarm: Probability) -> Estimate {
    let value = predicted + missed.value - false_alarm.value;
    let odds = |p: Probability| if p.value < 1.0 { p.value / (1.0 - p.value) } else { 0.0 };
    let r = -(odds(missed) * odds(false_alarm)).sqrt();
    let together = |a: f64, b: f64| (a * a + b * b - 2.0 * r * a * b).sqrt();
    let below = together(missed.value - missed.low, false_alarm.high - false_alarm.value);
    let above = together(missed.high - missed.value, false_alarm.value - false_alarm.low);
    let [value, low, high] = [value, value - below, value + above].map(|p| p.clamp(0.0, 1.0));
    Estimate { value, low, high }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::super::gradient::Difference;
    use super::super::{KeyPath, Link, Outcome, Parameter};
    use super::*;

    /// The share of intervals that have the true difference, of samples with these probabilities: about 95 %.
    #[test]
    fn intervals_have_their_confidence() {
        let mut chance = Pcg64::seed_from_u64(5);
        for (n, p1, p2) in [(64, 0.05, 0.05), (64, 0.3, 0.3), (128, 0.14, 0.14), (64, 0.4, 0.1), (256, 0.01, 0.2)] {
            let mut n_within = 0;
            for _ in 0..4000 {
                let draws: Vec<f64> = (0..n).map(|_| chance.random()).collect();
                let count = |from: f64, to: f64| draws.iter().filter(|u| (from..to).contains(*u)).count();
                let share = |k| Probability::of(k, n);
                let found = corrected(0.5, share(count(0.0, p1)), share(count(p1, p1 + p2)));
                n_within += usize::from((found.low..=found.high).contains(&(0.5 + p1 - p2)));
            }
            let share = n_within as f64 / 4000.0;
            assert!((0.94..0.98).contains(&share), "{n} {p1} {p2}: {share}");
        }
    }

    fn study(kind: DesignKind) -> Study {
        let parameter = |name: &str| Parameter {
            name: name.into(),
            keys: vec![KeyPath::parse("friction").unwrap()],
            is_factor: false,
            distribution: Distribution::Uniform { from: 0.0, to: 1.0 },
        };
        Study {
            file: "explore.toml".into(),
            model: "brake.toml".into(),
            parameters: ["p", "q"].map(parameter).to_vec(),
            fields: Vec::new(),
            design: Design { kind, seed: 3, correlation: None },
            contacts: None,
            band: None,
            criterion: None,
            bin: 100.0,
            follow: Some(2),
            gradients: true,
        }
    }

    fn point(values: &[f64], growth: f64, criterion: InstabilityCriterion) -> PointResult {
        let link = Some(Link { nominal: 1, share: 1.0, doubtful: false });
        let lambda = Complex64::new(growth, 1000.0);
        let mode = PointMode { lambda, unstable: growth > criterion.limit(lambda, 0.0), backward_error: 0.0, link };
        PointResult { values: values.to_vec(), outcome: Outcome::Modes(vec![mode]) }
    }

    /// The estimate with slopes, of 64 points and the growth rate `p + q - 0.5 + bend p q`, and that of the points
    /// alone.
    fn estimates(slopes: [f64; 2], bend: f64) -> (Option<Estimate>, Probability) {
        estimates_by(InstabilityCriterion::default(), slopes, bend)
    }

    fn estimates_by(criterion: InstabilityCriterion, slopes: [f64; 2], bend: f64) -> (Option<Estimate>, Probability) {
        let study = study(DesignKind::Sobol { n_points: 64 });
        let distributions: Vec<&Distribution> = study.parameters.iter().map(|own| &own.distribution).collect();
        let nominal = [0.25, 0.25];
        let growth = |x: &[f64]| x[0] + x[1] - 0.5 + bend * x[0] * x[1];
        let values = study.design.points(&distributions, &nominal).unwrap();
        let points: Vec<PointResult> = values.iter().map(|x| point(x, growth(x), criterion)).collect();
        let sample: Vec<(usize, &PointResult)> = (1..).zip(&points).collect();
        let gradient =
            |slope: f64| Gradient { slopes: vec![Complex64::new(slope, 0.0)], difference: Difference::Central };
        let gradients = slopes.map(gradient);
        let plain = Probability::of(points.iter().filter(|point| point.is_unstable()).count(), 64);
        let prediction = Prediction::new(&study, &gradients, &nominal, criterion).unwrap();
        let of = point(&nominal, growth(&nominal), criterion);
        (prediction.probability((0, &of.modes().unwrap()[0]), &sample, plain), plain)
    }

    /// `p + q > 1/2` on the unit square: 7/8. Without derivatives' errors the points only bound how wrong they are.
    #[test]
    fn a_linear_growth_rate_has_its_exact_probability() {
        let (found, plain) = estimates([1.0, 1.0], 0.0);
        let found = found.unwrap();
        assert!((found.value - 0.875).abs() < 1e-3, "{found:?}");
        assert!(found.low <= 0.875 && 0.875 <= found.high && found.high - found.low < plain.high - plain.low);
    }

    /// `p + q - 1/2 > 1/2` on the unit square: 1/2, by the limit of the criterion in place of 0.
    #[test]
    fn predictions_have_the_limit_of_the_criterion() {
        let (found, plain) = estimates_by(InstabilityCriterion::GrowthRate(0.5), [1.0, 1.0], 0.0);
        let found = found.unwrap();
        assert!((found.value - 0.5).abs() < 1e-3 && (plain.value - 0.5).abs() < 0.05, "{found:?} {plain:?}");
    }

    /// `p + q - p q > 1/2` is `(1 - p) (1 - q) < 1/2`: `1/2 + ln 2 / 2`. With the slopes at the nominal point.
    #[test]
    fn wrong_predictions_are_corrected() {
        let (found, _) = estimates([0.75, 0.75], -1.0);
        let exact = 0.5 * (1.0 + 2.0_f64.ln());
        let found = found.unwrap();
        assert!((found.value - exact).abs() < 0.03 && found.low <= exact && exact <= found.high, "{found:?}");
    }

    #[test]
    fn derivatives_that_are_often_wrong_give_no_estimate() {
        assert_eq!(estimates([-1.0, -1.0], 0.0).0, None);
    }

    #[test]
    fn points_of_no_known_distribution_and_missing_derivatives_give_none() {
        let gradient = Gradient { slopes: Vec::new(), difference: Difference::None("lost".into()) };
        let gradients = [gradient.clone(), gradient];
        let is_made =
            |kind| Prediction::new(&study(kind), &gradients, &[0.5, 0.5], InstabilityCriterion::default()).is_some();
        assert!(!is_made(DesignKind::Grid { n_levels: 3 }) && !is_made(DesignKind::List(vec![vec![0.5, 0.5]])));
        assert!(
            Prediction::new(
                &study(DesignKind::Sobol { n_points: 4 }),
                &[],
                &[0.5, 0.5],
                InstabilityCriterion::default()
            )
            .is_none()
        );
        let study = study(DesignKind::Sobol { n_points: 4 });
        let prediction = Prediction::new(&study, &gradients, &[0.5, 0.5], InstabilityCriterion::default()).unwrap();
        let of = point(&[0.5, 0.5], 1.0, InstabilityCriterion::default());
        assert_eq!(prediction.probability((0, &of.modes().unwrap()[0]), &[], Probability::of(0, 0)), None);
    }
}
