//! What wear needs to continue after its process has ended, at whatever moment.
//!
//! ```text
//! .NAME.unfinished/.resume/
//!   study.txt             what the numbers depend on
//!   step-0003.bin         a finished step: what is worn off
//!   state-0003.RANK.bin   the state at its end; that before any wear (0) stays, others go with the next one
//! ```
//!
//! Numbers are kept bit by bit, so that wear that was interrupted ends with the same files.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::Result;
use crate::analysis::start::Output;
use crate::analysis::unfinished::{Unfinished, read_binary, write_binary};
use crate::hdf::Format;
use crate::native::Comm;
use crate::output::folder::Folder;
use crate::results::WearStep;

use super::brake::State;

const FORMAT: Format = Format { name: "squeal wear", version: 1, advice: "Begin again with --force" };

/// What wear finishes one by one, the one before any wear among them.
pub const UNIT: &str = "equilibria";

/// A finished step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FinishedStep {
    /// What is worn off at its end.
    pub worn: WearStep,
    /// How much it has changed `p v`, of its norm; infinite before any wear.
    pub change: f64,
}

/// The finished steps, and their files where there is a folder.
pub struct Checkpoint {
    comm: Comm,
    place: Option<PathBuf>,
    /// The state before any wear first.
    pub steps: Vec<FinishedStep>,
}

impl Checkpoint {
    /// The steps that an earlier run has finished; the root has the folder. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Input`] where other wear was begun, or files are damaged; the system's.
    pub fn open(
        comm: &Comm,
        folder: Option<&Folder>,
        output: Option<&Output>,
        identity: &[(&str, String)],
    ) -> Result<Checkpoint> {
        let Some(Output { folder: target, force, .. }) = output else {
            return Ok(Checkpoint { comm: comm.clone(), place: None, steps: Vec::new() });
        };
        let read = |place: &Path, i: usize| read_binary::<FinishedStep>(&place.join(step_name(i)), &FORMAT);
        let check = |place: &Path, n: usize| {
            (0..n).try_for_each(|i| read(place, i).map(|_| ()))?;
            [0, n - 1].into_iter().try_for_each(|i| read_state(place, i, comm).map(|_| ()))
        };
        let wear = Unfinished { target, identity, name: step_name, unit: UNIT };
        let (place, n) = wear.open(comm, folder, *force, check)?;
        let steps = comm.agree((0..n).map(|i| read(&place, i)).collect())?;
        Ok(Checkpoint { comm: comm.clone(), place: Some(place), steps })
    }

    /// The states before any wear and after the last step, where an earlier run has finished some. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Input`] where a file is damaged; the system's.
    pub fn states(&self) -> Result<Option<[State; 2]>> {
        let (Some(place), Some(last)) = (&self.place, self.steps.len().checked_sub(1)) else { return Ok(None) };
        let state = |number| self.comm.agree(read_state(place, number, &self.comm));
        Ok(Some([state(0)?, state(last)?]))
    }

    /// Keeps a finished step with the state at its end, and gives it. Collective.
    ///
    /// # Errors
    /// The system's, with the path.
    pub fn commit(&mut self, step: FinishedStep, state: &State) -> Result<&FinishedStep> {
        let number = self.steps.len();
        if let Some(place) = &self.place {
            self.comm.agree(write_binary(&place.join(state_name(number, &self.comm)), state))?;
            let file = place.join(step_name(number));
            self.comm.agree(if self.comm.is_root() { write_binary(&file, &step) } else { Ok(()) })?;
            if number > 1 {
                // Best effort: it is needed no more.
                let _ = std::fs::remove_file(place.join(state_name(number - 1, &self.comm)));
            }
        }
        self.steps.push(step);
        Ok(&self.steps[number])
    }
}

fn step_name(number: usize) -> String {
    format!("step-{number:04}.bin")
}

fn state_name(number: usize, comm: &Comm) -> String {
    format!("state-{number:04}.{}.bin", comm.rank())
}

fn read_state(place: &Path, number: usize, comm: &Comm) -> Result<State> {
    read_binary(&place.join(state_name(number, comm)), &FORMAT)
}
