//! `squeal static`: equilibria.

use crate::Result;
use crate::petsc::Comm;
use crate::report::summary;

use super::Run;
use super::study::{Found, Study};

pub fn run(comm: &Comm, run: &Run) -> Result<()> {
    let study = Study::new(comm, run, "static", |_| Ok([0.0; 2]))?;
    let outcome = study.run(comm, |walk| {
        study.frictions().iter().try_for_each(|&friction| walk.visit(friction, |_| Ok(Found::default())).map(|_| ()))
    })?;
    study.finish(outcome, summary::statics)
}
