//! The law of a contact pair that the user leaves to the program: `law = "auto"`, and `HARD` or nothing in a deck.
//!
//! A penalty is stiff enough where the overlap is small beside the deformation of the elements next to it, and stiffer
//! only costs digits. So it is a multiple of the stiffness per area of a layer of elements of the softer side:
//!
//! ```text
//! k_n = 10 min(E_slave / h_slave, E_master / h_master)       k_t = k_n / 2
//! ```
//!
//! E is the smallest Young's modulus of the part, h the edge of a mean facet of the surface, taken for a square or, if
//! it is a triangle, half of one.
//! The factor is that of Abaqus's default penalty, "10 times the representative underlying element stiffness" (Abaqus
//! Analysis User's Guide, "Contact constraint enforcement methods in Abaqus/Standard").

use std::fmt::{Display, Formatter};

use super::{Contact, Model, NormalLaw, softest_young};
use crate::element::facet::area;
use crate::mesh::Mesh;

/// Multiple of the stiffness of a layer of elements.
const STIFFNESS_FACTOR: f64 = 10.0;
/// Stick over normal stiffness.
const STICK_RATIO: f64 = 0.5;

/// The stiffness of a contact pair for which the user gives none.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedStiffness {
    /// Name of the contact pair.
    pub contact: String,
    /// Normal stiffness, N/m3.
    pub stiffness: f64,
    /// Elastic stick, N/m3, where that is proposed, too.
    pub stick: Option<f64>,
}

impl Display for ProposedStiffness {
    fn fmt(&self, out: &mut Formatter) -> std::fmt::Result {
        write!(out, "proposed: the contact {} gets a stiffness of {:.3e} N/m3", self.contact, self.stiffness)?;
        self.stick.map_or(Ok(()), |stick| write!(out, " and sticks with {stick:.3e} N/m3"))
    }
}

impl Model {
    /// The normal law of a contact pair: the user's, or the proposed one. Meant for a mesh with the pair's surfaces.
    pub fn normal_law(&self, contact: &Contact, mesh: &Mesh) -> NormalLaw {
        contact.law.clone().unwrap_or_else(|| NormalLaw::Linear { stiffness: self.proposed_stiffness(contact, mesh) })
    }

    /// The elastic stick of a contact pair, N/m3: the user's, or a part of the stiffness where the pair needs a stick
    /// and has none. None on pairs that slide for ever or have no friction.
    pub fn stick(&self, contact: &Contact, mesh: &Mesh) -> Option<f64> {
        contact.stick.or_else(|| {
            let is_proposed = contact.law.is_none() && self.has_friction(contact);
            (is_proposed && self.sliding(contact, mesh).is_none()).then(|| self.half_stiffness(contact, mesh))
        })
    }

    /// What becomes the stick of a pair whose stick is to be proposed, N/m3.
    pub fn half_stiffness(&self, contact: &Contact, mesh: &Mesh) -> f64 {
        let stiffness = self.normal_law(contact, mesh).initial_stiffness();
        STICK_RATIO * stiffness
    }

    /// The pairs of which the program proposes the stiffness. Meant for a mesh with their surfaces.
    pub fn proposed(&self, mesh: &Mesh) -> Vec<ProposedStiffness> {
        let proposed = |contact: &Contact| ProposedStiffness {
            contact: contact.name.clone(),
            stiffness: self.proposed_stiffness(contact, mesh),
            stick: self.stick(contact, mesh).filter(|_| contact.stick.is_none()),
        };
        self.contacts.iter().filter(|contact| contact.law.is_none()).map(proposed).collect()
    }

    /// `k_n`, N/m3.
    fn proposed_stiffness(&self, contact: &Contact, mesh: &Mesh) -> f64 {
        let layer = |name: &str| {
            let surface = &mesh.surfaces[name];
            let size = surface.facet_size(surface.facets.iter().map(|facet| area(&facet.positions(&mesh.nodes))).sum());
            softest_young(&self.parts, mesh, &[name]) / size
        };
        STIFFNESS_FACTOR * layer(&contact.slave).min(layer(&contact.master))
    }

    /// Whether a contact has friction, in the file or in the sweep.
    pub(super) fn has_friction(&self, contact: &Contact) -> bool {
        let swept = self.swept.contains(&contact.name);
        contact.friction > 0.0 || (swept && self.frictions.iter().any(|&friction| friction > 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{mesh, model};

    fn pads_on_disc(change: impl Fn(&str) -> String) -> (Model, Mesh) {
        let path = "tests/data/pads_on_disc.toml";
        let text = std::fs::read_to_string(path).unwrap();
        let model = model::parse(&change(&text), path.as_ref()).unwrap();
        let mesh = mesh::read(&model.mesh_file, model.mesh_unit).unwrap();
        (model, mesh)
    }

    fn auto(text: &str) -> String {
        text.replace("law = { linear = 2e13 }", "law = \"auto\"")
    }

    #[test]
    fn the_stiffness_is_ten_times_that_of_a_layer_of_the_softer_side() {
        let (model, mesh) = pads_on_disc(auto);
        let contact = &model.contacts[0];
        assert_eq!(contact.law, None);
        let surface = &mesh.surfaces[&contact.slave];
        let size = surface.facet_size(surface.facets.iter().map(|own| area(&own.positions(&mesh.nodes))).sum());
        let lining = softest_young(&model.parts, &mesh, &[&contact.slave]);
        let NormalLaw::Linear { stiffness } = model.normal_law(contact, &mesh) else { panic!() };
        assert!((stiffness * size / (10.0 * lining) - 1.0).abs() < 1e-12, "{stiffness}");
        let found = model.proposed(&mesh);
        assert_eq!((found.len(), found[0].stiffness, found[0].stick), (2, stiffness, None));
    }

    #[test]
    fn a_pair_that_does_not_slide_sticks_with_half_of_its_stiffness() {
        let (model, mesh) = pads_on_disc(|text| {
            let (before, rotation) = text.split_once("[[rotation]]").unwrap();
            let (_, after) = rotation.split_once("\n[").unwrap();
            auto(&format!("{before}[{after}"))
        });
        model.check_against(&mesh).unwrap();
        let NormalLaw::Linear { stiffness } = model.normal_law(&model.contacts[0], &mesh) else { panic!() };
        assert_eq!(model.stick(&model.contacts[0], &mesh), Some(0.5 * stiffness));
        assert!(model.proposed(&mesh)[0].to_string().contains(" and sticks with "));
    }

    #[test]
    fn what_the_user_gives_is_not_proposed() {
        let (model, mesh) = pads_on_disc(str::to_owned);
        assert_eq!(model.normal_law(&model.contacts[0], &mesh), model.contacts[0].law.clone().unwrap());
        assert_eq!((model.proposed(&mesh).len(), model.stick(&model.contacts[0], &mesh)), (0, None));
    }
}
