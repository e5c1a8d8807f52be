//! All modes of a frequency band, none missed.

use std::f64::consts::TAU;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::search;
use super::solver::{Evidence, Search, Solver, factorise_shifted, n_equations};
use super::{Mode, Pencil};
use crate::native::petsc::eigen::Pair;
use crate::native::{Factor, machine};
use crate::{Error, Result};

/// Memory of a symmetric factor over that of an LU on the same pattern: 3.0 GB over 5.3 GB on the full demo brake, or over 2.8 GB in single
/// precision.
const SYMMETRIC_OVER_LU: [f64; 2] = [0.6, 1.1];
/// By this factor the shift moves where TOAR gave up: about another shift it does not meet the same blocks.
const ELSEWHERE: f64 = 1.3;
/// How often the search is widened before the band is given up.
const TRIES: u32 = 4;
/// The blocked search goes this much beyond the band's end, so that the count finds a gap; farther where friction has carried a mode
/// across that gap; then it is TOAR's turn.
const BEYOND: [f64; 2] = [1.03, 1.12];

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
        solver.make_room_for_search(pencil, expected + margin);
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
            solver.start_anew();
        }
    }
    match last {
        Some((search, count)) => finish(search, band, count, n_solves),
        None => Err(Error::not_converged(format!(
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
    solver.forget();
    let has_mb = |needed| machine::has_mb(pencil.k.comm(), needed);
    let symmetric_over_lu = SYMMETRIC_OVER_LU[usize::from(!lu.is_exact())];
    if !solver.inertia.is_made() {
        solver.make_room(pencil, symmetric_over_lu * lu.stats().used_mb);
        if !has_mb(symmetric_over_lu * lu.stats().used_mb) {
            lu.release();
        }
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

/// Sorts by frequency; modes of one frequency, such as the growing and the decaying one of a pair, by growth. What counts as one
/// frequency stands above rounding, so that modes have the same numbers on any number of ranks.
fn sort(modes: &mut [Mode]) {
    const SAME: f64 = 1e-9;
    modes.sort_by(|a, b| a.lambda.im.total_cmp(&b.lambda.im));
    for same in modes.chunk_by_mut(|a, b| b.lambda.im - a.lambda.im <= SAME * b.lambda.im) {
        same.sort_by(|a, b| a.lambda.re.total_cmp(&b.lambda.re));
    }
}
