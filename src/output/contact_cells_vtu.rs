//! The cells of reference nodes, drawn on the slave surfaces.
//!
//! A contact point stands for a third of each facet around it: the triangle of the facet's edge and centre. So the
//! triangles of a cell have exactly its area (on plane facets).

use std::collections::HashMap;

use crate::contact::Interface;
use crate::contact::interface::ContactPair;
use crate::element::tri6::{self, EDGES};
use crate::mesh::Mesh;

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
        let cell_of: HashMap<u32, usize> =
            own.flat_map(|(a, point)| point.nodes.iter().map(move |&n| (n, a))).collect();
        for facet in &mesh.surfaces[&pair.slave].facets {
            let x = facet.map(|n| mesh.nodes[n as usize]);
            let n = tri6::shape([1.0 / 3.0; 2]);
            let first = self.points.len() as u32;
            self.points.extend_from_slice(&x[..3]);
            self.points.push([0, 1, 2].map(|i| (0..6).map(|j| n[j] * x[j][i]).sum()));
            for (k, [a, b]) in EDGES.into_iter().enumerate() {
                let cell = cell_of.get(&facet[3 + k]);
                self.triangles.push([first + a as u32, first + b as u32, first + 3]);
                self.cell.push(cell.map_or(-1, |&a| a as i32));
                self.area.push(cell.map_or(0.0, |&a| 1e6 * interface.points[a].law.weight));
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
