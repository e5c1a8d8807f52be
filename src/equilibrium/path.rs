//! From rest to any friction, in steps that Newton can take.

use super::contacts::Contacts;
use super::newton::{self, Iteration, Step, Workspace};
use crate::assembly::System;
use crate::contact::interface::{ContactPair, Interface};
use crate::contact::{Response, Stage};
use crate::native::{Factor, Matrix, Precision, Vector};

use super::step_factor::StepFactor;
use crate::{Error, Result};

/// A converged state.
pub struct Equilibrium {
    /// Displacements of the free equations, m.
    pub u: Vector,
    /// What each contact point does, on every rank.
    pub responses: Vec<Response>,
    /// Friction of the swept pairs.
    pub friction: f64,
    /// The solves that led here from the state before.
    pub steps: Vec<Step>,
}

/// Equations from which tangents are factorised in single precision: below, a factor costs too little.
const SINGLE_FROM: usize = 50_000;
/// Friction rises from rest by this much at first, then by twice as much.
const FIRST_RISE: f64 = 0.1;
/// A failing step is halved down to this.
const SMALLEST_RISE: f64 = 0.005;

/// In which precision the tangents of a system are factorised.
pub fn tangent_precision(system: &System) -> Precision {
    if system.dofs.n_global() >= SINGLE_FROM { Precision::Single } else { Precision::Double }
}

/// The equilibria of one structure along rising or falling friction. Keeps the last state, from which the next starts.
pub struct Path<'a> {
    system: &'a System,
    contacts: Contacts<'a>,
    tangent: Matrix,
    factor: StepFactor,
    state: Option<(f64, Vector)>,
    /// The equilibrium before `state`, for extrapolation.
    before: Option<(f64, Vector)>,
    steps: Vec<Step>,
    /// Whether no step has followed the settling.
    is_settled_only: bool,
    /// Pairs that may open and are pulled apart where all that touches holds, with the force, N.
    pulled: Vec<(String, f64)>,
}

