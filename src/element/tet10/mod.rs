//! The 10-node isoparametric tetrahedron.
//!
//! ```text
//!            3
//!           /|\            corners 0-3, then the midsides of the edges
//!          7 | 9           4:(0,1) 5:(1,2) 6:(2,0) 7:(0,3) 8:(1,3) 9:(2,3)
//!         /  8  \
//!        0 --6|-- 2        reference coordinates (xi, eta, zeta) are the barycentric coordinates
//!         \  |  /          l1, l2, l3 of corners 1, 2, 3;  l0 = 1 - xi - eta - zeta
//!          4 | 5
//!           \|/            corners:  N_i = l_i (2 l_i - 1)
//!            1             midsides: N_ij = 4 l_i l_j
//! ```
//!
//! ```
//! use squeal::element::tet10::{mass_properties, straight};
//!
//! let nodes = straight([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
//! let steel = mass_properties(&nodes, 7800.0);
//! assert!((steel.mass - 1300.0).abs() < 1e-9 && (steel.centre()[0] - 0.25).abs() < 1e-12);
//! ```
//!
//! Geometry and displacement share the shape functions, `x = sum_a N_a x_a`, `u = sum_a N_a u_a`. An element is well
//! shaped when `detJ > 0` everywhere, which for the node order above means that corner 3 lies on the side of face
//! (0, 1, 2) from which it is seen counterclockwise, `(x_1 - x_0) x (x_2 - x_0) . (x_3 - x_0) > 0`.
//!
//! What the rules of [`quadrature`](super::quadrature) leave exact, and what they do not:
//!
//! | integral | straight edges | curved edges |
//! |---|---|---|
//! | stiffness (4 points) | exact | not exact; six rigid modes without force, no others |
//! | mass (14 points) | exact | row sums and total exact; entries (degree 7) to degree 5 |
//! | volume, first moment (14 points) | exact | exact |
//! | second moment (14 points) | exact | that of the mass matrix: 1e-6 for midsides 5 % off |
//!
//! Patch test, under a linear displacement: strain and stress are constant and right at every point of any element.
//! With straight edges the nodal forces balance to round-off. With curved edges they are integrals of `cof(J) grad
//! N_a`, of degree 3, so the 4-point rule leaves a residual that grows with the square of the midsides' offset (1e-3 of
//! the element forces for offsets up to 4 % of the edge; and since that offset shrinks with the element, it vanishes on
//! refinement); [`stiffness_14`] leaves none. `patch` measures both.

mod mass;
#[cfg(test)]
mod patch;
mod recovery;
mod shape;
mod stiffness;

pub use mass::{MassProperties, mass_properties, scalar_mass, volume};
pub use recovery::{strain, stress_at_nodes, von_mises};
pub use shape::{
    EDGES, FACES, NODES, corner_jacobians, determinants, gradients, is_inverted, jacobian, position, shape, straight,
};
pub use stiffness::{stiffness, stiffness_14};
