//! A brake with full contact, with fewer contacts, and as super-elements, compared with each other.
//!
//! Every model is a part of the study with a results folder of its own. `parts.toml` keeps for each finished part what
//! it depends on, so that a study that is run again makes only what is missing or out of date.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::comparison::{Sizes, Study, n_contacts};
use crate::native::Comm;
use crate::output::results_folder::RESULTS;
use crate::reduction;
use crate::results::{Results, file};
use crate::structure::{FullModel, Structure, StructureOptions};
use crate::{Error, Result};

use super::galerkin::{GalerkinOptions, first_middle_last, reduce_galerkin};
use super::observer::{Event, Observer};
use super::record::{Done, Record};
use super::reduce::{ReduceOptions, reduce, with_reference_contacts};
use super::stability::{StabilityOptions, stability};
use super::start::Output;

/// What [`study`] is asked for.
#[derive(Debug, Clone)]
pub struct StudyOptions {
    /// The model file.
    pub model: PathBuf,
    /// Values of the friction coefficient; the model's own where there are none.
    pub friction_values: Option<Vec<f64>>,
    /// Contact layouts: so many reference pairs over the sliding contacts.
    pub layouts: Vec<usize>,
    /// Reference pairs of the super-elements.
    pub super_element: usize,
    /// Friction coefficient at which the super-element for all values is made; the swept pairs' own where there is
    /// none.
    pub reduced_at: Option<f64>,
    /// Folder of the study.
    pub folder: PathBuf,
    /// What the numbers depend on beside model and options, such as options for PETSc.
    pub identity: String,
}

/// Makes the parts of a study that are missing or out of date, and compares all of them with full contact. Only the
/// root gets the comparison. Collective.
///
/// # Errors
/// [`Error::Input`] for a model, layouts or a folder that cannot be used; those of [`stability`] and [`reduce`].
pub fn study(comm: &Comm, options: &StudyOptions, observer: &mut dyn Observer) -> Result<Option<Study>> {
    let plan = Plan::new(comm, options)?;
    let mut record = comm.agree(if comm.is_root() { Record::open(&options.folder) } else { Ok(Record::default()) })?;
    for part in plan.parts() {
        plan.make(comm, &part, &mut record, observer)?;
    }
    comm.agree(if comm.is_root() { plan.compare(&record).map(Some) } else { Ok(None) })
}

/// What a study is made of.
struct Plan<'a> {
    options: &'a StudyOptions,
    friction_values: Vec<f64>,
    /// Friction coefficient of the super-element for all values.
    reduced_at: f64,
    n_loaded: usize,
    /// What all parts depend on.
    identity: String,
}

/// A model of the study.
struct Part {
    /// Its name for people.
    name: String,
    /// Its file or folder in the study's folder.
    product: String,
    /// What it alone depends on.
    options: String,
    work: Work,
}

/// How a part is made.
enum Work {
    /// Writes the super-element for all values.
    Reduce,
    /// Writes the Galerkin super-element.
    ReduceGalerkin,
    /// Analyses a model or super-element.
    Stability { model: PathBuf, contacts: Option<usize>, reduce_each: bool },
}

/// Folder of the reference.
const FULL: &str = "full";

