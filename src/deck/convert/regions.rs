//! Surfaces and node sets of the mesh. In a deck a surface, a set of nodes and a set of elements may have one name; in
//! a mesh each name means one thing.

use std::collections::HashMap;

use super::Conversion;
use super::bodies::UNUSED;
use crate::Result;
use crate::deck::sets::{Faces, Kind};
use crate::deck::types::Entry;
use crate::mesh::{Facet, Mesh, Skin, Surface};
use crate::model::Place;

/// The mesh while surfaces and node sets are added to it.
pub struct Regions {
    /// The mesh.
    pub mesh: Mesh,
    /// Names of the mesh's surfaces by those of the deck.
    surfaces: HashMap<String, String>,
}

/// A name, with a word behind it where it is taken.
pub fn unlike(name: &str, is_taken: impl Fn(&str) -> bool, word: &str) -> String {
    if !is_taken(name) {
        return name.to_owned();
    }
    let numbered = (1..).map(|i| if i == 1 { format!("{name} {word}") } else { format!("{name} {word} {i}") });
    numbered.into_iter().find(|name| !is_taken(name)).expect("one of them is free")
}

impl Regions {
    /// Regions of a mesh that has none yet.
    pub fn new(mesh: Mesh) -> Regions {
        Regions { mesh, surfaces: HashMap::new() }
    }

    /// A name that nothing has.
    fn free_name(&self, name: &str, word: &str) -> String {
        let mesh = &self.mesh;
        let is_taken = |name: &str| {
            mesh.parts.iter().any(|part| part == name)
                || mesh.surfaces.contains_key(name)
                || mesh.node_sets.contains_key(name)
        };
        unlike(name, is_taken, word)
    }

    /// Adds a node set, unless one of that name has the same nodes; gives its name.
    pub fn add_node_set(&mut self, name: &str, nodes: Vec<u32>) -> String {
        if self.mesh.node_sets.get(name) == Some(&nodes) || self.mesh.node_set(name).as_ref() == Some(&nodes) {
            return name.to_owned();
        }
        let name = self.free_name(name, "nodes");
        self.mesh.node_sets.insert(name.clone(), nodes);
        name
    }
}

impl Conversion<'_> {
    /// All surfaces of element faces; those of nodes where something uses them.
    pub(super) fn named_surfaces(&mut self) -> Result<()> {
        let mut all: Vec<(String, Vec<Facet>, Place)> = Vec::new();
        for name in self.assembly.surface_names() {
            let (space, definition) = self.assembly.surface(&name, Place::default())?;
            if definition.of_nodes {
                continue;
            }
            if let Faces::OfElements(faces) = self.assembly.faces(space, definition)? {
                all.push((name, self.facets(&faces), definition.place));
            }
        }
        let mesh = &self.regions.mesh;
        let skin = Skin::new(mesh.nodes.len(), &mesh.elements, all.iter().flat_map(|(_, facets, _)| facets));
        for (name, facets, place) in all {
            let spelled = self.regions.free_name(&self.deck.spelled(&name), "surface");
            self.insert_surface(&spelled, &facets, &skin, place)?;
            self.regions.surfaces.insert(name, spelled);
        }
        Ok(())
    }

    /// The mesh's name of a surface of the deck, which is added to the mesh if it is not there. Nodes become the facets
    /// on the skin of which all nodes are among them.
    pub(super) fn surface_name(&mut self, name: &str, place: Place) -> Result<String> {
        if let Some(known) = self.regions.surfaces.get(name) {
            return Ok(known.clone());
        }
        let (space, definition) = self.assembly.surface(name, place)?;
        let (faces, at) = match self.assembly.faces(space, definition)? {
            Faces::OfElements(faces) => (faces, definition.place),
            Faces::Nodes(nodes) => {
                let faces = self.faces_of_nodes(&nodes);
                let (n, name) = (faces.len(), self.deck.spelled(name));
                self.notes.push(format!(
                    "the surface {name} of {} nodes is read as the {n} facets between them",
                    nodes.len()
                ));
                (faces, definition.place)
            }
        };
        let spelled = self.regions.free_name(&self.deck.spelled(name), "surface");
        self.add_surface(&spelled, &faces, at)?;
        self.regions.surfaces.insert(name.to_owned(), spelled.clone());
        Ok(spelled)
    }

    /// Adds a surface of element faces.
    pub(super) fn add_surface(&mut self, name: &str, faces: &[(u32, u8)], place: Place) -> Result<()> {
        let facets = self.facets(faces);
        let mesh = &self.regions.mesh;
        let skin = Skin::new(mesh.nodes.len(), &mesh.elements, facets.iter());
        self.insert_surface(name, &facets, &skin, place)
    }

    /// Faces of elements in nodes of the mesh.
    fn facets(&self, faces: &[(u32, u8)]) -> Vec<Facet> {
        let facet = |&(element, face): &(u32, u8)| {
            let nodes = self.assembly.face(element, face)?;
            let nodes = nodes.into_iter().map(|node| self.bodies.node_of[node as usize]);
            nodes.clone().all(|node| node != UNUSED).then(|| nodes.collect())
        };
        faces.iter().filter_map(facet).collect()
    }

    fn insert_surface(&mut self, name: &str, facets: &[Facet], skin: &Skin, place: Place) -> Result<()> {
        let mut surface = Surface::default();
        for face in facets.iter().filter_map(|facet| skin.face(facet)) {
            if face.inner {
                surface.inner.push(surface.facets.len() as u32);
            }
            surface.facets.push(face.facet);
            surface.parts.push(face.part);
        }
        if surface.facets.is_empty() {
            return Err(self.assembly.error(place, format_args!("the surface {name} has no facet of a solid")));
        }
        self.regions.mesh.surfaces.insert(name.to_owned(), surface);
        Ok(())
    }

    /// The faces on the skin of which all nodes are in a sorted list.
    fn faces_of_nodes(&self, nodes: &[u32]) -> Vec<(u32, u8)> {
        let is_in = |node: &u32| nodes.binary_search(node).is_ok();
        let face = |(element, face): &(u32, u8)| self.assembly.face(*element, *face).unwrap_or_default();
        self.assembly.skin().into_iter().filter(|at| face(at).iter().all(is_in)).collect()
    }

    /// The node sets of the deck that are not most of the mesh, so that a model file can name them.
    pub(super) fn node_sets(&mut self) -> Result<()> {
        for name in self.assembly.set_names(Kind::Node, 0) {
            let entry = Entry::Name(name.as_str().into());
            let nodes = self.bodies.used(&self.assembly.set(Kind::Node, 0, &entry, Place::default())?);
            if !nodes.is_empty() && nodes.len() <= self.regions.mesh.nodes.len() / 4 {
                self.regions.add_node_set(&self.deck.spelled(&name), nodes);
            }
        }
        Ok(())
    }

    /// Whether a node of the assembly belongs to a solid.
    pub(super) fn is_used(&self, node: u32) -> bool {
        self.bodies.node_of[node as usize] != UNUSED
    }
}
