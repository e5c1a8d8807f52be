//! All modes of a frequency band, none missed.

use std::f64::consts::TAU;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::condition::condition;
use super::inertia::Inertia;
use super::left;
use super::modal::Modal;
use super::mode::backward_errors;
use super::search;
use super::space::{Basis, Problem};
use super::{Mode, Pencil};
use crate::assembly::System;
use crate::petsc::eigen::{self, Found, Options, Pair, Quadratic};
use crate::petsc::{Block, Factor, Matrix, Precision, memory};
use crate::{Error, Result};

/// How modes are searched for, and what serves all pencils of one pattern.
#[derive(Default)]
pub struct Solver {
    /// What counts the modes.
    pub inertia: Inertia,
    /// Real shift of the inverted problem, 1/s: 0, unless the structure has rigid motions.
    shift: f64,
    /// For the blocked search, where it pays: a number for each of this rank's equations that does not depend on the ranks.
    labels: Option<Vec<u64>>,
    /// The space of the last blocked search, which holds the vectors of its modes.
    basis: Option<Basis>,
    evidence: Evidence,
    /// Coordinates in which densely stored pencils are solved.
    modal: Option<Modal>,
    /// Where the last count was taken in a gap beyond the band's end, Hz: the next one begins there.
    gap: Option<f64>,
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

/// Modes that a search of the second kind begins with, where nothing tells their number.
const GUESS: usize = 10;

impl Evidence {
    /// Up to so many equations [`Evidence::Repetition`] asks for all eigenvalues.
    pub const ALL_UP_TO: usize = 100;
}

/// Equations from which the blocked search pays: below, a single solve costs too little.
const BLOCKED_FROM: usize = 50_000;

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
}

/// How many modes the symmetric problem has below a frequency, and how many were found there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Count {
    /// The frequency, Hz: the band's end, or a gap between modes near it.
    pub below: f64,
    /// By the inertia of `K_symmetric - omega^2 M`, or by a search before ([`Evidence`]).
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
/// The same in modal coordinates, with the band's end for the unit of frequency: it leaves backward errors of 1e-13 and eigenvalues to 2e-12
/// (782 coordinates).
const MODAL_TOLERANCE: f64 = 1e-11;
/// Memory of a symmetric factor over that of an LU on the same pattern: 3.0 GB over 5.3 GB on the full demo brake, or over 2.8 GB in single
/// precision.
const SYMMETRIC_OVER_LU: [f64; 2] = [0.6, 1.1];
/// Basis of TOAR over the eigenvalues wanted in modal coordinates, first: next to products its own upkeep counts there, and half of
/// SLEPc's basis takes half the time (782 coordinates). It restarts more often, which costs digits.
const SMALL_BASIS: f64 = 1.3;
/// So few left vectors of a densely stored pencil are sought one by one, more by a search of their own.
const FEW_LEFT: usize = 6;
/// By this factor the shift moves where TOAR gave up: about another shift it does not meet the same blocks.
const ELSEWHERE: f64 = 1.3;
/// How often the search is widened before the band is given up.
const TRIES: u32 = 4;
/// The blocked search goes this much beyond the band's end, so that the count finds a gap; farther where friction has carried a mode
/// across that gap; then it is TOAR's turn.
const BEYOND: [f64; 2] = [1.03, 1.12];

/// Eigenpairs of the closed upper half plane, complete up to a frequency.
struct Search {
    pairs: Vec<Pair>,
    /// Hz.
    reach: f64,
    n_solves: usize,
    /// Of the pairs.
    backward_errors: Vec<f64>,
}

impl Search {
    /// How many modes lie below a frequency, Hz.
    fn n_below(&self, frequency: f64) -> usize {
        self.pairs.iter().map(|pair| weight(pair, frequency)).sum::<f64>().round() as usize
    }
}

