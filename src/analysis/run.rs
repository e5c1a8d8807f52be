//! One value of the friction coefficient after the other: equilibrium, what an analysis makes of it, results, resume.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::Instant;

use crate::assembly::System;
use crate::equilibrium::Equilibrium;
use crate::model::InstabilityCriterion;
use crate::native::Comm;
use crate::output::fields::FieldWriter;
use crate::output::folder::Folder;
use crate::output::{results_folder, text};
use crate::results::{About, Failure, ModeData, Results, Value};
use crate::stability::Count;
use crate::structure::{Structure, SurfaceMotion};
use crate::{Error, ErrorKind, Result};

use super::checkpoint::{Checkpoint, EarlierValue, UNIT};
use super::family::{Snapshot, Vectors};
use super::observer::{Event, Observer, stop_signal};
use super::start::{Earlier, Output, about, announce, identity, numbers, open_folder};
use super::sweep::Sweep;

/// An analysis over values of the friction coefficient.
pub(super) struct Job {
    /// Its name, that of the command.
    pub name: &'static str,
    /// Its options, as far as the numbers depend on them.
    pub options: String,
    /// Values of the friction coefficient.
    pub values: Vec<f64>,
    /// The band analysed, Hz.
    pub band: [f64; 2],
    /// What counts as an unstable mode.
    pub criterion: InstabilityCriterion,
    /// The results as text for people, given with the folder's name.
    pub summary: fn(&Results, &str) -> String,
}

/// A job under way.
pub(super) struct Run<'r> {
    pub structure: &'r Structure,
    pub system: &'r System,
    pub results: Results,
    pub observer: &'r mut dyn Observer,
    pub fields: FieldWriter<'r>,
    pub sweep: Sweep<'r>,
    pub motion: SurfaceMotion<'r>,
    place: Option<PathBuf>,
    checkpoint: Option<Checkpoint>,
    /// What an earlier run has finished and this one has not come to yet.
    earlier: VecDeque<EarlierValue>,
}

/// What an analysis makes of an equilibrium.
#[derive(Default)]
pub(super) struct ValueResult {
    pub modes: Vec<ModeData>,
    pub count: Option<Count>,
    /// Where modes are followed.
    pub snapshot: Option<Snapshot>,
}

/// Runs a job: opens the folder, assembles, does the work, writes. Where the work does not converge, what was found is
/// kept. Collective.
///
/// # Errors
/// Those of the work but [`Error::NotConverged`]; the system's.
pub(super) fn run(
    comm: &Comm,
    structure: &Structure,
    job: &Job,
    output: Option<&Output>,
    observer: &mut dyn Observer,
    work: impl FnOnce(&mut Run) -> Result<()>,
) -> Result<Results> {
    let start = Instant::now();
    let folder = open_folder(comm, output)?;
    let about = About {
        band: job.band,
        criterion: job.criterion,
        friction_values: job.values.clone(),
        ..about(comm, structure, output)?
    };
    let (checkpoint, earlier) = resume(comm, job, output, folder.as_ref(), &about)?;
    let n_earlier = earlier.len();
    let (place, done) = (output.map(|output| output.folder.as_path()), Earlier { n: n_earlier, unit: UNIT });
    announce(&about, job.values.len(), place, done, observer);
    observer.event(Event::Stage("assembling"));
    let (system, prestress) = (structure.assemble(comm)?, structure.prestress()?);
    let motion = structure.surface_motion(&system)?;
    let results = Results {
        about: About { n_dofs: system.dofs.n_global(), ..about },
        surface: motion.surface().clone(),
        contact: structure.contact_faces(),
        ..Results::default()
    };
    let sweep = Sweep::of(structure, &system, prestress.as_ref())?;
    let fields = FieldWriter { structure, system: &system, folder: folder.as_ref() };
    let place = output.map(|output| output.folder.clone());
    let mut run =
        Run { structure, system: &system, results, observer, fields, sweep, motion, place, checkpoint, earlier };
    let outcome = work(&mut run);
    let (costs, mut results) = (run.sweep.costs(), run.results);
    results.costs = costs.text(start.elapsed().as_secs_f64(), comm.size());
    if n_earlier > 0 {
        results.costs += &format!("without {n_earlier} values that an earlier run has found\n");
    }
    keep_failure(outcome, &mut results)?;
    comm.agree(folder.map_or(Ok(()), |folder| write(folder, job, &results)))?;
    Ok(results)
}

/// Writes the results and ends the folder.
fn write(folder: Folder, job: &Job, results: &Results) -> Result<()> {
    let place = folder.place().display().to_string();
    results_folder::write(&folder, results, &(job.summary)(results, &place))?;
    folder.finish()
}

