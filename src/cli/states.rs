//! `squeal states`: one brake in named states, compared.

use std::path::PathBuf;

use clap::Args;

use crate::Result;
use crate::analysis::{self, StatesOptions};
use crate::explore::States as File;
use crate::report::states::{StatesDocument, write};

use super::watch::Watch;
use super::{Shell, command_line};

/// What `states` takes.
#[derive(Args)]
#[group(skip)]
pub struct States {
    /// The file of the states (TOML), which names a model file and what differs from it in each state
    states: PathBuf,
    /// Folder of the study (default: the model file's name with -states)
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print a line for each finished value on standard error, with the time left (a terminal shows a bar anyway)
    #[arg(short, long)]
    verbose: bool,
}

pub fn run(shell: &Shell, arguments: &States) -> Result<()> {
    let file = shell.comm.agree(File::read(&arguments.states))?;
    let stem = file.model.file_stem().unwrap_or_default().to_string_lossy();
    let folder = arguments.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-states")));
    let options = StatesOptions { folder, command: command_line(), identity: shell.petsc.join(" ") };
    let mut watch = Watch::with_signals(shell, arguments.verbose);
    let found = analysis::states(shell.comm, &file, &options, &mut watch);
    watch.finish();
    let made = found?.map(|found| {
        let document = StatesDocument::new(&found, &options.folder)?;
        write(&options.folder, &document, &found).map(|()| document)
    });
    let Some(document) = shell.comm.agree(made.transpose())? else { return Ok(()) };
    shell.print(&document.text(), &document)
}
