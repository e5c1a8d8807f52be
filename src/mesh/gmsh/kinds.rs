//! Gmsh's kinds of element, as far as they are named in messages or skipped.

/// A kind of element.
#[derive(Debug, PartialEq, Eq)]
pub struct ElementKind {
    /// Gmsh's number.
    pub number: i32,
    /// What messages call it, in the plural.
    pub name: &'static str,
    /// Its dimension.
    pub dimension: i32,
    /// Number of its nodes.
    pub n_nodes: usize,
}

/// The only volume element that is analysed.
pub const TET10: i32 = 11;
/// The only facet that is analysed.
pub const TRI6: i32 = 9;

const fn kind(number: i32, name: &'static str, dimension: i32, n_nodes: usize) -> ElementKind {
    ElementKind { number, name, dimension, n_nodes }
}

static KINDS: [ElementKind; 26] = [
    kind(1, "2-node lines", 1, 2),
    kind(2, "3-node triangles", 2, 3),
    kind(3, "4-node quadrangles", 2, 4),
    kind(4, "4-node tetrahedra", 3, 4),
    kind(5, "8-node hexahedra", 3, 8),
    kind(6, "6-node prisms", 3, 6),
    kind(7, "5-node pyramids", 3, 5),
    kind(8, "3-node lines", 1, 3),
    kind(TRI6, "6-node triangles", 2, 6),
    kind(10, "9-node quadrangles", 2, 9),
    kind(TET10, "10-node tetrahedra", 3, 10),
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

/// The kind with Gmsh's number.
pub fn by_number(number: i32) -> Option<&'static ElementKind> {
    KINDS.iter().find(|kind| kind.number == number)
}

impl ElementKind {
    /// What to do about elements of this kind where 10-node tetrahedra or 6-node triangles are needed.
    pub fn advice(&self) -> &'static str {
        match self.number {
            2 | 4 | 20 | 21 | 29 | 30 => "Set Mesh.ElementOrder = 2 and mesh again",
            _ => "Mesh with second-order tetrahedra: no recombination, no extruded layers, Mesh.ElementOrder = 2",
        }
    }
}
