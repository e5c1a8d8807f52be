//! Wear by Archard's law: `dh/dt = k p v` at each point of a sliding pair, h added to its gap.
//!
//! A step of time dt is implicit: pressure and wear at its end belong together, `d_new = d - k v dt P(d_new)`. That is
//! an equilibrium with a softer normal law at each point ([`PointLaw::wear`](crate::contact::PointLaw::wear)), so that
//! steps of any length are stable; each step begins at the equilibrium of the one before. The limit of long steps is
//! that of long sliding: the wear rate is a rigid motion of the parts, and uniform where they do not tilt.
//!
//! A step depends on nothing but the state before it, so that a run that was interrupted ends with the same numbers.
//!
//! Source: Archard, Contact and rubbing of flat surfaces, J. Appl. Phys. 24 (1953).

mod brake;
mod checkpoint;

use std::path::Path;
use std::time::Instant;

use crate::contact::Interface;
use crate::native::{Comm, Vector};
use crate::output::fields::write_contact_state;
use crate::output::folder::Folder;
use crate::output::wear::{summary, write};
use crate::results::{About, Wear, WearEnd};
use crate::structure::{FullModel, Structure};
use crate::{Error, Result};

use super::observer::{Event, Observer, stop_signal};
use super::start::{Earlier, Output, about, announce, identity, open_folder};

use brake::{State, WearingBrake};
use checkpoint::{Checkpoint, FinishedStep, UNIT};

/// What [`wear`] is asked for.
#[derive(Debug, Clone)]
pub struct WearOptions {
    /// Friction coefficient of the swept pairs; their own where there is none.
    pub friction: Option<f64>,
    /// Where wear ends.
    pub goal: WearGoal,
    /// Where results are written; nowhere if none.
    pub output: Option<Output>,
}

/// Where wear ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WearGoal {
    /// At a sliding distance, in steps of one length.
    Distance {
        /// Mean over the points that wear, m.
        distance: f64,
        /// Number of steps.
        n_steps: usize,
    },
    /// Where the standard deviation of `p v` over its mean falls below this on every pair, in steps that double.
    Uniform {
        /// Such as 0.01.
        tolerance: f64,
    },
}

/// Steps to a uniform wear rate double at most so often.
const MAX_DOUBLINGS: usize = 60;
/// `p v` is steady where a step changes it by less than this fraction of the tolerance of its uniformity.
const STEADY: f64 = 0.01;

/// What follows a step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Next {
    /// A step over this distance, m.
    Step(f64),
    End(WearEnd),
}

impl WearGoal {
    /// What follows the steps that are done, the state before any wear among them; to a uniform wear rate the first
    /// step has the length `first` (m).
    fn next(&self, done: &[FinishedStep], first: f64) -> Next {
        let n = done.len() - 1;
        match *self {
            WearGoal::Distance { n_steps, .. } if n == n_steps => Next::End(WearEnd::Distance),
            WearGoal::Distance { distance, n_steps } => Next::Step(distance / n_steps as f64),
            WearGoal::Uniform { tolerance } if done[n].worn.spread() <= tolerance => Next::End(WearEnd::Uniform),
            WearGoal::Uniform { tolerance } if n == MAX_DOUBLINGS || done[n].change <= STEADY * tolerance => {
                Next::End(WearEnd::Steady)
            }
            WearGoal::Uniform { .. } => Next::Step(first * 2_f64.powi(n as i32)),
        }
    }

    /// Equilibria that are known to come.
    fn n_planned(&self) -> usize {
        match *self {
            WearGoal::Distance { n_steps, .. } => n_steps + 1,
            WearGoal::Uniform { .. } => 1,
        }
    }
}

/// What a Galerkin super-element lacks.
const BASIS_OF_THE_NEW: &str = "the basis of this super-element has the displacements of the brake that it was made of: \
                                where wear moves the pressure, compare with the model";

