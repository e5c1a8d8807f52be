//! `squeal explore`: modes at points of many parameters, and the probability of squeal.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::analysis::{self, ExploreOutput, Output};
use crate::explore::{self, Answers, Study};
use crate::output::explore::Document;
use crate::report::explore_page;
use crate::results::Exploration;
use crate::{Error, Result};

use super::watch::Watch;
use super::{Shell, command_line, values};

/// What `explore` takes.
#[derive(Args)]
#[group(skip)]
pub struct Explore {
    /// The file of the study (TOML), which names a model file or a super-element, parameters and a design of points
    study: PathBuf,
    /// Folder of the results (default: the names of the model file and of the study, MODEL-STUDY)
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
        let stem = |file: &Path| file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let name = || format!("{}-{}", stem(&study.model), stem(&study.file));
        let output = Output {
            folder: self.output.clone().unwrap_or_else(|| PathBuf::from(name())),
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
    shell.print(&document.text(), &document)?;
    require_solution(&found)
}

/// A study without any solution beside the nominal one has not converged.
fn require_solution(found: &Exploration) -> Result<()> {
    let Answers { n_points, n_failed, .. } = found.answers;
    let what = "no point of the study has a solution. summary.txt has the reasons: change the ranges of its parameters";
    if n_failed < n_points { Ok(()) } else { Err(Error::not_converged(what)) }
}
