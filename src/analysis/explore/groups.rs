//! Groups of ranks, each of which solves points of its own.
//!
//! A group takes the next point that no other one has taken, so that none waits while there are points left: points
//! differ in what they take. It takes a point by a file in the study's folder, which can be created once; so no rank
//! has to answer the others while it computes. A study without a folder gives points to the groups in turn.

use std::cell::Cell;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::native::Comm;
use crate::{Error, Result};

/// All ranks of a study, and those of a point.
#[derive(Clone)]
pub struct Groups {
    /// All ranks.
    pub world: Comm,
    /// The ranks of this rank's group, which solve a point together.
    pub own: Comm,
}

impl Groups {
    /// Groups of so many ranks. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where the ranks cannot be divided so.
    pub fn new(world: &Comm, n_ranks: usize) -> Result<Groups> {
        let n = world.size();
        if n_ranks == 0 || !n.is_multiple_of(n_ranks) {
            let divisors: Vec<String> = (1..=n).filter(|i| n.is_multiple_of(*i)).map(|i| i.to_string()).collect();
            return Err(Error::input(format!(
                "{n_ranks} ranks per point: the {n} ranks of this run cannot be divided into groups of {n_ranks}. Give \
                 --ranks-per-point one of {}, or another number of ranks to mpirun",
                divisors.join(", ")
            )));
        }
        let own = if n_ranks == n { world.clone() } else { world.groups_of(n_ranks) };
        Ok(Groups { world: world.clone(), own })
    }

    /// Number of groups.
    pub fn n_groups(&self) -> usize {
        self.world.size() / self.own.size()
    }

    /// The number of this rank's group, from 0.
    pub fn number(&self) -> usize {
        self.world.rank() / self.own.size()
    }

    /// A result on which all ranks agree. An error of one rank of a group, for which the rest of the group waits, is
    /// returned at once: it has to end all ranks. Collective.
    ///
    /// # Errors
    /// That of any rank.
    pub fn agree<T>(&self, result: Result<T>) -> Result<T> {
        match result {
            Err(error) if ends_at_once(self.own.size(), &error) => Err(error),
            result => self.world.agree(result),
        }
    }

    /// The same after groups that may need hours: calls `meanwhile` again and again until all ranks have a result.
    /// Collective.
    ///
    /// # Errors
    /// That of any rank.
    pub fn agree_after<T>(&self, result: Result<T>, meanwhile: impl FnMut()) -> Result<T> {
        if !result.as_ref().is_err_and(|error| ends_at_once(self.own.size(), error)) {
            self.world.barrier_with(meanwhile);
        }
        self.agree(result)
    }

    /// The first group's value on all ranks: each rank gets that of the rank of the same number in the first group.
    /// Collective.
    pub fn first_groups<T: Serialize + DeserializeOwned>(&self, own: T) -> T {
        let (n, number) = (self.own.size(), self.own.rank());
        if self.number() > 0 {
            return self.world.receive_value(number);
        }
        (1..self.n_groups()).for_each(|group| self.world.send_value(&own, group * n + number));
        own
    }

    /// The values of all groups, one group's after the other's, on every rank. Collective.
    pub fn join<T: Serialize + DeserializeOwned>(&self, own: Vec<T>) -> Vec<T> {
        let own = if self.own.is_root() { own } else { Vec::new() };
        self.world.join_values(own).into_iter().flatten().collect()
    }
}

/// Whether an error of a rank ends all ranks, as the other ones of its group may wait for it.
fn ends_at_once(n_ranks: usize, error: &Error) -> bool {
    n_ranks > 1 && !error.is_of_all_ranks()
}

/// Folder of the files by which groups take points.
const TAKEN: &str = "taken";
/// The file in it that ends the work of all groups.
const STOP: &str = "stop";

/// What gives points to the groups.
pub struct Turns {
    number: usize,
    n_groups: usize,
    place: Option<PathBuf>,
    is_stopped: Cell<bool>,
}

impl Turns {
    /// Removes what an earlier run has taken. Not collective.
    ///
    /// # Errors
    /// The system's, with the path.
    pub fn clear(place: &Path) -> Result<()> {
        let place = place.join(TAKEN);
        let removed = if place.exists() { fs::remove_dir_all(&place) } else { Ok(()) };
        removed.and_then(|()| fs::create_dir_all(&place)).map_err(Error::io(&place))
    }

    /// Checks that the first rank of each group sees the folder by which groups take points. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where one does not.
    pub fn require_shared(groups: &Groups, place: &Path) -> Result<()> {
        let needs = groups.n_groups() > 1 && groups.own.is_root();
        groups.world.agree(if needs { require_seen(place, groups.world.rank()) } else { Ok(()) })
    }

