//! Equilibria and modes of the full model at samples, of which the basis of a Galerkin super-element is made.

use crate::assembly::System;
use crate::contact::Response;
use crate::equilibrium::{Contacts, Equilibrium};
use crate::native::{Block, Factor, Matrix, Vector};
use crate::reduction::galerkin::{self, Basis, BasisReport};
use crate::reduction::super_element::Sample;
use crate::stability::EigenOptions;
use crate::structure::FullModel;
use crate::{Error, ErrorKind, Result};

use super::galerkin::GalerkinOptions;
use super::observer::{Event, Observer};
use super::other_parts::OtherModel;
use super::sweep::{Costs, Sweep};

/// Static answers that join the basis together: less memory than all at once.
const PANEL: usize = 256;
/// What adds less than this part of itself to the span is left out: of equilibria, of static answers.
const NEGLIGIBLE_OF_EQUILIBRIA: f64 = 1e-6;
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

/// Samples of equilibria, one of which is for modes below a frequency as well.
fn with_modes_at(samples: &[Sample], place: usize, end: f64) -> Vec<(Sample, Option<f64>)> {
    samples.iter().enumerate().map(|(i, &sample)| (sample, (i == place).then_some(end))).collect()
}

/// An equilibrium of the full model.
pub(super) struct State {
    sample: Sample,
    u: Vector,
    responses: Vec<Response>,
}

/// What the basis is made of.
#[derive(Default)]
pub(super) struct Snapshots {
    states: Vec<State>,
    /// Right and left vectors, real and imaginary parts, of the modes at a sample.
    pub modes: Vec<Block>,
    /// How many of these samples have the model's own parts.
    n_own: usize,
    /// From how many states, the first ones, others start.
    n_starts: usize,
    /// Whether equilibria are proportional to the loads.
    is_homogeneous: bool,
    /// Spent on equilibria, modes and left vectors, s.
    seconds: [f64; 3],
}

impl Snapshots {
    /// Solves the full model at all samples, one path for each load and contact stiffness; the model's own first.
    pub(super) fn take(
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
        let mut snapshots = Snapshots { is_homogeneous, ..Snapshots::default() };
        let is_one_path =
            |a: &Sample, b: &Sample| (a.pressure, a.contact_stiffness) == (b.pressure, b.contact_stiffness);
        for path in all.chunk_by(|(a, _), (b, _)| is_one_path(a, b)) {
            let pressure = path[0].0.pressure;
            system.scale_load(pressure)?;
            snapshots.follow(model, system, path, options.vector_accuracy(), observer)?;
            system.scale_load(1.0 / pressure)?;
            // Those of the first path, which are the model's own.
            snapshots.n_starts = if snapshots.n_starts == 0 { snapshots.states.len() } else { snapshots.n_starts };
        }
        Ok(snapshots)
    }

