//! squeal
pub mod contact;
pub mod element;
pub mod error;
pub mod mesh;
pub mod model;

pub use error::{Error, Result};
