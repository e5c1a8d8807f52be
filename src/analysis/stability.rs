//! Complex modes over the friction coefficient, followed from one value to the next.

use std::path::{Path, PathBuf};

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::equilibrium::Equilibrium;
use crate::model::InstabilityCriterion;
use crate::native::{Comm, Vector};
use crate::output::fields::FieldWriter;
use crate::output::summary;
use crate::results::{About, Results, Source};
use crate::stability::{Complex, Mode};
use crate::structure::Structure;
use crate::tracking::track;
use crate::{Error, Result};

use super::certificate::certify;
use super::explain::explain;
use super::family::{FrictionFamily, Snapshot, Solutions, Vectors, tracking_options, widened};
use super::mode_data::{UnstableMode, mode_data};
use super::observer::{Event, Observer};
use super::run::{self, Job, Run, ValueResult};
use super::start::Output;
use super::sweep::Sweep;

/// What [`stability`] is asked for.
#[derive(Debug, Clone)]
pub struct StabilityOptions {
    /// Values of the friction coefficient; the structure's own where there are none.
    pub friction_values: Option<Vec<f64>>,
    /// Frequency band, Hz; the structure's own where there is none.
    pub band: Option<[f64; 2]>,
    /// What counts as an unstable mode; the structure's own where there is none.
    pub criterion: Option<InstabilityCriterion>,
    /// Whether modes are followed over the friction coefficient, which solves at more values to find where they become
    /// unstable.
    pub branches: bool,
    /// Whether a full model is reduced to a super-element at each value, whose modes are found.
    pub reduce_each: bool,
    /// The model of a super-element, with which its equilibria and modes are compared at the values asked for.
    pub certify: Option<PathBuf>,
    /// Where results are written; nowhere if none.
    pub output: Option<Output>,
}

impl Default for StabilityOptions {
    /// The structure's own values and band, with branches, nothing written.
    fn default() -> Self {
        StabilityOptions {
            friction_values: None,
            band: None,
            criterion: None,
            branches: true,
            reduce_each: false,
            certify: None,
            output: None,
        }
    }
}

/// Finds the complex modes of a band about the equilibrium at each value of the friction coefficient, `(lambda^2 M +
/// lambda C + K) x = 0`, follows them over the values, and explains those that are unstable. Where a value does not
/// converge, the analysis ends there, and [`Results::failure`] says why. The root's results are complete. Collective.
///
/// ```no_run
/// use squeal::analysis::{StabilityOptions, stability};
/// use squeal::structure::StructureOptions;
/// use squeal::{Session, Structure};
///
/// let comm = Session::start(&[])?;
/// let brake = Structure::read(&comm, "brake.toml".as_ref(), &StructureOptions::default())?;
/// let options = StabilityOptions { friction_values: Some(vec![0.3, 0.5]), ..StabilityOptions::default() };
/// let results = stability(&comm, &brake, &options, &mut ())?;
/// println!("{} modes", results.modes().count());
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`crate::Error::Input`] for values, a band or an output folder that cannot be used; [`crate::Error::Interrupted`];
/// PETSc's, MUMPS's and the system's.
pub fn stability(
    comm: &Comm,
    structure: &Structure,
    options: &StabilityOptions,
    observer: &mut dyn Observer,
) -> Result<Results> {
    let results = structure.on_its_ranks(comm, |comm| {
        let job = options.job(structure)?;
        let follows = options.follows(job.values.len());
        run::run(comm, structure, &job, options.output.as_ref(), observer, |run| {
            match (options.reduce_each, follows) {
                (false, true) => follow(run),
                (false, false) => run.each(modes_at),
                (true, _) => run.each(reduced_modes_at),
            }?;
            options.certify.as_ref().map_or(Ok(()), |model| certify_values(run, model))
        })
    })?;
    Ok(results.unwrap_or_default())
}

impl StabilityOptions {
    /// Super-elements that are made at each value have coordinates of their own, so that their modes cannot be
    /// compared.
    fn follows(&self, n_values: usize) -> bool {
        self.branches && !self.reduce_each && n_values > 1
    }

    fn job(&self, structure: &Structure) -> Result<Job> {
        if self.reduce_each && matches!(structure, Structure::Reduced(_)) {
            return Err(Error::input("a super-element cannot be reduced again: --reduce-each is for models"));
        }
        match (&self.certify, structure) {
            (Some(_), Structure::Reduced(reduced)) => reduced.require_basis()?,
            (Some(_), Structure::Full(_)) => return Err(Error::input("--certify is for Galerkin super-elements")),
            (None, _) => {}
        }
        structure.require_mass()?;
        let values = structure.friction_values(self.friction_values.as_deref())?;
        let follows = self.follows(values.len());
        let values = order(values, follows);
        let given = [(self.reduce_each, " --reduce-each"), (!self.branches, " --no-branches")];
        let options = given.iter().filter(|(given, _)| *given).map(|(_, name)| *name).collect();
        Ok(Job {
            name: "stability",
            options,
            values,
            band: structure.band(self.band)?,
            criterion: self.criterion.unwrap_or(structure.criterion()),
            summary: summary::stability,
        })
    }
}

/// Compares a super-element at the values asked for with its full model.
fn certify_values(run: &mut Run, model: &Path) -> Result<()> {
    run.observer.event(Event::Stage("comparing with the full model"));
    let (values, band) = (run.values(), run.results.about.band);
    for certificate in certify(run.system.k.comm(), run.structure, model, &values, band)? {
        let own = run.results.values.iter_mut().find(|value| value.friction == certificate.friction);
        own.into_iter().for_each(|value| value.certificate = Some(certificate.clone()));
    }
    Ok(())
}

