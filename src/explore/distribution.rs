//! Which values a parameter takes, and how probable they are.

use statrs::distribution::{ContinuousCDF, Normal};

/// The values of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Distribution {
    /// These values, the smallest first, each equally probable.
    Values(Vec<f64>),
    /// All values between two, equally probable.
    Uniform {
        /// The smallest.
        from: f64,
        /// The largest.
        to: f64,
    },
    /// All values between two, which are above 0, their logarithms equally probable.
    LogUniform {
        /// The smallest.
        from: f64,
        /// The largest.
        to: f64,
    },
    /// The normal distribution, cut off at bounds where these are finite.
    Normal {
        /// Mean of the distribution that is not cut off.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
        /// The smallest value; minus infinity for none.
        from: f64,
        /// The largest value; infinity for none.
        to: f64,
    },
    /// A variable whose logarithm has a normal distribution.
    LogNormal {
        /// Mean of the variable.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
}

/// Ends of a distribution without bounds, as probabilities: what a grid and one-at-a-time designs reach.
const TAILS: [f64; 2] = [0.05, 0.95];
/// Probabilities are kept this far from 0 and 1, where quantiles are infinite: half of the resolution of the points.
pub(super) const RESOLUTION: f64 = 1.0 / (1 << 25) as f64;

impl Distribution {
    /// The value below which the fraction `u` of the distribution lies, `F^-1(u)`; `u` in [0, 1].
    ///
    /// ```
    /// use squeal::explore::Distribution;
    ///
    /// let mu = Distribution::Uniform { from: 0.3, to: 0.5 };
    /// assert_eq!((mu.quantile(0.0), mu.quantile(0.5), mu.quantile(1.0)), (0.3, 0.4, 0.5));
    /// ```
    pub fn quantile(&self, u: f64) -> f64 {
        match self {
            Distribution::Values(values) => values[((u * values.len() as f64) as usize).min(values.len() - 1)],
            // F^-1(u) = (1 - u) a + u b
            Distribution::Uniform { from, to } => (1.0 - u) * from + u * to,
            // F^-1(u) = a (b / a)^u
            Distribution::LogUniform { from, to } => from * (to / from).powf(u),
            // F^-1(u) = m + s Phi^-1(Phi_a + u (Phi_b - Phi_a)),  Phi_a = Phi((a - m) / s)
            Distribution::Normal { mean, deviation, from, to } => {
                let [low, high] = [from, to].map(|bound| standard().cdf((bound - mean) / deviation));
                (mean + deviation * inverse(low + u * (high - low))).clamp(*from, *to)
            }
            // sigma^2 = ln(1 + (s / m)^2),  F^-1(u) = m exp(sigma Phi^-1(u) - sigma^2 / 2)
            Distribution::LogNormal { mean, deviation } => {
                let variance = (deviation / mean).powi(2).ln_1p();
                mean * (variance.sqrt() * inverse(u) - 0.5 * variance).exp()
            }
        }
    }

    /// `n` values from one end to the other: all of a list, whatever `n`; the ends are the bounds, or the quantiles 5
    /// and 95 % of a distribution without bounds. The middle for `n = 1`.
    pub fn levels(&self, n: usize) -> Vec<f64> {
        if let Distribution::Values(values) = self {
            return values.clone();
        }
        let [low, high] = match self {
            Distribution::Uniform { .. } | Distribution::LogUniform { .. } => [0.0, 1.0],
            _ => TAILS,
        };
        let at = |i: usize| if n == 1 { 0.5 } else { low + (high - low) * i as f64 / (n - 1) as f64 };
        (0..n).map(|i| self.quantile(at(i))).collect()
    }
}

fn standard() -> Normal {
    Normal::standard()
}

/// `Phi^-1(u)`, finite.
fn inverse(u: f64) -> f64 {
    standard().inverse_cdf(u.clamp(RESOLUTION, 1.0 - RESOLUTION))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::E;

    /// Mean and standard deviation by the midpoint rule over probabilities.
    fn moments(distribution: &Distribution) -> [f64; 2] {
        let n = 200_000;
        let values: Vec<f64> = (0..n).map(|i| distribution.quantile((i as f64 + 0.5) / n as f64)).collect();
        let mean = values.iter().sum::<f64>() / n as f64;
        [mean, (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n as f64).sqrt()]
    }

    #[test]
    fn moments_are_those_of_the_distributions() {
        let free = Distribution::Normal { mean: 3.0, deviation: 0.5, from: f64::NEG_INFINITY, to: f64::INFINITY };
        // Half of a normal distribution: mean s sqrt(2 / pi), deviation s sqrt(1 - 2 / pi).
        let half = Distribution::Normal { mean: 0.0, deviation: 2.0, from: 0.0, to: f64::INFINITY };
        let ratio = 2.0 / std::f64::consts::PI;
        for (distribution, mean, deviation) in [
            (free, 3.0, 0.5),
            (half, 2.0 * ratio.sqrt(), 2.0 * (1.0 - ratio).sqrt()),
            (Distribution::LogNormal { mean: 2.0, deviation: 0.4 }, 2.0, 0.4),
            (Distribution::Uniform { from: 1.0, to: 4.0 }, 2.5, 3.0 / 12.0_f64.sqrt()),
            // Mean (b - a) / ln(b / a), variance (b^2 - a^2) / (2 ln(b / a)) - mean^2.
            (Distribution::LogUniform { from: 1.0, to: E }, E - 1.0, (0.5 * (E * E - 1.0) - (E - 1.0).powi(2)).sqrt()),
        ] {
            let found = moments(&distribution);
            assert!((found[0] - mean).abs() < 1e-3 * mean, "{distribution:?}: mean {found:?}");
            assert!((found[1] - deviation).abs() < 2e-3 * deviation, "{distribution:?}: deviation {found:?}");
        }
    }

    #[test]
    fn quantiles_are_finite_and_within_bounds() {
        let cut = Distribution::Normal { mean: 0.5, deviation: 0.2, from: 0.1, to: 0.6 };
        assert!((0.1..0.101).contains(&cut.quantile(0.0)) && (0.599..=0.6).contains(&cut.quantile(1.0)));
        let free = Distribution::Normal { mean: 0.0, deviation: 1.0, from: f64::NEG_INFINITY, to: f64::INFINITY };
        assert!(free.quantile(0.0) < -5.0 && free.quantile(0.0).is_finite());
        assert!((free.quantile(0.975) - 1.959_963_985).abs() < 1e-8);
    }

    #[test]
    fn values_of_a_list_are_equally_probable() {
        let list = Distribution::Values(vec![1.0, 5.0]);
        assert_eq!([0.0, 0.49, 0.5, 1.0].map(|u| list.quantile(u)), [1.0, 1.0, 5.0, 5.0]);
    }

    #[test]
    fn levels_reach_from_end_to_end() {
        assert_eq!(Distribution::Uniform { from: 1.0, to: 3.0 }.levels(3), [1.0, 2.0, 3.0]);
        assert_eq!(Distribution::LogUniform { from: 1.0, to: 4.0 }.levels(3), [1.0, 2.0, 4.0]);
        assert_eq!(Distribution::Values(vec![4.0, 7.0]).levels(9), [4.0, 7.0]);
        let free = Distribution::Normal { mean: 0.0, deviation: 1.0, from: f64::NEG_INFINITY, to: f64::INFINITY };
        let levels = free.levels(3);
        assert!((levels[0] + 1.644_854).abs() < 1e-5 && levels[1].abs() < 1e-12 && levels[0] == -levels[2]);
        assert!(free.levels(1)[0].abs() < 1e-12);
    }
}
