//! Modes of the projected problem whose stiffness depends on the eigenvalue, each at its own.
//!
//! They begin with those of the reference problem (`t = 0`), and are those of `P(lambda)` at `t = 1`:
//!
//! ```text
//! P_t(lambda) = lambda^2 M + lambda C + K_0 + i G + sum_m [(1 - t) i Im r_m(i omega_0) + t (r_m(lambda) - rho_m)] K_m
//! ```
//!
//! At each t an eigenvalue is first the zero of Rayleigh's functional `y^H P_t(lambda) y` of the vector before. Then
//! Newton's method: with `P_t(lambda) y ~ (P_t(mu) + (lambda - mu) P_t'(mu)) y = 0`
//!
//! ```text
//! P_t(mu)^-1 P_t'(mu) y = -1 / (lambda - mu) y
//! ```
//!
//! is solved in the span of the vectors of one step of inverse iteration, mu becomes lambda, and so on: quadratic
//! convergence, and also for modes with the same or nearly the same eigenvalue, which go together. One step from t = 0
//! to 1 serves mostly; where a vector jumps to another mode or two become one, more and smaller steps are taken.
//!
//! Source: Ruhe, *Algorithms for the nonlinear eigenvalue problem*, SIAM J. Numer. Anal. 10, 1973, sections 3 and 5.

#[cfg(test)]
mod tests;

use std::ops::Mul;

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::QuadraticProblem;
use super::mode::by_frequency;
use super::space::Ritz;
use crate::Result;
use crate::algebra::complex::{norm, orthonormal, product};
use crate::native::lapack;

/// Eigenvalues closer than this, relative to one of them, go together.
const CLUSTER_WIDTH: f64 = 1e-3;
/// So many of them at most.
const MAX_CLUSTER: usize = 8;
/// Iterations for an eigenvalue.
const MAX_ITERATIONS: usize = 40;
/// Relative change at which an eigenvalue is found, and the one that is accepted where rounding leaves no better.
const CHANGES: [f64; 2] = [1e-13, 1e-11];
/// Numbers of steps from the reference problem, tried one after the other.
const STEPS: [usize; 4] = [1, 3, 10, 30];
/// A vector with less than this of itself in the span it begins with has jumped to another mode.
const MIN_OVERLAP: f64 = 0.5;
/// Two modes are one where their eigenvalues differ by less, relatively, and their vectors are parallel to this.
const DUPLICATES: [f64; 2] = [1e-9, 1e-6];
/// Relative step away from an eigenvalue, at which the problem is not singular.
const LAMBDA_STEP: f64 = 1e-14;

/// A problem with the projections of all its matrices.
pub(super) struct Projection<'a> {
    pub problem: &'a QuadraticProblem<'a>,
    /// In the order of [`QuadraticProblem::all_matrices`].
    pub matrices: &'a [DMatrix<f64>],
}

/// The modes that those of the reference problem become, in their order; none where two become one or one is lost.
///
/// # Errors
/// LAPACK's.
pub(super) fn refine(projection: &Projection, start: &[Ritz]) -> Result<Option<Vec<Ritz>>> {
    let start: Vec<Pair> = start.iter().map(Pair::of).collect();
    for n_steps in STEPS {
        if let Some(pairs) = continued(projection, &start, n_steps)?
            && are_distinct(&pairs)
        {
            return Ok(Some(pairs.iter().map(Pair::ritz).collect()));
        }
    }
    Ok(None)
}

/// An eigenvalue with its projected vector, of length 1.
#[derive(Clone)]
struct Pair {
    lambda: Complex64,
    y: Vec<Complex64>,
}

impl Pair {
    fn of(ritz: &Ritz) -> Pair {
        let y = ritz.re.iter().zip(&ritz.im).map(|(&re, &im)| Complex64::new(re, im)).collect();
        Pair { lambda: ritz.lambda, y }
    }

    fn ritz(&self) -> Ritz {
        let (re, im) = self.y.iter().map(|z| (z.re, z.im)).unzip();
        Ritz { lambda: self.lambda, re, im }
    }
}

