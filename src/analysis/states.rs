//! One brake in named states: each is the model with other numbers, or worn, with a sweep of its own.

use std::path::PathBuf;
use std::time::Instant;

use crate::explore::{State, StateWear, States};
use crate::hdf::is_hdf5;
use crate::native::Comm;
use crate::output::columns::write_csv;
use crate::output::files::write_file;
use crate::output::json;
use crate::output::results_folder::RESULTS;
use crate::output::wear::GAPS;
use crate::results::{Failure, Results, Wear, file};
use crate::structure::{FullModel, ModelVariants, Structure};
use crate::{Error, Result};

use super::observer::{Event, Observer};
use super::record::{Done, Record};
use super::stability::{StabilityOptions, stability};
use super::start::Output;
use super::wear::{WearGoal, WearOptions, require_wear};

/// The end of the name of a state's wear.
const WEAR: &str = "wear.json";

/// What was found in a state.
#[derive(Debug, Clone)]
pub struct StateResults {
    /// Its name.
    pub name: String,
    /// Name of its folder.
    pub folder: String,
    /// Wear before its modes were found, where there was any.
    pub wear: Option<Wear>,
    /// Its sweep.
    pub results: Results,
}

/// What [`states`] is asked for beside the file of states.
#[derive(Debug, Clone, Default)]
pub struct StatesOptions {
    /// Folder of the study.
    pub folder: PathBuf,
    /// How the study was started, for the results.
    pub command: String,
    /// What the numbers depend on beside models and states, such as options for PETSc.
    pub identity: String,
}

/// Finds the modes of a brake in each of its states. Each state has a results folder below that of the study, from
/// which an interrupted sweep continues; a study that is run again makes only what is missing or out of date. Only the
/// root gets the results. Collective.
///
/// # Errors
/// [`Error::Input`] for a model, state or folder that cannot be used; those of [`stability`] and
/// [`wear`](super::wear()).
pub fn states(
    comm: &Comm,
    states: &States,
    options: &StatesOptions,
    observer: &mut dyn Observer,
) -> Result<Option<Vec<StateResults>>> {
    if is_hdf5(&states.model) {
        let what = "a super-element has no states";
        return Err(Error::input(format!("{}: {what}. Name its model", states.file.display())));
    }
    let mut record = comm.agree(if comm.is_root() { Record::open(&options.folder) } else { Ok(Record::default()) })?;
    let variants = ModelVariants::read(comm, &states.model)?;
    let study = Study { comm, states, variants: &variants, options };
    // All states are checked before the first is analysed.
    let identities = states.states.iter().map(|state| study.identity(state)).collect::<Result<Vec<_>>>()?;
    for (state, identity) in states.states.iter().zip(identities) {
        let file = study.place(state).join(RESULTS);
        let is_made = comm.broadcast_value(0, comm.is_root() && record.has(&state.folder(), &identity, &file));
        observer.event(Event::Part { name: &state.name, is_made });
        if !is_made {
            let start = Instant::now();
            study.analyse(state, &identity, observer)?;
            let seconds = start.elapsed().as_secs_f64();
            record.parts.insert(state.folder(), Done { identity, seconds });
            comm.agree(if comm.is_root() { record.write(&options.folder) } else { Ok(()) })?;
        }
    }
    let read = || states.states.iter().map(|state| study.read(state)).collect::<Result<Vec<_>>>();
    comm.agree(if comm.is_root() { read().map(Some) } else { Ok(None) })
}

/// A study under way.
struct Study<'a> {
    comm: &'a Comm,
    states: &'a States,
    variants: &'a ModelVariants,
    options: &'a StatesOptions,
}

impl Study<'_> {
    /// Folder of a state's results.
    fn place(&self, state: &State) -> PathBuf {
        self.options.folder.join(state.folder())
    }

    /// A file of a state beside its folder.
    fn beside(&self, state: &State, what: &str) -> PathBuf {
        self.options.folder.join(format!("{}-{what}", state.folder()))
    }

    /// The brake in a state, before any wear. Collective.
    fn brake(&self, state: &State) -> Result<FullModel> {
        let (comm, variants) = (self.comm, self.variants);
        let wearing = variants.model.contacts.iter().filter(|own| own.wear.is_some());
        let wearing: Vec<String> = wearing.map(|own| own.name.clone()).collect();
        let worn = if wearing.is_empty() { &variants.swept } else { &wearing };
        let text = comm.agree(state.text(&variants.text, worn))?;
        let of_state = |error: Error| match error {
            Error::Input(what) => Error::input(format!("state {:?}: {what}", state.name)),
            other => other,
        };
        let full = variants.brake(comm, &text, None).map_err(of_state)?;
        full.require_mass()?;
        match state.wear {
            Some(_) => require_wear(&full).map_err(of_state).map(|()| full),
            None => Ok(full),
        }
    }

    /// All that the numbers of a state depend on. Collective.
    fn identity(&self, state: &State) -> Result<String> {
        let [model, mesh] = self.brake(state)?.digests(self.comm)?;
        let States { friction_values, band, .. } = self.states;
        let (program, more) = (env!("CARGO_PKG_VERSION"), &self.options.identity);
        Ok(format!("squeal {program} {more}, model {model}, mesh {mesh}, {friction_values:?} {band:?} {state:?}"))
    }

    /// Wears a state where it is to be worn, and finds its modes. Collective.
    fn analyse(&self, state: &State, identity: &str, observer: &mut dyn Observer) -> Result<()> {
        let (comm, mut brake) = (self.comm, Structure::Full(Box::new(self.brake(state)?)));
        if let Some(wear) = state.wear {
            let goal = match wear {
                StateWear::Distance(distance, n_steps) => WearGoal::Distance { distance, n_steps },
                StateWear::Uniform(tolerance) => WearGoal::Uniform { tolerance },
            };
            let worn = super::wear(comm, &mut brake, &WearOptions { friction: None, goal, output: None }, observer)?;
            comm.agree(if comm.is_root() { self.write_wear(state, &worn) } else { Ok(()) })?;
        }
        let output = Output {
            folder: self.place(state),
            force: true,
            command: self.options.command.clone(),
            identity: vec![("state", identity.to_owned())],
        };
        let options = StabilityOptions {
            friction_values: self.states.friction_values.clone(),
            band: self.states.band,
            output: Some(output),
            ..StabilityOptions::default()
        };
        let results = stability(comm, &brake, &options, observer)?;
        let failed =
            |failure: Failure| Err(Error::not_converged(format!("state {:?}: {}", state.name, failure.reason)));
        comm.agree(results.failure.map_or(Ok(()), failed))
    }

    /// Writes the wear of a state beside its folder. Not collective.
    fn write_wear(&self, state: &State, worn: &Wear) -> Result<()> {
        write_file(&self.beside(state, GAPS), |out| write_csv(out, worn.points.iter().cloned()))?;
        write_file(&self.beside(state, WEAR), |out| out.write_all(json::text(worn).as_bytes()))
    }

    /// What was found in a state. Not collective.
    fn read(&self, state: &State) -> Result<StateResults> {
        let wear = match state.wear {
            None => None,
            Some(_) => {
                let file = self.beside(state, WEAR);
                let text = std::fs::read_to_string(&file).map_err(Error::io(&file))?;
                let damaged = |reason| Error::input(format!("{} is damaged: {reason}. Remove it", file.display()));
                Some(serde_json::from_str(&text).map_err(damaged)?)
            }
        };
        let results = file::read(&self.place(state).join(RESULTS))?;
        Ok(StateResults { name: state.name.clone(), folder: state.folder(), wear, results })
    }
}