/// The files from which the analysis can go on, and the values that an earlier run has finished. Collective.
fn resume(
    comm: &Comm,
    job: &Job,
    output: Option<&Output>,
    folder: Option<&Folder>,
    about: &About,
) -> Result<(Option<Checkpoint>, VecDeque<EarlierValue>)> {
    let Some(output) = output else { return Ok((None, VecDeque::new())) };
    let identity = sweep_identity(job, output, about);
    let (checkpoint, earlier) = Checkpoint::open(comm, folder, &output.folder, &identity, output.force)?;
    Ok((Some(checkpoint), earlier))
}

/// A value that did not converge ends the analysis with what was found; any other error ends it with nothing.
fn keep_failure(outcome: Result<()>, results: &mut Results) -> Result<()> {
    match outcome {
        Err(error) if error.kind() == ErrorKind::NotConverged => {
            results.failure.get_or_insert_default().reason = error.to_string();
            Ok(())
        }
        outcome => outcome,
    }
}

/// All that the numbers of a sweep depend on, by name.
fn sweep_identity(job: &Job, output: &Output, about: &About) -> Vec<(&'static str, String)> {
    let own = [
        ("friction values", numbers(&job.values)),
        ("band", numbers(&job.band)),
        ("unstable", job.criterion.to_string()),
    ];
    identity(format!("{}{}", job.name, job.options), own, Some(output), about)
}

