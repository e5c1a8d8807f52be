//! A pad on a disc, both blocks, as a Gmsh file of a few hundred nodes.
//!
//! ```text
//!            pad_top                z
//!       +------------+              |_ x     the disc turns about an axis along z far away,
//!       |    pad     |                       so that it slides along y below the pad
//!       +-pad_bottom-+
//!   +-----disc_top-------+
//!   |        disc        |
//!   +----disc_bottom-----+
//! ```

use std::fmt::Write;

/// Millimetres, newtons through SI units.
pub const MODEL: &str = r#"title = "blocks"
[mesh]
file = "blocks.msh"
unit = "mm"
[material.iron]
young = 110e9
poisson = 0.27
density = 7100
[part.disc]
material = "iron"
[part.pad]
material = "iron"
[[fix]]
nodes = "disc_bottom"
axes = "xyz"
[[fix]]
nodes = "pad_top"
axes = "xy"
[[rotation]]
part = "disc"
axis = [0, 0, 1]
through = [-100, 10, 0]
speed = 5.0
[[contact]]
name = "disc / pad"
slave = "pad_bottom"
master = "disc_top"
law = { linear = 2e13 }
friction = 0.4
[[load]]
name = "piston"
on = "pad_top"
force = [0, 0, -1000]
[stability]
band = [0, 20000]
"#;

/// The mesh's variants.
pub struct Pair {
    /// Distance between pad and disc, mm.
    pub gap: f64,
    /// 10-node tetrahedra, or 4-node ones.
    pub quadratic: bool,
    /// Whether one node of the pad is pulled inside out.
    pub inverted: bool,
    /// Cells of the pad along an edge of its face.
    pub pad_cells: usize,
}

impl Default for Pair {
    fn default() -> Pair {
        Pair { gap: 0.0, quadratic: true, inverted: false, pad_cells: 2 }
    }
}

impl Pair {
    /// The file.
    pub fn gmsh(&self) -> String {
        let disc = Block { cells: [3, 3, 1], corner: [0.0; 3], size: [30.0, 30.0, 10.0] };
        let pad = Block {
            cells: [self.pad_cells, self.pad_cells, 1],
            corner: [5.0, 5.0, 10.0 + self.gap],
            size: [20.0, 20.0, 10.0],
        };
        let mut nodes: Vec<[f64; 3]> = disc.nodes();
        let first = nodes.len();
        nodes.extend(pad.nodes());
        if self.inverted {
            nodes[first][2] += 100.0;
        }
        let mut out = HEADER.to_owned();
        writeln!(out, "$Nodes\n1 {0} 1 {0}\n3 1 0 {0}", nodes.len()).unwrap();
        (1..=nodes.len()).for_each(|tag| writeln!(out, "{tag}").unwrap());
        nodes.iter().for_each(|[x, y, z]| writeln!(out, "{x} {y} {z}").unwrap());
        out += "$EndNodes\n";
        self.elements(&mut out, &[(&disc, 1), (&pad, first + 1)]);
        out
    }

    fn elements(&self, out: &mut String, blocks: &[(&Block, usize)]) {
        let (tet, triangle, tet_kind, triangle_kind) = if self.quadratic { (10, 6, 11, 9) } else { (4, 3, 4, 2) };
        let mut groups: Vec<(i32, i32, i32, Vec<Vec<usize>>)> = Vec::new();
        for (i, (block, first)) in blocks.iter().enumerate() {
            let tets = block.tets(*first);
            let tag = i as i32 + 1;
            for (top, name) in [(false, 0), (true, 1)] {
                let facets = block.facets(top, *first).into_iter().map(|f| f[..triangle].to_vec()).collect();
                groups.push((2, 2 * tag - 1 + name, triangle_kind, facets));
            }
            groups.push((3, tag, tet_kind, tets.into_iter().map(|t| t[..tet].to_vec()).collect()));
        }
        let total: usize = groups.iter().map(|group| group.3.len()).sum();
        writeln!(out, "$Elements\n{} {total} 1 {total}", groups.len()).unwrap();
        let mut element = 0;
        for (dimension, entity, kind, elements) in groups {
            writeln!(out, "{dimension} {entity} {kind} {}", elements.len()).unwrap();
            for nodes in elements {
                element += 1;
                let nodes: Vec<String> = nodes.iter().map(ToString::to_string).collect();
                writeln!(out, "{element} {}", nodes.join(" ")).unwrap();
            }
        }
        *out += "$EndElements\n";
    }
}

