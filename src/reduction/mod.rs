//! Reduced models: contact through a few reference nodes, and super-elements that keep nothing else.
//!
//! ```text
//! Interface --layout--> cells --contacts--> Interface with reference nodes
//! System + Interface + Equilibrium --craig_bampton--> Reduced --> SuperElement --> System + Interface of some hundred
//!                                                                                    dofs
//! ```

pub mod contacts;
pub mod craig_bampton;
pub mod file;
pub mod fixed_interface;
pub mod functionals;
pub mod galerkin;
pub mod layout;
mod linear;
pub mod made_for;
mod member;
mod pair_text;
pub mod part_change;
pub mod part_samples;
pub mod parts;
pub mod projection;
pub mod recovery;
pub mod super_element;
#[cfg(test)]
pub(crate) mod testing;
