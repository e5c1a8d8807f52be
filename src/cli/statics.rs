//! `squeal static`: equilibria.

use crate::Result;
use crate::petsc::Comm;

use super::Run;
use super::study::Study;

pub fn run(comm: &Comm, run: &Run) -> Result<()> {
    let study = Study::new(comm, run, "static")?;
    let outcome = study.run(comm, |walk| {
        study.frictions.iter().try_for_each(|&friction| walk.visit(friction, |_| Ok("equilibrium".into())))
    })?;
    let (title, place) = (study.subject.title(), study.place.display());
    let summary = format!("{title}\n{}results in {place}\n", outcome.record.text);
    study.finish(outcome, &summary)
}