impl<'a> Path<'a> {
    /// A path that starts at rest. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(system: &'a System, interface: &'a Interface) -> Result<Path<'a>> {
        let contacts = Contacts::new(interface, system)?;
        let (tangent, factor) = (system.k.duplicate()?, StepFactor::new(tangent_precision(system)));
        let (steps, pulled) = (Vec::new(), Vec::new());
        let (state, before, is_settled_only) = (None, None, true);
        Ok(Path { system, contacts, tangent, factor, state, before, steps, is_settled_only, pulled })
    }

    /// From now on factorises in this precision, whatever the size. Collective.
    pub fn set_precision(&mut self, precision: Precision) {
        self.factor.set_precision(precision);
    }

    /// The evaluator of the contact points.
    pub fn contacts(&self) -> &Contacts<'a> {
        &self.contacts
    }

    /// The evaluator of the contact points, to evaluate.
    pub fn contacts_mut(&mut self) -> &mut Contacts<'a> {
        &mut self.contacts
    }

    /// The tangent's factor.
    pub fn factor(&self) -> &Factor {
        self.factor.factor()
    }

    /// Iterations with factors of neighbouring tangents.
    pub fn n_iterations(&self) -> usize {
        self.factor.n_iterations()
    }

    /// The evaluator, and room for the tangent of the brake linearised: the next step makes its own.
    pub fn lend_tangent(&mut self) -> (&mut Contacts<'a>, &mut Matrix) {
        (&mut self.contacts, &mut self.tangent)
    }

    /// The evaluator, the tangent, and room for its factor. Whoever borrows it makes it for points that do what `frozen` says: the next step
    /// starts from there.
    pub fn lend_factor(&mut self, frozen: Vec<Response>) -> (&Contacts<'a>, &Matrix, &mut Factor) {
        (&self.contacts, &self.tangent, self.factor.lend(frozen))
    }

    /// The tangent last made.
    pub fn tangent(&self) -> &Matrix {
        &self.tangent
    }

    /// The last converged or attempted displacement, for output after a failure.
    pub fn last(&self) -> Option<&Vector> {
        self.state.as_ref().map(|(_, u)| u)
    }

    /// The equilibria from which the path goes on, each with its friction, the last one last.
    pub fn states(&self) -> Vec<(f64, &Vector)> {
        self.before.iter().chain(&self.state).map(|(friction, u)| (*friction, u)).collect()
    }

    /// Puts the path back to where [`Path::states`] was asked for: the next equilibrium is sought as it would have been then.
    ///
    /// # Panics
    /// Where there is no state.
    pub fn restore(&mut self, mut states: Vec<(f64, Vector)>) {
        self.state = Some(states.pop().expect("a path under way has a state"));
        self.before = states.pop();
        self.is_settled_only = false;
    }

    /// The solves since the last equilibrium: those of a step that failed.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The equilibrium at a friction of the swept pairs. `progress` hears of (label, iteration, iterate). Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's; [`Error::NotConverged`] where even the smallest step fails.
    pub fn advance(&mut self, friction: f64, progress: &mut dyn FnMut(&str, usize, &Iteration)) -> Result<Equilibrium> {
        if self.state.is_none() {
            self.settle(progress)?;
        }
        loop {
            let reached = self.state.as_ref().expect("settled above").0;
            let (goal, u, responses) = self.rise(reached, self.next_goal(reached, friction), progress)?;
            self.before = self.state.replace((goal, u));
            if goal == friction {
                return self.equilibrium(responses);
            }
        }
    }

    /// `u + (u - u_before) (goal - mu) / (mu - mu_before)`: the last equilibrium, carried on.
    fn predict(&self, goal: f64) -> Result<Vector> {
        let (mu, u) = self.state.as_ref().expect("a path under way has a state");
        let mut trial = u.duplicate()?;
        if let Some((mu_before, before)) = self.before.as_ref().filter(|(mu_before, _)| mu_before != mu) {
            let ratio = (goal - mu) / (mu - mu_before);
            trial.scale(1.0 + ratio)?;
            trial.axpy(-ratio, before)?;
        }
        Ok(trial)
    }

    /// Rest to where the brake is brought together.
    fn settle(&mut self, progress: &mut dyn FnMut(&str, usize, &Iteration)) -> Result<()> {
        let mut u = self.system.zeros()?;
        let (step, responses) = self.newton(&Stage::Settle, "settle".into(), &mut u, progress)?;
        let converged = step.converged;
        self.steps.push(step);
        self.state = Some((0.0, u));
        if !converged {
            return Err(self.failure(0.0));
        }
        self.pulled = pulled_apart(self.contacts.interface(), &responses);
        Ok(())
    }

    /// The true laws without friction at the disc, from where the brake is brought together: a stop on the way for a brake that does not
    /// reach its first friction at once.
    fn stop_without_friction(&mut self, progress: &mut dyn FnMut(&str, usize, &Iteration)) -> Result<()> {
        let mut u = self.state.as_ref().expect("settled").1.duplicate()?;
        let stage = self.contacts.interface().stage(0.0);
        let (step, _) = self.newton(&stage, "contact without friction at the disc".into(), &mut u, progress)?;
        let converged = step.converged;
        self.steps.push(step);
        self.state = Some((0.0, u));
        self.is_settled_only = false;
        if converged { Ok(()) } else { Err(self.failure(0.0)) }
    }

    fn next_goal(&self, reached: f64, friction: f64) -> f64 {
        let rise = if reached == 0.0 { FIRST_RISE } else { 2.0 * FIRST_RISE };
        let goal = reached + (friction - reached).clamp(-rise, rise);
        if (goal - friction).abs() < 1e-12 { friction } else { goal }
    }

    /// One step towards `goal`, halved until Newton takes it. Gives the friction reached and the state there.
    fn rise(
        &mut self,
        reached: f64,
        mut goal: f64,
        progress: &mut dyn FnMut(&str, usize, &Iteration),
    ) -> Result<(f64, Vector, Vec<Response>)> {
        loop {
            let mut trial = self.predict(goal)?;
            let stage = self.contacts.interface().stage(goal);
            let (step, responses) = self.newton(&stage, format!("friction {goal:.4}"), &mut trial, progress)?;
            let converged = step.converged;
            self.steps.push(step);
            if converged {
                if std::mem::take(&mut self.is_settled_only) {
                    // No equilibrium of the true laws: nothing to extrapolate from.
                    self.state = None;
                }
                return Ok((goal, trial, responses));
            }
            if self.is_settled_only {
                self.stop_without_friction(progress)?;
                continue;
            }
            if (goal - reached).abs() <= SMALLEST_RISE {
                return Err(self.failure(goal));
            }
            goal = 0.5 * (goal + reached);
        }
    }

    fn newton(
        &mut self,
        stage: &Stage,
        label: String,
        u: &mut Vector,
        progress: &mut dyn FnMut(&str, usize, &Iteration),
    ) -> Result<(Step, Vec<Response>)> {
        let name = label.clone();
        let workspace = Workspace {
            system: self.system,
            contacts: &mut self.contacts,
            factor: &mut self.factor,
            tangent: &mut self.tangent,
        };
        newton::solve(workspace, u, stage, label, &mut |i, it| progress(&name, i, it))
    }

    fn equilibrium(&mut self, responses: Vec<Response>) -> Result<Equilibrium> {
        let (friction, u) = self.state.as_ref().expect("a path under way has a state");
        Ok(Equilibrium { u: u.duplicate()?, responses, friction: *friction, steps: std::mem::take(&mut self.steps) })
    }

    fn failure(&self, friction: f64) -> Error {
        let step = self.steps.last().expect("a failure follows a step");
        let names: Vec<String> = self.contacts.interface().pairs.iter().map(|pair| pair.name.clone()).collect();
        let flicker = step.flickering(&names).map_or(String::new(), |pair| format!(" Flickering pair: {pair}."));
        let reached = match &self.state {
            Some((reached, _)) if *reached != friction => format!(", the last one is at {reached:.3}"),
            _ => String::new(),
        };
        let pulled = self.pulled.iter().map(|(pair, force)| format!(" The loads pull {pair} apart with {force:.1} N."));
        let advice = if self.pulled.is_empty() {
            "A finer mesh at the edge of contact, a softer contact law or more stick stiffness may help; `squeal check` shows gaps \
             and free parts"
        } else {
            "Look at the directions of the loads; what is to be pulled needs separation = false"
        };
        let what = format!(
            "no equilibrium at friction {friction:.3} (step `{}`){reached}. Relative residuals: {}.{flicker}{} {advice}",
            step.label,
            history(&step.iterations),
            pulled.collect::<String>()
        );
        Error::NotConverged { what, history: step.iterations.iter().map(|it| it.residual).collect() }
    }
}

