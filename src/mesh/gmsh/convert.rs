//! From Gmsh's tables to the mesh: tags to indices, groups to parts and sets, facets to elements.

use super::groups::{Groups, noun};
use super::sections::{ElementBlock, Sections};
use crate::element::{ElementKind, solid};
use crate::mesh::skin::Skin;
use crate::mesh::{Facet, Mesh, Surface};
use std::collections::{BTreeMap, HashMap};

/// Mark of a node that no element uses.
const UNUSED: u32 = u32::MAX;

/// The mesh of a file's tables; `unit` is metres per unit of the file.
pub fn mesh(sections: &Sections, unit: f64) -> Result<Mesh, String> {
    let groups = Groups::new(sections)?;
    let tags = Tags::new(&sections.node_tags)?;
    let mut mesh = Mesh { parts: groups.names(3).map(str::to_owned).collect(), ..Mesh::default() };
    let elements = solids(sections, &groups, &tags, &mut mesh)?;
    let numbers = compact(sections, unit, &mut mesh)?;
    check_inverted(&mesh, &elements)?;
    mesh.surfaces = surfaces(sections, &groups, &tags, &numbers, &mesh)?;
    mesh.node_sets = node_sets(sections, &groups, &tags, &numbers)?;
    Ok(mesh)
}

/// Places of the nodes in the file by their tags.
struct Tags(HashMap<u64, u32>);

impl Tags {
    fn new(tags: &[u64]) -> Result<Self, String> {
        let mut places = HashMap::with_capacity(tags.len());
        for (place, &tag) in tags.iter().enumerate() {
            if places.insert(tag, place as u32).is_some() {
                return Err(format!("node {tag} is there twice. Write the mesh again"));
            }
        }
        Ok(Tags(places))
    }

    fn place(&self, tag: u64, element: u64) -> Result<u32, String> {
        let place = self.0.get(&tag).copied();
        place.ok_or_else(|| {
            format!("element {element} uses node {tag}, which $Nodes does not have. Write the mesh again")
        })
    }

    /// Calls `visit` with the places of each element's nodes, in our order.
    fn visit(&self, block: &ElementBlock, mut visit: impl FnMut(u64, &[u32])) -> Result<(), String> {
        let (mut tags_in_order, mut places) = (Vec::new(), Vec::new());
        for (&element, tags) in block.elements.iter().zip(block.nodes.chunks_exact(block.kind.n_nodes)) {
            tags_in_order.clear();
            match block.kind.order() {
                Some(order) => tags_in_order.extend(order.iter().map(|&place| tags[place])),
                None => tags_in_order.extend_from_slice(tags),
            }
            places.clear();
            for &tag in &tags_in_order {
                places.push(self.place(tag, element)?);
            }
            visit(element, &places);
        }
        Ok(())
    }
}

/// Fills in the elements; returns Gmsh's tags of them.
fn solids(sections: &Sections, groups: &Groups, tags: &Tags, mesh: &mut Mesh) -> Result<Vec<u64>, String> {
    let mut elements = Vec::new();
    for block in sections.blocks.iter().filter(|block| block.kind.dimension == 3) {
        let name = groups.part_of_block(block)?;
        let Some(shape) = block.kind.shape() else {
            let (kind, advice) = (block.kind.name, block.kind.advice());
            return Err(format!("the part {name:?} has {kind}, which are not analysed. {advice}"));
        };
        let part = mesh.parts.iter().position(|part| part == name);
        let part =
            part.ok_or_else(|| format!("volume elements lie on the surface {name:?}. Write the mesh again"))? as u32;
        let kind = ElementKind::default_for(shape);
        tags.visit(block, |_, nodes| mesh.elements.push(kind, part, nodes))?;
        elements.extend_from_slice(&block.elements);
    }
    if mesh.elements.is_empty() {
        let advice = "Mesh in three dimensions (gmsh -3), with a Physical Volume for each part";
        return Err(format!("there are no solid elements. {advice}"));
    }
    Ok(elements)
}

