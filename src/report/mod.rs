//! The report: findings of a sweep in words and figures, on one HTML page. Reads results, computes nothing of its own.
//!
//! ```text
//! Results -> Findings (instabilities) --> words, figures (SVG -> PNG) --+
//!        \-> drawing: geometry, shapes, flat faces, as packed numbers --+-> one HTML page
//!         \-> ParaView: shapes that move
//! ```

mod certificate;
pub mod comparison_plot;
pub mod data;
pub mod drawing;
mod explore_data;
pub mod explore_page;
mod explore_plots;
pub mod findings;
mod frame;
pub mod model_section;
pub mod page;
pub mod paraview;
pub mod plots;
mod pressure_map;
pub mod raster;
pub mod states;
mod states_page;
pub mod study_folder;
pub mod study_plot;
pub mod svg;
pub mod words;
