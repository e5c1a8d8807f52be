//! What a rank has of a mesh.
//!
//! Its own nodes, all elements that touch one of them, those elements' nodes, and everything that has a name:
//! surfaces and node sets with their nodes are on every rank, as contact, loads and supports are. They grow with the
//! surface of the bodies, the rest with their volume.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::{Element, ElementList, Mesh, Numbering, Surface};

/// A part of a mesh, in local numbers.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Piece {
    /// Nodes and elements that the rank has; all surfaces and node sets.
    pub mesh: Mesh,
    /// The global numbers of its nodes.
    pub nodes: Numbering,
}

impl Piece {
    /// The piece of a rank that owns these nodes of a whole mesh; `labels` as [`Numbering::new`] takes them.
    ///
    /// # Panics
    /// Where the range goes beyond the nodes.
    pub fn of(whole: &Mesh, owned: Range<u32>, labels: &[u32]) -> Piece {
        let touches = |element: &Element| element.nodes.iter().any(|n| owned.contains(n));
        let mut elements: ElementList = whole.elements.iter().filter(touches).collect();
        let mut place = vec![u32::MAX; whole.nodes.len()];
        let here = owned.clone().chain(elements.all_nodes().0.iter().copied()).chain(whole.named_nodes());
        here.for_each(|n| place[n as usize] = 0);
        let global: Vec<u32> = (0..whole.nodes.len() as u32).filter(|&n| place[n as usize] == 0).collect();
        global.iter().enumerate().for_each(|(local, &n)| place[n as usize] = local as u32);
        let local = |n: u32| place[n as usize];
        let surface = |(name, surface): (&String, &Surface)| {
            let facets = surface.facets.iter().map(|facet| facet.renumbered(local)).collect();
            (name.clone(), Surface { facets, ..surface.clone() })
        };
        let set = |(name, nodes): (&String, &Vec<u32>)| (name.clone(), nodes.iter().map(|&n| local(n)).collect());
        elements.renumber(local);
        let mesh = Mesh {
            nodes: global.iter().map(|&n| whole.nodes[n as usize]).collect(),
            elements,
            parts: whole.parts.clone(),
            surfaces: whole.surfaces.iter().map(surface).collect(),
            node_sets: whole.node_sets.iter().map(set).collect(),
        };
        Piece { mesh, nodes: Numbering::new(global, owned, labels) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ElementKind;

    /// A chain of tetrahedra with four new nodes each, a surface at its first end and a node set at its last.
    fn chain() -> Mesh {
        let mut elements = ElementList::default();
        for e in 0..6 {
            let nodes: Vec<u32> = (4 * e..4 * e + 10).collect();
            elements.push(ElementKind::C3D10, u32::from(e < 3), &nodes);
        }
        let surface = Surface { facets: vec![[0, 1, 2, 3, 4, 5].into()], parts: vec![1], inner: vec![] };
        Mesh {
            nodes: (0..30).map(|n| [f64::from(n), 0.5, -0.25]).collect(),
            elements,
            parts: vec!["a".into(), "b c".into()],
            surfaces: [("end".to_owned(), surface)].into(),
            node_sets: [("last".to_owned(), vec![28, 29])].into(),
        }
    }

    fn labels() -> Vec<u32> {
        (100..130).collect()
    }

    #[test]
    fn a_piece_has_its_nodes_tetrahedra_and_all_that_has_a_name() {
        let piece = Piece::of(&chain(), 12..16, &labels());
        let global = piece.nodes.global();
        // Nodes 0..6 of the surface, 4..22 of the tetrahedra 1 to 3, and 28, 29 of the set.
        assert_eq!(global, [(0..22).collect::<Vec<_>>(), vec![28, 29]].concat());
        let back = |local: u32| global[local as usize];
        let mut elements = piece.mesh.elements.clone();
        elements.renumber(back);
        assert!(elements.iter().eq(chain().elements.iter().skip(1).take(3)));
        assert_eq!(piece.mesh.node_sets["last"].iter().map(|&n| back(n)).collect::<Vec<_>>(), [28, 29]);
        assert!(piece.mesh.nodes.iter().zip(global).all(|(x, &n)| x[0] == f64::from(n)));
        assert!(piece.nodes.labels().iter().zip(global).all(|(&label, &n)| label == 100 + n));
        assert_eq!((piece.nodes.owned(), piece.nodes.n_global()), (12..16, 30));
    }

    #[test]
    fn a_piece_survives_the_way_to_another_rank() {
        for owned in [0..30, 12..16, 5..5] {
            let piece = Piece::of(&chain(), owned, &labels());
            let copy: Piece = postcard::from_bytes(&postcard::to_stdvec(&piece).unwrap()).unwrap();
            assert_eq!(format!("{copy:?}"), format!("{piece:?}"));
        }
    }
}