    /// Solves at the friction values of a path, for modes below a frequency (Hz) where there is one. Of all paths but
    /// the first, each equilibrium starts from that of the first path with the nearest friction value.
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
            let starts = &self.states[..self.n_starts];
            let equilibrium = match nearest(starts.iter().map(|own| own.sample.friction), sample.friction) {
                Some(own) => sweep.equilibrium_near(starts[own].u.duplicate()?, sample.friction, observer)?,
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

    /// Solves the model with other parts: equilibria at the friction values of all modes, as contacts that open there
    /// may stay closed with the model's own parts, and modes at one of them in turn. An equilibrium starts from the
    /// model's own. Collective.
    pub(super) fn take_others(
        &mut self,
        model: &FullModel,
        others: &[OtherModel],
        options: &GalerkinOptions,
        end: f64,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        self.n_own = self.modes.len();
        for (i, other) in others.iter().enumerate() {
            let system = model.assemble_as(self.states[0].u.comm(), &other.model)?;
            let path = with_modes_at(&options.modes, i % options.modes.len(), end);
            self.follow(model, &system, &path, options.vector_accuracy(), observer)?;
        }
        Ok(())
    }

    /// Solves the model with other parts for equilibria alone, each under the friction, loads and contact stiffness of
    /// its own point. One that is not found is left out with a warning, as it is of a study. Collective.
    pub(super) fn take_equilibria(
        &mut self,
        model: &FullModel,
        others: &[OtherModel],
        options: &GalerkinOptions,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        for (number, other) in (1..).zip(others) {
            let mut system = model.assemble_as(self.states[0].u.comm(), &other.model)?;
            let own = other.shared.sample(options.middle().friction);
            let sample = if self.is_homogeneous { Sample { pressure: 1.0, ..own } } else { own };
            system.scale_load(sample.pressure)?;
            let found = self.follow(model, &system, &[(sample, None)], options.vector_accuracy(), observer);
            if let Some(reason) = not_converged(found)? {
                observer.event(Event::Warning(&left_out(number, &sample, &reason)));
            }
        }
        Ok(())
    }

    /// The equilibrium at a sample.
    pub(super) fn equilibrium(&self, sample: Sample) -> Result<Equilibrium> {
        let state = self.states.iter().find(|state| state.sample == sample).expect("every sample has a state");
        let (u, responses) = (state.u.duplicate()?, state.responses.clone());
        Ok(Equilibrium { u, responses, friction: sample.friction, steps: Vec::new() })
    }

    /// The stiffness at a state with contact and without friction's coupling. Collective.
    pub(super) fn reference_stiffness(&self, model: &FullModel, system: &System, sample: Sample) -> Result<Matrix> {
        let equilibrium = self.equilibrium(sample)?;
        Sweep::new(system, &model.interface, false)?.symmetric_stiffness(&equilibrium)
    }

    /// Adds equilibria, modes, which are given up, and static answers to a basis whose energy is that of a state.
    /// Collective.
    pub(super) fn span(
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
        for (i, modes) in std::mem::take(&mut self.modes).into_iter().enumerate() {
            let n = basis.add(modes, negligible)?;
            report.coordinates_of_modes += n;
            report.coordinates_of_parts += if i < self.n_own { 0 } else { n };
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
    pub(super) fn test_values(&self, options: &GalerkinOptions) -> Vec<f64> {
        let sorted = |samples: &mut dyn Iterator<Item = Sample>| {
            let mut values: Vec<f64> = samples.filter(is_own).map(|sample| sample.friction).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let modes = sorted(&mut options.modes.iter().copied());
        let states = sorted(&mut self.states[..self.n_starts].iter().map(|state| state.sample));
        modes.windows(2).filter_map(|ends| empty_middle(&states, 0.5 * (ends[0] + ends[1]))).collect()
    }
}

/// Why something did not converge; other errors stay what they are.
fn not_converged(outcome: Result<()>) -> Result<Option<Error>> {
    match outcome {
        Err(error) if error.kind() == ErrorKind::NotConverged => Ok(Some(error)),
        outcome => outcome.map(|()| None),
    }
}

/// The warning of a sample without an equilibrium.
fn left_out(number: usize, sample: &Sample, reason: &Error) -> String {
    let Sample { friction, pressure, contact_stiffness } = sample;
    format!(
        "the super-element goes without equilibrium {number} of other parts, at friction {friction:.3}, pressure \
         {pressure:.3} and contact stiffness {contact_stiffness:.3}: {reason}"
    )
}

/// The place of the value that is nearest to another one; the first of several.
fn nearest(values: impl Iterator<Item = f64>, to: f64) -> Option<usize> {
    let distances = values.map(|value| (value - to).abs()).enumerate();
    distances.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(place, _)| place)
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
    use std::path::PathBuf;

    #[test]
    fn tests_are_made_where_there_is_no_equilibrium() {
        let states = [0.1, 0.2, 0.3, 0.4];
        assert_eq!(empty_middle(&states, 0.2), Some(0.5 * (0.2 + 0.3)));
        assert_eq!(empty_middle(&states, 0.36), Some(0.35));
        assert_eq!(empty_middle(&states, 0.5), None);
    }

    #[test]
    fn an_equilibrium_that_is_not_found_is_left_out_and_other_errors_are_not() {
        assert!(not_converged(Ok(())).unwrap().is_none());
        let reason = not_converged(Err(Error::not_converged("no equilibrium"))).unwrap().unwrap();
        let text = left_out(7, &Sample { pressure: 0.4, ..Sample::at(0.25) }, &reason);
        assert!(text.contains("equilibrium 7 of other parts, at friction 0.250, pressure 0.400"), "{text}");
        assert!(text.contains("no equilibrium"), "{text}");
        assert!(not_converged(Err(Error::input("a file"))).is_err());
    }

    #[test]
    fn the_nearest_value_is_the_first_of_several() {
        let nearest = |to| nearest([0.5, 0.1, 0.3, 0.5].into_iter(), to);
        assert_eq!([0.2001, 0.05, 0.9].map(nearest), [Some(2), Some(1), Some(0)]);
        assert_eq!(super::nearest([].into_iter(), 0.3), None);
    }

    #[test]
    fn one_sample_of_other_parts_is_for_modes() {
        let samples = [0.1, 0.5, 0.9].map(Sample::at);
        let path = with_modes_at(&samples, 1, 300.0);
        assert_eq!(path, [(samples[0], None), (samples[1], Some(300.0)), (samples[2], None)]);
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
}
