//! From a model to a Galerkin super-element: equilibria and modes of the full model at samples, a basis of them, the
//! projection.

use std::path::PathBuf;
use std::time::Instant;

use crate::Result;
use crate::assembly::System;
use crate::contact::Response;
use crate::equilibrium::{Contacts, Equilibrium};
use crate::native::{Block, Comm, Factor, FactorKind, Matrix, Vector};
use crate::reduction::galerkin::{self, Basis, BasisReport};
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::{Sample, SuperElement};
use crate::results::Certificate;
use crate::stability::EigenOptions;
use crate::structure::{FullModel, ReducedModel, Structure, nodal_basis};

use super::certificate::Whole;
use super::family::widened;
use super::observer::{Event, Observer};
use super::reduce::SuperElementPlace;
use super::sweep::{Costs, Sweep};

/// Accuracy of modes that join the basis, relative to what they may leave out.
const VECTOR_ACCURACY: f64 = 0.1;
/// Static answers that join the basis together: less memory than all at once.
const PANEL: usize = 256;
/// Friction values of equilibria are no farther apart.
const EQUILIBRIUM_STEP: f64 = 0.05;
/// Equilibria under these factors on the loads and on the contact stiffness join the basis, too.
const PRESSURES: [f64; 2] = [0.5, 1.5];
const CONTACT_STIFFNESSES: [f64; 2] = [0.5, 2.0];
/// What adds less than this part of itself to the span is left out: of equilibria, of modes, of static answers.
const NEGLIGIBLE_OF_EQUILIBRIA: f64 = 1e-6;
const NEGLIGIBLE_OF_MODES: f64 = 1e-3;
const NEGLIGIBLE_OF_ANSWERS: f64 = 0.03;

/// Equilibria of some samples without those that are multiples of another sample's equilibrium: where contact is
/// homogeneous ([`crate::contact::Interface::is_homogeneous`]) and no load is constant, equilibria are proportional to
/// the loads.
fn independent(equilibria: &[Sample], modes: &[Sample], is_homogeneous: bool) -> Vec<Sample> {
    let is_multiple = |a: &Sample, b: &Sample| Sample { pressure: b.pressure, ..*a } == *b;
    let mut independent: Vec<Sample> = Vec::new();
    for sample in equilibria {
        if !is_homogeneous || !modes.iter().chain(&independent).any(|other| is_multiple(sample, other)) {
            independent.push(*sample);
        }
    }
    independent
}

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
            max_coordinates: 1500,
            file,
            force: false,
            keep_basis: false,
        }
    }
}

impl GalerkinOptions {
    /// The sample in the middle of those of the modes: where the basis has its energy, and prestress its stress.
    fn middle(&self) -> Sample {
        self.modes[self.modes.len() / 2]
    }

