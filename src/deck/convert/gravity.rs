//! `*DLOAD`, GRAV: the weight of parts and masses.
//!
//! A mass element weighs where it is in the set, as in Abaqus and CalculiX; a set without a name is all of the deck.

use std::collections::BTreeMap;

use super::Conversion;
use super::bodies::UNUSED;
use super::history::State;
use super::supports::add;
use crate::Result;
use crate::deck::sets::Kind;
use crate::deck::types::{ActionKind, Entry};
use crate::model::{Load, LoadKind, Model, Place};

/// Accelerations by axis, each with the step that it is of, and the place of the last one.
type Acceleration = ([(usize, f64); 3], Place);

impl Conversion<'_> {
    /// The gravity that acts at the end of the last step: one load where all parts and masses have the same.
    pub(super) fn gravity(&self, state: &State, model: &Model) -> Result<Vec<Load>> {
        let mut all: BTreeMap<String, Acceleration> = BTreeMap::new();
        for (step, action) in state.actions() {
            let ActionKind::Gravity(of, value) = &action.what else { continue };
            for name in self.weighing(of.as_ref(), action.place)? {
                let known = all.entry(name).or_default();
                known.0.iter_mut().zip(value).for_each(|(sum, value)| add(sum, step, *value));
                known.1 = action.place;
            }
        }
        let unit = self.units.acceleration();
        let load = |(on, (sum, place)): (String, Acceleration)| {
            let kind = LoadKind::Gravity(sum.map(|(_, value)| value * unit));
            Load { name: format!("gravity on {on}"), on, kind, place }
        };
        let loads: Vec<Load> =
            all.into_iter().map(load).filter(|load| load.kind != LoadKind::Gravity([0.0; 3])).collect();
        let n_masses = model.masses.iter().filter(|mass| mass.mass != 0.0).count();
        match &loads[..] {
            [first, rest @ ..]
                if loads.len() == model.parts.len() + n_masses && rest.iter().all(|load| load.kind == first.kind) =>
            {
                Ok(vec![Load { name: "gravity".into(), on: String::new(), ..first.clone() }])
            }
            _ => Ok(loads),
        }
    }

    /// The parts and masses of a set of elements, or of all.
    fn weighing(&self, of: Option<&Entry>, place: Place) -> Result<Vec<String>> {
        let elements = match of {
            Some(of) => self.assembly.set(Kind::Element, 0, of, place)?,
            None => (0..self.assembly.elements.len() as u32).collect(),
        };
        let mut names = Vec::new();
        let of_parts = elements.iter().map(|&e| self.bodies.part_of[e as usize]);
        let (own, all) = (self.counts(of_parts), self.counts(self.bodies.part_of.iter().copied()));
        for (part, (own, all)) in self.bodies.parts.iter().zip(own.into_iter().zip(all)) {
            self.require_whole(own, all, &part.name, place)?;
            names.extend((own > 0).then(|| part.name.clone()));
        }
        for (name, own) in &self.mass_elements {
            let n = own.iter().filter(|element| elements.binary_search(element).is_ok()).count();
            self.require_whole(n, own.len(), name, place)?;
            names.extend((n > 0).then(|| name.clone()));
        }
        match names.is_empty() {
            false => Ok(names),
            true => Err(self.assembly.error(place, "GRAV acts on nothing that has mass: name solids or masses")),
        }
    }

    /// Number of elements of each part.
    fn counts(&self, parts: impl Iterator<Item = u32>) -> Vec<usize> {
        let mut counts = vec![0; self.bodies.parts.len()];
        parts.filter(|&part| part != UNUSED).for_each(|part| counts[part as usize] += 1);
        counts
    }

    fn require_whole(&self, n: usize, all: usize, name: &str, place: Place) -> Result<()> {
        if n == 0 || n == all {
            return Ok(());
        }
        let what = format_args!("GRAV acts on {n} of the {all} elements of {name}. Give it to all of them");
        Err(self.assembly.error(place, what))
    }
}
