//! The straight line between two small matrices, and how eigenvalues move along it.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::matching::{State, matched};
use crate::native::lapack::{Eigen, eigen};

/// Eigenvalues along `A(s)`, s from 0 to 1, in the order of the modes at s = 0.
pub struct Path {
    /// (s, eigenvalues), s rising.
    pub samples: Vec<(f64, Vec<Complex64>)>,
    /// The largest share `|V_ki (V^-1)_ik|` of a mode of s = 0 in another at each sample: 1 or less, but near a
    /// coalescence.
    pub sharing: Vec<f64>,
    /// Eigenvalues at s = 1.
    pub end: Vec<Complex64>,
    /// Place of each mode among those of s = 1, `b`.
    pub places: Vec<usize>,
    /// Vectors at s = 1 in the basis of the modes of `b`: a column is one mode, but for turned doublets.
    pub vectors: DMatrix<Complex64>,
}

/// Steps are no longer than this.
const LONGEST: f64 = 0.125;
/// A coalescence is passed in a step of this length.
const SHORTEST: f64 = 1e-6;

/// Follows the modes of `A(s) = (1 - s) diag(a) + s T diag(b) T^-1` from `start`, which are those of s = 0 in the order
/// and the basis wanted; none where T is singular or LAPACK-like iterations fail.
///
/// Steps are halved until every mode is recognised. Two modes that exchange their frequencies are looked at in steps of
/// `resolution`: a veering narrower than that is a crossing.
pub fn follow(
    start: State,
    a: &[Complex64],
    b: &[Complex64],
    transfer: &DMatrix<Complex64>,
    resolution: f64,
) -> Option<Path> {
    if a.is_empty() {
        let samples = vec![(0.0, Vec::new()), (1.0, Vec::new())];
        return Some(Path {
            samples,
            sharing: vec![1.0; 2],
            end: Vec::new(),
            places: Vec::new(),
            vectors: start.vectors,
        });
    }
    let at_end = moved(transfer, b)?;
    let at = |s: f64| {
        let mut matrix = &at_end * Complex64::from(s);
        a.iter().enumerate().for_each(|(i, &lambda)| matrix[(i, i)] += lambda * (1.0 - s));
        eigen(matrix).ok()
    };
    let (mut samples, mut sharing) = (vec![(0.0, start.values.clone())], vec![1.0]);
    let (mut s, mut state, mut step) = (0.0, start, LONGEST);
    while s < 1.0 {
        let (reached, next) = advance(s, &state, step, resolution, &at)?;
        step = (2.0 * (reached - s)).min(LONGEST);
        (s, state) = (reached, next);
        samples.push((s, state.values.clone()));
        sharing.push(largest_share(&state.vectors));
    }
    let vectors = transfer.clone().lu().solve(&state.vectors)?;
    Some(Path { samples, sharing, end: state.values, places: places(&vectors), vectors })
}

/// `max |V_ki (V^-1)_ik|`
fn largest_share(vectors: &DMatrix<Complex64>) -> f64 {
    let inverse = vectors.clone().try_inverse();
    inverse.map_or(f64::INFINITY, |inverse| vectors.component_mul(&inverse.transpose()).camax())
}

/// The mode that each column mostly is, every mode once: by the shares `|C_ji (C^-1)_ij|`, largest first.
fn places(vectors: &DMatrix<Complex64>) -> Vec<usize> {
    let n = vectors.ncols();
    let inverse = vectors.clone().try_inverse().unwrap_or_else(|| vectors.adjoint());
    let share = |j: usize, i: usize| (vectors[(j, i)] * inverse[(i, j)]).norm();
    let mut pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).collect();
    pairs.sort_by(|&(i, j), &(k, l)| share(l, k).total_cmp(&share(j, i)));
    let (mut places, mut taken) = (vec![None; n], vec![false; n]);
    for (i, j) in pairs {
        if places[i].is_none() && !taken[j] {
            (places[i], taken[j]) = (Some(j), true);
        }
    }
    places.into_iter().flatten().collect()
}

/// `T diag(b) T^-1`.
fn moved(transfer: &DMatrix<Complex64>, b: &[Complex64]) -> Option<DMatrix<Complex64>> {
    let scaled = DMatrix::from_fn(b.len(), b.len(), |i, j| transfer[(i, j)] * b[j]);
    // X T = T diag(b), as T^T X^T = (T diag(b))^T
    let transposed = transfer.transpose().lu().solve(&scaled.transpose())?;
    transposed.iter().all(|z| z.is_finite()).then(|| transposed.transpose())
}

