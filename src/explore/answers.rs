//! Results over all points of a study.

use serde::Serialize;

use super::adaptive::BoundaryPair;
use super::design::DesignKind;
use super::gradient::{Gradient, MissingDerivative, Tornado, missing_derivatives, tornados};
use super::hopf::HopfCurves;
use super::instability::{Instability, instabilities};
use super::predicted::Prediction;
use super::result::{PointMode, PointResult};
use super::sensitivity::{Bar, Indices, sobol_indices, tornado, whole_base_points};
use super::statistics::{Probability, quantile};
use super::study::Study;
use crate::model::InstabilityCriterion;

/// The answers of a study. Points have numbers from 1; the nominal point has number 0.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answers {
    /// Points without the nominal one.
    pub n_points: usize,
    /// Points that have failed.
    pub n_failed: usize,
    /// Modes whose link to the nominal point is doubtful.
    pub n_doubtful: usize,
    /// Whether points represent the distributions of the parameters. If not, probabilities are fractions of the points.
    pub is_sample: bool,
    /// That any mode is unstable, of the points that have not failed.
    pub unstable: Probability,
    /// The fraction of all points that are unstable where none of the failed ones is, and where all are; none where
    /// none has failed.
    pub with_failed: Option<[f64; 2]>,
    /// Quantiles of the largest growth rate, 1/s.
    pub growth_rate: Vec<Quantile>,
    /// The modes of the nominal point that are unstable anywhere, the most probable first, and those that are no mode
    /// of it.
    pub instabilities: Vec<Instability>,
    /// Squeal probability over frequency.
    pub bins: Vec<Bin>,
    /// Sobol indices of the largest growth rate, where the design is for them.
    pub indices: Option<Vec<Indices>>,
    /// How many base points these are of: those whose points all have modes in the band.
    pub n_base_points: usize,
    /// Swings of the largest growth rate, where one parameter varies at a time.
    pub tornado: Option<Vec<Bar>>,
    /// First-order changes of the nominal modes that may squeal over the range of each parameter, by left vectors.
    pub gradients: Vec<Tornado>,
    /// Parameters without a derivative.
    pub missing_derivatives: Vec<MissingDerivative>,
    /// Neighbours with opposite verdicts of an adaptive design, the widest apart first.
    pub boundary: Vec<BoundaryPair>,
    /// Where modes turn unstable on a map.
    pub hopf: HopfCurves,
    /// The point with the largest growth rate.
    pub worst: Option<usize>,
}

/// A quantile of the largest growth rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantile {
    /// Fraction of the points below.
    pub fraction: f64,
    /// Growth rate, 1/s.
    pub growth_rate_per_s: f64,
}

/// That a mode is unstable in a range of frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bin {
    /// Lower end, Hz, in the range.
    pub from_hz: f64,
    /// Upper end, Hz, not in the range.
    pub to_hz: f64,
    /// The probability.
    pub probability: Probability,
}

/// Fractions at which quantiles are given.
const FRACTIONS: [f64; 7] = [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0];

/// The quantity of Sobol indices, tornado and quantiles: the largest growth rate of a point, 1/s.
pub fn quantity(point: &PointResult) -> Option<f64> {
    point.critical().map(PointMode::growth_rate)
}

impl Answers {
    /// The answers of finished points, the nominal one first, then those of the design in its order. `gradients` are
    /// derivatives by each parameter; `band` in Hz; `criterion` is what the points' modes are unstable by.
    ///
    /// # Panics
    /// Without a nominal point.
    pub fn new(
        study: &Study,
        points: &[PointResult],
        gradients: &[Gradient],
        band: [f64; 2],
        criterion: InstabilityCriterion,
    ) -> Answers {
        let (nominal, own) = points.split_first().expect("the nominal point");
        let solved: Vec<(usize, &PointResult)> = (1..).zip(own).filter(|(_, point)| point.modes().is_some()).collect();
        let sample: Vec<(usize, &PointResult)> =
            solved.iter().copied().filter(|(number, _)| study.is_independent(number - 1)).collect();
        let n_unstable = sample.iter().filter(|(_, point)| point.is_unstable()).count();
        let growth = |(number, point): &(usize, &PointResult)| Some((*number, quantity(point)?));
        let worst = solved.iter().filter_map(growth).max_by(|a, b| a.1.total_cmp(&b.1));
        let n_counted = (0..own.len()).filter(|index| study.is_independent(*index)).count();
        let n_sample_failed = n_counted - sample.len();
        let prediction = Prediction::new(study, gradients, &nominal.values, criterion).filter(|_| n_sample_failed == 0);
        let with_failed = [n_unstable, n_unstable + n_sample_failed].map(|n| n as f64 / n_counted as f64);
        let (indices, n_base_points) = indices(study, own);
        Answers {
            n_points: own.len(),
            n_failed: own.len() - solved.len(),
            n_doubtful: solved.iter().flat_map(|(_, point)| doubtful(point)).count(),
            is_sample: study.design.is_sample(),
            unstable: Probability::of(n_unstable, sample.len()),
            with_failed: (n_sample_failed > 0).then_some(with_failed),
            growth_rate: quantiles(&sample),
            instabilities: instabilities(nominal, &solved, &sample, prediction.as_ref()),
            bins: bins(&sample, band, study.bin),
            indices,
            n_base_points,
            tornado: bars(study, nominal, &solved),
            gradients: may_squeal(study, gradients, points, criterion),
            missing_derivatives: missing_derivatives(&study.parameters, gradients),
            boundary: study.boundary(own),
            hopf: study.hopf(own),
            worst: worst.map(|(number, _)| number),
        }
    }
}

