//! What a study of many parameters needs to continue after its process has ended, at whatever moment.
//!
//! ```text
//! .NAME.unfinished/.resume/
//!   study.txt             what the numbers depend on
//!   point-000003.bin      a finished point
//!   state-000003.RANK.h5  its displacements, from which points nearby start
//!   nominal.RANK.h5       vectors of the nominal modes
//!   gradients.bin         their derivatives by the parameters
//! ```
//!
//! Numbers are kept bit by bit, so that a study that was interrupted ends with the same files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::analysis::unfinished::Unfinished;
use crate::explore::{Gradient, PointResult};
use crate::hdf::{self, Format, array, list, values};
use crate::native::{Block, Comm};
use crate::output::files::write_whole;
use crate::output::folder::{self, Folder, RESUME};
use crate::{Error, Result};

use super::point::NominalModes;

const FORMAT: Format = Format { name: "squeal study", version: 1, advice: "Begin again with --force" };

/// A finished point, and whether there are files with its displacements.
#[derive(Serialize, Deserialize)]
struct KeptPoint {
    has_state: bool,
    point: PointResult,
}

/// The finished points of a study, and its files where it has a folder.
pub struct Points {
    comm: Comm,
    place: Option<PathBuf>,
    /// The finished points, the nominal one first.
    pub done: Vec<PointResult>,
    /// Derivatives of the nominal modes by each parameter; none where they are not asked for.
    pub gradients: Vec<Gradient>,
    /// This rank's displacements of points, by their numbers.
    states: BTreeMap<usize, Vec<f64>>,
}

impl Points {
    /// The points that an earlier run has finished. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where another study was begun, or files are damaged; the system's.
    pub fn open(
        comm: &Comm,
        folder: Option<&Folder>,
        target: Option<&Path>,
        identity: &[(&str, String)],
        force: bool,
    ) -> Result<Points> {
        let (done, gradients, states) = (Vec::new(), Vec::new(), BTreeMap::new());
        let mut points = Points { comm: comm.clone(), place: None, done, gradients, states };
        let Some(target) = target else { return Ok(points) };
        let place = folder::unfinished(target)?.join(RESUME);
        let study = Unfinished { target, identity, name: point_name, unit: "points" };
        let check = |n: usize| (0..n).try_for_each(|i| read_point(&place.join(point_name(i))).map(|_| ()));
        let n = folder.map_or(Ok(0), |folder| study.prepare(folder, force, check));
        let n = comm.broadcast_value(0, comm.agree(n)?);
        for number in 0..n {
            let kept = comm.agree(read_point(&place.join(point_name(number))))?;
            if kept.has_state {
                let state = comm.agree(read_list(&place.join(own_name("state", number, comm))))?;
                points.states.insert(number, state);
            }
            points.done.push(kept.point);
        }
        let path = place.join(GRADIENTS);
        points.gradients = comm.agree(if n > 0 && path.exists() { read_binary(&path) } else { Ok(Vec::new()) })?;
        points.place = Some(place);
        Ok(points)
    }

    /// Gives all ranks the points of the first one, where each rank has whole displacements. Collective.
    pub fn share(&mut self, world: &Comm) {
        self.done = world.broadcast_value(0, std::mem::take(&mut self.done));
        self.gradients = world.broadcast_value(0, std::mem::take(&mut self.gradients));
        self.states = world.broadcast_value(0, std::mem::take(&mut self.states));
    }

    /// Keeps a finished point; its displacements, where there is room for them. Collective.
    ///
    /// # Errors
    /// The system's and HDF5's, with the path.
    pub fn commit(&mut self, point: PointResult, state: Option<Vec<f64>>) -> Result<()> {
        let number = self.done.len();
        if let Some(place) = &self.place {
            if let Some(state) = &state {
                let path = place.join(own_name("state", number, &self.comm));
                self.comm.agree(hdf::create_passing(&path, &FORMAT, |file| list(file, "u", state)))?;
            }
            let kept = KeptPoint { has_state: state.is_some(), point: point.clone() };
            self.keep_binary(&place.join(point_name(number)), &kept)?;
        }
        self.done.push(point);
        self.states.extend(state.map(|state| (number, state)));
        Ok(())
    }

