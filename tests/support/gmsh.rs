//! Meshes of 10-node tetrahedra as Gmsh files.

use std::fmt::Write;

use squeal::mesh::Mesh;

/// Elements of an entity: its dimension, its number there, Gmsh's type, and the nodes of each element.
struct Entity {
    dimension: usize,
    number: usize,
    kind: u32,
    elements: Vec<Vec<u32>>,
}

/// The text of a Gmsh file with a physical group for each part, surface and node set.
pub fn gmsh(mesh: &Mesh) -> String {
    let points = mesh.node_sets.values().map(|nodes| nodes.iter().map(|&n| vec![n]).collect());
    let surfaces =
        mesh.surfaces.values().map(|surface| surface.facets.iter().map(|facet| facet.nodes().to_vec()).collect());
    let volumes = (0..mesh.parts.len() as u32).map(|part| {
        let own = mesh.elements.iter().filter(|element| element.part == part);
        // Gmsh has the last two midsides the other way round.
        own.map(|element| [0, 1, 2, 3, 4, 5, 6, 7, 9, 8].map(|a| element.nodes[a]).to_vec()).collect()
    });
    let entity = |dimension, kind| {
        move |(elements, number): (Vec<Vec<u32>>, usize)| Entity { dimension, number, kind, elements }
    };
    let entities: Vec<Entity> = (points.zip(1..).map(entity(0, 15)))
        .chain(surfaces.zip(1..).map(entity(2, 9)))
        .chain(volumes.zip(1..).map(entity(3, 11)))
        .collect();
    let groups = [mesh.node_sets.keys().collect(), vec![], mesh.surfaces.keys().collect(), mesh.parts.iter().collect()];
    let nodes = mesh.nodes.iter().zip(1..);
    let tags: String = nodes.clone().map(|(_, tag)| format!("{tag}\n")).collect();
    let coordinates: String = nodes.map(|([x, y, z], _)| format!("{x} {y} {z}\n")).collect();
    let n = mesh.nodes.len();
    format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{}", header(&groups))
        + &format!("$Nodes\n1 {n} 1 {n}\n3 1 0 {n}\n{tags}{coordinates}$EndNodes\n{}", elements(&entities))
}

/// Physical names, and an entity for each.
fn header(groups: &[Vec<&String>; 4]) -> String {
    let total: usize = groups.iter().map(Vec::len).sum();
    let mut out = format!("$PhysicalNames\n{total}\n");
    let all = || {
        groups
            .iter()
            .enumerate()
            .flat_map(|(dimension, names)| names.iter().zip(1..).map(move |(name, number)| (dimension, number, name)))
    };
    all().for_each(|(dimension, number, name)| writeln!(out, "{dimension} {number} {name:?}").unwrap());
    let counts = groups.each_ref().map(|names| names.len().to_string()).join(" ");
    write!(out, "$EndPhysicalNames\n$Entities\n{counts}\n").unwrap();
    for (dimension, number, _) in all() {
        let rest = if dimension == 0 { "0 0 0 1" } else { "0 0 0 0 0 0 1" };
        let bounds = if dimension == 0 { "" } else { " 0" };
        writeln!(out, "{number} {rest} {number}{bounds}").unwrap();
    }
    out + "$EndEntities\n"
}

fn elements(entities: &[Entity]) -> String {
    let total: usize = entities.iter().map(|entity| entity.elements.len()).sum();
    let mut out = format!("$Elements\n{} {total} 1 {total}\n", entities.len());
    let mut tag = 0;
    for Entity { dimension, number, kind, elements } in entities {
        writeln!(out, "{dimension} {number} {kind} {}", elements.len()).unwrap();
        for nodes in elements {
            tag += 1;
            let nodes: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
            writeln!(out, "{tag} {}", nodes.join(" ")).unwrap();
        }
    }
    out + "$EndElements\n"
}
