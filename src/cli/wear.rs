//! `squeal wear`: wear of the sliding pairs.

use std::path::PathBuf;

use clap::Args;

use crate::analysis::{self, WearGoal, WearOptions};
use crate::hdf::is_hdf5;
use crate::output;
use crate::output::folder::Folder;
use crate::structure::FullModel;
use crate::{Error, Result};

use super::watch::Watch;
use super::{Shell, values};

/// What `wear` takes.
#[derive(Args)]
#[group(skip)]
pub struct Wear {
    /// The model file, whose sliding contacts have wear = COEFFICIENT (m2/N)
    model: PathBuf,
    /// Sliding distance in m, the mean over the points that wear
    #[arg(long, value_name = "METRES", value_parser = values::positive, required_unless_present = "until_uniform")]
    distance: Option<f64>,
    /// Number of steps over the distance
    #[arg(long, value_name = "N", value_parser = values::count, default_value = "10", conflicts_with = "until_uniform")]
    steps: usize,
    /// Wear until the standard deviation of pressure times speed over its mean is below this on every pair, e.g. 0.01
    #[arg(long, value_name = "TOLERANCE", value_parser = values::positive, conflicts_with = "distance")]
    until_uniform: Option<f64>,
    /// Friction coefficient of the swept contacts (default: their own)
    #[arg(long, value_name = "MU", value_parser = values::single, allow_hyphen_values = true)]
    friction: Option<f64>,
    /// Folder of the results (default: the model file's name with -wear)
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Replace the results of an earlier run
    #[arg(long)]
    force: bool,
    /// Print what is being done twice a minute on standard error (a terminal shows it anyway)
    #[arg(short, long)]
    verbose: bool,
}

impl Wear {
    fn options(&self) -> WearOptions {
        let goal = match (self.until_uniform, self.distance) {
            (Some(tolerance), _) => WearGoal::Uniform { tolerance },
            (None, distance) => {
                WearGoal::Distance { distance: distance.expect("clap has asked for one"), n_steps: self.steps }
            }
        };
        WearOptions { friction: self.friction, goal }
    }

    fn place(&self) -> PathBuf {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-wear")))
    }
}

pub fn run(shell: &Shell, arguments: &Wear) -> Result<()> {
    let (comm, place) = (shell.comm, arguments.place());
    if is_hdf5(&arguments.model) {
        let what = "a super-element does not wear: its contacts have one gap each";
        return Err(Error::input(format!("{}: {what}. Wear its model, with full contact", arguments.model.display())));
    }
    let mut full = FullModel::read(comm, &arguments.model)?;
    full.require_constrained(comm)?;
    let folder = Folder::open_empty(comm, &place, arguments.force)?;
    let mut watch = Watch::with_signals(shell, arguments.verbose)?;
    let found = analysis::wear(comm, &mut full, &arguments.options(), folder.as_ref(), &mut watch);
    watch.finish();
    let found = found?;
    let text = output::wear::summary(&found, &place.display().to_string());
    comm.agree(folder.map_or(Ok(()), |folder| {
        output::wear::write(&found, &folder, &text)?;
        folder.finish()
    }))?;
    shell.print(&text, &found)
}
