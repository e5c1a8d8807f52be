//! The finite element mesh: nodes, 10-node tetrahedra grouped into parts, named surfaces and node sets.
//!
//! ```text
//!  .msh --gmsh::sections--> tags, blocks, groups --gmsh::convert--> Mesh --check--> Model and Mesh agree
//!                                                  (jacobian: none inverted; skin: facets outward)
//!  Mesh --numbering::order--> nodes rank by rank --Piece--> each rank's own part
//! ```
//!
//! Physical volumes become parts, physical surfaces become [`Surface`]s, physical curves and points become node sets. The names are
//! the only link between a mesh and a model file, so a name may mean one thing only.
//!
//! A tetrahedron's nodes, seen along the edge from corner 3 (formulas in [`jacobian`]):
//!
//! ```text
//!            2
//!          / | \            corners 0 1 2 3, positive volume: det(x1-x0, x2-x0, x3-x0) > 0
//!        6   9   5          midsides 4 = (0,1)  5 = (1,2)  6 = (2,0)
//!      /     3     \                 7 = (0,3)  8 = (1,3)  9 = (2,3)
//!    /   7       8   \      faces outward: (0,2,1) (0,1,3) (1,2,3) (2,0,3)
//!   0 ------- 4 ------- 1
//! ```

mod bytes;
mod check;
mod gmsh;
pub mod jacobian;
mod numbering;
mod piece;
pub mod quality;
mod skin;
mod types;

pub use gmsh::read;
pub use numbering::{Numbering, order};
pub use piece::Piece;
pub use types::{Mesh, Surface};
