//! Fractions of points as probabilities, and quantiles.

use serde::Serialize;

/// A probability from a fraction of points, with its interval of 95 % confidence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Probability {
    /// Points at which it is so.
    pub n_true: usize,
    /// All points.
    pub n_points: usize,
    /// The fraction.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// `Phi^-1(0.975)`
const Z: f64 = 1.959_963_984_540_054;

impl Probability {
    /// Wilson's interval of k among n independent points, `p = k / n`:
    ///
    /// ```text
    /// (p + z^2 / (2 n) +- z sqrt(p (1 - p) / n + z^2 / (4 n^2))) / (1 + z^2 / n)
    /// ```
    ///
    /// Points of a Latin hypercube or Sobol sequence are spread more evenly, so that the interval is usually too wide.
    /// Source: Wilson, J. Am. Stat. Assoc. 22 (1927).
    ///
    /// ```
    /// let squeal = squeal::explore::Probability::of(3, 10);
    /// assert!(squeal.value == 0.3 && squeal.low > 0.10 && squeal.high < 0.61);
    /// ```
    pub fn of(n_true: usize, n_points: usize) -> Probability {
        if n_points == 0 {
            return Probability { n_true, n_points, value: 0.0, low: 0.0, high: 1.0 };
        }
        let n = n_points as f64;
        let p = n_true as f64 / n;
        let middle = p + Z * Z / (2.0 * n);
        let half = Z * (p * (1.0 - p) / n + (Z / (2.0 * n)).powi(2)).sqrt();
        let whole = 1.0 + Z * Z / n;
        let low = if n_true == 0 { 0.0 } else { (middle - half) / whole };
        let high = if n_true == n_points { 1.0 } else { (middle + half) / whole };
        Probability { n_true, n_points, value: p, low, high }
    }
}

/// The quantile `u` of rising values, linear between them (type 7 of Hyndman and Fan); none without values.
pub fn quantile(sorted: &[f64], u: f64) -> Option<f64> {
    let place = u * sorted.len().checked_sub(1)? as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    Some(below + (place - place.floor()) * (above - below))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: Newcombe, Statistics in Medicine 17 (1998), table I, method 3: 81/263, 15/148, 0/20, 1/29.
    #[test]
    fn intervals_are_the_published_ones() {
        for (k, n, low, high) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let found = Probability::of(k, n);
            assert!((found.low - low).abs() < 5e-5 && (found.high - high).abs() < 5e-5, "{k} of {n}: {found:?}");
        }
        assert_eq!(Probability::of(20, 20).high, 1.0);
        assert_eq!((Probability::of(0, 0).low, Probability::of(0, 0).high), (0.0, 1.0));
    }

    #[test]
    fn quantiles_are_between_the_values() {
        let values = [1.0, 2.0, 4.0];
        assert_eq!([0.0, 0.25, 0.5, 0.75, 1.0].map(|u| quantile(&values, u).unwrap()), [1.0, 1.5, 2.0, 3.0, 4.0]);
        assert_eq!((quantile(&[], 0.5), quantile(&[3.0], 0.9)), (None, Some(3.0)));
    }
}
