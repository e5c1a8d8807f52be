//! Parts, instances and what stands beside them as one mesh with one numbering; sets and surfaces by their names.
//!
//! Each instance, and what stands outside all of them, is a *space* with numbers and names of its own. From outside,
//! `INSTANCE.NAME` and `INSTANCE.NUMBER` mean what is in an instance.

use std::collections::HashMap;

use super::elements::{Class, ElementKind};
use super::numbers::Numbers;
use super::types::{Deck, Instance, Nodes, Scope, Turn};
use crate::Result;
use crate::algebra::{cross, dot, norm, scale, sub};
use crate::model::Place;

/// A place in which numbers and names mean one thing.
pub struct Space<'d> {
    /// Name of the instance; empty outside.
    pub name: String,
    /// What is defined in it: the part's and the instance's own.
    pub scopes: Vec<&'d Scope>,
    /// Indices of its nodes by their numbers.
    pub nodes: Numbers,
    /// Indices of its elements by their numbers.
    pub elements: Numbers,
}

/// An element of the assembly.
pub struct Element {
    /// Its kind.
    pub kind: &'static ElementKind,
    /// Its number in its space.
    pub number: u32,
    /// Index of its space.
    pub space: u32,
    /// Where it stands.
    pub place: Place,
    /// Index of its first node in [`Assembly::connectivity`].
    first: usize,
}

/// A deck with one numbering.
pub struct Assembly<'d> {
    /// The deck.
    pub deck: &'d Deck,
    /// What stands outside instances, then the instances.
    pub spaces: Vec<Space<'d>>,
    /// Coordinates of all nodes, in the deck's unit.
    pub coordinates: Vec<[f64; 3]>,
    /// Their numbers, each in its space.
    pub numbers: Vec<u32>,
    /// All elements.
    pub elements: Vec<Element>,
    /// Nodes of the elements, element by element.
    connectivity: Vec<u32>,
}

impl<'d> Assembly<'d> {
    /// Puts the deck together.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input): numbers that mean two things or nothing, instances of no part.
    pub fn new(deck: &'d Deck) -> Result<Assembly<'d>> {
        let (coordinates, numbers, elements, connectivity) = Default::default();
        let mut assembly = Assembly { deck, spaces: Vec::new(), coordinates, numbers, elements, connectivity };
        let outside = Space::new(String::new(), vec![&deck.assembly]);
        assembly.add(outside, &|x| x)?;
        for instance in &deck.instances {
            let part = deck.parts.iter().find(|part| part.name == instance.part).ok_or_else(|| {
                let (name, part) = (deck.spelled(&instance.name), deck.spelled(&instance.part));
                instance.place.error(&deck.files, format_args!("there is no part {part} (instance {name})"))
            })?;
            let space = Space::new(instance.name.clone(), vec![part, &instance.own]);
            assembly.add(space, &|x| placed(instance, x))?;
        }
        match deck.parts.iter().find(|part| !deck.instances.iter().any(|instance| instance.part == part.name)) {
            None => Ok(assembly),
            Some(part) => {
                let what = format_args!("the part {} has no instance. Add an *INSTANCE", deck.spelled(&part.name));
                Err(part.place.error(&deck.files, what))
            }
        }
    }

    fn add(&mut self, mut space: Space<'d>, place: &dyn Fn([f64; 3]) -> [f64; 3]) -> Result<()> {
        for scope in space.scopes.clone() {
            self.add_nodes(&mut space, &scope.nodes, place)?;
        }
        for scope in space.scopes.clone() {
            self.add_elements(&mut space, scope)?;
        }
        self.spaces.push(space);
        Ok(())
    }

    /// A number that is there already is accepted with the same coordinates.
    fn add_nodes(&mut self, space: &mut Space, nodes: &Nodes, place: &dyn Fn([f64; 3]) -> [f64; 3]) -> Result<()> {
        space.nodes.reserve(&nodes.numbers);
        for (i, (&number, &x)) in nodes.numbers.iter().zip(&nodes.coordinates).enumerate() {
            let (x, index) = (place(x), self.coordinates.len() as u32);
            match space.nodes.insert(number, index) {
                None => {
                    self.coordinates.push(x);
                    self.numbers.push(number);
                }
                Some(other) if self.coordinates[other as usize] == x => {}
                Some(_) => {
                    let what =
                        format_args!("node {number} is there already, with other coordinates. Renumber one of them");
                    return Err(nodes.places[i].error(&self.deck.files, what));
                }
            }
        }
        Ok(())
    }

    fn add_elements(&mut self, space: &mut Space, scope: &Scope) -> Result<()> {
        let files = &self.deck.files;
        for block in &scope.elements {
            space.elements.reserve(&block.numbers);
            for (i, nodes) in block.nodes.chunks_exact(block.kind.n_nodes).enumerate() {
                let (number, place) = (block.numbers[i], block.places[i]);
                if space.elements.insert(number, self.elements.len() as u32).is_some() {
                    let what = format_args!("element {number} is there already. Renumber one of them");
                    return Err(place.error(files, what));
                }
                let first = self.connectivity.len();
                for &node in nodes {
                    let index = space.nodes.get(node).ok_or_else(|| {
                        place.error(files, format_args!("element {number} has node {node}, which is not there"))
                    })?;
                    self.connectivity.push(index);
                }
                let space = self.spaces.len() as u32;
                self.elements.push(Element { kind: block.kind, number, space, place, first });
            }
        }
        Ok(())
    }

    /// A direction of a space in the assembly.
    pub fn turned(&self, space: usize, direction: [f64; 3]) -> [f64; 3] {
        let turn = space.checked_sub(1).and_then(|instance| self.deck.instances[instance].rotation);
        turn.map_or(direction, |turn| sub(turned(&turn, direction), turned(&turn, [0.0; 3])))
    }

    /// Nodes of an element.
    pub fn nodes(&self, element: u32) -> &[u32] {
        let Element { kind, first, .. } = self.elements[element as usize];
        &self.connectivity[first..first + kind.n_nodes]
    }

    /// Nodes of a face of an element, from 1; none where it has no such face.
    pub fn face(&self, element: u32, face: u8) -> Option<Vec<u32>> {
        let Class::Solid(faces) = self.elements[element as usize].kind.class else { return None };
        let nodes = self.nodes(element);
        faces.get(usize::from(face).wrapping_sub(1)).map(|face| face.iter().map(|&i| nodes[i]).collect())
    }

    /// Indices of the solid elements.
    pub fn solids(&self) -> impl Iterator<Item = u32> + '_ {
        let is_solid = |&e: &u32| matches!(self.elements[e as usize].kind.class, Class::Solid(_));
        (0..self.elements.len() as u32).filter(is_solid)
    }

