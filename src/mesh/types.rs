//! The mesh as the rest of the program sees it, and questions about its names.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// A mesh of 10-node tetrahedra in metres.
///
/// Node order of a tetrahedron: corners 0-3, then the midsides of the edges
/// (0,1) (1,2) (2,0) (0,3) (1,3) (2,3). Node order of a facet: corners 0-2, then the midsides of (0,1) (1,2) (2,0).
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Mesh {
    /// Coordinates of the nodes, m.
    pub nodes: Vec<[f64; 3]>,
    /// The tetrahedra, ten node indices each.
    pub tets: Vec<[u32; 10]>,
    /// For each tetrahedron the index of its part in `parts`.
    pub tet_part: Vec<u32>,
    /// Names of the parts (physical volumes).
    pub parts: Vec<String>,
    /// Named surfaces (physical surfaces).
    pub surfaces: BTreeMap<String, Surface>,
    /// Named node sets (physical curves and points; a surface's nodes are found through [`Mesh::node_set`]).
    pub node_sets: BTreeMap<String, Vec<u32>>,
}

/// A named set of 6-node facets on the skin of the parts, each oriented so that its normal points out of the body.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Surface {
    /// The facets, six node indices each.
    pub facets: Vec<[u32; 6]>,
    /// For each facet the index of the part whose skin it is.
    pub parts: Vec<u32>,
    /// Indices of the facets with a tetrahedron on both sides: a conformal interface inside the mesh, not its skin.
    /// They belong to the tetrahedron of the part that comes first.
    pub inner: Vec<u32>,
}

impl Mesh {
    /// The nodes of a surface or node set, sorted, each once; none where nothing has this name.
    pub fn node_set(&self, name: &str) -> Option<Vec<u32>> {
        let mut nodes = match self.surfaces.get(name) {
            Some(surface) => surface.facets.as_flattened().to_vec(),
            None => self.node_sets.get(name)?.clone(),
        };
        nodes.sort_unstable();
        nodes.dedup();
        Some(nodes)
    }

    /// The nodes of all surfaces and node sets, as often as they are there.
    pub fn named_nodes(&self) -> impl Iterator<Item = u32> + '_ {
        let on_surfaces = self.surfaces.values().flat_map(|surface| surface.facets.as_flattened());
        on_surfaces.chain(self.node_sets.values().flatten()).copied()
    }

    /// The parts that a surface lies on (indices, ascending); none where no surface has this name.
    pub fn parts_of_surface(&self, name: &str) -> Option<Vec<u32>> {
        let mut parts = self.surfaces.get(name)?.parts.clone();
        parts.sort_unstable();
        parts.dedup();
        Some(parts)
    }

    /// The one part that a surface lies on; none where no surface has this name or it lies on several parts.
    pub fn part_of_surface(&self, name: &str) -> Option<u32> {
        match self.parts_of_surface(name)?[..] {
            [part] => Some(part),
            _ => None,
        }
    }

    /// One part alone, with its nodes and without names of surfaces and sets; none where there is no such part.
    pub fn only(&self, part: &str) -> Option<Mesh> {
        let index = self.parts.iter().position(|name| name == part)? as u32;
        let tets: Vec<[u32; 10]> =
            self.tets.iter().zip(&self.tet_part).filter(|(_, part)| **part == index).map(|(tet, _)| *tet).collect();
        let mut kept: Vec<u32> = tets.as_flattened().to_vec();
        kept.sort_unstable();
        kept.dedup();
        let mut place = vec![0; self.nodes.len()];
        kept.iter().enumerate().for_each(|(i, &n)| place[n as usize] = i as u32);
        Some(Mesh {
            nodes: kept.iter().map(|&n| self.nodes[n as usize]).collect(),
            tet_part: vec![0; tets.len()],
            tets: tets.iter().map(|tet| tet.map(|n| place[n as usize])).collect(),
            parts: vec![part.to_owned()],
            ..Mesh::default()
        })
    }

    /// Puts the nodes into a new order, `order[new] = old`, and the tetrahedra into that of their first nodes.
    ///
    /// # Panics
    /// Where `order` does not have every node once.
    pub fn reorder(&mut self, order: &[u32]) {
        let mut new = vec![u32::MAX; self.nodes.len()];
        order.iter().enumerate().for_each(|(number, &old)| new[old as usize] = number as u32);
        assert!(order.len() == new.len() && new.iter().all(|&n| n != u32::MAX));
        self.nodes = order.iter().map(|&old| self.nodes[old as usize]).collect();
        let rename = |nodes: &mut [u32]| nodes.iter_mut().for_each(|n| *n = new[*n as usize]);
        rename(self.tets.as_flattened_mut());
        self.surfaces.values_mut().for_each(|surface| rename(surface.facets.as_flattened_mut()));
        self.node_sets.values_mut().for_each(|set| {
            rename(set);
            set.sort_unstable();
        });
        let mut tets: Vec<usize> = (0..self.tets.len()).collect();
        tets.sort_by_cached_key(|&tet| self.tets[tet].iter().min().copied());
        self.tet_part = tets.iter().map(|&tet| self.tet_part[tet]).collect();
        self.tets = tets.iter().map(|&tet| self.tets[tet]).collect();
    }

    /// Coordinates of a tetrahedron's nodes, m.
    pub fn tet_nodes(&self, tet: usize) -> [[f64; 3]; 10] {
        self.tets[tet].map(|node| self.nodes[node as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_order_changes_numbers_and_nothing_else() {
        let node = |n: u32| [f64::from(n), 0.0, 1.0];
        let surface = Surface { facets: vec![[0, 1, 2, 3, 4, 5]], parts: vec![1], inner: vec![] };
        let mut mesh = Mesh {
            nodes: (0..14).map(node).collect(),
            tets: vec![[4, 5, 6, 7, 8, 9, 10, 11, 12, 13], [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]],
            tet_part: vec![0, 1],
            surfaces: [("face".to_owned(), surface)].into(),
            node_sets: [("two".to_owned(), vec![3, 9])].into(),
            ..Mesh::default()
        };
        let before = mesh.clone();
        let order: Vec<u32> = (0..14).map(|n| (5 * n + 3) % 14).collect();
        mesh.reorder(&order);
        let place = |n: &u32| mesh.nodes[*n as usize][0] as u32;
        assert_eq!(mesh.surfaces["face"].facets[0].each_ref().map(place), [0, 1, 2, 3, 4, 5]);
        let mut set: Vec<u32> = mesh.node_sets["two"].iter().map(place).collect();
        set.sort_unstable();
        assert_eq!(set, [3, 9]);
        let tets: Vec<_> =
            mesh.tets.iter().zip(&mesh.tet_part).map(|(tet, &part)| (tet.each_ref().map(place), part)).collect();
        assert!((0..2).all(|e| tets.contains(&(before.tets[e], before.tet_part[e]))));
        assert!(mesh.tets.is_sorted_by_key(|tet| tet.iter().min().copied()));
    }
}
