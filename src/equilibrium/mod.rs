//! Static equilibrium under contact and friction: `K u + F_nl(u) = F_ext`.
//!
//! [`Contacts`] carries displacements to the contact points and contact forces back to the equations; the code in
//! `newton` is one solve by PETSc's SNES with a line search; [`Path`] leads from rest to any friction in steps that Newton can
//! take: at rest there is no pressure, so every bound on sticking is zero and the pads are loose. So the first step *settles*
//! with all points sticking and touching points closed, the second solves the true laws without friction at the disc, and only then
//! friction rises; a step that fails is halved. [`Balance`] checks the result: forces, moments, torque.

mod balance;
mod contacts;
mod continuation;
mod labelled_factor;
mod newton;
mod path;
mod step_factor;
#[cfg(test)]
pub(crate) mod testing;
mod woodbury;

pub use balance::{Balance, PairForces, Wrench};
pub use contacts::{Contacts, Counts};
pub use labelled_factor::{Label, LabelledFactor};
pub use newton::{Iteration, Step};
pub use path::{Equilibrium, LinearSystem, Path, tangent_precision};
pub use woodbury::Woodbury;
