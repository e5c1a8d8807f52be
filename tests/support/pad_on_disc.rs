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

use squeal::mesh::Mesh;

use super::block::Block;

/// Its model file. Millimetres; newtons through SI units.
pub const MODEL: &str = include_str!("../data/pad_on_disc.toml");

/// The mesh's variants.
pub struct PadOnDisc {
    /// Distance between pad and disc, mm.
    pub gap: f64,
    /// 10-node tetrahedra, or 4-node ones.
    pub quadratic: bool,
    /// Whether one node of the pad is pulled inside out.
    pub inverted: bool,
    /// Cells of the pad along an edge of its face.
    pub pad_cells: usize,
}

impl Default for PadOnDisc {
    fn default() -> PadOnDisc {
        PadOnDisc { gap: 0.0, quadratic: true, inverted: false, pad_cells: 2 }
    }
}

impl PadOnDisc {
    /// The file.
    pub fn gmsh(&self) -> String {
        let mut mesh = Mesh::default();
        let disc = |[x, y, z]: [f64; 3]| [30.0 * x, 30.0 * y, 10.0 * z];
        Block { part: "disc", cells: [3, 3, 1], wraps: false, map: &disc }.add_to(&mut mesh);
        let first = mesh.nodes.len();
        let pad = |[x, y, z]: [f64; 3]| [5.0 + 20.0 * x, 5.0 + 20.0 * y, 10.0 + self.gap + 10.0 * z];
        let cells = [self.pad_cells, self.pad_cells, 1];
        Block { part: "pad", cells, wraps: false, map: &pad }.add_to(&mut mesh);
        if self.inverted {
            mesh.nodes[first][2] += 100.0;
        }
        let mut out = HEADER.to_owned();
        let n = mesh.nodes.len();
        writeln!(out, "$Nodes\n1 {n} 1 {n}\n3 1 0 {n}").unwrap();
        (1..=n).for_each(|tag| writeln!(out, "{tag}").unwrap());
        mesh.nodes.iter().for_each(|[x, y, z]| writeln!(out, "{x} {y} {z}").unwrap());
        out += "$EndNodes\n";
        self.elements(&mut out, &mesh);
        out
    }

    fn elements(&self, out: &mut String, mesh: &Mesh) {
        let (tet, triangle, tet_kind, triangle_kind) = if self.quadratic { (10, 6, 11, 9) } else { (4, 3, 4, 2) };
        let facets =
            |name: &str| mesh.surfaces[name].facets.iter().map(|facet| facet.nodes()[..triangle].to_vec()).collect();
        let tets = |part: u32| {
            let own = mesh.elements.iter().filter(|element| element.part == part);
            // Gmsh has the last two midsides the other way round.
            own.map(|element| [0, 1, 2, 3, 4, 5, 6, 7, 9, 8][..tet].iter().map(|&a| element.nodes[a]).collect())
                .collect()
        };
        let surfaces = SURFACES.iter().zip(1..).map(|(name, entity)| (2, entity, triangle_kind, facets(name)));
        let parts = [(3, 1, tet_kind, tets(0)), (3, 2, tet_kind, tets(1))];
        let entities: Vec<(i32, i32, i32, Vec<Vec<u32>>)> = surfaces.chain(parts).collect();
        let total: usize = entities.iter().map(|entity| entity.3.len()).sum();
        writeln!(out, "$Elements\n{} {total} 1 {total}", entities.len()).unwrap();
        let mut element = 0;
        for (dimension, entity, kind, elements) in entities {
            writeln!(out, "{dimension} {entity} {kind} {}", elements.len()).unwrap();
            for nodes in elements {
                element += 1;
                let tags: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
                writeln!(out, "{element} {}", tags.join(" ")).unwrap();
            }
        }
        *out += "$EndElements\n";
    }
}

/// The sides of the blocks that are the surfaces 1 to 4 of [`HEADER`].
const SURFACES: [&str; 4] = ["disc_z0", "disc_z1", "pad_z0", "pad_z1"];

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
