//! A pad pressed by a piston on a sliding disc, all blocks.
//!
//! ```text
//!           | force           z
//!       +---v---+             |_ y     the disc turns about an axis far away: it slides along y
//!       | piston|
//!     +-+-------+-+
//!     |    pad    |
//!   +-+-----------+-+
//!   |     disc      |         held at its bottom
//!   +---------------+
//! ```

use squeal::mesh::Mesh;

use super::block::add_block;

/// The disc's support and rotation, the sliding contact and the force; parts, materials and what is between piston and
/// pad come from the test.
pub const SLIDING: &str = r#"
[[fix]]
nodes = "disc_z0"
axes = "xyz"
[[rotation]]
part = "disc"
axis = [0, 0, 1]
through = [-0.1, 0.01, 0]
speed = 5.0
[[contact]]
name = "disc / pad"
slave = "pad_z0"
master = "disc_z1"
law = { linear = 2e13 }
friction = 0.4
[[load]]
name = "force"
on = "piston_z1"
force = [0, 0, -1000]
"#;

/// Its mesh, with cells of the disc.
pub fn mesh(disc_cells: [usize; 3]) -> Mesh {
    let mut mesh = Mesh::default();
    add_block(&mut mesh, "disc", disc_cells, [0.0, 0.0, 0.0], [30.0, 31.0, 10.0]);
    add_block(&mut mesh, "pad", [2, 2, 1], [5.0, 5.0, 10.0], [20.0, 21.0, 5.0]);
    add_block(&mut mesh, "piston", [1, 1, 1], [8.0, 9.0, 15.0], [12.0, 13.0, 8.0]);
    mesh
}
