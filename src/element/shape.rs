//! The geometry of solid elements: nodes, faces and shape functions, by tables.
//!
//! ```text
//!            3                       5                     7-------6        corners first, then the midsides of the
//!           /|\                     /|\                   /|      /|        edges:
//!          7 | 9                   3---4                 4-------5 |        tetrahedron (0,1) (1,2) (2,0) (0,3) (1,3)
//!         /  8  \                  | | |                 | |     | |                    (2,3)
//!        0 --6|-- 2                | 2 |                 | 3-----|-2        wedge       bottom, top, upright
//!         \  |  /                  |/ \|                 |/      |/         hexahedron  bottom, top, upright
//!          4 | 5                   0---1                 0-------1
//!           \|/
//!            1                xi, eta in the           [-1, 1]^3
//!       unit tetrahedron      unit triangle,
//!                             zeta in [-1, 1]
//! ```
//!
//! Node and face order are those of Abaqus and CalculiX. A linear element has the first nodes of the quadratic one, and
//! the corners of its faces. An element is well shaped when `detJ > 0` everywhere.

use super::FacetShape;
use super::interpolation::Interpolation;

/// The geometry of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shape {
    /// 4 nodes.
    Tetrahedron4,
    /// 10 nodes.
    Tetrahedron10,
    /// 6 nodes.
    Wedge6,
    /// 15 nodes.
    Wedge15,
    /// 8 nodes.
    Hexahedron8,
    /// 20 nodes.
    Hexahedron20,
}

/// Largest number of nodes of an element.
pub const MAX_NODES: usize = 20;

const TETRAHEDRON_NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];

const TETRAHEDRON_POWERS: [[u8; 3]; 10] =
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 1, 0], [0, 1, 1], [1, 0, 1]];

const TETRAHEDRON_FACES: [&[usize]; 4] =
    [&[0, 2, 1, 6, 5, 4], &[0, 1, 3, 4, 8, 7], &[1, 2, 3, 5, 9, 8], &[2, 0, 3, 6, 7, 9]];

const WEDGE_NODES: [[f64; 3]; 15] = [
    [0.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.5, 0.0, -1.0],
    [0.5, 0.5, -1.0],
    [0.0, 0.5, -1.0],
    [0.5, 0.0, 1.0],
    [0.5, 0.5, 1.0],
    [0.0, 0.5, 1.0],
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
];

const WEDGE_POWERS: [[u8; 3]; 15] = [
    [0, 0, 0],
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [0, 1, 1],
    [2, 0, 0],
    [1, 1, 0],
    [0, 2, 0],
    [2, 0, 1],
    [1, 1, 1],
    [0, 2, 1],
    [0, 0, 2],
    [1, 0, 2],
    [0, 1, 2],
];

const WEDGE_FACES: [&[usize]; 5] = [
    &[0, 2, 1, 8, 7, 6],
    &[3, 4, 5, 9, 10, 11],
    &[0, 1, 4, 3, 6, 13, 9, 12],
    &[1, 2, 5, 4, 7, 14, 10, 13],
    &[2, 0, 3, 5, 8, 12, 11, 14],
];

const HEXAHEDRON_NODES: [[f64; 3]; 20] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

const HEXAHEDRON_POWERS: [[u8; 3]; 20] = [
    [0, 0, 0],
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 0],
    [0, 1, 1],
    [1, 0, 1],
    [1, 1, 1],
    [2, 0, 0],
    [2, 1, 0],
    [2, 0, 1],
    [2, 1, 1],
    [0, 2, 0],
    [1, 2, 0],
    [0, 2, 1],
    [1, 2, 1],
    [0, 0, 2],
    [1, 0, 2],
    [0, 1, 2],
    [1, 1, 2],
];

const HEXAHEDRON_FACES: [&[usize]; 6] = [
    &[0, 3, 2, 1, 11, 10, 9, 8],
    &[4, 5, 6, 7, 12, 13, 14, 15],
    &[0, 1, 5, 4, 8, 17, 12, 16],
    &[1, 2, 6, 5, 9, 18, 13, 17],
    &[2, 3, 7, 6, 10, 19, 14, 18],
    &[3, 0, 4, 7, 11, 16, 15, 19],
];

pub(super) static TETRAHEDRON_4: Interpolation<3, MAX_NODES> =
    Interpolation::new(4, &TETRAHEDRON_NODES, &TETRAHEDRON_POWERS);
pub(super) static TETRAHEDRON_10: Interpolation<3, MAX_NODES> =
    Interpolation::new(10, &TETRAHEDRON_NODES, &TETRAHEDRON_POWERS);
pub(super) static WEDGE_6: Interpolation<3, MAX_NODES> = Interpolation::new(6, &WEDGE_NODES, &WEDGE_POWERS);
pub(super) static WEDGE_15: Interpolation<3, MAX_NODES> = Interpolation::new(15, &WEDGE_NODES, &WEDGE_POWERS);
pub(super) static HEXAHEDRON_8: Interpolation<3, MAX_NODES> =
    Interpolation::new(8, &HEXAHEDRON_NODES, &HEXAHEDRON_POWERS);
pub(super) static HEXAHEDRON_20: Interpolation<3, MAX_NODES> =
    Interpolation::new(20, &HEXAHEDRON_NODES, &HEXAHEDRON_POWERS);

