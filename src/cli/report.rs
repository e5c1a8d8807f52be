//! `squeal report`: the page that people look at, its figures as files, and instabilities in motion for ParaView.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::{Shell, compare, values};
use crate::model::InstabilityCriterion;
use crate::output::explore::PAGE;
use crate::output::files::write_whole;
use crate::output::folder::add_to_listed;
use crate::output::json::Reported;
use crate::output::overwrite::{FileKind, SIGNATURE, is_free, may_write_file};
use crate::output::results_folder::RESULTS;
use crate::output::vtu;
use crate::report::findings::Findings;
use crate::report::raster::{self, Painter};
use crate::report::{page, paraview, plots, words};
use crate::results::exploration_file;
use crate::{Error, Result};

/// What `report` takes.
#[derive(Args)]
#[group(skip)]
pub struct Report {
    /// The folder of a run, or its results.h5
    results: PathBuf,
    /// The page (default: report.html in the folder of the results)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write the figures as SVG and PNG into a folder, too
    #[arg(long, value_name = "FOLDER")]
    plots: Option<PathBuf>,
    /// Write the instabilities in motion for ParaView into a folder, too: a .pvd file each, with 24 moments of a cycle
    #[arg(long, value_name = "FOLDER")]
    paraview: Option<PathBuf>,
    /// What counts as unstable, instead of the run's: damping_ratio:X for damping ratios below X (a fraction:
    /// -0.001 is -0.1 %), or growth_rate:X for growth rates above X in 1/s
    #[arg(long, value_name = "CRITERION", value_parser = values::criterion)]
    unstable: Option<InstabilityCriterion>,
    /// Replace earlier files
    #[arg(long)]
    force: bool,
}

pub fn run(shell: &Shell, report: &Report) -> Result<()> {
    let mut written = None;
    let outcome = if shell.comm.is_root() { write(report).map(|what| written = Some(what)) } else { Ok(()) };
    shell.comm.agree(outcome)?;
    let Some((headline, files)) = written else { return Ok(()) };
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let list: String = names.iter().map(|name| format!("  {name}\n")).collect();
    shell.print(&format!("{headline}\n{list}"), &Reported { headline, files: names })
}

/// Writes all that is asked for, and gives the first sentence and the files that a person opens.
fn write(report: &Report) -> Result<(String, Vec<PathBuf>)> {
    let source = if report.results.is_dir() { report.results.join(RESULTS) } else { report.results.clone() };
    let home = source.parent().unwrap_or(Path::new(""));
    let html = report.output.clone().unwrap_or_else(|| home.join("report.html"));
    may_write_file(&html, &page::KIND, report.force)?;
    [&report.plots, &report.paraview].into_iter().flatten().try_for_each(|folder| may_fill(folder, report.force))?;
    if exploration_file::is_one(&source) {
        return Err(of_explore(&source, &home.join(PAGE)));
    }
    let results = compare::read(&report.results)?;
    let criterion = report.unstable.unwrap_or(results.about.criterion);
    let results = results.by(criterion);
    let findings = Findings::new(&results);
    let page = page::page(&results)?;
    let mut writer = Writer { force: report.force, written: Vec::new() };
    writer.put(html.clone(), &page::KIND, |out| out.write_all(page.as_bytes()))?;
    report.plots.as_ref().map_or(Ok(()), |folder| writer.plots(folder, &findings))?;
    let cycles = report.paraview.as_ref().map(|folder| writer.cycles(folder, &findings)).transpose()?;
    add_to_listed(home, &writer.written)?;
    // A person opens the page, the folder of figures and the collections.
    let shown = [html].into_iter().chain(report.plots.clone()).chain(cycles.into_iter().flatten());
    Ok((words::headline(&findings), shown.collect()))
}

/// Whether files may be added to a folder; whether each of them may be replaced, its kind decides.
fn may_fill(folder: &Path, force: bool) -> Result<()> {
    let place = folder.display();
    match (folder.is_file(), is_free(folder) || force) {
        (true, _) => Err(Error::input(format!("{place} is a file. Give the name of a folder"))),
        (_, true) => Ok(()),
        (_, false) => {
            Err(Error::input(format!("{place} exists. Use --force to replace files in it, or choose another")))
        }
    }
}

/// Why there is no report of the results of a study of many parameters.
fn of_explore(source: &Path, page: &Path) -> Error {
    let (source, shown) = (source.display(), page.display());
    Error::input(if page.exists() {
        format!("{source} is of squeal explore, which has written its page: {shown}. Open that")
    } else {
        format!("{source} is of squeal explore, whose page {shown} is missing. Run squeal explore again to write it")
    })
}

/// Writes files, each in place of its like at most.
struct Writer {
    force: bool,
    written: Vec<PathBuf>,
}

impl Writer {
    fn put(
        &mut self,
        path: PathBuf,
        kind: &FileKind,
        body: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<()> {
        may_write_file(&path, kind, self.force)?;
        write_whole(&path, body)?;
        self.written.push(path);
        Ok(())
    }

    fn plots(&mut self, folder: &Path, findings: &Findings) -> Result<()> {
        let painter = Painter::new()?;
        for figure in plots::figures(findings) {
            let [svg, png] = ["svg", "png"].map(|ending| folder.join(format!("{}.{ending}", figure.name)));
            self.put(svg, &plots::KIND, |out| write!(out, "{SIGNATURE}\n{}", figure.svg))?;
            let pixels = painter.png(&figure.svg)?;
            self.put(png, &raster::KIND, |out| out.write_all(&pixels))?;
        }
        Ok(())
    }

    /// Writes the cycles, and gives their collections.
    fn cycles(&mut self, folder: &Path, findings: &Findings) -> Result<Vec<PathBuf>> {
        let mut collections = Vec::new();
        for cycle in paraview::cycles(findings) {
            for moment in 0..paraview::MOMENTS {
                self.put(folder.join(cycle.file(moment)), &vtu::KIND, |out| cycle.write_moment(moment, out))?;
            }
            let path = folder.join(format!("{}.pvd", cycle.name));
            self.put(path.clone(), &paraview::KIND, |out| cycle.write_collection(out))?;
            collections.push(path);
        }
        Ok(collections)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_a_study_is_named_where_it_is_and_missed_where_it_is_not() {
        let place = tempfile::tempdir().unwrap();
        let page = place.path().join(PAGE);
        let message = || of_explore("run/results.h5".as_ref(), &page).to_string();
        assert!(message().contains("is missing. Run squeal explore again"), "{}", message());
        std::fs::write(&page, "").unwrap();
        assert!(message().contains("explore.html. Open that"), "{}", message());
    }
}
