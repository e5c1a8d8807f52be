//! The mesh as the rest of the program sees it, and questions about its names.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::elements::{Element, ElementList, Facet, Positions};

/// A mesh of solid elements in metres.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Mesh {
    /// Coordinates of the nodes, m.
    pub nodes: Vec<[f64; 3]>,
    /// The elements, each with the index of its part in `parts`.
    pub elements: ElementList,
    /// Names of the parts (physical volumes).
    pub parts: Vec<String>,
    /// Named surfaces (physical surfaces).
    pub surfaces: BTreeMap<String, Surface>,
    /// Named node sets (physical curves and points; a surface's nodes are found through [`Mesh::node_set`]).
    pub node_sets: BTreeMap<String, Vec<u32>>,
}

/// A named set of facets on the skin of the parts, each oriented so that its normal points out of the body.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Surface {
    /// The facets.
    pub facets: Vec<Facet>,
    /// For each facet the index of the part whose skin it is.
    pub parts: Vec<u32>,
    /// Indices of the facets with an element on both sides: a conformal interface inside the mesh, not its skin.
    /// They belong to the element of the part that comes first.
    pub inner: Vec<u32>,
}

impl Surface {
    /// Edge of a mean facet of the surface, which has this area (m2), m: a quadrilateral is a square, a triangle half
    /// of one.
    pub fn facet_size(&self, area: f64) -> f64 {
        let halves: usize = self.facets.iter().map(|facet| facet.corners().len() - 2).sum();
        (2.0 * area / halves as f64).sqrt()
    }
}

impl Mesh {
    /// The nodes of a surface or node set, sorted, each once; none where nothing has this name.
    pub fn node_set(&self, name: &str) -> Option<Vec<u32>> {
        let mut nodes = match self.surfaces.get(name) {
            Some(surface) => surface.nodes().collect(),
            None => self.node_sets.get(name)?.clone(),
        };
        nodes.sort_unstable();
        nodes.dedup();
        Some(nodes)
    }

    /// The nodes of all surfaces and node sets, as often as they are there.
    pub fn named_nodes(&self) -> impl Iterator<Item = u32> + '_ {
        let on_surfaces = self.surfaces.values().flat_map(Surface::nodes);
        on_surfaces.chain(self.node_sets.values().flatten().copied())
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
        let own = self.elements.iter().filter(|element| element.part == index);
        let mut elements: ElementList = own.map(|element| Element { part: 0, ..element }).collect();
        let mut kept: Vec<u32> = elements.all_nodes().0.to_vec();
        kept.sort_unstable();
        kept.dedup();
        let mut place = vec![0; self.nodes.len()];
        kept.iter().enumerate().for_each(|(i, &n)| place[n as usize] = i as u32);
        elements.renumber(|n| place[n as usize]);
        Some(Mesh {
            nodes: kept.iter().map(|&n| self.nodes[n as usize]).collect(),
            elements,
            parts: vec![part.to_owned()],
            ..Mesh::default()
        })
    }

    /// Puts the nodes into a new order, `order[new] = old`, and the elements into that of their first nodes.
    ///
    /// # Panics
    /// Where `order` does not have every node once.
    pub fn reorder(&mut self, order: &[u32]) {
        let mut new = vec![u32::MAX; self.nodes.len()];
        order.iter().enumerate().for_each(|(number, &old)| new[old as usize] = number as u32);
        assert!(order.len() == new.len() && new.iter().all(|&n| n != u32::MAX));
        self.nodes = order.iter().map(|&old| self.nodes[old as usize]).collect();
        let rename = |n: u32| new[n as usize];
        self.elements.renumber(rename);
        for surface in self.surfaces.values_mut() {
            surface.facets.iter_mut().for_each(|facet| *facet = facet.renumbered(rename));
        }
        self.node_sets.values_mut().for_each(|set| {
            set.iter_mut().for_each(|n| *n = rename(*n));
            set.sort_unstable();
        });
        let mut order: Vec<usize> = (0..self.elements.len()).collect();
        order.sort_by_cached_key(|&e| self.elements.get(e).nodes.iter().min().copied());
        self.elements = order.iter().map(|&e| self.elements.get(e)).collect();
    }

    /// Coordinates of an element's nodes, m.
    #[inline]
    pub fn element_nodes(&self, e: usize) -> Positions {
        Positions::gather(&self.nodes, self.elements.get(e).nodes)
    }
}

impl Surface {
    /// The nodes of all facets, as often as they are there.
    pub fn nodes(&self) -> impl Iterator<Item = u32> + '_ {
        self.facets.iter().flat_map(|facet| facet.nodes().iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ElementKind;

    #[test]
    fn a_new_order_changes_numbers_and_nothing_else() {
        let node = |n: u32| [f64::from(n), 0.0, 1.0];
        let surface = Surface { facets: vec![[0, 1, 2, 3, 4, 5].into()], parts: vec![1], inner: vec![] };
        let mut mesh = Mesh {
            nodes: (0..14).map(node).collect(),
            surfaces: [("face".to_owned(), surface)].into(),
            node_sets: [("two".to_owned(), vec![3, 9])].into(),
            ..Mesh::default()
        };
        mesh.elements.push(ElementKind::C3D10, 0, &[4, 5, 6, 7, 8, 9, 10, 11, 12, 13]);
        mesh.elements.push(ElementKind::C3D8I, 1, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let before = mesh.clone();
        let order: Vec<u32> = (0..14).map(|n| (5 * n + 3) % 14).collect();
        mesh.reorder(&order);
        let place = |n: &u32| mesh.nodes[*n as usize][0] as u32;
        assert!(mesh.surfaces["face"].facets[0].nodes().iter().map(place).eq(0..6));
        let mut set: Vec<u32> = mesh.node_sets["two"].iter().map(place).collect();
        set.sort_unstable();
        assert_eq!(set, [3, 9]);
        for element in mesh.elements.iter() {
            let nodes: Vec<u32> = element.nodes.iter().map(place).collect();
            assert!(before.elements.iter().any(|old| old == Element { nodes: &nodes, ..element }));
        }
        assert!(mesh.elements.iter().is_sorted_by_key(|element| element.nodes.iter().min().copied()));
    }
}
