//! What a study of many parameters needs to continue after its process has ended, at whatever moment.
//!
//! ```text
//! .NAME.unfinished/.resume/
//!   study.txt               what the numbers depend on
//!   point-000003.bin        a finished point with shapes of its modes
//!   state-000003.N.RANK.h5  its displacements, from which points nearby start, of a rank of N
//!   nominal.N.RANK.h5       vectors of the nominal modes
//!   taken/000003            a group of ranks has taken the point, finished or not
//!   gradients.bin           their derivatives by the parameters
//! ```
//!
//! Numbers are kept bit by bit, so that a study that was interrupted ends with the same files on one group of ranks.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::Result;
use crate::analysis::unfinished::{Unfinished, write_binary};
use crate::explore::{Gradient, PointResult};
use crate::output::folder::{self, Folder, RESUME};
use crate::results::Shape;

use super::files::{
    GRADIENTS, KeptPoint, nominal_name, point_name, read_binary, read_list, read_nominal, read_point, read_points,
    state_name, write_list, write_nominal,
};
use super::groups::{Groups, Turns};
use super::point::WeightedModes;

/// What a study finishes one by one.
pub const UNIT: &str = "points";

/// The finished points of a study, and its files where it has a folder.
pub struct Points {
    groups: Groups,
    place: Option<PathBuf>,
    /// The finished points by their numbers: this group's, and those of the others as far as they are known.
    done: BTreeMap<usize, PointResult>,
    /// This group's points that the others do not have.
    unshared: Vec<usize>,
    /// Those that no event has reported.
    unreported: BTreeSet<usize>,
    /// Derivatives of the nominal modes by each parameter; none where they are not asked for.
    pub gradients: Vec<Gradient>,
    /// This rank's displacements of points of its group, by their numbers.
    states: BTreeMap<usize, Vec<f64>>,
    /// When the files of other groups were last looked for.
    looked: Option<Instant>,
    /// What could not be read of an earlier run, on the first rank.
    pub warnings: Vec<String>,
}

/// Displacements are kept of so many bytes over all ranks.
const STATES_BYTES: usize = 1 << 30;
/// Displacements are kept of at most so many points.
const MAX_STATES: usize = 1000;
/// The files of other groups are looked for no more often than this.
const LOOK_INTERVAL: Duration = Duration::from_millis(500);

impl Points {
    /// The points that an earlier run has finished, whatever its ranks and groups. Displacements of groups of as many
    /// ranks serve as starts. A file that cannot be read counts as absent: what it has is computed again. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where another study was begun, or a machine does not see the folder; the system's.
    pub fn open(
        groups: &Groups,
        folder: Option<&Folder>,
        target: Option<&Path>,
        identity: &[(&str, String)],
        force: bool,
    ) -> Result<Points> {
        let mut points = Points {
            groups: groups.clone(),
            place: None,
            done: BTreeMap::new(),
            unshared: Vec::new(),
            unreported: BTreeSet::new(),
            gradients: Vec::new(),
            states: BTreeMap::new(),
            looked: None,
            warnings: Vec::new(),
        };
        let Some(target) = target else { return Ok(points) };
        let place = folder::unfinished(target)?.join(RESUME);
        let study = Unfinished { target, identity, name: point_name, unit: UNIT };
        let earlier = folder.map_or(Ok(Vec::new()), |folder| {
            let n = study.prepare(folder, force)?;
            Turns::clear(&place)?;
            if n > 0 { read_points(&place, &mut points.warnings) } else { Ok(Vec::new()) }
        });
        let world = &groups.world;
        let earlier = world.broadcast_value(0, world.agree(earlier)?);
        Turns::require_shared(groups, &place)?;
        let reads = world.is_root() && !earlier.is_empty();
        let gradients = if reads { read_binary(&place.join(GRADIENTS)).unwrap_or_default() } else { Vec::new() };
        points.gradients = world.broadcast_value(0, gradients);
        points.place = Some(place);
        points.read_states(&earlier);
        points.done = earlier.into_iter().map(|(number, kept)| (number, kept.point)).collect();
        Ok(points)
    }