/// All modes in so many steps from t = 0 to 1.
fn continued(projection: &Projection, start: &[Pair], n_steps: usize) -> Result<Option<Vec<Pair>>> {
    let mut pairs = start.to_vec();
    for step in 1..=n_steps {
        let at = At { projection, t: step as f64 / n_steps as f64 };
        // Real eigenvalues have no frequency: what does not strain the materials keeps its own.
        let begun: Vec<Pair> = pairs.iter().map(|pair| at.by_rayleigh(pair)).collect();
        let mut next = Vec::with_capacity(pairs.len());
        for (i, pair) in begun.iter().enumerate() {
            if pair.lambda.im == 0.0 {
                next.push(pair.clone());
                continue;
            }
            let Some(found) = at.newton(&begun, i)? else { return Ok(None) };
            next.push(found);
        }
        pairs = next;
    }
    Ok(Some(pairs))
}

/// Whether no two modes are one.
fn are_distinct(pairs: &[Pair]) -> bool {
    let is_same = |a: &Pair, b: &Pair| {
        (a.lambda - b.lambda).norm() <= DUPLICATES[0] * a.lambda.norm()
            && product(&a.y, &b.y).norm_sqr() > 1.0 - DUPLICATES[1]
    };
    let differs = |(i, a): (usize, &Pair)| a.lambda.im == 0.0 || !pairs[..i].iter().any(|b| is_same(a, b));
    pairs.iter().enumerate().all(differs)
}

/// The problem at a t.
struct At<'a> {
    projection: &'a Projection<'a>,
    t: f64,
}

