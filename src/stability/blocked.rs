//! All modes within a radius by one growing subspace, with many right-hand sides at a time.
//!
//! With `P(lambda) = lambda^2 M + lambda C + K + i G` and a factor of K:
//!
//! 1. *Krylov blocks.* `V = [V_1 V_2 ...]`, `V_{j+1} = orth(K^-1 M V_j)` from a few random columns, until V has about
//!    twice as many columns as modes are expected: it nearly holds the shapes of the undamped problem, friction
//!    included. Where a nearby problem was solved before, V begins with its modes instead, those of some way beyond the
//!    radius included, and needs no solve for them.
//! 2. *Rayleigh-Ritz.* `V^T P(lambda) V y = 0` is solved ([`super::projected`]); `x = V y`. V is real, with structural
//!    damping, too: real and imaginary parts of vectors join it.
//! 3. *Correction.* The residuals `R = [P(lambda_i) x_i]` of all wanted modes are what damping and a truncated Krylov
//!    space leave. The directions `K^-1 R` that V lacks have few that count (singular values fall by three decades in
//!    twenty), which random combinations find: `K^-1 (R Omega)` joins V. Steps 2 and 3 repeat until every eigenvalue is
//!    converged and every backward error small.
//! 4. *One correction of left vectors.* An eigenvalue's error is about the product of the errors that its right and its
//!    left vector have in V, and V lacks much of what friction makes of left vectors. So one round, the second, takes
//!    the residuals of the transposed problem and adds `K^-T (L Omega)`.
//!
//! Why it is written by hand: SLEPc's solvers of quadratic problems take one right-hand side at a time. A pass over the
//! factor is memory traffic for one right-hand side and arithmetic for 16, a quarter of the time each on two ranks, and
//! so are the products with C and M. On the full brake it took 75 s where TOAR took 165 s when it came, and a third of
//! the solves less since it starts from the modes of another friction value.
//!
//! Sources: generalised Davidson with `K^-1` for its preconditioner (Sleijpen, Booten, Fokkema and van der Vorst, BIT
//! 36, 1996, section 4), its corrections compressed by a randomised range finder (Halko, Martinsson and Tropp, SIAM
//! Review 53, 2011, algorithm 4.1).

use std::f64::consts::TAU;
use std::rc::Rc;

use num_complex::Complex64;

use super::eigensolver::{EigenProgress, Eigensolver, OnProgress, Search, SearchRequest, SearchResult, SolverKind};
use super::mode::backward_errors;
use super::projected::{self, Target};
use super::space::{Basis, FactoredProblem, Ritz, SKETCH, Side, Space, Start};
use super::{EigenOptions, QuadraticProblem};
use crate::native::petsc::eigen::Pair;
use crate::{ErrorKind, Result};

/// Pairs whose vectors are looked at together.
const PAIRS_AT_ONCE: usize = 16;
/// Eigenvalues up to this share of the radius are the zeros of rigid motions, which rounding moves from round to round.
const RIGID: f64 = 1e-5;
/// Rounds that most searches take.
const N_ROUNDS_EXPECTED: usize = 10;
/// Rounds that the left vectors of a few unstable modes take.
const N_LEFT_ROUNDS_EXPECTED: usize = 3;

/// Searches in blocks, each from what the last one has left.
pub(super) struct Blocked {
    options: EigenOptions,
    /// For each of this rank's dofs a number that does not depend on the ranks.
    labels: Rc<[u64]>,
    /// What the next search starts from.
    start: Option<Start>,
    /// The space of the last search, which holds the vectors of its modes.
    basis: Option<Basis>,
}

impl Blocked {
    pub fn new(options: EigenOptions, labels: Vec<u64>) -> Blocked {
        Blocked { options, labels: labels.into(), start: None, basis: None }
    }

    /// For each of this rank's dofs a number that does not depend on the ranks.
    pub fn labels(&self) -> &[u64] {
        &self.labels
    }

    /// The next search starts from nothing.
    pub fn drop_start(&mut self) {
        self.start = None;
    }

