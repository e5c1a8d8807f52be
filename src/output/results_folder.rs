//! From results to the files of a run's folder.

use std::f64::consts::TAU;

use crate::Result;
use crate::output::folder::Folder;
use crate::output::tables::csv_file;
use crate::output::{branches, details, explain, tables};
use crate::results::{Results, file};

/// Name of the results file.
pub const RESULTS: &str = "results.h5";

/// Writes the results file, the tables that the results have rows for, and the summary, which ends with what went wrong. Not
/// collective.
///
/// # Errors
/// The system's and HDF5's, with the file's path.
pub fn write(folder: &Folder, results: &Results, summary: &str) -> Result<()> {
    file::write(&folder.draft().join(RESULTS), results)?;
    csv_file(folder, "contact.csv", |out| tables::pairs(out, results))?;
    csv_file(folder, "convergence.csv", |out| tables::convergence(out, results))?;
    if results.about.band[1] > 0.0 {
        modes(folder, results)?;
    }
    let failure = results.failure.as_ref().map_or_else(String::new, |f| format!("\nnot converged: {}\n", f.reason));
    folder.write("summary.txt", |out| out.write_all((summary.to_owned() + &failure).as_bytes()))
}

fn modes(folder: &Folder, results: &Results) -> Result<()> {
    folder.write("modes.csv", |out| tables::modes(out, results))?;
    folder.write("details.txt", |out| out.write_all(details::text(results).as_bytes()))?;
    if results.modes().any(|(_, _, mode)| !mode.sources.is_empty()) {
        csv_file(folder, "explained.csv", |out| explain::sources(out, results))?;
    }
    let Some(diagram) = &results.diagram else { return Ok(()) };
    let band = results.about.band.map(|f| TAU * f);
    folder.write("branches.csv", |out| branches::points(out, diagram, band, "friction"))?;
    folder.write("hopf.csv", |out| branches::hopf(out, diagram, "friction"))
}
