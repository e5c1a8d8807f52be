//! The linearised problem and one solution of it.

use num_complex::Complex64;

use crate::Result;
use crate::petsc::{Matrix, Vector};

/// A mode is called unstable where its growth rate exceeds this fraction of its angular frequency: below is noise.
pub const UNSTABLE_RATIO: f64 = 1e-6;

/// A real eigenvalue above this, 1/s, is an instability.
const DIVERGENCE: f64 = 1.0;

/// The matrices of `lambda^2 M + lambda C + K`, K with the contact tangent.
pub struct Pencil<'a> {
    /// Mass.
    pub m: &'a Matrix,
    /// Damping.
    pub c: &'a Matrix,
    /// Stiffness with the tangent of contact and friction.
    pub k: &'a Matrix,
    /// Stiffness with the tangent of contact without friction's coupling: symmetric, for counting.
    pub k_symmetric: &'a Matrix,
}

/// An eigenvalue with non-negative frequency, its vector, and how well the two solve the problem.
pub struct Mode {
    /// `a + i omega`, 1/s.
    pub lambda: Complex64,
    /// `|P(lambda) x| / ((|lambda|^2 |M| + |lambda| |C| + |K|) |x|)`, maximum norms.
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

    /// Whether the mode grows, beyond noise. A rigid motion's double zero may come out as a real pair of some 1e-2/s:
    /// divergence, a real eigenvalue, counts from 1/s on.
    pub fn is_unstable(&self) -> bool {
        let noise = if self.lambda.im == 0.0 { DIVERGENCE } else { UNSTABLE_RATIO * self.lambda.im };
        self.lambda.re > noise
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
    let modulus = comm.max(own.norm());
    let rank = if own.norm() == modulus { -(comm.rank() as f64) } else { f64::NEG_INFINITY };
    let mine = comm.max(rank) == rank;
    let mut value = if mine { [own.re, own.im] } else { [0.0; 2] };
    comm.sum_all(&mut value);
    Ok((Complex64::new(value[0], value[1]), modulus))
}

/// Backward errors of eigenpairs of one pencil.
pub(super) struct Residual<'a> {
    pencil: &'a Pencil<'a>,
    norms: [f64; 3],
    work: [Vector; 2],
}

impl<'a> Residual<'a> {
    pub(super) fn new(pencil: &'a Pencil) -> Result<Residual<'a>> {
        let zeros = || Vector::zeros(pencil.k.comm(), pencil.k.n_local());
        let norms = [pencil.m.norm_inf()?, pencil.c.norm_inf()?, pencil.k.norm_inf()?];
        Ok(Residual { pencil, norms, work: [zeros()?, zeros()?] })
    }

    /// `|P(lambda) x| / ((|lambda|^2 |M| + |lambda| |C| + |K|) |x|)`, maximum norms, moduli of complex entries.
    pub(super) fn backward_error(&mut self, lambda: Complex64, re: &Vector, im: &Vector) -> Result<f64> {
        let (mut r, mut s) = (re.duplicate()?, im.duplicate()?);
        r.scale(0.0)?;
        s.scale(0.0)?;
        let [mx, my] = &mut self.work;
        let terms =
            [(lambda * lambda, self.pencil.m), (lambda, self.pencil.c), (Complex64::new(1.0, 0.0), self.pencil.k)];
        // (p + i q)(A x + i A y) = (p A x - q A y) + i (q A x + p A y)
        for (factor, matrix) in terms {
            matrix.multiply(re, mx)?;
            matrix.multiply(im, my)?;
            r.axpy(factor.re, mx)?;
            r.axpy(-factor.im, my)?;
            s.axpy(factor.im, mx)?;
            s.axpy(factor.re, my)?;
        }
        let [m, c, k] = self.norms;
        let modulus = lambda.norm();
        let scale = (modulus * modulus * m + modulus * c + k) * largest(re, im)?.1;
        Ok(largest(&r, &s)?.1 / scale)
    }
}
