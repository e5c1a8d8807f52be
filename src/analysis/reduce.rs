//! From a model to a super-element's file.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::explore::Study;
use crate::native::Comm;
use crate::output::overwrite::{FileKind, may_write_file};
use crate::reduction::craig_bampton::Costs;
use crate::reduction::file;
use crate::reduction::made_for::MadeFor;
use crate::reduction::part_samples::{PartSamples, SampleReport};
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::SuperElement;
use crate::structure::FullModel;
use crate::{Error, Result};

use super::observer::{Event, Observer, warn};
use super::other_parts::OtherParts;
use super::sweep::Sweep;

/// Samples of other parts at most; fewer are taken where the last ones agree with the basis.
const MAX_SAMPLES: usize = 16;
/// What a reduction writes.
const SUPER_ELEMENT: FileKind = FileKind { name: "a super-element of squeal", is_one: file::is_super_element };

/// Where the super-element of a reduction goes.
pub(super) struct SuperElementPlace<'a> {
    /// The file.
    pub file: &'a Path,
    /// Whether an earlier super-element may be replaced.
    pub force: bool,
}

impl SuperElementPlace<'_> {
    /// Refuses what cannot be reduced, and a place that is taken, before anything is computed. Collective.
    ///
    /// # Errors
    /// [`Error::Input`].
    pub(super) fn begin(&self, comm: &Comm, model: &FullModel, observer: &mut dyn Observer) -> Result<()> {
        warn(comm, model, observer);
        model.require_constrained(comm)?;
        model.require_mass()?;
        model.require_no_prescribed()?;
        model.require_pair_laws()?;
        comm.agree(if comm.is_root() { self.may_write() } else { Ok(()) })
    }

    /// Writes the file, unless something has come to its place since, and reports samples that do not agree.
    /// Collective.
    ///
    /// # Errors
    /// [`Error::Input`], the system's.
    pub(super) fn write(
        &self,
        comm: &Comm,
        element: &SuperElement,
        surface: &OuterSurface,
        basis: Option<&[f32]>,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let warning = element.origin.made_for.as_ref().and_then(MadeFor::warning);
        warning.iter().for_each(|warning| observer.event(Event::Warning(warning)));
        let write = || self.may_write().and_then(|()| file::write(self.file, element, surface, basis));
        comm.agree(if comm.is_root() { write() } else { Ok(()) })
    }

    fn may_write(&self) -> Result<()> {
        may_write_file(self.file, &SUPER_ELEMENT, self.force)
    }
}

/// What [`reduce`] is asked for.
#[derive(Debug, Clone)]
pub struct ReduceOptions {
    /// Friction coefficient of the equilibrium about which the other contacts are linearised; the swept pairs' own
    /// where there is none.
    pub friction: Option<f64>,
    /// Fixed-interface modes are kept below this, Hz; the model's own limit where there is none.
    pub limit: Option<f64>,
    /// A study of many parameters, at whose moduli and densities the basis holds as well.
    pub for_study: Option<Study>,
    /// The super-element's file.
    pub file: PathBuf,
    /// Whether an earlier super-element may be replaced.
    pub force: bool,
}

/// A super-element, and what it cost.
pub struct Reduction {
    /// The super-element.
    pub element: SuperElement,
    /// Factor and solves of the reduction.
    pub costs: Costs,
    /// Reading, assembly and equilibrium, s.
    pub equilibrium_seconds: f64,
    /// All of it, s.
    pub seconds: f64,
}

/// Reduces a model with reference contacts ([`FullModel::reduce_contacts`]) about its equilibrium, and writes the
/// super-element's file. Collective.
///
/// # Errors
/// [`Error::Input`] where the file may not be replaced or a part can move freely; [`Error::NotConverged`]; PETSc's,
/// MUMPS's, the system's.
pub fn reduce(
    comm: &Comm,
    model: &FullModel,
    options: &ReduceOptions,
    observer: &mut dyn Observer,
) -> Result<Reduction> {
    let start = Instant::now();
    let place = SuperElementPlace { file: &options.file, force: options.force };
    place.begin(comm, model, observer)?;
    let friction = options.friction.map_or_else(|| model.own_friction(), Ok)?;
    let others = OtherParts::of(model, options.for_study.as_ref(), &options.file, observer)?;
    let limit = options.limit.unwrap_or_else(|| model.reduction_limit());
    observer.event(Event::Stage("assembling"));
    let system = model.assemble(comm, &model.families()?)?;
    let equilibrium = Sweep::new(&system, &model.interface, false)?.equilibrium(friction, observer)?;
    let equilibrium_seconds = start.elapsed().as_secs_f64();
    let mut follow = |event| observer.event(Event::Reduction(&event));
    let sample = |i: usize| model.assemble_as(comm, &others.models[i].model);
    // Damping is no part of the basis.
    let n_samples = if others.changes_matrices { others.first(MAX_SAMPLES).len() } else { 0 };
    let samples = PartSamples { n_samples, min_samples: others.min_samples, system: &sample };
    let (mut element, surface, costs, report) =
        model.reduce_for(comm, (&system, &equilibrium), limit, &samples, &mut follow)?;
    let SampleReport { errors: sample_errors, n_added: sample_coordinates } = report;
    let n_samples = sample_errors.len();
    let found = MadeFor { n_samples, sample_coordinates, sample_errors, ..MadeFor::default() };
    element.origin.made_for = others.made_for(found);
    place.write(comm, &element, &surface, None, observer)?;
    Ok(Reduction { element, costs, equilibrium_seconds, seconds: start.elapsed().as_secs_f64() })
}

/// Puts reference contacts into a model: as many as are given, else as its file says.
///
/// # Errors
/// [`Error::Input`] where neither says how many; see [`FullModel::reduce_contacts`].
pub fn with_reference_contacts(mut model: FullModel, n_contacts: Option<usize>) -> Result<FullModel> {
    let n = n_contacts.or(model.model.reduction.as_ref().map(|reduction| reduction.contacts));
    let n = n.ok_or_else(|| {
        let file = model.model.file.display();
        let advice = "Give --contacts, such as 104, or [reduction] contacts in the model";
        Error::input(format!("{file}: how many contacts? {advice}"))
    })?;
    model.reduce_contacts(n)?;
    Ok(model)
}
