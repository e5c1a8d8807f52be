//! Elements: pure functions from coordinates and constants to matrices.
//!
//! Nothing here knows a mesh, a file or PETSc. Each element takes the coordinates of its own nodes as plain arrays and
//! fills dense matrices, row-major, with the dofs of one node side by side (dof `3a + i` is axis `i` of node `a`).
//! Symmetric 3x3 tensors travel in Voigt order xx yy zz xy yz zx with engineering shear strains, so that
//! `stress = elasticity * strain` with the elasticity as a `[[f64; 6]; 6]`, and energy density is `strain . stress /
//! 2`.
//!
//! ```text
//!   shape          tetrahedra, wedges, hexahedra: nodes and faces, by tables      facet   their faces; loads on them
//!   interpolation  shape functions from nodes and monomials                       quadrature   points and weights
//!   kind           C3D4 ... C3D20R: a shape and how it is integrated
//!   solid          stiffness, mass, mass properties, mean stress of any kind
//!   voigt          the order of stresses and strains
//!   coupling       a cloud's mean rigid motion as 3x3 blocks on its nodes (distributing coupling)
//!   linear         stiffness, damping and mass on linear functionals of displacements
//! ```
//!
//! Symbols, the same in all files of this module:
//!
//! | symbol | meaning |
//! |---|---|
//! | `N_a` | shape function of node `a` |
//! | `J` | Jacobian `d x_i / d xi_k`, row `i` column `k`; `detJ` its determinant |
//! | `B_a` | 6x3 strain-displacement matrix of node `a` |
//! | `D` | elasticity, 6x6 |
//! | `w` | quadrature weight (they add up to the reference element's volume or area) |

pub mod coupling;
pub mod facet;
pub mod interpolation;
mod kind;
pub mod linear;
pub mod quadrature;
#[cfg(test)]
pub(crate) mod samples;
mod shape;
pub mod solid;
pub mod voigt;

pub use facet::{FacetShape, MAX_FACET_NODES};
pub use kind::ElementKind;
pub use shape::{MAX_NODES, Shape};
