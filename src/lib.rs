//! squeal
pub mod assembly;
pub mod contact;
pub mod element;
pub mod error;
pub mod mesh;
pub mod model;
pub mod petsc;
pub mod stability;

pub use error::{Error, Result};
