//! Which contact pairs slide.

use super::{Contact, Model, Rotation};
use crate::mesh::Mesh;

impl Model {
    /// The rotation under which a contact pair slides steadily: that of its master, where the slave does not turn.
    ///
    /// None on pairs that stick: neither part turns, or both turn together. Meant for a model that
    /// [`Model::check_against`] accepts.
    pub fn sliding(&self, contact: &Contact, mesh: &Mesh) -> Option<&Rotation> {
        match (self.turning(&contact.slave, mesh), self.turning(&contact.master, mesh)) {
            (None, Some(rotation)) => Some(rotation),
            _ => None,
        }
    }

    /// Indices of the contacts whose friction coefficient a sweep changes: those it names, or all that slide.
    pub fn swept_contacts(&self, mesh: &Mesh) -> Vec<usize> {
        let is_swept = |contact: &Contact| {
            if self.swept.is_empty() {
                self.sliding(contact, mesh).is_some()
            } else {
                self.swept.contains(&contact.name)
            }
        };
        (0..self.contacts.len()).filter(|&i| is_swept(&self.contacts[i])).collect()
    }

    /// The rotation of the part that a surface lies on.
    pub(super) fn turning(&self, surface: &str, mesh: &Mesh) -> Option<&Rotation> {
        let part = &mesh.parts[mesh.part_of_surface(surface)? as usize];
        self.rotations.iter().find(|rotation| &rotation.part == part)
    }
}