    /// Accuracy of the modes' vectors.
    fn vector_accuracy(&self) -> f64 {
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

/// A Galerkin super-element, and where its coordinates come from.
pub struct GalerkinReduction {
    /// The super-element.
    pub element: SuperElement,
    /// What it is made of.
    pub report: BasisReport,
    /// How it does at friction values without a sample.
    pub certificates: Vec<Certificate>,
}

/// An equilibrium of the full model.
struct State {
    sample: Sample,
    u: Vector,
    responses: Vec<Response>,
}

/// What the basis is made of.
#[derive(Default)]
struct Snapshots {
    states: Vec<State>,
    /// Right and left vectors, real and imaginary parts, of the modes at a sample.
    modes: Vec<Block>,
    /// Spent on equilibria, modes and left vectors, s.
    seconds: [f64; 3],
}

/// Reduces a model with all of its contacts to a Galerkin super-element ([`galerkin`]), and writes its file.
/// Collective.
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
    observer.event(Event::Stage("assembling"));
    let mut system = model.assemble(comm, &model.families()?)?;
    let end = widened(model.model.band)[1];
    let mut snapshots = Snapshots::take(model, &mut system, options, end, observer)?;

    observer.event(Event::Stage("making the basis"));
    let clock = Instant::now();
    let k_ref = snapshots.reference_stiffness(model, &system, options.middle())?;
    let mut factor = Factor::new(FactorKind::Symmetric);
    factor.factorise(&k_ref)?;
    let mut basis = Basis::new(&k_ref, &snapshots.modes[0], options.max_coordinates);
    let mut report = snapshots.span(model, &system, &factor, options.negligible, &mut basis)?;
    report.basis_seconds = clock.elapsed().as_secs_f64();

    observer.event(Event::Stage("projecting the matrices"));
    let clock = Instant::now();
    let (mut element, surface) = model.project(comm, &system, basis.vectors(), &options.modes, end)?;
    model.freeze_prestress(&mut element, &system, &snapshots.equilibrium(options.middle())?, basis.vectors())?;
    let kept = options.keep_basis.then(|| nodal_basis::gathered(&system, &model.nodes, basis.vectors()));
    place.write(comm, &element, &surface, kept.as_deref())?;
    drop((surface, kept));
    report.projection_seconds = clock.elapsed().as_secs_f64();

    observer.event(Event::Stage("comparing with the full model between the samples"));
    let clock = Instant::now();
    let reduced = ReducedModel::new(&options.file, element.clone(), OuterSurface::default());
    let (reduced, prestress) = (Structure::Reduced(Box::new(reduced)), model.prestress()?);
    let (interface, basis, prestress) = (&model.interface, basis.vectors(), prestress.as_ref());
    let whole = Whole { system: &system, interface, prestress, basis, factor: &factor, inverse_metric: None };
    let certificates = whole.certify(&reduced, &snapshots.test_values(options), model.model.band)?;
    report.test_seconds = clock.elapsed().as_secs_f64();
    report.seconds = start.elapsed().as_secs_f64();
    Ok(GalerkinReduction { element, report, certificates })
}

impl Snapshots {
    /// Solves the full model at all samples, one path for each load and contact stiffness; the model's own first.
    fn take(
        model: &FullModel,
        system: &mut System,
        options: &GalerkinOptions,
        end: f64,
        observer: &mut dyn Observer,
    ) -> Result<Snapshots> {
        let modes = options.modes.iter().map(|&sample| (sample, Some(end)));
        let is_homogeneous = model.interface.is_homogeneous() && system.constant_load.norm()? == 0.0;
        let equilibria = independent(&options.equilibria, &options.modes, is_homogeneous);
        let mut all: Vec<(Sample, Option<f64>)> =
            modes.chain(equilibria.into_iter().map(|sample| (sample, None))).collect();
        let rank = |s: &Sample| (!is_own(s), s.pressure, s.contact_stiffness, s.friction);
        all.sort_by(|(a, _), (b, _)| rank(a).partial_cmp(&rank(b)).expect("samples are finite"));
        let mut snapshots = Snapshots::default();
        let is_one_path =
            |a: &Sample, b: &Sample| (a.pressure, a.contact_stiffness) == (b.pressure, b.contact_stiffness);
        for path in all.chunk_by(|(a, _), (b, _)| is_one_path(a, b)) {
            let pressure = path[0].0.pressure;
            system.scale_load(pressure)?;
            snapshots.follow(model, system, path, options.vector_accuracy(), observer)?;
            system.scale_load(1.0 / pressure)?;
        }
        Ok(snapshots)
    }

    /// Solves at the friction values of a path, for modes below a frequency (Hz) where there is one. Under other loads
    /// or contact stiffnesses each equilibrium starts from the model's own at the same friction value, where that is
    /// known.
    fn follow(
        &mut self,
        model: &FullModel,
        system: &System,
        path: &[(Sample, Option<f64>)],
        accuracy: f64,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let mut interface = model.interface.clone();
        interface.scale_contact_stiffness(path[0].0.contact_stiffness);
        let prestress = model.prestress()?;
        let mut sweep = Sweep::new(system, &interface, model.model.friction_damping)?;
        sweep = sweep.with_prestress(prestress.as_ref());
        sweep.search_by(EigenOptions::with_vector_accuracy(accuracy));
        for &(sample, end) in path {
            let equilibrium = match self.states.iter().find(|state| state.sample == Sample::at(sample.friction)) {
                Some(own) => sweep.equilibrium_near(own.u.duplicate()?, sample.friction, observer)?,
                None => sweep.equilibrium(sample.friction, observer)?,
            };
            if let Some(end) = end {
                let band = sweep.modes(&equilibrium, [0.0, end], observer)?;
                let mut vectors = sweep.right_vectors(&band.modes)?;
                vectors.append(&sweep.left_vectors(&band.modes, |_| accuracy)?);
                self.modes.push(vectors);
            }
            let Equilibrium { u, responses, .. } = equilibrium;
            self.states.push(State { sample, u, responses });
        }
        let Costs { equilibria_seconds, modes_seconds, left_seconds, .. } = sweep.costs();
        let seconds = [equilibria_seconds, modes_seconds, left_seconds];
        self.seconds.iter_mut().zip(seconds).for_each(|(sum, seconds)| *sum += seconds);
        Ok(())
    }

