//! One solve of the equilibrium at given laws and friction.

use serde::{Deserialize, Serialize};

use super::contacts::{Contacts, Counts};
use crate::Result;
use crate::assembly::System;
use crate::contact::{Response, Stage};
use crate::native::petsc::nonlinear::{self, Problem, Verdict};
use crate::native::{Matrix, Vector};

use super::step_factor::{StepFactor, StepSystem};

/// Residual at which an equilibrium counts as converged, relative to the larger of the loads and the contact forces.
const TOLERANCE: f64 = 1e-9;
/// A residual is also accepted where it is no more than this multiple of its own rounding error, which no step reduces:
/// penalties are so stiff on slender parts.
const ROUNDING_MULTIPLE: f64 = 4.0;
/// Rounding excuses no residual above this.
const ROUNDING_LIMIT: f64 = 1e-6;
/// Largest residual of a step's linear system relative to the step's own.
const LINEAR_TOLERANCE: f64 = 1e-2;
/// The last step need not go further below the equilibrium's tolerance than this.
const LAST_STEP_SHARE: f64 = 1e-2;
/// Newton steps at most: those that converge take 5 to 20, and a shorter step in friction is better than more of them.
const MAX_ITERATIONS: usize = 30;

/// What one Newton iterate looked like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// Residual over the larger of loads and contact forces (Euclidean norms).
    #[serde(rename = "relative_residual")]
    pub residual: f64,
    /// Points by status.
    #[serde(flatten)]
    pub counts: Counts,
    /// For each pair the number of points whose status differs from the iterate before.
    pub flips: Vec<usize>,
}

/// The report of one solve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// What was solved.
    pub label: String,
    /// Whether it converged.
    pub converged: bool,
    /// The iterates, the start first.
    pub iterations: Vec<Iteration>,
}

impl Step {
    /// Name of the pair that changed status most in the last iterates.
    pub fn flickering(&self, names: &[String]) -> Option<String> {
        let last = &self.iterations[self.iterations.len().saturating_sub(8)..];
        let flips = |pair: usize| last.iter().map(|it| it.flips.get(pair).copied().unwrap_or(0)).sum::<usize>();
        let worst = (0..names.len()).max_by_key(|&pair| flips(pair))?;
        (flips(worst) > 0).then(|| format!("{} ({} changes in {} iterations)", names[worst], flips(worst), last.len()))
    }
}

struct Newton<'a, 'b, 'c> {
    workspace: &'c mut Workspace<'a, 'b>,
    stage: &'c Stage,
    work: Vector,
    /// The displacements of the last residual.
    u: Vector,
    load_norm: f64,
    force_norm: f64,
    responses: Vec<Response>,
    accepted: Vec<Response>,
    iterations: Vec<Iteration>,
    progress: &'c mut dyn FnMut(usize, &Iteration),
}

