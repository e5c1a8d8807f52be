//! `squeal reduce`: a super-element.

use std::path::PathBuf;

use crate::Result;
use crate::analysis::{ReduceOptions, Reduction, reduce, with_reference_contacts};
use crate::output::super_element::ReductionDocument;
use crate::structure::FullModel;

use super::watch::Watch;
use super::{Reduce, Shell};

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
    shell.tell(&document.text(), &document)
}

impl Reduce {
    fn file(&self) -> PathBuf {
        let stem = self.model.file_stem().unwrap_or_default().to_string_lossy();
        self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.se.h5")))
    }
}
