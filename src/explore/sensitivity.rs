//! Which parameter matters: Sobol indices with bootstrap intervals, and the swing of one parameter at a time.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::statistics::quantile;

/// An estimate with its interval of 95 % confidence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// Shares of a parameter in the variance of a quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Indices {
    /// The parameter.
    pub parameter: String,
    /// By itself alone: `V(E(f | x_i)) / V(f)`.
    pub first_order: Estimate,
    /// With all interactions: `E(V(f | all but x_i)) / V(f)`.
    pub total: Estimate,
}

/// How far a quantity moves while one parameter does.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bar {
    /// The parameter.
    pub parameter: String,
    /// Value of the parameter at which the quantity is smallest.
    pub lowest_at: f64,
    /// The smallest quantity.
    pub lowest: f64,
    /// Value of the parameter at which the quantity is largest.
    pub highest_at: f64,
    /// The largest quantity.
    pub highest: f64,
}

/// Bootstrap samples.
const N_SAMPLES: usize = 1000;

/// Sobol indices of a quantity from its values at the points of [`super::DesignKind::Saltelli`], in their order. Base
/// points of which any value is missing are left out. None where fewer than two are left, or all values are equal.
///
/// ```text
/// V_i  = 1/n sum f(B)_j (f(A_B^i)_j - f(A)_j)             first order (Saltelli et al. 2010, table 2, b)
/// VT_i = 1/(2n) sum (f(A)_j - f(A_B^i)_j)^2               total (Jansen 1999; the same table, f)
/// S_i = V_i / V, ST_i = VT_i / V, with the mean of f taken off, V the variance of all f(A) and f(B)
/// ```
///
/// Intervals are the quantiles 2.5 and 97.5 % over 1000 resampled sets of base points. Source: Saltelli et al., Comput.
/// Phys. Commun. 181 (2010).
///
/// # Panics
/// Where there are not k + 2 values for each base point.
pub fn sobol_indices(parameters: &[&str], values: &[Option<f64>], seed: u32) -> Option<Vec<Indices>> {
    let rows = whole_base_points(parameters.len(), values);
    let all: Vec<usize> = (0..rows.len()).collect();
    let whole = estimates(&rows, &all)?;
    let mut chance = Pcg64::seed_from_u64(u64::from(seed));
    let resample = |_| {
        let chosen: Vec<usize> = (0..rows.len()).map(|_| chance.random_range(0..rows.len())).collect();
        estimates(&rows, &chosen)
    };
    let samples: Vec<_> = (0..N_SAMPLES).filter_map(resample).collect();
    let estimate = |which: &dyn Fn(&Vec<[f64; 2]>) -> f64| {
        let mut sorted: Vec<f64> = samples.iter().map(which).collect();
        sorted.sort_by(f64::total_cmp);
        let [low, high] = [0.025, 0.975].map(|u| quantile(&sorted, u).unwrap_or(f64::NAN));
        Estimate { value: which(&whole), low, high }
    };
    let of = |(i, parameter): (usize, &&str)| Indices {
        parameter: (*parameter).to_owned(),
        first_order: estimate(&|sample| sample[i][0]),
        total: estimate(&|sample| sample[i][1]),
    };
    Some(parameters.iter().enumerate().map(of).collect())
}

/// The values of the base points of which none is missing, `k + 2` each.
///
/// # Panics
/// Where there are not k + 2 values for each base point.
pub(super) fn whole_base_points(n_parameters: usize, values: &[Option<f64>]) -> Vec<Vec<f64>> {
    let width = n_parameters + 2;
    assert_eq!(values.len() % width, 0, "k + 2 values a base point");
    values.chunks(width).filter_map(|row| row.iter().copied().collect()).collect()
}

/// First-order and total index of each parameter from some of the rows `f(A), f(B), f(A_B^1), ...`.
fn estimates(rows: &[Vec<f64>], chosen: &[usize]) -> Option<Vec<[f64; 2]>> {
    let n = chosen.len() as f64;
    let both = || chosen.iter().flat_map(|&j| [rows[j][0], rows[j][1]]);
    let mean = both().sum::<f64>() / (2.0 * n);
    let variance = both().map(|f| (f - mean).powi(2)).sum::<f64>() / (2.0 * n - 1.0);
    if chosen.len() < 2 || variance <= 0.0 {
        return None;
    }
    let n_parameters = rows[0].len() - 2;
    let of = |i: usize| {
        let sum = |term: &dyn Fn(&[f64]) -> f64| chosen.iter().map(|&j| term(&rows[j])).sum::<f64>();
        let first = sum(&|row| (row[1] - mean) * (row[2 + i] - row[0])) / n;
        let total = sum(&|row| (row[0] - row[2 + i]).powi(2)) / (2.0 * n);
        [first / variance, total / variance]
    };
    Some((0..n_parameters).map(of).collect())
}