impl Shape {
    /// All shapes.
    pub const ALL: [Shape; 6] = [
        Shape::Tetrahedron4,
        Shape::Tetrahedron10,
        Shape::Wedge6,
        Shape::Wedge15,
        Shape::Hexahedron8,
        Shape::Hexahedron20,
    ];

    /// Shape functions and the reference coordinates of the nodes.
    pub fn interpolation(self) -> &'static Interpolation<3, MAX_NODES> {
        match self {
            Shape::Tetrahedron4 => &TETRAHEDRON_4,
            Shape::Tetrahedron10 => &TETRAHEDRON_10,
            Shape::Wedge6 => &WEDGE_6,
            Shape::Wedge15 => &WEDGE_15,
            Shape::Hexahedron8 => &HEXAHEDRON_8,
            Shape::Hexahedron20 => &HEXAHEDRON_20,
        }
    }

    /// Number of nodes.
    pub const fn n_nodes(self) -> usize {
        match self {
            Shape::Tetrahedron4 => 4,
            Shape::Tetrahedron10 => 10,
            Shape::Wedge6 => 6,
            Shape::Wedge15 => 15,
            Shape::Hexahedron8 => 8,
            Shape::Hexahedron20 => 20,
        }
    }

    /// Number of corners; they are the first nodes.
    pub const fn n_corners(self) -> usize {
        match self {
            Shape::Tetrahedron4 | Shape::Tetrahedron10 => 4,
            Shape::Wedge6 | Shape::Wedge15 => 6,
            Shape::Hexahedron8 | Shape::Hexahedron20 => 8,
        }
    }

    /// Whether the edges have midsides.
    pub const fn is_quadratic(self) -> bool {
        self.n_nodes() > self.n_corners()
    }

    /// What messages call elements of this shape, in the plural.
    pub const fn name(self) -> &'static str {
        match self {
            Shape::Tetrahedron4 => "4-node tetrahedra",
            Shape::Tetrahedron10 => "10-node tetrahedra",
            Shape::Wedge6 => "6-node wedges",
            Shape::Wedge15 => "15-node wedges",
            Shape::Hexahedron8 => "8-node hexahedra",
            Shape::Hexahedron20 => "20-node hexahedra",
        }
    }

    /// The nodes of each face as a facet: corners, then midsides, turning so that the normal points out of the element.
    pub fn faces(self) -> impl Iterator<Item = &'static [usize]> {
        let faces: &[&[usize]] = match self.n_corners() {
            4 => &TETRAHEDRON_FACES,
            6 => &WEDGE_FACES,
            _ => &HEXAHEDRON_FACES,
        };
        faces.iter().map(move |face| if self.is_quadratic() { face } else { &face[..face.len() / 2] })
    }

    /// The nodes of the element with straight edges, its midsides in the middle, from its corners.
    ///
    /// # Panics
    /// Where these are not as many as the shape has corners.
    pub fn straight(self, corners: &[[f64; 3]]) -> Vec<[f64; 3]> {
        assert_eq!(corners.len(), self.n_corners());
        let mut nodes = vec![[0.0; 3]; self.n_nodes()];
        nodes[..corners.len()].copy_from_slice(corners);
        for face in self.faces() {
            let n = FacetShape::of(face.len()).n_corners();
            for (k, &midside) in face[n..].iter().enumerate() {
                let [a, b] = [face[k], face[(k + 1) % n]].map(|corner| corners[corner]);
                nodes[midside] = [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]));
            }
        }
        nodes
    }

    /// The corners that an edge joins with a corner: three.
    pub fn neighbours(self, corner: usize) -> Vec<usize> {
        let mut found = Vec::new();
        for face in self.faces() {
            let corners = &face[..FacetShape::of(face.len()).n_corners()];
            if let Some(at) = corners.iter().position(|&c| c == corner) {
                let next = corners[(at + 1) % corners.len()];
                found.push(next);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{cross, dot, sub};

    fn middle(points: &[[f64; 3]]) -> [f64; 3] {
        [0, 1, 2].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64)
    }

    #[test]
    fn faces_look_out_and_their_midsides_lie_between_their_corners() {
        for shape in Shape::ALL {
            let nodes = shape.interpolation().nodes();
            assert_eq!(nodes.len(), shape.n_nodes());
            let centre = middle(&nodes[..shape.n_corners()]);
            for face in shape.faces() {
                let n_corners = FacetShape::of(face.len()).n_corners();
                let x: Vec<[f64; 3]> = face.iter().map(|&a| nodes[a]).collect();
                let normal = cross(sub(x[1], x[0]), sub(x[2], x[0]));
                assert!(dot(normal, sub(x[0], centre)) > 0.0, "{shape:?} {face:?}");
                for k in 0..x.len() - n_corners {
                    assert_eq!(x[n_corners + k], middle(&[x[k], x[(k + 1) % n_corners]]), "{shape:?} {face:?}");
                }
            }
        }
    }

    #[test]
    fn each_edge_lies_on_two_faces_that_run_through_it_in_opposite_directions() {
        for shape in Shape::ALL {
            for corner in 0..shape.n_corners() {
                let neighbours = shape.neighbours(corner);
                assert_eq!(neighbours.len(), 3);
                assert!(neighbours.iter().all(|&other| shape.neighbours(other).contains(&corner)));
            }
        }
    }
}
