//! From a model to a Galerkin super-element: equilibria and modes of the full model at samples, a basis of them, the
//! projection.

use std::path::PathBuf;
use std::time::Instant;

use crate::Result;
use crate::algebra::span;
use crate::assembly::System;
use crate::equilibrium::Equilibrium;
use crate::explore::Study;
use crate::native::{Block, Comm, Factor, FactorKind, Matrix};
use crate::reduction::galerkin::{Basis, BasisReport};
use crate::reduction::made_for::MadeFor;
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::{Sample, SuperElement};
use crate::results::Certificate;
use crate::structure::{FullModel, ReducedModel, Structure, nodal_basis};

use super::certificate::{Whole, certify_at};
use super::family::widened;
use super::observer::{Event, Observer};
use super::other_parts::OtherParts;
use super::part_keys::sampled_range;
use super::reduce::SuperElementPlace;
use super::snapshots::Snapshots;

/// Accuracy of modes that join the basis, relative to what they may leave out.
const VECTOR_ACCURACY: f64 = 0.1;
/// Friction values of equilibria are no farther apart.
const EQUILIBRIUM_STEP: f64 = 0.05;
/// Equilibria under these factors on the loads and on the contact stiffness join the basis, too.
const PRESSURES: [f64; 2] = [0.5, 1.5];
const CONTACT_STIFFNESSES: [f64; 2] = [0.5, 2.0];
/// What modes add less than this part of themselves to the span is left out.
const NEGLIGIBLE_OF_MODES: f64 = 1e-3;
/// Modes and equilibria are taken at so many samples of other parts, equilibria alone at so many more, and modes
/// compared at so many others.
const OTHER_PARTS: usize = 8;
const OTHER_EQUILIBRIA: usize = 40;
const OTHER_TESTS: usize = 2;

/// What [`reduce_galerkin`] does.
#[derive(Debug, Clone)]
pub struct GalerkinOptions {
    /// Where the basis takes equilibrium and modes.
    pub modes: Vec<Sample>,
    /// Where it takes the equilibrium alone, unless that is a multiple of another sample's.
    pub equilibria: Vec<Sample>,
    /// What modes add less than this part of themselves is left out, 1e-7 or more: eigenvalues at the samples have its
    /// square as their error.
    pub negligible: f64,
    /// A study of many parameters: the basis takes modes at its moduli and densities as well.
    pub for_study: Option<Study>,
    /// Coordinates at most.
    pub max_coordinates: usize,
    /// The super-element's file.
    pub file: PathBuf,
    /// Whether an earlier super-element may be replaced.
    pub force: bool,
    /// Whether the file keeps the basis, by which results are compared with the full model later.
    pub keep_basis: bool,
}

impl GalerkinOptions {
    /// Modes at some friction values; equilibria in between, and at these values under other loads and contact
    /// stiffnesses.
    pub fn over(friction_values: &[f64], file: PathBuf) -> GalerkinOptions {
        let modes: Vec<Sample> = friction_values.iter().map(|&mu| Sample::at(mu)).collect();
        let pressed = |sample: Sample| PRESSURES.map(|pressure| Sample { pressure, ..sample });
        let stiffened =
            |sample: Sample| CONTACT_STIFFNESSES.map(|contact_stiffness| Sample { contact_stiffness, ..sample });
        let varied = modes.iter().flat_map(|&sample| pressed(sample).into_iter().chain(stiffened(sample)));
        let between = values_between(friction_values).into_iter().map(Sample::at);
        let equilibria = between.chain(varied).collect();
        GalerkinOptions {
            modes,
            equilibria,
            negligible: NEGLIGIBLE_OF_MODES,
            for_study: None,
            max_coordinates: 1500,
            file,
            force: false,
            keep_basis: false,
        }
    }
}

impl GalerkinOptions {
    /// The sample in the middle of those of the modes: where the basis has its energy, and prestress its stress.
    pub(super) fn middle(&self) -> Sample {
        self.modes[self.modes.len() / 2]
    }

    /// Accuracy of the modes' vectors.
    pub(super) fn vector_accuracy(&self) -> f64 {
        VECTOR_ACCURACY * self.negligible
    }
}

/// Values between neighbours of a list, evenly spaced and no farther apart than [`EQUILIBRIUM_STEP`].
fn values_between(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let within = |ends: &[f64]| {
        let (first, width) = (ends[0], ends[1] - ends[0]);
        let n = (width / EQUILIBRIUM_STEP * (1.0 - 1e-9)).ceil() as usize;
        (1..n).map(move |i| first + width * i as f64 / n as f64).collect::<Vec<_>>()
    };
    values.windows(2).flat_map(within).collect()
}

/// The first, the middle and the last value of a list, each once: where modes of a sweep are taken.
pub fn first_middle_last(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let mut places = vec![0, n / 2, n.saturating_sub(1)];
    places.dedup();
    places.into_iter().filter_map(|at| values.get(at).copied()).collect()
}