    /// The faces of solids that have a solid on one side alone: element and face, from 1.
    pub fn skin(&self) -> Vec<(u32, u8)> {
        let mut faces: HashMap<[u32; 4], Option<(u32, u8)>> = HashMap::new();
        for element in self.solids() {
            for number in 1..=6 {
                let Some(face) = self.face(element, number) else { break };
                let known = faces.entry(corners(&face)).or_insert(Some((element, number)));
                if *known != Some((element, number)) {
                    *known = None;
                }
            }
        }
        let mut skin: Vec<(u32, u8)> = faces.into_values().flatten().collect();
        skin.sort_unstable();
        skin
    }
}

/// The corners of a face, sorted; three or four.
fn corners(face: &[u32]) -> [u32; 4] {
    let n = match face.len() {
        3 | 6 => 3,
        _ => 4,
    };
    let mut key = [u32::MAX; 4];
    key[..n].copy_from_slice(&face[..n]);
    key.sort_unstable();
    key
}

impl<'d> Space<'d> {
    fn new(name: String, scopes: Vec<&'d Scope>) -> Space<'d> {
        Space { name, scopes, nodes: Numbers::default(), elements: Numbers::default() }
    }

    /// How an item of this space is called from outside.
    pub fn outside_name(&self, name: &str) -> String {
        if self.name.is_empty() { name.to_owned() } else { format!("{}.{name}", self.name) }
    }
}

/// A point of a part in its instance: moved, then turned.
fn placed(instance: &Instance, x: [f64; 3]) -> [f64; 3] {
    let moved = [0, 1, 2].map(|i| x[i] + instance.translation[i]);
    instance.rotation.map_or(moved, |turn| turned(&turn, moved))
}

/// Rodrigues' formula: `x' = o + r cos a + (k x r) sin a + k (k.r) (1 - cos a)` with `r = x - o`.
fn turned(turn: &Turn, x: [f64; 3]) -> [f64; 3] {
    let axis = sub(turn.to, turn.from);
    let k = scale(1.0 / norm(axis), axis);
    let r = sub(x, turn.from);
    let (sin, cos) = turn.degrees.to_radians().sin_cos();
    let (across, along) = (cross(k, r), dot(k, r) * (1.0 - cos));
    [0, 1, 2].map(|i| turn.from[i] + r[i] * cos + across[i] * sin + k[i] * along)
}
