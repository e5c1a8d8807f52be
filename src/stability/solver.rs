//! How the eigenpairs of a pencil are searched for: by TOAR, in modal coordinates, or in blocks of right-hand sides.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::band::Count;
use super::condition::condition;
use super::inertia::Inertia;
use super::left;
use super::modal::Modal;
use super::mode::backward_errors;
use super::search;
use super::space::{Basis, Problem, Start};
use super::{Mode, Pencil};
use crate::assembly::System;
use crate::native::petsc::eigen::{self, Found, Options, Pair, Quadratic};
use crate::native::{Block, Factor, Matrix, Precision, machine};
use crate::{ErrorKind, Result};

/// Equations from which the blocked search pays: below, a single solve costs too little.
const BLOCKED_FROM: usize = 50_000;
/// Modes that a search of the second kind begins with, where nothing tells their number.
const GUESS: usize = 10;
/// Eigenvalue tolerance handed to SLEPc: near double roots an error e in the residual is sqrt(e) in the eigenvalue.
const TOLERANCE: f64 = 1e-12;
/// The same in modal coordinates, with the band's end for the unit of frequency: it leaves backward errors of 2e-14 and eigenvalues to 2e-12
/// (782 coordinates).
const MODAL_TOLERANCE: f64 = 1e-11;
/// Basis of TOAR over the eigenvalues wanted in modal coordinates, first: next to products its own upkeep counts there, and half of
/// SLEPc's basis takes half the time (782 coordinates). It restarts more often, which costs digits.
const SMALL_BASIS: f64 = 1.3;
/// So few left vectors of a densely stored pencil are sought one by one, more by a search of their own.
const FEW_LEFT: usize = 6;

/// How modes are searched for, and what serves all pencils of one pattern.
#[derive(Default)]
pub struct Solver {
    /// What counts the modes.
    pub inertia: Inertia,
    /// Real shift of the inverted problem, 1/s: 0, unless the structure has rigid motions.
    pub(super) shift: f64,
    /// For the blocked search, where it pays: a number for each of this rank's equations that does not depend on the ranks.
    pub(super) labels: Option<Vec<u64>>,
    /// The space of the last blocked search, which holds the vectors of its modes.
    basis: Option<Basis>,
    /// What the next search in blocks starts from.
    start: Option<Start>,
    pub(super) evidence: Evidence,
    /// Coordinates in which densely stored pencils are solved.
    modal: Option<Modal>,
    /// Where the last count was taken in a gap beyond the band's end, Hz: the next one begins there.
    pub(super) gap: Option<f64>,
}

/// What shows that no mode is missing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Evidence {
    /// The inertia of the symmetric problem: what brakes have.
    #[default]
    Inertia,
    /// For matrices of any structure, where inertia proves nothing. A search finds all eigenvalues that there are; or as many modes as the search
    /// before, which was for fewer; or, where M is symmetric and so inertia tells about how many there are (`estimated`), just as many.
    Repetition {
        /// Whether inertia gives an estimate.
        estimated: bool,
    },
}

impl Evidence {
    /// Up to so many equations [`Evidence::Repetition`] asks for all eigenvalues.
    pub const ALL_UP_TO: usize = 100;
}

/// Eigenpairs of the closed upper half plane, complete up to a frequency.
pub(super) struct Search {
    pub pairs: Vec<Pair>,
    /// Hz.
    pub reach: f64,
    pub n_solves: usize,
    /// Of the pairs.
    pub backward_errors: Vec<f64>,
}

impl Search {
    /// How many modes lie below a frequency, Hz.
    pub fn n_below(&self, frequency: f64) -> usize {
        self.pairs.iter().map(|pair| weight(pair, frequency)).sum::<f64>().round() as usize
    }
}

impl Solver {
    /// The solver for a system: blocked for a large one, else [`Solver::default`], which is TOAR.
    pub fn for_system(system: &System) -> Solver {
        match system.dofs.n_global() {
            n if n >= BLOCKED_FROM => Solver::blocked(system),
            _ => Solver::default(),
        }
    }

    /// Searches about a real shift, 1/s, with TOAR: for structures with rigid motions.
    pub fn shifted(shift: f64) -> Solver {
        Solver { shift, ..Solver::default() }
    }

    /// The solver for given matrices; `labels` has a number for each of this rank's equations that does not depend on the ranks. Blocked
    /// for a large problem with symmetric M and C.
    pub fn given(n_equations: usize, labels: Vec<u64>, symmetric_mc: bool, evidence: Evidence) -> Solver {
        let labels = Some(labels).filter(|_| symmetric_mc && n_equations >= BLOCKED_FROM);
        Solver { labels, evidence, ..Solver::default() }
    }

