//! What the computing commands share: a brake, its frictions, a results folder, and one equilibrium after the other. All that is found goes
//! into [`Results`], of which everything that is written is made.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::Instant;

use crate::assembly::System;
use crate::equilibrium::Equilibrium;
use crate::hdf::is_hdf5;
use crate::native::{Comm, libraries};
use crate::output::folder::Folder;
use crate::output::{json, results_folder};
use crate::results::{About, Failure, ModeData, Results, Value};
use crate::stability::Count;
use crate::sweep::{Costs, Event, Snapshot, Sweep, Vectors};
use crate::{Error, Result};

use super::checkpoint::{Checkpoint, Earlier};
use super::interrupt::Interrupt;
use super::motion::Motion;
use super::progress::Progress;
use super::subject::{self, Subject, Told};
use super::{Run, Shell};

/// A brake about to be analysed over friction.
pub struct Study {
    pub subject: Box<dyn Subject>,
    pub folder: Option<Folder>,
    pub about: About,
    place: PathBuf,
    /// All that the numbers depend on, by name.
    identity: Vec<(&'static str, String)>,
    force: bool,
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
    checkpoint: Checkpoint,
    /// What an earlier run has finished and this one has not come to yet.
    earlier: VecDeque<Earlier>,
    interrupt: Interrupt,
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

/// Has the work of a command done by all ranks, or, on a super-element, by the first alone: that has too few equations to be shared, and
/// all ranks end together. Collective.
///
/// # Errors
/// Those of the work.
pub fn shared(shell: &Shell, run: &Run, work: impl FnOnce(&Shell) -> Result<()>) -> Result<()> {
    let comm = shell.comm;
    let is_small = comm.from_root(&[f64::from(u8::from(is_hdf5(&run.model)))])[0] > 0.0;
    if comm.size() == 1 || !is_small {
        return work(shell);
    }
    let alone = comm.alone();
    comm.agree(if comm.is_root() { work(&Shell { comm: &alone, ..*shell }) } else { Ok(()) })
}

impl Study {
    /// Reads and checks everything before anything is computed; `band` gives the band (Hz) to analyse, `options` are those of the
    /// command that others do not have. Collective.
    pub fn new(
        shell: &Shell,
        run: &Run,
        (command, options): (&str, &str),
        band: impl FnOnce(&dyn Subject) -> Result<[f64; 2]>,
    ) -> Result<Study> {
        let (comm, start) = (shell.comm, Instant::now());
        let subject = subject::read(comm, run)?;
        let frictions = subject.frictions(run.friction.as_ref().map(|list| list.0.as_slice()))?;
        let band = band(&*subject)?;
        let place = run.folder(command);
        let folder = comm.agree(if comm.is_root() { Folder::open(&place, run.force).map(Some) } else { Ok(None) })?;
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
        let identity = vec![
            ("program", about.program.clone()),
            ("command", format!("{command}{options}{}", run.options())),
            ("options for PETSc", shell.petsc.join(" ")),
            ("frictions", numbers(&about.frictions)),
            ("band", numbers(&band)),
            ("SHA-256 of the model", about.model_digest.clone()),
            ("SHA-256 of the mesh", about.mesh_digest.clone()),
            ("number of ranks", comm.size().to_string()),
        ];
        Ok(Study { subject, folder, about, place, identity, force: run.force, progress, start })
    }

    /// The values asked for.
    pub fn frictions(&self) -> &[f64] {
        &self.about.frictions
    }

    /// Does the work of a command, which visits one friction after the other. Where that does not converge, what was found is kept.
    /// Collective.
    pub fn run(&self, comm: &Comm, work: impl FnOnce(&mut Walk) -> Result<()>) -> Result<Outcome> {
        let (checkpoint, earlier) =
            Checkpoint::open(comm, self.folder.as_ref(), &self.place, &self.identity, self.force)?;
        let n_earlier = earlier.len();
        self.tell_earlier(comm, n_earlier);
        let interrupt =
            Interrupt::listen(self.progress.teller("ending after this friction; a second signal ends at once"))?;
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
        let mut walk = Walk { study: self, system: &system, results, sweep, motion, checkpoint, earlier, interrupt };
        let outcome = work(&mut walk);
        self.progress.finish();
        let error = match outcome {
            Ok(()) => None,
            Err(error @ Error::NotConverged(_)) => Some(error),
            Err(error) => return Err(error),
        };
        let (costs, mut results) = (walk.sweep.costs(), walk.results);
        results.costs = costs_text(&costs, self.start.elapsed().as_secs_f64(), comm.size());
        if n_earlier > 0 {
            results.costs += &format!("without {n_earlier} frictions that an earlier run has found\n");
        }
        if let Some(error) = &error {
            results.failure.get_or_insert_default().reason = error.to_string();
        }
        Ok(Outcome { results, error })
    }

    /// Writes what was found, gives the folder its name, and tells the summary. Collective.
    pub fn finish(self, shell: &Shell, outcome: Outcome, summary: fn(&Results, &str) -> String) -> Result<()> {
        let Outcome { results, error } = outcome;
        let place = self.place.display().to_string();
        let text = summary(&results, &place);
        let written = self.folder.map_or(Ok(()), |folder| {
            results_folder::write(&folder, &results, &text)?;
            folder.finish()
        });
        shell.comm.agree(written)?;
        shell.tell(&text, || json::document(&results, &place))?;
        error.map_or(Ok(()), Err)
    }

    /// Tells what need not be done again.
    fn tell_earlier(&self, comm: &Comm, n: usize) {
        if n > 0 && comm.is_root() {
            eprintln!(
                "{}: an earlier run has finished {n} frictions, from where this one goes on",
                self.place.display()
            );
        }
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
        if let Some(earlier) = self.earlier.pop_front() {
            return self.replay(friction, earlier);
        }
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
        let Found { modes, count, mut snapshot } = found;
        let (steps, seconds) = (equilibrium.steps, start.elapsed().as_secs_f64());
        let value = Value { friction, asked, pairs, checks, steps, pressure, status, modes, count, seconds };
        self.checkpoint.commit(&value, &self.sweep, snapshot.as_mut())?;
        study.folder.as_ref().inspect(|folder| folder.keep());
        study.progress.advance(&done(&value));
        self.results.values.push(value);
        self.may_go_on(friction)?;
        Ok(snapshot)
    }

    /// Takes a friction as an earlier run has left it; after the last of them the path goes on from there.
    fn replay(&mut self, friction: f64, mut earlier: Earlier) -> Result<Option<Snapshot>> {
        let snapshot = self.checkpoint.replay(&mut earlier);
        let value = earlier.value;
        if value.friction.to_bits() != friction.to_bits() {
            let place = self.study.place.display();
            return Err(Error::input(format!(
                "{place} is unfinished, and friction {} stands in it where {friction} is due. Use --force to start anew",
                value.friction
            )));
        }
        self.study.progress.skip(value.asked);
        if self.earlier.is_empty() {
            self.sweep.restore(self.checkpoint.path(&self.system.load)?, value.count.as_ref());
        }
        self.results.values.push(value);
        Ok(snapshot)
    }

    /// Ends the work where a signal has asked for it.
    fn may_go_on(&self, friction: f64) -> Result<()> {
        let Some(signal) = self.interrupt.heard(self.system.k.comm()) else { return Ok(()) };
        let (n, place) = (self.checkpoint.n_done(), self.study.place.display());
        let text = format!(
            "stopped after friction {friction:.4}; {n} frictions are done. The same command goes on from there to {place}"
        );
        Err(Error::Interrupted { signal, text })
    }

    /// The vectors of a snapshot of an earlier run. Collective.
    pub fn vectors(&mut self, number: usize) -> Result<Vectors> {
        let ([right, left], u) = self.checkpoint.vectors(number)?;
        let c = self.sweep.damping_at(self.results.values[number].friction, &u)?;
        Ok(Vectors { right, left, c, m: None })
    }

    /// The files from which the study can go on.
    pub fn checkpoint(&self) -> &Checkpoint {
        &self.checkpoint
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

/// Numbers as people give them.
fn numbers(list: &[f64]) -> String {
    list.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
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
            "{name}{}: {} analysis {:.1} s, {} factorisations {:.1} s, {} solves of {} right-hand sides {:.1} s; {:.0} M entries, \
             {:.0} MB of {:.0} MB estimated{}, ordering {}\n",
            if cost.single { " in single precision" } else { "" },
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
