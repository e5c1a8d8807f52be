//! What the computing commands share: a brake, its frictions, a results folder, and one equilibrium after the other. All that is found goes
//! into [`Results`], of which everything that is written is made.

use std::path::PathBuf;
use std::time::Instant;

use crate::assembly::System;
use crate::equilibrium::Equilibrium;
use crate::petsc::{Comm, libraries};
use crate::report::folder::Folder;
use crate::results::{About, Failure, ModeData, Results, Value};
use crate::stability::Count;
use crate::sweep::{Costs, Event, Snapshot, Sweep};
use crate::{Error, Result};

use super::motion::Motion;
use super::progress::Progress;
use super::subject::{self, Subject, Told};
use super::{Run, output};

/// A brake about to be analysed over friction.
pub struct Study {
    pub subject: Box<dyn Subject>,
    pub folder: Option<Folder>,
    pub about: About,
    place: PathBuf,
    progress: Progress,
    start: Instant,
}

/// A study under way.
pub struct Walk<'w, 's> {
    pub study: &'w Study,
    pub system: &'s System,
    pub results: Results,
    sweep: Sweep<'s>,
    motion: Box<dyn Motion + 's>,
}

/// One friction of a study, its equilibrium found.
pub struct Visit<'v, 's> {
    pub study: &'v Study,
    pub system: &'v System,
    pub sweep: &'v mut Sweep<'s>,
    pub motion: &'v mut dyn Motion,
    pub equilibrium: &'v Equilibrium,
    /// Whether the friction is one of those asked for, whose modes are drawn and explained.
    pub asked: bool,
}

/// What a command makes of an equilibrium.
#[derive(Default)]
pub struct Found {
    pub modes: Vec<ModeData>,
    pub count: Option<Count>,
    /// Where modes are followed.
    pub snapshot: Option<Snapshot>,
}

/// How a study ended.
pub struct Outcome {
    results: Results,
    /// Why it went no further than its results.
    error: Option<Error>,
}

impl Study {
    /// Reads and checks everything before anything is computed; `band` gives the band (Hz) to analyse. Collective.
    pub fn new(
        comm: &Comm,
        run: &Run,
        command: &str,
        band: impl FnOnce(&dyn Subject) -> Result<[f64; 2]>,
    ) -> Result<Study> {
        let start = Instant::now();
        let subject = subject::read(comm, run)?;
        let frictions = subject.frictions(run.friction.as_ref().map(|list| list.0.as_slice()))?;
        let band = band(&*subject)?;
        let place = run.folder(command);
        let folder = comm.agree(if comm.is_root() { Folder::create(&place, run.force).map(Some) } else { Ok(None) })?;
        let progress = Progress::new(comm, frictions.len(), run.verbose);
        let about = About {
            program: format!("squeal {}", env!("CARGO_PKG_VERSION")),
            libraries: libraries(),
            command: std::env::args().skip(1).collect::<Vec<_>>().join(" "),
            n_ranks: comm.size(),
            band,
            frictions,
            ..subject.about(comm)?
        };
        Ok(Study { subject, folder, about, place, progress, start })
    }

    /// The values asked for.
    pub fn frictions(&self) -> &[f64] {
        &self.about.frictions
    }

    /// Does the work of a command, which visits one friction after the other. Where that does not converge, what was found is kept.
    /// Collective.
    pub fn run(&self, comm: &Comm, work: impl FnOnce(&mut Walk) -> Result<()>) -> Result<Outcome> {
        self.progress.say("assembling");
        let system = self.subject.assemble(comm)?;
        let mut sweep = Sweep::new(&system, self.subject.interface())?;
        sweep.friction_damping = self.subject.friction_damping();
        let motion = self.subject.motion(&system)?;
        let results = Results {
            about: About { n_equations: system.dofs.n_global(), ..self.about.clone() },
            surface: motion.surface().clone(),
            contact: self.subject.contact_faces(),
            ..Results::default()
        };
        let mut walk = Walk { study: self, system: &system, results, sweep, motion };
        let error = match work(&mut walk) {
            Ok(()) => None,
            Err(error @ Error::NotConverged(_)) => Some(error),
            Err(error) => return Err(error),
        };
        self.progress.finish();
        let (costs, mut results) = (walk.sweep.costs(), walk.results);
        results.costs = costs_text(&costs, self.start.elapsed().as_secs_f64(), comm.size());
        if let Some(error) = &error {
            results.failure.get_or_insert_default().reason = error.to_string();
        }
        Ok(Outcome { results, error })
    }