impl Study {
    /// Whether a point is independent of the others, so that it counts for probabilities: of a design for Sobol indices
    /// only A and B, of a design that adds points only those that it starts with.
    pub fn is_independent(&self, index: usize) -> bool {
        match self.design.kind {
            DesignKind::Saltelli { .. } => index % (self.parameters.len() + 2) < 2,
            _ => self.design.n_start().is_none_or(|n_start| index < n_start),
        }
    }

    /// The levels of the two parameters of a grid or map; none of another design.
    pub fn plane(&self) -> Option<[Vec<f64>; 2]> {
        match (&self.design.kind, &self.parameters[..]) {
            (DesignKind::Grid { n_levels } | DesignKind::Map { n_levels }, [a, b]) => {
                Some([a, b].map(|own| own.distribution.levels(*n_levels)))
            }
            _ => None,
        }
    }

    fn names(&self) -> Vec<&str> {
        self.parameters.iter().map(|parameter| parameter.name.as_str()).collect()
    }
}

fn doubtful(point: &PointResult) -> impl Iterator<Item = &PointMode> {
    point.modes().into_iter().flatten().filter(|mode| mode.link.is_some_and(|link| link.doubtful))
}

/// Quantiles of the largest growth rate.
fn quantiles(sample: &[(usize, &PointResult)]) -> Vec<Quantile> {
    let mut sorted: Vec<f64> = sample.iter().filter_map(|(_, point)| quantity(point)).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |&fraction: &f64| Some(Quantile { fraction, growth_rate_per_s: quantile(&sorted, fraction)? });
    FRACTIONS.iter().filter_map(at).collect()
}

fn bins(sample: &[(usize, &PointResult)], band: [f64; 2], width: f64) -> Vec<Bin> {
    let n = ((band[1] - band[0]) / width).ceil().max(1.0) as usize;
    let bin = |i: usize| {
        let [from_hz, to_hz] = [i, i + 1].map(|i| (band[0] + i as f64 * width).min(band[1]));
        // The last bin has its end.
        let is_in = |f: f64| f >= from_hz && (f < to_hz || i + 1 == n && f <= to_hz);
        let squeals = |(_, point): &&(usize, &PointResult)| {
            point.modes().into_iter().flatten().any(|mode| mode.unstable && is_in(mode.frequency()))
        };
        Bin { from_hz, to_hz, probability: Probability::of(sample.iter().filter(squeals).count(), sample.len()) }
    };
    (0..n).map(bin).collect()
}

/// Sobol indices, and of how many base points.
fn indices(study: &Study, own: &[PointResult]) -> (Option<Vec<Indices>>, usize) {
    if !matches!(study.design.kind, DesignKind::Saltelli { .. }) {
        return (None, 0);
    }
    let values: Vec<Option<f64>> = own.iter().map(quantity).collect();
    let n_base_points = whole_base_points(study.parameters.len(), &values).len();
    (sobol_indices(&study.names(), &values, study.design.seed), n_base_points)
}

fn bars(study: &Study, nominal: &PointResult, solved: &[(usize, &PointResult)]) -> Option<Vec<Bar>> {
    if !matches!(study.design.kind, DesignKind::OneAtATime { .. }) {
        return None;
    }
    let all = solved.iter().map(|(_, point)| *point).chain([nominal]);
    let points: Vec<(&[f64], f64)> = all.filter_map(|point| Some((&point.values[..], quantity(point)?))).collect();
    Some(tornado(&study.names(), &nominal.values, &points))
}

