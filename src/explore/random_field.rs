//! Random fields over the points of a contact surface, by their Karhunen-Loeve expansion.
//!
//! ```text
//! Z(x) = sum_i sqrt(lambda_i) phi_i(x) xi_i      xi_i independent standard normal variables
//! int c(x, y) phi_i(y) dA = lambda_i phi_i(x)    c(x, y) = exp(-d^2 / 2 l^2) or exp(-d / l), d = |x - y|
//! ```
//!
//! With the points' areas W the integral equation is `W^1/2 C W^1/2 v = lambda v`, `phi = W^-1/2 v` (Ghanem and Spanos,
//! Stochastic Finite Elements, 1991, section 2.3). C is factorised as `L L^T` by Cholesky's method with pivots, which
//! stops where the rest of the variance is small; then `sqrt(lambda) phi = L u` with the eigenvectors u of `L^T W L`.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::Deserialize;

/// How the correlation of two points falls with their distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kernel {
    /// `exp(-d^2 / 2 l^2)`, a smooth field.
    Gaussian,
    /// `exp(-d / l)`, a rough field.
    Exponential,
}

impl Kernel {
    /// The correlation of two points at a distance, in units of `length`.
    pub fn correlation(self, distance: f64, length: f64) -> f64 {
        let ratio = distance / length;
        match self {
            Kernel::Gaussian => (-0.5 * ratio * ratio).exp(),
            Kernel::Exponential => (-ratio).exp(),
        }
    }
}

/// A field of mean 0 and variance 1 over points, as a sum of modes.
#[derive(Debug, Clone)]
pub struct RandomField {
    /// `sqrt(lambda_i) phi_i`, a column a mode, the largest first.
    modes: DMatrix<f64>,
    /// `lambda_i` over the surface's area: shares of the variance.
    pub shares: Vec<f64>,
}

/// The factor of C leaves out this share of the variance.
const NEGLIGIBLE_SHARE: f64 = 1e-8;
/// Columns of the factor of C at most.
const MAX_COLUMNS: usize = 1000;

impl RandomField {
    /// The field over points with their areas, of at most `n_modes` modes.
    ///
    /// # Panics
    /// Where points and areas differ in number.
    pub fn new(points: &[[f64; 3]], areas: &[f64], kernel: Kernel, length: f64, n_modes: usize) -> RandomField {
        assert_eq!(points.len(), areas.len());
        // Ranks may have the points in another order, on which a factor that ends early depends.
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|&a, &b| points[a].partial_cmp(&points[b]).unwrap_or(std::cmp::Ordering::Equal));
        let sorted: Vec<[f64; 3]> = order.iter().map(|&i| points[i]).collect();
        let distance = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let factor = factor(points.len(), |i, j| kernel.correlation(distance(&sorted[i], &sorted[j]), length));
        let weights: Vec<f64> = order.iter().map(|&i| areas[i]).collect();
        let weighted = |marks: &[f64]| {
            let mut own = factor.clone();
            own.row_iter_mut().zip(marks.iter().zip(&weights)).for_each(|(mut row, (mark, w))| row *= mark * w);
            own
        };
        let marks = marks(&sorted);
        let (plain, marked) = (factor.tr_mul(&weighted(&vec![1.0; points.len()])), factor.tr_mul(&weighted(&marks)));
        let (values, mut vectors) = settled(plain, &marked);
        let sums = weighted(&marks).row_sum_tr();
        vectors.column_iter_mut().filter(|own| own.dot(&sums) < 0.0).for_each(|mut own| own.neg_mut());
        let n_modes = n_modes.min(values.len());
        let found = &factor * vectors.columns(0, n_modes);
        let mut modes = DMatrix::zeros(points.len(), n_modes);
        order.iter().enumerate().for_each(|(own, &i)| modes.set_row(i, &found.row(own)));
        let area: f64 = areas.iter().sum();
        RandomField { modes, shares: values[..n_modes].iter().map(|value| value / area).collect() }
    }

    /// The share of the variance that the modes have together.
    pub fn share(&self) -> f64 {
        self.shares.iter().sum()
    }

    /// The field at the points with coefficients of its modes.
    pub fn at(&self, coefficients: &[f64]) -> Vec<f64> {
        (&self.modes * DVector::from_column_slice(coefficients)).as_slice().to_vec()
    }
}

