//! A picture of a model before anything is computed: parts, contact surfaces, ties, constrained nodes, loads and axes.
//!
//! One grid has all of it. The cells' array `kind` says what a cell shows, see [`CellKind`].

use std::collections::BTreeMap;

use crate::algebra::{dot, norm, scale, sub};
use crate::assembly::{Boundary, DofMap};
use crate::element::facet::area_normal;
use crate::mesh::{Facet, Mesh};
use crate::model::Rotation;
use crate::native::Comm;
use crate::structure::FullModel;

use super::vtu::{Cells, Grid, Values};

/// What a cell shows: its number in the array `kind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellKind {
    /// A triangle of the outer surface of a part; `part` is the part's place in the mesh, from 0.
    Part = 0,
    /// A facet of the slave of a contact pair; `pair` is the pair's place in the model, from 0.
    Slave = 1,
    /// A facet of its master.
    Master = 2,
    /// A facet of a tied surface.
    Tie = 3,
    /// A constrained node.
    Constrained = 4,
    /// A loaded node.
    Load = 5,
    /// The axis of a rotation, `normal` along it in the sense of a right-handed rotation.
    Axis = 6,
}

/// What a cell belongs to.
struct Cell {
    kind: CellKind,
    part: i32,
    pair: i32,
}

impl Cell {
    /// Of no part and no pair.
    fn of(kind: CellKind) -> Cell {
        Cell { kind, part: -1, pair: -1 }
    }
}

/// The axis is longer than the part that turns by this fraction, at each end.
const AXIS_MARGIN: f64 = 0.25;

/// A picture of a model.
#[derive(Default)]
pub struct ModelPicture {
    points: Vec<[f64; 3]>,
    cells: Vec<Vec<u32>>,
    kind: Vec<i32>,
    part: Vec<i32>,
    pair: Vec<i32>,
    /// Unit vector out of the body, or along an axis; zero where there is none.
    normal: Vec<[f64; 3]>,
    /// By point: force of the loads, N.
    force: Vec<[f64; 3]>,
    /// By point: 1 where x is constrained, plus 2 where y is, plus 4 where z is.
    constrained: Vec<i32>,
}

impl ModelPicture {
    /// Draws a model. Collective; the root has the whole picture.
    pub fn new(comm: &Comm, full: &FullModel) -> ModelPicture {
        let boundary = Boundary::new(comm, &full.mesh, &full.nodes, &DofMap::new(&full.nodes, &full.held));
        let (mesh, mut picture) = (&full.mesh, ModelPicture::default());
        picture.add_parts(&boundary);
        for (pair, contact) in (0..).zip(&full.model.contacts) {
            picture.add_surface(mesh, &contact.slave, CellKind::Slave, pair);
            picture.add_surface(mesh, &contact.master, CellKind::Master, pair);
        }
        for tie in &full.model.ties {
            [&tie.slave, &tie.master].into_iter().for_each(|name| picture.add_surface(mesh, name, CellKind::Tie, -1));
        }
        picture.add_constrained(mesh, &full.held);
        picture.add_loads(mesh, &full.loads);
        full.model.rotations.iter().for_each(|rotation| picture.add_axis(mesh, &boundary, rotation));
        picture
    }

    fn add_point(&mut self, position: [f64; 3]) -> u32 {
        self.points.push(position);
        self.force.push([0.0; 3]);
        self.constrained.push(0);
        self.points.len() as u32 - 1
    }

    fn add_cell(&mut self, cell: Cell, nodes: Vec<u32>, normal: [f64; 3]) {
        self.cells.push(nodes);
        self.kind.push(cell.kind as i32);
        self.part.push(cell.part);
        self.pair.push(cell.pair);
        self.normal.push(normal);
    }

    fn add_parts(&mut self, boundary: &Boundary) {
        let first = self.points.len() as u32;
        for &x in &boundary.nodes {
            self.add_point(x);
        }
        for (triangle, part) in boundary.triangles.iter().zip(&boundary.part) {
            let corners = triangle.map(|n| boundary.nodes[n as usize]);
            let cell = Cell { part: *part, ..Cell::of(CellKind::Part) };
            self.add_cell(cell, triangle.map(|n| first + n).to_vec(), unit_normal(&corners));
        }
    }

    /// The facets of a surface.
    fn add_surface(&mut self, mesh: &Mesh, name: &str, kind: CellKind, pair: i32) {
        let mut places: BTreeMap<u32, u32> = BTreeMap::new();
        for facet in &mesh.surfaces[name].facets {
            let place = |&n: &u32| *places.entry(n).or_insert_with(|| self.add_point(mesh.nodes[n as usize]));
            let nodes = facet.nodes().iter().map(place).collect();
            self.add_cell(Cell { pair, ..Cell::of(kind) }, nodes, unit_normal(&corners(mesh, facet)));
        }
    }

    fn add_constrained(&mut self, mesh: &Mesh, held: &[[bool; 3]]) {
        for (x, axes) in mesh.nodes.iter().zip(held).filter(|(_, axes)| **axes != [false; 3]) {
            let point = self.add_point(*x);
            self.constrained[point as usize] =
                axes.iter().zip([1, 2, 4]).map(|(&held, bit)| i32::from(held) * bit).sum();
            self.add_cell(Cell::of(CellKind::Constrained), vec![point], [0.0; 3]);
        }
    }