impl At<'_> {
    /// What each matrix is multiplied by in `P_t(lambda)`.
    fn coefficients(&self, lambda: Complex64) -> Vec<Complex64> {
        let Projection { problem, matrices } = self.projection;
        let mut all = problem.coefficients(lambda);
        let first = matrices.len() - problem.viscoelastic.stiffnesses.len();
        let of_reference = problem.viscoelastic.coefficients_at_reference();
        all[first..].iter_mut().zip(of_reference).for_each(|(own, reference)| {
            *own = (1.0 - self.t) * reference + self.t * *own;
        });
        all
    }

    /// The same of `P_t'(lambda)`.
    fn slopes(&self, lambda: Complex64) -> Vec<Complex64> {
        let Projection { problem, matrices } = self.projection;
        let mut all = problem.slopes(lambda);
        let first = matrices.len() - problem.viscoelastic.stiffnesses.len();
        all[first..].iter_mut().for_each(|slope| *slope *= self.t);
        all
    }

    /// The zero of Rayleigh's functional of a pair's vector next to its eigenvalue; the pair where Newton's method
    /// leaves the upper half plane.
    fn by_rayleigh(&self, pair: &Pair) -> Pair {
        let quadratic = |a: &DMatrix<f64>| product(&pair.y, &times(a, &pair.y));
        let forms: Vec<Complex64> = self.projection.matrices.iter().map(quadratic).collect();
        let sum = |factors: Vec<Complex64>| factors.iter().zip(&forms).map(|(a, b)| a * b).sum::<Complex64>();
        let mut lambda = pair.lambda;
        for _ in 0..MAX_ITERATIONS {
            let change = sum(self.coefficients(lambda)) / sum(self.slopes(lambda));
            lambda -= change;
            if !lambda.is_finite() || lambda.im <= 0.0 {
                return pair.clone();
            }
            if change.norm() <= CHANGES[0] * lambda.norm() {
                break;
            }
        }
        Pair { lambda, y: pair.y.clone() }
    }

    /// The mode that pair i becomes; none where the iteration does not converge or jumps to another mode.
    fn newton(&self, pairs: &[Pair], i: usize) -> Result<Option<Pair>> {
        let cluster = cluster(pairs, i);
        let lambdas: Vec<Complex64> = cluster.iter().map(|&j| pairs[j].lambda).collect();
        let order = by_frequency(&lambdas);
        let rank = order.iter().position(|&j| cluster[j] == i).expect("a pair is in its own cluster");
        let start = orthonormal(cluster.iter().map(|&j| &pairs[j].y), 0.0);
        if start.len() < cluster.len() {
            return Ok(None);
        }
        let (mut block, mut lambda, mut last) = (start.clone(), pairs[i].lambda, f64::INFINITY);
        for _ in 0..MAX_ITERATIONS {
            let Some((next, y)) = self.inverse_iteration(lambda, &mut block, rank)? else { return Ok(None) };
            let change = (next - lambda).norm() / next.norm();
            lambda = next;
            if change <= CHANGES[0] || (change <= CHANGES[1] && change >= last) {
                let overlap: f64 = start.iter().map(|q| product(q, &y).norm_sqr()).sum();
                return Ok((overlap > MIN_OVERLAP * MIN_OVERLAP).then_some(Pair { lambda, y }));
            }
            last = change;
        }
        Ok(None)
    }

    /// One step of block inverse iteration at mu: the eigenvalue of a rank and its vector in the span of the block,
    /// which becomes the next one. None where the numbers run out.
    fn inverse_iteration(
        &self,
        mu: Complex64,
        block: &mut Vec<Vec<Complex64>>,
        rank: usize,
    ) -> Result<Option<(Complex64, Vec<Complex64>)>> {
        let (n, q) = (block[0].len(), block.len());
        let derivative = self.sum(&self.slopes(mu));
        let right: Vec<Complex64> = block.iter().flat_map(|y| times(&derivative, y)).collect();
        let solve = |mu: Complex64| {
            let (mut matrix, mut x) = (self.sum(&self.coefficients(mu)), right.clone());
            let is_solved = lapack::solve_complex(n, matrix.as_mut_slice(), &mut x);
            (is_solved && x.iter().all(|z| z.is_finite())).then_some(x)
        };
        // Where mu is an eigenvalue to the last digit, a number beside it serves.
        let Some(image) = solve(mu).or_else(|| solve(mu * (1.0 + LAMBDA_STEP))) else { return Ok(None) };
        let column = |j: usize| &image[j * n..(j + 1) * n];
        let small = DMatrix::from_fn(q, q, |i, j| product(&block[i], column(j)));
        let lapack::Eigen { values, vectors } = lapack::eigen(small)?;
        let lambdas: Vec<Complex64> = values.iter().map(|nu| mu - 1.0 / nu).collect();
        if !lambdas.iter().all(|z| z.is_finite()) {
            return Ok(None);
        }
        let combined = |k: usize| -> Vec<Complex64> {
            (0..n).map(|row| (0..q).map(|j| column(j)[row] * vectors[(j, k)]).sum()).collect()
        };
        let own = by_frequency(&lambdas)[rank];
        let images: Vec<Vec<Complex64>> = (0..q).map(combined).collect();
        *block = orthonormal(images.iter(), 0.0);
        let length = norm(&images[own]);
        let y = images[own].iter().map(|z| z / length).collect();
        Ok((block.len() == q).then_some((lambdas[own], y)))
    }

    /// A sum of the matrices.
    fn sum(&self, coefficients: &[Complex64]) -> DMatrix<Complex64> {
        let n = self.projection.matrices[0].nrows();
        let mut sum = DMatrix::from_element(n, n, Complex64::ZERO);
        for (factor, a) in coefficients.iter().zip(self.projection.matrices).filter(|(f, _)| **f != Complex64::ZERO) {
            sum.as_mut_slice().iter_mut().zip(a.as_slice()).for_each(|(z, x)| *z += factor * x);
        }
        sum
    }
}

/// The pairs whose eigenvalues are next to that of pair i, it among them.
fn cluster(pairs: &[Pair], i: usize) -> Vec<usize> {
    let own = pairs[i].lambda;
    let distance = |j: usize| (pairs[j].lambda - own).norm();
    let is_near = |&j: &usize| pairs[j].lambda.im > 0.0 && distance(j) <= CLUSTER_WIDTH * own.norm();
    let mut near: Vec<usize> = (0..pairs.len()).filter(is_near).collect();
    near.sort_by(|&a, &b| (a != i, distance(a)).partial_cmp(&(b != i, distance(b))).expect("all are finite"));
    near.truncate(MAX_CLUSTER);
    near
}

/// `A y`
fn times<T: Copy>(a: &DMatrix<T>, y: &[Complex64]) -> Vec<Complex64>
where
    Complex64: Mul<T, Output = Complex64>,
{
    let mut image = vec![Complex64::ZERO; a.nrows()];
    for (column, &y) in a.as_slice().chunks_exact(a.nrows()).zip(y) {
        image.iter_mut().zip(column).for_each(|(z, &x)| *z += y * x);
    }
    image
}
