//! What the computing commands share: a brake, its frictions, a results folder, and one equilibrium after the other.

use std::path::PathBuf;

use crate::assembly::System;
use crate::contact::Pair;
use crate::equilibrium::{Equilibrium, Step};
use crate::petsc::Comm;
use crate::report::folder::Folder;
use crate::report::tables::{self, PairRow};
use crate::sweep::{Costs, Event, Sweep};
use crate::{Error, Result};

use super::Run;
use super::progress::Progress;
use super::results;
use super::subject::{self, Subject, Told};

/// A brake about to be analysed over friction.
pub struct Study {
    pub subject: Box<dyn Subject>,
    pub folder: Option<Folder>,
    pub place: PathBuf,
    /// The values asked for.
    pub frictions: Vec<f64>,
    progress: Progress,
}

/// A study under way.
pub struct Walk<'w, 's> {
    pub study: &'w Study,
    pub system: &'s System,
    sweep: Sweep<'s>,
    record: Record,
}

impl Walk<'_, '_> {
    /// Finds the equilibrium at a friction; `each` makes of it what the command is for, and says in a few words what it found.
    /// Tables and pictures are of the frictions asked for. Collective.
    pub fn visit(&mut self, friction: f64, each: impl FnOnce(Visit) -> Result<String>) -> Result<()> {
        let study = self.study;
        let asked = study.frictions.contains(&friction);
        if !asked {
            study.progress.lengthen();
        }
        let mut equilibrium = match self.sweep.equilibrium(friction, &mut |event| study.say(&event)) {
            Ok(equilibrium) => equilibrium,
            Err(error) => {
                self.record.add_steps(friction, self.sweep.path().steps());
                return Err(study.save_last(error, self.system, &self.sweep)?);
            }
        };
        self.record.add(study, self.system, &mut equilibrium, asked)?;
        let (system, equilibrium) = (self.system, &equilibrium);
        let (sweep, text) = (&mut self.sweep, &mut self.record.text);
        let done = each(Visit { study, system, sweep, equilibrium, text })?;
        study.progress.advance(&format!("friction {friction:.4}: {done}"));
        Ok(())
    }
}

/// One friction of a study, its equilibrium found.
pub struct Visit<'v, 's> {
    pub study: &'v Study,
    pub system: &'v System,
    pub sweep: &'v mut Sweep<'s>,
    pub equilibrium: &'v Equilibrium,
    /// The report in words, to be added to.
    pub text: &'v mut String,
}

/// How a study ended.
pub struct Outcome {
    pub record: Record,
    pub costs: Costs,
    /// Why it went no further, after the frictions in the record.
    pub failure: Option<Error>,
}

impl Study {
    /// Reads and checks everything before anything is computed. Collective.
    pub fn new(comm: &Comm, run: &Run, command: &str) -> Result<Study> {
        let subject = subject::read(comm, run)?;
        let frictions = subject.frictions(run.friction.as_ref().map(|list| list.0.as_slice()))?;
        let folder = results::folder(comm, run, command)?;
        let progress = Progress::new(comm, frictions.len(), run.verbose);
        Ok(Study { subject, folder, place: run.folder(command), frictions, progress })
    }

    /// Does the work of a command, which visits one friction after the other. Where that does not converge, what was found is kept.
    /// Collective.
    pub fn run(&self, comm: &Comm, work: impl FnOnce(&mut Walk) -> Result<()>) -> Result<Outcome> {
        self.progress.say("assembling");
        let system = self.subject.assemble(comm)?;
        let mut sweep = Sweep::new(&system, self.subject.interface())?;
        sweep.friction_damping = self.subject.friction_damping();
        let mut walk = Walk { study: self, system: &system, sweep, record: Record::default() };
        let failure = match work(&mut walk) {
            Ok(()) => None,
            Err(error @ Error::NotConverged(_)) => Some(error),
            Err(error) => return Err(error),
        };
        self.progress.finish();
        Ok(Outcome { record: walk.record, costs: walk.sweep.costs(), failure })
    }

