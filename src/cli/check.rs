//! `squeal check`: what a model is, before anything is computed.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::Result;
use crate::analysis::{matrix_summary, model_summary};
use crate::output::contact_cells_vtu::ContactCells;
use crate::output::files::write_whole;
use crate::output::overwrite::may_write_file;
use crate::output::vtu;
use crate::structure::FullModel;

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
    /// A VTU file that shows the cells of the reference nodes (with --contacts)
    #[arg(short, long, value_name = "FILE", requires = "contacts")]
    output: Option<PathBuf>,
    /// Replace an earlier VTU file
    #[arg(long, requires = "output")]
    force: bool,
}

pub fn run(shell: &Shell, arguments: &Check) -> Result<()> {
    let comm = shell.comm;
    let Check { model, contacts, output, force } = arguments;
    let may_draw = || output.as_ref().map_or(Ok(()), |file| may_write_file(file, &vtu::KIND, *force));
    comm.agree(if comm.is_root() { may_draw() } else { Ok(()) })?;
    let full = FullModel::read_with_contacts(comm, model, *contacts)?;
    let mut summary = model_summary(comm, &full, contacts.is_some());
    let mut text = summary.text();
    if !shell.json {
        // What takes no time is printed at once.
        shell.print(&std::mem::take(&mut text), &())?;
    }
    if let Some(file) = output {
        comm.agree(if comm.is_root() { draw(file, &full) } else { Ok(()) })?;
    }
    shell.warn(&summary.warnings);
    full.require_constrained(comm)?;
    let matrix = matrix_summary(comm, &full)?;
    text += &matrix.text();
    summary.matrix = Some(matrix);
    shell.print(&text, &summary)
}

/// Writes the cells of the reference nodes.
fn draw(file: &Path, full: &FullModel) -> Result<()> {
    let picture = ContactCells::new(&full.mesh, &full.interface);
    write_whole(file, |mut out| picture.grid().write(&mut out))
}
