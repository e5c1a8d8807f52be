//! `squeal stability`: complex modes for one friction or a sweep, followed from one to the next.

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::Result;
use crate::native::{Comm, Vector};
use crate::output::summary;
use crate::stability::{Band, Complex, Mode};
use crate::sweep::{Friction, Snapshot, Solutions, Source, Sweep, Vectors, tracking_options, wider};
use crate::tracking::track;

use super::motion;
use super::study::{self, Found, Study, Visit, Walk};
use super::subject::Drawn;
use super::{Run, Shell};

pub fn run(shell: &Shell, run: &Run, band: Option<[f64; 2]>, anew: bool, branches: bool) -> Result<()> {
    study::shared(shell, run, |shell| solve(shell, run, band, [anew, branches]))
}

fn solve(shell: &Shell, run: &Run, band: Option<[f64; 2]>, [anew, branches]: [bool; 2]) -> Result<()> {
    let comm = shell.comm;
    let options = [(anew, " --anew"), (!branches, " --no-branches")];
    let options: String = options.iter().filter(|(given, _)| *given).map(|(_, name)| *name).collect();
    let mut study = Study::new(shell, run, ("stability", &options), |subject| subject.band(band))?;
    // Super-elements that are made anew have coordinates of their own, so that their modes cannot be compared.
    let follows = branches && !anew && study.frictions().len() > 1;
    if follows && !study.frictions().is_sorted_by(|a, b| a > b) {
        study.about.frictions.sort_by(f64::total_cmp);
    }
    let outcome = study.run(comm, |walk| match (anew, follows) {
        (false, true) => follow(walk),
        (false, false) => each(walk, &find),
        (true, _) => each(walk, &|visit| find_reduced(comm, visit)),
    })?;
    study.finish(shell, outcome, summary::stability)
}

/// Only the frictions asked for, one by one.
fn each(walk: &mut Walk, find: &dyn Fn(Visit) -> Result<Found>) -> Result<()> {
    let study = walk.study;
    study.frictions().iter().try_for_each(|&friction| walk.visit(friction, find).map(|_| ()))
}

/// Modes at all frictions, strung on branches, and at those in between that this needs.
fn follow(walk: &mut Walk) -> Result<()> {
    let (system, study) = (walk.system, walk.study);
    let band = study.about.band;
    let mut family = Friction { solutions: walk, m: &system.m, c: &system.c };
    let (diagram, outcome) = track(&mut family, study.frictions(), &tracking_options(band));
    walk.results.diagram = Some(diagram);
    outcome
}

/// The modes of each friction that tracking asks for.
impl Solutions for Walk<'_, '_> {
    fn solve(&mut self, friction: f64) -> Result<Snapshot> {
        let snapshot = self.visit(friction, |mut visit| {
            let (study, band) = (visit.study, visit.study.about.band);
            let modes = visit.sweep.modes(visit.equilibrium, wider(band), &mut |event| study.say(&event))?;
            let snapshot = Snapshot::new(visit.sweep, &modes, band[1])?;
            let found = found(&mut visit, &modes, |visit, i, drawn| explained(visit, drawn, snapshot.left(i)?))?;
            Ok(Found { snapshot: Some(snapshot), ..found })
        })?;
        Ok(snapshot.expect("a visit without error has made it"))
    }

    fn vectors(&mut self, number: usize) -> Result<Vectors> {
        Walk::vectors(self, number)
    }

    fn known(&mut self, numbers: [usize; 2]) -> Result<Option<DMatrix<Complex64>>> {
        self.checkpoint().products(numbers)
    }

    fn keep(&mut self, numbers: [usize; 2], products: &DMatrix<Complex64>) -> Result<()> {
        self.checkpoint().keep_products(numbers, products)
    }
}

/// The modes at one friction.
fn find(mut visit: Visit) -> Result<Found> {
    let (study, band) = (visit.study, visit.study.about.band);
    let modes = visit.sweep.modes(visit.equilibrium, band, &mut |event| study.say(&event))?;
    let any_unstable = modes.modes.iter().any(Mode::is_unstable);
    let snapshot = any_unstable.then(|| Snapshot::of_unstable(visit.sweep, &modes, band[1])).transpose()?;
    found(&mut visit, &modes, |visit, i, drawn| match &snapshot {
        Some(snapshot) => explained(visit, drawn, snapshot.left(i)?),
        None => Ok(Vec::new()),
    })
}

/// The modes of the super-element that the brake is about the equilibrium.
fn find_reduced(comm: &Comm, visit: Visit) -> Result<Found> {
    let (study, friction) = (visit.study, visit.equilibrium.friction);
    let subject = study.subject.reduce(visit.system, visit.equilibrium)?;
    let (band, system) = (subject.band(Some(study.about.band))?, subject.assemble(comm)?);
    let mut sweep = Sweep::new(&system, subject.interface())?;
    sweep.friction_damping = subject.friction_damping();
    let equilibrium = sweep.equilibrium(friction, &mut |event| study.say(&event))?;
    let modes = sweep.modes(&equilibrium, band, &mut |event| study.say(&event))?;
    let mut motion = subject.motion(&system)?;
    found(&mut Visit { motion: &mut *motion, ..visit }, &modes, |_, _, drawn| {
        subject.draw(study.folder.as_ref(), &system, friction, drawn)?;
        Ok(Vec::new())
    })
}

/// The modes of the band as plain data. Where the friction was asked for, `look` draws unstable ones, given with their place among `modes`,
/// and explains them if it can.
fn found(
    visit: &mut Visit,
    modes: &Band,
    mut look: impl FnMut(&mut Visit, usize, &Drawn) -> Result<Vec<Source>>,
) -> Result<Found> {
    let ([from, to], asked) = (visit.study.about.band, visit.asked);
    let inside: Vec<usize> =
        (0..modes.modes.len()).filter(|&i| (from..=to).contains(&modes.modes[i].frequency())).collect();
    let chosen: Vec<&Mode> = inside.iter().map(|&i| &modes.modes[i]).collect();
    let mut plain = motion::plain(visit.motion, &chosen, |mode| asked && mode.is_unstable())?;
    for ((number, &i), mode) in (1..).zip(&inside).zip(&mut plain).filter(|(_, mode)| asked && mode.unstable) {
        let shape = mode.shape.as_ref().expect("unstable modes at a friction asked for have a shape");
        mode.sources = look(visit, i, &Drawn { number, mode: &modes.modes[i], shape })?;
    }
    Ok(Found { modes: plain, count: Some(modes.count), snapshot: None })
}

/// Draws an unstable mode and explains it.
fn explained(visit: &mut Visit, drawn: &Drawn, [re, im]: [Vector; 2]) -> Result<Vec<Source>> {
    let (study, equilibrium, mode) = (visit.study, visit.equilibrium, drawn.mode);
    study.subject.draw(study.folder.as_ref(), visit.system, equilibrium.friction, drawn)?;
    let right = (mode.lambda, Complex { re: &mode.re, im: &mode.im });
    study.subject.explain(visit.sweep, equilibrium, right, Complex { re: &re, im: &im })
}
