//! Gmsh's types of element, and which of them are ours.

use crate::element::{FacetShape, Shape};

/// A type of element in a Gmsh file.
#[derive(Debug, PartialEq, Eq)]
pub struct GmshType {
    /// Gmsh's number.
    pub number: i32,
    /// What messages call it, in the plural.
    pub name: &'static str,
    /// Its dimension.
    pub dimension: i32,
    /// Number of its nodes.
    pub n_nodes: usize,
}

const fn kind(number: i32, name: &'static str, dimension: i32, n_nodes: usize) -> GmshType {
    GmshType { number, name, dimension, n_nodes }
}

static KINDS: [GmshType; 26] = [
    kind(1, "2-node lines", 1, 2),
    kind(2, "3-node triangles", 2, 3),
    kind(3, "4-node quadrangles", 2, 4),
    kind(4, "4-node tetrahedra", 3, 4),
    kind(5, "8-node hexahedra", 3, 8),
    kind(6, "6-node prisms", 3, 6),
    kind(7, "5-node pyramids", 3, 5),
    kind(8, "3-node lines", 1, 3),
    kind(9, "6-node triangles", 2, 6),
    kind(10, "9-node quadrangles", 2, 9),
    kind(11, "10-node tetrahedra", 3, 10),
    kind(12, "27-node hexahedra", 3, 27),
    kind(13, "18-node prisms", 3, 18),
    kind(14, "14-node pyramids", 3, 14),
    kind(15, "points", 0, 1),
    kind(16, "8-node quadrangles", 2, 8),
    kind(17, "20-node hexahedra", 3, 20),
    kind(18, "15-node prisms", 3, 15),
    kind(19, "13-node pyramids", 3, 13),
    kind(20, "9-node triangles", 2, 9),
    kind(21, "10-node triangles", 2, 10),
    kind(26, "4-node lines", 1, 4),
    kind(27, "5-node lines", 1, 5),
    kind(29, "20-node tetrahedra", 3, 20),
    kind(30, "35-node tetrahedra", 3, 35),
    kind(92, "64-node hexahedra", 3, 64),
];

/// The type of a shape.
pub fn of_shape(shape: Shape) -> &'static GmshType {
    KINDS.iter().find(|kind| kind.shape() == Some(shape)).expect("every shape has a type")
}

/// The type of a facet's shape.
pub fn of_facet(shape: FacetShape) -> &'static GmshType {
    KINDS.iter().find(|kind| kind.is_facet() && kind.n_nodes == shape.n_nodes()).expect("every shape has a type")
}

/// The kind with Gmsh's number.
pub fn by_number(number: i32) -> Option<&'static GmshType> {
    KINDS.iter().find(|kind| kind.number == number)
}

const TETRAHEDRON_10: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];
const WEDGE_15: [usize; 15] = [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11];
const HEXAHEDRON_20: [usize; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15];

impl GmshType {
    /// The shape of solid elements of this type; none where they are not analysed.
    pub fn shape(&self) -> Option<Shape> {
        Some(match self.number {
            4 => Shape::Tetrahedron4,
            5 => Shape::Hexahedron8,
            6 => Shape::Wedge6,
            11 => Shape::Tetrahedron10,
            17 => Shape::Hexahedron20,
            18 => Shape::Wedge15,
            _ => return None,
        })
    }

    /// Whether elements of this type are facets of such elements.
    pub fn is_facet(&self) -> bool {
        self.dimension == 2 && FacetShape::ALL.iter().any(|shape| shape.n_nodes() == self.n_nodes)
    }

    /// For each node of ours, its place in Gmsh's order; none where the orders are alike.
    pub fn order(&self) -> Option<&'static [usize]> {
        match self.number {
            11 => Some(&TETRAHEDRON_10),
            17 => Some(&HEXAHEDRON_20),
            18 => Some(&WEDGE_15),
            _ => None,
        }
    }

    /// What to do about elements of this type.
    pub fn advice(&self) -> &'static str {
        match self.number {
            10 | 12 | 13 => "Set Mesh.SecondOrderIncomplete = 1 and mesh again",
            7 | 14 | 19 => {
                "Pyramids are not analysed: mesh the part with hexahedra or tetrahedra alone, with surfaces of its own"
            }
            _ => "Mesh with tetrahedra, hexahedra or wedges of first or second order (Mesh.ElementOrder = 2)",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gmsh's edges in the order of its midsides, from its manual, "Node ordering".
    fn edges(shape: Shape) -> &'static [[usize; 2]] {
        match shape {
            Shape::Tetrahedron10 => &[[0, 1], [1, 2], [2, 0], [3, 0], [2, 3], [1, 3]],
            Shape::Wedge15 => &[[0, 1], [0, 2], [0, 3], [1, 2], [1, 4], [2, 5], [3, 4], [3, 5], [4, 5]],
            Shape::Hexahedron20 => {
                &[[0, 1], [0, 3], [0, 4], [1, 2], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 7], [5, 6], [6, 7]]
            }
            _ => &[],
        }
    }

    #[test]
    fn midsides_come_to_their_edges() {
        for kind in &KINDS {
            let Some(shape) = kind.shape() else { continue };
            assert_eq!(shape.n_nodes(), kind.n_nodes);
            let corners = &shape.interpolation().nodes()[..shape.n_corners()];
            let middle = |edge: &[usize; 2]| [0, 1, 2].map(|i| 0.5 * (corners[edge[0]][i] + corners[edge[1]][i]));
            let nodes: Vec<[f64; 3]> = corners.iter().copied().chain(edges(shape).iter().map(middle)).collect();
            let ours: Vec<[f64; 3]> = match kind.order() {
                Some(order) => order.iter().map(|&place| nodes[place]).collect(),
                None => nodes,
            };
            assert_eq!(ours, shape.interpolation().nodes(), "{shape:?}");
        }
    }
}
