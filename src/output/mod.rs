//! Results on disk and on screen: a run's folder, tables as text and CSV, JSON documents, VTU files. Reads results,
//! computes nothing of its own.

pub mod branches;
pub mod columns;
pub mod comparison;
pub mod contact_cells_vtu;
mod contact_rows;
pub mod details;
pub mod explain;
pub mod explore;
mod explore_sections;
mod explore_tables;
pub mod external;
pub mod fields;
pub mod files;
pub mod folder;
pub mod free_modes;
pub mod json;
pub mod model_summary;
pub mod model_vtu;
pub mod overwrite;
pub mod results_folder;
pub mod study;
pub mod summary;
pub mod super_element;
pub mod sweep_text;
pub mod text;
mod volume;
pub mod vtu;
pub mod wear;