/// `L` of `C ~ L L^T`, n x r, by Cholesky's method with the largest remaining variance as the pivot.
fn factor(n: usize, covariance: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
    let mut rest: Vec<f64> = (0..n).map(|i| covariance(i, i)).collect();
    let (total, mut columns): (f64, Vec<DVector<f64>>) = (rest.iter().sum(), Vec::new());
    while columns.len() < n.min(MAX_COLUMNS) && rest.iter().sum::<f64>() > NEGLIGIBLE_SHARE * total {
        let pivot = (1..n).fold(0, |best, i| if rest[i] > rest[best] { i } else { best });
        let root = rest[pivot].sqrt();
        let mut column = DVector::from_fn(n, |i, _| covariance(i, pivot));
        columns.iter().for_each(|own| column.axpy(-own[pivot], own, 1.0));
        column /= root;
        rest.iter_mut().zip(column.iter()).for_each(|(rest, own)| *rest = (*rest - own * own).max(0.0));
        columns.push(column);
    }
    DMatrix::from_columns(&columns)
}

/// Eigenvalues nearer to each other than this fraction of them are equal, as those of a symmetric surface are.
const SAME_VALUE: f64 = 1e-6;

/// Eigenvalues of a matrix, the largest first, and its eigenvectors; those of equal eigenvalues are eigenvectors of
/// `marked` among them, so that rounding does not choose them.
fn settled(plain: DMatrix<f64>, marked: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let eigen = SymmetricEigen::new(plain);
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let values: Vec<f64> = order.iter().map(|&i| eigen.eigenvalues[i]).collect();
    let mut vectors = eigen.eigenvectors.select_columns(&order);
    let mut first = 0;
    for group in values.chunk_by(|a, b| a - b <= SAME_VALUE * a) {
        let own = vectors.columns(first, group.len()).into_owned();
        if group.len() > 1 {
            let inner = SymmetricEigen::new(own.tr_mul(&(marked * &own)));
            let mut order: Vec<usize> = (0..group.len()).collect();
            order.sort_by(|&a, &b| inner.eigenvalues[b].total_cmp(&inner.eigenvalues[a]));
            vectors.columns_mut(first, group.len()).copy_from(&(own * inner.eigenvectors.select_columns(&order)));
        }
        first += group.len();
    }
    (values, vectors)
}