    /// Whether there is something to start from.
    #[cfg(test)]
    pub fn has_start(&self) -> bool {
        self.start.is_some()
    }

    /// The space of the last search.
    pub fn take_basis(&mut self) -> Option<Basis> {
        self.basis.take()
    }

    /// How far a search would go, Hz; none where it is not for such a problem, or not for such an attempt any more.
    /// With a complex stiffness it is the only search that there is, and every attempt goes farther. Collective.
    pub fn reach(&self, problem: &QuadraticProblem, request: &SearchRequest) -> Option<f64> {
        let margins = self.options.band_margins;
        if problem.is_complex() {
            let margin = if request.attempt == 0 { margins[0] } else { margins[1].powi(request.attempt as i32) };
            return Some(margin * request.end);
        }
        let suits = request.shift == 0.0 && problem.n_dofs() >= self.options.blocked_from;
        margins.get(request.attempt).filter(|_| suits).map(|margin| margin * request.end)
    }

    /// Memory (MB) of a search for `n_modes` among `n_dofs`: the basis, its rounds, the vectors found, those that the
    /// next search starts from, a round's right-hand sides, solutions and products, and what left vectors then add.
    pub fn needs_mb(&self, n_modes: usize, n_dofs: usize) -> f64 {
        let right = self.n_krylov(n_modes) + (N_ROUNDS_EXPECTED + 5) * SKETCH + 2 * n_modes + self.n_start(n_modes);
        let left = N_LEFT_ROUNDS_EXPECTED * SKETCH + 6 * n_modes;
        8.0 * ((right + left) * n_dofs) as f64 / (1024.0 * 1024.0)
    }

    /// Columns of the Krylov space.
    fn n_krylov(&self, n_modes: usize) -> usize {
        (self.options.blocked.krylov_per_mode * n_modes as f64) as usize + 2 * self.options.blocked.krylov_block
    }

    /// Columns that the next search starts from.
    fn n_start(&self, n_modes: usize) -> usize {
        (2.0 * self.options.blocked.start_radius * n_modes as f64) as usize
    }

    /// Krylov blocks of `K^-1 M`.
    fn krylov<'p>(&self, problem: FactoredProblem<'p>, n_expected: usize) -> Result<Space<'p>> {
        let n_krylov = self.n_krylov(n_expected);
        let mut space = Space::with_capacity(problem, Side::Right, n_krylov + N_ROUNDS_EXPECTED * SKETCH);
        let n_columns = n_krylov.min(space.n_dofs);
        let block = self.options.blocked.krylov_block.min(space.n_dofs);
        let mut image = space.random(block).multiplied_by(problem.problem.matrices.m)?;
        while space.v.n_columns() < n_columns && image.n_columns() > 0 {
            image = space.extend_by_solves(&image)?;
        }
        Ok(space)
    }

    /// Rounds of Rayleigh-Ritz and corrections in a space; none where they do not converge. Keeps the space and the
    /// next start.
    fn correct(
        &mut self,
        mut space: Space,
        target: &Target,
        progress: &mut OnProgress,
    ) -> Result<Option<SearchResult>> {
        let mut last: Vec<Complex64> = Vec::new();
        for round in 0..self.options.blocked.max_rounds {
            let Some(ritz) = projected::solve(&space, target)? else { return Ok(None) };
            let change = self.options.blocked.eigenvalue_change;
            let is_rigid = |r: &Ritz| r.lambda.norm() <= RIGID * target.radius;
            let is_converged =
                |r: &Ritz| is_rigid(r) || last.iter().any(|z| (z - r.lambda).norm() <= change * z.norm());
            let n_converged = ritz.iter().filter(|r| is_converged(r)).count();
            progress(EigenProgress { n_converged, n_wanted: ritz.len(), n_solves: space.n_solves });
            if n_converged == ritz.len() && last.len() == ritz.len() {
                let start = space.start(&self.with_far_ones(&space, &ritz, target)?)?;
                let largest = self.options.blocked.backward_error;
                if let Some((pairs, backward_errors)) = accurate(&space, &start, &ritz, largest)? {
                    let (reach, n_solves) = (target.radius / TAU, space.n_solves);
                    (self.basis, self.start) = (Some(space.into_basis()), Some(start));
                    let solver = SolverKind::Blocked;
                    return Ok(Some(SearchResult { solver, pairs, backward_errors, reach, n_solves }));
                }
            }
            if round == self.options.blocked.left_round {
                if !correct_left(&mut space, target)? {
                    return Ok(None);
                }
            } else {
                let residuals = space.sketch(&worth_correcting(&ritz, is_converged))?;
                space.extend_by_solves(&residuals)?;
            }
            last = ritz.iter().map(|r| r.lambda).collect();
        }
        Ok(None)
    }

    /// The pairs within the radius, and those within a multiple of it as well as the space has them.
    fn with_far_ones(&self, space: &Space, within: &[Ritz], target: &Target) -> Result<Vec<Ritz>> {
        let radius = self.options.blocked.start_radius * target.radius;
        let wider = Target { radius, n_expected: self.n_start(target.n_expected) / 2, ..*target };
        let far = projected::solve(space, &wider)?.unwrap_or_default();
        Ok(within.iter().cloned().chain(far.into_iter().filter(|r| r.lambda.norm() > target.radius)).collect())
    }
}

