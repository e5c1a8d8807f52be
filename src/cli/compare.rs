//! `squeal compare`: two results, mode by mode.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::comparison;
use crate::output::comparison as tables;
use crate::output::folder::Folder;
use crate::report::comparison_plot;
use crate::results::{About, Results, file};
use crate::{Error, Result};

use super::Shell;
use crate::output::results_folder::RESULTS;

/// What `compare` takes.
#[derive(Args)]
#[group(skip)]
pub struct Compare {
    /// The folder of the results that are the reference
    a: PathBuf,
    /// The folder of those to be compared with it
    b: PathBuf,
    /// Folder for the comparison as text, table (CSV) and figure (SVG); without it, it is only printed
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Replace an earlier comparison
    #[arg(long)]
    force: bool,
}

/// Compares the results in two folders, on the first rank.
pub fn run(shell: &Shell, arguments: &Compare) -> Result<()> {
    shell.comm.agree(if shell.comm.is_root() { compare(shell, arguments) } else { Ok(()) })
}

fn compare(shell: &Shell, Compare { a, b, output, force }: &Compare) -> Result<()> {
    let places = [a.as_path(), b.as_path()];
    let folder = output.as_ref().map(|output| Folder::open(output, *force)).transpose()?;
    let [a, b] = [read(places[0])?, read(places[1])?];
    let comparison = comparison::compare(&a, &b).map_err(|error| of_both(places, error))?;
    let names = [name(places[0], &a), name(places[1], &b)];
    let text = tables::text(&comparison, names.each_ref().map(String::as_str));
    if let Some(folder) = folder {
        folder.write("comparison.txt", |out| out.write_all(text.as_bytes()))?;
        folder.write("comparison.csv", |out| tables::csv(out, &comparison))?;
        folder.write("comparison.svg", |out| out.write_all(comparison_plot::errors(&comparison).as_bytes()))?;
        folder.finish()?;
    }
    shell.print(&text, &comparison)
}

/// The results in a folder, or of the file itself.
///
/// # Errors
/// [`Error::Input`] where there are none, or none with modes.
pub(super) fn read(place: &Path) -> Result<Results> {
    let file = if place.is_dir() { place.join(RESULTS) } else { PathBuf::from(place) };
    let advice = "Give the folder of a run of squeal stability";
    if !file.exists() {
        return Err(Error::input(format!("{} contains no {RESULTS}. {advice}", place.display())));
    }
    let results = file::read(&file)?;
    match results.about.band[1] > 0.0 {
        true => Ok(results),
        false => Err(Error::input(format!("{} has no modes. {advice}", file.display()))),
    }
}

/// What the results are of, in one line.
fn name(place: &Path, results: &Results) -> String {
    let about = &results.about;
    let n_contacts: usize = about.pairs.iter().filter(|pair| pair.sliding).map(|pair| pair.n_points).sum();
    let About { model, n_dofs, criterion, .. } = about;
    format!("{}: {model}, {n_dofs} dofs, {n_contacts} sliding contact points; unstable: {criterion}", place.display())
}

/// Names the results that could not be compared.
fn of_both([a, b]: [&Path; 2], error: Error) -> Error {
    match error {
        Error::Input(what) => Error::input(format!("{} and {}: {what}", a.display(), b.display())),
        other => other,
    }
}
