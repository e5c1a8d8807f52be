//! Which part a facet belongs to, and the facet seen from outside it.

use std::collections::HashMap;

use super::elements::{ElementList, Facet};

/// A face of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SkinFace {
    /// The part of the element.
    pub part: u32,
    /// Nodes of the facet, turning so that its normal points out of the element.
    pub facet: Facet,
    /// Whether there is an element on the other side, too.
    pub inner: bool,
}

/// Finds the elements behind facets.
pub struct Skin {
    faces: HashMap<[u32; 4], Option<SkinFace>>,
}

impl Skin {
    /// Looks for the faces of elements that are among `facets`.
    ///
    /// Where two elements share a facet, it belongs to that of the part with the lower index.
    pub fn new<'f>(n_nodes: usize, elements: &ElementList, facets: impl Iterator<Item = &'f Facet>) -> Skin {
        let mut wanted = vec![false; n_nodes];
        let mut faces = HashMap::new();
        for facet in facets {
            facet.corners().iter().for_each(|&node| wanted[node as usize] = true);
            faces.insert(facet.key(), None);
        }
        for element in elements.iter() {
            for facet in element.facets().filter(|facet| facet.corners().iter().all(|&node| wanted[node as usize])) {
                if let Some(face) = faces.get_mut(&facet.key()) {
                    *face = Some(outer(*face, SkinFace { part: element.part, facet, inner: false }));
                }
            }
        }
        Skin { faces }
    }

    /// The face behind a facet; none where no element has its nodes as a face.
    pub fn face(&self, facet: &Facet) -> Option<SkinFace> {
        let face = self.faces.get(&facet.key()).copied().flatten()?;
        (sorted(face.facet.midsides()) == sorted(facet.midsides())).then_some(face)
    }
}

/// Of two elements that meet at a facet, the one of the first part.
fn outer(known: Option<SkinFace>, found: SkinFace) -> SkinFace {
    let Some(known) = known else {
        return found;
    };
    SkinFace { inner: true, ..if known.part <= found.part { known } else { found } }
}

fn sorted(nodes: &[u32]) -> Vec<u32> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ElementKind;

    /// Two tetrahedra with a face in common, of two parts.
    fn pair(parts: [u32; 2]) -> ElementList {
        let mut elements = ElementList::default();
        elements.push(ElementKind::C3D10, parts[0], &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
        elements.push(ElementKind::C3D10, parts[1], &[0, 2, 1, 10, 6, 5, 4, 11, 12, 13]);
        elements
    }

    #[test]
    fn a_shared_facet_belongs_to_the_first_part() {
        let facet = Facet::from([1, 2, 0, 5, 6, 4]);
        let seen_from = [[0, 2, 1, 6, 5, 4], [0, 1, 2, 4, 5, 6]];
        for (parts, tet) in [([0, 1], 0), ([1, 0], 1), ([0, 0], 0)] {
            let skin = Skin::new(14, &pair(parts), [facet].iter());
            let face = skin.face(&facet).unwrap();
            assert_eq!(face, SkinFace { part: 0, facet: seen_from[tet].into(), inner: true });
        }
        let skin = Skin::new(14, &pair([0, 1]), [[0, 1, 3, 4, 8, 7].into()].iter());
        let face = skin.face(&[3, 0, 1, 7, 4, 8].into()).unwrap();
        assert_eq!(face, SkinFace { part: 0, facet: [0, 1, 3, 4, 8, 7].into(), inner: false });
        assert_eq!(skin.face(&[3, 0, 1, 7, 4, 9].into()), None);
        assert_eq!(skin.face(&[0, 3, 2, 7, 9, 6].into()), None);
    }

    #[test]
    fn quadrilaterals_and_triangles_of_a_wedge_are_found() {
        let mut elements = ElementList::default();
        elements.push(ElementKind::C3D6, 3, &[0, 1, 2, 3, 4, 5]);
        let facets = [Facet::from([4, 3, 0, 1]), Facet::from([0, 1, 2])];
        let skin = Skin::new(6, &elements, facets.iter());
        let found = facets.map(|facet| skin.face(&facet).unwrap());
        assert_eq!(found.map(|face| (face.part, face.inner)), [(3, false); 2]);
        assert_eq!(found.map(|face| face.facet), [[0, 1, 4, 3].into(), [0, 2, 1].into()]);
        assert_eq!(skin.face(&[0, 1, 4].into()), None);
    }
}
