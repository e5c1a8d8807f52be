//! First-order derivatives of the nominal modes by the parameters, and the tornado that they make.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

use super::result::{PointMode, PointResult};
use super::study::Parameter;
use crate::model::InstabilityCriterion;

/// Derivatives of the nominal modes by one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gradient {
    /// `d lambda / dp` of each nominal mode, 1/s per unit of the parameter; empty where there is none.
    pub slopes: Vec<Complex64>,
    /// Where the matrices are known, or why they are not.
    pub difference: Difference,
}

/// Where the matrices are evaluated, whose difference left and right vectors turn into derivatives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Difference {
    /// Below and above the nominal value.
    Central,
    /// At the nominal value and above: below there is no equilibrium, or no model.
    Forward,
    /// At the nominal value and below.
    Backward,
    /// On neither side, for this reason.
    None(String),
}

impl Difference {
    /// For tables.
    pub fn text(&self) -> &str {
        match self {
            Difference::Central => "central",
            Difference::Forward => "forward",
            Difference::Backward => "backward",
            Difference::None(reason) => reason,
        }
    }
}

/// What each parameter changes in a nominal mode over its range, to first order.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tornado {
    /// Number of the nominal mode, from 1.
    pub nominal: usize,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Its growth rate, 1/s.
    pub growth_rate_per_s: f64,
    /// Share of the variance of its growth rate over the points that the derivatives explain, at most 1; none with
    /// fewer than three points.
    pub linear_share: Option<f64>,
    /// The parameters that have a derivative, that with the largest change of growth first.
    pub bars: Vec<Influence>,
}

/// What one parameter changes in a mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Influence {
    /// The parameter.
    pub parameter: String,
    /// Its nominal value.
    pub nominal: f64,
    /// Its quantile 5 %.
    pub from: f64,
    /// Its quantile 95 %.
    pub to: f64,
    /// Derivative of the growth rate, 1/s per unit of the parameter.
    pub growth_rate_slope: f64,
    /// Derivative of the frequency, Hz per unit of the parameter.
    pub frequency_slope: f64,
    /// What the growth rate changes from the one to the other quantile, 1/s.
    pub growth_rate_change_per_s: f64,
    /// The same of the frequency, Hz.
    pub frequency_change_hz: f64,
    /// The difference that the derivative is: central, forward or backward.
    pub difference: String,
}

/// A parameter by which there is no derivative.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MissingDerivative {
    /// The parameter.
    pub parameter: String,
    /// Why there is none.
    pub reason: String,
}

/// Distance of the evaluated points from the nominal one, relative to the range of a parameter.
const STEP: f64 = 0.01;
/// The same relative to the larger of its nominal and its one value, of a parameter that has one value only.
const STEP_OF_CONSTANT: f64 = 1e-3;

impl Parameter {
    /// The quantiles 5 % and 95 %.
    pub fn range(&self) -> [f64; 2] {
        [0.05, 0.95].map(|u| self.distribution.quantile(u))
    }

    /// How far from its nominal value the matrices are evaluated: far enough that some contact points change their
    /// status, as they do over the range. There is no step for a parameter that is 0 everywhere.
    pub fn step(&self, nominal: f64) -> Option<f64> {
        let [from, to] = self.range();
        let step = if to > from { STEP * (to - from) } else { STEP_OF_CONSTANT * nominal.abs().max(from.abs()) };
        (step > 0.0).then_some(step)
    }
}

impl Influence {
    /// Of a parameter on the mode with the number `mode`, from 0.
    fn new(parameter: &Parameter, nominal: f64, gradient: &Gradient, mode: usize) -> Option<Influence> {
        let [from, to] = parameter.range();
        let slope = gradient.slopes.get(mode)?;
        let (growth_rate_slope, frequency_slope) = (slope.re, slope.im / TAU);
        Some(Influence {
            parameter: parameter.name.clone(),
            nominal,
            from,
            to,
            growth_rate_slope,
            frequency_slope,
            growth_rate_change_per_s: growth_rate_slope * (to - from),
            frequency_change_hz: frequency_slope * (to - from),
            difference: gradient.difference.text().to_owned(),
        })
    }

    /// The growth rate of first order at its 5 % and 95 % quantiles, from that of the nominal point, 1/s.
    pub fn ends(&self, growth_rate: f64) -> [f64; 2] {
        [self.from, self.to].map(|end| growth_rate + self.growth_rate_slope * (end - self.nominal))
    }
}

/// The parameters without a derivative.
pub fn missing_derivatives(parameters: &[Parameter], gradients: &[Gradient]) -> Vec<MissingDerivative> {
    let missing = |(parameter, gradient): (&Parameter, &Gradient)| match &gradient.difference {
        Difference::None(reason) => {
            Some(MissingDerivative { parameter: parameter.name.clone(), reason: reason.clone() })
        }
        _ => None,
    };
    parameters.iter().zip(gradients).filter_map(missing).collect()
}

