//! `squeal explore`: modes at points of many parameters, and the probability of squeal.

use std::path::PathBuf;

use clap::Args;

use crate::Result;
use crate::analysis::{self, ExploreOutput, Output};
use crate::explore::{self, Study};
use crate::output::explore::Document;
use crate::report::explore_page;

use super::watch::Watch;
use super::{Shell, command_line, values};

/// What `explore` takes.
#[derive(Args)]
#[group(skip)]
pub struct Explore {
    /// The file of the study (TOML), which names a model file or a super-element, parameters and a design of points
    study: PathBuf,
    /// Folder of the results (default: the model file's name with -explore)
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Replace the results of an earlier run, and what another study has left unfinished
    #[arg(long)]
    force: bool,
    /// Under mpirun: so many ranks solve a point together, and groups of them solve points at the same time; the number
    /// of ranks is a multiple of it (default: all ranks, of a super-element one)
    #[arg(long, value_name = "R", value_parser = values::count)]
    ranks_per_point: Option<usize>,
    /// Print a line for each finished point on standard error, with the time left (a terminal shows a bar anyway)
    #[arg(short, long)]
    verbose: bool,
}

impl Explore {
    fn output(&self, shell: &Shell, study: &Study) -> ExploreOutput {
        let stem = study.model.file_stem().unwrap_or_default().to_string_lossy();
        let output = Output {
            folder: self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-explore"))),
            force: self.force,
            command: command_line(),
            identity: vec![("options for PETSc", shell.petsc.join(" "))],
        };
        ExploreOutput { output, page: explore_page::page }
    }
}

pub fn run(shell: &Shell, arguments: &Explore) -> Result<()> {
    let study = shell.comm.agree(explore::read(&arguments.study))?;
    let output = arguments.output(shell, &study);
    let mut watch = Watch::with_signals(shell, arguments.verbose);
    let found = analysis::explore(shell.comm, &study, arguments.ranks_per_point, Some(&output), &mut watch);
    watch.finish();
    let Some(found) = found? else { return Ok(()) };
    let document = Document::new(&study, &found, &output.output.folder);
    shell.print(&document.text(), &document)
}
