//! The stiffness of a contact for which a deck has none: `HARD`, or nothing said.
//!
//! A penalty is stiff enough where the overlap is small beside the deformation of the elements next to it, and stiffer
//! only costs digits. So it is a multiple of the stiffness per area of a layer of elements of the softer side:
//!
//! ```text
//! k_n = 10 min(E_slave / h_slave, E_master / h_master)
//! ```
//!
//! E is the smallest Young's modulus of the part, h the edge of a mean facet of the surface, taken for a square or, if
//! it is a triangle, half of one.
//! The factor is that of Abaqus's default penalty, "10 times the representative underlying element stiffness" (Abaqus
//! Analysis User's Guide, "Contact constraint enforcement methods in Abaqus/Standard").

use super::super::geometry::surface_centroid;
use super::Conversion;
use crate::model::softest_young;

/// Multiple of the stiffness of a layer of elements.
pub const STIFFNESS_FACTOR: f64 = 10.0;

impl Conversion<'_> {
    /// The proposed stiffness of a contact between two surfaces of the mesh, N/m3.
    pub(super) fn proposed_stiffness(&self, slave: &str, master: &str) -> f64 {
        let mesh = &self.regions.mesh;
        let layer = |name: &str| {
            let surface = &mesh.surfaces[name];
            let size = surface.facet_size(surface_centroid(mesh, surface).0);
            softest_young(&self.bodies.parts, mesh, &[name]) / size
        };
        STIFFNESS_FACTOR * layer(slave).min(layer(master))
    }
}