/// One step, as long as the modes can be recognised.
fn advance(
    s: f64,
    state: &State,
    longest: f64,
    resolution: f64,
    at: &impl Fn(f64) -> Option<Eigen>,
) -> Option<(f64, State)> {
    let mut step = longest;
    let mut may_leap = true;
    loop {
        let goal = if s + step > 1.0 - SHORTEST { 1.0 } else { s + step };
        let found = matched(state, at(goal)?);
        let narrow = goal - s <= resolution;
        if (found.clear && (!found.swapped || narrow)) || goal - s <= 2.0 * SHORTEST {
            return Some((goal, found.state));
        }
        if narrow && may_leap {
            may_leap = false;
            if let Some(landed) = leap(s, state, resolution, at)? {
                return Some(landed);
            }
        }
        step = 0.5 * (goal - s);
    }
}

/// A step across a veering that is narrower than the resolution.
fn leap(s: f64, state: &State, resolution: f64, at: &impl Fn(f64) -> Option<Eigen>) -> Option<Option<(f64, State)>> {
    let goal = (s + 2.0 * resolution).min(1.0);
    let found = matched(state, at(goal)?);
    Some(found.clear.then_some((goal, found.state)))
}

impl Path {
    /// Where a function of an eigenvalue is zero along one mode for the first time, by straight lines between samples.
    pub fn first_root(&self, mode: usize, function: impl Fn(Complex64) -> f64) -> Option<f64> {
        let points: Vec<(f64, f64)> = self.samples.iter().map(|(s, values)| (*s, function(values[mode]))).collect();
        let crossing = points.windows(2).find(|w| (w[0].1 > 0.0) != (w[1].1 > 0.0))?;
        let [(s, f), (t, g)] = [crossing[0], crossing[1]];
        Some(s + (t - s) * f / (f - g))
    }

    /// Where inside two modes come closest to one vector, and how close: by how much the sharing exceeds that of the
    /// ends.
    pub fn nearest_coalescence(&self) -> (f64, f64) {
        let end = self.sharing.last().copied().unwrap_or(1.0).max(1.0);
        let inside = self.samples.iter().zip(&self.sharing).map(|((s, _), share)| (*s, share / end));
        inside.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a path has its start")
    }

    /// Where a function of an eigenvalue is largest along one mode, and its value there.
    pub fn maximum(&self, mode: usize, function: impl Fn(Complex64) -> f64) -> (f64, f64) {
        let points = self.samples.iter().map(|(s, values)| (*s, function(values[mode])));
        points.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a path has its start")
    }

    /// Eigenvalue of a mode at s, by straight lines between samples.
    pub fn value(&self, mode: usize, s: f64) -> Complex64 {
        let after = self.samples.partition_point(|(at, _)| *at < s).clamp(1, self.samples.len() - 1);
        let [(s0, a), (s1, b)] = [&self.samples[after - 1], &self.samples[after]];
        let t = (s - s0) / (s1 - s0);
        a[mode] * (1.0 - t) + b[mode] * t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn i(omega: f64) -> Complex64 {
        Complex64::new(0.0, omega)
    }

    fn along(a: [f64; 2], b: [f64; 2], transfer: [f64; 4]) -> Path {
        let (a, b) = (a.map(i), b.map(i));
        let start = State { values: a.to_vec(), vectors: DMatrix::identity(2, 2) };
        let transfer = DMatrix::from_row_slice(2, 2, &transfer).map(Complex64::from);
        follow(start, &a, &b, &transfer, 1e-2).unwrap()
    }

    #[test]
    fn without_coupling_modes_cross() {
        let path = along([1.0, 2.0], [2.0, 1.0], [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(path.end, [i(2.0), i(1.0)]);
    }

    /// A rotation by x couples the two with sin(2x)/2 of their distance at s = 1, half of that where they meet: that is
    /// half the gap.
    #[test]
    fn with_coupling_they_veer() {
        let (sin, cos) = 0.1_f64.sin_cos();
        let path = along([1.0, 2.0], [2.0, 1.0], [cos, -sin, sin, cos]);
        assert!((path.end[0] - i(1.0)).norm() < 1e-12 && (path.end[1] - i(2.0)).norm() < 1e-12);
        let gap = path.samples.iter().map(|(_, z)| (z[1] - z[0]).norm()).fold(f64::INFINITY, f64::min);
        assert!((gap - 0.5 * 0.2_f64.sin()).abs() < 0.01, "{gap}");
    }

    /// Coupling of opposite signs: between the two crossings of `(w_2 - w_1)^2 + 4 c_12 c_21` they flutter.
    #[test]
    fn a_coupling_that_both_ends_ignore_is_seen() {
        // A(1) = [2 -c; c 1] i, with T its vectors: angle where tanh(2x) = 2c
        let x = 0.5 * 0.2_f64.atanh();
        let path = along([1.0, 2.0], [2.0, 1.0], [x.cosh(), x.sinh(), x.sinh(), x.cosh()]);
        let (s, growth) = path.maximum(1, |z| z.re);
        assert!((s - 0.5).abs() < 0.07 && growth > 0.04, "{s} {growth}");
        assert!(path.end.iter().all(|z| z.re.abs() < 1e-12));
    }
}
