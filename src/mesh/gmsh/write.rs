//! A mesh as a text of Gmsh's format 4.1.

use std::io::{Result, Write};

use super::kinds::{self, GmshType};
use crate::element::{FacetShape, Shape};
use crate::mesh::Mesh;

/// Gmsh's number of a point element.
const POINT: i32 = 15;

/// Elements of one entity.
struct Block {
    dimension: i32,
    entity: usize,
    kind: i32,
    /// Nodes of the elements, in Gmsh's order, from 0.
    elements: Vec<Vec<u32>>,
}

/// Writes a mesh, with coordinates in a unit of so many metres. Parts become physical volumes,
/// surfaces physical surfaces, node sets physical points. `mark` is a comment.
///
/// # Errors
/// The system's.
pub fn write(mesh: &Mesh, unit: f64, mark: &str, out: &mut impl Write) -> Result<()> {
    writeln!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\n{mark}\n$EndComments\n$PhysicalNames")?;
    writeln!(out, "{}", mesh.parts.len() + mesh.surfaces.len() + mesh.node_sets.len())?;
    let volumes = mesh.parts.iter().zip(1..).map(|(name, tag)| (3, tag, name));
    let surfaces = mesh.surfaces.keys().zip(1..).map(|(name, tag)| (2, tag, name));
    let points = mesh.node_sets.keys().zip(1..).map(|(name, tag)| (0, tag, name));
    for (dimension, tag, name) in points.chain(surfaces).chain(volumes) {
        writeln!(out, "{dimension} {tag} \"{}\"", name.replace('"', "'"))?;
    }
    writeln!(out, "$EndPhysicalNames")?;
    entities(mesh, unit, out)?;
    let n = mesh.nodes.len();
    writeln!(out, "$Nodes\n1 {n} 1 {n}\n3 1 0 {n}")?;
    for tag in 1..=n {
        writeln!(out, "{tag}")?;
    }
    for x in &mesh.nodes {
        let [x, y, z] = x.map(|x| x / unit);
        writeln!(out, "{x} {y} {z}")?;
    }
    writeln!(out, "$EndNodes")?;
    elements(&blocks(mesh), out)
}

/// Entities with their physical groups: a point for each node of a set, a surface for each surface, a volume a part.
fn entities(mesh: &Mesh, unit: f64, out: &mut impl Write) -> Result<()> {
    let n_points: usize = mesh.node_sets.values().map(Vec::len).sum();
    writeln!(out, "$Entities\n{n_points} 0 {} {}", mesh.surfaces.len(), mesh.parts.len())?;
    let of_sets =
        mesh.node_sets.values().zip(1..).flat_map(|(nodes, group)| nodes.iter().map(move |node| (node, group)));
    for ((node, group), tag) in of_sets.zip(1..) {
        let [x, y, z] = mesh.nodes[*node as usize].map(|x| x / unit);
        writeln!(out, "{tag} {x} {y} {z} 1 {group}")?;
    }
    let end =
        |sign: f64| [0, 1, 2].map(|i| sign * mesh.nodes.iter().map(|x| sign * x[i] / unit).fold(f64::MIN, f64::max));
    let ([a, b, c], [d, e, f]) = (end(-1.0), end(1.0));
    for tag in (1..=mesh.surfaces.len()).chain(1..=mesh.parts.len()) {
        writeln!(out, "{tag} {a} {b} {c} {d} {e} {f} 1 {tag} 0")?;
    }
    writeln!(out, "$EndEntities")
}

fn blocks(mesh: &Mesh) -> Vec<Block> {
    let points = mesh.node_sets.values().flatten().zip(1..);
    let points = points.map(|(&node, entity)| Block { dimension: 0, entity, kind: POINT, elements: vec![vec![node]] });
    let mut all: Vec<Block> = points.collect();
    for (surface, entity) in mesh.surfaces.values().zip(1..) {
        for shape in FacetShape::ALL {
            let own = surface.facets.iter().filter(|facet| facet.shape() == shape);
            let elements: Vec<Vec<u32>> = own.map(|facet| facet.nodes().to_vec()).collect();
            all.extend(block(2, entity, kinds::of_facet(shape), elements));
        }
    }
    for part in 0..mesh.parts.len() {
        for shape in Shape::ALL {
            let own = mesh.elements.iter().filter(|own| own.part as usize == part && own.shape() == shape);
            let elements: Vec<Vec<u32>> = own.map(|element| element.nodes.to_vec()).collect();
            all.extend(block(3, part + 1, kinds::of_shape(shape), elements));
        }
    }
    all
}

/// Elements of one type, their nodes in Gmsh's order; none where there are no elements.
fn block(dimension: i32, entity: usize, kind: &GmshType, mut elements: Vec<Vec<u32>>) -> Option<Block> {
    if let Some(order) = kind.order() {
        for nodes in &mut elements {
            let ours = nodes.clone();
            order.iter().zip(ours).for_each(|(&place, node)| nodes[place] = node);
        }
    }
    (!elements.is_empty()).then_some(Block { dimension, entity, kind: kind.number, elements })
}

fn elements(blocks: &[Block], out: &mut impl Write) -> Result<()> {
    let n: usize = blocks.iter().map(|block| block.elements.len()).sum();
    writeln!(out, "$Elements\n{} {n} 1 {n}", blocks.len())?;
    let mut tag = 0;
    for block in blocks {
        writeln!(out, "{} {} {} {}", block.dimension, block.entity, block.kind, block.elements.len())?;
        for nodes in &block.elements {
            tag += 1;
            write!(out, "{tag}")?;
            nodes.iter().try_for_each(|node| write!(out, " {}", node + 1))?;
            writeln!(out)?;
        }
    }
    writeln!(out, "$EndElements")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_mesh_is_written_and_read_back() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut mesh = crate::mesh::read(&root.join("tests/data/two_blocks_ascii.msh"), 1e-3).unwrap();
        mesh.node_sets.insert("two nodes".to_owned(), vec![3, 7]);
        let mut bytes = Vec::new();
        write(&mesh, 1e-3, "a comment", &mut bytes).unwrap();
        let back = super::super::parse(&bytes, Path::new("a.msh"), 1e-3).unwrap();
        assert_eq!((&back.parts, &back.node_sets), (&mesh.parts, &mesh.node_sets));
        assert_eq!(back.elements, mesh.elements);
        assert!(back.nodes.iter().zip(&mesh.nodes).all(|(a, b)| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-15)));
        for (name, surface) in &mesh.surfaces {
            assert_eq!(back.surfaces[name].facets, surface.facets, "{name}");
        }
    }
}
