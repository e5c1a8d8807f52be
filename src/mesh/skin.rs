//! Which part a facet belongs to, and the facet seen from outside it.

use std::collections::HashMap;

use crate::element::tet10::FACES;

/// A face of a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SkinFace {
    /// The part of the tetrahedron.
    pub part: u32,
    /// Nodes of the facet, turning so that its normal points out of the tetrahedron.
    pub facet: [u32; 6],
    /// Whether there is a tetrahedron on the other side, too.
    pub inner: bool,
}

/// Finds the tetrahedra behind facets.
pub struct Skin {
    faces: HashMap<[u32; 3], Option<SkinFace>>,
}

impl Skin {
    /// Looks for the faces of `tets` (with their parts) that are among `facets`.
    ///
    /// Where two tetrahedra share a facet, it belongs to that of the part with the lower index.
    pub fn new<'f>(
        n_nodes: usize,
        tets: &[[u32; 10]],
        tet_part: &[u32],
        facets: impl Iterator<Item = &'f [u32; 6]>,
    ) -> Skin {
        let mut wanted = vec![false; n_nodes];
        let mut faces = HashMap::new();
        for facet in facets {
            for &node in &facet[..3] {
                wanted[node as usize] = true;
            }
            faces.insert(key(facet), None);
        }
        for (nodes, &part) in tets.iter().zip(tet_part) {
            for facet in FACES.map(|local| local.map(|i| nodes[i])) {
                if !facet[..3].iter().all(|&node| wanted[node as usize]) {
                    continue;
                }
                if let Some(face) = faces.get_mut(&key(&facet)) {
                    *face = Some(outer(*face, SkinFace { part, facet, inner: false }));
                }
            }
        }
        Skin { faces }
    }

    /// The face behind a facet; none where no tetrahedron has its six nodes as a face.
    pub fn face(&self, facet: &[u32; 6]) -> Option<SkinFace> {
        let face = self.faces.get(&key(facet)).copied().flatten()?;
        (sorted(&face.facet[3..]) == sorted(&facet[3..])).then_some(face)
    }
}

/// Of two tetrahedra that meet at a facet, the one of the first part.
fn outer(known: Option<SkinFace>, found: SkinFace) -> SkinFace {
    let Some(known) = known else {
        return found;
    };
    SkinFace { inner: true, ..if known.part <= found.part { known } else { found } }
}

fn key(facet: &[u32; 6]) -> [u32; 3] {
    sorted(&facet[..3])
}

fn sorted(three: &[u32]) -> [u32; 3] {
    let mut key = [three[0], three[1], three[2]];
    key.sort_unstable();
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shared_facet_belongs_to_the_first_part() {
        let tets = [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], [0, 2, 1, 10, 6, 5, 4, 11, 12, 13]];
        let facet = [1, 2, 0, 5, 6, 4];
        let seen_from = [[0, 2, 1, 6, 5, 4], [0, 1, 2, 4, 5, 6]];
        for (parts, tet) in [([0, 1], 0), ([1, 0], 1), ([0, 0], 0)] {
            let skin = Skin::new(14, &tets, &parts, [facet].iter());
            let face = skin.face(&facet).unwrap();
            assert_eq!(face, SkinFace { part: 0, facet: seen_from[tet], inner: true });
        }
        let skin = Skin::new(14, &tets, &[0, 1], [[0, 1, 3, 4, 8, 7]].iter());
        let face = skin.face(&[3, 0, 1, 7, 4, 8]).unwrap();
        assert_eq!(face, SkinFace { part: 0, facet: [0, 1, 3, 4, 8, 7], inner: false });
        assert_eq!(skin.face(&[3, 0, 1, 7, 4, 9]), None);
        assert_eq!(skin.face(&[0, 3, 2, 7, 9, 6]), None);
    }
}
