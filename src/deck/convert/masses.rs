//! Masses and rotary inertias on reference nodes and nodes of solids.

use super::Conversion;
use super::discrete::End;
use super::references::References;
use super::regions::unlike;
use crate::Result;
use crate::deck::VOIGT_ORDER;
use crate::deck::types::{Property, PropertyKind};
use crate::model::{GROUND, Model, PointMass};

impl Conversion<'_> {
    /// A mass or inertia on a reference node or a node of a solid; both on one node are one mass.
    pub(super) fn mass(
        &mut self,
        element: u32,
        property: &Property,
        references: &References,
        model: &mut Model,
    ) -> Result<()> {
        let (node, place) = (self.assembly.nodes(element)[0], self.assembly.elements[element as usize].place);
        let acts = [true, true, true, false, false, false];
        let is_inertia = property.kind == PropertyKind::RotaryInertia;
        if is_inertia && references.at(node).is_none() {
            return Err(self
                .assembly
                .error(place, "a rotary inertia is supported on a reference node. Couple the node to a surface"));
        }
        let End { region, at } = self.end(node, acts, references, place)?;
        if region == GROUND {
            return Ok(());
        }
        let known = model.masses.iter().position(|mass| mass.nodes == region && mass.at == Some(at));
        let i = known.unwrap_or_else(|| {
            let name = unlike(&region, |name| model.masses.iter().any(|own| own.name == name), "mass");
            model.masses.push(PointMass { name, nodes: region, at: Some(at), mass: 0.0, inertia: [0.0; 6], place });
            model.masses.len() - 1
        });
        let unit = if is_inertia { self.units.mass * self.units.length.powi(2) } else { self.units.mass };
        match is_inertia {
            true => VOIGT_ORDER
                .iter()
                .zip(property.values)
                .for_each(|(&own, value)| model.masses[i].inertia[own] += value * unit),
            false => {
                model.masses[i].mass += property.values[0] * unit;
                self.mass_elements.entry(model.masses[i].name.clone()).or_default().push(element);
            }
        }
        Ok(())
    }
}