/// Where modes are taken unless otherwise said: at the first, the middle and the last friction coefficient of a sweep,
/// which is widened to the range of a study where that reaches beyond it; the middle one is then the nearest to the
/// middle of that range.
pub fn friction_samples(sweep: &[f64], study: Option<&Study>) -> Vec<f64> {
    let own = study.into_iter().flat_map(|study| &study.parameters).find(|own| own.shared_key() == Some("friction"));
    let Some(range) = own.map(sampled_range) else { return first_middle_last(sweep) };
    let [low, high] = span(sweep.iter().copied());
    let beyond = range.map(|value| value.max(0.0)).into_iter().filter(|value| !(low..=high).contains(value));
    let mut values: Vec<f64> = sweep.iter().copied().chain(beyond).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let [low, high] = span(values.iter().copied());
    let middle = values.iter().copied().min_by(|a, b| {
        let distance = |value: &f64| (value - 0.5 * (low + high)).abs();
        distance(a).total_cmp(&distance(b))
    });
    let mut samples: Vec<f64> = [low].into_iter().chain(middle).chain([high]).collect();
    samples.dedup();
    samples
}

/// A Galerkin super-element, and where its coordinates come from.
pub struct GalerkinReduction {
    /// The super-element.
    pub element: SuperElement,
    /// What it is made of.
    pub report: BasisReport,
    /// How it does at friction values without a sample.
    pub certificates: Vec<Certificate>,
}

/// Reduces a model with all of its contacts to a Galerkin super-element ([`crate::reduction::galerkin`]), and writes
/// its file. Collective.
///
/// # Errors
/// [`crate::Error::Input`] where the file may not be replaced or a part can move freely;
/// [`crate::Error::NotConverged`]; PETSc's, MUMPS's, the system's.
///
/// # Panics
/// Without a sample of modes.
pub fn reduce_galerkin(
    comm: &Comm,
    model: &FullModel,
    options: &GalerkinOptions,
    observer: &mut dyn Observer,
) -> Result<GalerkinReduction> {
    let start = Instant::now();
    let place = SuperElementPlace { file: &options.file, force: options.force };
    place.begin(comm, model, observer)?;
    // What the file has as its own friction value: refused before the long work, not after it.
    model.own_friction()?;
    let others = OtherParts::of(model, options.for_study.as_ref(), &options.file, observer)?;
    observer.event(Event::Stage("assembling"));
    let mut system = model.assemble(comm, &model.families()?)?;
    let end = widened(model.model.band)[1];
    let mut snapshots = sampled(model, &mut system, &others, options, observer)?;

    observer.event(Event::Stage("making the basis"));
    let clock = Instant::now();
    let k_ref = snapshots.reference_stiffness(model, &system, options.middle())?;
    let factor = factorised(&k_ref)?;
    let mut basis = Basis::new(&k_ref, &snapshots.modes[0], options.max_coordinates);
    let mut report = snapshots.span(model, &system, &factor, options.negligible, &mut basis)?;
    report.basis_seconds = clock.elapsed().as_secs_f64();

    observer.event(Event::Stage("projecting the matrices"));
    let clock = Instant::now();
    let (mut element, surface) = model.project(comm, &system, basis.vectors(), &options.modes, end)?;
    let middle = snapshots.equilibrium(options.middle())?;
    model.freeze_prestress(&mut element, &system, &middle, basis.vectors())?;
    element.origin.made_for = made_for(model, others, (&element, basis.vectors()), &middle, &report)?;
    let kept = options.keep_basis.then(|| nodal_basis::gathered(&system, &model.nodes, basis.vectors()));
    place.write(comm, &element, &surface, kept.as_deref(), observer)?;
    drop((surface, kept));
    report.projection_seconds = clock.elapsed().as_secs_f64();

    observer.event(Event::Stage("comparing with the full model between the samples"));
    let clock = Instant::now();
    let (tested, values) = ((&element, basis.vectors()), snapshots.test_values(options));
    let certificates = compare(model, (&system, &factor), tested, &values)?;
    report.test_seconds = clock.elapsed().as_secs_f64();
    report.seconds = start.elapsed().as_secs_f64();
    Ok(GalerkinReduction { element, report, certificates })
}

/// Equilibria and modes of the model, and with other parts. Collective.
fn sampled(
    model: &FullModel,
    system: &mut System,
    others: &OtherParts,
    options: &GalerkinOptions,
    observer: &mut dyn Observer,
) -> Result<Snapshots> {
    let end = widened(model.model.band)[1];
    let mut snapshots = Snapshots::take(model, system, options, end, observer)?;
    snapshots.take_others(model, others.first(OTHER_PARTS), options, end, observer)?;
    snapshots.take_equilibria(
        model,
        others.after(OTHER_PARTS, n_equilibria(others.models.len())),
        options,
        observer,
    )?;
    Ok(snapshots)
}

