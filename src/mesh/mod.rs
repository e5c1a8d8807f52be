//! The finite element mesh: nodes, 10-node tetrahedra grouped into parts, named surfaces and node sets.
//!
//! ```text
//!  .msh --gmsh::sections--> tags, blocks, groups --gmsh::convert--> Mesh
//!                                                  (no element inverted; skin: facets outward)
//!  Mesh --numbering::order--> nodes rank by rank --Piece--> each rank's own part
//! ```
//!
//! Physical volumes become parts, physical surfaces become [`Surface`]s, physical curves and points become node sets.
//! The names are the only link between a mesh and a model file, so a name may mean one thing only.
//!
//! The order of nodes is that of [`tet10`](crate::element::tet10) and [`tri6`](crate::element::tri6).

mod gmsh;
mod numbering;
mod piece;
pub mod quality;
mod skin;
mod types;

pub use gmsh::read;
pub use numbering::{Numbering, order};
pub use piece::Piece;
pub use types::{Mesh, Surface};