    /// Reads displacements of earlier points, as many as may be kept, which all ranks can read.
    fn read_states(&mut self, earlier: &[(usize, KeptPoint)]) {
        let Some(place) = &self.place else { return };
        let comm = &self.groups.own;
        for (number, _) in earlier.iter().filter(|(_, kept)| kept.n_state_files == comm.size()) {
            let Some(state) = self.on_all(read_list(&place.join(state_name(*number, comm)))) else { continue };
            if !has_room(&self.groups, self.states.len(), &state) {
                break;
            }
            self.states.insert(*number, state);
        }
    }

    /// What all ranks can read. Collective over all ranks.
    fn on_all<T>(&self, read: Result<T>) -> Option<T> {
        let all_can = self.groups.world.min(usize::from(read.is_ok())) == 1;
        read.ok().filter(|_| all_can)
    }

    /// The folder of their files.
    pub fn place(&self) -> Option<&Path> {
        self.place.as_deref()
    }

    /// A finished point.
    pub fn get(&self, number: usize) -> Option<&PointResult> {
        self.done.get(&number)
    }

    /// The finished points with their numbers.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &PointResult)> {
        self.done.iter().map(|(number, point)| (*number, point))
    }

    /// Those of the first `n` points that are not finished.
    pub fn missing(&self, n: usize) -> Vec<usize> {
        (0..n).filter(|number| !self.done.contains_key(number)).collect()
    }

    /// The finished points by their numbers, the nominal one first.
    pub fn all(&self) -> Vec<PointResult> {
        self.done.values().cloned().collect()
    }

    /// Keeps a point that this group has finished, with shapes of its modes; its displacements, where there is room for
    /// them. All groups have the nominal point, whose files are the first one's. Collective in the group.
    ///
    /// # Errors
    /// The system's and HDF5's, with the path.
    pub fn commit(
        &mut self,
        number: usize,
        point: PointResult,
        shapes: Vec<Shape>,
        state: Option<Vec<f64>>,
    ) -> Result<()> {
        let state = state.filter(|state| has_room(&self.groups, self.states.len(), state));
        if number > 0 || self.groups.number() == 0 {
            self.write(number, &point, shapes, state.as_deref())?;
        }
        if number > 0 {
            self.unshared.push(number);
        }
        self.unreported.insert(number);
        self.done.insert(number, point);
        self.keep_state(number, state);
        Ok(())
    }

    /// Keeps displacements as starts of other points.
    pub fn keep_state(&mut self, number: usize, state: Option<Vec<f64>>) {
        self.states.extend(state.map(|state| (number, state)));
    }

    fn write(&self, number: usize, point: &PointResult, shapes: Vec<Shape>, state: Option<&[f64]>) -> Result<()> {
        let (Some(place), comm) = (&self.place, &self.groups.own) else { return Ok(()) };
        if let Some(state) = state {
            comm.agree(write_list(&place.join(state_name(number, comm)), state))?;
        }
        let n_state_files = state.map_or(0, |_| comm.size());
        self.keep_binary(&place.join(point_name(number)), &KeptPoint { n_state_files, point: point.clone(), shapes })
    }

    /// The shapes that are kept of a finished point; none without a folder. Not collective.
    ///
    /// # Errors
    /// The system's, with the path.
    pub fn shapes(&self, number: usize) -> Result<Vec<Shape>> {
        self.place.as_ref().map_or(Ok(Vec::new()), |place| Ok(read_point(&place.join(point_name(number)))?.shapes))
    }

    /// Gives all ranks the points of all groups. Collective over all ranks.
    pub fn share(&mut self) {
        let own = std::mem::take(&mut self.unshared);
        let own = own.into_iter().map(|number| (number, self.done[&number].clone())).collect();
        let all = self.groups.join(own);
        all.into_iter().for_each(|(number, point)| self.add(number, point));
    }

    /// Reads the points that other groups have kept, for the progress. Not collective.
    pub fn look_for(&mut self, numbers: &[usize]) {
        let Some(place) = self.place.clone() else { return };
        if self.looked.is_some_and(|looked| looked.elapsed() < LOOK_INTERVAL) {
            return;
        }
        self.looked = Some(Instant::now());
        for &number in numbers {
            if self.done.contains_key(&number) {
                continue;
            }
            // What cannot be read now comes by `share`.
            if let Ok(kept) = read_point(&place.join(point_name(number))) {
                self.add(number, kept.point);
            }
        }
    }

    fn add(&mut self, number: usize, point: PointResult) {
        if self.done.insert(number, point).is_none() {
            self.unreported.insert(number);
        }
    }

    /// The finished points of which this function was not asked before, but those of an earlier run.
    pub fn news(&mut self) -> Vec<(usize, &PointResult)> {
        let numbers = std::mem::take(&mut self.unreported);
        numbers.into_iter().map(|number| (number, &self.done[&number])).collect()
    }

    /// Keeps the derivatives, before the nominal point is committed; the first group writes them. Collective in the
    /// group.
    ///
    /// # Errors
    /// The system's, with the path.
    pub fn keep_gradients(&mut self, gradients: Vec<Gradient>) -> Result<()> {
        self.gradients = gradients;
        let place = self.place.as_ref().filter(|_| self.groups.number() == 0);
        place.map_or(Ok(()), |place| self.keep_binary(&place.join(GRADIENTS), &self.gradients))
    }

    /// The first rank of the group writes it.
    fn keep_binary<T: Serialize>(&self, path: &Path, what: &T) -> Result<()> {
        self.groups.own.agree(if self.groups.own.is_root() { write_binary(path, what) } else { Ok(()) })
    }

    /// Number of points of which there are displacements.
    pub fn n_states(&self) -> usize {
        self.states.len()
    }

    /// Number of this rank's dofs.
    pub fn n_own_dofs(&self) -> usize {
        self.states.values().next().map_or(0, Vec::len)
    }

    /// The displacements of the group's finished point that is nearest to some values, each measured by its scale; the
    /// first of equals.
    pub fn nearest(&self, to: &[f64], scales: &[f64]) -> Option<&[f64]> {
        let distance = |number: usize| -> f64 {
            let own = self.done[&number].values.iter().zip(to).zip(scales);
            own.map(|((a, b), scale)| ((a - b) / scale).powi(2)).sum()
        };
        let all = self.states.iter().map(|(number, state)| (distance(*number), state));
        let nearest = all.reduce(|best, next| if next.0 < best.0 { next } else { best });
        nearest.map(|(_, state)| state.as_slice())
    }

    /// Keeps the nominal modes, before the nominal point is committed; the first group writes them. Collective in the
    /// group.
    ///
    /// # Errors
    /// The system's and HDF5's, with the path.
    pub fn keep_nominal(&self, nominal: &WeightedModes) -> Result<()> {
        let Some(place) = self.place.as_ref().filter(|_| self.groups.number() == 0) else { return Ok(()) };
        let comm = &self.groups.own;
        comm.agree(write_nominal(&place.join(nominal_name(comm)), nominal))
    }

    /// The nominal modes that an earlier run with as many ranks a point has kept, where all ranks can read them.
    /// Collective over all ranks.
    pub fn nominal(&self) -> Option<WeightedModes> {
        let comm = &self.groups.own;
        let place = self.place.as_ref().filter(|_| self.done.contains_key(&0))?;
        self.on_all(read_nominal(comm, &place.join(nominal_name(comm))))
    }
}

/// Whether displacements are kept beside those of so many points. Collective in the group.
fn has_room(groups: &Groups, n_states: usize, state: &[f64]) -> bool {
    let n_dofs = groups.own.sum(state.len());
    n_states < (STATES_BYTES / 8 / n_dofs.max(1) / groups.n_groups()).clamp(1, MAX_STATES)
}

#[cfg(test)]
mod tests;
