//! `squeal static`: equilibria.

use crate::Result;
use crate::analysis::{StaticOptions, statics};
use crate::output::summary;
use crate::structure::Structure;

use super::watch::Watch;
use super::{Run, Shell};

pub fn run(shell: &Shell, run: &Run) -> Result<()> {
    let structure = Structure::read(shell.comm, &run.model, &run.structure_options())?;
    let options = StaticOptions { friction_values: run.friction_values(), output: Some(run.output(shell, "static")) };
    let mut watch = Watch::with_signals(shell, run.verbose);
    let outcome = statics(shell.comm, &structure, &options, &mut watch);
    watch.finish();
    shell.print_results(&outcome?, &run.folder("static"), summary::statics)
}
