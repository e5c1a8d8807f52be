//! The family of pencils along friction, as tracking sees it.

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::Sweep;
use crate::Result;
use crate::petsc::{Block, Matrix, Vector};
use crate::stability::{Band, growth_threshold};
use crate::tracking::{Family, Options};

/// The modes at one friction with right and left vectors, and what their products need.
pub struct Snapshot {
    /// Modes as the eigensolver gave them, then the conjugates of low ones.
    lambdas: Vec<Complex64>,
    /// For each of them its place among the eigensolver's, and whether it is the conjugate.
    places: Vec<(usize, bool)>,
    /// Real and imaginary parts, two columns a mode, `x^H M x = y^H M y = 1`.
    right: Block,
    left: Block,
    /// The damping, where it is not the system's.
    c: Option<Matrix>,
}

/// Pencils along the friction of the swept pairs. `solve` finds equilibrium and modes.
pub struct Friction<'f> {
    /// Equilibrium, modes and their snapshot at a friction.
    pub solve: &'f mut dyn FnMut(f64) -> Result<Snapshot>,
    /// Mass.
    pub m: &'f Matrix,
    /// Damping of the system.
    pub c: &'f Matrix,
}

/// Modes are solved for up to this fraction beyond the band's end, and conjugates kept down to as far below zero: there modes come and
/// go unnoticed.
const BEYOND: f64 = 0.05;
/// Accuracy of left vectors that explain a mode: sensitivities are as exact.
const EXPLAINS: f64 = 1e-7;
/// Accuracy of left vectors that only recognise a mode at the next friction.
const RECOGNISES: f64 = 1e-4;
/// Hopf points are bracketed to this, in friction.
const TOLERANCE: f64 = 1e-3;

/// The band (Hz) to be solved for where modes of `band` are to be followed.
pub fn wider(band: [f64; 2]) -> [f64; 2] {
    let reach = BEYOND * band[1];
    [if band[0] > reach { band[0] - reach } else { 0.0 }, band[1] + reach]
}

/// How modes of a band (Hz) are followed over friction.
pub fn tracking_options(band: [f64; 2]) -> Options {
    Options { band: band.map(|f| TAU * f), tolerance: TOLERANCE, threshold: growth_threshold }
}

impl Snapshot {
    /// Left vectors of the modes that a sweep has just found, those of unstable modes to seven digits, and right vectors in the same form.
    /// Collective.
    ///
    /// # Errors
    /// See [`crate::stability::left_vectors`].
    pub fn new(sweep: &mut Sweep, band: &Band, end: f64) -> Result<Snapshot> {
        Snapshot::with(sweep, band, end, RECOGNISES)
    }

    /// As [`Snapshot::new`], where only unstable modes need left vectors: those of the others are not computed. Collective.
    ///
    /// # Errors
    /// See [`crate::stability::left_vectors`].
    pub fn of_unstable(sweep: &mut Sweep, band: &Band, end: f64) -> Result<Snapshot> {
        Snapshot::with(sweep, band, end, f64::INFINITY)
    }

    /// With the accuracy of stable modes' left vectors.
    fn with(sweep: &mut Sweep, band: &Band, end: f64, of_stable: f64) -> Result<Snapshot> {
        let (left, _) =
            sweep.left_vectors(&band.modes, |mode| if mode.is_unstable() { EXPLAINS } else { of_stable })?;
        let right = sweep.right_vectors(&band.modes)?;
        let n = band.modes.len();
        let low = |i: &usize| band.modes[*i].lambda.im > 0.0 && band.modes[*i].lambda.im < BEYOND * TAU * end;
        let places: Vec<(usize, bool)> =
            (0..n).map(|i| (i, false)).chain((0..n).filter(low).map(|i| (i, true))).collect();
        let lambda = |&(i, conjugate): &(usize, bool)| {
            let lambda = band.modes[i].lambda;
            if conjugate { lambda.conj() } else { lambda }
        };
        Ok(Snapshot { lambdas: places.iter().map(lambda).collect(), places, right, left, c: sweep.own_damping()? })
    }

    /// Real and imaginary part of the left vector of the i-th mode that the eigensolver gave.
    ///
    /// # Errors
    /// PETSc's.
    pub fn left(&self, i: usize) -> Result<[Vector; 2]> {
        Ok([self.left.vector(2 * i)?, self.left.vector(2 * i + 1)?])
    }
}

impl Family for Friction<'_> {
    type Modes = Snapshot;

    fn solve(&mut self, value: f64) -> Result<Snapshot> {
        (self.solve)(value)
    }

    fn eigenvalues<'m>(&self, modes: &'m Snapshot) -> &'m [Complex64] {
        &modes.lambdas
    }

    fn products(&mut self, left: &Snapshot, right: &Snapshot) -> Result<DMatrix<Complex64>> {
        let c = left.c.as_ref().unwrap_or(self.c);
        let [m, c] = [self.m, c].map(|matrix| {
            let product = left.left.gram(&right.right.multiplied_by(matrix)?);
            Ok(DMatrix::from_vec(left.left.n_columns(), right.right.n_columns(), product))
        });
        let (m, c): (DMatrix<f64>, DMatrix<f64>) = (m?, c?);
        Ok(DMatrix::from_fn(left.lambdas.len(), right.lambdas.len(), |i, j| {
            let [with_m, with_c] = [&m, &c].map(|a| hermitian(a, left.places[i], right.places[j]));
            (left.lambdas[i] + right.lambdas[j]) * with_m + with_c
        }))
    }
}

/// `y^H A x` from the products of real and imaginary parts; conjugates have the other sign of the latter.
fn hermitian(a: &DMatrix<f64>, (i, left): (usize, bool), (j, right): (usize, bool)) -> Complex64 {
    let [s, t] = [left, right].map(|conjugate| if conjugate { -1.0 } else { 1.0 });
    let [rr, ri, ir, ii] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(row, column)| a[(2 * i + row, 2 * j + column)]);
    // (y_r - i s y_i)^T A (x_r + i t x_i)
    Complex64::new(rr + s * t * ii, t * ri - s * ir)
}
