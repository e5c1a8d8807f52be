//! Rounds of points: all those that are not finished, by the groups of ranks.

use std::time::Duration;

use crate::analysis::observer::{Event, Observer, stop_signal};
use crate::explore::{Outcome, PointResult};
use crate::output::folder::Folder;
use crate::{Error, Result};

use super::Run;
use super::checkpoint::Points;
use super::groups::Turns;
use super::point::{PointSolution, Request, WeightedModes, of_point, solve};

/// A rank that waits for others looks so often whether they have ended.
const WAIT: Duration = Duration::from_millis(10);

impl Run<'_> {
    /// Solves all points that are not finished. Collective.
    pub(super) fn round(
        &self,
        points: &mut Points,
        nominal: Option<&WeightedModes>,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let numbers = points.missing(self.values.len());
        let turns = Turns::new(&self.groups, points.place());
        let worked = self.work(&turns, &numbers, points, nominal, observer).inspect_err(|_| turns.stop());
        let is_first = self.groups.world.is_root() && turns.has_others();
        self.groups.agree_after(worked, || {
            std::thread::sleep(WAIT);
            if observer.stop_signal().is_some() && !turns.is_stopped() {
                turns.stop();
            }
            if is_first {
                points.look_for(&numbers);
                self.report(points, observer);
            }
        })?;
        points.share();
        self.report(points, observer);
        Ok(())
    }

    /// Solves those points that this rank's group takes, until a signal. Collective in the group.
    fn work(
        &self,
        turns: &Turns,
        numbers: &[usize],
        points: &mut Points,
        nominal: Option<&WeightedModes>,
        observer: &mut dyn Observer,
    ) -> Result<()> {
        let comm = &self.groups.own;
        for &number in numbers {
            if stop_signal(comm, observer).is_some() {
                turns.stop();
            }
            let taken = comm.agree(if comm.is_root() { turns.take(number) } else { Ok(false) })?;
            if !comm.broadcast_value(0, taken) {
                continue;
            }
            let start = points.nearest(&self.values[number], &self.scales);
            let (point, found) = self.point(number, &self.request, start, nominal, observer)?;
            let (shapes, state) = found.map(|found| (found.shapes, found.displacements)).unzip();
            points.commit(number, point, shapes.unwrap_or_default(), state)?;
            self.folder.iter().for_each(Folder::keep);
            points.look_for(if turns.has_others() && self.groups.world.is_root() { numbers } else { &[] });
            self.report(points, observer);
        }
        Ok(())
    }

    pub(super) fn report(&self, points: &mut Points, observer: &mut dyn Observer) {
        for (number, point) in points.news() {
            observer.event(Event::Point { number, point, is_replayed: false });
        }
    }

    /// Solves one point, and recognises its modes; without `nominal` it is the nominal one. What fails is its result.
    /// Collective in the group.
    pub(super) fn point(
        &self,
        number: usize,
        request: &Request,
        start: Option<&[f64]>,
        nominal: Option<&WeightedModes>,
        observer: &mut dyn Observer,
    ) -> Result<(PointResult, Option<PointSolution>)> {
        let values = self.values[number].clone();
        match self.solved(&values, request, start, observer)? {
            Ok(mut found) => {
                match nominal {
                    _ if number == 0 => found.are_nominal(),
                    Some(nominal) => self.follow(number, &mut found, nominal, observer)?,
                    None => {}
                }
                let outcome = Outcome::Modes(std::mem::take(&mut found.modes));
                Ok((PointResult { values, outcome }, Some(found)))
            }
            Err(reason) => Ok((PointResult { values, outcome: Outcome::Failed(reason) }, None)),
        }
    }

    /// Equilibrium and modes with some values, or why there are none. Collective in the group.
    pub(super) fn solved(
        &self,
        values: &[f64],
        request: &Request,
        start: Option<&[f64]>,
        observer: &mut dyn Observer,
    ) -> Result<std::result::Result<PointSolution, String>> {
        let comm = &self.groups.own;
        let structure = self.subject.structure(comm, values);
        let found = structure.and_then(|(brake, friction)| solve(comm, (&brake, friction), request, start, observer));
        match found {
            Ok(found) => Ok(Ok(found)),
            // A reason is the same on all ranks.
            Err(error) => Ok(Err(comm.broadcast_value(0, of_point(&self.groups, error)?.to_string()))),
        }
    }
}

/// That a round without a signal has finished points, of which so many were missing before and after.
///
/// # Errors
/// [`Error::Input`] where it has not: the next one would not, either.
pub fn require_progress(n_before: usize, n_after: usize) -> Result<()> {
    if n_after < n_before {
        return Ok(());
    }
    let what = format!("{n_after} points are missing, and no group of ranks could take any of them");
    Err(Error::input(format!("{what}. Let no other program change the unfinished folder, and give the command again")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_that_finishes_no_point_is_the_last_one() {
        assert!(require_progress(3, 2).is_ok() && require_progress(3, 0).is_ok());
        assert!(require_progress(3, 3).unwrap_err().to_string().contains("3 points are missing"));
    }
}
