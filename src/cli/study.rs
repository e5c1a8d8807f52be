//! `squeal study`: reduced models compared with full contact.

use std::path::PathBuf;

use clap::Args;

use crate::Result;
use crate::analysis::{StudyOptions, study};
use crate::report::study_folder;

use super::Shell;
use super::values::{self, Values};
use super::watch::Watch;

/// What `study` takes.
#[derive(Args)]
#[group(skip)]
pub struct Study {
    /// The model file
    model: PathBuf,
    /// Friction coefficient of the swept contacts: one value, a list 0.2,0.5 or a range FROM:TO:STEP (default: the
    /// model file's)
    #[arg(long, value_name = "MU", value_parser = values::parse, allow_hyphen_values = true)]
    friction: Option<Values>,
    /// Contact layouts: numbers of reference pairs over the sliding contacts
    #[arg(long, value_name = "N,N", value_parser = values::count, value_delimiter = ',', default_value = "12,44,104,212")]
    layouts: Vec<usize>,
    /// Reference pairs of the super-elements
    #[arg(long, value_name = "N", value_parser = values::count, default_value = "104")]
    super_element: usize,
    /// Friction coefficient at which the super-element for all values is made (default: the swept contacts' own)
    #[arg(long, value_name = "MU", value_parser = values::single, allow_hyphen_values = true)]
    reduced_at: Option<f64>,
    /// Folder of the study (default: the model file's name with -study)
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print a line for each finished value on standard error, with the time left, and one twice a minute for what is
    /// being done (a terminal shows a bar anyway)
    #[arg(short, long)]
    verbose: bool,
}

impl Study {
    fn place(&self) -> PathBuf {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}-study")))
    }
}

pub fn run(shell: &Shell, arguments: &Study) -> Result<()> {
    let options = StudyOptions {
        model: arguments.model.clone(),
        friction_values: arguments.friction.as_ref().map(|values| values.0.clone()),
        layouts: arguments.layouts.clone(),
        super_element: arguments.super_element,
        reduced_at: arguments.reduced_at,
        folder: arguments.place(),
        identity: shell.petsc.join(" "),
    };
    let mut watch = Watch::with_signals(shell, arguments.verbose);
    let found = study(shell.comm, &options, &mut watch);
    watch.finish();
    let Some(found) = found? else { return Ok(()) };
    let text = study_folder::write(&options.folder, &found, options.super_element)?;
    shell.print(&text, &found)
}