    /// The equilibrium at a sample.
    fn equilibrium(&self, sample: Sample) -> Result<Equilibrium> {
        let state = self.states.iter().find(|state| state.sample == sample).expect("every sample has a state");
        let (u, responses) = (state.u.duplicate()?, state.responses.clone());
        Ok(Equilibrium { u, responses, friction: sample.friction, steps: Vec::new() })
    }

    /// The stiffness at a state with contact and without friction's coupling. Collective.
    fn reference_stiffness(&self, model: &FullModel, system: &System, sample: Sample) -> Result<Matrix> {
        let equilibrium = self.equilibrium(sample)?;
        Sweep::new(system, &model.interface, false)?.symmetric_stiffness(&equilibrium)
    }

    /// Adds equilibria, modes, which are given up, and static answers to a basis whose energy is that of a state.
    /// Collective.
    fn span(
        &mut self,
        model: &FullModel,
        system: &System,
        factor: &Factor,
        negligible: f64,
        basis: &mut Basis,
    ) -> Result<BasisReport> {
        let [equilibrium_seconds, mode_seconds, left_seconds] = self.seconds;
        let mut report = BasisReport {
            equilibria: self.states.len(),
            mode_samples: self.modes.len(),
            equilibrium_seconds,
            mode_seconds,
            left_seconds,
            ..BasisReport::default()
        };
        for state in &self.states {
            let u = Block::from_columns(state.u.comm(), state.u.n_local(), state.u.to_vec()?);
            report.coordinates_of_equilibria += basis.add(u, NEGLIGIBLE_OF_EQUILIBRIA)?;
        }
        for modes in std::mem::take(&mut self.modes) {
            report.coordinates_of_modes += basis.add(modes, negligible)?;
        }
        let responses: Vec<&[Response]> = self.states.iter().map(|state| &state.responses[..]).collect();
        let forces = galerkin::switching_forces(&model.interface, &responses);
        report.switching_points = forces.chunk_by(|a, b| a.0 == b.0).count();
        let contacts = Contacts::new(&model.interface, system)?;
        for forces in forces.chunks(PANEL) {
            let answers = contacts.loads(system.k.comm(), forces).solved_by(factor)?;
            report.coordinates_of_static_answers += basis.add(answers, NEGLIGIBLE_OF_ANSWERS)?;
        }
        Ok(report)
    }

    /// Friction values without an equilibrium, near the middle between samples of modes.
    fn test_values(&self, options: &GalerkinOptions) -> Vec<f64> {
        let sorted = |samples: &mut dyn Iterator<Item = Sample>| {
            let mut values: Vec<f64> = samples.filter(is_own).map(|sample| sample.friction).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let modes = sorted(&mut options.modes.iter().copied());
        let states = sorted(&mut self.states.iter().map(|state| state.sample));
        modes.windows(2).filter_map(|ends| empty_middle(&states, 0.5 * (ends[0] + ends[1]))).collect()
    }
}

/// Whether a sample has the model's own loads and contact stiffness.
fn is_own(sample: &Sample) -> bool {
    *sample == Sample::at(sample.friction)
}

/// The middle between the two neighbours in a rising list that a value lies between, or is the first of.
fn empty_middle(values: &[f64], value: f64) -> Option<f64> {
    let pair = values.windows(2).find(|pair| pair[0] <= value + 1e-9 && value + 1e-9 < pair[1])?;
    Some(0.5 * (pair[0] + pair[1]))
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
    fn tests_are_made_where_there_is_no_equilibrium() {
        let states = [0.1, 0.2, 0.3, 0.4];
        assert_eq!(empty_middle(&states, 0.2), Some(0.5 * (0.2 + 0.3)));
        assert_eq!(empty_middle(&states, 0.36), Some(0.35));
        assert_eq!(empty_middle(&states, 0.5), None);
    }

    /// Equilibria at other loads join the basis only where they are no multiples of others.
    #[test]
    fn proportional_equilibria_are_left_out() {
        let options = GalerkinOptions::over(&[0.2, 0.22], PathBuf::new());
        let kept = |is_homogeneous| independent(&options.equilibria, &options.modes, is_homogeneous);
        assert_eq!(kept(false), options.equilibria);
        assert!(kept(true).len() == 4 && kept(true).iter().all(|sample| sample.pressure == 1.0));
        let at = |friction, pressure| Sample { pressure, ..Sample::at(friction) };
        let equilibria = [at(0.2, 1.5), at(0.4, 1.5), at(0.4, 0.5)];
        assert_eq!(independent(&equilibria, &options.modes, true), [at(0.4, 1.5)]);
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