    /// The sum of all loads at each node.
    fn add_loads(&mut self, mesh: &Mesh, loads: &[(u32, [f64; 3])]) {
        let mut sums: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
        for (node, force) in loads {
            let sum = sums.entry(*node).or_default();
            *sum = [0, 1, 2].map(|i| sum[i] + force[i]);
        }
        for (node, force) in sums {
            let point = self.add_point(mesh.nodes[node as usize]);
            self.force[point as usize] = force;
            self.add_cell(Cell::of(CellKind::Load), vec![point], [0.0; 3]);
        }
    }

    /// A line along the axis, through the part that turns.
    fn add_axis(&mut self, mesh: &Mesh, boundary: &Boundary, rotation: &Rotation) {
        let is_own = |part: &i32| mesh.parts[*part as usize] == rotation.part;
        let own = boundary.triangles.iter().zip(&boundary.part).filter(|(_, part)| is_own(part));
        let nodes = own.flat_map(|(triangle, _)| triangle.map(|n| boundary.nodes[n as usize]));
        let (mut low, mut high, mut radius) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for arm in nodes.map(|x| sub(x, rotation.through)) {
            let along = dot(arm, rotation.axis);
            (low, high) = (low.min(along), high.max(along));
            radius = radius.max(norm(sub(arm, scale(along, rotation.axis))));
        }
        let ends = [low - AXIS_MARGIN * radius, high + AXIS_MARGIN * radius];
        let at = |along: f64| [0, 1, 2].map(|i| rotation.through[i] + along * rotation.axis[i]);
        let nodes = ends.map(|along| self.add_point(at(along))).to_vec();
        self.add_cell(Cell::of(CellKind::Axis), nodes, scale(rotation.speed.signum(), rotation.axis));
    }

    /// As a grid to be written.
    pub fn grid(&self) -> Grid<'_> {
        Grid {
            points: &self.points,
            cells: Cells::Lists(&self.cells),
            point_data: vec![
                ("force_n", Values::Vectors(&self.force)),
                ("constrained", Values::Integers(&self.constrained)),
            ],
            cell_data: vec![
                ("kind", Values::Integers(&self.kind)),
                ("part", Values::Integers(&self.part)),
                ("pair", Values::Integers(&self.pair)),
                ("normal", Values::Vectors(&self.normal)),
            ],
        }
    }
}

/// Positions of a facet's corners, m.
fn corners(mesh: &Mesh, facet: &Facet) -> Vec<[f64; 3]> {
    facet.corners().iter().map(|&n| mesh.nodes[n as usize]).collect()
}

/// The unit normal at the middle of a plane facet, from its corners.
fn unit_normal(corners: &[[f64; 3]]) -> [f64; 3] {
    let normal = area_normal(corners, if corners.len() == 3 { [1.0 / 3.0; 2] } else { [0.0; 2] });
    scale(1.0 / norm(normal), normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Inertia, Place};

    fn square() -> Mesh {
        let x = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 1.0, 1.0], [0.0, 1.0, 1.0]];
        let surface = crate::mesh::Surface { facets: vec![Facet::from([0, 1, 2, 3])], parts: vec![0], inner: vec![] };
        let surfaces = [("face".to_owned(), surface)].into();
        Mesh { nodes: x.to_vec(), parts: vec!["disc".into()], surfaces, ..Mesh::default() }
    }

    #[test]
    fn surfaces_have_their_pair_and_their_outward_normal() {
        let mut picture = ModelPicture::default();
        picture.add_surface(&square(), "face", CellKind::Master, 3);
        assert_eq!((&picture.kind[..], &picture.pair[..], &picture.part[..]), (&[2][..], &[3][..], &[-1][..]));
        assert_eq!((picture.normal[0], picture.cells[0].len(), picture.points.len()), ([0.0, 0.0, 1.0], 4, 4));
    }

    #[test]
    fn forces_on_a_node_are_added_and_constrained_axes_are_bits() {
        let (mesh, mut picture) = (square(), ModelPicture::default());
        picture.add_loads(&mesh, &[(2, [1.0, 0.0, 0.0]), (2, [0.0, 2.0, 0.0])]);
        picture.add_constrained(&mesh, &[[false; 3], [true, false, true], [false; 3], [true; 3]]);
        assert_eq!(picture.force, [[1.0, 2.0, 0.0], [0.0; 3], [0.0; 3]]);
        assert_eq!((&picture.constrained[..], &picture.kind[..]), (&[0, 5, 7][..], &[5, 4, 4][..]));
        assert_eq!(picture.points, [mesh.nodes[2], mesh.nodes[1], mesh.nodes[3]]);
    }

    #[test]
    fn an_axis_passes_through_the_part_in_the_sense_of_its_rotation() {
        let mesh = square();
        let mut boundary = Boundary::default();
        (boundary.nodes, boundary.triangles) = (mesh.nodes.clone(), vec![[0, 1, 2], [0, 2, 3]]);
        boundary.part = vec![0; 2];
        let (axis, through) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        let rotation = Rotation {
            part: "disc".into(),
            axis,
            through,
            speed: -5.0,
            inertia: Inertia::None,
            place: Place::default(),
        };
        let mut picture = ModelPicture::default();
        picture.add_axis(&mesh, &boundary, &rotation);
        // The part is 2 m long, and 1 m away from the axis at most.
        assert_eq!(picture.points, [[-0.25, 0.0, 1.0], [2.25, 0.0, 1.0]]);
        assert_eq!((picture.normal[0], picture.kind[0]), ([-1.0, 0.0, 0.0], 6));
    }
}
