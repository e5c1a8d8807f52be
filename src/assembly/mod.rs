//! From elements to the system matrices: one layer for full and reduced models alike.
//!
//! Whatever adds to M, C or K is a family of [`Elements`]: a list of nodes and dense matrices for each member. A *node*
//! is a place for up to three free dofs: a mesh node, a reference point, or three generalised coordinates of a
//! super-element. [`DofMap`] numbers the free dofs (constrained ones have no number) so that each rank owns a
//! contiguous range; [`Pattern`] is the union of everything that couples nodes, contact points included, open or
//! closed, so that it never changes; [`System`] is the result.
//!
//! Each rank computes every element that touches a node of its own and keeps the rows that it owns. Elements on the
//! border are computed twice and nothing is communicated.
//!
//! Element matrices go straight to their places in PETSc's arrays (`scatter`): K and C have one pattern, and room for
//! all that contact adds. A mass that does not couple axes has a pattern of its own, a third as large (`axes`).

mod axes;
mod boundary;
mod dofs;
mod gravity;
pub mod joints;
mod load_vector;
mod loads;
mod pattern;
mod rotation;
mod scatter;
mod solids;
mod system;

pub use boundary::{Boundary, Displacements};
pub use dofs::DofMap;
pub use gravity::weights;
pub use joints::{JointElement, JointKind, Joints};
pub use loads::{add_prescribed, constraints, forces_of_prescribed, loads, prescribed};
pub use pattern::Pattern;
pub use rotation::{Prestress, TurningSolids};
pub use solids::Solids;
pub use system::{Connectivity, ElementMatrices, Elements, System, ViscoelasticStiffness, element_forces};