impl Run<'_> {
    /// The values asked for.
    pub fn values(&self) -> Vec<f64> {
        self.results.about.friction_values.clone()
    }

    /// Whether a value is one of those asked for, whose fields are written and whose modes are drawn and explained.
    pub fn is_asked(&self, friction: f64) -> bool {
        self.results.about.friction_values.contains(&friction)
    }

    /// Visits the values asked for, one by one.
    pub fn each(&mut self, find: fn(&mut Self, &Equilibrium) -> Result<ValueResult>) -> Result<()> {
        self.values().into_iter().try_for_each(|friction| self.visit(friction, find).map(|_| ()))
    }

    /// Finds the equilibrium at a value; `find` makes of it what the analysis is for. Gives the snapshot that was made.
    /// Collective.
    pub fn visit(
        &mut self,
        friction: f64,
        find: impl FnOnce(&mut Self, &Equilibrium) -> Result<ValueResult>,
    ) -> Result<Option<Snapshot>> {
        if let Some(earlier) = self.earlier.pop_front() {
            return self.replay(friction, earlier);
        }
        let start = Instant::now();
        let asked = self.is_asked(friction);
        if !asked {
            self.observer.event(Event::Inserted);
        }
        let equilibrium = match self.sweep.equilibrium(friction, self.observer) {
            Ok(equilibrium) => equilibrium,
            Err(error) => return Err(self.give_up(friction, error)?),
        };
        let checks = self.structure.check_equilibrium(self.system, &equilibrium)?;
        if !self.results.about.has_contact(&checks.pairs) {
            let what = format!(
                "no sliding contact carries a force at friction {}: the loads close none",
                text::friction(friction)
            );
            self.observer.event(Event::Warning(&what));
        }
        if asked {
            self.fields.equilibrium(&equilibrium)?;
        }
        let ValueResult { modes, count, mut snapshot } = find(self, &equilibrium)?;
        let (pressure, status) = self.structure.contact_fields(&equilibrium.responses);
        let (pairs, checks, steps) = (checks.pairs, checks.text, equilibrium.steps);
        let value = Value { friction, asked, pairs, checks, steps, pressure, status, modes, count, ..Value::default() };
        let value = Value { seconds: start.elapsed().as_secs_f64(), ..value };
        if let Some(checkpoint) = &mut self.checkpoint {
            checkpoint.commit(&value, &self.sweep, snapshot.as_mut())?;
            self.fields.folder.into_iter().for_each(Folder::keep);
        }
        self.observer.event(Event::Finished(&value));
        self.results.values.push(value);
        self.stop_if_asked(friction)?;
        Ok(snapshot)
    }

    /// Takes a value as an earlier run has left it; after the last of them the path goes on from there.
    fn replay(&mut self, friction: f64, mut earlier: EarlierValue) -> Result<Option<Snapshot>> {
        let checkpoint = self.checkpoint.as_mut().expect("earlier values come from a checkpoint");
        let snapshot = checkpoint.replay(&mut earlier);
        let value = earlier.value;
        if value.friction.to_bits() != friction.to_bits() {
            let place = self.place.clone().unwrap_or_default();
            return Err(Error::input(format!(
                "{} is unfinished, and has friction coefficient {} where {friction} is due. Use --force to begin again",
                place.display(),
                value.friction
            )));
        }
        self.observer.event(Event::Replayed(&value));
        if self.earlier.is_empty() {
            self.sweep.restore(checkpoint.path(&self.system.load)?, value.count.as_ref());
        }
        self.results.values.push(value);
        Ok(snapshot)
    }

    /// Ends the work where a signal has asked any rank for it. Collective.
    fn stop_if_asked(&mut self, friction: f64) -> Result<()> {
        let Some(signal) = stop_signal(self.system.k.comm(), self.observer) else { return Ok(()) };
        let n = self.results.values.len();
        let advice = self
            .place
            .as_deref()
            .map_or_else(String::new, |place| format!(". The same command goes on from there to {}", place.display()));
        let text = format!("stopped after friction coefficient {friction:.4}; {n} values are done{advice}");
        Err(Error::Interrupted { signal, text })
    }

    /// The vectors of a snapshot of an earlier run. Collective.
    pub fn vectors(&mut self, number: usize) -> Result<Vectors> {
        let checkpoint = self.checkpoint.as_ref().expect("only snapshots of a checkpoint lack their vectors");
        let ([right, left], u) = checkpoint.vectors(number)?;
        let c = self.sweep.damping_at(self.results.values[number].friction, &u)?;
        Ok(Vectors { right, left, c, m: None })
    }

    /// The files from which the analysis can go on.
    pub fn checkpoint(&self) -> Option<&Checkpoint> {
        self.checkpoint.as_ref()
    }

    /// Keeps the steps towards an equilibrium that was not reached, writes the state in which they ended, and says
    /// where that is.
    fn give_up(&mut self, friction: f64, error: Error) -> Result<Error> {
        let steps = self.sweep.path().steps().to_vec();
        self.results.failure = Some(Failure { friction: Some(friction), steps, ..Failure::default() });
        let (ErrorKind::NotConverged, Some(u), Some(place)) = (error.kind(), self.sweep.path().last(), &self.place)
        else {
            return Ok(error);
        };
        let file = place.join(self.fields.last_state(u)?);
        let what = format!("{error}. The last state is in {}", file.display());
        Ok(Error::NotConverged { what, history: error.history().to_vec() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(options: &str, values: &[f64]) -> Job {
        Job {
            name: "stability",
            options: options.into(),
            values: values.to_vec(),
            band: [0.0, 6000.0],
            criterion: InstabilityCriterion::default(),
            summary: |_, _| String::new(),
        }
    }

    #[test]
    fn an_analysis_goes_on_only_where_all_that_its_numbers_depend_on_is_the_same() {
        let (about, output) = (About { n_ranks: 1, ..About::default() }, Output::default());
        let first = sweep_identity(&job("", &[0.1, 0.2]), &output, &about);
        assert_eq!(first, sweep_identity(&job("", &[0.1, 0.2]), &output, &about));
        let petsc = Output { identity: vec![("options for PETSc", "-x".into())], ..Output::default() };
        for other in [
            sweep_identity(&job(" --no-branches", &[0.1, 0.2]), &output, &about),
            sweep_identity(&job("", &[0.1, 0.3]), &output, &about),
            sweep_identity(
                &Job { criterion: InstabilityCriterion::GrowthRate(5.0), ..job("", &[0.1, 0.2]) },
                &output,
                &about,
            ),
            sweep_identity(&Job { band: [0.0, 5000.0], ..job("", &[0.1, 0.2]) }, &output, &about),
            sweep_identity(&job("", &[0.1, 0.2]), &output, &About { n_ranks: 2, ..about.clone() }),
            sweep_identity(&job("", &[0.1, 0.2]), &output, &About { mesh_digest: "0".into(), ..about.clone() }),
            sweep_identity(&job("", &[0.1, 0.2]), &output, &About { model_digest: "0".into(), ..about.clone() }),
            sweep_identity(&job("", &[0.1, 0.2]), &petsc, &about),
        ] {
            assert_ne!(first, other);
        }
    }

    #[test]
    fn results_survive_a_value_that_does_not_converge_and_no_other_error() {
        let mut results = Results::default();
        keep_failure(Ok(()), &mut results).unwrap();
        assert_eq!(results.failure, None);
        keep_failure(Err(Error::not_converged("stagnates at 0.3")), &mut results).unwrap();
        assert_eq!(results.failure.as_ref().map(|failure| failure.reason.as_str()), Some("stagnates at 0.3"));
        assert!(keep_failure(Err(Error::input("no band")), &mut results).is_err());
    }
}
