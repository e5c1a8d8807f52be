//! Static equilibrium under contact and friction: `K u + F_nl(u) = F_ext`.
//!
//! [`Contacts`] evaluates the contact points at displacements of the dofs; the code in `newton` is one solve by PETSc's
//! SNES with a line search, `step_factor` its linear systems; [`Path`] leads from rest to any friction value by the
//! steps of `continuation`. [`LabelledFactor`] is the one factor that steps and modes share. [`Balance`] checks the
//! result: forces, moments, torque.

mod balance;
mod contacts;
mod continuation;
mod dense_gaps;
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
