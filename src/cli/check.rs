//! `squeal check`: what a model is, before anything is computed.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::Result;
use crate::analysis::{matrix_summary, model_summary};
use crate::native::Comm;
use crate::output::contact_cells_vtu::ContactCells;
use crate::output::files::write_whole;
use crate::output::model_vtu::ModelPicture;
use crate::output::overwrite::may_write_file;
use crate::output::vtu::{self, Grid};
use crate::structure::FullModel;

use super::progress::Stages;
use super::{Shell, values};

/// What `check` takes.
#[derive(Args)]
#[group(skip)]
pub struct Check {
    /// The model file, or a deck of Abaqus or CalculiX (.inp)
    model: PathBuf,
    /// Show how this number of reference pairs would be spread over the sliding contacts
    #[arg(long, value_name = "N", value_parser = values::count)]
    contacts: Option<usize>,
    /// A VTU file that shows the model: parts, contact surfaces, constrained nodes, loads and axes; with --contacts the
    /// cells of the reference nodes
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace an earlier VTU file
    #[arg(long, requires = "output")]
    force: bool,
    /// Print a line for each finished stage on standard error: its seconds, and the most memory taken so far
    #[arg(short, long)]
    verbose: bool,
}

pub fn run(shell: &Shell, arguments: &Check) -> Result<()> {
    let comm = shell.comm;
    let Check { model, contacts, output, force, verbose } = arguments;
    let mut stages = Stages::new(comm, *verbose);
    let may_draw = || output.as_ref().map_or(Ok(()), |file| may_write_file(file, &vtu::KIND, *force));
    comm.agree(if comm.is_root() { may_draw() } else { Ok(()) })?;
    let full = FullModel::read_in_stages(comm, model, *contacts, &mut |stage| stages.end(stage))?;
    let mut summary = model_summary(comm, &full, contacts.is_some());
    let mut text = summary.text();
    if !shell.json {
        // What takes no time is printed at once.
        shell.print(&std::mem::take(&mut text), &())?;
    }
    if let Some(file) = output {
        draw(comm, file, &full, contacts.is_some())?;
    }
    let matrix = full.require_constrained(comm).and_then(|()| {
        stages.end("checking the model");
        matrix_summary(comm, &full, &mut |stage| stages.end(stage))
    });
    let outcome = matrix.and_then(|matrix| {
        text += &matrix.text();
        summary.matrix = Some(matrix);
        shell.print(&text, &summary)
    });
    // Last, where they are not overlooked.
    shell.warn(&summary.warnings);
    outcome
}

/// Writes the picture of the model, or that of the cells of the reference nodes. Collective.
fn draw(comm: &Comm, file: &Path, full: &FullModel, shows_cells: bool) -> Result<()> {
    let write = |grid: Grid| match comm.is_root() {
        true => write_whole(file, |mut out| grid.write(&mut out)),
        false => Ok(()),
    };
    comm.agree(match shows_cells {
        true => write(ContactCells::new(&full.mesh, &full.interface).grid()),
        false => write(ModelPicture::new(comm, full).grid()),
    })
}
