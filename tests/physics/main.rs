//! The physics by way of the library: equilibrium, modes, energies and reduced models against theory and other
//! programs.

mod balance;
mod branches;
mod calculix;
mod damped_pad;
mod deck;
mod eigensolvers;
mod explain;
mod factors;
mod friction_law;
mod galerkin;
mod gravity;
mod joints;
mod manufactured_solution;
mod part_factors;
mod prestress;
mod reduced_terms;
mod rotation;
mod structural_damping;
mod super_element;
mod super_element_laws;
#[path = "../support/mod.rs"]
mod support;
mod viscoelastic;
mod wear;