/// Finds all modes of `band` (Hz) of a pencil, sorted by frequency, vectors scaled to a largest entry of 1. `progress` hears of
/// (converged, wanted, solves). `lu` becomes the factor of the pencil's stiffness (shifted, where the solver shifts). Collective.
///
/// # Errors
/// PETSc's and MUMPS's; [`Error::NotConverged`] where the band could not be completed.
pub fn solve(
    pencil: &Pencil,
    lu: &mut Factor,
    solver: &mut Solver,
    band: [f64; 2],
    progress: &mut dyn FnMut(usize, usize, usize),
) -> Result<Band> {
    let (below, expected) = prepare(pencil, lu, solver, band[1])?;
    let (mut n_solves, mut last, mut gave_up) = (0, None, false);
    for attempt in 0..TRIES {
        let margin = (4 + expected / 20) * 3_usize.pow(attempt);
        if solver.labels.is_some() && !solver.has_room(pencil, expected + margin) {
            solver.inertia.release();
        }
        let beyond = BEYOND.get(attempt as usize).filter(|_| !gave_up);
        let Some(search) = solver.search(pencil, lu, expected + margin, band[1], beyond, progress)? else {
            gave_up = true;
            if solver.shift != 0.0 {
                solver.shift *= ELSEWHERE;
                factorise_shifted(pencil, lu, solver.shift)?;
            }
            continue;
        };
        n_solves += search.n_solves;
        let before = last.as_ref().map(|(_, count): &(Search, Count)| count.found);
        let count = match solver.evidence {
            Evidence::Inertia => count(pencil, solver, &search, band[1], (below, expected))?,
            Evidence::Repetition { estimated } => {
                repeated(&search, below, before.or(if estimated { Some(expected) } else { None }))
            }
        };
        if let Some(count) = count {
            if count.agrees() {
                return finish(search, band, count, n_solves);
            }
            last = Some((search, count));
        }
    }
    match last {
        Some((search, count)) => finish(search, band, count, n_solves),
        None => Err(Error::NotConverged(format!(
            "the eigensolver did not reach the end of the band {}-{} Hz, with {expected} modes expected. Try a narrower band \
             ([stability] band)",
            band[0], band[1]
        ))),
    }
}

/// About how many modes there are below a frequency (Hz), the band's end or the gap beyond it where the last count was taken, and the factor
/// about which is searched; where both do not fit into memory, the factor that counts and the one that solves make room for one another, and
/// the latter leaves room for the search.
fn prepare(pencil: &Pencil, lu: &mut Factor, solver: &mut Solver, end: f64) -> Result<(f64, usize)> {
    solver.basis = None;
    let has_mb = |needed| memory::has_mb(pencil.k.comm(), needed);
    let symmetric_over_lu = SYMMETRIC_OVER_LU[usize::from(!lu.is_exact())];
    if !solver.inertia.is_made() && !has_mb(symmetric_over_lu * lu.stats().used_mb) {
        lu.release();
    }
    let below = solver.gap.filter(|gap| (end..BEYOND[0] * end).contains(gap)).unwrap_or(end);
    let expected = solver.estimate(pencil, below)?;
    if !lu.is_made() {
        let search_mb = search::needs_mb(expected, n_equations(pencil));
        if !has_mb(solver.inertia.stats().used_mb / symmetric_over_lu + search_mb) {
            solver.inertia.release();
        }
        lu.leave_mb(search_mb);
    }
    factorise_shifted(pencil, lu, solver.shift)?;
    Ok((below, expected))
}

fn n_equations(pencil: &Pencil) -> usize {
    pencil.k.comm().sum(pencil.k.n_local() as f64) as usize
}

/// How many modes were found below a frequency at the band's `end` or beyond it, and how many there should be; none where the search did not
/// get there.
///
/// Friction may carry a mode across that frequency, where the two problems then differ by one: the count is taken again
/// in the widest gap between modes above the band's end.
fn count(
    pencil: &Pencil,
    solver: &mut Solver,
    search: &Search,
    end: f64,
    (below, expected): (f64, usize),
) -> Result<Option<Count>> {
    if search.reach <= below {
        return Ok(None);
    }
    let mut moduli: Vec<f64> = search.pairs.iter().map(|pair| pair.lambda.norm() / TAU).collect();
    moduli.extend(Some(search.reach).filter(|reach| reach.is_finite()));
    moduli.sort_by(f64::total_cmp);
    let count = Count { below, expected, found: search.n_below(below) };
    match widest_gap(&moduli, end).filter(|_| !count.agrees()) {
        Some(gap) => {
            let expected = solver.inertia.n_below(pencil, gap)?;
            solver.gap = Some(gap);
            Ok(Some(Count { below: gap, expected, found: search.n_below(gap) }))
        }
        None => Ok(Some(count)),
    }
}

/// How many modes were found below the band's end, now and before; none where the search did not get there.
fn repeated(search: &Search, end: f64, before: Option<usize>) -> Option<Count> {
    let found = search.n_below(end);
    let expected = if search.reach.is_finite() { before.unwrap_or(usize::MAX) } else { found };
    (search.reach > end).then_some(Count { below: end, expected, found })
}