/// Residuals of the first and the last iterates, for people.
fn history(iterations: &[Iteration]) -> String {
    const SHOWN: usize = 6;
    let text = |part: &[Iteration]| part.iter().map(|it| format!("{:.1e}", it.residual)).collect::<Vec<_>>().join(" ");
    if iterations.len() <= 2 * SHOWN {
        return text(iterations);
    }
    let (first, last) = (&iterations[..SHOWN], &iterations[iterations.len() - SHOWN..]);
    format!("{} ... {} ({} iterations)", text(first), text(last), iterations.len() - 1)
}

/// The pairs whose settled forces add up to a pull, with that pull, N.
fn pulled_apart(interface: &Interface, responses: &[Response]) -> Vec<(String, f64)> {
    let sums = |pair: &ContactPair| {
        let forces = responses.get(pair.points.clone()).unwrap_or_default().iter().map(|r| r.normal_force);
        (forces.clone().sum::<f64>(), forces.map(f64::abs).sum::<f64>())
    };
    let pairs = interface.pairs.iter().filter(|pair| pair.separation).map(|pair| (pair, sums(pair)));
    // A part without load is pulled by rounding alone.
    let pulled = pairs.filter(|(_, (push, all))| -push > 1e-6 * all);
    pulled.map(|(pair, (push, _))| (pair.name.clone(), -push)).collect()
}
