//! From Gmsh's tables to the mesh: tags to indices, groups to parts and sets, facets to tetrahedra.

use super::groups::{Groups, noun};
use super::kinds::{TET10, TRI6};
use super::sections::{ElementBlock, Sections};
use crate::element::tet10;
use crate::mesh::skin::Skin;
use crate::mesh::{Mesh, Surface};
use std::collections::{BTreeMap, HashMap};

/// For each node of ours, its place in Gmsh's order of a 10-node tetrahedron: the last two midsides are swapped.
const FROM_GMSH: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];

/// Mark of a node that no tetrahedron uses.
const UNUSED: u32 = u32::MAX;

/// The mesh of a file's tables; `unit` is metres per unit of the file.
pub fn mesh(sections: &Sections, unit: f64) -> Result<Mesh, String> {
    let groups = Groups::new(sections)?;
    let tags = Tags::new(&sections.node_tags)?;
    let mut mesh = Mesh { parts: groups.names(3).map(str::to_owned).collect(), ..Mesh::default() };
    let elements = tets(sections, &groups, &tags, &mut mesh)?;
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

    /// The elements of a block as places of nodes, N each.
    fn elements<const N: usize>(&self, block: &ElementBlock) -> Result<Vec<[u32; N]>, String> {
        let mut elements = Vec::with_capacity(block.elements.len());
        for (&element, tags) in block.elements.iter().zip(block.nodes.chunks_exact(N)) {
            let mut places = [0; N];
            for (place, &tag) in places.iter_mut().zip(tags) {
                *place = self.place(tag, element)?;
            }
            elements.push(places);
        }
        Ok(elements)
    }
}

/// Fills in the tetrahedra and their parts; returns Gmsh's tags of the elements.
fn tets(sections: &Sections, groups: &Groups, tags: &Tags, mesh: &mut Mesh) -> Result<Vec<u64>, String> {
    let mut elements = Vec::new();
    for block in sections.blocks.iter().filter(|block| block.kind.dimension == 3) {
        let name = groups.part_of_block(block)?;
        if block.kind.number != TET10 {
            let (kind, advice) = (block.kind.name, block.kind.advice());
            return Err(format!("the part {name:?} has {kind}, not 10-node tetrahedra. {advice}"));
        }
        let part = mesh.parts.iter().position(|part| part == name);
        let part =
            part.ok_or_else(|| format!("volume elements lie on the surface {name:?}. Write the mesh again"))? as u32;
        let tets = tags.elements::<10>(block)?;
        mesh.tet_part.resize(mesh.tet_part.len() + tets.len(), part);
        mesh.tets.extend(tets.into_iter().map(|nodes| FROM_GMSH.map(|i| nodes[i])));
        elements.extend_from_slice(&block.elements);
    }
    if mesh.tets.is_empty() {
        let advice = "Mesh in three dimensions (gmsh -3), with a Physical Volume for each part";
        return Err(format!("there are no tetrahedra. {advice}"));
    }
    Ok(elements)
}

/// Numbers the nodes that tetrahedra use in the file's order, scales them, and returns all places' numbers.
fn compact(sections: &Sections, unit: f64, mesh: &mut Mesh) -> Result<Vec<u32>, String> {
    let mut numbers = vec![UNUSED; sections.node_tags.len()];
    for &place in mesh.tets.as_flattened() {
        numbers[place as usize] = 0;
    }
    for (number, x) in numbers.iter_mut().zip(&sections.coordinates) {
        if *number != UNUSED {
            *number = mesh.nodes.len() as u32;
            mesh.nodes.push(x.map(|x| x * unit));
        }
    }
    for node in mesh.tets.as_flattened_mut() {
        *node = numbers[*node as usize];
    }
    Ok(numbers)
}

/// Refuses a mesh with inverted elements, telling how many and where.
fn check_inverted(mesh: &Mesh, elements: &[u64]) -> Result<(), String> {
    let inverted: Vec<usize> = (0..mesh.tets.len()).filter(|&tet| tet10::is_inverted(&mesh.tet_nodes(tet))).collect();
    let Some(&first) = inverted.first() else {
        return Ok(());
    };
    let part = &mesh.parts[mesh.tet_part[first] as usize];
    Err(format!(
        "{} of {} tetrahedra are inverted (Jacobian 0 or below), first element {} of the part {part:?}. \
         Set Mesh.HighOrderOptimize = 2, or mesh finer where the surface is curved",
        inverted.len(),
        mesh.tets.len(),
        elements[first],
    ))
}

/// The physical surfaces, with facets that look out of their tetrahedra.
fn surfaces(
    sections: &Sections,
    groups: &Groups,
    tags: &Tags,
    numbers: &[u32],
    mesh: &Mesh,
) -> Result<BTreeMap<String, Surface>, String> {
    let mut raw: BTreeMap<&str, Vec<(u64, [u32; 6])>> = BTreeMap::new();
    for block in sections.blocks.iter().filter(|block| block.dimension == 2) {
        for name in groups.of_block(block) {
            if block.kind.number != TRI6 {
                let (kind, advice) = (block.kind.name, block.kind.advice());
                return Err(format!("the surface {name:?} has {kind}, not 6-node triangles. {advice}"));
            }
            let facets = tags.elements::<6>(block)?;
            let facets = block.elements.iter().copied().zip(facets);
            raw.entry(name).or_default().extend(facets);
        }
    }
    for (name, facets) in &mut raw {
        for (element, facet) in facets {
            *facet = facet.map(|place| numbers[place as usize]);
            if facet.contains(&UNUSED) {
                return Err(no_tet(name, *element));
            }
        }
    }
    let all = raw.values().flatten().map(|(_, facet)| facet);
    let skin = Skin::new(mesh.nodes.len(), &mesh.tets, &mesh.tet_part, all);
    raw.iter().map(|(name, facets)| Ok(((*name).to_owned(), surface(name, facets, &skin)?))).collect()
}

fn surface(name: &str, facets: &[(u64, [u32; 6])], skin: &Skin) -> Result<Surface, String> {
    let mut surface = Surface::default();
    for (element, facet) in facets {
        let face = skin.face(facet).ok_or_else(|| no_tet(name, *element))?;
        if face.inner {
            surface.inner.push(surface.facets.len() as u32);
        }
        surface.facets.push(face.facet);
        surface.parts.push(face.part);
    }
    Ok(surface)
}

fn no_tet(name: &str, element: u64) -> String {
    format!(
        "the triangle {element} of the surface {name:?} is no face of a tetrahedron. \
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
                        "node {tag} of the {noun} {name:?} is in no tetrahedron. Embed the {noun} in a volume, or remove it"
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
