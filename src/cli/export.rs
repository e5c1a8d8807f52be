//! `squeal export`: M, C, K and G about an equilibrium, for other programs.

use std::path::Path;

use clap::{Args, ValueEnum};

use crate::Result;
use crate::analysis::{ExportOptions, Exported, MatrixFormat, export};
use crate::output::folder::Folder;
use crate::output::json::ExportDocument;
use crate::structure::{FullModel, Structure};

use super::watch::Watch;
use super::{Run, Shell};

/// Formats of matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Matrix Market text, coordinate real general
    Mtx,
    /// PETSc binary
    Petsc,
}

impl From<Format> for MatrixFormat {
    fn from(format: Format) -> MatrixFormat {
        match format {
            Format::Mtx => MatrixFormat::MatrixMarket,
            Format::Petsc => MatrixFormat::Petsc,
        }
    }
}

/// What `export` takes.
#[derive(Args)]
#[group(skip)]
pub struct Export {
    #[command(flatten)]
    run: Run,
    /// Format of the files
    #[arg(long, value_enum, default_value = "mtx")]
    format: Format,
    /// This part alone: unconstrained, without contact and load
    #[arg(long, value_name = "NAME", conflicts_with_all = ["friction", "contacts", "law"])]
    part: Option<String>,
}

pub fn run(shell: &Shell, Export { run, format, part }: &Export) -> Result<()> {
    let (comm, place) = (shell.comm, run.folder("export"));
    let structure = match part {
        Some(part) => Structure::Full(Box::new(FullModel::read_part(comm, &run.model, part)?)),
        None => Structure::read(comm, &run.model, &run.structure_options())?,
    };
    let options =
        ExportOptions { friction: run.friction_values(), with_contact: part.is_none(), format: (*format).into() };
    let folder = Folder::open_empty(comm, &place, run.force)?;
    let mut watch = Watch::new(shell, run.verbose);
    let exported = export(comm, &structure, &options, folder.as_ref(), &mut watch)?;
    watch.finish();
    let text = text(&exported, &place);
    let written = folder.map_or(Ok(()), |folder| {
        folder.write("summary.txt", |out| out.write_all(text.as_bytes()))?;
        folder.finish()
    });
    comm.agree(written)?;
    let (friction, n) = (exported.friction, exported.n_dofs);
    shell.print(&text, &ExportDocument { folder: place.display().to_string(), friction, dofs: n })
}

fn text(exported: &Exported, place: &Path) -> String {
    let about = match exported.friction {
        Some(friction) => format!("about the equilibrium at friction coefficient {friction}"),
        None => "of a free part".into(),
    };
    let lines: String = exported.files.iter().map(|(name, what)| format!("  {name:20}{what}\n")).collect();
    let (title, n, folder) = (&exported.title, exported.n_dofs, place.display());
    let file = |i: usize| &exported.files[i].0;
    let structural = exported.files.iter().find(|(name, _)| name.starts_with("structural."));
    let structural = structural.map_or_else(String::new, |(name, _)| format!(" --structural {folder}/{name}"));
    format!(
        "{title}: M, C and K {about}, {n} dofs\n\nresults in {folder}:\n{lines}\nIts modes: squeal modes --mass {folder}/{} \
         --damping {folder}/{} --stiffness {folder}/{}{structural} --band FROM:TO\n",
        file(0),
        file(1),
        file(2)
    )
}