    /// Searches with a growing subspace and many right-hand sides at a time.
    pub fn blocked(system: &System) -> Solver {
        Solver { labels: Some(system.dofs.labels()), ..Solver::default() }
    }

    /// About how many modes lie below a frequency (Hz); with [`Evidence::Inertia`] exactly.
    pub(super) fn estimate(&mut self, pencil: &Pencil, frequency: f64) -> Result<usize> {
        match self.evidence {
            Evidence::Repetition { .. } if n_equations(pencil) <= Evidence::ALL_UP_TO => Ok(n_equations(pencil)),
            Evidence::Repetition { estimated: false } => Ok(GUESS),
            _ => self.inertia.n_below(pencil, frequency),
        }
    }

    /// Factorises at a shift (1/s), about which is searched from now on, and estimates the condition number there: infinite where the
    /// matrix is singular. Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    pub fn search_about(&mut self, shift: f64, pencil: &Pencil, lu: &mut Factor) -> Result<f64> {
        self.shift = shift;
        let shifted = shifted(pencil, shift)?;
        let matrix = shifted.as_ref().unwrap_or(pencil.k);
        match lu.factorise(matrix) {
            Ok(()) => condition(matrix, lu),
            Err(error) if error.kind() == ErrorKind::Singular => {
                // MUMPS takes no other values after it has failed.
                lu.release();
                Ok(f64::INFINITY)
            }
            Err(error) => Err(error),
        }
    }

    /// Counts next where this count was taken, as the solver that took it would. Not collective.
    pub fn go_on_from(&mut self, count: &Count) {
        self.gap = Some(count.below);
    }

    /// Left vectors of the modes that the last search found: columns `2i` and `2i + 1` are the real and imaginary part of mode i, `y^H M y = 1`, with the
    /// relative `accuracy` that each is to have; where it is infinite, the columns need be no left vector. Gives the number of solves, too.
    /// Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's; [`Error::NotConverged`] where a vector does not come to its accuracy.
    pub fn left_vectors(
        &mut self,
        problem: &Problem,
        modes: &[Mode],
        accuracy: impl Fn(&Mode) -> f64,
    ) -> Result<(Block, usize)> {
        let (basis, n_sought) = (self.basis.take(), modes.iter().filter(|mode| accuracy(mode).is_finite()).count());
        if let Some(modal) = self.modal.as_mut().filter(|_| n_sought > FEW_LEFT)
            && let Some(vectors) = modal.left_vectors(problem.pencil, modes)?
        {
            return Ok((left::normalised_left(problem.pencil.m, vectors)?, 0));
        }
        left::left_vectors(problem, modes, basis, accuracy)
    }

    /// Gives the memory of the last search's space back, but for what the next one starts from.
    pub fn forget(&mut self) {
        self.basis = None;
    }

    /// The next search knows nothing of the last one, which may have missed a mode.
    pub(super) fn start_anew(&mut self) {
        self.start = None;
    }

    /// Gives up what the next search would start from where so much memory is not free, MB. Collective.
    pub(super) fn make_room(&mut self, pencil: &Pencil, mb: f64) {
        if !machine::has_mb(pencil.k.comm(), mb) {
            self.start = None;
        }
    }

    /// Where a search in blocks does not fit into memory, gives up its start, then what counts the modes. Collective.
    pub(super) fn make_room_for_search(&mut self, pencil: &Pencil, n_modes: usize) {
        if self.labels.is_some() && !self.has_room(pencil, n_modes) {
            self.start = None;
            if !self.has_room(pencil, n_modes) {
                self.inertia.release();
            }
        }
    }

    /// Whether there is memory for a search in blocks.
    pub(super) fn has_room(&self, pencil: &Pencil, n_modes: usize) -> bool {
        machine::has_mb(pencil.k.comm(), search::needs_mb(n_modes, n_equations(pencil)))
    }

    /// The eigenpairs up to `end` (Hz) and some beyond, about `n_modes`; none where the search gave up. In blocks if it is told how far
    /// `beyond` the end, and can; else by TOAR.
    pub(super) fn search(
        &mut self,
        pencil: &Pencil,
        lu: &mut Factor,
        n_modes: usize,
        end: f64,
        beyond: Option<&f64>,
        progress: &mut dyn FnMut(usize, usize, usize),
    ) -> Result<Option<Search>> {
        let has_room = self.has_room(pencil, n_modes);
        let in_blocks = self.labels.as_ref().filter(|_| self.shift == 0.0 && has_room);
        let Some((labels, beyond)) = in_blocks.zip(beyond) else {
            return self.by_toar(pencil, lu, n_modes, end, progress);
        };
        let problem = Problem { pencil, factor: lu, labels };
        let reach = beyond * end;
        let start = self.start.take();
        let was_started = start.is_some();
        let mut outcome = search::solve(&problem, TAU * reach, n_modes, start, progress);
        if was_started && matches!(&outcome, Err(error) if error.kind() == ErrorKind::NotConverged) {
            outcome = search::solve(&problem, TAU * reach, n_modes, None, progress);
        }
        match outcome {
            Ok(search::Outcome { found: Found { pairs, n_solves, .. }, backward_errors, basis, start }) => {
                (self.basis, self.start) = (Some(basis), Some(start));
                Ok(Some(Search { pairs, reach, n_solves, backward_errors }))
            }
            Err(error) if error.kind() == ErrorKind::NotConverged => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// The same by TOAR: of a densely stored pencil in modal coordinates, unless that costs too many digits.
    fn by_toar(
        &mut self,
        pencil: &Pencil,
        lu: &mut Factor,
        n_modes: usize,
        end: f64,
        progress: &mut dyn FnMut(usize, usize, usize),
    ) -> Result<Option<Search>> {
        let shift = self.shift;
        if !lu.is_exact() {
            lu.set_precision(Precision::Double);
            factorise_shifted(pencil, lu, shift)?;
        }
        let n_all = 2 * n_equations(pencil);
        let n_wanted = (2 * n_modes).min(n_all);
        let options = Options { n_wanted, n_basis: 0, tolerance: TOLERANCE, max_restarts: 200, scale: 0.0 };
        let mut hear = |converged, solves| progress(converged, n_wanted, solves);
        let small = (SMALL_BASIS * n_wanted as f64) as usize;
        if shift == 0.0 && small < n_all && pencil.k.is_dense()? {
            if self.modal.is_none() {
                self.modal = Modal::new(pencil)?;
            }
            let options = Options { n_basis: small, tolerance: MODAL_TOLERANCE, scale: TAU * end, ..options };
            let search = match &mut self.modal {
                Some(modal) => complete(pencil, modal.solve(pencil, &options, &mut hear)?)?,
                None => None,
            };
            let is_good = |search: &Search| search.backward_errors.iter().all(|&error| error <= search::BACKWARD_ERROR);
            if let Some(search) = search.filter(is_good) {
                return Ok(Some(search));
            }
        }
        let problem = Quadratic { m: pencil.m, c: pencil.c, k: pencil.k, shift, inverse: &|b, x| lu.solve(b, x) };
        complete(pencil, eigen::solve_or_none(&problem, &options, &mut hear)?)
    }
}

/// A pair of the upper half plane stands for one mode, a real eigenvalue for half of one.
fn weight(pair: &Pair, below: f64) -> f64 {
    match pair.lambda.norm() <= TAU * below {
        true if pair.lambda.im > 0.0 => 1.0,
        true => 0.5,
        false => 0.0,
    }
}

/// What TOAR has found, with its backward errors.
fn complete(pencil: &Pencil, found: Option<Found>) -> Result<Option<Search>> {
    let Some(Found { pairs, n_converged, n_solves }) = found else { return Ok(None) };
    let lambdas: Vec<Complex64> = pairs.iter().map(|pair| pair.lambda).collect();
    let backward_errors = backward_errors(pencil, &lambdas, &vectors(pencil, &pairs)?)?;
    let furthest = lambdas.iter().map(|lambda| lambda.norm() / TAU).fold(0.0, f64::max);
    let reach = if n_converged >= 2 * n_equations(pencil) { f64::INFINITY } else { furthest };
    Ok(Some(Search { pairs, reach, n_solves, backward_errors }))
}

/// Real and imaginary parts as the columns of a block.
fn vectors(pencil: &Pencil, pairs: &[Pair]) -> Result<Block> {
    let mut block = Block::zeros(pencil.k.comm(), pencil.k.n_local(), 2 * pairs.len());
    for (j, vector) in pairs.iter().flat_map(|pair| [&pair.re, &pair.im]).enumerate() {
        vector.local(|values| block.column_mut(j).copy_from_slice(values))?;
    }
    Ok(block)
}

/// LU of `sigma^2 M + sigma C + K`.
pub(super) fn factorise_shifted(pencil: &Pencil, lu: &mut Factor, shift: f64) -> Result<()> {
    lu.factorise(shifted(pencil, shift)?.as_ref().unwrap_or(pencil.k))
}

/// `sigma^2 M + sigma C + K`, unless it is K.
fn shifted(pencil: &Pencil, shift: f64) -> Result<Option<Matrix>> {
    if shift == 0.0 {
        return Ok(None);
    }
    let mut shifted = pencil.k.duplicate()?;
    shifted.axpy(shift * shift, pencil.m)?;
    shifted.axpy(shift, pencil.c)?;
    Ok(Some(shifted))
}

pub(super) fn n_equations(pencil: &Pencil) -> usize {
    pencil.k.comm().sum(pencil.k.n_local())
}
