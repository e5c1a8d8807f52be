//! All modes of a frequency band, none missed: choose a solver, search, count, widen.

#[cfg(test)]
mod structural_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod viscoelastic_tests;

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::blocked::Blocked;
use super::count::{Count, Expected, ModeCounter};
use super::eigensolver::{Eigensolver, OnProgress, Search, SearchRequest, SearchResult, SolverKind};
use super::left;
use super::memory::MemoryBudget;
use super::modal::Modal;
use super::mode::by_frequency;
use super::space::FactoredProblem;
use super::toar::Toar;
use super::{EigenOptions, Mode, QuadraticProblem};
use crate::equilibrium::LabelledFactor;
use crate::native::petsc::eigen::Pair;
use crate::native::{Block, FactorStats};
use crate::{Error, Result};

/// What is searched for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandRequest {
    /// First and last frequency, Hz.
    pub band: [f64; 2],
    /// Real shift at which the problem is inverted, 1/s: 0, unless the structure has rigid-body modes.
    pub shift: f64,
}

impl From<[f64; 2]> for BandRequest {
    fn from(band: [f64; 2]) -> BandRequest {
        BandRequest { band, shift: 0.0 }
    }
}

/// Dofs below which all modes may be asked for.
const N_DOFS_SMALL: usize = 1000;
/// Modes of the band over dofs: above, the mesh does not resolve them.
const MAX_MODES_PER_DOF: f64 = 0.2;

/// The modes of a band.
pub struct Band {
    /// By frequency.
    pub modes: Vec<Mode>,
    /// The check of their number.
    pub count: Count,
    /// What was done.
    pub report: BandReport,
    /// Whether the conjugate of an eigenvalue is one, too: not with a complex stiffness.
    pub has_conjugates: bool,
}

/// What was done for a band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandReport {
    /// Who found the modes.
    pub solver: SolverKind,
    /// Number of searches.
    pub n_attempts: usize,
    /// Solves with the factor in all searches that came to an end.
    pub n_solves: usize,
    /// Shift of the last search, 1/s.
    pub shift: f64,
}

/// The solvers for problems of one pattern, with what one problem's solution leaves for the next.
pub struct BandSolver {
    options: EigenOptions,
    memory: MemoryBudget,
    counter: ModeCounter,
    blocked: Blocked,
    modal: Modal,
    toar: Box<dyn Eigensolver>,
}

impl BandSolver {
    /// Nothing is left from an earlier problem. `labels` has a number for each of this rank's dofs that does not depend
    /// on the ranks.
    pub fn new(options: EigenOptions, labels: Vec<u64>) -> BandSolver {
        BandSolver {
            options,
            memory: MemoryBudget::default(),
            counter: ModeCounter::default(),
            blocked: Blocked::new(options, labels),
            modal: Modal::new(options),
            toar: Box::new(Toar { options }),
        }
    }

