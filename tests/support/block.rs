//! Blocks of 10-node tetrahedra, or of any other kind of element.

use std::collections::BTreeMap;

use squeal::element::{ElementKind, Shape, solid};
use squeal::mesh::{Mesh, Surface};

/// A block of `cells` cells of six tetrahedra each (Kuhn's), the unit cube mapped by `map`.
///
/// ```text
///      z1   y1           all six tetrahedra of a cell share its diagonal 000-111, and neighbours agree on their face;
///       |  /             midside nodes are mapped as well, so edges follow curved maps;
///       | /              `wraps` closes the block along y: the nodes of y1 are those of y0.
///       |/____ x1
/// ```
pub struct Block<'a> {
    pub part: &'a str,
    pub cells: [usize; 3],
    pub wraps: bool,
    pub map: &'a dyn Fn([f64; 3]) -> [f64; 3],
}

/// Adds a block of `cells` from `corner` on, in millimetres.
pub fn add_block(mesh: &mut Mesh, part: &str, cells: [usize; 3], corner: [f64; 3], size: [f64; 3]) {
    let map = |s: [f64; 3]| [0, 1, 2].map(|i| 1e-3 * (corner[i] + size[i] * s[i]));
    Block { part, cells, wraps: false, map: &map }.add_to(mesh);
}

impl Block<'_> {
    /// Adds the block as a part, and its sides as surfaces `<part>_x0`, `<part>_x1`, `<part>_y0`, ...
    pub fn add_to(&self, mesh: &mut Mesh) {
        let first = mesh.nodes.len() as u32;
        let part = mesh.parts.len() as u32;
        mesh.parts.push(self.part.into());
        let n = self.n_points();
        for k in 0..n[2] {
            for j in 0..n[1] {
                for i in 0..n[0] {
                    let at = [i, j, k];
                    mesh.nodes.push((self.map)([0, 1, 2].map(|a| at[a] as f64 / (2 * self.cells[a]) as f64)));
                }
            }
        }
        let node = |at: [usize; 3]| {
            let [i, j, k] = [0, 1, 2].map(|a| at[a] % n[a]);
            first + (i + n[0] * (j + n[1] * k)) as u32
        };
        let mut sides: BTreeMap<String, Surface> = BTreeMap::new();
        for lattice in self.tets() {
            let tet = lattice.map(node);
            let index = mesh.elements.len();
            mesh.elements.push(ElementKind::C3D10, part, &tet);
            let inverted = solid::is_inverted(Shape::Tetrahedron10, &mesh.element_nodes(index));
            assert!(!inverted, "{}: the map turns the block inside out", self.part);
            for face in Shape::Tetrahedron10.faces() {
                let places: Vec<[usize; 3]> = face.iter().map(|&a| lattice[a]).collect();
                if let Some(side) = self.side(&places) {
                    let surface = sides.entry(format!("{}_{side}", self.part)).or_default();
                    surface.facets.push(face.iter().map(|&a| tet[a]).collect());
                    surface.parts.push(part);
                }
            }
        }
        mesh.surfaces.append(&mut sides);
    }

    /// As [`Block::add_to`] with elements of any kind: each cell is one hexahedron, two wedges or six tetrahedra.
    pub fn add_solids_to(&self, mesh: &mut Mesh, kind: ElementKind) {
        let (part, shape, n) = (mesh.parts.len() as u32, kind.shape(), self.n_points());
        mesh.parts.push(self.part.into());
        let mut numbers: BTreeMap<[usize; 3], u32> = BTreeMap::new();
        let mut sides: BTreeMap<String, Surface> = BTreeMap::new();
        for lattice in self.solids(shape) {
            let mut number = |at: [usize; 3]| {
                *numbers.entry([0, 1, 2].map(|a| at[a] % n[a])).or_insert_with(|| {
                    mesh.nodes.push((self.map)([0, 1, 2].map(|a| at[a] as f64 / (2 * self.cells[a]) as f64)));
                    mesh.nodes.len() as u32 - 1
                })
            };
            let nodes: Vec<u32> = lattice.iter().map(|&at| number(at)).collect();
            mesh.elements.push(kind, part, &nodes);
            let inverted = solid::is_inverted(shape, &mesh.element_nodes(mesh.elements.len() - 1));
            assert!(!inverted, "{}: the map turns the block inside out", self.part);
            for face in shape.faces() {
                let places: Vec<[usize; 3]> = face.iter().map(|&a| lattice[a]).collect();
                if let Some(side) = self.side(&places) {
                    let surface = sides.entry(format!("{}_{side}", self.part)).or_default();
                    surface.facets.push(face.iter().map(|&a| nodes[a]).collect());
                    surface.parts.push(part);
                }
            }
        }
        mesh.surfaces.append(&mut sides);
    }

    /// Each element's places on the lattice.
    fn solids(&self, shape: Shape) -> Vec<Vec<[usize; 3]>> {
        let [nx, ny, nz] = self.cells;
        let cells = (0..nx * ny * nz).map(|c| [c % nx, c / nx % ny, c / (nx * ny)]);
        let of_cell = |cell: [usize; 3]| {
            cuts(shape).iter().map(move |corners| {
                let corner = |bits: usize| [0, 1, 2].map(|i| (2 * (cell[i] + (bits >> i & 1))) as f64);
                let corners: Vec<[f64; 3]> = corners.iter().map(|&bits| corner(bits)).collect();
                shape.straight(&corners).into_iter().map(|x| x.map(|x| x as usize)).collect()
            })
        };
        cells.flat_map(of_cell).collect()
    }

    /// Points of the lattice of corners and midsides along each axis.
    fn n_points(&self) -> [usize; 3] {
        let [x, y, z] = self.cells.map(|n| 2 * n + 1);
        [x, if self.wraps { y - 1 } else { y }, z]
    }

    /// Each tetrahedron's ten places on the lattice.
    fn tets(&self) -> impl Iterator<Item = [[usize; 3]; 10]> {
        let [nx, ny, nz] = self.cells;
        let cells = (0..nx * ny * nz).map(move |c| [c % nx, c / nx % ny, c / (nx * ny)]);
        cells.flat_map(|cell| PATHS.map(|path| tet_of(cell, path)))
    }

    /// The side on which all places lie.
    fn side(&self, face: &[[usize; 3]]) -> Option<String> {
        let all = |axis: usize, value: usize| face.iter().all(|at| at[axis] == value);
        let axes = (0..3).filter(|&axis| !(self.wraps && axis == 1));
        axes.flat_map(|axis| [(axis, 0, 0), (axis, 1, 2 * self.cells[axis])])
            .find(|&(axis, _, value)| all(axis, value))
            .map(|(axis, end, _)| format!("{}{end}", ["x", "y", "z"][axis]))
    }
}

