//! Results on disk and on screen: tables, CSV, VTU, and the report with its figures. Reads results, computes nothing of its own.
//!
//! ```text
//! Results -> Findings (instabilities) --> words, figures (SVG -> PNG) --+
//!        \-> drawing: geometry, shapes, flat faces, as packed numbers --+-> one HTML page
//!         \-> ParaView: shapes that move
//! ```

pub mod branches;
pub mod comparison;
pub mod comparison_plot;
pub mod contact_cells;
pub mod contact_surface;
pub mod data;
pub mod details;
pub mod drawing;
pub mod eigenvalues;
pub mod explain;
pub mod files;
pub mod findings;
pub mod folder;
pub mod json;
pub mod overwrite;
pub mod page;
pub mod paraview;
pub mod plots;
pub mod raster;
pub mod study;
pub mod study_plot;
pub mod summary;
pub mod svg;
pub mod tables;
#[cfg(test)]
mod testing;
pub mod vtu;
pub mod words;