impl Problem for Newton<'_, '_, '_> {
    /// `r = K u - B^T f(B u) - F_ext`
    fn residual(&mut self, u: &Vector, r: &mut Vector) -> Result<()> {
        self.responses = self.workspace.contacts.respond(u, self.stage)?;
        self.work.scale(0.0)?;
        self.workspace.contacts.add_forces(&self.responses, -1.0, &mut self.work)?;
        self.force_norm = self.work.norm()?;
        self.u.copy_from(u)?;
        self.workspace.system.k.multiply(u, r)?;
        r.axpy(1.0, &self.work)?;
        r.axpy(-1.0, &self.workspace.system.load)
    }

    /// `J = K + B^T D(B u) B`
    fn linearise(&mut self, u: &Vector) -> Result<()> {
        let responses = self.workspace.contacts.respond(u, self.stage)?;
        self.workspace.tangent.copy_from(&self.workspace.system.k)?;
        self.workspace.contacts.add_blocks(responses.iter().map(|r| r.tangent), self.workspace.tangent)?;
        self.workspace.factor.set_points(responses);
        Ok(())
    }

    fn jacobian(&self) -> &Matrix {
        self.workspace.tangent
    }

    fn correct(&mut self, r: &Vector, du: &mut Vector) -> Result<()> {
        let tolerance = linear_tolerance(self.iterations.last().map_or(1.0, |it| it.residual));
        let system = StepSystem { a: self.workspace.tangent, contacts: self.workspace.contacts, tolerance };
        self.workspace.factor.solve(&system, r, du)
    }

    fn judge(&mut self, iteration: usize, residual: f64, _step: f64) -> Verdict {
        let size = self.load_norm.max(self.force_norm).max(f64::MIN_POSITIVE);
        let (relative, flips) = (residual / size, self.flips());
        let may_be_rounding = iteration > 0 && relative > TOLERANCE && relative < ROUNDING_LIMIT;
        let rounding = if may_be_rounding { self.rounding().unwrap_or(0.0) / size } else { 0.0 };
        let entry = Iteration { residual: relative, counts: Counts::of(&self.responses), flips };
        (self.progress)(iteration, &entry);
        self.iterations.push(entry);
        self.accepted.clone_from(&self.responses);
        verdict(iteration, relative, rounding)
    }
}

/// `eps/2 |K (s u)|` with signs s that look random: about how much of `K u` is the rounding of u. Collective.
fn rounding(k: &Matrix, mut u: Vector, work: &mut Vector) -> Result<f64> {
    let signed = |(i, x): (usize, &mut f64)| {
        if (i.wrapping_mul(0x9e37_79b9) >> 16) & 1 == 1 {
            *x = -*x;
        }
    };
    u.local_mut(|u| u.iter_mut().enumerate().for_each(signed))?;
    k.multiply(&u, work)?;
    Ok(0.5 * f64::EPSILON * work.norm()?)
}

/// A step's linear residual relative to the step's own, after an iterate with this residual. It falls with the
/// residual, so that the convergence stays quadratic (Eisenstat and Walker, *SIAM J. Sci. Comput.* 17, 1996).
fn linear_tolerance(residual: f64) -> f64 {
    LINEAR_TOLERANCE.min(residual.max(LAST_STEP_SHARE * TOLERANCE / residual))
}

/// What an iterate with this residual and rounding error, relative to the larger of the loads and the contact forces,
/// means.
fn verdict(iteration: usize, residual: f64, rounding: f64) -> Verdict {
    match residual {
        r if r.is_nan() => Verdict::Diverged,
        r if r <= TOLERANCE => Verdict::Converged,
        r if r <= ROUNDING_LIMIT.min(ROUNDING_MULTIPLE * rounding) => Verdict::Converged,
        _ if iteration >= MAX_ITERATIONS => Verdict::Diverged,
        _ => Verdict::Continue,
    }
}

impl Newton<'_, '_, '_> {
    /// The rounding error of the last residual, N. Collective.
    fn rounding(&mut self) -> Result<f64> {
        rounding(&self.workspace.system.k, self.u.duplicate()?, &mut self.work)
    }

    fn flips(&self) -> Vec<usize> {
        let changed = |a: usize| self.accepted.get(a).is_some_and(|r| r.status != self.responses[a].status);
        let pairs = &self.workspace.contacts.interface().pairs;
        pairs.iter().map(|pair| pair.points.clone().filter(|&a| changed(a)).count()).collect()
    }
}

/// What a solve works with and keeps for the next.
pub(super) struct Workspace<'a, 'b> {
    pub system: &'a System,
    pub contacts: &'b Contacts<'a>,
    pub factor: &'b mut StepFactor,
    pub tangent: &'b mut Matrix,
}

/// What a solve came to.
pub(super) struct Outcome {
    pub converged: bool,
    pub iterations: Vec<Iteration>,
    /// What every point does at the last iterate.
    pub responses: Vec<Response>,
}