    /// Finds all modes of a band, sorted by frequency, vectors scaled to a largest entry of 1. Where the solver needs a
    /// factor, `factor` becomes that of the problem at the shift of the report. Collective.
    ///
    /// ```no_run
    /// use squeal::equilibrium::{LinearSystem, Path};
    /// use squeal::stability::{BandSolver, EigenOptions, LinearTerms, Linearised};
    /// use squeal::structure::StructureOptions;
    /// use squeal::{Session, Structure};
    ///
    /// let comm = Session::start(&[])?;
    /// let brake = Structure::read(&comm, "brake.toml".as_ref(), &StructureOptions::default())?;
    /// let system = brake.assemble(&comm)?;
    /// let mut path = Path::new(&system, brake.interface())?;
    /// let equilibrium = path.advance(0.4, &mut |_, _, _| ())?;
    /// let LinearSystem { contacts, tangent, factor } = path.linear_system();
    /// let linearised = Linearised::new(&system, contacts, &equilibrium, LinearTerms::default(), tangent)?;
    /// let problem = linearised.problem(&system, contacts, tangent);
    /// let mut solver = BandSolver::new(EigenOptions::default(), system.dofs.labels());
    /// for mode in solver.solve_band(&problem, factor, &[0.0, 6000.0].into(), &mut |_| ())?.modes {
    ///     println!("{:.1} Hz grows by {:.1} 1/s", mode.frequency(), mode.lambda.re);
    /// }
    /// # Ok::<(), squeal::Error>(())
    /// ```
    ///
    /// # Errors
    /// PETSc's and MUMPS's; [`Error::NotConverged`] where the band could not be completed.
    pub fn solve_band(
        &mut self,
        problem: &QuadraticProblem,
        factor: &mut LabelledFactor,
        request: &BandRequest,
        progress: &mut OnProgress,
    ) -> Result<Band> {
        let &BandRequest { band, mut shift } = request;
        let expected = self.prepare(problem, factor, band[1])?;
        let (mut n_solves, mut last): (usize, Option<(SearchResult, Count, BandReport)>) = (0, None);
        let mut again = None;
        for attempt in 0.. {
            let planned = (attempt < self.options.n_attempts).then(|| self.options.n_margin(expected.n, attempt));
            let Some(n_modes) = again.take().or(planned.map(|margin| expected.n + margin)) else { break };
            let request = SearchRequest { n_modes, end: band[1], shift, attempt };
            let Some(search) = self.search(Search { problem, factor, request, progress })? else {
                shift *= self.options.shift_growth;
                continue;
            };
            n_solves += search.n_solves;
            let before = last.as_ref().map(|(_, count, _)| *count);
            let Some(count) = self.counter.count(problem, self.options.evidence, &search, expected, before)? else {
                continue;
            };
            let report = BandReport { solver: search.solver, n_attempts: attempt + 1, n_solves, shift };
            // The same band, by a search of its own, from a little more.
            again = (before.is_none() && search.is_overdamped(count.below))
                .then(|| search.n_below(f64::INFINITY) + self.options.n_margin(expected.n, 0));
            last = Some((search, count, report));
            if count.agrees() {
                break;
            }
            // What the search started from may lack a mode.
            self.blocked.drop_start();
        }
        let (search, count, report) = last.ok_or_else(|| not_converged(band, expected))?;
        Ok(Band { modes: modes_of(search, band)?, count, report, has_conjugates: !problem.is_complex() })
    }

    /// About how many modes there are; the factor that counts and the one that solves give way to one another where
    /// memory is short.
    fn prepare(&mut self, problem: &QuadraticProblem, factor: &mut LabelledFactor, end: f64) -> Result<Expected> {
        self.release_search_space();
        if !self.counter.sturm.is_made() {
            self.memory.before_count(problem, factor, &mut self.blocked);
        }
        let expected = self.counter.expect(problem, &self.options, end)?;
        if !problem.matrices.k.is_dense()? {
            require_resolved(expected.n, problem.n_dofs(), end)?;
        }
        if !factor.factor().is_made() {
            let search_mb = self.blocked.needs_mb(expected.n, problem.n_dofs());
            self.memory.before_factor(problem, factor, &mut self.counter.sturm, search_mb);
        }
        Ok(expected)
    }

    /// The eigenpairs by the first solver that does not give up; none where all do.
    fn search(&mut self, search: Search) -> Result<Option<SearchResult>> {
        let Search { problem, factor, request, progress } = search;
        for kind in self.choose(problem, &request)? {
            let solver: &mut dyn Eigensolver = match kind {
                SolverKind::Blocked => &mut self.blocked,
                SolverKind::Modal => &mut self.modal,
                SolverKind::Toar => &mut *self.toar,
            };
            if let Some(result) = solver.search(Search { problem, factor, request, progress })? {
                return Ok(Some(result));
            }
        }
        Ok(None)
    }

    /// The solvers for a request, the fastest first. TOAR is the last resort, but for complex stiffnesses, which the
    /// blocked search alone can take.
    fn choose(&mut self, problem: &QuadraticProblem, request: &SearchRequest) -> Result<Vec<SolverKind>> {
        let (mut kinds, is_complex) = (Vec::new(), problem.is_complex());
        if self.blocked.reach(problem, request).is_some() {
            let search_mb = self.blocked.needs_mb(request.n_modes, problem.n_dofs());
            if self.memory.before_search(problem, &mut self.blocked, &mut self.counter.sturm, search_mb) || is_complex {
                kinds.push(SolverKind::Blocked);
            }
        }
        if is_complex {
            return Ok(kinds);
        }
        if self.modal.suits(problem, request)? {
            kinds.push(SolverKind::Modal);
        }
        kinds.push(SolverKind::Toar);
        Ok(kinds)
    }

