//! Contact: where surfaces meet, how a body is seen there, and what acts.
//!
//! ```text
//! Model + Mesh --search--> points: w, n, gap0 --+
//!                     \--> gap operator: g = B u --> Interface
//!                            Model --> laws ----+
//! ```
//!
//! A contact point `a` is a quadrature point of the slave's facets with the weight `w`, such that a uniform pressure is
//! exact and no weight is negative ([`surface_points`]): on 6-node triangles these are the midside nodes. At
//! the reference geometry the point is projected once on the master, which gives the unit normal n (outward from the
//! master), the initial gap, and the shape values N_j of the master's facet ([`search`]). From then on contact sees
//! the bodies only through the relative displacement of the two,
//!
//! ```text
//! g_a = sum_i N_i u_i - sum_j N_j u_j      that is    g = B u      B: the gap operator
//! ```
//!
//! and its answer is a force f(g) on the slave with `D = -df/dg` ([`law`]). To residual and tangent of the whole they
//! bring
//!
//! ```text
//! F_contact = -B^T f         K_contact = B^T D B
//! ```
//!
//! ([`GapOperator::spread`] and [`GapOperator::expand_into`]). Reference nodes that follow a cloud of nodes, and
//! super-elements, differ in B and in nothing else.
//!
//! This module is pure: it knows neither PETSc nor files.

mod facet;
pub mod gap_operator;
pub mod interface;
pub mod law;
mod motion;
mod pairing;
mod projection;
pub mod search;
pub mod surface_points;
mod tangent_change;
#[cfg(test)]
pub(crate) mod testing;

pub use gap_operator::GapOperator;
pub use interface::{ArchardWear, ContactPair, ContactPoint, Interface, Stage, Statistics, TangentialKind};
pub use law::{FrictionLaw, PointLaw, Response, Status, Tangential};
pub use motion::sliding;
pub use pairing::NothingFound;
pub use tangent_change::{Dyad, Tangent, TangentChange};
