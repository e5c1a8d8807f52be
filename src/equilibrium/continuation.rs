//! Continuation in the friction coefficient: which steps lead from rest to a value that is wanted.
//!
//! At rest there is no pressure, so every bound on sticking is zero and the pads are loose. So the first step *settles*
//! with all points sticking and touching points closed. From there one step leads to the value that is wanted, and from
//! an equilibrium to the next one, which it extrapolates the last two to. A step that fails is halved, and those after
//! it are at most twice as long as the one before. Where the first one fails, the true laws are solved without friction
//! at the disc before it.

use crate::Result;

/// A failing step is halved down to this.
const MIN_RISE: f64 = 0.005;
/// Friction values that differ by no more are the same.
const FRICTION_ROUNDING: f64 = 1e-12;

/// The laws of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Laws {
    /// While the brake is brought together.
    Settling,
    /// The true laws without friction at the disc, which a step stops at that has failed.
    Frictionless,
    /// The true laws at a friction value.
    Friction(f64),
}

/// Solves the steps.
pub(super) trait StepSolver {
    /// Displacements.
    type State;

    /// The state at rest.
    fn rest(&self) -> Result<Self::State>;

    /// `last + ratio (last - before)` with `before = (state, ratio)`; without it a copy of the last state.
    fn extrapolate(&self, last: &Self::State, before: Option<(&Self::State, f64)>) -> Result<Self::State>;

    /// Solves under some laws from a state, which becomes the last iterate; gives whether it converged.
    fn solve(&mut self, laws: Laws, state: &mut Self::State) -> Result<bool>;
}

/// How far the continuation came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reached {
    /// The value that was wanted.
    Goal,
    /// A step to this value failed, and could not be made smaller.
    Failed(f64),
}

/// A state and its friction value.
type Point<S> = (f64, S);

/// The last equilibria.
pub(super) struct Continuation<S> {
    last: Option<Point<S>>,
    /// The equilibrium before the last one, for extrapolation.
    before: Option<Point<S>>,
    /// Whether the last state is that of settling, no equilibrium of the true laws.
    is_settled_only: bool,
}

impl<S> Continuation<S> {
    /// At rest.
    pub fn new() -> Continuation<S> {
        Continuation { last: None, before: None, is_settled_only: false }
    }

    /// The last states, each with its friction value, the last one last.
    pub fn states(&self) -> impl Iterator<Item = &Point<S>> {
        self.before.iter().chain(&self.last)
    }

    /// The last state, or that of a failed settling, with its friction value.
    pub fn last(&self) -> Option<&Point<S>> {
        self.last.as_ref()
    }

    /// Continues from where [`Continuation::states`] were these.
    pub fn restore(&mut self, mut states: Vec<Point<S>>) {
        self.last = states.pop();
        self.before = states.pop();
        self.is_settled_only = false;
    }

    /// Goes to a friction value.
    pub fn advance(&mut self, friction: f64, solver: &mut impl StepSolver<State = S>) -> Result<Reached> {
        if self.last.is_none() && !self.start(Laws::Settling, solver)? {
            return Ok(Reached::Failed(0.0));
        }
        // Of this advance alone: a path that was restored goes on as it would have.
        let mut longest = f64::INFINITY;
        loop {
            let reached = self.last.as_ref().expect("settled above").0;
            match self.rise(next_goal(reached, friction, longest), &mut longest, solver)? {
                Err(failed) => return Ok(Reached::Failed(failed)),
                Ok(goal) if goal == friction => return Ok(Reached::Goal),
                Ok(_) => {}
            }
        }
    }

    /// The state from which friction rises: settling, or the true laws without friction from there. Gives whether it
    /// converged.
    fn start(&mut self, laws: Laws, solver: &mut impl StepSolver<State = S>) -> Result<bool> {
        let mut state = match &self.last {
            Some((_, settled)) => solver.extrapolate(settled, None)?,
            None => solver.rest()?,
        };
        let converged = solver.solve(laws, &mut state)?;
        self.last = Some((0.0, state));
        self.is_settled_only = laws == Laws::Settling;
        Ok(converged)
    }

