//! What a part's rotation means for its vibrations, and whether the part is a solid of revolution.

use std::collections::HashMap;

use crate::algebra::{dot, norm};
use crate::element::facet::area_normal;
use crate::mesh::{Facet, Mesh, Numbering};
use crate::model::{Inertia, Rotation};
use crate::native::Comm;

use super::FullModel;

/// Root mean square of the normal velocity of a part's surface, over that of its velocity: above, the part is no solid
/// of revolution. Bolt holes of 2 % of the surface give 0.1.
const NORMAL_SHARE: f64 = 0.1;

impl FullModel {
    /// The fastest point of a part that turns, m/s. Collective.
    pub fn largest_speed(&self, comm: &Comm, rotation: &Rotation) -> f64 {
        let part = self.mesh.parts.iter().position(|part| *part == rotation.part);
        let own = self.mesh.elements.iter().filter(|element| Some(element.part as usize) == part);
        let speeds =
            own.flat_map(|element| element.nodes).map(|&n| norm(rotation.velocity(self.mesh.nodes[n as usize])));
        let mut largest = [speeds.fold(0.0, f64::max)];
        comm.max_all(&mut largest);
        largest[0]
    }

    /// A warning of each part that has the inertia forces of a solid of revolution and is none. Collective.
    pub(super) fn revolution_warnings(&self, comm: &Comm) -> Vec<String> {
        let fixed = self.model.rotations.iter().filter(|rotation| rotation.inertia == Inertia::FixedFrame);
        fixed
            .filter_map(|rotation| revolution(&rotation.part, normal_share(comm, &self.mesh, &self.nodes, rotation)))
            .collect()
    }
}

/// What is wrong with a part of which the surface has such a share of normal velocity.
fn revolution(part: &str, share: f64) -> Option<String> {
    (share > NORMAL_SHARE).then(|| {
        format!(
            "part {part:?} is no solid of revolution about its axis: its surface moves along its normal by {:.0} % of its speed, so that \
             inertia = \"fixed_frame\" is an approximation. Look at axis and through of its [[rotation]], or leave inertia out",
            100.0 * share
        )
    })
}

/// `sqrt(integral of (v . n)^2 / integral of v^2)` over the surface of a part. Collective.
fn normal_share(comm: &Comm, mesh: &Mesh, nodes: &Numbering, rotation: &Rotation) -> f64 {
    let part = mesh.parts.iter().position(|part| *part == rotation.part);
    let mut faces: HashMap<[u32; 4], Facet> = HashMap::new();
    for element in mesh.elements.iter().filter(|element| Some(element.part as usize) == part) {
        for facet in element.facets() {
            let key = facet.key();
            // A face between two elements of the part is not outside.
            if nodes.owns(key[0]) && faces.remove(&key).is_none() {
                faces.insert(key, facet);
            }
        }
    }
    let mut sums = [0.0; 2];
    for facet in faces.values() {
        let x = facet.positions(&mesh.nodes);
        for point in facet.shape().rule() {
            let normal = area_normal(&x, point.at);
            let shapes = facet.shape().interpolation().shape(point.at);
            let at = [0, 1, 2].map(|i| x.iter().zip(shapes).map(|(x, n)| n * x[i]).sum());
            let (velocity, area) = (rotation.velocity(at), norm(normal));
            sums[0] += point.weight * dot(velocity, normal).powi(2) / area;
            sums[1] += point.weight * area * dot(velocity, velocity);
        }
    }
    comm.sum_all(&mut sums);
    if sums[1] > 0.0 { (sums[0] / sums[1]).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::element::ElementKind;
    use crate::model::Place;
    use crate::native::Session;

    /// A ring of hexahedra of second order about z, its outer radius 1 + `wave` times the cosine of three angles.
    fn ring(wave: f64) -> (Mesh, Numbering) {
        let mut mesh = Mesh { parts: vec!["disc".into()], ..Mesh::default() };
        let n = 12;
        for cell in 0..n {
            let place = |[xi, eta, zeta]: [f64; 3]| {
                let angle = TAU * (f64::from(cell) + 0.5 * (1.0 + eta)) / f64::from(n);
                let r = 0.5 + 0.5 * (0.5 + wave * (3.0 * angle).cos()) * (1.0 + xi);
                [r * angle.cos(), r * angle.sin(), 0.1 * (1.0 + zeta)]
            };
            let all = ElementKind::C3D20.shape().interpolation().nodes();
            let numbers: Vec<u32> = all[..20].iter().map(|&node| number_of(&mut mesh, place(node))).collect();
            mesh.elements.push(ElementKind::C3D20, 0, &numbers);
        }
        let nodes = Numbering::even(mesh.nodes.len(), 0, 1);
        (mesh, nodes)
    }

    /// The number of a node, which joins the mesh where it has none.
    fn number_of(mesh: &mut Mesh, x: [f64; 3]) -> u32 {
        let is_there = |own: &[f64; 3]| (0..3).all(|i| (own[i] - x[i]).abs() < 1e-9);
        let known = mesh.nodes.iter().position(is_there);
        known.unwrap_or_else(|| {
            mesh.nodes.push(x);
            mesh.nodes.len() - 1
        }) as u32
    }

    #[test]
    fn a_ring_is_a_solid_of_revolution_about_its_own_axis_and_a_wavy_one_about_none() {
        let comm = Session::start(&[]).unwrap();
        let share = |wave: f64, through: [f64; 3]| {
            let (mesh, nodes) = ring(wave);
            let (axis, inertia, place) = ([0.0, 0.0, 1.0], Inertia::FixedFrame, Place::default());
            normal_share(
                &comm,
                &mesh,
                &nodes,
                &Rotation { part: "disc".into(), axis, through, speed: 5.0, inertia, place },
            )
        };
        assert!(share(0.0, [0.0; 3]) < 1e-2, "{}", share(0.0, [0.0; 3]));
        assert!(share(0.2, [0.0; 3]) > NORMAL_SHARE, "{}", share(0.2, [0.0; 3]));
        assert!(share(0.0, [0.3, 0.0, 0.0]) > NORMAL_SHARE, "{}", share(0.0, [0.3, 0.0, 0.0]));
        assert_eq!(revolution("disc", 0.09), None);
        assert!(revolution("disc", 0.3).unwrap().contains("part \"disc\" is no solid of revolution"));
    }
}
