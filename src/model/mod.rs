//! The model file: what the user writes, checked and in SI units.
//!
//! ```text
//!  file --toml, serde--> keys::File --one file a table: materials, bodies, contacts, joints, loads ...--> Model
//!                 (spans kept)                                                           (names and lines kept)
//! ```
//!
//! A model file names things that the mesh defines (physical groups), so it is checked in two steps. [`read()`] sees
//! the file alone: keys, kinds, ranges, names defined within the file. [`Model::check_against`] sees the mesh too:
//! names of surfaces, which pairs slide, what those need. Either way a message is
//!
//! ```text
//! brake.toml:12: young must be above 0, not -1 (material "iron"). Give Pa, such as 110e9
//! ```
//!
//! that is, where, what, of which item, and what to do. Nothing is guessed: an unknown key is an error that offers the
//! nearest right one, and a number that no material can have is an error and not a warning.
//!
//! # Every key
//!
#![doc = concat!("```toml\n", include_str!("example.toml"), "```")]

mod analysis;
mod bodies;
mod check;
mod contacts;
mod criterion;
pub mod elasticity;
pub mod friction;
mod gap_field;
mod gap_image;
mod grid;
mod item;
mod joint_types;
mod joints;
mod keys;
mod loads;
mod materials;
mod merge;
pub mod names;
mod paths;
mod place;
mod proposed;
mod read;
mod sliding;
mod source;
mod surfaces;
#[cfg(test)]
mod tests;
mod types;
mod units;
pub mod viscoelastic;
mod write;

pub use analysis::spaced;
pub use contacts::is_pressure_table;
pub use criterion::InstabilityCriterion;
pub use friction::{LARGEST_FRICTION, ROUGH};
pub use gap_field::{GapField, StiffnessField};
pub use gap_image::ImageFrame;
pub use grid::GridInterval;
pub use joint_types::{Connector, Equation, EquationTerm, GROUND, PointMass, RigidSet, Tie};
pub use joints::PENALTY;
pub use place::Place;
pub use proposed::ProposedStiffness;
pub use read::{is_deck, parse, read, read_text};
pub use source::{located, utf8};
pub use surfaces::softest_young;
pub use types::{
    Contact, Fix, Inertia, Load, LoadKind, Material, Model, NormalLaw, Part, Rayleigh, Reduction, Rotation,
};
pub use units::UnitSystem;
pub use write::{isotropic, write};

/// A model file that uses every key, with an explanation of each.
pub const EXAMPLE: &str = include_str!("example.toml");

/// The JSON schema (draft 2020-12) of model files: for editors, which complete and check keys by it.
pub const SCHEMA: &str = include_str!("schema.json");