/// Wears the sliding pairs of a structure that have a wear coefficient. The structure has the worn gaps afterwards.
/// With [`WearOptions::output`] the result is written to a folder with the pressure before and after, and wear
/// continues where an earlier run has ended. The root's result is complete. Collective.
///
/// ```no_run
/// use squeal::analysis::{WearGoal, WearOptions, wear};
/// use squeal::structure::{Structure, StructureOptions};
///
/// let comm = squeal::Session::start(&[])?;
/// let mut brake = Structure::read(&comm, "brake.toml".as_ref(), &StructureOptions::default())?;
/// let options = WearOptions { friction: None, goal: WearGoal::Uniform { tolerance: 0.01 }, output: None };
/// let worn = wear(&comm, &mut brake, &options, &mut ())?;
/// println!("bedded in after {} m", worn.steps.last().map_or(0.0, |step| step.distance));
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] where no pair wears, or for an output folder that cannot be used; [`Error::NotConverged`];
/// [`Error::Interrupted`]; PETSc's, MUMPS's and the system's.
pub fn wear(
    comm: &Comm,
    structure: &mut Structure,
    options: &WearOptions,
    observer: &mut dyn Observer,
) -> Result<Wear> {
    match structure {
        Structure::Full(full) => require_wear(full)?,
        Structure::Reduced(reduced) => {
            let refused = |_, what| Error::input(format!("{}: {what}", reduced.file().display()));
            let advice =
                "Give wear = 1e-14 (m2/N) to a [[contact]] of its model, and make it again with `squeal reduce`";
            require_wearing(&reduced.interface, advice, refused)?;
            if reduced.element.is_galerkin() {
                observer.event(Event::Warning(BASIS_OF_THE_NEW));
            }
        }
    }
    let found = structure.on_its_ranks(comm, |comm| Run::new(comm, structure, options, observer)?.run())?;
    let (wear, gaps) = found.unwrap_or_default();
    // Ranks that have no part in the work have the gaps, too.
    let gaps: Vec<f64> = comm.broadcast_value(0, gaps);
    for (point, gap) in structure.interface_mut().points.iter_mut().zip(gaps) {
        point.field_gap += gap - point.law.gap;
        point.law.gap = gap;
    }
    Ok(wear)
}

/// Refuses a model without a pair that wears.
///
/// # Errors
/// [`Error::Input`]; see [`wear`].
pub(super) fn require_wear(full: &FullModel) -> Result<()> {
    let refused = |number: Option<usize>, what: String| match number {
        Some(i) => full.model.error(full.model.contacts[i].place, what),
        None => Error::input(format!("{}: {what}", full.model.file.display())),
    };
    let advice = "Give wear = 1e-14 (m2/N) to the [[contact]] of each pad";
    require_wearing(&full.interface, advice, refused)
}

/// Refuses an interface without a pair that wears, or with one that wears and does not slide; `refused` makes the
/// error, of a pair by its number.
fn require_wearing(
    interface: &Interface,
    advice: &str,
    refused: impl Fn(Option<usize>, String) -> Error,
) -> Result<()> {
    let pairs = &interface.pairs;
    if let Some(i) = pairs.iter().position(|pair| pair.wear.is_some() && !pair.is_sliding()) {
        let what = "it has wear and does not slide. Leave wear out, or give its master a [[rotation]]";
        return Err(refused(Some(i), format!("contact {:?}: {what}", pairs[i].name)));
    }
    match pairs.iter().any(|pair| pair.wear.is_some()) {
        true => Ok(()),
        false => Err(refused(None, format!("no sliding contact has a wear coefficient. {advice}"))),
    }
}

/// Wear under way.
struct Run<'r> {
    comm: Comm,
    start: Instant,
    structure: &'r Structure,
    options: &'r WearOptions,
    friction: f64,
    observer: &'r mut dyn Observer,
    folder: Option<Folder>,
    checkpoint: Checkpoint,
}

