//! From rest to any friction value, in steps that Newton's method converges in.

use super::contacts::Contacts;
use super::continuation::{Continuation, Laws, Reached, StepSolver};
use super::labelled_factor::LabelledFactor;
use super::newton::{self, Iteration, Step, Workspace};
use super::step_factor::StepFactor;
use crate::assembly::System;
use crate::contact::interface::{ContactPair, Interface};
use crate::contact::{Response, Stage};
use crate::native::{Factor, Matrix, Precision, Vector};
use crate::{Error, Result};

/// A converged state.
pub struct Equilibrium {
    /// Displacements of the free dofs, m.
    pub u: Vector,
    /// What each contact point does, on every rank.
    pub responses: Vec<Response>,
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// The solves that led here from the state before.
    pub steps: Vec<Step>,
}

/// The evaluation of the contact points, a matrix on the pattern of the tangents, and the factor.
pub struct LinearSystem<'p, 'a> {
    /// The evaluation.
    pub contacts: &'p Contacts<'a>,
    /// The matrix.
    pub tangent: &'p mut Matrix,
    /// The factor, of whatever its label says.
    pub factor: &'p mut LabelledFactor,
}

/// Dofs from which tangents are factorised in single precision: below, a factor costs too little.
const SINGLE_PRECISION_FROM: usize = 50_000;

/// In which precision the tangents of a system are factorised.
pub fn tangent_precision(system: &System) -> Precision {
    if system.dofs.n_global() >= SINGLE_PRECISION_FROM { Precision::Single } else { Precision::Double }
}

/// The equilibria of one structure along rising or falling friction. Keeps the last states, from which the next starts.
pub struct Path<'a> {
    system: &'a System,
    contacts: Contacts<'a>,
    tangent: Matrix,
    factor: StepFactor,
    continuation: Continuation<Vector>,
    steps: Vec<Step>,
    /// What the points do where the brake has settled.
    settled: Vec<Response>,
}