/// Numbers at points by which symmetric modes differ: `exp(b (x - c) / d)` with the middle c and the size d of the
/// points, and a direction b along no axis of symmetry.
fn marks(points: &[[f64; 3]]) -> Vec<f64> {
    const DIRECTION: [f64; 3] = [2.0, 1.3, 0.7];
    let end = |i: usize, of: fn(f64, f64) -> f64| points.iter().map(|x| x[i]).reduce(of).unwrap_or_default();
    let (low, high) = ([0, 1, 2].map(|i| end(i, f64::min)), [0, 1, 2].map(|i| end(i, f64::max)));
    let size = [0, 1, 2].map(|i| high[i] - low[i]).into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let exponent = |x: &[f64; 3]| (0..3).map(|i| DIRECTION[i] * (x[i] - 0.5 * (low[i] + high[i])) / size).sum::<f64>();
    points.iter().map(|x| exponent(x).exp()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::distribution::Distribution;
    use super::*;

    /// Points in the middle of n equal parts of a line from 0 to 1.
    fn line(n: usize) -> (Vec<[f64; 3]>, Vec<f64>) {
        ((0..n).map(|i| [(i as f64 + 0.5) / n as f64, 0.0, 0.0]).collect(), vec![1.0 / n as f64; n])
    }

    /// The root of a function between two ends of opposite sign.
    fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if (f(middle) < 0.0) == (f(low) < 0.0) { low = middle } else { high = middle }
        }
        low
    }

    /// Ghanem and Spanos (1991), section 2.3.3: on [-a, a] with c = 1/l `lambda = 2 c / (w^2 + c^2)`, with w of
    /// `c = w tan(w a)` and of `w = -c tan(w a)` in turn.
    #[test]
    fn eigenvalues_of_the_exponential_kernel_on_a_line_are_exact() {
        let (points, areas) = line(300);
        let (a, c) = (0.5, 1.0 / 0.4);
        let field = RandomField::new(&points, &areas, Kernel::Exponential, 0.4, 6);
        for (i, share) in field.shares.iter().enumerate() {
            let (low, high) =
                (i as f64 * std::f64::consts::FRAC_PI_2 / a, (i + 1) as f64 * std::f64::consts::FRAC_PI_2 / a);
            let even = |w: f64| c * (w * a).cos() - w * (w * a).sin();
            let odd = |w: f64| w * (w * a).cos() + c * (w * a).sin();
            let w = if i % 2 == 0 { root(low, high, even) } else { root(low + 1e-9, high, odd) };
            let expected = 2.0 * c / (w * w + c * c);
            assert!((share - expected).abs() < 3e-4 * field.shares[0], "{i}: {share} and {expected}");
        }
    }

    #[test]
    fn samples_have_the_covariance_of_the_kernel() {
        let (points, areas) = line(12);
        for kernel in [Kernel::Gaussian, Kernel::Exponential] {
            let field = RandomField::new(&points, &areas, kernel, 0.3, 12);
            assert!((field.share() - 1.0).abs() < 1e-6, "{}", field.share());
            let normal = Distribution::Normal { mean: 0.0, deviation: 1.0, from: f64::NEG_INFINITY, to: f64::INFINITY };
            let n = 4096;
            let mut products = DMatrix::<f64>::zeros(12, 12);
            for i in 0..n {
                let coordinate = |d: usize| f64::from(sobol_burley::sample(i, d as u32, 7)) + 1e-8;
                let xi: Vec<f64> = (0..field.shares.len()).map(|d| normal.quantile(coordinate(d))).collect();
                let z = DVector::from_vec(field.at(&xi));
                products += &z * z.transpose() / f64::from(n);
            }
            for (i, j) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))) {
                let expected = kernel.correlation((points[i][0] - points[j][0]).abs(), 0.3);
                assert!((products[(i, j)] - expected).abs() < 0.03, "{i} {j}: {} and {expected}", products[(i, j)]);
            }
        }
    }

    /// Modes of a square come in pairs.
    #[test]
    fn modes_of_a_square_do_not_depend_on_the_order_of_its_points_or_on_rounding() {
        let points: Vec<[f64; 3]> = (0..36).map(|i| [f64::from(i / 6), f64::from(i % 6), 0.0]).collect();
        let field = |points: &[[f64; 3]], area: f64| {
            let areas: Vec<f64> = (0..36).map(|i| area * (1.0 + 1e-15 * f64::from(i % 5))).collect();
            RandomField::new(points, &areas, Kernel::Gaussian, 4.0, 6).modes
        };
        let turned: Vec<[f64; 3]> = points.iter().rev().copied().collect();
        let (one, other) = (field(&points, 1.0), field(&turned, 0.3));
        for (i, j) in (0..36).flat_map(|i| (0..6).map(move |j| (i, j))) {
            assert!((one[(i, j)] - other[(35 - i, j)]).abs() < 1e-9, "{i} {j}: {} {}", one[(i, j)], other[(35 - i, j)]);
        }
    }

    #[test]
    fn few_modes_have_most_of_a_smooth_field() {
        let (points, areas) = line(200);
        let field = RandomField::new(&points, &areas, Kernel::Gaussian, 0.5, 3);
        assert!(field.share() > 0.99 && field.at(&[0.0; 3]).iter().all(|z| *z == 0.0), "{}", field.share());
    }
}