impl<'r> Run<'r> {
    /// Opens the folder, and reports what an earlier run has done. Collective.
    fn new(
        comm: &Comm,
        structure: &'r Structure,
        options: &'r WearOptions,
        observer: &'r mut dyn Observer,
    ) -> Result<Run<'r>> {
        let (start, output) = (Instant::now(), options.output.as_ref());
        let folder = open_folder(comm, output)?;
        // Without a folder nothing is compared.
        let about = if output.is_some() { about(comm, structure, output)? } else { About::default() };
        let friction = options.friction.map_or_else(|| structure.own_friction(), Ok)?;
        let own = [("friction", friction.to_string()), ("goal", format!("{:?}", options.goal))];
        let identity = identity("wear".into(), own, output, &about);
        let checkpoint = Checkpoint::open(comm, folder.as_ref(), output, &identity)?;
        let earlier = Earlier { n: checkpoint.steps.len(), unit: UNIT };
        announce(&about, options.goal.n_planned(), place(options), earlier, observer);
        for (i, step) in checkpoint.steps.iter().enumerate() {
            if i >= options.goal.n_planned() {
                observer.event(Event::Inserted);
            }
            observer.event(Event::Worn { step: &step.worn, is_replayed: true });
        }
        Ok(Run { comm: comm.clone(), start, structure, options, friction, observer, folder, checkpoint })
    }

    /// Wears the structure, and writes the folder; gives the gaps of all points at the end, too. Collective.
    fn run(mut self) -> Result<(Wear, Vec<f64>)> {
        self.observer.event(Event::Stage("assembling"));
        let system = self.structure.assemble(&self.comm)?;
        let brake = WearingBrake::new(self.structure, &system, self.friction);
        let (before, mut state) = match self.checkpoint.states()? {
            Some([before, last]) => (before, last),
            None => {
                let state = brake.unworn(self.observer)?;
                self.finish_step(&brake, &state, f64::INFINITY)?;
                (state.clone(), state)
            }
        };
        let first = brake.first_distance();
        let end = loop {
            let distance = match self.options.goal.next(&self.checkpoint.steps, first) {
                Next::Step(distance) => distance,
                Next::End(end) => break end,
            };
            if self.checkpoint.steps.len() >= self.options.goal.n_planned() {
                self.observer.event(Event::Inserted);
            }
            let next = brake.step(&state, distance, self.observer)?;
            let change = brake.change(&state, &next);
            self.finish_step(&brake, &next, change)?;
            state = next;
        };
        let wear = self.results(&brake, [&before, &state], end);
        self.write(&brake, [&before, &state], &wear)?;
        Ok((wear, state.gaps))
    }

    /// Keeps a finished step, and ends the work where a signal has asked any rank for it. Collective.
    fn finish_step(&mut self, brake: &WearingBrake, state: &State, change: f64) -> Result<()> {
        let step = FinishedStep { worn: brake.measured(state), change };
        let step = self.checkpoint.commit(step, state)?;
        self.observer.event(Event::Worn { step: &step.worn, is_replayed: false });
        self.folder.iter().for_each(Folder::keep);
        let Some(signal) = stop_signal(&self.comm, self.observer) else { return Ok(()) };
        let advice = place(self.options)
            .map_or_else(String::new, |place| format!(". The same command goes on from there to {}", place.display()));
        let (distance, n) = (state.distance, self.checkpoint.steps.len());
        let text = format!("stopped after {distance:.3e} m of sliding; {n} {UNIT} are done{advice}");
        Err(Error::Interrupted { signal, text })
    }

    fn results(&self, brake: &WearingBrake, [before, state]: [&State; 2], end: WearEnd) -> Wear {
        Wear {
            title: self.structure.title().to_owned(),
            friction: self.friction,
            steps: self.checkpoint.steps.iter().map(|step| step.worn.clone()).collect(),
            end,
            points: brake.points(before, state),
            is_reduced: matches!(self.structure, Structure::Reduced(_)),
            seconds: self.start.elapsed().as_secs_f64(),
            n_ranks: self.comm.size(),
        }
    }

    /// Writes the results and ends the folder. Collective.
    fn write(self, brake: &WearingBrake, [before, state]: [&State; 2], wear: &Wear) -> Result<()> {
        if let Structure::Full(full) = self.structure {
            for (state, name) in [(before, "contact_before"), (state, "contact_worn")] {
                let u = Vector::from_local(&self.comm, &state.u)?;
                write_contact_state(self.folder.as_ref(), full, brake.system, (&u, &state.responses), name)?;
            }
        }
        let text = |folder: &Folder| summary(wear, &folder.place().display().to_string());
        self.comm.agree(self.folder.map_or(Ok(()), |folder| {
            write(wear, &folder, &text(&folder))?;
            folder.finish()
        }))
    }
}