    /// Left vectors of modes that the last [`BandSolver::solve_band`] has found for the problem: columns `2i` and `2i +
    /// 1` are the real and imaginary part of mode i, `y^H M y = 1`, with the relative `accuracy` that each is to have;
    /// where it is infinite, the columns need be no left vector. Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's; [`Error::NotConverged`] where a vector does not come to its accuracy.
    pub fn left_vectors(
        &mut self,
        problem: &QuadraticProblem,
        factor: &mut LabelledFactor,
        modes: &[Mode],
        accuracy: impl Fn(&Mode) -> f64,
    ) -> Result<Block> {
        let basis = self.blocked.take_basis();
        let accuracies: Vec<f64> = modes.iter().map(accuracy).collect();
        let n_sought = accuracies.iter().filter(|accuracy| accuracy.is_finite()).count();
        if n_sought == 0 {
            return left::right_vectors(problem.matrices.m, modes);
        }
        if n_sought > self.options.n_left_one_by_one
            && let Some(vectors) = self.modal.left_vectors(problem, modes)?
        {
            return left::normalised_left(problem.matrices.m, vectors);
        }
        let shift = factor.shift().unwrap_or(0.0);
        let factor = problem.factorise(shift, factor)?;
        let searched = FactoredProblem { problem, factor, labels: self.blocked.labels() };
        left::left_vectors(searched, modes, basis, &accuracies, self.options.max_left_rounds)
    }

    /// The next count begins where this one was taken, as it would for the solver that took it. Not collective.
    pub fn resume(&mut self, count: &Count) {
        self.counter.resume(count);
    }

    /// Gives the memory of the last search's space back, but for what the next one starts from.
    pub fn release_search_space(&mut self) {
        self.blocked.take_basis();
    }

    /// What the symmetric factor, which counts modes, has cost. Not collective.
    pub fn count_stats(&self) -> FactorStats {
        self.counter.sturm.stats()
    }
}

fn not_converged(band: [f64; 2], expected: Expected) -> Error {
    Error::not_converged(format!(
        "the eigensolver did not reach the end of the band {}-{} Hz, with {} modes expected. Try a narrower band",
        band[0], band[1], expected.n
    ))
}

/// The modes of a search that are in the band.
fn modes_of(search: SearchResult, band: [f64; 2]) -> Result<Vec<Mode>> {
    // A real eigenvalue has no frequency: it belongs to the band where its modulus does.
    let frequency = |lambda: Complex64| if lambda.im == 0.0 { lambda.norm() } else { lambda.im } / TAU;
    let within = |(pair, _): &(Pair, f64)| frequency(pair.lambda) <= band[1] && pair.lambda.im / TAU >= band[0];
    let mut modes = Vec::new();
    for (Pair { lambda, re, im }, backward_error) in search.pairs.into_iter().zip(search.backward_errors).filter(within)
    {
        let mut mode = Mode { lambda, backward_error, re, im };
        mode.normalise()?;
        modes.push(mode);
    }
    let order = by_frequency(&modes.iter().map(|mode| mode.lambda).collect::<Vec<_>>());
    let mut modes: Vec<Option<Mode>> = modes.into_iter().map(Some).collect();
    Ok(order.into_iter().filter_map(|i| modes[i].take()).collect())
}

/// Refuses a band with so many modes that they mean nothing: the upper modes of a mesh are those of its elements. Small
/// models may have all of theirs in the band.
fn require_resolved(n_modes: usize, n_dofs: usize, end: f64) -> Result<()> {
    if n_dofs < N_DOFS_SMALL || n_modes as f64 <= MAX_MODES_PER_DOF * n_dofs as f64 {
        return Ok(());
    }
    let advice = "Look at the units of mesh, Young's modulus and density, or narrow the band";
    Err(Error::input(format!("{n_modes} modes lie below {end} Hz, of {n_dofs} dofs. {advice}")))
}