impl Eigensolver for Blocked {
    fn search(&mut self, search: Search) -> Result<Option<SearchResult>> {
        let Search { problem, factor, request, progress } = search;
        let Some(reach) = self.reach(problem, &request) else { return Ok(None) };
        let (factor, labels) = (problem.factorise(request.shift, factor)?, self.labels.clone());
        let searched = FactoredProblem { problem, factor, labels: &labels };
        let target = Target { radius: TAU * reach, n_expected: request.n_modes, shift: request.shift };
        if let Some(start) = self.start.take() {
            let space = Space::started(searched, start, N_ROUNDS_EXPECTED * SKETCH)?;
            if let Some(result) = unless_not_converged(self.correct(space, &target, progress))? {
                return Ok(Some(result));
            }
        }
        unless_not_converged(
            self.krylov(searched, request.n_modes).and_then(|space| self.correct(space, &target, progress)),
        )
    }
}

/// A round for left vectors: extends the space by what these lack; gives whether they were found.
fn correct_left(space: &mut Space, target: &Target) -> Result<bool> {
    space.transpose();
    let left = projected::solve(space, target)?;
    if let Some(left) = &left {
        let residuals = space.sketch(&left.iter().collect::<Vec<_>>())?;
        space.extend_by_solves(&residuals)?;
    }
    space.transpose();
    Ok(left.is_some())
}

/// None where something did not converge.
fn unless_not_converged<T>(outcome: Result<Option<T>>) -> Result<Option<T>> {
    match outcome {
        Err(error) if error.kind() == ErrorKind::NotConverged => Ok(None),
        outcome => outcome,
    }
}

/// The pairs, whose vectors a start spans, with their backward errors; none where one of these is too large.
fn accurate(space: &Space, start: &Start, ritz: &[Ritz], largest: f64) -> Result<Option<(Vec<Pair>, Vec<f64>)>> {
    let (mut pairs, mut errors) = (Vec::new(), Vec::new());
    for ritz in ritz.chunks(PAIRS_AT_ONCE) {
        let lambdas: Vec<Complex64> = ritz.iter().map(|r| r.lambda).collect();
        let x = space.vectors_within(start, ritz);
        errors.extend(backward_errors(space.problem(), &lambdas, &x)?);
        if errors.iter().any(|&error| error > largest) {
            return Ok(None);
        }
        for (i, &lambda) in lambdas.iter().enumerate() {
            pairs.push(Pair { lambda, re: x.vector(2 * i)?, im: x.vector(2 * i + 1)? });
        }
    }
    Ok(Some((pairs, errors)))
}

