//! What reference nodes become: rigid node sets, supports, stiff connectors to the ground, forces at points.
//!
//! A rigid set of which all six displacements are held is a support. One that is held in part, and any held mean
//! motion, gets a connector to the ground with
//!
//! ```text
//! k = 1e4 E L    along,    k L^2 about the held axes
//! ```
//!
//! E is the largest Young's modulus of the model, L the size of the set, or of a mean element where the set is one
//! node: an error of about 1e-4 of the deformation of a body of this size.

use super::Conversion;
use super::references::{Reference, References};
use super::regions::unlike;
use super::supports::OTHER_THAN_ZERO;
use crate::Result;
use crate::algebra::{cross, norm, sub};
use crate::deck::geometry::surface_centroid;
use crate::model::{Connector, Fix, GROUND, Load, LoadKind, Model, PENALTY, Part, Place, RigidSet};

/// A connector without constants.
pub(super) fn connector(name: String, between: [String; 2], at: [f64; 3], place: Place) -> Connector {
    let [stiffness, rotational_stiffness, damping] = [[0.0; 3]; 3];
    Connector {
        name,
        between,
        at: Some(at),
        axes: None,
        stiffness,
        rotational_stiffness,
        damping,
        loss_factor: 0.0,
        place,
    }
}

impl Conversion<'_> {
    /// Adds what the reference nodes are to a model.
    pub(super) fn joints(&mut self, references: &References, model: &mut Model) -> Result<()> {
        for reference in &references.all {
            let is_support = reference.is_rigid && reference.held == [true; 6];
            if is_support {
                let (nodes, place) = (reference.region.clone(), reference.place);
                let axes = reference.coupled;
                let along = |i: usize| if axes[i] { reference.displacement[i] * self.units.length } else { 0.0 };
                model.fixes.push(Fix { nodes, axes, displacement: [0, 1, 2].map(along), place });
            } else {
                self.require_all_axes(reference)?;
                if reference.displacement != [0.0; 3] {
                    return Err(self.assembly.error(reference.place, OTHER_THAN_ZERO));
                }
                if reference.is_rigid {
                    let name =
                        unlike(&reference.region, |name| model.rigid_sets.iter().any(|own| own.name == name), "rigid");
                    let (nodes, place) = (reference.region.clone(), reference.place);
                    model.rigid_sets.push(RigidSet { name, nodes, place });
                }
                model.connectors.extend(self.held(reference));
            }
            if reference.force.iter().any(|(_, force)| *force != 0.0) && !is_support {
                let load = self.load(reference);
                model.loads.push(load);
            }
        }
        Ok(())
    }

    fn require_all_axes(&self, reference: &Reference) -> Result<()> {
        if reference.coupled == [true; 3] {
            return Ok(());
        }
        let what = "a coupling of some displacements is supported where all six of its reference node are held. \
                    Couple 1 to 3, or hold them by *BOUNDARY";
        Err(self.assembly.error(reference.place, what))
    }

    /// The connector to the ground that holds a motion.
    fn held(&self, reference: &Reference) -> Option<Connector> {
        if reference.held == [false; 6] {
            return None;
        }
        let (between, name) =
            ([reference.region.clone(), GROUND.to_owned()], format!("support of {}", reference.region));
        let [along, about] = self.rigid_stiffness(&reference.region);
        let held = |first: usize, k: f64| [0, 1, 2].map(|i| if reference.held[first + i] { k } else { 0.0 });
        let mut support = connector(name, between, self.point(reference.node), reference.place);
        (support.stiffness, support.rotational_stiffness) = (held(0, along), held(3, about));
        Some(support)
    }

    /// Stiffness along (N/m) and about (N m/rad) an axis of what does not give way beside a region.
    pub(super) fn rigid_stiffness(&self, region: &str) -> [f64; 2] {
        let mesh = &self.regions.mesh;
        let own = extent(mesh.node_set(region).unwrap_or_default().iter().map(|&n| mesh.nodes[n as usize]));
        let of_element = extent(mesh.nodes.iter().copied()) / (mesh.elements.len() as f64).cbrt();
        let young = |part: &Part| part.material.youngs()[1];
        let largest = self.bodies.parts.iter().map(young).fold(0.0, f64::max);
        let size = if own > 0.0 { own } else { of_element };
        let along = PENALTY * largest * size;
        [along, along * size * size]
    }

    /// The point of a node of the assembly, m.
    pub(super) fn point(&self, node: u32) -> [f64; 3] {
        self.assembly.coordinates[node as usize].map(|x| x * self.units.length)
    }

    /// The force and moment on a reference node. A force through the centroid of a surface that follows on average is
    /// a uniform traction.
    fn load(&self, reference: &Reference) -> Load {
        let (on, at) = (reference.region.clone(), self.point(reference.node));
        let [x, y, z, u, v, w] = reference.force.map(|(_, value)| value);
        let force = [x, y, z].map(|f| f * self.units.force());
        let moment = [u, v, w].map(|m| m * self.units.force() * self.units.length);
        let is_central = self.centroid(&on).is_some_and(|(centroid, size)| {
            norm(cross(sub(at, centroid), force)) <= 1e-3 * size * norm(force) && moment == [0.0; 3]
        });
        let kind = match is_central && !reference.is_rigid {
            true => LoadKind::ForceByArea(force),
            false => LoadKind::ForceAt { force, moment, at: Some(at) },
        };
        let place = reference.force_place.unwrap_or(reference.place);
        Load { name: format!("force on {on}"), on, kind, place }
    }

    /// Centroid and size of a surface of the mesh, m.
    fn centroid(&self, surface: &str) -> Option<([f64; 3], f64)> {
        let mesh = &self.regions.mesh;
        let (area, centroid) = surface_centroid(mesh, mesh.surfaces.get(surface)?);
        Some((centroid, area.sqrt()))
    }
}

/// The diagonal of the box around some points; 0 of none.
fn extent(points: impl Iterator<Item = [f64; 3]>) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for x in points {
        (0..3).for_each(|i| (low[i], high[i]) = (low[i].min(x[i]), high[i].max(x[i])));
    }
    if low[0] <= high[0] { norm(sub(high, low)) } else { 0.0 }
}
