//! From results to the files of a run's folder.

use std::f64::consts::TAU;

use super::columns::{
    self, AtFriction, CertifiedRow, ContactRow, HopfRow, IterationRow, ModeRow, ModeSourceRow, SourceRow,
};
use super::folder::Folder;
use super::{branches, details};
use crate::Result;
use crate::results::{Results, file};
use crate::tracking::Diagram;

/// Name of the results file.
pub const RESULTS: &str = "results.h5";

/// Writes the results file, the tables that the results have rows for, and the summary, which ends with what went
/// wrong. Not collective.
///
/// ```
/// use squeal::Results;
/// use squeal::output::folder::Folder;
/// use squeal::output::results_folder;
///
/// # let place = tempfile::tempdir().expect("a folder");
/// let place = place.path().join("my-brake");
/// let folder = Folder::open(&place, false)?;
/// results_folder::write(&folder, &Results::default(), "nothing was found\n")?;
/// folder.finish()?;
/// assert!(place.join("results.h5").is_file() && place.join("summary.txt").is_file());
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// The system's and HDF5's, with the file's path.
pub fn write(folder: &Folder, results: &Results, summary: &str) -> Result<()> {
    file::write(&folder.draft().join(RESULTS), results)?;
    folder.write("contact.csv", |out| columns::write_csv(out, contact(results)))?;
    folder.write("convergence.csv", |out| columns::write_csv(out, convergence(results)))?;
    if results.about.band[1] > 0.0 {
        write_modes(folder, results)?;
    }
    let failure = results.failure.as_ref().map_or_else(String::new, |f| format!("\nnot converged: {}\n", f.reason));
    folder.write("summary.txt", |out| out.write_all((summary.to_owned() + &failure).as_bytes()))
}

fn write_modes(folder: &Folder, results: &Results) -> Result<()> {
    folder.write("modes.csv", |out| columns::write_csv(out, modes(results)))?;
    folder.write("details.txt", |out| out.write_all(details::text(results).as_bytes()))?;
    if results.modes().any(|(_, _, mode)| !mode.sources.is_empty()) {
        folder.write("explained.csv", |out| columns::write_csv(out, sources(results)))?;
    }
    if results.asked().any(|value| value.certificate.is_some()) {
        folder.write("certified.csv", |out| columns::write_csv(out, certified(results)))?;
    }
    let Some(diagram) = &results.diagram else { return Ok(()) };
    write_branches(folder, diagram, results.about.band, "friction")
}

/// Writes the branches within a band (Hz) over a parameter, and their Hopf points.
///
/// # Errors
/// The system's, with the file's path.
pub fn write_branches(folder: &Folder, diagram: &Diagram, band: [f64; 2], parameter: &str) -> Result<()> {
    let points = branches::points(diagram, band.map(|f| TAU * f));
    folder.write("branches.csv", |out| columns::write_csv_over(out, parameter, points))?;
    let hopf = diagram.hopf.iter().map(HopfRow::new);
    folder.write("hopf.csv", |out| columns::write_csv_over(out, parameter, hopf))
}

fn modes(results: &Results) -> impl Iterator<Item = AtFriction<ModeRow>> {
    results.modes().map(|(friction, number, mode)| AtFriction { friction, row: ModeRow::of(number, mode) })
}

fn certified(results: &Results) -> impl Iterator<Item = AtFriction<CertifiedRow>> {
    results.asked().filter_map(|value| value.certificate.as_ref()).flat_map(|certificate| {
        let numbered = (1..).zip(&certificate.modes);
        let row =
            move |(number, mode)| AtFriction { friction: certificate.friction, row: CertifiedRow::of(number, mode) };
        numbered.map(row)
    })
}

fn contact(results: &Results) -> impl Iterator<Item = AtFriction<ContactRow<'_>>> {
    results.asked().flat_map(|value| {
        let pairs = results.about.pairs.iter().zip(&value.pairs);
        pairs.map(|(pair, forces)| AtFriction { friction: value.friction, row: ContactRow::new(&pair.name, forces) })
    })
}

/// The iterates of all values and of a failure.
fn convergence(results: &Results) -> impl Iterator<Item = AtFriction<IterationRow<'_>>> {
    let done = results.values.iter().map(|value| (value.friction, &value.steps));
    let failed = results.failure.iter().filter_map(|failure| Some((failure.friction?, &failure.steps)));
    done.chain(failed).flat_map(|(friction, steps)| {
        steps.iter().flat_map(IterationRow::of).map(move |row| AtFriction { friction, row })
    })
}

fn sources(results: &Results) -> impl Iterator<Item = AtFriction<ModeSourceRow<'_>>> {
    results.modes().flat_map(|(friction, mode, data)| {
        let row = move |source| ModeSourceRow { mode, frequency_hz: data.frequency(), source: SourceRow::new(source) };
        data.sources.iter().map(move |source| AtFriction { friction, row: row(source) })
    })
}
