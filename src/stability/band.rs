//! All modes of a frequency band, none missed.

use std::f64::consts::TAU;

use super::mode::Residual;
use super::{Mode, Pencil};
use crate::petsc::eigen::{self, Options, Quadratic};
use crate::petsc::{Factor, FactorKind};
use crate::{Error, Result};

/// Factors whose analysis is made once and shared by all pencils of one pattern.
pub struct Solver {
    /// LU of the unsymmetric stiffness; the equilibrium uses the same.
    pub lu: Factor,
    /// Symmetric factor that counts.
    pub ldl: Factor,
    /// Real shift of the inverted problem, 1/s: 0, unless the structure has rigid motions.
    pub shift: f64,
}

impl Default for Solver {
    fn default() -> Self {
        Solver { lu: Factor::new(FactorKind::Unsymmetric), ldl: Factor::new(FactorKind::Symmetric), shift: 0.0 }
    }
}

/// How many modes the symmetric problem has below a frequency, and how many were found there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Count {
    /// The frequency, Hz: the band's end, or a gap between modes near it.
    pub below: f64,
    /// By the inertia of `K_symmetric - omega^2 M`.
    pub expected: usize,
    /// By the eigensolver.
    pub found: usize,
}

impl Count {
    /// Whether no mode is missing.
    pub fn agrees(&self) -> bool {
        self.expected == self.found
    }
}

/// The modes of a band.
pub struct Band {
    /// By frequency.
    pub modes: Vec<Mode>,
    /// The check of their number.
    pub count: Count,
    /// Solves with the factor.
    pub n_solves: usize,
}

/// Eigenvalue tolerance handed to SLEPc: near double roots an error e in the residual is sqrt(e) in the eigenvalue.
const TOLERANCE: f64 = 1e-12;
/// How often the search is widened before the band is given up.
const TRIES: u32 = 4;

/// Finds all modes of `band` (Hz) of a pencil, sorted by frequency, vectors scaled to a largest entry of 1. `progress` hears of
/// (converged, wanted, solves). Collective.
///
/// # Errors
/// PETSc's and MUMPS's; [`Error::NotConverged`] where the band could not be completed.
pub fn solve(
    pencil: &Pencil,
    solver: &mut Solver,
    band: [f64; 2],
    progress: &mut dyn FnMut(usize, usize, usize),
) -> Result<Band> {
    let expected = solver.n_below(pencil, band[1])?;
    solver.factorise_shifted(pencil)?;
    let (mut n_solves, mut last) = (0, None);
    for attempt in 0..TRIES {
        let margin = (4 + expected / 20) * 3_usize.pow(attempt);
        let Some(found) = nearest(pencil, solver, expected + margin, progress)? else { continue };
        n_solves += found.n_solves;
        if let Some(count) = count(pencil, solver, &found, band[1], expected)? {
            if count.agrees() {
                return finish(pencil, found, band, count, n_solves);
            }
            last = Some((found, count));
        }
    }
    match last {
        Some((found, count)) => finish(pencil, found, band, count, n_solves),
        None => Err(Error::NotConverged(format!(
            "the eigensolver did not reach the end of the band {}-{} Hz, with {expected} modes expected. Try a narrower band \
             ([stability] band)",
            band[0], band[1]
        ))),
    }
}

fn n_equations(pencil: &Pencil) -> usize {
    pencil.k.comm().sum(pencil.k.n_local() as f64) as usize
}

/// The eigenpairs nearest to the shift, the expected modes and some beyond the band's end; none where LAPACK could not
/// reorder the projected problem (xTREXC, info 1: blocks too close to swap, as the defective zeros of several rigid motions are).
/// Another search space does not meet the same blocks.
fn nearest(
    pencil: &Pencil,
    solver: &Solver,
    n_modes: usize,
    progress: &mut dyn FnMut(usize, usize, usize),
) -> Result<Option<eigen::Found>> {
    let problem = Quadratic { m: pencil.m, c: pencil.c, k: pencil.k, shift: solver.shift, factor: &solver.lu };
    let n_wanted = (2 * n_modes).min(2 * n_equations(pencil));
    let options = Options { n_wanted, n_basis: 0, tolerance: TOLERANCE, max_restarts: 200 };
    match eigen::solve(&problem, &options, &mut |converged, solves| progress(converged, n_wanted, solves)) {
        Err(Error::Library(text)) if text.contains("LAPACK subroutine trexc: info=1") => Ok(None),
        found => found.map(Some),
    }
}

