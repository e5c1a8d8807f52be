//! The finite element mesh: nodes, 10-node tetrahedra grouped into parts, named surfaces and node sets.

use std::collections::BTreeMap;

/// A mesh of 10-node tetrahedra in metres.
///
/// Node order of a tetrahedron: corners 0-3, then the midsides of the edges
/// (0,1) (1,2) (2,0) (0,3) (1,3) (2,3). Node order of a facet: corners 0-2, then the midsides of (0,1) (1,2) (2,0).
#[derive(Debug, Clone, Default)]
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
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// The facets, six node indices each.
    pub facets: Vec<[u32; 6]>,
    /// For each facet the index of the tetrahedron it belongs to.
    pub tets: Vec<u32>,
}