/// Where results will be.
fn place(options: &WearOptions) -> Option<&Path> {
    options.output.as_ref().map(|output| output.folder.as_path())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ArchardWear, TangentialKind};
    use crate::native::Session;
    use crate::results::{PairWear, WearStep};

    fn done(spread: f64, change: f64) -> FinishedStep {
        let pairs = vec![PairWear { spread, ..PairWear::default() }];
        FinishedStep { worn: WearStep { distance: 1.0, pairs }, change }
    }

    #[test]
    fn a_distance_has_its_steps_and_ends() {
        let goal = WearGoal::Distance { distance: 6.0, n_steps: 2 };
        let steps = vec![done(0.0, f64::INFINITY); 3];
        assert_eq!(goal.next(&steps[..1], 9.0), Next::Step(3.0));
        assert_eq!(goal.next(&steps[..2], 9.0), Next::Step(3.0));
        assert_eq!(goal.next(&steps, 9.0), Next::End(WearEnd::Distance));
        assert_eq!((goal.n_planned(), WearGoal::Uniform { tolerance: 0.1 }.n_planned()), (3, 1));
    }

    #[test]
    fn steps_to_a_uniform_wear_rate_double_until_it_is_uniform_or_steady() {
        let goal = WearGoal::Uniform { tolerance: 0.1 };
        let mut steps = vec![done(0.5, f64::INFINITY)];
        for length in [3.0, 6.0, 12.0] {
            assert_eq!(goal.next(&steps, 3.0), Next::Step(length));
            steps.push(done(0.4, 0.0011));
        }
        let after = |last: FinishedStep| goal.next(&[&steps[..], &[last]].concat(), 3.0);
        assert_eq!(after(done(0.1, 0.5)), Next::End(WearEnd::Uniform));
        assert_eq!(after(done(0.1, 0.0)), Next::End(WearEnd::Uniform));
        assert_eq!(after(done(0.4, 0.001)), Next::End(WearEnd::Steady));
        assert_eq!(goal.next(&vec![done(0.4, 1.0); MAX_DOUBLINGS + 1], 3.0), Next::End(WearEnd::Steady));
    }

    #[test]
    fn only_sliding_pairs_with_a_coefficient_wear() {
        let comm = Session::start(&[]).unwrap();
        let mut brake = FullModel::read(&comm, "tests/data/pads_on_disc.toml".as_ref()).unwrap();
        let message = |brake: &FullModel| require_wear(brake).unwrap_err().to_string();
        assert!(message(&brake).contains("no sliding contact has a wear coefficient. Give wear = 1e-14"));
        brake.interface.pairs[1].wear = Some(ArchardWear { coefficient: 2e-14, density: 2000.0 });
        require_wear(&brake).unwrap();
        brake.interface.pairs[1].kind = TangentialKind::StickSlip;
        let line = brake.model.error(brake.model.contacts[1].place, "").to_string();
        assert!(message(&brake).starts_with(line.trim_end()), "{}", message(&brake));
        assert!(message(&brake).contains("it has wear and does not slide"));
    }
}
