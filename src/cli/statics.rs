//! `squeal static`: equilibria.

use crate::assembly::System;
use crate::equilibrium::{Equilibrium, Step};
use crate::petsc::Comm;
use crate::report::folder::Folder;
use crate::report::tables::{self, PairRow};
use crate::sweep::{Brake, Event, Families, Sweep};
use crate::{Error, Result};

use super::Run;
use super::progress::Progress;
use super::results::{self, State};

pub fn run(comm: &Comm, run: &Run) -> Result<()> {
    let brake = Brake::read(comm, &run.model)?;
    brake.require_held()?;
    let frictions = brake.frictions(run.friction.as_ref().map(|list| list.0.as_slice()))?;
    let folder = results::folder(comm, run, "static")?;
    let progress = Progress::new(comm, frictions.len(), run.verbose);
    progress.say("assembling");
    let families = brake.families()?;
    let system = brake.assemble(comm, &families)?;
    let mut sweep = Sweep::new(&system, &brake.interface)?;
    let mut record = Record { text: format!("{}\n", brake.model.title), ..Record::default() };
    let mut failure = None;
    for &friction in &frictions {
        let outcome = sweep.equilibrium(friction, &mut |event| say(&progress, &event));
        let mut equilibrium = match outcome {
            Ok(equilibrium) => equilibrium,
            Err(error) => {
                record.add_steps(friction, sweep.path().steps());
                failure = Some(save_last(error, comm, &brake, &system, &sweep, folder.as_ref())?);
                break;
            }
        };
        record.add(&brake, &families, &system, &mut equilibrium, folder.as_ref())?;
        progress.advance(&format!("friction {friction:.3}: equilibrium"));
    }
    progress.finish();
    if let Some(folder) = folder {
        record.write(&folder)?;
        let summary = format!("{}results in {}\n", record.text, run.folder("static").display());
        results::write_summary(&folder, &summary, failure.as_ref())?;
        folder.finish()?;
        super::tell(&summary)?;
    }
    failure.map_or(Ok(()), Err)
}

/// What the equilibria of a run leave behind: the report in words, and rows of the tables.
#[derive(Default)]
pub struct Record {
    pub text: String,
    rows: Vec<PairRow>,
    steps: Vec<(f64, Step)>,
}

impl Record {
    /// Reports an equilibrium, whose steps it takes, and draws it. Collective.
    pub fn add(
        &mut self,
        brake: &Brake,
        families: &Families,
        system: &System,
        equilibrium: &mut Equilibrium,
        folder: Option<&Folder>,
    ) -> Result<()> {
        let state = State::new(brake, families, system, equilibrium)?;
        self.text += &equilibrium_text(brake, &state, &equilibrium.steps);
        self.rows.extend(state.pair_rows(brake));
        self.steps.extend(equilibrium.steps.drain(..).map(|step| (state.friction, step)));
        folder.map_or(Ok(()), |folder| state.write(folder, brake, &equilibrium.responses))
    }

    /// Keeps the steps towards an equilibrium that was not reached.
    pub fn add_steps(&mut self, friction: f64, steps: &[Step]) {
        self.steps.extend(steps.iter().map(|step| (friction, step.clone())));
    }

    /// Writes the tables.
    pub fn write(&self, folder: &Folder) -> Result<()> {
        results::csv_table(folder, "contact.csv", |out| tables::pairs(out, &self.rows))?;
        results::csv_table(folder, "convergence.csv", |out| tables::convergence(out, &self.steps))
    }
}

/// What a sweep is doing, for a person who waits.
pub fn say(progress: &Progress, event: &Event) {
    match event {
        Event::Newton(label, i, it) => {
            progress.say(format!(
                "{label}: iteration {i}, residual {:.1e}, {} closed",
                it.residual,
                it.counts.closed()
            ));
        }
        Event::Modes(converged, wanted, solves) => {
            progress.say(format!("modes: {converged} of {wanted} eigenvalues, {solves} solves"));
        }
    }
}

/// The report of one equilibrium.
fn equilibrium_text(brake: &Brake, state: &State, steps: &[Step]) -> String {
    let mut text = format!("\nfriction {:.3}\n", state.friction);
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
    let width = brake.interface.pairs.iter().map(|pair| pair.name.len()).max().unwrap_or(4).max(4);
    text += &format!(
        "  {:width$}  {:>6} {:>6} {:>6}  {:>12} {:>14} {:>10}\n",
        "pair", "open", "stick", "slip", "normal N", "tangential N", "peak MPa"
    );
    for (pair, forces) in brake.interface.pairs.iter().zip(&state.balance.pairs) {
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
    let checks: Vec<String> = state.checks(brake).lines().map(|line| format!("  {line}\n")).collect();
    text + &checks.concat()
}

/// Keeps the state in which a solve gave up, and says where. Collective.
///
/// # Errors
/// Any other error as it came, and what went wrong in writing.
pub fn save_last(
    error: Error,
    comm: &Comm,
    brake: &Brake,
    system: &System,
    sweep: &Sweep,
    folder: Option<&Folder>,
) -> Result<Error> {
    let (Error::NotConverged(reason), Some(u)) = (&error, sweep.path().last()) else { return Err(error) };
    comm.agree(results::write_last(folder, brake, system, u))?;
    let place =
        folder.map_or_else(String::new, |folder| folder.target().join(results::LAST_STATE).display().to_string());
    Ok(Error::NotConverged(format!("{reason}. The last state is in {place}")))
}