/// At how many models with other parts equilibria alone are taken: what others and tests leave.
fn n_equilibria(n_models: usize) -> usize {
    n_models.saturating_sub(OTHER_PARTS + OTHER_TESTS).min(OTHER_EQUILIBRIA)
}

fn factorised(k_ref: &Matrix) -> Result<Factor> {
    let mut factor = Factor::new(FactorKind::Symmetric);
    factor.factorise(k_ref)?;
    Ok(factor)
}

/// How a super-element does at friction values without a sample. Collective.
fn compare(
    model: &FullModel,
    (system, factor): (&System, &Factor),
    (element, basis): (&SuperElement, &Block),
    values: &[f64],
) -> Result<Vec<Certificate>> {
    let reduced = ReducedModel::new("".as_ref(), element.clone(), OuterSurface::default());
    let (reduced, prestress) = (Structure::Reduced(Box::new(reduced)), model.prestress()?);
    let (interface, prestress) = (&model.interface, prestress.as_ref());
    let whole = Whole { system, interface, prestress, basis, factor, inverse_metric: None };
    whole.certify(&reduced, values, model.model.band)
}

/// What a super-element is made for, with its errors at parts that its basis was not made of, about an equilibrium.
/// Collective.
fn made_for(
    model: &FullModel,
    others: OtherParts,
    (element, basis): (&SuperElement, &Block),
    middle: &Equilibrium,
    report: &BasisReport,
) -> Result<Option<MadeFor>> {
    let error = |other| Ok(certify_at(model, other, (element, basis), middle, middle.friction)?.frequency_error());
    let tests = others.after(OTHER_PARTS + n_equilibria(others.models.len()), OTHER_TESTS);
    let test_errors = tests.iter().map(error).collect::<Result<Vec<f64>>>()?;
    let n_samples = others.first(OTHER_PARTS).len();
    Ok(others.made_for(MadeFor {
        n_samples,
        sample_coordinates: report.coordinates_of_parts,
        test_friction: (!test_errors.is_empty()).then_some(middle.friction),
        test_errors,
        ..MadeFor::default()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equilibria_fill_the_gaps_between_samples() {
        let close = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(&values_between(&[0.3, 0.1]), &[0.15, 0.2, 0.25]), "{:?}", values_between(&[0.3, 0.1]));
        assert!(close(&values_between(&[0.1, 0.16, 0.2]), &[0.13]));
        assert!(values_between(&[0.4]).is_empty());
    }

    #[test]
    fn samples_are_the_ends_and_the_middle_of_a_sweep() {
        assert_eq!(first_middle_last(&[0.1, 0.2, 0.3, 0.4, 0.5]), [0.1, 0.3, 0.5]);
        assert_eq!(first_middle_last(&[0.1, 0.5]), [0.1, 0.5]);
        assert_eq!(first_middle_last(&[0.4]), [0.4]);
    }

    #[test]
    fn few_models_leave_tests() {
        assert_eq!([9, 10, 22, 50, 64].map(n_equilibria), [0, 0, 12, 40, 40]);
    }

    #[test]
    fn samples_reach_as_far_as_the_friction_coefficients_of_a_study() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("for.toml");
        let text = |key: &str| {
            format!(
                "model = \"a.toml\"\n[design]\nkind = \"grid\"\n[parameter.x]\nkey = \"{key}\"\nvalues = [0.2, 0.6]\n"
            )
        };
        let of = |key: &str, sweep: &[f64]| {
            std::fs::write(&file, text(key)).unwrap();
            friction_samples(sweep, Some(&crate::explore::read(&file).unwrap()))
        };
        assert_eq!(of("friction", &[0.4]), [0.2, 0.4, 0.6]);
        assert_eq!(of("friction", &[0.1, 0.5, 0.9]), [0.1, 0.5, 0.9], "the study lies within the sweep");
        assert_eq!(of("friction", &[0.3, 0.4, 0.5, 0.7]), [0.2, 0.4, 0.7]);
        assert_eq!(of("friction", &[0.1, 0.12, 0.14, 0.16, 0.3]), [0.1, 0.3, 0.6], "nearest to 0.35");
        assert_eq!((of("pressure", &[0.4]), friction_samples(&[0.4], None)), (vec![0.4], vec![0.4]));
    }

    #[test]
    fn loads_and_contact_stiffness_vary_at_each_sample() {
        let options = GalerkinOptions::over(&[0.2, 0.22], PathBuf::new());
        assert_eq!(options.modes, [Sample::at(0.2), Sample::at(0.22)]);
        let count = |is: fn(&Sample) -> bool| options.equilibria.iter().filter(|sample| is(sample)).count();
        assert_eq!([count(|s| s.pressure != 1.0), count(|s| s.contact_stiffness != 1.0)], [4, 4]);
        assert_eq!(options.equilibria.len(), 8);
    }
}