    /// One step towards `goal`, halved until it converges, with the longest step that the next one may take. Gives the
    /// value reached, or that of the step that failed.
    fn rise(
        &mut self,
        mut goal: f64,
        longest: &mut f64,
        solver: &mut impl StepSolver<State = S>,
    ) -> Result<std::result::Result<f64, f64>> {
        loop {
            let mut trial = self.predict(goal, solver)?;
            if solver.solve(Laws::Friction(goal), &mut trial)? {
                // A settled state is no equilibrium of the true laws: nothing to extrapolate from.
                let is_settled_only = std::mem::take(&mut self.is_settled_only);
                *longest *= 2.0;
                self.before = self.last.replace((goal, trial)).filter(|_| !is_settled_only);
                return Ok(Ok(goal));
            }
            let reached = self.last.as_ref().expect("a step starts from a state").0;
            if self.is_settled_only {
                if !self.start(Laws::Frictionless, solver)? {
                    return Ok(Err(0.0));
                }
            } else if (goal - reached).abs() <= MIN_RISE {
                return Ok(Err(goal));
            } else {
                *longest = 0.5 * (goal - reached).abs();
                goal = next_goal(reached, goal, *longest);
            }
        }
    }

    /// `u + (u - u_before) (goal - mu) / (mu - mu_before)`: the last equilibrium, extrapolated, by no more than the
    /// distance of the two.
    fn predict(&self, goal: f64, solver: &impl StepSolver<State = S>) -> Result<S> {
        let (mu, u) = self.last.as_ref().expect("a step starts from a state");
        let before = self.before.as_ref().filter(|(mu_before, _)| mu_before != mu);
        solver.extrapolate(
            u,
            before.map(|(mu_before, before)| (before, ((goal - mu) / (mu - mu_before)).clamp(-1.0, 1.0))),
        )
    }
}