/// Numbers the nodes that elements use in the file's order, scales them, and returns all places' numbers.
fn compact(sections: &Sections, unit: f64, mesh: &mut Mesh) -> Result<Vec<u32>, String> {
    let mut numbers = vec![UNUSED; sections.node_tags.len()];
    for &place in mesh.elements.all_nodes().0 {
        numbers[place as usize] = 0;
    }
    for (number, x) in numbers.iter_mut().zip(&sections.coordinates) {
        if *number != UNUSED {
            *number = mesh.nodes.len() as u32;
            mesh.nodes.push(x.map(|x| x * unit));
        }
    }
    mesh.elements.renumber(|place| numbers[place as usize]);
    Ok(numbers)
}

/// Refuses a mesh with inverted elements, telling how many and where.
fn check_inverted(mesh: &Mesh, elements: &[u64]) -> Result<(), String> {
    let is_inverted = |&e: &usize| solid::is_inverted(mesh.elements.get(e).shape(), &mesh.element_nodes(e));
    let inverted: Vec<usize> = (0..mesh.elements.len()).filter(is_inverted).collect();
    let Some(&first) = inverted.first() else {
        return Ok(());
    };
    let part = &mesh.parts[mesh.elements.get(first).part as usize];
    Err(format!(
        "{} of {} elements are inverted (Jacobian 0 or below), first element {} of the part {part:?}. \
         Set Mesh.HighOrderOptimize = 2, or mesh finer where the surface is curved",
        inverted.len(),
        mesh.elements.len(),
        elements[first],
    ))
}

/// The physical surfaces, with facets that look out of their elements.
fn surfaces(
    sections: &Sections,
    groups: &Groups,
    tags: &Tags,
    numbers: &[u32],
    mesh: &Mesh,
) -> Result<BTreeMap<String, Surface>, String> {
    let mut raw: BTreeMap<&str, Vec<(u64, Facet)>> = BTreeMap::new();
    for block in sections.blocks.iter().filter(|block| block.dimension == 2) {
        for name in groups.of_block(block) {
            if !block.kind.is_facet() {
                let (kind, advice) = (block.kind.name, block.kind.advice());
                return Err(format!("the surface {name:?} has {kind}, which are not analysed. {advice}"));
            }
            let facets = raw.entry(name).or_default();
            tags.visit(block, |element, nodes| facets.push((element, nodes.iter().copied().collect())))?;
        }
    }
    for (name, facets) in &mut raw {
        for (element, facet) in facets {
            *facet = facet.renumbered(|place| numbers[place as usize]);
            if facet.nodes().contains(&UNUSED) {
                return Err(no_element(name, *element));
            }
        }
    }
    let all = raw.values().flatten().map(|(_, facet)| facet);
    let skin = Skin::new(mesh.nodes.len(), &mesh.elements, all);
    raw.iter().map(|(name, facets)| Ok(((*name).to_owned(), surface(name, facets, &skin)?))).collect()
}

fn surface(name: &str, facets: &[(u64, Facet)], skin: &Skin) -> Result<Surface, String> {
    let mut surface = Surface::default();
    for (element, facet) in facets {
        let face = skin.face(facet).ok_or_else(|| no_element(name, *element))?;
        if face.inner {
            surface.inner.push(surface.facets.len() as u32);
        }
        surface.facets.push(face.facet);
        surface.parts.push(face.part);
    }
    Ok(surface)
}

fn no_element(name: &str, element: u64) -> String {
    format!(
        "the facet {element} of the surface {name:?} is no face of an element. \
         Put its volume into a Physical Volume, or take it out of the surface"
    )
}

/// The physical curves and points.
fn node_sets(
    sections: &Sections,
    groups: &Groups,
    tags: &Tags,
    numbers: &[u32],
) -> Result<BTreeMap<String, Vec<u32>>, String> {
    let mut sets: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    for block in sections.blocks.iter().filter(|block| block.dimension < 2) {
        for name in groups.of_block(block) {
            let set = sets.entry(name.to_owned()).or_default();
            for &tag in &block.nodes {
                let number = numbers[tags.place(tag, block.elements[0])? as usize];
                if number == UNUSED {
                    let noun = noun(block.dimension);
                    return Err(format!(
                        "node {tag} of the {noun} {name:?} is in no element. Embed the {noun} in a volume, or remove it"
                    ));
                }
                set.push(number);
            }
        }
    }
    for set in sets.values_mut() {
        set.sort_unstable();
        set.dedup();
    }
    Ok(sets)
}