impl<'a> Plan<'a> {
    /// Reads and checks everything before anything is computed. Collective.
    fn new(comm: &Comm, options: &'a StudyOptions) -> Result<Plan<'a>> {
        let mut full = FullModel::read(comm, &options.model)?;
        full.require_constrained(comm)?;
        full.require_pair_laws()?;
        let mut friction_values = full.friction_values(options.friction_values.as_deref())?;
        friction_values.sort_by(f64::total_cmp);
        for &n in options.layouts.iter().chain([&options.super_element]) {
            let reduced = reduction::contacts::reduce(&full.model, &full.mesh, &full.interface, n)?;
            let all = std::mem::replace(&mut full.interface, reduced);
            full.require_constrained(comm)?;
            full.interface = all;
        }
        let reduced_at = options.reduced_at.map_or_else(|| full.own_friction(), Ok)?;
        let [model, mesh] = full.digests(comm)?;
        let (program, more) = (env!("CARGO_PKG_VERSION"), &options.identity);
        let identity = format!("squeal {program} {more}, model {model}, mesh {mesh}");
        Ok(Plan { options, friction_values, reduced_at, n_loaded: full.loaded_names().len(), identity })
    }

    /// All parts, each after those that it needs.
    fn parts(&self) -> Vec<Part> {
        let (model, n) = (&self.options.model, self.options.super_element);
        let stability = |model: &Path, contacts, reduce_each| {
            let model = model.to_owned();
            Work::Stability { model, contacts, reduce_each }
        };
        let layouts =
            self.options.layouts.iter().map(|&n| {
                self.part(&format!("{n} contacts"), &format!("contacts-{n}"), stability(model, Some(n), false))
            });
        let one = format!("super-element of {n}, made at {}", self.reduced_at);
        let one = self.part(&one, &format!("super-element-{n}"), stability(&self.element(), None, false));
        let each = format!("super-element of {n}, made at each");
        let each = self.part(&each, &format!("super-element-{n}-each"), stability(model, Some(n), true));
        let galerkin = stability(&self.galerkin_element(), None, false);
        let galerkin = self.part("super-element, Galerkin", "galerkin", galerkin);
        let full = self.part("full contact", FULL, stability(model, None, false));
        let elements = [self.reduction(), one, each, self.galerkin_reduction(), galerkin];
        [full].into_iter().chain(layouts).chain(elements).collect()
    }

    fn part(&self, name: &str, product: &str, work: Work) -> Part {
        let values: Vec<String> = self.friction_values.iter().map(f64::to_string).collect();
        let mut options = format!("friction values {}", values.join(" "));
        if let Work::Stability { model, .. } = &work {
            let made = [self.reduction(), self.galerkin_reduction()];
            let own = made.iter().find(|part| part.product == file_name(model));
            options += &own.map_or_else(String::new, |part| format!(", super-element of {}", part.options));
        }
        Part { name: name.into(), product: product.into(), options, work }
    }

    fn reduction(&self) -> Part {
        Part {
            name: format!("making the super-element of {}", self.options.super_element),
            product: file_name(&self.element()),
            options: format!("friction coefficient {}", self.reduced_at),
            work: Work::Reduce,
        }
    }

    fn galerkin_reduction(&self) -> Part {
        let samples: Vec<String> = self.samples().iter().map(f64::to_string).collect();
        Part {
            name: "making the Galerkin super-element".into(),
            product: file_name(&self.galerkin_element()),
            options: format!("modes at {}", samples.join(" ")),
            work: Work::ReduceGalerkin,
        }
    }

    /// Friction values at which the Galerkin super-element has its modes.
    fn samples(&self) -> Vec<f64> {
        first_middle_last(&self.friction_values)
    }

    /// The file of the Galerkin super-element.
    fn galerkin_element(&self) -> PathBuf {
        self.options.folder.join("brake-galerkin.se.h5")
    }

    /// The file of the super-element for all values.
    fn element(&self) -> PathBuf {
        self.options.folder.join(format!("brake-{}.se.h5", self.options.super_element))
    }

    /// Makes a part, unless it is there. Collective.
    fn make(&self, comm: &Comm, part: &Part, record: &mut Record, observer: &mut dyn Observer) -> Result<()> {
        let identity = format!("{}, {}", self.identity, part.options);
        let file = self.options.folder.join(&part.product);
        let file = if let Work::Stability { .. } = part.work { file.join(RESULTS) } else { file };
        let is_made = comm.is_root() && record.has(&part.product, &identity, &file);
        let is_made = comm.broadcast_value(0, is_made);
        observer.event(Event::Part { name: &part.name, is_made });
        if is_made {
            return Ok(());
        }
        let start = Instant::now();
        match &part.work {
            Work::Reduce => self.reduce(comm, observer)?,
            Work::ReduceGalerkin => self.reduce_galerkin(comm, observer)?,
            Work::Stability { .. } => self.analyse(comm, part, observer)?,
        }
        let seconds = start.elapsed().as_secs_f64();
        record.parts.insert(part.product.clone(), Done { identity, seconds });
        comm.agree(if comm.is_root() { record.write(&self.options.folder) } else { Ok(()) })
    }

    fn reduce(&self, comm: &Comm, observer: &mut dyn Observer) -> Result<()> {
        let model = FullModel::read(comm, &self.options.model)?;
        let model = with_reference_contacts(model, Some(self.options.super_element))?;
        let (friction, file) = (Some(self.reduced_at), self.element());
        reduce(comm, &model, &ReduceOptions { friction, limit: None, for_study: None, file, force: true }, observer)
            .map(|_| ())
    }

    fn reduce_galerkin(&self, comm: &Comm, observer: &mut dyn Observer) -> Result<()> {
        let model = FullModel::read(comm, &self.options.model)?;
        let options =
            GalerkinOptions { force: true, ..GalerkinOptions::over(&self.samples(), self.galerkin_element()) };
        reduce_galerkin(comm, &model, &options, observer).map(|_| ())
    }

    fn analyse(&self, comm: &Comm, part: &Part, observer: &mut dyn Observer) -> Result<()> {
        let Work::Stability { model, contacts, reduce_each } = &part.work else { return Ok(()) };
        let structure =
            Structure::read(comm, model, &StructureOptions { contacts: *contacts, ..StructureOptions::default() })?;
        let output = Output {
            folder: self.options.folder.join(&part.product),
            force: true,
            command: format!("study: {}", part.name),
            identity: vec![("study", self.identity.clone()), ("contacts", format!("{contacts:?}"))],
        };
        let options = StabilityOptions {
            friction_values: Some(self.friction_values.clone()),
            band: None,
            criterion: None,
            // Super-elements of their own have no modes in common.
            branches: !reduce_each,
            reduce_each: *reduce_each,
            certify: None,
            output: Some(output),
        };
        let results = stability(comm, &structure, &options, observer)?;
        let failed = |failure: crate::results::Failure| Err(Error::not_converged(failure.reason));
        comm.agree(results.failure.map_or(Ok(()), failed))
    }

    /// All models against the reference. Not collective.
    fn compare(&self, record: &Record) -> Result<Study> {
        let reference = self.read(FULL)?;
        let mut study = Study::new(&reference);
        let element = format!("super-element-{}", self.options.super_element);
        let n_coordinates = self.read(&element)?.about.n_dofs;
        for part in self.parts().into_iter().filter(|part| part.product != FULL) {
            let Work::Stability { model, reduce_each, .. } = &part.work else { continue };
            let results = self.read(&part.product)?;
            let n_contacts = n_contacts(&results);
            let n_dofs = if *reduce_each { n_coordinates } else { results.about.n_dofs };
            let has_all_points = *model == self.galerkin_element();
            let n_retained = (!has_all_points).then_some(2 * n_contacts + self.n_loaded);
            let sizes = Sizes { n_contacts, n_retained, n_dofs };
            let making = record.parts.get(&file_name(model));
            study.add(&part.name, [&reference, &results], sizes, making.map(|done| done.seconds))?;
        }
        Ok(study)
    }

    fn read(&self, product: &str) -> Result<Results> {
        file::read(&self.options.folder.join(product).join(RESULTS))
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A super-element and what is computed with it are made again where its samples change, the rest is not.
    #[test]
    fn what_depends_on_a_super_element_depends_on_how_it_is_made() {
        let options = StudyOptions {
            model: "brake.toml".into(),
            friction_values: None,
            layouts: vec![4],
            super_element: 8,
            reduced_at: None,
            folder: "study".into(),
            identity: String::new(),
        };
        let parts = |reduced_at: f64| {
            let friction_values = vec![0.2, 0.3, 0.5];
            Plan { options: &options, friction_values, reduced_at, n_loaded: 1, identity: String::new() }.parts()
        };
        let changed: Vec<String> = parts(0.4)
            .into_iter()
            .zip(parts(0.5))
            .filter(|(a, b)| a.options != b.options)
            .map(|(a, _)| a.product)
            .collect();
        assert_eq!(changed, ["brake-8.se.h5", "super-element-8"]);
        let of = |product: &str| parts(0.4).into_iter().find(|part| part.product == product).unwrap().options;
        assert!(of("galerkin").ends_with("super-element of modes at 0.2 0.3 0.5"), "{}", of("galerkin"));
    }
}
