//! `squeal wear`: wear of the sliding pairs.

use clap::Args;

use crate::analysis::{self, WearGoal, WearOptions};
use crate::output::wear::summary;
use crate::structure::Structure;
use crate::{Error, Result};

use super::watch::Watch;
use super::{Run, Shell, values};

/// What `wear` takes.
#[derive(Args)]
#[group(skip)]
pub struct Wear {
    #[command(flatten)]
    run: Run,
    /// Sliding distance in m, the mean over the points that wear
    #[arg(long, value_name = "METRES", value_parser = values::positive, required_unless_present = "until_uniform")]
    distance: Option<f64>,
    /// Number of steps over the distance
    #[arg(long, value_name = "N", value_parser = values::count, default_value = "10", conflicts_with = "until_uniform")]
    steps: usize,
    /// Wear until the standard deviation of pressure times speed over its mean is below this on every pair, e.g. 0.01
    #[arg(long, value_name = "TOLERANCE", value_parser = values::positive, conflicts_with = "distance")]
    until_uniform: Option<f64>,
}

impl Wear {
    fn goal(&self) -> WearGoal {
        match (self.until_uniform, self.distance) {
            (Some(tolerance), _) => WearGoal::Uniform { tolerance },
            (None, distance) => {
                WearGoal::Distance { distance: distance.expect("clap has asked for one"), n_steps: self.steps }
            }
        }
    }

    /// The friction coefficient, where one is given.
    fn friction(&self) -> Result<Option<f64>> {
        match self.run.friction_values().as_deref() {
            None => Ok(None),
            Some(&[friction]) => Ok(Some(friction)),
            Some(_) => Err(Error::input("a brake wears at one friction coefficient. Give --friction one value")),
        }
    }
}

pub fn run(shell: &Shell, arguments: &Wear) -> Result<()> {
    let run = &arguments.run;
    let friction = arguments.friction()?;
    let mut structure = Structure::read(shell.comm, &run.model, &run.structure_options())?;
    let options = WearOptions { friction, goal: arguments.goal(), output: Some(run.output(shell, "wear")) };
    let mut watch = Watch::with_signals(shell, run.verbose);
    let outcome = analysis::wear(shell.comm, &mut structure, &options, &mut watch);
    watch.finish();
    let found = outcome?;
    shell.print(&summary(&found, &run.folder("wear").display().to_string()), &found)
}