    /// Writes what was found, gives the folder its name, and tells the summary.
    pub fn finish(self, outcome: Outcome, summary: fn(&Results, &str) -> String) -> Result<()> {
        if let Some(folder) = self.folder {
            let text = summary(&outcome.results, &self.place.display().to_string());
            output::write(&folder, &outcome.results, &text)?;
            folder.finish()?;
            super::tell(&text)?;
        }
        outcome.error.map_or(Ok(()), Err)
    }

    /// What a sweep is doing, for a person who waits.
    pub fn say(&self, event: &Event) {
        self.progress.say(match event {
            Event::Newton(label, i, it) => {
                format!("{label}: iteration {i}, residual {:.1e}, {} closed", it.residual, it.counts.closed())
            }
            Event::Modes(converged, wanted, solves) => {
                format!("modes: {converged} of {wanted} eigenvalues, {solves} solves")
            }
        });
    }
}

impl Walk<'_, '_> {
    /// Finds the equilibrium at a friction; `each` makes of it what the command is for. Pictures are of the frictions asked for. Gives the
    /// snapshot that was found. Collective.
    pub fn visit(&mut self, friction: f64, each: impl FnOnce(Visit) -> Result<Found>) -> Result<Option<Snapshot>> {
        let (study, system, start) = (self.study, self.system, Instant::now());
        let asked = study.frictions().contains(&friction);
        if !asked {
            study.progress.lengthen();
        }
        let equilibrium = match self.sweep.equilibrium(friction, &mut |event| study.say(&event)) {
            Ok(equilibrium) => equilibrium,
            Err(error) => return Err(self.give_up(friction, error)?),
        };
        let Told { pairs, checks } =
            study.subject.tell(study.folder.as_ref().filter(|_| asked), system, &equilibrium)?;
        let (sweep, motion) = (&mut self.sweep, &mut *self.motion);
        let found = each(Visit { study, system, sweep, motion, equilibrium: &equilibrium, asked })?;
        let (pressure, status) = study.subject.contact_fields(&equilibrium.responses);
        let Found { modes, count, snapshot } = found;
        let (steps, seconds) = (equilibrium.steps, start.elapsed().as_secs_f64());
        let value = Value { friction, asked, pairs, checks, steps, pressure, status, modes, count, seconds };
        study.progress.advance(&done(&value));
        self.results.values.push(value);
        Ok(snapshot)
    }

    /// Keeps the steps towards an equilibrium that was not reached and the state in which they ended, and says where that is.
    fn give_up(&mut self, friction: f64, error: Error) -> Result<Error> {
        let steps = self.sweep.path().steps().to_vec();
        self.results.failure = Some(Failure { friction: Some(friction), steps, ..Failure::default() });
        let (Error::NotConverged(reason), Some(u)) = (&error, self.sweep.path().last()) else { return Ok(error) };
        let study = self.study;
        let name = study.subject.draw_last(study.folder.as_ref(), self.system, u)?;
        let file = study.place.join(name);
        Ok(Error::NotConverged(format!("{reason}. The last state is in {}", file.display())))
    }
}

/// A finished friction in a few words.
fn done(value: &Value) -> String {
    let found = match value.count {
        Some(_) => {
            let n_unstable = value.modes.iter().filter(|mode| mode.unstable).count();
            format!("{} modes, {n_unstable} unstable", value.modes.len())
        }
        None => "equilibrium".into(),
    };
    format!("friction {:.4}: {found}", value.friction)
}

/// What the run cost: seconds of its stages, and each factor.
fn costs_text(costs: &Costs, seconds: f64, ranks: usize) -> String {
    let mut text = format!(
        "{seconds:.1} s on {ranks} rank{}: equilibria {:.1} s, modes {:.1} s, left vectors {:.1} s; {} iterations with a neighbour's factor\n",
        if ranks == 1 { "" } else { "s" },
        costs.equilibria_seconds,
        costs.modes_seconds,
        costs.left_seconds,
        costs.n_iterations
    );
    let factors = [("LU", costs.lu), ("LDL^T", costs.symmetric)];
    for (name, cost) in factors.iter().filter(|(_, cost)| cost.n_factorisations > 0) {
        text += &format!(
            "{name}: {} analysis {:.1} s, {} factorisations {:.1} s, {} solves of {} right-hand sides {:.1} s; {:.0} M entries, \
             {:.0} MB of {:.0} MB estimated{}, ordering {}\n",
            cost.n_analyses,
            cost.analysis_seconds,
            cost.n_factorisations,
            cost.factorisation_seconds,
            cost.n_solves,
            cost.n_right_hand_sides,
            cost.solve_seconds,
            1e-6 * cost.entries,
            cost.used_mb,
            cost.estimated_mb,
            if cost.out_of_core { ", out of core" } else { "" },
            cost.ordering_name()
        );
    }
    text
}