/// The tornado of each nominal mode, `points[0]` being the nominal point; none without derivatives.
pub fn tornados(parameters: &[Parameter], gradients: &[Gradient], points: &[PointResult]) -> Vec<Tornado> {
    let Some((nominal, own)) = points.split_first().filter(|_| !gradients.is_empty()) else { return Vec::new() };
    let tornado = |(i, mode): (usize, &PointMode)| {
        let own_values = nominal.values.iter().copied();
        let influence = |((parameter, gradient), value)| Influence::new(parameter, value, gradient, i);
        let mut bars: Vec<Influence> = parameters.iter().zip(gradients).zip(own_values).filter_map(influence).collect();
        let size = |bar: &Influence| bar.growth_rate_change_per_s.abs();
        bars.sort_by(|a, b| size(b).total_cmp(&size(a)));
        Tornado {
            nominal: i + 1,
            frequency_hz: mode.frequency(),
            growth_rate_per_s: mode.growth_rate(),
            linear_share: linear_share(i, mode, gradients, &nominal.values, own),
            bars,
        }
    };
    nominal.modes().unwrap_or_default().iter().enumerate().map(tornado).collect()
}

impl Tornado {
    /// Whether the mode is unstable at a point, or one parameter alone makes it so to first order: its bar reaches
    /// above the limit of the criterion.
    pub fn may_squeal(&self, points: &[PointResult], criterion: InstabilityCriterion) -> bool {
        let is_own = |mode: &PointMode| mode.unstable && mode.link.is_some_and(|link| link.nominal == self.nominal);
        let lambda = Complex64::new(0.0, TAU * self.frequency_hz);
        let limit = criterion.limit(lambda, 0.0);
        let reaches = |bar: &Influence| bar.ends(self.growth_rate_per_s).iter().any(|end| *end > limit);
        points.iter().flat_map(PointResult::modes).flatten().any(is_own) || self.bars.iter().any(reaches)
    }
}

/// `a_1 = a_0 + sum_i a'_i (p_i - p_i0)`, the growth rate of first order of the nominal mode with the number `i`, from
/// 0; none where a parameter has no derivative.
pub(super) fn first_order(
    (i, mode): (usize, &PointMode),
    gradients: &[Gradient],
    nominal: &[f64],
    values: &[f64],
) -> Option<f64> {
    let terms = gradients.iter().zip(values.iter().zip(nominal));
    let change = |(gradient, (p, p0)): (&Gradient, (&f64, &f64))| Some(gradient.slopes.get(i)?.re * (p - p0));
    terms.map(change).sum::<Option<f64>>().map(|change| mode.growth_rate() + change)
}

/// `1 - sum (a - a_1)^2 / sum (a - mean)^2` over the points at which a mode is recognised without doubt, with the
/// growth rate `a_1` of first order.
fn linear_share(
    i: usize,
    mode: &PointMode,
    gradients: &[Gradient],
    nominal: &[f64],
    points: &[PointResult],
) -> Option<f64> {
    let growth = |point: &PointResult| {
        let is_own = |mode: &&PointMode| mode.link.is_some_and(|link| link.nominal == i + 1 && !link.doubtful);
        let own = point.modes()?.iter().find(is_own)?.growth_rate();
        Some([own, first_order((i, mode), gradients, nominal, &point.values)?])
    };
    let pairs: Vec<[f64; 2]> = points.iter().filter_map(growth).collect();
    let mean = pairs.iter().map(|pair| pair[0]).sum::<f64>() / pairs.len() as f64;
    let sum = |of: &dyn Fn(&[f64; 2]) -> f64| pairs.iter().map(|pair| of(pair).powi(2)).sum::<f64>();
    let (off, all) = (sum(&|pair| pair[0] - pair[1]), sum(&|pair| pair[0] - mean));
    (pairs.len() > 2 && all > 0.0).then(|| 1.0 - off / all)
}

#[cfg(test)]
mod tests {
    use super::super::{Distribution, KeyPath, Link, Outcome};
    use super::*;

    fn parameter(name: &str, from: f64, to: f64) -> Parameter {
        let keys = vec![KeyPath::parse("friction").unwrap()];
        Parameter { name: name.into(), keys, is_factor: false, distribution: Distribution::Uniform { from, to } }
    }

    fn gradient(slopes: &[[f64; 2]]) -> Gradient {
        let slopes = slopes.iter().map(|&[growth, hertz]| Complex64::new(growth, TAU * hertz)).collect();
        Gradient { slopes, difference: Difference::Central }
    }

    fn point(values: [f64; 2], growths: [f64; 2]) -> PointResult {
        let mode = |(nominal, growth): (usize, f64)| PointMode {
            lambda: Complex64::new(growth, TAU * 1000.0),
            unstable: growth > 0.0,
            backward_error: 0.0,
            link: Some(Link { nominal, share: 1.0, doubtful: false }),
        };
        let modes = (1..).zip(growths).map(mode).collect();
        PointResult { values: values.to_vec(), outcome: Outcome::Modes(modes) }
    }

