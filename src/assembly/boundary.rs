//! The outer surface of all parts, and how it moves.

use std::collections::{BTreeMap, HashMap};

use serde::{Deserialize, Serialize};

use super::{DofMap, System};
use crate::Result;
use crate::mesh::{Facet, Mesh, Numbering};
use crate::native::{Comm, Gather, Vector};

/// The outer surface of all parts of a mesh of which each rank has a piece, in triangles between the corners of the
/// facets. Nodes and triangles are in an order that does not depend on the number of ranks. Every rank knows it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Boundary {
    /// Coordinates of its nodes, m.
    pub nodes: Vec<[f64; 3]>,
    /// Triangles, turning so that their normals point out.
    pub triangles: Vec<[u32; 3]>,
    /// Part of each triangle.
    pub part: Vec<i32>,
    /// Dofs of its nodes, -1 where constrained.
    dofs: Vec<[i32; 3]>,
}

impl Boundary {
    /// Brings the outer faces of all ranks together. Collective.
    pub fn new(comm: &Comm, mesh: &Mesh, nodes: &Numbering, dofs: &DofMap) -> Boundary {
        let mut faces = comm.join_values(own_faces(mesh, nodes, dofs)).concat();
        faces.sort_by_key(|face| (face.part, face.corners.map(|corner| corner.label)));
        let corners: BTreeMap<u32, Corner> =
            faces.iter().flat_map(|face| face.corners).map(|corner| (corner.label, corner)).collect();
        let place: HashMap<u32, u32> = corners.keys().zip(0..).map(|(&label, i)| (label, i)).collect();
        Boundary {
            nodes: corners.values().map(|corner| corner.position).collect(),
            triangles: faces.iter().map(|face| face.corners.map(|corner| place[&corner.label])).collect(),
            part: faces.iter().map(|face| face.part).collect(),
            dofs: corners.values().map(|corner| corner.dofs).collect(),
        }
    }

    /// Prepares to follow some of the nodes in vectors of a system. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn follow(&self, system: &System, chosen: impl Iterator<Item = usize>) -> Result<Displacements> {
        let is_root = system.k.comm().is_root();
        let dofs: Vec<i32> = chosen.filter(|_| is_root).flat_map(|node| self.dofs[node]).collect();
        let free: Vec<i32> = dofs.iter().copied().filter(|&e| e >= 0).collect();
        Ok(Displacements { dofs, gather: Gather::new(&system.load, &free)? })
    }
}

/// Displacements of some nodes, on the root.
pub struct Displacements {
    dofs: Vec<i32>,
    gather: Gather,
}

impl Displacements {
    /// Displacements x, y, z of the nodes one after the other, zero where constrained; none on other ranks than the
    /// root. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn of(&mut self, vector: &Vector) -> Result<Vec<f64>> {
        let dofs = &self.dofs;
        self.gather.run(vector, |values| {
            let mut values = values.iter();
            let at = |&e: &i32| if e < 0 { 0.0 } else { *values.next().expect("one value a free dof") };
            dofs.iter().map(at).collect()
        })
    }
}

/// A corner of an outer face, by its number in the mesh's file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Corner {
    label: u32,
    position: [f64; 3],
    dofs: [i32; 3],
}

/// A triangle of an outer face.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct OuterFace {
    corners: [Corner; 3],
    part: i32,
}

/// The outer faces of a piece that are this rank's: those of whose corner with the lowest number it is the owner, as it
/// has all elements around a node of its own. Quadrilaterals are halved.
fn own_faces(mesh: &Mesh, nodes: &Numbering, dofs: &DofMap) -> Vec<OuterFace> {
    let mut faces: HashMap<[u32; 4], (Facet, usize)> = HashMap::new();
    for (e, element) in mesh.elements.iter().enumerate() {
        for facet in element.facets() {
            let key = facet.key();
            // A face between two elements is not outside.
            if nodes.owns(key[0]) && faces.remove(&key).is_none() {
                faces.insert(key, (facet, e));
            }
        }
    }
    let mut outer: Vec<(Facet, usize)> = faces.into_values().collect();
    outer.sort_unstable_by(|(a, e), (b, f)| e.cmp(f).then_with(|| a.corners().cmp(b.corners())));
    let corner = |n: u32| Corner {
        label: nodes.labels()[n as usize],
        position: mesh.nodes[n as usize],
        dofs: dofs.node_dofs(n),
    };
    let triangles = |(facet, e): (Facet, usize)| {
        let corners: Vec<Corner> = facet.corners().iter().map(|&n| corner(n)).collect();
        let part = mesh.elements.get(e).part as i32;
        let triangle = move |k: usize| OuterFace { corners: [corners[0], corners[k], corners[k + 1]], part };
        (1..facet.corners().len() - 1).map(triangle).collect::<Vec<_>>()
    };
    outer.into_iter().flat_map(triangles).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ElementKind;

    /// Two tetrahedra with a common face.
    fn mesh() -> Mesh {
        let nodes = (0..14).map(|n| [f64::from(n), 0.0, 0.0]).collect();
        let mut mesh = Mesh { nodes, parts: vec!["a".into(), "b".into()], ..Mesh::default() };
        mesh.elements.push(ElementKind::C3D10, 0, &[0, 1, 2, 3, 5, 6, 7, 8, 9, 10]);
        mesh.elements.push(ElementKind::C3D10, 1, &[0, 2, 1, 4, 7, 6, 5, 11, 12, 13]);
        mesh
    }

    fn faces(owned: std::ops::Range<u32>) -> Vec<OuterFace> {
        let nodes = Numbering::whole(14, owned);
        own_faces(&mesh(), &nodes, &DofMap::new(&nodes, &[[false; 3]; 14]))
    }

    #[test]
    fn two_tetrahedra_have_six_outer_faces_each_on_one_rank() {
        let all = faces(0..14);
        assert_eq!(all.iter().map(|face| face.part).collect::<Vec<_>>(), [0, 0, 0, 1, 1, 1]);
        let below_three = |face: &OuterFace| face.corners.iter().filter(|corner| corner.label < 3).count();
        assert!(all.iter().all(|face| below_three(face) == 2));
        let apart = [faces(0..1), faces(1..14)].concat();
        assert!(apart.len() == 6 && all.iter().all(|face| apart.contains(face)));
    }
}