    /// Keeps the derivatives, before the nominal point is committed. Collective.
    ///
    /// # Errors
    /// The system's, with the path.
    pub fn keep_gradients(&mut self, gradients: Vec<Gradient>) -> Result<()> {
        self.gradients = gradients;
        self.place.as_ref().map_or(Ok(()), |place| self.keep_binary(&place.join(GRADIENTS), &self.gradients))
    }

    /// The first rank writes it.
    fn keep_binary<T: Serialize>(&self, path: &Path, what: &T) -> Result<()> {
        let write = || {
            let bytes = postcard::to_stdvec(what).map_err(Error::library("postcard"))?;
            write_whole(path, |out| out.write_all(&bytes))
        };
        self.comm.agree(if self.comm.is_root() { write() } else { Ok(()) })
    }

    /// Number of points of which there are displacements.
    pub fn n_states(&self) -> usize {
        self.states.len()
    }

    /// Number of this rank's dofs.
    pub fn n_own_dofs(&self) -> usize {
        self.states.values().next().map_or(0, Vec::len)
    }

    /// The displacements of the finished point that is nearest to some values, each measured by its scale; the first of
    /// equals.
    pub fn nearest(&self, to: &[f64], scales: &[f64]) -> Option<&[f64]> {
        let distance = |number: usize| -> f64 {
            let own = self.done[number].values.iter().zip(to).zip(scales);
            own.map(|((a, b), scale)| ((a - b) / scale).powi(2)).sum()
        };
        let all = self.states.iter().map(|(number, state)| (distance(*number), state));
        let nearest = all.reduce(|best, next| if next.0 < best.0 { next } else { best });
        nearest.map(|(_, state)| state.as_slice())
    }

    /// Keeps the nominal modes, before the nominal point is committed. Collective.
    ///
    /// # Errors
    /// The system's and HDF5's, with the path.
    pub fn keep_nominal(&self, nominal: &NominalModes) -> Result<()> {
        let Some(place) = &self.place else { return Ok(()) };
        let own: Vec<f64> = nominal.own.iter().flat_map(|z| [z.re, z.im]).collect();
        let block = |block: &Block| [block.n_columns(), block.n_local()];
        let written = hdf::create_passing(&place.join(nominal_name(&self.comm)), &FORMAT, |file| {
            array(file, "left", &block(&nominal.left), nominal.left.values())?;
            array(file, "right", &block(&nominal.right), nominal.right.values())?;
            list(file, "own", &own)
        });
        self.comm.agree(written)
    }

    /// The nominal modes that an earlier run has kept. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where the file is damaged.
    pub fn nominal(&self) -> Result<Option<NominalModes>> {
        let path = self.place.as_ref().map(|place| place.join(nominal_name(&self.comm))).filter(|path| path.exists());
        self.comm.agree(path.map(|path| read_nominal(&self.comm, &path)).transpose())
    }
}

/// File of the derivatives.
const GRADIENTS: &str = "gradients.bin";

fn point_name(number: usize) -> String {
    format!("point-{number:06}.bin")
}

fn own_name(what: &str, number: usize, comm: &Comm) -> String {
    format!("{what}-{number:06}.{}.h5", comm.rank())
}

fn nominal_name(comm: &Comm) -> String {
    format!("nominal.{}.h5", comm.rank())
}

fn read_point(path: &Path) -> Result<KeptPoint> {
    read_binary(path)
}

fn read_binary<T: for<'d> Deserialize<'d>>(path: &Path) -> Result<T> {
    let bytes = std::fs::read(path).map_err(Error::io(path))?;
    postcard::from_bytes(&bytes).map_err(|reason| hdf::damaged(path, &FORMAT, reason))
}

fn read_list(path: &Path) -> Result<Vec<f64>> {
    let file = hdf::open(path, &FORMAT)?;
    values(&file, "u").map_err(|reason| hdf::damaged(path, &FORMAT, reason))
}

