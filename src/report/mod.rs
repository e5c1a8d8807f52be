//! Results on disk and on screen: tables, CSV, JSON, VTU. Reads results, computes nothing of its own.

pub mod branches;
pub mod contact_cells;
pub mod contact_surface;
pub mod details;
pub mod explain;
pub mod folder;
pub mod json;
pub mod summary;
pub mod tables;
pub mod vtu;