/// Corners of the elements that a cell is cut into; the bits of a corner are x, y, z.
fn cuts(shape: Shape) -> &'static [&'static [usize]] {
    match shape.n_corners() {
        4 => &[&[0, 1, 3, 7], &[0, 3, 2, 7], &[0, 2, 6, 7], &[0, 6, 4, 7], &[0, 4, 5, 7], &[0, 5, 1, 7]],
        6 => &[&[0, 1, 3, 4, 5, 7], &[0, 3, 2, 4, 7, 6]],
        _ => &[&[0, 1, 3, 2, 4, 5, 7, 6]],
    }
}

/// Orders in which a path from 000 to 111 takes the axes; the even ones first.
const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

fn tet_of(cell: [usize; 3], path: [usize; 3]) -> [[usize; 3]; 10] {
    let mut corners = [cell.map(|c| 2 * c); 4];
    for (step, &axis) in path.iter().enumerate() {
        corners[step + 1..].iter_mut().for_each(|corner| corner[axis] += 2);
    }
    if PATHS[3..].contains(&path) {
        corners.swap(1, 2);
    }
    let [a, b, c, d] = corners;
    let middle = |p: [usize; 3], q: [usize; 3]| [0, 1, 2].map(|i| (p[i] + q[i]) / 2);
    [a, b, c, d, middle(a, b), middle(b, c), middle(c, a), middle(a, d), middle(b, d), middle(c, d)]
}