    /// Growth rates `-3 + 10 (p - 1) - (q - 20)` and -100.
    fn points() -> Vec<PointResult> {
        let growth = |p: f64, q: f64| -3.0 + 10.0 * (p - 1.0) - (q - 20.0);
        [[1.0, 20.0], [0.5, 18.0], [1.1, 25.0], [0.7, 30.0]].map(|[p, q]| point([p, q], [growth(p, q), -100.0])).into()
    }

    #[test]
    fn bars_are_changes_over_the_range_and_the_longest_comes_first() {
        let parameters = [parameter("p", 0.5, 1.5), parameter("q", 10.0, 30.0)];
        let gradients = [gradient(&[[10.0, 2.0], [0.0, 0.0]]), gradient(&[[-1.0, 3.0], [0.1, 0.0]])];
        let found = tornados(&parameters, &gradients, &points());
        assert_eq!(found.len(), 2);
        let bars = &found[0].bars;
        assert_eq!((bars[0].parameter.as_str(), bars[1].parameter.as_str()), ("q", "p"));
        assert!(
            (bars[0].growth_rate_change_per_s + 18.0).abs() < 1e-12
                && (bars[1].frequency_change_hz - 1.8).abs() < 1e-12
        );
        assert_eq!((bars[0].nominal, bars[1].nominal, bars[0].difference.as_str()), (20.0, 1.0, "central"));
        assert!((bars[0].from - 11.0).abs() < 1e-12 && (bars[0].to - 29.0).abs() < 1e-12);
    }

    #[test]
    fn the_points_judge_the_derivatives() {
        let parameters = [parameter("p", 0.5, 1.5), parameter("q", 10.0, 30.0)];
        let share = |gradients: [Gradient; 2]| tornados(&parameters, &gradients, &points())[0].linear_share;
        let exact = share([gradient(&[[10.0, 0.0]]), gradient(&[[-1.0, 0.0]])]).unwrap();
        let wrong = share([gradient(&[[10.0, 0.0]]), gradient(&[[1.0, 0.0]])]).unwrap();
        assert!((exact - 1.0).abs() < 1e-12 && wrong < 0.0, "{exact} {wrong}");
        let few = tornados(&parameters, &[gradient(&[[1.0, 0.0]])], &points()[..3]);
        assert_eq!(few[0].linear_share, None);
    }

    #[test]
    fn a_mode_may_squeal_where_it_does_or_one_bar_reaches_there() {
        let parameters = [parameter("p", 0.5, 1.5), parameter("q", 10.0, 30.0)];
        let by = |criterion: InstabilityCriterion, slope: f64, points: &[PointResult]| {
            let gradients = [gradient(&[[slope, 0.0]]), gradient(&[[0.0, 0.0]])];
            tornados(&parameters, &gradients, points)[0].may_squeal(points, criterion)
        };
        let may = |slope: f64, points: &[PointResult]| by(InstabilityCriterion::default(), slope, points);
        let quiet = &points()[..1];
        // From 1 to the quantile 1.45: -3 + 0.45 slope.
        assert!(!may(6.6, quiet) && may(6.7, quiet) && may(-6.7, quiet));
        assert!(!may(3.003 / 0.45, quiet), "rounding");
        let limit = InstabilityCriterion::GrowthRate(5.0);
        assert!(!by(limit, 7.9 / 0.45, quiet) && by(limit, 8.1 / 0.45, quiet), "-3 + 0.45 slope above 5");
        assert!(may(0.0, &[points()[0].clone(), point([1.0, 20.0], [0.1, -1.0])]));
    }

    #[test]
    fn a_step_is_a_part_of_the_range_and_none_is_zero() {
        let is_near = |step: Option<f64>, expected: f64| (step.unwrap() - expected).abs() < 1e-12;
        assert!(is_near(parameter("p", 0.0, 10.0).step(3.0), 0.09));
        let constant =
            |value: f64| Parameter { distribution: Distribution::Values(vec![value]), ..parameter("p", 0.0, 1.0) };
        assert!(is_near(constant(4.0).step(4.0), 0.004) && is_near(constant(1.0).step(-4.0), 0.004));
        assert!(is_near(constant(-4.0).step(0.0), 0.004), "nominally 0");
        assert_eq!(constant(0.0).step(0.0), None);
    }

    #[test]
    fn a_parameter_without_a_derivative_has_its_reason_and_no_bar() {
        let parameters = [parameter("p", 0.5, 1.5), parameter("q", 10.0, 30.0)];
        let none = Gradient { slopes: Vec::new(), difference: Difference::None("lost".into()) };
        let all = tornados(&parameters, &[gradient(&[[1.0, 0.0], [0.0, 0.0]]), none.clone()], &points());
        assert!(all.iter().all(|own| own.bars.len() == 1 && own.bars[0].parameter == "p"));
        let missing = missing_derivatives(&parameters, &[gradient(&[]), none.clone()]);
        assert_eq!(missing, [MissingDerivative { parameter: "q".into(), reason: "lost".into() }]);
        assert_eq!(tornados(&parameters, &[none.clone(), none], &points()).len(), 2, "modes of gradients.csv");
        assert_eq!(tornados(&parameters, &[], &points()), []);
    }
}