/// A pair of the upper half plane stands for one mode, a real eigenvalue for half of one.
fn weight(pair: &Pair, below: f64) -> f64 {
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

fn finish(search: Search, band: [f64; 2], count: Count, n_solves: usize) -> Result<Band> {
    let pairs = search.pairs;
    // A real eigenvalue has no frequency: it belongs to the band where its modulus does.
    let frequency = |lambda: Complex64| if lambda.im == 0.0 { lambda.norm() } else { lambda.im } / TAU;
    let within = |(pair, _): &(Pair, f64)| frequency(pair.lambda) <= band[1] && pair.lambda.im / TAU >= band[0];
    let mut modes = Vec::new();
    for (Pair { lambda, re, im }, backward_error) in pairs.into_iter().zip(search.backward_errors).filter(within) {
        let mut mode = Mode { lambda, backward_error, re, im };
        mode.normalise()?;
        modes.push(mode);
    }
    sort(&mut modes);
    Ok(Band { modes, count, n_solves })
}

/// Real and imaginary parts as the columns of a block.
fn vectors(pencil: &Pencil, pairs: &[Pair]) -> Result<Block> {
    let mut block = Block::zeros(pencil.k.comm(), pencil.k.n_local(), 2 * pairs.len());
    for (j, vector) in pairs.iter().flat_map(|pair| [&pair.re, &pair.im]).enumerate() {
        vector.local(|values| block.column_mut(j).copy_from_slice(values))?;
    }
    Ok(block)
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
    /// About how many modes lie below a frequency (Hz); with [`Evidence::Inertia`] exactly.
    fn estimate(&mut self, pencil: &Pencil, frequency: f64) -> Result<usize> {
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
            Err(Error::Library(text)) if text.contains("the matrix is singular") => {
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

    /// Left vectors of the modes that the last search found, as [`left::left_vectors`] gives them. Collective.
    ///
    /// # Errors
    /// See there.
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

    /// Gives the memory of the last search's space back.
    pub fn forget(&mut self) {
        self.basis = None;
    }

    /// Whether there is memory for a search in blocks.
    fn has_room(&self, pencil: &Pencil, n_modes: usize) -> bool {
        memory::has_mb(pencil.k.comm(), search::needs_mb(n_modes, n_equations(pencil)))
    }

    /// The eigenpairs up to `end` (Hz) and some beyond, about `n_modes`; none where the search gave up. In blocks if it is told how far
    /// `beyond` the end, and can; else by TOAR.
    fn search(
        &mut self,
        pencil: &Pencil,
        lu: &mut Factor,
        n_modes: usize,
        end: f64,
        beyond: Option<&f64>,
        progress: &mut dyn FnMut(usize, usize, usize),
    ) -> Result<Option<Search>> {
        let shift = self.shift;
        let has_room = self.has_room(pencil, n_modes);
        let in_blocks = self.labels.as_ref().filter(|_| shift == 0.0 && has_room);
        if let Some((labels, beyond)) = in_blocks.zip(beyond) {
            let problem = Problem { pencil, factor: lu, labels };
            let reach = beyond * end;
            let outcome = search::solve(&problem, TAU * reach, n_modes, progress);
            return match outcome {
                Ok((Found { pairs, n_solves, .. }, errors, basis)) => {
                    self.basis = Some(basis);
                    Ok(Some(Search { pairs, reach, n_solves, backward_errors: errors }))
                }
                Err(Error::NotConverged(_)) => Ok(None),
                Err(error) => Err(error),
            };
        }
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

/// What TOAR has found, with its backward errors.
fn complete(pencil: &Pencil, found: Option<Found>) -> Result<Option<Search>> {
    let Some(Found { pairs, n_converged, n_solves }) = found else { return Ok(None) };
    let lambdas: Vec<Complex64> = pairs.iter().map(|pair| pair.lambda).collect();
    let backward_errors = backward_errors(pencil, &lambdas, &vectors(pencil, &pairs)?)?;
    let furthest = lambdas.iter().map(|lambda| lambda.norm() / TAU).fold(0.0, f64::max);
    let reach = if n_converged >= 2 * n_equations(pencil) { f64::INFINITY } else { furthest };
    Ok(Some(Search { pairs, reach, n_solves, backward_errors }))
}

/// LU of `sigma^2 M + sigma C + K`.
fn factorise_shifted(pencil: &Pencil, lu: &mut Factor, shift: f64) -> Result<()> {
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
