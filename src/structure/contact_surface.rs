//! Contact results as fields on the slave surfaces.

use std::collections::HashMap;

use crate::contact::surface_points::{Place, places};
use crate::contact::{ContactPoint, Interface, Response, Status};
use crate::element::FacetShape;
use crate::mesh::{Facet, Mesh};
use crate::results::ContactFaces;

/// The slave facets of all pairs, each pair with nodes of its own. A node at a contact point has its values, any other
/// the mean over the contact points next to it.
#[derive(Default)]
pub struct ContactSurface {
    /// The mesh's node behind each node of the surface.
    pub nodes: Vec<u32>,
    /// Facets, in nodes of the surface.
    pub facets: Vec<Facet>,
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

/// Pressure, traction and status of a contact point.
type Values = (f64, [f64; 3], i32);

/// Of a place without a contact point.
const NOTHING: Values = (0.0, [0.0; 3], -1);

/// Pairs of a facet's node and the contact point that it is at, or next to, in the order of `places`.
const fn next_to(shape: FacetShape) -> &'static [(usize, usize)] {
    match shape {
        FacetShape::Triangle3 => &[(0, 0), (1, 1), (2, 2)],
        FacetShape::Triangle6 => &[(3, 0), (4, 1), (5, 2), (0, 0), (0, 2), (1, 0), (1, 1), (2, 1), (2, 2)],
        FacetShape::Quadrilateral4 => &[(0, 0), (1, 1), (2, 2), (3, 3)],
        FacetShape::Quadrilateral8 => {
            &[(0, 0), (1, 1), (2, 2), (3, 3), (4, 0), (4, 1), (5, 1), (5, 2), (6, 2), (6, 3), (7, 3), (7, 0)]
        }
    }
}

/// The triangles between a facet's nodes.
const fn triangles(shape: FacetShape) -> &'static [[usize; 3]] {
    match shape {
        FacetShape::Triangle3 => &[[0, 1, 2]],
        FacetShape::Triangle6 => &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
        FacetShape::Quadrilateral4 => &[[0, 1, 2], [0, 2, 3]],
        FacetShape::Quadrilateral8 => &[[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]],
    }
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

    /// Adds the values of a point next to a node; the status is the greatest.
    fn add(&mut self, node: usize, (pressure, traction, status): Values) {
        self.pressure[node] += pressure;
        (0..3).for_each(|i| self.traction[node][i] += traction[i]);
        self.status[node] = self.status[node].max(status);
    }

    fn divide(&mut self, node: usize, n: f64) {
        self.pressure[node] /= n;
        self.traction[node] = self.traction[node].map(|t| t / n);
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
            let of_places = |(point, response)| {
                let values = at(point, response);
                point.places.iter().map(move |&place| (place, values))
            };
            let values: HashMap<Place, Values> = own.flat_map(of_places).collect();
            surface.add(&mesh.surfaces[&pair.slave].facets, number as i32, &values);
        }
        surface
    }

    fn add(&mut self, facets: &[Facet], pair: i32, values: &HashMap<Place, Values>) {
        let mut local: HashMap<u32, u32> = HashMap::new();
        let mut count = vec![0.0; self.nodes.len()];
        for (index, facet) in facets.iter().enumerate() {
            let own = facet.renumbered(|n| {
                *local.entry(n).or_insert_with(|| {
                    self.nodes.push(n);
                    self.fields.push(0.0, [0.0; 3], -1);
                    count.push(0.0);
                    self.nodes.len() as u32 - 1
                })
            });
            let places = places(index, facet);
            for &(node, point) in next_to(facet.shape()) {
                let values = values.get(&places[point]).copied().unwrap_or(NOTHING);
                let node = own.nodes()[node] as usize;
                count[node] += 1.0;
                self.fields.add(node, values);
            }
            self.facets.push(own);
            self.pairs.push(pair);
        }
        for (node, &n) in count.iter().enumerate().filter(|(_, n)| **n > 0.0) {
            self.fields.divide(node, n);
        }
    }

    /// The surfaces as results keep them, each facet in triangles between its nodes.
    pub fn faces(&self, mesh: &Mesh) -> ContactFaces {
        let mut pair_of_node = vec![0; self.nodes.len()];
        for (facet, &pair) in self.facets.iter().zip(&self.pairs) {
            facet.nodes().iter().for_each(|&node| pair_of_node[node as usize] = pair);
        }
        let of_facet = |facet: &Facet| {
            let nodes = facet.nodes().to_vec();
            triangles(facet.shape()).iter().map(move |triangle| triangle.map(|i| nodes[i]))
        };
        let pair_of_facet = |(facet, &pair): (&Facet, &i32)| vec![pair; triangles(facet.shape()).len()];
        ContactFaces {
            nodes: self.nodes.iter().map(|&n| mesh.nodes[n as usize]).collect(),
            triangles: self.facets.iter().flat_map(of_facet).collect(),
            pair: self.facets.iter().zip(&self.pairs).flat_map(pair_of_facet).collect(),
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
fn at(point: &ContactPoint, response: &Response) -> Values {
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
        let values = [(13, (2.0, [1.0, 0.0, 0.0], 1)), (14, (4.0, [0.0; 3], 2)), (15, (6.0, [0.0; 3], 0))];
        let values: HashMap<Place, Values> = values.into_iter().map(|(n, v)| (Place::Node(n), v)).collect();
        surface.add(&[[10, 11, 12, 13, 14, 15].into()], 7, &values);
        assert_eq!(surface.nodes, [10, 11, 12, 13, 14, 15]);
        assert_eq!(surface.fields.pressure, [4.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
        assert_eq!(surface.fields.status, [1, 2, 2, 1, 2, 0]);
        let all = surface.on_mesh(20);
        assert_eq!((all.pressure[14], all.status[14], all.status[0]), (4.0, 2, -1));
    }

    #[test]
    fn nodes_of_quadrilaterals_take_the_mean_of_the_points_next_to_them() {
        let mut surface = ContactSurface::default();
        let place = |facet, point| Place::Inside { facet, point };
        let values = [1.0, 2.0, 3.0, 4.0].map(|p| (p, [0.0; 3], 1));
        let values: HashMap<Place, Values> = (0..4).map(|k| (place(0, k), values[usize::from(k)])).collect();
        surface.add(&[[0, 1, 2, 3, 4, 5, 6, 7].into(), [1, 8, 9, 2].into()], 0, &values);
        assert_eq!(surface.fields.pressure[..8], [1.0, 1.0, 1.5, 4.0, 1.5, 2.5, 3.5, 2.5]);
        assert_eq!((surface.fields.pressure[8], surface.fields.status[8]), (0.0, -1));
    }
}
