//! What the last step computes.

use super::Conversion;
use crate::deck::types::Procedure;

/// Band of a deck that names none, Hz: most of what is heard as squeal.
const USUAL_BAND: [f64; 2] = [0.0, 10e3];

/// What to compute.
pub(super) struct Settings {
    /// Hz.
    pub band: [f64; 2],
    /// Whether friction damps.
    pub friction_damping: bool,
    /// Whether stresses stiffen the modes, where the deck says so.
    pub prestress: Option<bool>,
}

impl Conversion<'_> {
    /// The band of the last step that has one; real modes count where there are no complex ones.
    pub(super) fn settings(&mut self) -> Settings {
        let procedures = || self.deck.steps.iter().rev().map(|step| step.procedure);
        let complex = procedures().find_map(|procedure| match procedure {
            Procedure::ComplexFrequency { band, friction_damping, .. } => Some((band, friction_damping)),
            _ => None,
        });
        let real = procedures().find_map(|procedure| match procedure {
            Procedure::Frequency(band) => Some((band, false)),
            _ => None,
        });
        let friction_damping = complex.is_some_and(|(_, damping)| damping);
        let bands = [complex, real].into_iter().flatten().map(|(band, _)| band);
        let ends = bands.into_iter().find_map(|[low, high]| high.map(|high| [low.unwrap_or(0.0).max(0.0), high]));
        let band = ends.map(|ends| ends.map(|end| end / self.units.time)).filter(|[low, high]| low < high);
        if band.is_none() {
            self.notes.push(format!(
                "no step has a highest frequency: the band is {} to {} Hz",
                USUAL_BAND[0], USUAL_BAND[1]
            ));
        }
        Settings { band: band.unwrap_or(USUAL_BAND), friction_damping, prestress: self.prestress() }
    }

    /// Stresses stiffen modes in a step with PERTURBATION, after one with NLGEOM. Abaqus needs both.
    fn prestress(&mut self) -> Option<bool> {
        let steps = &self.deck.steps;
        let modes = steps.iter().position(|step| step.perturbation && step.procedure.is_of_modes())?;
        if steps[..modes].iter().any(|step| step.nlgeom) {
            return Some(true);
        }
        self.notes.push("PERTURBATION without NLGEOM in a step before: stresses do not stiffen the modes".to_owned());
        None
    }
}
