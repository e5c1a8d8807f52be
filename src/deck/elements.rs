//! The kinds of element that a deck may have, with the numbers of their nodes and their faces as decks number them.
//!
//! Source: Abaqus Analysis User's Guide, "Three-dimensional solid element library"; CalculiX CrunchiX 2.20 User's
//! Manual, section 6.2. Both number nodes and faces alike.

/// Nodes of each face, corners before midsides; the normal of the corners' turn points into the element.
pub type Faces = &'static [&'static [usize]];

/// A kind of element.
#[derive(Debug, PartialEq)]
pub struct ElementKind {
    /// Its name in a deck.
    pub name: &'static str,
    /// Number of its nodes.
    pub n_nodes: usize,
    /// What it is.
    pub class: Class,
}

/// What an element is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Class {
    /// A solid with its faces.
    Solid(Faces),
    /// A spring, dashpot, mass or connector.
    Discrete,
}

const TET4: Faces = &[&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[2, 3, 0]];
const TET10: Faces = &[&[0, 1, 2, 4, 5, 6], &[0, 3, 1, 7, 8, 4], &[1, 3, 2, 8, 9, 5], &[2, 3, 0, 9, 7, 6]];
const WEDGE6: Faces = &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]];
const WEDGE15: Faces = &[
    &[0, 1, 2, 6, 7, 8],
    &[3, 5, 4, 11, 10, 9],
    &[0, 3, 4, 1, 12, 9, 13, 6],
    &[1, 4, 5, 2, 13, 10, 14, 7],
    &[2, 5, 3, 0, 14, 11, 12, 8],
];
const HEX8: Faces = &[&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]];
const HEX20: Faces = &[
    &[0, 1, 2, 3, 8, 9, 10, 11],
    &[4, 7, 6, 5, 15, 14, 13, 12],
    &[0, 4, 5, 1, 16, 12, 17, 8],
    &[1, 5, 6, 2, 17, 13, 18, 9],
    &[2, 6, 7, 3, 18, 14, 19, 10],
    &[3, 7, 4, 0, 19, 15, 16, 11],
];

const fn solid(name: &'static str, n_nodes: usize, faces: Faces) -> ElementKind {
    ElementKind { name, n_nodes, class: Class::Solid(faces) }
}

const fn discrete(name: &'static str, n_nodes: usize) -> ElementKind {
    ElementKind { name, n_nodes, class: Class::Discrete }
}

/// All kinds.
pub static KINDS: [ElementKind; 20] = [
    solid("C3D4", 4, TET4),
    solid("C3D6", 6, WEDGE6),
    solid("C3D8", 8, HEX8),
    solid("C3D8I", 8, HEX8),
    solid("C3D8R", 8, HEX8),
    solid("C3D10", 10, TET10),
    solid("C3D10M", 10, TET10),
    solid("C3D10HS", 10, TET10),
    solid("C3D15", 15, WEDGE15),
    solid("C3D20", 20, HEX20),
    solid("C3D20R", 20, HEX20),
    discrete("SPRING1", 1),
    discrete("SPRING2", 2),
    discrete("SPRINGA", 2),
    discrete("DASHPOT1", 1),
    discrete("DASHPOT2", 2),
    discrete("DASHPOTA", 2),
    discrete("MASS", 1),
    discrete("ROTARYI", 1),
    discrete("CONN3D2", 2),
];

/// The kind with a name.
pub fn by_name(name: &str) -> Option<&'static ElementKind> {
    KINDS.iter().find(|kind| kind.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{cross, dot, norm, sub};

    /// Corners of the reference elements.
    const CORNERS: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];

    fn corners(n: usize) -> Vec<[f64; 3]> {
        match n {
            4 => [0, 1, 3, 4].map(|i| CORNERS[i]).to_vec(),
            6 => [0, 1, 3, 4, 5, 7].map(|i| CORNERS[i]).to_vec(),
            _ => CORNERS.to_vec(),
        }
    }

    /// Pairs of corners of the edges, in the order of the midsides.
    fn edges(n: usize) -> Vec<[usize; 2]> {
        match n {
            4 => vec![[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
            6 => vec![[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
            _ => {
                let round = |k: usize| (0..4).map(move |i| [k + i, k + (i + 1) % 4]);
                round(0).chain(round(4)).chain((0..4).map(|i| [i, i + 4])).collect()
            }
        }
    }

    /// Normals of all faces point into the element; midsides of quadratic faces lie between their corners in turn.
    #[test]
    fn faces_look_in_and_their_midsides_follow_their_corners() {
        for kind in &KINDS {
            let Class::Solid(faces) = kind.class else { continue };
            let n_corners = match kind.n_nodes {
                10 => 4,
                15 => 6,
                20 => 8,
                n => n,
            };
            let x = corners(n_corners);
            let edges = edges(n_corners);
            for face in faces {
                let n = if kind.n_nodes > n_corners { face.len() / 2 } else { face.len() };
                let [a, b, c] = [0, 1, 2].map(|i| x[face[i]]);
                let normal = cross(sub(b, a), sub(c, a));
                assert!(norm(normal) > 0.5, "{}", kind.name);
                assert!(x.iter().all(|&y| dot(sub(y, a), normal) > -1e-12), "{} {face:?}", kind.name);
                for (i, &middle) in face[n..].iter().enumerate() {
                    let mut ends = [face[i], face[(i + 1) % n]];
                    let mut edge = edges[middle - n_corners];
                    ends.sort_unstable();
                    edge.sort_unstable();
                    assert_eq!(ends, edge, "{} {face:?}", kind.name);
                }
            }
        }
    }
}