fn read_nominal(comm: &Comm, path: &Path) -> Result<NominalModes> {
    let file = hdf::open(path, &FORMAT)?;
    let block = |name: &str| -> hdf5::Result<Block> {
        let dataset = file.dataset(name)?;
        let [_, n_local] = dataset.shape()[..] else { return Err(format!("{name} is no table").into()) };
        Ok(Block::from_columns(comm, n_local, dataset.read_raw()?))
    };
    let read = || -> hdf5::Result<NominalModes> {
        let own: Vec<f64> = values(&file, "own")?;
        let own = own.as_chunks().0.iter().map(|&[re, im]| Complex64::new(re, im)).collect();
        Ok(NominalModes { left: block("left")?, right: block("right")?, own })
    };
    read().map_err(|reason| hdf::damaged(path, &FORMAT, reason))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore::{Difference, Link, Outcome, PointMode};
    use crate::native::Session;

    fn point(values: &[f64]) -> PointResult {
        let link = Some(Link { nominal: 2, share: 1.0 / 3.0, doubtful: true });
        let lambda = Complex64::new(0.1, 1e4 / 3.0);
        let mode = PointMode { lambda, unstable: true, backward_error: 1e-13, link };
        PointResult { values: values.to_vec(), outcome: Outcome::Modes(vec![mode]) }
    }

    #[test]
    fn an_earlier_run_is_continued_bit_by_bit() {
        let comm = Session::start(&[]).unwrap();
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("run");
        let folder = Folder::open(&target, false).unwrap();
        let open = |identity: &str, force| {
            Points::open(&comm, Some(&folder), Some(&target), &[("seed", identity.to_owned())], force)
        };
        let mut points = open("1", false).unwrap();
        let nominal = NominalModes {
            left: Block::from_columns(&comm, 2, vec![1.0, 2.0, 3.0, 1.0 / 3.0]),
            right: Block::from_columns(&comm, 2, vec![0.1; 4]),
            own: vec![Complex64::new(0.1, 0.2)],
        };
        points.keep_nominal(&nominal).unwrap();
        let slopes = vec![Complex64::new(1.0 / 3.0, -7.0)];
        points.keep_gradients(vec![Gradient { slopes, difference: Difference::Forward }]).unwrap();
        points.commit(point(&[0.1, 5.0]), Some(vec![1.0 / 7.0])).unwrap();
        points.commit(point(&[0.3, 5.0]), None).unwrap();
        let again = open("1", false).unwrap();
        assert_eq!((&again.done, &again.states), (&points.done, &points.states));
        assert!(again.gradients == points.gradients && again.gradients.len() == 1);
        let kept = again.nominal().unwrap().unwrap();
        assert!(kept.left.values() == nominal.left.values() && kept.own == nominal.own);
        let state = folder.draft().join(".resume/state-000000.0.h5");
        std::fs::rename(&state, state.with_extension("away")).unwrap();
        assert!(open("1", false).is_err(), "a state is missing");
        let message = open("2", false).err().unwrap().to_string();
        assert!(message.contains("2 points are done") && message.contains("seed was 1, is 2"), "{message}");
        std::fs::write(folder.draft().join(".resume/point-000001.bin"), [1, 2]).unwrap();
        assert!(open("1", false).err().unwrap().to_string().contains("damaged"));
        assert!(open("2", true).unwrap().done.is_empty());
    }

    #[test]
    fn a_point_starts_from_the_nearest_one() {
        let comm = Session::start(&[]).unwrap();
        let mut points = Points::open(&comm, None, None, &[], false).unwrap();
        assert_eq!(points.nearest(&[0.2, 5.0], &[1.0, 1.0]), None);
        for (values, state) in [([0.1, 5.0], Some(1.0)), ([0.2, 9.0], Some(2.0)), ([0.2, 5.0], None)] {
            points.commit(point(&values), state.map(|u| vec![u])).unwrap();
        }
        assert_eq!(points.nearest(&[0.2, 5.0], &[1.0, 1.0]), Some(&[1.0][..]));
        assert_eq!(points.nearest(&[0.2, 5.0], &[0.001, 1.0]), Some(&[2.0][..]), "measured by the scales");
        assert_eq!(points.n_states(), 2);
    }
}
