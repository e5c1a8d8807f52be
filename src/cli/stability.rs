//! `squeal stability`: complex modes for one friction coefficient or a sweep.

use std::path::PathBuf;

use clap::Args;

use crate::Result;
use crate::analysis::{StabilityOptions, stability};
use crate::model::InstabilityCriterion;
use crate::output::summary;
use crate::structure::Structure;

use super::values;
use super::watch::Watch;
use super::{Run, Shell};

/// What `stability` takes.
#[derive(Args)]
#[group(skip)]
pub struct Stability {
    #[command(flatten)]
    run: Run,
    /// Frequency band in Hz, instead of the model file's
    #[arg(long, value_name = "FROM:TO", value_parser = values::band, allow_hyphen_values = true)]
    band: Option<[f64; 2]>,
    /// What counts as unstable, instead of the model file's: damping_ratio:X for damping ratios below X (a fraction:
    /// -0.001 is -0.1 %), or growth_rate:X for growth rates above X in 1/s
    #[arg(long, value_name = "CRITERION", value_parser = values::criterion)]
    unstable: Option<InstabilityCriterion>,
    /// Of a Galerkin super-element: compare its equilibria and modes with its full model, MODEL, by the residuals of
    /// the full model's equations, and correct the eigenvalues; the file needs its basis (reduce --keep-basis)
    #[arg(long, value_name = "MODEL")]
    certify: Option<PathBuf>,
    /// Reduce the model to a super-element at each friction coefficient, and find the modes of that
    #[arg(long)]
    reduce_each: bool,
    /// Do not follow the modes over the friction coefficient, which solves at more values to find where they become
    /// unstable
    #[arg(long)]
    no_branches: bool,
}

pub fn run(shell: &Shell, arguments: &Stability) -> Result<()> {
    let run = &arguments.run;
    let structure = Structure::read(shell.comm, &run.model, &run.structure_options())?;
    let options = StabilityOptions {
        friction_values: run.friction_values(),
        band: arguments.band,
        criterion: arguments.unstable,
        branches: !arguments.no_branches,
        reduce_each: arguments.reduce_each,
        certify: arguments.certify.clone(),
        output: Some(run.output(shell, "stability")),
    };
    let mut watch = Watch::with_signals(shell, run.verbose);
    let outcome = stability(shell.comm, &structure, &options, &mut watch);
    watch.finish();
    shell.print_results(&outcome?, &run.folder("stability"), summary::stability)
}
