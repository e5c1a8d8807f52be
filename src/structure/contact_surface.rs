//! Contact results as fields on the slave surfaces.

use std::collections::HashMap;

use crate::contact::{ContactPoint, Interface, Response, Status};
use crate::mesh::Mesh;
use crate::results::ContactFaces;

/// The slave facets of all pairs, each pair with nodes of its own: exact values at the contact points (midside nodes),
/// the mean of the neighbours at corners.
#[derive(Default)]
pub struct ContactSurface {
    /// The mesh's node behind each node of the surface.
    pub nodes: Vec<u32>,
    /// Facets, in nodes of the surface.
    pub facets: Vec<[u32; 6]>,
    /// Pair of each facet, in the interface's order.
    pub pairs: Vec<i32>,
    /// Values at the nodes.
    pub fields: Fields,
}

/// Values at nodes.
#[derive(Default)]
pub struct Fields {
    /// Normal force over weight, Pa.
    pub pressure: Vec<f64>,
    /// Force on the slave over weight, Pa.
    pub traction: Vec<[f64; 3]>,
    /// 0 open, 1 slip, 2 stick, -1 no contact point.
    pub status: Vec<i32>,
}

impl Fields {
    fn nothing(n: usize) -> Fields {
        Fields { pressure: vec![0.0; n], traction: vec![[0.0; 3]; n], status: vec![-1; n] }
    }

    fn push(&mut self, pressure: f64, traction: [f64; 3], status: i32) {
        self.pressure.push(pressure);
        self.traction.push(traction);
        self.status.push(status);
    }

    /// The values at some of the nodes.
    pub fn at(&self, nodes: &[u32]) -> Fields {
        let of = |n: &u32| *n as usize;
        Fields {
            pressure: nodes.iter().map(|n| self.pressure[of(n)]).collect(),
            traction: nodes.iter().map(|n| self.traction[of(n)]).collect(),
            status: nodes.iter().map(|n| self.status[of(n)]).collect(),
        }
    }
}

impl ContactSurface {
    /// The surfaces with the responses of their points; without any, no point touches.
    pub fn new(mesh: &Mesh, interface: &Interface, responses: &[Response]) -> ContactSurface {
        let mut surface = ContactSurface::default();
        for (number, pair) in interface.pairs.iter().enumerate() {
            let own = interface.points[pair.points.clone()].iter();
            let own = own.zip(responses.get(pair.points.clone()).unwrap_or_default());
            let of_nodes = |(point, response)| {
                let values = at(point, response);
                point.nodes.iter().map(move |&node| (node, values))
            };
            let values: HashMap<u32, _> = own.flat_map(of_nodes).collect();
            surface.add(&mesh.surfaces[&pair.slave].facets, number as i32, &values);
        }
        surface
    }

    fn add(&mut self, facets: &[[u32; 6]], pair: i32, values: &HashMap<u32, (f64, [f64; 3], i32)>) {
        let mut local: HashMap<u32, u32> = HashMap::new();
        let first = self.facets.len();
        for facet in facets {
            let place = |&n: &u32| {
                *local.entry(n).or_insert_with(|| {
                    let (pressure, traction, status) = values.get(&n).copied().unwrap_or((0.0, [0.0; 3], -1));
                    self.nodes.push(n);
                    self.fields.push(pressure, traction, status);
                    self.nodes.len() as u32 - 1
                })
            };
            let facet = facet.each_ref().map(place);
            self.facets.push(facet);
            self.pairs.push(pair);
        }
        self.fill_corners(first);
    }

    /// Corners take the mean over the midsides next to them.
    fn fill_corners(&mut self, first: usize) {
        let fields = &mut self.fields;
        let mut count = vec![0.0; self.nodes.len()];
        for facet in &self.facets[first..] {
            for (corner, sides) in [(0, [3, 5]), (1, [3, 4]), (2, [4, 5])] {
                let corner = facet[corner] as usize;
                for side in sides.map(|s| facet[s] as usize) {
                    count[corner] += 1.0;
                    fields.pressure[corner] += fields.pressure[side];
                    (0..3).for_each(|i| fields.traction[corner][i] += fields.traction[side][i]);
                    fields.status[corner] = fields.status[corner].max(fields.status[side]);
                }
            }
        }
        for (node, &n) in count.iter().enumerate().filter(|(_, n)| **n > 0.0) {
            fields.pressure[node] /= n;
            fields.traction[node] = fields.traction[node].map(|t| t / n);
        }
    }

    /// The surfaces as results keep them, each facet in four triangles between its six nodes.
    pub fn faces(&self, mesh: &Mesh) -> ContactFaces {
        const PARTS: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
        let mut pair_of_node = vec![0; self.nodes.len()];
        for (facet, &pair) in self.facets.iter().zip(&self.pairs) {
            facet.iter().for_each(|&node| pair_of_node[node as usize] = pair);
        }
        ContactFaces {
            nodes: self.nodes.iter().map(|&n| mesh.nodes[n as usize]).collect(),
            triangles: self.facets.iter().flat_map(|facet| PARTS.map(|part| part.map(|i| facet[i]))).collect(),
            pair: self.pairs.iter().flat_map(|&pair| [pair; 4]).collect(),
            pair_of_node,
        }
    }

    /// The fields at the nodes of the mesh; where surfaces meet, those of the higher pressure.
    pub fn on_mesh(&self, n_nodes: usize) -> Fields {
        let mut all = Fields::nothing(n_nodes);
        for (i, &node) in self.nodes.iter().enumerate() {
            let node = node as usize;
            if all.status[node] < 0 || self.fields.pressure[i] > all.pressure[node] {
                all.pressure[node] = self.fields.pressure[i];
                all.traction[node] = self.fields.traction[i];
                all.status[node] = self.fields.status[i];
            }
        }
        all
    }
}

/// Pressure, traction and status of a point.
fn at(point: &ContactPoint, response: &Response) -> (f64, [f64; 3], i32) {
    let weight = point.law.weight;
    (response.normal_force / weight, response.force.map(|f| f / weight), status(response))
}

/// The status of a point as a number.
pub fn status(response: &Response) -> i32 {
    match response.status {
        Status::Open => 0,
        Status::Slip => 1,
        Status::Stick => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_take_the_mean_of_the_midsides_next_to_them() {
        let mut surface = ContactSurface::default();
        let values =
            HashMap::from([(13, (2.0, [1.0, 0.0, 0.0], 1)), (14, (4.0, [0.0; 3], 2)), (15, (6.0, [0.0; 3], 0))]);
        surface.add(&[[10, 11, 12, 13, 14, 15]], 7, &values);
        assert_eq!(surface.nodes, [10, 11, 12, 13, 14, 15]);
        assert_eq!(surface.fields.pressure, [4.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
        assert_eq!(surface.fields.status, [1, 2, 2, 1, 2, 0]);
        let all = surface.on_mesh(20);
        assert_eq!((all.pressure[14], all.status[14], all.status[0]), (4.0, 2, -1));
    }
}