impl<'a> Path<'a> {
    /// A path that starts at rest. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(system: &'a System, interface: &'a Interface) -> Result<Path<'a>> {
        Ok(Path {
            system,
            contacts: Contacts::new(interface, system)?,
            tangent: system.k.duplicate()?,
            factor: StepFactor::new(tangent_precision(system)),
            continuation: Continuation::new(),
            steps: Vec::new(),
            settled: Vec::new(),
        })
    }

    /// From now on factorises in this precision, whatever the size. Collective.
    pub fn set_precision(&mut self, precision: Precision) {
        self.factor.labelled().set_precision(precision);
    }

    /// The evaluation of the contact points.
    pub fn contacts(&self) -> &Contacts<'a> {
        &self.contacts
    }

    /// The tangent's factor.
    pub fn factor(&self) -> &Factor {
        self.factor.factor()
    }

    /// Iterations with factors of earlier tangents.
    pub fn n_iterations(&self) -> usize {
        self.factor.n_iterations()
    }

    /// What the steps solve with, for a linearisation about an equilibrium: the next step assembles a tangent of its
    /// own, and starts from the factor by its label.
    pub fn linear_system(&mut self) -> LinearSystem<'_, 'a> {
        LinearSystem { contacts: &self.contacts, tangent: &mut self.tangent, factor: self.factor.labelled() }
    }

    /// The last converged displacement, or that of a settling that failed.
    pub fn last(&self) -> Option<&Vector> {
        self.continuation.last().map(|(_, u)| u)
    }

    /// The equilibria from which the path continues, each with its friction value, the last one last.
    pub fn states(&self) -> Vec<(f64, &Vector)> {
        self.continuation.states().map(|(friction, u)| (*friction, u)).collect()
    }

    /// Puts the path back to where [`Path::states`] were these: the next equilibrium is sought as it would have been
    /// then.
    pub fn restore(&mut self, states: Vec<(f64, Vector)>) {
        self.continuation.restore(states);
    }

    /// The solves since the last equilibrium: those of a step that failed.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The equilibrium at a friction value of the swept pairs. `progress` takes (label, iteration, iterate).
    /// Collective.
    ///
    /// ```no_run
    /// use squeal::equilibrium::Path;
    /// use squeal::structure::StructureOptions;
    /// use squeal::{Session, Structure};
    ///
    /// let comm = Session::start(&[])?;
    /// let brake = Structure::read(&comm, "brake.toml".as_ref(), &StructureOptions::default())?;
    /// let system = brake.assemble(&comm)?;
    /// let equilibrium = Path::new(&system, brake.interface())?.advance(0.4, &mut |_, _, _| ())?;
    /// let force: f64 = equilibrium.responses.iter().map(|response| response.normal_force).sum();
    /// println!("{force} N presses the contacts");
    /// # Ok::<(), squeal::Error>(())
    /// ```
    ///
    /// # Errors
    /// PETSc's and MUMPS's; [`Error::NotConverged`] where even the smallest step fails.
    pub fn advance(&mut self, friction: f64, progress: &mut dyn FnMut(&str, usize, &Iteration)) -> Result<Equilibrium> {
        let workspace = Workspace {
            system: self.system,
            contacts: &self.contacts,
            factor: &mut self.factor,
            tangent: &mut self.tangent,
        };
        let (steps, settled) = (&mut self.steps, &mut self.settled);
        let mut solver = NewtonSteps { workspace, steps, settled, responses: Vec::new(), progress };
        let reached = self.continuation.advance(friction, &mut solver)?;
        let responses = solver.responses;
        match (reached, self.last()) {
            (Reached::Goal, Some(u)) => {
                Ok(Equilibrium { u: u.duplicate()?, responses, friction, steps: std::mem::take(&mut self.steps) })
            }
            (Reached::Failed(friction), _) => Err(self.failure(friction)),
            (Reached::Goal, None) => unreachable!("the goal is a state"),
        }
    }

    fn failure(&self, friction: f64) -> Error {
        let step = self.steps.last().expect("a failure follows a step");
        let names: Vec<String> = self.contacts.interface().pairs.iter().map(|pair| pair.name.clone()).collect();
        let flicker = step.flickering(&names).map_or(String::new(), |pair| format!(" Flickering pair: {pair}."));
        let reached = match self.continuation.last() {
            Some((reached, _)) if *reached != friction => format!(", the last one is at {reached:.3}"),
            _ => String::new(),
        };
        let pulled = pulled_apart(self.contacts.interface(), &self.settled);
        let advice = if pulled.is_empty() {
            "A finer mesh at the edge of contact, a softer contact law or more stick stiffness may help; `squeal check` shows gaps \
             and free parts"
        } else {
            "Look at the directions of the loads; what is to be pulled needs separation = false"
        };
        let pulled = pulled.iter().map(|(pair, force)| format!(" The loads pull {pair} apart with {force:.1} N."));
        let what = format!(
            "no equilibrium at friction {friction:.3} (step `{}`){reached}. Relative residuals: {}.{flicker}{} {advice}",
            step.label,
            history(&step.iterations),
            pulled.collect::<String>()
        );
        Error::NotConverged { what, history: step.iterations.iter().map(|it| it.residual).collect() }
    }
}

/// Newton's method for one step after the other.
struct NewtonSteps<'p, 'a> {
    workspace: Workspace<'a, 'p>,
    steps: &'p mut Vec<Step>,
    settled: &'p mut Vec<Response>,
    /// Of the last step.
    responses: Vec<Response>,
    progress: &'p mut dyn FnMut(&str, usize, &Iteration),
}

impl StepSolver for NewtonSteps<'_, '_> {
    type State = Vector;

    fn rest(&self) -> Result<Vector> {
        self.workspace.system.zeros()
    }

    fn extrapolate(&self, last: &Vector, before: Option<(&Vector, f64)>) -> Result<Vector> {
        let mut trial = last.duplicate()?;
        if let Some((before, ratio)) = before {
            trial.scale(1.0 + ratio)?;
            trial.axpy(-ratio, before)?;
        }
        Ok(trial)
    }

    fn solve(&mut self, laws: Laws, u: &mut Vector) -> Result<bool> {
        let interface = self.workspace.contacts.interface();
        let (stage, label) = match laws {
            Laws::Settling => (Stage::Settle, "settle".to_string()),
            Laws::Frictionless => (interface.stage(0.0), "contact without friction at the disc".to_string()),
            Laws::Friction(mu) => (interface.stage(mu), format!("friction {mu:.4}")),
        };
        let progress = &mut *self.progress;
        let mut progress = |i: usize, iteration: &Iteration| progress(&label, i, iteration);
        let outcome = newton::solve(&mut self.workspace, u, &stage, &mut progress)?;
        let converged = outcome.converged;
        self.steps.push(Step { label, converged, iterations: outcome.iterations });
        self.responses = outcome.responses;
        if laws == Laws::Settling && converged {
            self.settled.clone_from(&self.responses);
        }
        Ok(converged)
    }
}