/// Surface 1, 2: bottom and top of the disc; 3, 4: of the pad. Volume 1: disc; 2: pad.
const HEADER: &str = r#"$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
6
2 1 "disc_bottom"
2 2 "disc_top"
2 3 "pad_bottom"
2 4 "pad_top"
3 1 "disc"
3 2 "pad"
$EndPhysicalNames
$Entities
0 0 4 2
1 0 0 0 0 0 0 1 1 0
2 0 0 0 0 0 0 1 2 0
3 0 0 0 0 0 0 1 3 0
4 0 0 0 0 0 0 1 4 0
1 0 0 0 0 0 0 1 1 0
2 0 0 0 0 0 0 1 2 0
$EndEntities
"#;

/// A block of cells of six tetrahedra each (Kuhn's), which all share the cell's diagonal.
struct Block {
    cells: [usize; 3],
    corner: [f64; 3],
    size: [f64; 3],
}

type Lattice = [usize; 3];

impl Block {
    fn n(&self) -> Lattice {
        self.cells.map(|n| 2 * n + 1)
    }

    fn nodes(&self) -> Vec<[f64; 3]> {
        let [nx, ny, nz] = self.n();
        let at = |a: usize, i: usize| self.corner[a] + self.size[a] * i as f64 / (2 * self.cells[a]) as f64;
        (0..nx * ny * nz).map(|n| [at(0, n % nx), at(1, n / nx % ny), at(2, n / (nx * ny))]).collect()
    }

    fn tag(&self, [i, j, k]: Lattice, first: usize) -> usize {
        let [nx, ny, _] = self.n();
        first + i + nx * (j + ny * k)
    }

    fn cells(&self) -> impl Iterator<Item = Lattice> {
        let [nx, ny, nz] = self.cells;
        (0..nx * ny * nz).map(move |n| [n % nx, n / nx % ny, n / (nx * ny)].map(|i| 2 * i))
    }

    /// Gmsh's order: corners, then midsides of 01 12 20 03 23 13.
    fn tets(&self, first: usize) -> Vec<[usize; 10]> {
        const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
        const EDGES: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 0), (0, 3), (2, 3), (1, 3)];
        let mut tets = Vec::new();
        for cell in self.cells() {
            for (p, path) in PATHS.iter().enumerate() {
                let mut corners = [cell; 4];
                for (i, &axis) in path.iter().enumerate() {
                    corners[i + 1] = corners[i];
                    corners[i + 1][axis] += 2;
                }
                if p >= 3 {
                    corners.swap(1, 2); // odd paths are left-handed
                }
                let mut nodes = corners.to_vec();
                nodes.extend(EDGES.map(|(a, b)| middle(corners[a], corners[b])));
                tets.push(std::array::from_fn(|i| self.tag(nodes[i], first)));
            }
        }
        tets
    }

    /// The two triangles of each cell at the bottom or top: corners, then midsides of 01 12 20.
    fn facets(&self, top: bool, first: usize) -> Vec<[usize; 6]> {
        let z = if top { 2 * self.cells[2] } else { 0 };
        let mut facets = Vec::new();
        for [i, j, _] in self.cells().filter(|cell| cell[2] == 0) {
            let (a, b, c, d) = ([i, j, z], [i + 2, j, z], [i + 2, j + 2, z], [i, j + 2, z]);
            for [a, b, c] in [[a, b, c], [a, c, d]] {
                let nodes = [a, b, c, middle(a, b), middle(b, c), middle(c, a)];
                facets.push(nodes.map(|node| self.tag(node, first)));
            }
        }
        facets
    }
}

fn middle(a: Lattice, b: Lattice) -> Lattice {
    [0, 1, 2].map(|i| (a[i] + b[i]) / 2)
}