/// The next value on the way from one friction value to another, by steps that are no longer than `longest`.
fn next_goal(reached: f64, friction: f64, longest: f64) -> f64 {
    let goal = reached + (friction - reached).clamp(-longest, longest);
    if (goal - friction).abs() < FRICTION_ROUNDING { friction } else { goal }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A structure whose state is `100 mu`; a step converges where `may` says so of its laws and its start.
    struct Line<F: Fn(Laws, f64) -> bool> {
        may: F,
        /// Laws and starts of all steps.
        steps: Vec<(Laws, f64)>,
    }

    impl<F: Fn(Laws, f64) -> bool> StepSolver for Line<F> {
        type State = f64;

        fn rest(&self) -> Result<f64> {
            Ok(-1.0)
        }

        fn extrapolate(&self, last: &f64, before: Option<(&f64, f64)>) -> Result<f64> {
            Ok(last + before.map_or(0.0, |(before, ratio)| ratio * (last - before)))
        }

        fn solve(&mut self, laws: Laws, state: &mut f64) -> Result<bool> {
            let converges = (self.may)(laws, *state);
            self.steps.push((laws, *state));
            match laws {
                Laws::Settling => *state = 7.0,
                Laws::Frictionless => *state = 0.0,
                Laws::Friction(mu) => *state = 100.0 * mu,
            }
            Ok(converges)
        }
    }

    fn line<F: Fn(Laws, f64) -> bool>(may: F) -> (Continuation<f64>, Line<F>) {
        (Continuation::new(), Line { may, steps: Vec::new() })
    }

    fn values(steps: &[(Laws, f64)]) -> Vec<f64> {
        steps.iter().filter_map(|(laws, _)| if let Laws::Friction(mu) = laws { Some(*mu) } else { None }).collect()
    }

    fn is_near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    #[test]
    fn one_step_leads_to_a_value_up_and_down() {
        let (mut path, mut line) = line(|_, _| true);
        assert_eq!(path.advance(0.6, &mut line).unwrap(), Reached::Goal);
        assert_eq!(path.advance(0.1, &mut line).unwrap(), Reached::Goal);
        assert_eq!(line.steps[0], (Laws::Settling, -1.0));
        assert_eq!(values(&line.steps), [0.6, 0.1]);
        assert_eq!(path.last().unwrap().0, 0.1);
    }

    #[test]
    fn a_step_starts_from_the_extrapolation_of_the_last_two_equilibria_by_no_more_than_their_distance() {
        let (mut path, mut line) = line(|_, _| true);
        for friction in [0.1, 0.3, 0.4, 0.9] {
            path.advance(friction, &mut line).unwrap();
        }
        let starts: Vec<f64> = line.steps.iter().map(|(_, start)| *start).collect();
        // From rest, from the settled state, from 0.1 alone, from 0.1 and 0.3 to 0.4, from 0.3 and 0.4 to 0.5.
        assert!(starts.iter().zip([-1.0, 7.0, 10.0, 40.0, 50.0]).all(|(a, b)| is_near(*a, b)), "{starts:?}");
    }

    #[test]
    fn a_failing_step_is_halved_and_later_ones_grow_from_there() {
        let (mut path, mut line) = line(|laws, start| match laws {
            Laws::Friction(mu) => (100.0 * mu - start).abs() < 11.0,
            _ => true,
        });
        path.restore(vec![(0.1, 10.0)]);
        assert_eq!(path.advance(0.9, &mut line).unwrap(), Reached::Goal);
        let values = values(&line.steps);
        // Extrapolation by as much as the step before is exact, by more it is not.
        let expected = [0.9, 0.5, 0.3, 0.2, 0.4, 0.8, 0.6, 0.9];
        assert!(values.iter().zip(expected).all(|(a, b)| is_near(*a, b)) && values.len() == 8, "{values:?}");
    }

    #[test]
    fn a_step_is_not_halved_below_the_smallest() {
        let (mut path, mut line) = line(|laws, _| !matches!(laws, Laws::Friction(mu) if mu > 0.1 + 1e-6));
        path.advance(0.1, &mut line).unwrap();
        let Reached::Failed(value) = path.advance(0.3, &mut line).unwrap() else { panic!("it cannot get there") };
        assert!(value - 0.1 <= MIN_RISE && value - 0.1 > 0.5 * MIN_RISE, "{value}");
        assert!(is_near(path.last().unwrap().0, 0.1), "the last equilibrium stays");
        line.steps.clear();
        path.advance(0.05, &mut line).unwrap();
        assert_eq!(values(&line.steps), [0.05], "as a path that is restored there goes on");
    }

    #[test]
    fn a_first_step_that_fails_stops_without_friction_and_goes_on_from_there() {
        let (mut path, mut line) = line(|laws, start| laws != Laws::Friction(0.1) || start == 0.0);
        assert_eq!(path.advance(0.1, &mut line).unwrap(), Reached::Goal);
        let expected =
            [(Laws::Settling, -1.0), (Laws::Friction(0.1), 7.0), (Laws::Frictionless, 7.0), (Laws::Friction(0.1), 0.0)];
        assert_eq!(line.steps, expected);
        // The stop is an equilibrium of the true laws, which later steps extrapolate from.
        assert_eq!(path.states().copied().collect::<Vec<_>>(), [(0.0, 0.0), (0.1, 10.0)]);
    }

    #[test]
    fn the_stop_without_friction_comes_once() {
        let (mut path, mut line) = line(|laws, _| !matches!(laws, Laws::Friction(_)));
        assert!(matches!(path.advance(0.1, &mut line).unwrap(), Reached::Failed(value) if value <= MIN_RISE));
        assert_eq!(line.steps.iter().filter(|(laws, _)| *laws == Laws::Frictionless).count(), 1);
    }

    #[test]
    fn a_settling_or_a_stop_that_fails_ends_it() {
        let (mut path, mut line) = line(|laws, _| laws != Laws::Settling);
        assert_eq!(path.advance(0.3, &mut line).unwrap(), Reached::Failed(0.0));
        assert_eq!((line.steps.len(), path.last().copied()), (1, Some((0.0, 7.0))));
        let (mut path, mut line) = self::line(|laws, _| laws == Laws::Settling);
        assert_eq!(path.advance(0.3, &mut line).unwrap(), Reached::Failed(0.0));
        assert_eq!(line.steps.len(), 3);
    }

    #[test]
    fn nothing_is_extrapolated_from_the_settled_state() {
        let (mut path, mut line) = line(|_, _| true);
        path.advance(0.1, &mut line).unwrap();
        assert_eq!(path.states().copied().collect::<Vec<_>>(), [(0.1, 10.0)]);
    }
}
