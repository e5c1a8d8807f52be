//! A section of several bodies that touch one another: each body is a part of its own, since a contact pair is between
//! two parts.

use pathfinding::undirected::connected_components::separate_components;

use super::bodies::{Bodies, UNUSED};
use super::regions::unlike;
use crate::Result;
use crate::deck::assembly::Assembly;
use crate::deck::sets::Faces;
use crate::model::Place;

impl Bodies {
    /// Separates the parts on which both sides of a contact pair or tie lie. Returns what was done.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for surfaces that are not there.
    pub(super) fn separate(&mut self, assembly: &Assembly) -> Result<Vec<String>> {
        let mut notes = Vec::new();
        let deck = assembly.deck;
        let contacts = deck.contact_pairs.iter().map(|pair| (&pair.slave, &pair.master, pair.place));
        for (slave, master, place) in contacts.chain(deck.ties.iter().map(|tie| (&tie.slave, &tie.master, tie.place))) {
            let of_master = self.parts_of(assembly, master, place)?;
            for part in self.parts_of(assembly, slave, place)? {
                if of_master.contains(&part) {
                    notes.extend(self.separate_part(assembly, part));
                }
            }
        }
        Ok(notes)
    }

    /// The parts that a surface lies on.
    fn parts_of(&self, assembly: &Assembly, surface: &str, place: Place) -> Result<Vec<u32>> {
        let (space, definition) = assembly.surface(surface, place)?;
        let part = |element: u32| self.part_of[element as usize];
        let mut parts: Vec<u32> = match assembly.faces(space, definition)? {
            Faces::OfElements(faces) => faces.into_iter().map(|(element, _)| part(element)).collect(),
            Faces::Nodes(nodes) => {
                let has_one = |element: &u32| assembly.nodes(*element).iter().any(|n| nodes.binary_search(n).is_ok());
                assembly.solids().filter(has_one).map(part).collect()
            }
        };
        parts.sort_unstable();
        parts.dedup();
        parts.retain(|&part| part != UNUSED);
        Ok(parts)
    }

    /// Makes a part of each body of a part but the first: elements with common nodes are one body.
    fn separate_part(&mut self, assembly: &Assembly, part: u32) -> Option<String> {
        let own: Vec<u32> = assembly.solids().filter(|&e| self.part_of[e as usize] == part).collect();
        let groups: Vec<Vec<u32>> = own.iter().map(|&e| assembly.nodes(e).to_vec()).collect();
        let (component_of, _) = separate_components(&groups);
        let n_others = self.parts.len();
        let mut bodies = Vec::new();
        for &element in &own {
            let component = component_of[&assembly.nodes(element)[0]];
            let known = bodies.iter().position(|body| *body == component);
            let body = known.unwrap_or_else(|| {
                bodies.push(component);
                bodies.len() - 1
            });
            if body > 0 {
                self.part_of[element as usize] = (n_others + body - 1) as u32;
            }
        }
        let first = self.parts[part as usize].clone();
        for _ in 1..bodies.len() {
            let name = unlike(&first.name, |name| self.parts.iter().any(|other| other.name == name), "body");
            self.parts.push(crate::model::Part { name, ..first.clone() });
        }
        let names: Vec<&str> = self.parts[n_others..].iter().map(|part| part.name.as_str()).collect();
        let touch = format!("{} bodies of {} touch", bodies.len(), first.name);
        (!names.is_empty()).then(|| format!("{touch}: those beside the first are the parts {}", names.join(", ")))
    }
}
