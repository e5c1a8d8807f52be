//! squeal
mod algebra;
pub mod assembly;
pub mod cli;
pub mod contact;
pub mod element;
pub mod equilibrium;
pub mod error;
pub mod mesh;
pub mod model;
pub mod petsc;
pub mod report;
pub mod stability;
pub mod sweep;

pub use error::{Error, Result};