/// All pairs, or only those that are not converged where these are few: then their residuals need no compression.
fn worth_correcting(ritz: &[Ritz], is_converged: impl Fn(&Ritz) -> bool) -> Vec<&Ritz> {
    let open: Vec<&Ritz> = ritz.iter().filter(|r| !is_converged(r)).collect();
    if open.is_empty() || 2 * open.len() > SKETCH { ritz.iter().collect() } else { open }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::LabelledFactor;
    use crate::native::{Block, Precision, Session};
    use crate::stability::BlockedOptions;
    use crate::stability::testing::Blocks;

    const END: f64 = 5.0;

    /// Searches a problem for its modes below 5 Hz with other options for the rounds.
    fn search(problem: &QuadraticProblem, labels: Vec<u64>, blocked: BlockedOptions) -> SearchResult {
        let options = EigenOptions { blocked, ..EigenOptions::always_blocked() };
        let mut factor = LabelledFactor::new(Precision::Double);
        let request = SearchRequest { n_modes: 20, end: END, shift: 0.0, attempt: 0 };
        let search = Search { problem, factor: &mut factor, request, progress: &mut |_| () };
        Blocked::new(options, labels).search(search).unwrap().unwrap()
    }

    #[test]
    fn a_round_for_left_vectors_saves_solves() {
        let blocks = Blocks::new(&Session::start(&[]).unwrap(), 50);
        blocks.with(0.8, &[], |problem| {
            let found = [BlockedOptions::default().left_round, usize::MAX].map(|left_round| {
                let options = BlockedOptions { left_round, ..BlockedOptions::default() };
                search(problem, blocks.system.dofs.labels(), options)
            });
            let [with, without] = &found;
            assert!(with.n_solves < without.n_solves, "{} {}", with.n_solves, without.n_solves);
            assert_eq!(with.pairs.len(), without.pairs.len());
            for (a, b) in with.pairs.iter().zip(&without.pairs) {
                assert!((a.lambda - b.lambda).norm() < 1e-9 * b.lambda.norm(), "{} {}", a.lambda, b.lambda);
            }
        });
    }

    /// With right vectors to 1e-5 and left ones as friction changes them, the correction of the left ones alone
    /// takes the eigenvalues' errors down.
    #[test]
    fn eigenvalues_are_better_with_the_directions_of_left_vectors() {
        let comm = Session::start(&[]).unwrap();
        let blocks = Blocks::new(&comm, 50);
        let labels = blocks.system.dofs.labels();
        blocks.with(0.8, &[], |problem| {
            let exact = search(problem, labels.clone(), BlockedOptions::default()).pairs;
            let mut factor = LabelledFactor::new(Precision::Double);
            let factor = problem.factorise(0.0, &mut factor).unwrap();
            let searched = FactoredProblem { problem, factor, labels: &labels };
            let mut space = Space::with_capacity(searched, Side::Right, 0);
            let mut columns = space.random(2 * exact.len());
            columns.values_mut().iter_mut().for_each(|x| *x *= 1e-6);
            let vectors = exact.iter().flat_map(|pair| [pair.re.to_vec().unwrap(), pair.im.to_vec().unwrap()].concat());
            columns.axpy(1.0, &Block::from_columns(&comm, 150, vectors.collect()));
            space.extend(columns).unwrap();
            let target = Target { radius: TAU * 1.03 * END, n_expected: 20, shift: 0.0 };
            let error = |space: &Space| {
                let found = projected::solve(space, &target).unwrap().unwrap();
                let nearest = |z: Complex64| {
                    let distance = |r: &Ritz| (r.lambda - z).norm() / z.norm();
                    found.iter().map(distance).fold(f64::INFINITY, f64::min)
                };
                exact.iter().map(|pair| nearest(pair.lambda)).fold(0.0, f64::max)
            };
            let before = error(&space);
            assert!(correct_left(&mut space, &target).unwrap());
            let after = error(&space);
            assert!(after < 0.05 * before && before > 1e-9, "{before:e} {after:e}");
        });
    }
}