/// How many modes were found below the band's end, and how many there should be; none where the search did not get there.
///
/// Friction may carry a mode across the band's end, where the two problems then differ by one: the count is taken again
/// in the widest gap between modes above it.
fn count(
    pencil: &Pencil,
    solver: &mut Solver,
    found: &eigen::Found,
    end: f64,
    expected: usize,
) -> Result<Option<Count>> {
    let mut moduli: Vec<f64> = found.pairs.iter().map(|pair| pair.lambda.norm() / TAU).collect();
    moduli.sort_by(f64::total_cmp);
    let all = found.n_converged >= 2 * n_equations(pencil);
    let reach = if all { f64::INFINITY } else { moduli.last().copied().unwrap_or(0.0) };
    if reach <= end {
        return Ok(None);
    }
    let below = |f: f64| found.pairs.iter().map(|pair| weight(pair, f)).sum::<f64>().round() as usize;
    let count = Count { below: end, expected, found: below(end) };
    match widest_gap(&moduli, end).filter(|_| !count.agrees()) {
        Some(gap) => Ok(Some(Count { below: gap, expected: solver.n_below(pencil, gap)?, found: below(gap) })),
        None => Ok(Some(count)),
    }
}

/// A pair of the upper half plane stands for one mode, a real eigenvalue for half of one.
fn weight(pair: &eigen::Pair, below: f64) -> f64 {
    match pair.lambda.norm() <= TAU * below {
        true if pair.lambda.im > 0.0 => 1.0,
        true => 0.5,
        false => 0.0,
    }
}

/// The middle of the widest gap between neighbours of which the upper is above `from`.
fn widest_gap(sorted: &[f64], from: f64) -> Option<f64> {
    let gaps = sorted.windows(2).filter(|w| w[1] > from);
    gaps.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0]))).map(|w| 0.5 * (w[0] + w[1]))
}

fn finish(pencil: &Pencil, found: eigen::Found, band: [f64; 2], count: Count, n_solves: usize) -> Result<Band> {
    let mut residual = Residual::new(pencil)?;
    let mut modes = Vec::new();
    for eigen::Pair { lambda, re, im } in found.pairs {
        let frequency = lambda.im / TAU;
        if frequency >= band[0] && frequency <= band[1] {
            let backward_error = residual.backward_error(lambda, &re, &im)?;
            let mut mode = Mode { lambda, backward_error, re, im };
            mode.normalise()?;
            modes.push(mode);
        }
    }
    sort(&mut modes);
    Ok(Band { modes, count, n_solves })
}

/// Sorts by frequency; modes of one frequency, such as the growing and the decaying one of a pair, by growth. What counts as one
/// frequency stands above rounding, so that modes have the same numbers on any number of ranks.
fn sort(modes: &mut [Mode]) {
    const SAME: f64 = 1e-9;
    modes.sort_by(|a, b| a.lambda.im.total_cmp(&b.lambda.im));
    for same in modes.chunk_by_mut(|a, b| b.lambda.im - a.lambda.im <= SAME * b.lambda.im) {
        same.sort_by(|a, b| a.lambda.re.total_cmp(&b.lambda.re));
    }
}

impl Solver {
    /// Number of modes of the symmetric problem below a frequency (Hz): negative pivots of `K_symmetric - omega^2 M`.
    fn n_below(&mut self, pencil: &Pencil, frequency: f64) -> Result<usize> {
        let omega = TAU * frequency;
        let mut shifted = pencil.k_symmetric.duplicate()?;
        shifted.axpy(-omega * omega, pencil.m)?;
        shifted.declare_symmetric()?;
        self.ldl.factorise(&shifted)?;
        self.ldl.n_negative()
    }

    /// LU of `sigma^2 M + sigma C + K`.
    fn factorise_shifted(&mut self, pencil: &Pencil) -> Result<()> {
        if self.shift == 0.0 {
            return self.lu.factorise(pencil.k);
        }
        let mut shifted = pencil.k.duplicate()?;
        shifted.axpy(self.shift * self.shift, pencil.m)?;
        shifted.axpy(self.shift, pencil.c)?;
        self.lu.factorise(&shifted)
    }
}
