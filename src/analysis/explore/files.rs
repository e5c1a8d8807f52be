//! The files of points: their names, and how they are read and written.

use std::path::Path;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::analysis::unfinished;
use crate::explore::PointResult;
use crate::hdf::{self, Format, array, list, values};
use crate::native::{Block, Comm};
use crate::results::Shape;
use crate::{Error, Result};

use super::point::WeightedModes;

const FORMAT: Format = Format { name: "squeal study", version: 1, advice: "Begin again with --force" };

/// A finished point.
#[derive(Serialize, Deserialize)]
pub struct KeptPoint {
    /// Number of files with its displacements: one a rank of the group that solved it.
    pub n_state_files: usize,
    pub point: PointResult,
    /// Shapes of those modes that [`crate::explore::shaped_modes`] names.
    pub shapes: Vec<Shape>,
}

/// File of the derivatives.
pub const GRADIENTS: &str = "gradients.bin";

pub fn point_name(number: usize) -> String {
    format!("point-{number:06}.bin")
}

/// Displacements of this rank, which depend on the number of ranks.
pub fn state_name(number: usize, comm: &Comm) -> String {
    format!("state-{number:06}.{}.{}.h5", comm.size(), comm.rank())
}

pub fn nominal_name(comm: &Comm) -> String {
    format!("nominal.{}.{}.h5", comm.size(), comm.rank())
}

/// All points in a folder, by their numbers, without their shapes. Those that cannot be read are removed, with a
/// warning.
pub fn read_points(place: &Path, warnings: &mut Vec<String>) -> Result<Vec<(usize, KeptPoint)>> {
    let entries = std::fs::read_dir(place).map_err(Error::io(place))?;
    let number = |name: &str| name.strip_prefix("point-")?.strip_suffix(".bin")?.parse().ok();
    let mut numbers: Vec<usize> =
        entries.filter_map(|entry| number(&entry.ok()?.file_name().to_string_lossy())).collect();
    numbers.sort_unstable();
    let mut points = Vec::new();
    for number in numbers {
        let path = place.join(point_name(number));
        match read_point(&path) {
            Ok(kept) => points.push((number, KeptPoint { shapes: Vec::new(), ..kept })),
            Err(_) => {
                warnings.push(format!("{} cannot be read: point {number} is computed again", path.display()));
                std::fs::remove_file(&path).map_err(Error::io(&path))?;
            }
        }
    }
    Ok(points)
}

pub fn read_point(path: &Path) -> Result<KeptPoint> {
    read_binary(path)
}

pub fn read_binary<T: for<'d> Deserialize<'d>>(path: &Path) -> Result<T> {
    unfinished::read_binary(path, &FORMAT)
}

pub fn read_list(path: &Path) -> Result<Vec<f64>> {
    let file = hdf::open(path, &FORMAT)?;
    values(&file, "u").map_err(|reason| hdf::damaged(path, &FORMAT, reason))
}

pub fn read_nominal(comm: &Comm, path: &Path) -> Result<WeightedModes> {
    let file = hdf::open(path, &FORMAT)?;
    let block = |name: &str| -> hdf5::Result<Block> {
        let dataset = file.dataset(name)?;
        let [_, n_local] = dataset.shape()[..] else { return Err(format!("{name} is no table").into()) };
        Ok(Block::from_columns(comm, n_local, dataset.read_raw()?))
    };
    let read = || -> hdf5::Result<WeightedModes> {
        let own: Vec<f64> = values(&file, "own")?;
        let own = own.as_chunks().0.iter().map(|&[re, im]| Complex64::new(re, im)).collect();
        Ok(WeightedModes { left: block("left")?, right: block("right")?, own })
    };
    read().map_err(|reason| hdf::damaged(path, &FORMAT, reason))
}

/// Not collective.
pub fn write_nominal(path: &Path, nominal: &WeightedModes) -> Result<()> {
    let own: Vec<f64> = nominal.own.iter().flat_map(|z| [z.re, z.im]).collect();
    let block = |block: &Block| [block.n_columns(), block.n_local()];
    hdf::create_passing(path, &FORMAT, |file| {
        array(file, "left", &block(&nominal.left), nominal.left.values())?;
        array(file, "right", &block(&nominal.right), nominal.right.values())?;
        list(file, "own", &own)
    })
}

/// Displacements of one rank.
pub fn write_list(path: &Path, state: &[f64]) -> Result<()> {
    hdf::create_passing(path, &FORMAT, |file| list(file, "u", state))
}