/// Values along which modes are followed rise or fall; others are taken as they come.
fn order(mut values: Vec<f64>, follows: bool) -> Vec<f64> {
    if follows && !values.is_sorted_by(|a, b| a > b) {
        values.sort_by(f64::total_cmp);
    }
    values
}

/// Modes at all values, followed as branches, and at those in between that this needs.
fn follow(run: &mut Run) -> Result<()> {
    let (system, values) = (run.system, run.values());
    let About { band, criterion, .. } = run.results.about;
    let options = tracking_options(band, criterion);
    let mut family = FrictionFamily { solutions: run, m: &system.m, c: &system.c, viscoelastic: &system.viscoelastic };
    let (diagram, outcome) = track(&mut family, &values, &options);
    run.results.diagram = Some(diagram);
    outcome
}

/// The modes at each value that tracking asks for.
impl Solutions for Run<'_> {
    fn solve(&mut self, friction: f64) -> Result<Snapshot> {
        let snapshot = self.visit(friction, |run, equilibrium| {
            let (band, asked) = (run.results.about.band, run.is_asked(friction));
            let Run { sweep, motion, fields, observer, results, .. } = run;
            let modes = sweep.modes(equilibrium, widened(band), *observer)?;
            let snapshot = Snapshot::new(sweep, &modes, band[1])?;
            let found = mode_data(motion, &modes, asked, &results.about, |unstable| {
                write_and_explain(sweep, fields, equilibrium, &unstable, snapshot.left(unstable.index)?)
            })?;
            Ok(ValueResult { snapshot: Some(snapshot), ..found })
        })?;
        Ok(snapshot.expect("a visit without error has made it"))
    }

    fn vectors(&mut self, number: usize) -> Result<Vectors> {
        Run::vectors(self, number)
    }

    fn known(&mut self, numbers: [usize; 2]) -> Result<Option<DMatrix<Complex64>>> {
        self.checkpoint().map_or(Ok(None), |checkpoint| checkpoint.products(numbers))
    }

    fn keep(&mut self, numbers: [usize; 2], products: &DMatrix<Complex64>) -> Result<()> {
        self.checkpoint().map_or(Ok(()), |checkpoint| checkpoint.keep_products(numbers, products))
    }
}

/// The modes at one value; left vectors of unstable ones alone.
fn modes_at(run: &mut Run, equilibrium: &Equilibrium) -> Result<ValueResult> {
    let (band, asked) = (run.results.about.band, run.is_asked(equilibrium.friction));
    let Run { sweep, motion, fields, observer, results, .. } = run;
    let modes = sweep.modes(equilibrium, band, *observer)?;
    let any_grows = modes.modes.iter().any(Mode::grows);
    let snapshot = any_grows.then(|| Snapshot::of_unstable(sweep, &modes, band[1])).transpose()?;
    mode_data(motion, &modes, asked, &results.about, |unstable| match &snapshot {
        Some(snapshot) => write_and_explain(sweep, fields, equilibrium, &unstable, snapshot.left(unstable.index)?),
        None => Ok(Vec::new()),
    })
}

/// The modes of the super-element that the model is about the equilibrium.
fn reduced_modes_at(run: &mut Run, full: &Equilibrium) -> Result<ValueResult> {
    let (friction, band, asked) = (full.friction, run.results.about.band, run.is_asked(full.friction));
    let structure = run.structure.reduced_about(run.system, full)?;
    structure.band(Some(band))?;
    let system = structure.assemble(run.system.k.comm())?;
    let prestress = structure.prestress()?;
    let mut sweep = Sweep::of(&structure, &system, prestress.as_ref())?;
    let equilibrium = sweep.equilibrium(friction, run.observer)?;
    let modes = sweep.modes(&equilibrium, band, run.observer)?;
    let fields = FieldWriter { structure: &structure, system: &system, folder: run.fields.folder };
    mode_data(&mut structure.surface_motion(&system)?, &modes, asked, &run.results.about, |unstable| {
        fields.mode(friction, unstable.number, unstable.mode, unstable.shape)?;
        Ok(Vec::new())
    })
}

/// Writes the shape of an unstable mode, and gives what explains it.
fn write_and_explain(
    sweep: &mut Sweep,
    fields: &FieldWriter,
    equilibrium: &Equilibrium,
    unstable: &UnstableMode,
    [re, im]: [Vector; 2],
) -> Result<Vec<Source>> {
    fields.mode(equilibrium.friction, unstable.number, unstable.mode, unstable.shape)?;
    explain(fields.structure, sweep, equilibrium, unstable.mode, Some(Complex { re: &re, im: &im }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_followed_over_several_values_of_one_problem() {
        let options = StabilityOptions::default();
        assert!(options.follows(2) && !options.follows(1));
        assert!(!StabilityOptions { branches: false, ..options.clone() }.follows(2));
        assert!(!StabilityOptions { reduce_each: true, ..options }.follows(2));
    }

    #[test]
    fn values_to_be_followed_rise_or_fall() {
        let ordered = |values: &[f64], follows| order(values.to_vec(), follows);
        assert_eq!(ordered(&[0.5, 0.1, 0.3], true), [0.1, 0.3, 0.5]);
        assert_eq!(ordered(&[0.5, 0.3, 0.1], true), [0.5, 0.3, 0.1], "a falling list stays");
        assert_eq!(ordered(&[0.5, 0.1, 0.3], false), [0.5, 0.1, 0.3]);
    }
}