    /// Those of groups whose study has this folder for its points.
    pub fn new(groups: &Groups, place: Option<&Path>) -> Turns {
        let place = place.filter(|_| groups.n_groups() > 1).map(|place| place.join(TAKEN));
        Turns { number: groups.number(), n_groups: groups.n_groups(), place, is_stopped: Cell::new(false) }
    }

    /// Whether this rank's group has the point from now on. Not collective.
    ///
    /// # Errors
    /// The system's, with the path.
    pub fn take(&self, point: usize) -> Result<bool> {
        let Some(place) = &self.place else { return Ok(point % self.n_groups == self.number && !self.is_stopped()) };
        let path = place.join(format!("{point:06}"));
        if self.is_stopped() {
            return Ok(false);
        }
        match File::create_new(&path) {
            Ok(_) => Ok(true),
            Err(reason) if reason.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(reason) => Err(Error::io(&path)(reason)),
        }
    }

    /// Ends the work: no group takes another point. Without a folder only this rank's group stops. Not collective.
    pub fn stop(&self) {
        self.is_stopped.set(true);
        // Where this fails, the other groups finish their points.
        let _ = self.place.as_ref().map(|place| File::create(place.join(STOP)));
    }

    /// Whether no group takes another point. Not collective.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.get() || self.place.as_ref().is_some_and(|place| place.join(STOP).exists())
    }

    /// Whether other groups finish points whose files can be read. Not collective.
    pub fn has_others(&self) -> bool {
        self.place.is_some()
    }
}

fn require_seen(place: &Path, rank: usize) -> Result<()> {
    if place.join(TAKEN).is_dir() {
        return Ok(());
    }
    let what = format!("rank {rank} does not see {}", place.join(TAKEN).display());
    Err(Error::input(format!("{what}; all machines need the same file system")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    fn turns(number: usize, place: Option<PathBuf>) -> Turns {
        Turns { number, n_groups: 2, place, is_stopped: Cell::new(false) }
    }

    #[test]
    fn a_point_is_taken_once_until_the_folder_is_cleared() {
        let place = tempfile::tempdir().unwrap();
        Turns::clear(place.path()).unwrap();
        let groups = [0, 1].map(|number| turns(number, Some(place.path().join(TAKEN))));
        let take = |group: usize, point| groups[group].take(point).unwrap();
        assert_eq!([take(1, 0), take(0, 0), take(0, 1), take(1, 1)], [true, false, true, false]);
        groups[0].stop();
        assert!(groups[1].is_stopped() && !take(1, 2), "one group stops all");
        Turns::clear(place.path()).unwrap();
        assert!(turns(1, Some(place.path().join(TAKEN))).take(0).unwrap());
        assert!(turns(0, Some(place.path().join("none"))).take(0).is_err());
        require_seen(place.path(), 3).unwrap();
        let message = require_seen(&place.path().join("none"), 3).unwrap_err().to_string();
        assert!(message.contains("rank 3 does not see") && message.contains("the same file system"), "{message}");
    }

    #[test]
    fn without_a_folder_points_are_given_in_turn() {
        let groups = [turns(0, None), turns(1, None)];
        let taken = |group: usize| (0..5).filter(|&point| groups[group].take(point).unwrap()).collect::<Vec<_>>();
        assert_eq!([taken(0), taken(1)], [vec![0, 2, 4], vec![1, 3]]);
        groups[0].stop();
        assert!(taken(0).is_empty() && !groups[1].is_stopped());
    }

    #[test]
    fn ranks_that_cannot_be_divided_are_refused() {
        let comm = Session::start(&[]).unwrap();
        let message = |n| Groups::new(&comm, n).err().unwrap().to_string();
        assert!(message(3).contains("the 1 ranks of this run cannot be divided into groups of 3"), "{}", message(3));
        assert!(message(0).contains("one of 1,"));
        let groups = Groups::new(&comm, 1).unwrap();
        assert_eq!((groups.n_groups(), groups.number(), groups.join(vec![7_u64])), (1, 0, vec![7]));
    }

    #[test]
    fn an_error_of_one_rank_alone_is_not_agreed_on_in_a_group() {
        let (own, alike) = (Error::library("x")("y"), Error::input("x"));
        let agreed = Error::Agreed { kind: own.kind(), text: own.to_string() };
        assert!(ends_at_once(2, &own) && !ends_at_once(1, &own));
        assert!(!ends_at_once(2, &alike) && !ends_at_once(2, &agreed));
    }

    #[test]
    fn one_group_has_its_own_value_and_waits_for_nobody() {
        let groups = Groups::new(&Session::start(&[]).unwrap(), 1).unwrap();
        assert_eq!((groups.agree(Ok(1)).unwrap(), groups.first_groups(2)), (1, 2));
        assert!(groups.agree_after::<()>(Err(Error::input("x")), || ()).is_err());
    }
}
