//! What the names of sets and surfaces mean.

use super::assembly::Assembly;
use super::types::{Entry, Scope, SetDefinition, SurfaceDefinition, SurfaceItem};
use crate::model::{Place, names};
use crate::{Error, Result};
use std::collections::HashSet;

/// Sets may be nested this deep.
const DEEPEST: usize = 64;

/// Nodes or elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Nodes.
    Node,
    /// Elements.
    Element,
}

impl Kind {
    fn word(self) -> &'static str {
        match self {
            Kind::Node => "node",
            Kind::Element => "element",
        }
    }

    fn sets(self, scope: &Scope) -> &[SetDefinition] {
        match self {
            Kind::Node => &scope.node_sets,
            Kind::Element => &scope.element_sets,
        }
    }
}

/// What a surface consists of.
pub enum Faces {
    /// Element and face, from 1.
    OfElements(Vec<(u32, u8)>),
    /// Nodes.
    Nodes(Vec<u32>),
}

impl Assembly<'_> {
    /// Indices of what an entry of a space means, in its order.
    ///
    /// # Errors
    /// [`Error::Input`] at `place` where it means nothing, and for sets that contain themselves.
    pub fn members(&self, kind: Kind, space: usize, entry: &Entry, place: Place) -> Result<Vec<u32>> {
        let mut found = Vec::new();
        self.collect(kind, space, entry, place, &mut Vec::new(), &mut found)?;
        Ok(found)
    }

    /// The same, sorted, each once.
    ///
    /// # Errors
    /// As [`Assembly::members`].
    pub fn set(&self, kind: Kind, space: usize, entry: &Entry, place: Place) -> Result<Vec<u32>> {
        let mut found = self.members(kind, space, entry, place)?;
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }

    fn collect(
        &self,
        kind: Kind,
        space: usize,
        entry: &Entry,
        place: Place,
        path: &mut Vec<(usize, String)>,
        found: &mut Vec<u32>,
    ) -> Result<()> {
        let numbers = match kind {
            Kind::Node => &self.spaces[space].nodes,
            Kind::Element => &self.spaces[space].elements,
        };
        let word = kind.word();
        match entry {
            Entry::Number(number) => match numbers.get(*number) {
                Some(index) => found.push(index),
                None => return Err(self.error(place, format_args!("there is no {word} {number}"))),
            },
            Entry::Range(first, last, step) => {
                let range = numbers.range(*first, *last, *step);
                if range.is_empty() {
                    return Err(self.error(place, format_args!("there is no {word} from {first} to {last}")));
                }
                found.extend(range);
            }
            Entry::Name(name) => self.collect_named(kind, space, name, place, path, found)?,
        }
        Ok(())
    }

    fn collect_named(
        &self,
        kind: Kind,
        space: usize,
        name: &str,
        place: Place,
        path: &mut Vec<(usize, String)>,
        found: &mut Vec<u32>,
    ) -> Result<()> {
        let step = (space, name.to_owned());
        if path.contains(&step) || path.len() >= DEEPEST {
            return Err(self.error(place, format_args!("the set {} contains itself", self.deck.spelled(name))));
        }
        let mut is_known = false;
        path.push(step);
        for definition in self.spaces[space].scopes.iter().flat_map(|scope| kind.sets(scope)) {
            if definition.name != name {
                continue;
            }
            is_known = true;
            let inside = self.space_of(definition.instance.as_deref(), space, definition.place)?;
            for (entry, place) in &definition.entries {
                self.collect(kind, inside, entry, *place, path, found)?;
            }
        }
        path.pop();
        match (is_known, self.in_instance(space, name)) {
            (true, _) => Ok(()),
            (false, Some((inside, entry))) => self.collect(kind, inside, &entry, place, path, found),
            (false, None) => Err(self.unknown(kind, space, name, place)),
        }
    }

    /// `INSTANCE.NAME` seen from outside: the space and what is in it.
    fn in_instance(&self, space: usize, name: &str) -> Option<(usize, Entry)> {
        let (instance, rest) = name.split_once('.').filter(|_| space == 0)?;
        let inside = self.spaces.iter().position(|space| !instance.is_empty() && space.name == instance)?;
        Some((inside, super::parse::entry(rest)))
    }

    /// The space of an instance that a definition names, or its own.
    fn space_of(&self, instance: Option<&str>, own: usize, place: Place) -> Result<usize> {
        let Some(name) = instance else { return Ok(own) };
        self.spaces.iter().position(|space| space.name == name).ok_or_else(|| {
            let instances = self.deck.instances.iter().map(|instance| instance.name.as_str());
            self.error(place, format_args!("there is no instance {name}. {}", names::advice(name, instances)))
        })
    }

    fn unknown(&self, kind: Kind, space: usize, name: &str, place: Place) -> Error {
        let known = self.set_names(kind, space);
        let advice = names::advice(name, known.iter().map(String::as_str));
        let (word, name) = (kind.word(), self.deck.spelled(name));
        self.error(place, format_args!("there is no {word} set {name}. {advice}"))
    }

    /// The names of all sets of a space; from outside also those of the instances.
    pub fn set_names(&self, kind: Kind, space: usize) -> Vec<String> {
        let seen = self.spaces.iter().enumerate().filter(|(i, _)| space == 0 || *i == space);
        let mut all: Vec<String> = Vec::new();
        for (i, seen) in seen {
            let definitions = seen.scopes.iter().flat_map(|scope| kind.sets(scope));
            let name = |set: &SetDefinition| if i == space { set.name.clone() } else { seen.outside_name(&set.name) };
            all.extend(definitions.map(name));
        }
        all.sort();
        all.dedup();
        all
    }

    /// The definition of a surface seen from outside, and its space.
    ///
    /// # Errors
    /// [`Error::Input`] at `place` where there is none.
    pub fn surface(&self, name: &str, place: Place) -> Result<(usize, &SurfaceDefinition)> {
        let in_space = |space: usize, name: &str| {
            let surfaces = self.spaces[space].scopes.iter().flat_map(|scope| &scope.surfaces);
            surfaces.into_iter().find(|surface| surface.name == name).map(|surface| (space, surface))
        };
        let in_instance = || match self.in_instance(0, name)? {
            (space, Entry::Name(rest)) => in_space(space, &rest),
            _ => None,
        };
        in_space(0, name).or_else(in_instance).ok_or_else(|| {
            let known = self.surface_names();
            let advice = names::advice(name, known.iter().map(String::as_str));
            self.error(place, format_args!("there is no surface {}. {advice}", self.deck.spelled(name)))
        })
    }

    /// The names of all surfaces, seen from outside.
    pub fn surface_names(&self) -> Vec<String> {
        let names = |space: &super::assembly::Space| {
            let surfaces = space.scopes.iter().flat_map(|scope| &scope.surfaces);
            surfaces.map(|surface| space.outside_name(&surface.name)).collect::<Vec<_>>()
        };
        self.spaces.iter().flat_map(names).collect()
    }

    /// What a surface consists of, each once, faces in the order of the deck. A contact point in the corner of two
    /// walls meets the first of them, so that another order would be another model.
    ///
    /// # Errors
    /// [`Error::Input`] for sets, elements and faces that are not there, and for a surface of nothing.
    pub fn faces(&self, space: usize, surface: &SurfaceDefinition) -> Result<Faces> {
        let space = self.space_of(surface.instance.as_deref(), space, surface.place)?;
        if surface.items.is_empty() {
            return Err(
                self.error(surface.place, format_args!("the surface {} is empty", self.deck.spelled(&surface.name)))
            );
        }
        if surface.of_nodes {
            let mut nodes = Vec::new();
            for item in &surface.items {
                nodes.extend(self.members(Kind::Node, space, &item.of, item.place)?);
            }
            nodes.sort_unstable();
            nodes.dedup();
            return Ok(Faces::Nodes(nodes));
        }
        let mut faces = Vec::new();
        for item in &surface.items {
            self.item_faces(space, item, &mut faces)?;
        }
        let mut seen = HashSet::new();
        faces.retain(|face| seen.insert(*face));
        Ok(Faces::OfElements(faces))
    }

    fn item_faces(&self, space: usize, item: &SurfaceItem, faces: &mut Vec<(u32, u8)>) -> Result<()> {
        let elements = self.set(Kind::Element, space, &item.of, item.place)?;
        let before = faces.len();
        match item.face {
            Some(face) => faces.extend(self.with_face(&elements, face, item.place)?),
            None => {
                let skin = self.skin().into_iter();
                faces.extend(skin.filter(|(element, _)| elements.binary_search(element).is_ok()));
            }
        }
        if faces.len() == before {
            return Err(self.error(item.place, "no element has a face here: the surface is of nothing"));
        }
        Ok(())
    }

    /// The face of each element of a list.
    ///
    /// # Errors
    /// [`Error::Input`] for an element without such a face.
    pub fn with_face(&self, elements: &[u32], face: u8, place: Place) -> Result<Vec<(u32, u8)>> {
        match elements.iter().find(|element| self.face(**element, face).is_none()) {
            None => Ok(elements.iter().map(|&element| (element, face)).collect()),
            Some(&element) => {
                let element = &self.elements[element as usize];
                let what =
                    format_args!("element {} is a {}, which has no face {face}", element.number, element.kind.name);
                Err(self.error(place, what))
            }
        }
    }

    /// `file:line: message`.
    pub fn error(&self, place: Place, message: impl std::fmt::Display) -> Error {
        place.error(&self.deck.files, message)
    }
}