    /// Writes the tables and the summary, gives the folder its name, and tells the summary.
    pub fn finish(self, outcome: Outcome, summary: &str) -> Result<()> {
        if let Some(folder) = self.folder {
            outcome.record.write(&folder)?;
            results::write_summary(&folder, summary, outcome.failure.as_ref())?;
            folder.finish()?;
            super::tell(summary)?;
        }
        outcome.failure.map_or(Ok(()), Err)
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

    /// Keeps the state in which a solve gave up, and says where.
    fn save_last(&self, error: Error, system: &System, sweep: &Sweep) -> Result<Error> {
        let (Error::NotConverged(reason), Some(u)) = (&error, sweep.path().last()) else { return Err(error) };
        let folder = self.folder.as_ref();
        let name = self.subject.draw_last(folder, system, u)?;
        let file = self.place.join(name);
        let place = file.display();
        Ok(Error::NotConverged(format!("{reason}. The last state is in {place}")))
    }
}

/// What the equilibria of a run leave behind: the report in words, and rows of the tables.
#[derive(Default)]
pub struct Record {
    pub text: String,
    rows: Vec<PairRow>,
    steps: Vec<(f64, Step)>,
}

impl Record {
    /// Reports an equilibrium, whose steps it takes; rows and pictures are of the frictions asked for. Collective.
    fn add(&mut self, study: &Study, system: &System, equilibrium: &mut Equilibrium, asked: bool) -> Result<()> {
        let (subject, friction) = (&study.subject, equilibrium.friction);
        let told = subject.tell(study.folder.as_ref().filter(|_| asked), system, equilibrium)?;
        let pairs = &subject.interface().pairs;
        self.text += &equilibrium_text(friction, pairs, &told, &equilibrium.steps);
        if asked {
            let rows = pairs.iter().zip(told.pairs);
            self.rows.extend(rows.map(|(pair, forces)| PairRow { friction, pair: pair.name.clone(), forces }));
        }
        self.steps.extend(equilibrium.steps.drain(..).map(|step| (friction, step)));
        Ok(())
    }

    /// Keeps the steps towards an equilibrium that was not reached.
    fn add_steps(&mut self, friction: f64, steps: &[Step]) {
        self.steps.extend(steps.iter().map(|step| (friction, step.clone())));
    }

    /// Writes the tables.
    fn write(&self, folder: &Folder) -> Result<()> {
        results::csv_table(folder, "contact.csv", |out| tables::pairs(out, &self.rows))?;
        results::csv_table(folder, "convergence.csv", |out| tables::convergence(out, &self.steps))
    }
}

/// The report of one equilibrium.
fn equilibrium_text(friction: f64, pairs: &[Pair], told: &Told, steps: &[Step]) -> String {
    let mut text = format!("\nfriction {friction:.3}\n");
    for step in steps {
        let last = step.iterations.last().expect("a step has its start");
        text += &format!(
            "  {}: {} iterations, residual {:.1e}, {} open, {} sticking, {} slipping\n",
            step.label,
            step.iterations.len() - 1,
            last.residual,
            last.counts.open,
            last.counts.stick,
            last.counts.slip
        );
    }
    let width = pairs.iter().map(|pair| pair.name.len()).max().unwrap_or(4).max(4);
    text += &format!(
        "  {:width$}  {:>6} {:>6} {:>6}  {:>12} {:>14} {:>10}\n",
        "pair", "open", "stick", "slip", "normal N", "tangential N", "peak MPa"
    );
    for (pair, forces) in pairs.iter().zip(&told.pairs) {
        let counts = forces.counts;
        text += &format!(
            "  {:width$}  {:>6} {:>6} {:>6}  {:>12.2} {:>14.2} {:>10.3}\n",
            pair.name,
            counts.open,
            counts.stick,
            counts.slip,
            forces.normal,
            forces.tangential,
            1e-6 * forces.peak_pressure
        );
    }
    let checks: Vec<String> = told.checks.lines().map(|line| format!("  {line}\n")).collect();
    text + &checks.concat()
}