/// Residuals of the first and the last iterates, as text.
fn history(iterations: &[Iteration]) -> String {
    const SHOWN: usize = 6;
    if iterations.is_empty() {
        return "the first one is not a number".into();
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::Counts;
    use crate::equilibrium::testing::{ALONG_X, CONTACT, blocks_on_belt};
    use crate::native::Session;

    #[test]
    fn the_equilibrium_has_pressed_blocks_closed_and_pulled_ones_open() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = blocks_on_belt(&comm, 4, 1, ALONG_X);
        let mut path = Path::new(&system, &interface).unwrap();
        let equilibrium = path.advance(0.5, &mut |_, _, _| ()).unwrap();
        let closed: Vec<bool> = equilibrium.responses.iter().map(|r| r.normal_force > 0.0).collect();
        assert_eq!(closed, [false, true, true, true]);
        let u = equilibrium.u.to_vec().unwrap();
        for (i, response) in equilibrium.responses.iter().enumerate().skip(1) {
            assert!((response.normal_force + CONTACT * u[3 * i + 2]).abs() < 1e-9);
            assert!((response.force[0] - 0.5 * response.normal_force).abs() < 1e-9);
        }
        assert!(equilibrium.steps.iter().all(|step| step.converged));
        assert_eq!(equilibrium.steps[0].label, "settle");
    }

    #[test]
    fn the_same_equilibrium_is_reached_from_below_from_above_and_from_a_restored_state() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = blocks_on_belt(&comm, 4, 1, ALONG_X);
        let at = |path: &mut Path, mu: f64| path.advance(mu, &mut |_, _, _| ()).unwrap().u.to_vec().unwrap();
        let mut path = Path::new(&system, &interface).unwrap();
        let from_below = at(&mut path, 0.3);
        at(&mut path, 0.9);
        let states = path.states().into_iter().map(|(mu, u)| (mu, u.duplicate().unwrap())).collect();
        let from_above = at(&mut path, 0.3);
        let mut restored = Path::new(&system, &interface).unwrap();
        restored.restore(states);
        let after = at(&mut restored, 0.3);
        for other in [from_above, after] {
            assert!(from_below.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-9));
        }
    }

    #[test]
    fn the_factor_is_labelled_with_what_the_points_do_in_it() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = blocks_on_belt(&comm, 4, 1, ALONG_X);
        let mut path = Path::new(&system, &interface).unwrap();
        path.advance(0.3, &mut |_, _, _| ()).unwrap();
        let LinearSystem { tangent, factor, .. } = path.linear_system();
        let before = factor.points().len();
        // A linearisation that needs no factor leaves the label alone.
        tangent.copy_from(&system.k).unwrap();
        assert!(before == 4 && path.linear_system().factor.points().len() == before);
        assert!(path.advance(0.5, &mut |_, _, _| ()).is_ok());
    }

    #[test]
    fn a_failure_names_the_pair_that_flickers() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = blocks_on_belt(&comm, 2, 0, ALONG_X);
        let mut path = Path::new(&system, &interface).unwrap();
        let iteration = |n_flips| Iteration { residual: 0.1, counts: Counts::default(), flips: vec![n_flips] };
        let mut failure = |flips: [usize; 2]| {
            path.steps = vec![Step { label: "a".into(), converged: false, iterations: flips.map(iteration).to_vec() }];
            path.failure(0.3).to_string()
        };
        assert!(failure([0, 2]).contains("1.0e-1. Flickering pair: belt (2 changes in 2 iterations)."));
        assert!(!failure([0, 0]).contains("Flickering"));
    }

    #[test]
    fn loads_that_pull_a_pair_apart_are_named() {
        let comm = Session::start(&[]).unwrap();
        let (_, interface) = blocks_on_belt(&comm, 2, 0, ALONG_X);
        let response = |normal_force: f64| Response { normal_force, ..Response::OPEN };
        assert!(pulled_apart(&interface, &[response(5.0), response(-4.0)]).is_empty());
        assert_eq!(pulled_apart(&interface, &[response(3.0), response(-4.0)]), [("belt".to_string(), 1.0)]);
        assert!(pulled_apart(&interface, &[response(3.0), response(-3.0 - 1e-9)]).is_empty(), "rounding");
    }
}
