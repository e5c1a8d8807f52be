//! `squeal static`: equilibria.

use crate::Result;
use crate::output::summary;

use super::study::{self, Found, Study};
use super::{Run, Shell};

pub fn run(shell: &Shell, run: &Run) -> Result<()> {
    study::shared(shell, run, |shell| solve(shell, run))
}

fn solve(shell: &Shell, run: &Run) -> Result<()> {
    let study = Study::new(shell, run, ("static", ""), |_| Ok([0.0; 2]))?;
    let outcome = study.run(shell.comm, |walk| {
        study.frictions().iter().try_for_each(|&friction| walk.visit(friction, |_| Ok(Found::default())).map(|_| ()))
    })?;
    study.finish(shell, outcome, summary::statics)
}
