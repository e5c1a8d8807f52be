//! `squeal report`: the page that people look at, its figures as files, and instabilities in motion for ParaView.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::Shell;
use super::output::RESULTS;
use crate::report::findings::Findings;
use crate::report::folder::{adopt, write_file};
use crate::report::raster::Painter;
use crate::report::{page, paraview, plots, words};
use crate::results::file;
use crate::{Error, Result};

/// What `report` takes.
#[derive(Args)]
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
    /// Replace earlier files
    #[arg(long)]
    force: bool,
}

pub fn run(shell: &Shell, report: &Report) -> Result<()> {
    let mut told = None;
    let outcome = if shell.comm.is_root() { write(report).map(|what| told = Some(what)) } else { Ok(()) };
    shell.comm.agree(outcome)?;
    let Some((headline, files)) = told else { return Ok(()) };
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let list: String = names.iter().map(|name| format!("  {name}\n")).collect();
    shell.tell(&format!("{headline}\n{list}"), || json!({"headline": headline, "files": names}))
}

/// Writes all that is asked for, and tells the first sentence and the files that a person opens.
fn write(report: &Report) -> Result<(String, Vec<PathBuf>)> {
    let source = if report.results.is_dir() { report.results.join(RESULTS) } else { report.results.clone() };
    let home = source.parent().unwrap_or(Path::new(""));
    let html = report.output.clone().unwrap_or_else(|| home.join("report.html"));
    let targets = [Some(&html), report.plots.as_ref(), report.paraview.as_ref()];
    targets.into_iter().flatten().try_for_each(|target| may_write(target, report.force))?;
    let results = file::read(&source)?;
    if results.about.band[1] <= 0.0 {
        return Err(Error::input(format!(
            "{} has no modes: squeal report tells of squeal stability",
            source.display()
        )));
    }
    let findings = Findings::new(&results);
    let page = page::page(&results)?;
    let mut written = vec![html.clone()];
    put(&html, |out| out.write_all(page.as_bytes()))?;
    report.plots.as_ref().map_or(Ok(()), |folder| write_plots(folder, &findings, &mut written))?;
    let cycles = report.paraview.as_ref().map(|folder| write_cycles(folder, &findings, &mut written)).transpose()?;
    adopt(home, &written)?;
    // A person opens the page, the folder of figures and the collections.
    let shown = [html].into_iter().chain(report.plots.clone()).chain(cycles.into_iter().flatten());
    Ok((words::headline(&findings), shown.collect()))
}

fn may_write(target: &Path, force: bool) -> Result<()> {
    let is_free = fs::read_dir(target).map_or(!target.exists(), |mut entries| entries.next().is_none());
    match is_free || force {
        true => Ok(()),
        false => {
            Err(Error::input(format!("{} exists. Use --force to replace it, or choose another", target.display())))
        }
    }
}

/// A file that appears when it is complete.
fn put(path: &Path, body: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    let name = path.file_name().ok_or_else(|| Error::input(format!("{} is no name of a file", path.display())))?;
    let draft = path.with_file_name(format!(".{}.partial-{}", name.to_string_lossy(), std::process::id()));
    write_file(&draft, body).and_then(|()| fs::rename(&draft, path).map_err(Error::io(path))).inspect_err(|_| {
        // Best effort: half a file is of no use to anyone.
        let _ = fs::remove_file(&draft);
    })
}

fn write_plots(folder: &Path, findings: &Findings, written: &mut Vec<PathBuf>) -> Result<()> {
    let painter = Painter::new()?;
    for figure in plots::figures(findings) {
        let files = [("svg", figure.svg.clone().into_bytes()), ("png", painter.png(&figure.svg)?)];
        for (kind, bytes) in files {
            let path = folder.join(format!("{}.{kind}", figure.name));
            put(&path, |out| out.write_all(&bytes))?;
            written.push(path);
        }
    }
    Ok(())
}

/// Writes the cycles, and gives their collections.
fn write_cycles(folder: &Path, findings: &Findings, written: &mut Vec<PathBuf>) -> Result<Vec<PathBuf>> {
    let mut collections = Vec::new();
    for cycle in paraview::cycles(findings) {
        for moment in 0..paraview::MOMENTS {
            let path = folder.join(cycle.file(moment));
            put(&path, |out| cycle.write_moment(moment, out))?;
            written.push(path);
        }
        let path = folder.join(format!("{}.pvd", cycle.name));
        put(&path, |out| cycle.write_collection(out))?;
        collections.push(path);
    }
    written.extend(collections.iter().cloned());
    Ok(collections)
}