/// Newton's method from `u` under one stage's laws; `u` ends as the last iterate.
pub(super) fn solve(
    workspace: &mut Workspace,
    u: &mut Vector,
    stage: &Stage,
    progress: &mut dyn FnMut(usize, &Iteration),
) -> Result<Outcome> {
    let [work, own] = [workspace.system.zeros()?, workspace.system.zeros()?];
    let load_norm = workspace.system.load.norm()?;
    let mut newton = Newton {
        workspace,
        stage,
        work,
        u: own,
        load_norm,
        force_norm: 0.0,
        responses: Vec::new(),
        accepted: Vec::new(),
        iterations: Vec::new(),
        progress,
    };
    let converged = nonlinear::solve(&mut newton, u, MAX_ITERATIONS)?;
    Ok(Outcome { converged, iterations: newton.iterations, responses: newton.accepted })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    #[test]
    fn an_iterate_is_judged_by_its_residual_and_its_number() {
        let verdict_of = |iteration, residual| verdict(iteration, residual, 0.0);
        assert_eq!(verdict_of(0, 1e-9), Verdict::Converged);
        assert_eq!(verdict_of(0, 1.01e-9), Verdict::Continue);
        assert_eq!(verdict_of(MAX_ITERATIONS - 1, 1e-3), Verdict::Continue);
        assert_eq!(verdict_of(MAX_ITERATIONS, 1e-3), Verdict::Diverged);
        assert_eq!(verdict_of(MAX_ITERATIONS, 1e-10), Verdict::Converged);
        assert_eq!(verdict_of(3, f64::NAN), Verdict::Diverged);
    }

    #[test]
    fn a_residual_of_rounding_is_accepted_unless_it_is_large() {
        assert_eq!(verdict(1, 4e-8, 1e-8), Verdict::Converged);
        assert_eq!(verdict(1, 4.1e-8, 1e-8), Verdict::Continue);
        assert_eq!(verdict(1, 1.1e-6, 1.0), Verdict::Continue);
    }

    /// A spring of 1 N/m behind one of 1e10 N/m, both ends moved by 1 m: forces of 1e10 N cancel.
    #[test]
    fn rounding_is_that_of_the_forces_that_cancel() {
        let comm = Session::start(&[]).unwrap();
        let k = Matrix::dense(&comm, 2, &[1e10, -1e10, -1e10, 1e10 + 1.0]).unwrap();
        let u = Vector::from_local(&comm, &[1.0, 1.0]).unwrap();
        let mut work = u.duplicate().unwrap();
        k.multiply(&u, &mut work).unwrap();
        assert!(work.norm().unwrap() < 1.1);
        let found = rounding(&k, u, &mut work).unwrap();
        assert!(found > 1e-7 && found < 1e-5, "{found}");
    }

    #[test]
    fn a_step_is_solved_as_far_as_newtons_method_comes_and_no_further_than_the_tolerance_needs() {
        assert_eq!(linear_tolerance(1.0), 1e-2);
        assert_eq!(linear_tolerance(1e-4), 1e-4);
        assert!((linear_tolerance(1e-7) / 1e-4 - 1.0).abs() < 1e-12);
        assert_eq!(linear_tolerance(1e-10), 1e-2);
    }

    #[test]
    fn the_pair_that_changes_most_in_the_last_iterates_flickers() {
        let iteration =
            |flips: [usize; 2]| Iteration { residual: 1.0, counts: Counts::default(), flips: flips.to_vec() };
        let mut iterations = vec![iteration([50, 0])];
        iterations.extend((0..8).map(|_| iteration([1, 2])));
        let step = Step { label: String::new(), converged: false, iterations };
        let names = ["a".to_string(), "b".to_string()];
        assert_eq!(step.flickering(&names).unwrap(), "b (16 changes in 8 iterations)");
        let calm = Step { iterations: vec![iteration([0, 0])], ..step };
        assert_eq!(calm.flickering(&names), None);
    }
}
