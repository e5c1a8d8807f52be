//! Materials beside the surfaces of a mesh.

use super::Part;
use crate::mesh::Mesh;

/// The smallest Young's modulus, in any direction, of the parts that some surfaces of a mesh lie on, Pa; infinite where
/// they lie on none of these parts.
pub fn softest_young(parts: &[Part], mesh: &Mesh, surfaces: &[&str]) -> f64 {
    let beside = surfaces.iter().filter_map(|name| mesh.parts_of_surface(name)).flatten();
    let of_part = |part: u32| parts.iter().find(|own| own.name == mesh.parts[part as usize]);
    beside.filter_map(of_part).map(|part| part.material.youngs()[0]).fold(f64::INFINITY, f64::min)
}
