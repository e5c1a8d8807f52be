//! `squeal reduce`: a super-element.

use std::path::PathBuf;

use clap::Args;

use crate::Result;
use crate::analysis::{ReduceOptions, Reduction, reduce, with_reference_contacts};
use crate::output::super_element::ReductionDocument;
use crate::structure::FullModel;

use super::watch::Watch;
use super::{Shell, values};

/// What `reduce` takes.
#[derive(Args)]
#[group(skip)]
pub struct Reduce {
    /// The model file
    model: PathBuf,
    /// Number of reference pairs over the sliding contacts, e.g. 104 (default: the model file's)
    #[arg(long, value_name = "N", value_parser = values::count)]
    contacts: Option<usize>,
    /// Friction coefficient at which the other contacts are linearised (default: the swept contacts' own)
    #[arg(long, value_name = "MU", value_parser = values::single, allow_hyphen_values = true)]
    friction: Option<f64>,
    /// Keep fixed-interface modes up to this frequency in Hz (default: the model file's reduction, else twice its band)
    #[arg(long, value_name = "HZ", value_parser = values::frequency, allow_hyphen_values = true)]
    limit: Option<f64>,
    /// The super-element's file (default: the model file's name with .se.h5)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace an earlier file
    #[arg(long)]
    force: bool,
}

pub fn run(shell: &Shell, arguments: &Reduce) -> Result<()> {
    let comm = shell.comm;
    let model = with_reference_contacts(FullModel::read(comm, &arguments.model)?, arguments.contacts)?;
    let options = ReduceOptions {
        friction: arguments.friction,
        limit: arguments.limit,
        file: arguments.file(),
        force: arguments.force,
    };
    let mut watch = Watch::new(shell, false);
    let Reduction { element, costs, equilibrium_seconds, seconds } = reduce(comm, &model, &options, &mut watch)?;
    watch.finish();
    let document = ReductionDocument::new(&element, &costs, [equilibrium_seconds, seconds], &options.file);
    shell.print(&document.text(), &document)
}

impl Reduce {
    fn file(&self) -> PathBuf {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.se.h5")))
    }
}
