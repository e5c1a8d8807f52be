//! The elements of a mesh and the facets of its surfaces, of any kind.

use serde::{Deserialize, Serialize};

use crate::element::{ElementKind, FacetShape, MAX_FACET_NODES, MAX_NODES, Shape};

/// An element of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Element<'a> {
    /// Its kind.
    pub kind: ElementKind,
    /// The index of its part.
    pub part: u32,
    /// Its nodes, in the order of its [`Shape`].
    pub nodes: &'a [u32],
}

impl Element<'_> {
    /// Its geometry.
    pub fn shape(&self) -> Shape {
        self.kind.shape()
    }

    /// Its faces, turning so that their normals point out.
    pub fn facets(&self) -> impl Iterator<Item = Facet> + '_ {
        self.shape().faces().map(|face| face.iter().map(|&a| self.nodes[a]).collect())
    }
}

/// The elements of a mesh, of mixed kinds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ElementList {
    kinds: Vec<ElementKind>,
    parts: Vec<u32>,
    /// Where each element's nodes start, and the end of the last.
    offsets: Vec<u32>,
    nodes: Vec<u32>,
}

impl Default for ElementList {
    fn default() -> Self {
        ElementList { kinds: Vec::new(), parts: Vec::new(), offsets: vec![0], nodes: Vec::new() }
    }
}

impl ElementList {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.kinds.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.kinds.is_empty()
    }

    /// Appends an element.
    ///
    /// # Panics
    /// Where it has not as many nodes as its kind, or where all elements have more than 2^32 nodes together.
    pub fn push(&mut self, kind: ElementKind, part: u32, nodes: &[u32]) {
        assert_eq!(nodes.len(), kind.n_nodes());
        self.kinds.push(kind);
        self.parts.push(part);
        self.nodes.extend_from_slice(nodes);
        self.offsets.push(u32::try_from(self.nodes.len()).expect("fewer than 2^32 nodes of elements"));
    }

    /// An element.
    ///
    /// # Panics
    /// Where `e >= len()`.
    #[inline]
    pub fn get(&self, e: usize) -> Element<'_> {
        let nodes = &self.nodes[self.offsets[e] as usize..self.offsets[e + 1] as usize];
        Element { kind: self.kinds[e], part: self.parts[e], nodes }
    }

    /// The elements, one after the other.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Element<'_>> + Clone {
        (0..self.len()).map(|e| self.get(e))
    }

    /// The nodes of all elements, one after the other, and where each element's start, with the end of the last.
    pub fn all_nodes(&self) -> (&[u32], &[u32]) {
        (&self.nodes, &self.offsets)
    }

    /// Gives the elements of a part that have the shape of a kind this kind; gives their number.
    pub fn change_kind(&mut self, part: u32, kind: ElementKind) -> usize {
        let all = self.kinds.iter_mut().zip(&self.parts);
        let own = all.filter(|(own, of)| **of == part && own.shape() == kind.shape());
        own.map(|(own, _)| *own = kind).count()
    }

    /// Gives the nodes other numbers.
    pub fn renumber(&mut self, number: impl Fn(u32) -> u32) {
        self.nodes.iter_mut().for_each(|n| *n = number(*n));
    }
}

impl<'a> FromIterator<Element<'a>> for ElementList {
    fn from_iter<I: IntoIterator<Item = Element<'a>>>(elements: I) -> Self {
        let mut list = ElementList::default();
        elements.into_iter().for_each(|element| list.push(element.kind, element.part, element.nodes));
        list
    }
}

/// Positions of an element's nodes, m; a slice with one entry a node.
#[derive(Debug, Clone, Copy)]
pub struct Positions {
    x: [[f64; 3]; MAX_NODES],
    n: usize,
}

impl Positions {
    /// Gathers them from all nodes'.
    #[inline]
    pub(super) fn gather(all: &[[f64; 3]], nodes: &[u32]) -> Positions {
        let mut x = [[0.0; 3]; MAX_NODES];
        x.iter_mut().zip(nodes).for_each(|(x, &n)| *x = all[n as usize]);
        Positions { x, n: nodes.len() }
    }
}

impl std::ops::Deref for Positions {
    type Target = [[f64; 3]];

    fn deref(&self) -> &[[f64; 3]] {
        &self.x[..self.n]
    }
}

