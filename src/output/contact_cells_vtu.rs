//! The cells of reference nodes, drawn on the slave surfaces.
//!
//! A contact point at a midside stands for the triangle of its edge and the facet's centre, any other for the
//! quadrilateral between its corner, the middles of the two edges there, and the centre. So the triangles of a cell
//! have exactly its area on plane 6-node and 3-node facets and on parallelograms.

use std::collections::HashMap;

use crate::contact::Interface;
use crate::contact::interface::ContactPair;
use crate::contact::surface_points::{Place, places};
use crate::element::FacetShape;
use crate::mesh::{Facet, Mesh};

use super::vtu::{Cells, Grid, Values};

/// A tiling of the sliding pairs' slave surfaces by contact points.
#[derive(Default)]
pub struct ContactCells {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// Reference node of each triangle, from 0, pair by pair; -1 where the point was dropped.
    cell: Vec<i32>,
    /// Area of its cell, mm2.
    area: Vec<f64>,
}

impl ContactCells {
    /// Tiles the surfaces.
    pub fn new(mesh: &Mesh, interface: &Interface) -> ContactCells {
        let mut picture = ContactCells::default();
        interface.pairs.iter().filter(|pair| pair.is_sliding()).for_each(|pair| picture.add(mesh, interface, pair));
        picture
    }

    fn add(&mut self, mesh: &Mesh, interface: &Interface, pair: &ContactPair) {
        let own = pair.points.clone().map(|a| (a, &interface.points[a]));
        let cell_of: HashMap<Place, usize> =
            own.flat_map(|(a, point)| point.places.iter().map(move |&place| (place, a))).collect();
        for (index, facet) in mesh.surfaces[&pair.slave].facets.iter().enumerate() {
            let first = self.points.len() as u32;
            self.points.extend(outline(mesh, facet));
            for (k, place) in places(index, facet).into_iter().enumerate() {
                let cell = cell_of.get(&place);
                for triangle in share(facet.shape(), k as u32) {
                    self.triangles.push(triangle.map(|n| first + n));
                    self.cell.push(cell.map_or(-1, |&a| a as i32));
                    self.area.push(cell.map_or(0.0, |&a| 1e6 * interface.points[a].law.weight));
                }
            }
        }
    }

    /// As a grid to be written.
    pub fn grid(&self) -> Grid<'_> {
        Grid {
            points: &self.points,
            cells: Cells::Patches(&self.triangles),
            point_data: vec![],
            cell_data: vec![("cell", Values::Integers(&self.cell)), ("area_mm2", Values::Scalars(&self.area))],
        }
    }
}

/// A facet's corners, its centre, and the middles of its edges where these bound shares.
fn outline(mesh: &Mesh, facet: &Facet) -> Vec<[f64; 3]> {
    let (shape, x) = (facet.shape(), facet.positions(&mesh.nodes));
    let interpolation = shape.interpolation();
    let at = |at: [f64; 2]| {
        let n = interpolation.shape(at);
        [0, 1, 2].map(|i| x.iter().zip(n).map(|(x, n)| n * x[i]).sum())
    };
    let nodes = interpolation.nodes();
    let middle = |[a, b]: [usize; 2]| at([0, 1].map(|i| 0.5 * (nodes[a][i] + nodes[b][i])));
    let centre = at(if shape.is_triangle() { [1.0 / 3.0; 2] } else { [0.0; 2] });
    let mut points = x[..shape.n_corners()].to_vec();
    points.push(centre);
    if shape != FacetShape::Triangle6 {
        points.extend(shape.edges().map(middle));
    }
    points
}

/// The triangles of contact point `k`'s share of a facet, between the points of its [`outline`].
fn share(shape: FacetShape, k: u32) -> Vec<[u32; 3]> {
    let n = shape.n_corners() as u32;
    if shape == FacetShape::Triangle6 {
        return vec![[k, (k + 1) % n, n]];
    }
    let (after, before) = (n + 1 + k, n + 1 + (k + n - 1) % n);
    vec![[k, after, n], [k, n, before]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_tile_each_facet() {
        let x = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh { nodes: x.to_vec(), ..Mesh::default() };
        for facet in [Facet::from([0, 1, 2]), Facet::from([0, 1, 2, 3])] {
            let (points, shape) = (outline(&mesh, &facet), facet.shape());
            let area = |[a, b, c]: [u32; 3]| {
                let [a, b, c] = [a, b, c].map(|n| points[n as usize]);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            };
            for k in 0..shape.n_corners() as u32 {
                let own: f64 = share(shape, k).into_iter().map(area).sum();
                assert!(
                    (own - if shape.is_triangle() { 1.0 / 3.0 } else { 0.5 }).abs() < 1e-15,
                    "{shape:?} {k}: {own}"
                );
            }
        }
    }
}
