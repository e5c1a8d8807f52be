//! The finite element mesh: nodes, solid elements grouped into parts, named surfaces and node sets.
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
//! The order of nodes is that of [`Shape`](crate::element::Shape) and [`FacetShape`](crate::element::FacetShape).

mod elements;
mod gmsh;
mod numbering;
mod piece;
pub mod quality;
mod skin;
mod types;

pub use elements::{Element, ElementList, Facet, Positions};
pub use gmsh::{read, write};
pub use numbering::{Numbering, order};
pub use piece::Piece;
pub(crate) use skin::Skin;
pub use types::{Mesh, Surface};
