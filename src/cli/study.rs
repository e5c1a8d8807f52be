//! `squeal study`: reduced models compared with full contact.

use crate::Result;
use crate::analysis::{StudyOptions, study};
use crate::report::study_folder;

use super::watch::Watch;
use super::{Shell, Study};

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
    let mut watch = Watch::with_signals(shell, arguments.verbose)?;
    let found = study(shell.comm, &options, &mut watch);
    watch.finish();
    let Some(found) = found? else { return Ok(()) };
    let text = study_folder::write(&options.folder, &found, options.super_element)?;
    shell.tell(&text, &found)
}
