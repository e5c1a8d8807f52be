//! A solution of the quadratic eigenproblem, and how well it solves it.

use num_complex::Complex64;

use super::QuadraticProblem;
use crate::Result;
use crate::model::InstabilityCriterion;
use crate::native::{Block, Vector};

/// A real eigenvalue up to this (1/s) is no divergence: a rigid motion's double zero may come out as a real pair of
/// some 1e-2/s.
pub const RIGID_RATE: f64 = 1.0;

/// An eigenvalue with non-negative frequency, its vector, and how well the two solve the problem.
pub struct Mode {
    /// `a + i omega`, 1/s.
    pub lambda: Complex64,
    /// `|P(lambda) x| / ((|lambda|^2 |M| + |lambda| |C| + |K| + |G|) |x|)`, maximum norms.
    pub backward_error: f64,
    /// Real part of the vector.
    pub re: Vector,
    /// Imaginary part of the vector.
    pub im: Vector,
}

impl Mode {
    /// Frequency `omega / 2 pi`, Hz.
    pub fn frequency(&self) -> f64 {
        self.lambda.im / std::f64::consts::TAU
    }

    /// Growth rate `a`, 1/s.
    pub fn growth_rate(&self) -> f64 {
        self.lambda.re
    }

    /// Damping ratio `-a / |lambda|`.
    pub fn damping_ratio(&self) -> f64 {
        -self.lambda.re / self.lambda.norm()
    }

    /// Whether the mode is unstable by a criterion.
    pub fn is_unstable(&self, criterion: InstabilityCriterion) -> bool {
        self.lambda.re > criterion.limit(self.lambda, RIGID_RATE)
    }

    /// Whether the mode grows beyond rounding.
    pub fn grows(&self) -> bool {
        self.is_unstable(InstabilityCriterion::default())
    }

    /// Turns and scales the vector so that its largest entry (in modulus) is 1, real.
    pub(super) fn normalise(&mut self) -> Result<()> {
        let (value, _) = largest(&self.re, &self.im)?;
        let factor = 1.0 / value;
        let re = self.re.duplicate()?;
        combine(&mut self.re, factor.re, -factor.im, &self.im)?;
        combine(&mut self.im, factor.re, factor.im, &re)
    }
}

/// `x = a x + b y`.
fn combine(x: &mut Vector, a: f64, b: f64, y: &Vector) -> Result<()> {
    x.scale(a)?;
    x.axpy(b, y)
}

/// The entry of largest modulus of `re + i im` and that modulus, over all ranks; the first of equals in rank order.
fn largest(re: &Vector, im: &Vector) -> Result<(Complex64, f64)> {
    let entry = |re: &[f64], im: &[f64]| {
        let values = re.iter().zip(im).map(|(&a, &b)| Complex64::new(a, b));
        values.fold(Complex64::default(), |best, z| if z.norm_sqr() > best.norm_sqr() { z } else { best })
    };
    let own = re.local(|re| im.local(|im| entry(re, im)))??;
    let comm = re.comm();
    let largest = comm.max_loc(own.norm());
    Ok((comm.broadcast_value(largest.rank(), own), largest.value))
}

/// Columns of a block of products.
const BLOCK: usize = 32;

/// Backward errors `|P(lambda) x| / ((|lambda|^2 |M| + |lambda| |C| + |K| + |G|) |x|)` of eigenpairs, maximum norms
/// and moduli of complex entries, of the problem at the eigenvalue itself: viscoelastic stiffnesses add `|r_m(lambda) -
/// rho_m| |K_m|` to the sum. Columns 2i and 2i + 1 of `x` are the real and the imaginary part of vector i.
/// Collective.
///
/// # Errors
/// PETSc's.
pub(super) fn backward_errors(problem: &QuadraticProblem, lambdas: &[Complex64], x: &Block) -> Result<Vec<f64>> {
    let matrices = problem.all_matrices();
    let norms: Vec<f64> = matrices.iter().map(|matrix| matrix.norm_inf()).collect::<Result<_>>()?;
    let mut errors = Vec::new();
    for (part, lambdas) in lambdas.chunks(BLOCK / 2).enumerate() {
        let x = x.columns(BLOCK * part..BLOCK * part + 2 * lambdas.len());
        let n = x.n_columns();
        let mut images = Block::zeros(x.comm(), x.n_local(), matrices.len() * n);
        images.add_products(&matrices, &x, 0..n)?;
        for (i, lambda) in lambdas.iter().enumerate() {
            let coefficients = problem.coefficients(*lambda);
            let residual = |row: usize| -> Complex64 {
                let image = |b: usize| entry(&images, b * lambdas.len() + i, row);
                coefficients.iter().enumerate().map(|(b, factor)| factor * image(b)).sum()
            };
            let largest = |value: &dyn Fn(usize) -> Complex64| {
                (0..x.n_local()).map(|row| value(row).norm_sqr()).fold(0.0, f64::max).sqrt()
            };
            let scale: f64 = coefficients.iter().zip(&norms).map(|(factor, norm)| factor.norm() * norm).sum();
            let comm = x.comm();
            errors.push(comm.max(largest(&residual)) / (scale * comm.max(largest(&|row| entry(&x, i, row)))));
        }
    }
    Ok(errors)
}

/// Entry of the complex vector i kept as two columns.
fn entry(x: &Block, i: usize, row: usize) -> Complex64 {
    Complex64::new(x.column(2 * i)[row], x.column(2 * i + 1)[row])
}

/// Imaginary parts closer than this, relative, are one frequency.
const FREQUENCY_ROUNDING: f64 = 1e-9;

/// Places of eigenvalues by frequency; those of one frequency, such as a growing and a decaying mode of a pair, by
/// growth. What counts as one frequency stands above rounding, so that modes have the same numbers on any number of
/// ranks.
pub(super) fn by_frequency(lambdas: &[Complex64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..lambdas.len()).collect();
    order.sort_by(|&a, &b| lambdas[a].im.total_cmp(&lambdas[b].im));
    let is_one = |&a: &usize, &b: &usize| lambdas[b].im - lambdas[a].im <= FREQUENCY_ROUNDING * lambdas[b].im.abs();
    for same in order.chunk_by_mut(is_one) {
        same.sort_by(|&a, &b| lambdas[a].re.total_cmp(&lambdas[b].re));
    }
    order
}