/// The tornados of the nominal modes that may squeal, where a parameter has a derivative.
fn may_squeal(
    study: &Study,
    gradients: &[Gradient],
    points: &[PointResult],
    criterion: InstabilityCriterion,
) -> Vec<Tornado> {
    let all = tornados(&study.parameters, gradients, points);
    all.into_iter().filter(|own| !own.bars.is_empty() && own.may_squeal(points, criterion)).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use num_complex::Complex64;

    use super::super::{Design, Distribution, KeyPath, Link, Outcome, Parameter};
    use super::*;

    fn study(kind: DesignKind, n_parameters: usize) -> Study {
        let parameter = |i: usize| Parameter {
            name: format!("p{i}"),
            keys: vec![KeyPath::parse("friction").unwrap()],
            is_factor: false,
            distribution: Distribution::Uniform { from: 0.4, to: 0.9 },
        };
        Study {
            file: "explore.toml".into(),
            model: "brake.toml".into(),
            parameters: (0..n_parameters).map(parameter).collect(),
            fields: Vec::new(),
            design: Design { kind, seed: 1, correlation: None },
            contacts: None,
            band: None,
            criterion: None,
            bin: 100.0,
            follow: Some(2),
            gradients: true,
        }
    }

    fn mode(hertz: f64, growth: f64, nominal: Option<usize>) -> PointMode {
        PointMode {
            lambda: Complex64::new(growth, TAU * hertz),
            unstable: growth > 0.0,
            backward_error: 0.0,
            link: nominal.map(|nominal| Link { nominal, share: 0.9, doubtful: nominal == 2 }),
        }
    }

    fn point(modes: Vec<PointMode>) -> PointResult {
        PointResult { values: vec![0.5], outcome: Outcome::Modes(modes) }
    }

    #[test]
    fn instabilities_are_counted_by_the_nominal_modes() {
        let failed = PointResult { values: vec![0.5], outcome: Outcome::Failed("no equilibrium".into()) };
        let points = [
            point(vec![mode(150.0, -1.0, Some(1)), mode(250.0, -2.0, Some(2))]),
            point(vec![mode(160.0, 3.0, Some(1)), mode(250.0, -2.0, Some(2))]),
            point(vec![mode(140.0, 5.0, Some(1)), mode(255.0, 1.0, None)]),
            point(vec![mode(150.0, -1.0, Some(1)), mode(250.0, -2.0, Some(2))]),
            failed,
        ];
        let answers = Answers::new(
            &study(DesignKind::Sobol { n_points: 4 }, 1),
            &points,
            &[],
            [100.0, 300.0],
            InstabilityCriterion::default(),
        );
        assert_eq!((answers.n_points, answers.n_failed, answers.n_doubtful, answers.worst), (4, 1, 2, Some(2)));
        assert_eq!((answers.unstable.n_true, answers.unstable.n_points), (2, 3));
        assert_eq!(answers.with_failed, Some([0.5, 0.75]), "of all four points");
        let [first, other] = &answers.instabilities[..] else { panic!("{:?}", answers.instabilities) };
        assert_eq!((first.nominal, first.probability.n_true, first.worst), (Some(1), 2, 2));
        assert!((first.frequency_range_hz[0] - 140.0).abs() < 1e-9 && first.largest_growth_rate_per_s == 5.0);
        assert_eq!((other.nominal, other.nominal_frequency_hz, other.probability.n_true), (None, None, 1));
        let counts: Vec<usize> = answers.bins.iter().map(|bin| bin.probability.n_true).collect();
        assert_eq!(counts, [2, 1]);
        let median = answers.growth_rate.iter().find(|quantile| quantile.fraction == 0.5).unwrap();
        assert_eq!((median.growth_rate_per_s, answers.indices, answers.tornado), (3.0, None, None));
    }

    /// Hoffmann's model, `lambda^2 = -2 +- sqrt(1 - 4 mu / 3)`, with a stiffness k on both diagonals in place of 2: the
    /// largest growth rate `a` is `(lambda^2 + sqrt(...))`'s real part, `a = sqrt((|s| - k) / 2)`, `|s|^2 = k^2 + 4 mu
    /// / 3 - 1`, above mu = 3/4, 0 below.
    fn hoffmann(mu: f64, k: f64) -> PointMode {
        let root = Complex64::new(1.0 - 4.0 * mu / 3.0, 0.0).sqrt();
        let square = Complex64::new(-k, 0.0) + root;
        let lambda = square.sqrt();
        let lambda = if lambda.im < 0.0 { -lambda.conj() } else { lambda };
        let lambda = Complex64::new(lambda.re.abs(), lambda.im);
        PointMode { lambda, unstable: lambda.re > 1e-9, backward_error: 0.0, link: None }
    }

    fn explored(kind: DesignKind) -> Answers {
        let mut study = study(kind, 2);
        study.parameters[1].distribution = Distribution::Uniform { from: 1.8, to: 2.2 };
        let distributions: Vec<&Distribution> = study.parameters.iter().map(|own| &own.distribution).collect();
        let design = study.design.points(&distributions, &[0.5, 2.0]).unwrap();
        let all = [vec![0.5, 2.0]].into_iter().chain(design);
        let points: Vec<PointResult> = all
            .map(|values| PointResult { outcome: Outcome::Modes(vec![hoffmann(values[0], values[1])]), values })
            .collect();
        Answers::new(&study, &points, &[], [0.0, 1.0], InstabilityCriterion::default())
    }

    /// Mean of a function over mu in (0.4, 0.9) and k in (1.8, 2.2), by the midpoint rule.
    fn mean(f: impl Fn(f64, f64) -> f64) -> f64 {
        let n = 1000;
        let at = |i: usize| (i as f64 + 0.5) / n as f64;
        let row = |i: usize| (0..n).map(|j| f(0.4 + 0.5 * at(i), 1.8 + 0.4 * at(j))).sum::<f64>();
        (0..n).map(row).sum::<f64>() / (n * n) as f64
    }

    /// mu is uniform in (0.4, 0.9), so that the model is unstable with probability (0.9 - 0.75) / 0.5 = 0.3.
    #[test]
    fn the_squeal_probability_of_hoffmanns_model_is_exact() {
        let answers = explored(DesignKind::Sobol { n_points: 1024 });
        assert!((answers.unstable.value - 0.3).abs() < 2e-3, "{:?}", answers.unstable);
        assert!(answers.unstable.low < 0.3 && 0.3 < answers.unstable.high);
        let answers = explored(DesignKind::LatinHypercube { n_points: 1000 });
        assert!((answers.unstable.value - 0.3).abs() < 2e-3, "{:?}", answers.unstable);
        // a rises with mu: at k = 2 the quantile 0.95 is that of mu = 0.4 + 0.95 * 0.5.
        let found = answers.growth_rate.iter().find(|quantile| quantile.fraction == 0.95).unwrap();
        assert!((found.growth_rate_per_s / hoffmann(0.875, 2.0).lambda.re - 1.0).abs() < 0.02, "{found:?}");
    }

    #[test]
    fn the_indices_of_hoffmanns_model_are_those_of_exact_integrals() {
        let f = |mu: f64, k: f64| hoffmann(mu, k).lambda.re;
        let whole = mean(f);
        let variance = mean(|mu, k| (f(mu, k) - whole).powi(2));
        let n = 400;
        let over = |low: f64, length: f64, g: &dyn Fn(f64) -> f64| {
            (0..n).map(|i| g(low + length * (i as f64 + 0.5) / n as f64)).sum::<f64>() / n as f64
        };
        let given_mu = |mu: f64| over(1.8, 0.4, &|k| f(mu, k));
        let given_k = |k: f64| over(0.4, 0.5, &|mu| f(mu, k));
        let first = [
            over(0.4, 0.5, &|mu| (given_mu(mu) - whole).powi(2)) / variance,
            over(1.8, 0.4, &|k| (given_k(k) - whole).powi(2)) / variance,
        ];
        let answers = explored(DesignKind::Saltelli { n_base: 1024 });
        let indices = answers.indices.unwrap();
        for (i, index) in indices.iter().enumerate() {
            let total = 1.0 - first[1 - i];
            assert!((index.first_order.value - first[i]).abs() < 0.02, "{index:?}, exact {}", first[i]);
            assert!((index.total.value - total).abs() < 0.02, "{index:?}, exact {total}");
        }
        assert_eq!((answers.unstable.n_points, answers.n_base_points), (2048, 1024), "A and B alone are independent");
        assert_eq!(answers.with_failed, None);
        assert!((answers.unstable.value - 0.3).abs() < 5e-3);
    }

    #[test]
    fn a_base_point_with_a_failed_point_has_no_part_in_indices() {
        let study = study(DesignKind::Saltelli { n_base: 3 }, 2);
        let mut points: Vec<PointResult> =
            (0..13).map(|i| point(vec![mode(100.0, f64::from(i * i % 7) - 2.0, None)])).collect();
        points[6].outcome = Outcome::Failed("no equilibrium".into());
        let answers = Answers::new(&study, &points, &[], [0.0, 300.0], InstabilityCriterion::default());
        assert_eq!((answers.n_base_points, answers.indices.map(|all| all.len())), (2, Some(2)));
    }

    #[test]
    fn one_parameter_at_a_time_makes_a_tornado() {
        let answers = explored(DesignKind::OneAtATime { n_levels: 2 });
        let bars = answers.tornado.unwrap();
        assert_eq!((bars[0].parameter.as_str(), bars[0].highest_at), ("p0", 0.9));
        assert!(bars[1].highest == 0.0 && !answers.is_sample, "below 3/4 the stiffness alone makes no growth");
    }
}