/// A facet of a surface: 3, 4, 6 or 8 nodes, in the order of its [`FacetShape`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Facet {
    nodes: [u32; MAX_FACET_NODES],
    n: u8,
}

impl Facet {
    /// Its geometry.
    pub fn shape(&self) -> FacetShape {
        FacetShape::of(self.n.into())
    }

    /// Its nodes: corners, then midsides.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.n.into()]
    }

    /// Its corners.
    pub fn corners(&self) -> &[u32] {
        &self.nodes[..self.shape().n_corners()]
    }

    /// Its corners, sorted, with `u32::MAX` after those of a triangle: the same for both elements that share a face.
    pub fn key(&self) -> [u32; 4] {
        let mut key = [u32::MAX; 4];
        key[..self.corners().len()].copy_from_slice(self.corners());
        key.sort_unstable();
        key
    }

    /// Its midsides; none where it is linear.
    pub fn midsides(&self) -> &[u32] {
        &self.nodes()[self.shape().n_corners()..]
    }

    /// The facet with other numbers of nodes.
    pub fn renumbered(&self, number: impl FnMut(u32) -> u32) -> Facet {
        self.nodes().iter().copied().map(number).collect()
    }

    /// Positions of its nodes, m.
    pub fn positions(&self, nodes: &[[f64; 3]]) -> Positions {
        Positions::gather(nodes, self.nodes())
    }
}

impl FromIterator<u32> for Facet {
    /// # Panics
    /// Where there are not 3, 4, 6 or 8 nodes.
    fn from_iter<I: IntoIterator<Item = u32>>(nodes: I) -> Self {
        let (mut own, mut n) = ([0; MAX_FACET_NODES], 0);
        for node in nodes {
            own[n] = node;
            n += 1;
        }
        let shape = FacetShape::of(n);
        Facet { nodes: own, n: shape.n_nodes() as u8 }
    }
}

impl<const N: usize> From<[u32; N]> for Facet {
    fn from(nodes: [u32; N]) -> Self {
        nodes.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_of_mixed_kinds_keep_their_nodes_and_parts() {
        let mut list = ElementList::default();
        list.push(ElementKind::C3D4, 1, &[3, 1, 4, 0]);
        list.push(ElementKind::C3D6, 0, &[0, 1, 2, 3, 4, 5]);
        assert_eq!(list.get(0), Element { kind: ElementKind::C3D4, part: 1, nodes: &[3, 1, 4, 0] });
        let facets: Vec<Vec<u32>> = list.get(1).facets().map(|facet| facet.nodes().to_vec()).collect();
        assert_eq!(facets, [vec![0, 2, 1], vec![3, 4, 5], vec![0, 1, 4, 3], vec![1, 2, 5, 4], vec![2, 0, 3, 5]]);
        list.renumber(|n| n + 10);
        assert_eq!(list.get(0).nodes, [13, 11, 14, 10]);
        assert_eq!(list.iter().collect::<ElementList>(), list);
    }

    #[test]
    fn the_kind_of_a_parts_elements_of_one_shape_changes() {
        let mut list = ElementList::default();
        list.push(ElementKind::C3D4, 1, &[3, 1, 4, 0]);
        list.push(ElementKind::C3D8I, 1, &[0, 1, 2, 3, 4, 5, 6, 7]);
        list.push(ElementKind::C3D8I, 0, &[0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!((list.change_kind(1, ElementKind::C3D8R), list.change_kind(0, ElementKind::C3D20)), (1, 0));
        let kinds: Vec<ElementKind> = list.iter().map(|element| element.kind).collect();
        assert_eq!(kinds, [ElementKind::C3D4, ElementKind::C3D8R, ElementKind::C3D8I]);
    }

    #[test]
    fn facets_know_their_corners_and_midsides() {
        let facet = Facet::from([1, 2, 3, 4, 5, 6]);
        assert_eq!((facet.corners(), facet.midsides()), (&[1, 2, 3][..], &[4, 5, 6][..]));
        assert_eq!(facet.key(), Facet::from([3, 2, 1]).key());
        let facet = Facet::from([1, 2, 3, 4]).renumbered(|n| 2 * n);
        assert_eq!((facet.corners(), facet.midsides()), (&[2, 4, 6, 8][..], &[][..]));
    }
}