/// The bars of a tornado, the longest first: for each parameter the smallest and largest quantity while it alone
/// differs from its nominal value. `points` are values of the parameters with the quantity there, the nominal point
/// among them.
pub fn tornado(parameters: &[&str], nominal: &[f64], points: &[(&[f64], f64)]) -> Vec<Bar> {
    let bar = |(i, parameter): (usize, &&str)| {
        let is_own = |values: &[f64]| (0..nominal.len()).all(|j| j == i || values[j] == nominal[j]);
        let own = || points.iter().filter(|(values, _)| is_own(values));
        let lowest = own().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let highest = own().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(Bar {
            parameter: (*parameter).to_owned(),
            lowest_at: lowest.0[i],
            lowest: lowest.1,
            highest_at: highest.0[i],
            highest: highest.1,
        })
    };
    let mut bars: Vec<Bar> = parameters.iter().enumerate().filter_map(bar).collect();
    bars.sort_by(|a, b| (b.highest - b.lowest).total_cmp(&(a.highest - a.lowest)));
    bars
}

#[cfg(test)]
mod tests {
    use super::super::{Design, DesignKind, Distribution};
    use super::*;
    use std::f64::consts::PI;

    fn indices(f: impl Fn(&[f64]) -> Option<f64>, of: &[&Distribution], n_base: usize) -> Vec<Indices> {
        let design = Design { kind: DesignKind::Saltelli { n_base }, seed: 3, correlation: None };
        let points = design.points(of, &vec![0.0; of.len()]).unwrap();
        let values: Vec<Option<f64>> = points.iter().map(|point| f(point)).collect();
        sobol_indices(&["x1", "x2", "x3"][..of.len()], &values, 5).unwrap()
    }

    /// `f = sin x1 + a sin^2 x2 + b x3^4 sin x1`, a = 7, b = 0.1, x uniform in (-pi, pi). Source: Ishigami and Homma,
    /// 1990; exact variances from Saltelli et al., Global Sensitivity Analysis (2008), section 4.5.
    #[test]
    fn indices_of_ishigamis_function_are_exact() {
        let (a, b) = (7.0, 0.1);
        let f = |x: &[f64]| Some(x[0].sin() + a * x[1].sin().powi(2) + b * x[2].powi(4) * x[0].sin());
        let x = Distribution::Uniform { from: -PI, to: PI };
        let found = indices(f, &[&x, &x, &x], 4096);
        let v1 = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
        let v2 = a * a / 8.0;
        let v13 = b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
        let v = v1 + v2 + v13;
        let exact = [[v1, v1 + v13], [v2, v2], [0.0, v13]].map(|pair| pair.map(|part| part / v));
        for (found, [first, total]) in found.iter().zip(exact) {
            assert!((found.first_order.value - first).abs() < 0.01, "{found:?}, exact {first}");
            assert!((found.total.value - total).abs() < 0.01, "{found:?}, exact {total}");
            for (estimate, exact) in [(found.first_order, first), (found.total, total)] {
                assert!(estimate.low <= exact && exact <= estimate.high && estimate.high - estimate.low < 0.2);
            }
        }
    }

    #[test]
    fn base_points_without_all_values_are_left_out() {
        let x = Distribution::Uniform { from: 0.0, to: 1.0 };
        let found = indices(|x| (x[0] < 0.95).then(|| 3.0 * x[0] + x[1]), &[&x, &x], 512);
        assert!(found.iter().all(|index| index.first_order.value.is_finite()));
        // Variances 9 c^2 / 12 and 1 / 12 with x1 in (0, c), c = 0.95.
        assert!((found[0].total.value - 8.1225 / 9.1225).abs() < 0.03, "{found:?}");
        assert_eq!(sobol_indices(&["x1"], &[Some(1.0); 9], 1), None, "no variance");
        assert_eq!(sobol_indices(&["x1"], &[None; 9], 1), None, "no values");
    }

    #[test]
    fn bars_are_sorted_by_their_length() {
        let points: Vec<[f64; 2]> = vec![[1.0, 1.0], [0.5, 1.0], [2.0, 1.0], [1.0, 0.0], [1.0, 3.0]];
        let values: Vec<(&[f64], f64)> = points.iter().map(|p| (&p[..], p[0] - 10.0 * p[1])).collect();
        let bars = tornado(&["small", "large"], &[1.0, 1.0], &values);
        let of = |bar: &Bar| (bar.parameter.clone(), bar.lowest_at, bar.lowest, bar.highest_at, bar.highest);
        assert_eq!(of(&bars[0]), ("large".into(), 3.0, -29.0, 0.0, 1.0));
        assert_eq!(of(&bars[1]), ("small".into(), 0.5, -9.5, 2.0, -8.0));
    }
}
