//! One solve of the equilibrium at given laws and friction.

use serde::{Deserialize, Serialize};

use super::contacts::{Contacts, Counts};
use crate::Result;
use crate::assembly::System;
use crate::contact::{Response, Stage};
use crate::native::petsc::nonlinear::{self, Problem, Verdict};
use crate::native::{Matrix, Vector};

use super::step_factor::StepFactor;

/// Residual at which an equilibrium counts as converged, relative to the larger of the loads and the contact forces.
const TOLERANCE: f64 = 1e-9;
/// A step's linear residual relative to the step's own.
const FORCING: f64 = 1e-2;
/// The last step need not go further below the equilibrium's tolerance than this.
const ENOUGH: f64 = 0.1;
/// Newton steps at most.
const MAX_ITERATIONS: usize = 40;

/// What one Newton iterate looked like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// Residual over the larger of loads and contact forces (Euclidean norms).
    pub residual: f64,
    /// Points by status.
    pub counts: Counts,
    /// For each pair the number of points whose status differs from the iterate before.
    pub flips: Vec<usize>,
}

/// The report of one solve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// What was solved, for people.
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

struct Newton<'a, 'b> {
    system: &'a System,
    contacts: &'b mut Contacts<'a>,
    factor: &'b mut StepFactor,
    tangent: &'b mut Matrix,
    stage: &'b Stage,
    work: Vector,
    load_norm: f64,
    force_norm: f64,
    responses: Vec<Response>,
    accepted: Vec<Response>,
    iterations: Vec<Iteration>,
    progress: &'b mut dyn FnMut(usize, &Iteration),
}

impl Problem for Newton<'_, '_> {
    /// `r = K u - B^T f(B u) - F_ext`
    fn residual(&mut self, u: &Vector, r: &mut Vector) -> Result<()> {
        self.responses = self.contacts.respond(u, self.stage)?;
        self.work.scale(0.0)?;
        self.contacts.add_forces(&self.responses, -1.0, &mut self.work)?;
        self.force_norm = self.work.norm()?;
        self.system.k.multiply(u, r)?;
        r.axpy(1.0, &self.work)?;
        r.axpy(-1.0, &self.system.load)
    }

    /// `J = K + B^T D(B u) B`
    fn linearise(&mut self, u: &Vector) -> Result<()> {
        let responses = self.contacts.respond(u, self.stage)?;
        self.tangent.copy_from(&self.system.k)?;
        self.contacts.add_blocks(responses.iter().map(|r| r.tangent), self.tangent)?;
        self.factor.adopt(responses);
        Ok(())
    }

    fn jacobian(&self) -> &Matrix {
        self.tangent
    }

    fn correct(&mut self, r: &Vector, du: &mut Vector) -> Result<()> {
        let residual = self.iterations.last().map_or(1.0, |it| it.residual);
        let tolerance = FORCING.max(ENOUGH * TOLERANCE / residual);
        self.factor.solve(self.tangent, r, du, tolerance, self.contacts)
    }

    fn judge(&mut self, iteration: usize, residual: f64, _step: f64) -> Verdict {
        let relative = residual / self.load_norm.max(self.force_norm).max(f64::MIN_POSITIVE);
        let flips = self.flips();
        let entry = Iteration { residual: relative, counts: Counts::of(&self.responses), flips };
        (self.progress)(iteration, &entry);
        self.iterations.push(entry);
        self.accepted.clone_from(&self.responses);
        match relative {
            r if r.is_nan() => Verdict::Diverged,
            r if r <= TOLERANCE => Verdict::Converged,
            _ if iteration >= MAX_ITERATIONS => Verdict::Diverged,
            _ => Verdict::Continue,
        }
    }
}

impl Newton<'_, '_> {
    fn flips(&self) -> Vec<usize> {
        let changed = |a: usize| self.accepted.get(a).is_some_and(|r| r.status != self.responses[a].status);
        let pairs = &self.contacts.interface().pairs;
        pairs.iter().map(|pair| pair.points.clone().filter(|&a| changed(a)).count()).collect()
    }
}

/// What a solve works with and keeps for the next.
pub(super) struct Workspace<'a, 'b> {
    pub system: &'a System,
    pub contacts: &'b mut Contacts<'a>,
    pub factor: &'b mut StepFactor,
    pub tangent: &'b mut Matrix,
}

/// Newton's method from `u` under one stage's laws; `u` ends as the last iterate.
pub(super) fn solve(
    workspace: Workspace,
    u: &mut Vector,
    stage: &Stage,
    label: String,
    progress: &mut dyn FnMut(usize, &Iteration),
) -> Result<(Step, Vec<Response>)> {
    let Workspace { system, contacts, factor, tangent } = workspace;
    let mut newton = Newton {
        system,
        contacts,
        factor,
        tangent,
        stage,
        work: system.zeros()?,
        load_norm: system.load.norm()?,
        force_norm: 0.0,
        responses: Vec::new(),
        accepted: Vec::new(),
        iterations: Vec::new(),
        progress,
    };
    let outcome = nonlinear::solve(&mut newton, u, MAX_ITERATIONS)?;
    let Newton { iterations, accepted, .. } = newton;
    Ok((Step { label, converged: outcome.converged, iterations }, accepted))
}
