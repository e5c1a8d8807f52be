//! Parameters that depend on each other.

use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, Normal};

use super::distribution::RESOLUTION;

/// A Gaussian copula: the normal scores of the parameters have given coefficients of correlation, and each parameter
/// keeps its own distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Lower triangular L, `R = L L^T`.
    factor: DMatrix<f64>,
}

impl Correlation {
    /// Of n parameters, some pairs of which are correlated; none where no parameters can have these coefficients.
    ///
    /// # Panics
    /// Where a pair names a parameter that there is not.
    pub fn new(n: usize, pairs: &[([usize; 2], f64)]) -> Option<Correlation> {
        let mut matrix = DMatrix::identity(n, n);
        for &([i, j], coefficient) in pairs {
            matrix[(i, j)] = coefficient;
            matrix[(j, i)] = coefficient;
        }
        matrix.cholesky().map(|cholesky| Correlation { factor: cholesky.l() })
    }

    /// Turns independent coordinates of the unit cube into correlated ones, `z' = L z` with `z = Phi^-1(u)`.
    pub fn apply(&self, point: &[f64]) -> Vec<f64> {
        let normal = Normal::standard();
        let score = |u: &f64| normal.inverse_cdf(u.clamp(RESOLUTION, 1.0 - RESOLUTION));
        let z = nalgebra::DVector::from_iterator(point.len(), point.iter().map(score));
        (&self.factor * z).iter().map(|z| normal.cdf(*z)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Design, DesignKind, Distribution};
    use super::*;

    #[test]
    fn normal_parameters_have_the_coefficient_and_keep_their_distributions() {
        let normal = Distribution::Normal { mean: 3.0, deviation: 0.5, from: f64::NEG_INFINITY, to: f64::INFINITY };
        let uniform = Distribution::Uniform { from: 0.0, to: 1.0 };
        let correlation = Correlation::new(3, &[([0, 2], -0.7)]);
        let design = Design { kind: DesignKind::Sobol { n_points: 4096 }, seed: 1, correlation };
        let points = design.points(&[&normal, &uniform, &normal], &[3.0, 0.5, 3.0]).unwrap();
        let mean = |f: &dyn Fn(&[f64]) -> f64| points.iter().map(|point| f(point)).sum::<f64>() / points.len() as f64;
        let covariance = mean(&|p| (p[0] - 3.0) * (p[2] - 3.0));
        assert!((covariance / 0.25 + 0.7).abs() < 0.01, "{covariance}");
        assert!(mean(&|p| (p[0] - 3.0) * (p[1] - 0.5)).abs() < 1e-3);
        assert!((mean(&|p| p[2]) - 3.0).abs() < 1e-3 && (mean(&|p| (p[2] - 3.0).powi(2)) / 0.25 - 1.0).abs() < 0.01);
    }

    #[test]
    fn coefficients_that_contradict_each_other_are_refused() {
        assert!(Correlation::new(3, &[([0, 1], 0.9), ([1, 2], 0.9), ([0, 2], -0.9)]).is_none());
        assert!(Correlation::new(2, &[([0, 1], 1.0)]).is_none(), "one parameter twice");
    }
}
