//! What a study needs to continue after its process has ended, at whatever moment.
//!
//! ```text
//! .NAME.unfinished/.resume/
//!   study.txt                 what the numbers depend on, a line each: a run that differs does not continue
//!   value-0003.h5             a finished value: its group of the results file, and the eigenvalues for tracking
//!   files-0003.txt            all files of results so far with their bytes
//!   path-0003.RANK.h5         the last equilibria of the path that ends there
//!   vectors-0003.RANK.h5      right and left vectors of a snapshot that tracking still needs, single precision,
//!                             and its equilibrium
//!   products-0003-0005.h5     products of two snapshots' vectors
//! ```
//!
//! Every file appears when it is complete, a value after all that it needs. So the values in the folder are what is
//! done, and tracking that begins again is given their eigenvalues and products until it needs what no file has: there
//! it continues with a solve. Vectors that tracking has dropped have gone with the next value, as all their products
//! are known.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::rc::Weak;

use hdf5::Group;
use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::hdf::{self, Format, array, list, table, values};
use crate::native::{Block, Comm, Vector};
use crate::output::files::write_file;
use crate::output::folder::Folder;
use crate::output::overwrite::entries;
use crate::results::{Value, file};
use crate::{Error, Result};

use super::family::{Snapshot, Spectrum};
use super::sweep::Sweep;
use super::unfinished::Unfinished;

const FORMAT: Format = Format { name: "squeal checkpoint", version: 2, advice: "Begin again with --force" };

/// What an analysis over friction finishes one by one.
pub const UNIT: &str = "friction values";

/// A finished value as an earlier run has left it.
pub struct EarlierValue {
    pub value: Value,
    /// Where modes are followed.
    spectrum: Option<Spectrum>,
}

/// The files from which a study can continue.
pub struct Checkpoint {
    comm: Comm,
    folder: PathBuf,
    /// Friction values that an earlier run has finished.
    n_earlier: usize,
    n_done: usize,
    /// Snapshots of which there are vectors.
    kept: Vec<(usize, Weak<()>)>,
}

impl Checkpoint {
    /// Opens the checkpoint of an unfinished folder, which the root has, and gives what is done. A folder that was
    /// begun with another `identity` (name and value of all that the numbers depend on) is emptied with `force`.
    /// Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where another study was begun, or files are damaged; the system's.
    pub fn open(
        comm: &Comm,
        folder: Option<&Folder>,
        target: &Path,
        identity: &[(&str, String)],
        force: bool,
    ) -> Result<(Checkpoint, VecDeque<EarlierValue>)> {
        let study = Unfinished { target, identity, name: value_name, unit: UNIT };
        let check = |place: &Path, n: usize| {
            require_files(place, n - 1)?;
            (0..n).try_for_each(|i| read_value(&place.join(value_name(i))).map(|_| ()))
        };
        let (place, n_earlier) = study.open(comm, folder, force, check)?;
        let earlier = comm.agree((0..n_earlier).map(|i| read_value(&place.join(value_name(i)))).collect())?;
        Ok((Checkpoint { comm: comm.clone(), folder: place, n_earlier, n_done: 0, kept: Vec::new() }, earlier))
    }

    /// Counts a value of an earlier run as done, and gives its snapshot.
    pub fn replay(&mut self, earlier: &mut EarlierValue) -> Option<Snapshot> {
        let number = self.n_done;
        self.n_done += 1;
        let snapshot = Snapshot::kept(number, earlier.spectrum.take()?);
        self.kept.push((number, snapshot.life()));
        Some(snapshot)
    }

    /// Keeps a finished value with the sweep's path to it and the snapshot where modes are followed, which gets its
    /// number, and removes what is needed no more. Collective.
    ///
    /// # Errors
    /// The system's and HDF5's, with the path.
    pub fn commit(&mut self, value: &Value, sweep: &Sweep, mut snapshot: Option<&mut Snapshot>) -> Result<()> {
        let number = self.n_done;
        self.comm.agree(self.require_folder(number))?;
        snapshot.as_mut().into_iter().for_each(|snapshot| snapshot.number = number);
        let snapshot = snapshot.as_deref();
        self.comm.agree(self.write_own(number, sweep, snapshot))?;
        let spectrum = snapshot.map(Snapshot::spectrum);
        let file = self.folder.join(value_name(number));
        let write = || self.write_list(number).and_then(|()| write_value(&file, value, spectrum));
        self.comm.agree(if self.comm.is_root() { write() } else { Ok(()) })?;
        self.n_done += 1;
        self.kept.extend(snapshot.map(|snapshot| (number, snapshot.life())));
        self.tidy(number);
        Ok(())
    }

    /// Writes what each rank has its own part of.
    fn write_own(&self, number: usize, sweep: &Sweep, snapshot: Option<&Snapshot>) -> Result<()> {
        let states = sweep.states();
        let local = states.iter().map(|(_, u)| u.to_vec()).collect::<Result<Vec<_>>>()?;
        let friction_values: Vec<f64> = states.iter().map(|(friction, _)| *friction).collect();
        hdf::create_passing(&self.own("path", number), &FORMAT, |file| {
            list(file, "friction_values", &friction_values)?;
            table(file, "u", local.first().map_or(0, Vec::len), &local.concat())
        })?;
        let Some(vectors) = snapshot.and_then(Snapshot::vectors) else { return Ok(()) };
        hdf::create_passing(&self.own("vectors", number), &FORMAT, |file| {
            write_block(file, "right", &vectors.right)?;
            write_block(file, "left", &vectors.left)?;
            list(file, "u", local.last().map_or(&[], Vec::as_slice))
        })
    }

    /// Refuses to go on where what the value before has left is gone.
    fn require_folder(&self, number: usize) -> Result<()> {
        if !self.comm.is_root() || number == 0 || self.folder.join(list_name(number - 1)).exists() {
            return Ok(());
        }
        let what = "has been removed or emptied while this run was writing it";
        Err(Error::input(format!("{} {what}. Give the command again", draft(&self.folder).display())))
    }

    /// Writes which files of results there are.
    fn write_list(&self, number: usize) -> Result<()> {
        let draft = draft(&self.folder);
        let size = |name: &String| draft.join(name).metadata().map_err(Error::io(&draft)).map(|data| data.len());
        let lines =
            entries(&draft)?.iter().map(|name| Ok(format!("{}\t{name}\n", size(name)?))).collect::<Result<String>>()?;
        write_file(&self.folder.join(list_name(number)), |out| out.write_all(lines.as_bytes()))
    }

    /// Removes, best effort, the path to the value before and the vectors of snapshots that live no more.
    fn tidy(&mut self, number: usize) {
        if number > 0 {
            let _ = std::fs::remove_file(self.own("path", number - 1));
            let _ = std::fs::remove_file(self.folder.join(list_name(number - 1)));
        }
        let (alive, dead) = std::mem::take(&mut self.kept).into_iter().partition(|(_, life)| life.strong_count() > 0);
        self.kept = alive;
        for (number, _) in dead as Vec<(usize, Weak<()>)> {
            let _ = std::fs::remove_file(self.own("vectors", number));
        }
    }

    /// The last equilibria of the path to the last finished value, each with its friction coefficient. `like` has the
    /// system's layout. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where the file is damaged.
    pub fn path(&self, like: &Vector) -> Result<Vec<(f64, Vector)>> {
        let path = self.own("path", self.n_done - 1);
        let read = read(&path, |file| Ok((values::<f64>(file, "friction_values")?, values::<f64>(file, "u")?)));
        let (friction_values, u) = self.comm.agree(read.and_then(|(friction_values, u)| {
            if u.len() == friction_values.len() * like.n_local() {
                return Ok((friction_values, u));
            }
            Err(hdf::damaged(&path, &FORMAT, "it is of another numbering of the equations"))
        }))?;
        let state = |(i, friction): (usize, f64)| {
            let n = like.n_local();
            Ok((friction, Vector::from_local(&self.comm, &u[i * n..(i + 1) * n])?))
        };
        friction_values.into_iter().enumerate().map(state).collect()
    }

    /// Right and left vectors of a snapshot, and its equilibrium. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where the file is damaged.
    pub fn vectors(&self, number: usize) -> Result<([Block; 2], Vector)> {
        let path = self.own("vectors", number);
        let parts = |file: &Group| {
            Ok((
                [read_block(&self.comm, file, "right")?, read_block(&self.comm, file, "left")?],
                values::<f64>(file, "u")?,
            ))
        };
        let (blocks, u) = self.comm.agree(read(&path, parts))?;
        Ok((blocks, Vector::from_local(&self.comm, &u)?))
    }

    /// Products that an earlier run has kept. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where the file is damaged.
    pub fn products(&self, numbers: [usize; 2]) -> Result<Option<DMatrix<Complex64>>> {
        if numbers.iter().any(|&number| number >= self.n_earlier) {
            return Ok(None);
        }
        let path = self.folder.join(products_name(numbers));
        let known = if self.comm.is_root() && path.exists() {
            read(&path, |file| Ok([values::<f64>(file, "rows")?, values::<f64>(file, "products")?].concat()))
        } else {
            Ok(Vec::new())
        };
        let numbers = self.comm.broadcast(0, self.comm.agree(known)?);
        let Some((&rows, products)) = numbers.split_first() else { return Ok(None) };
        let products: Vec<Complex64> = products.as_chunks().0.iter().map(|&[re, im]| Complex64::new(re, im)).collect();
        let rows = rows as usize;
        Ok(Some(DMatrix::from_vec(rows, products.len() / rows.max(1), products)))
    }

    /// Keeps products. Collective.
    ///
    /// # Errors
    /// The system's and HDF5's, with the path.
    pub fn keep_products(&self, numbers: [usize; 2], products: &DMatrix<Complex64>) -> Result<()> {
        let path = self.folder.join(products_name(numbers));
        let flat: Vec<f64> = products.iter().flat_map(|z| [z.re, z.im]).collect();
        let write = || {
            hdf::create_passing(&path, &FORMAT, |file| {
                list(file, "rows", &[products.nrows() as f64])?;
                table(file, "products", 2, &flat)
            })
        };
        self.comm.agree(if self.comm.is_root() { write() } else { Ok(()) })
    }

    fn own(&self, what: &str, number: usize) -> PathBuf {
        self.folder.join(format!("{what}-{number:04}.{}.h5", self.comm.rank()))
    }
}

fn value_name(number: usize) -> String {
    format!("value-{number:04}.h5")
}

fn list_name(number: usize) -> String {
    format!("files-{number:04}.txt")
}

/// The unfinished folder whose checkpoint stands in `place`.
fn draft(place: &Path) -> PathBuf {
    place.parent().map_or_else(PathBuf::new, Path::to_owned)
}

fn products_name([left, right]: [usize; 2]) -> String {
    format!("products-{left:04}-{right:04}.h5")
}

/// Refuses an unfinished folder in which files of finished values are missing, or have another length.
fn require_files(place: &Path, last: usize) -> Result<()> {
    let list = place.join(list_name(last));
    let refused =
        |path: &Path, what: &str| Err(Error::input(format!("{} {what}. Use --force to begin again", path.display())));
    let Ok(text) = std::fs::read_to_string(&list) else { return refused(&list, "is missing or damaged") };
    for (size, name) in text.lines().filter_map(|line| line.split_once('\t')) {
        let path = draft(place).join(name);
        let is_whole = path.metadata().is_ok_and(|data| size.parse() == Ok(data.len()));
        if !is_whole {
            return refused(&path, "is missing or has another length than the run that began here has written");
        }
    }
    Ok(())
}

fn write_value(path: &Path, value: &Value, spectrum: Option<&Spectrum>) -> Result<()> {
    hdf::create_passing(path, &FORMAT, |file| {
        file::write_value(&file.create_group("value")?, value)?;
        let Some(Spectrum { lambdas, places }) = spectrum else { return Ok(()) };
        let group = file.create_group("spectrum")?;
        table(&group, "lambdas", 2, &lambdas.iter().flat_map(|z| [z.re, z.im]).collect::<Vec<_>>())?;
        list(&group, "places", &places.iter().map(|(place, _)| *place as u32).collect::<Vec<_>>())?;
        list(&group, "conjugate", &places.iter().map(|(_, conjugate)| u8::from(*conjugate)).collect::<Vec<_>>())
    })
}

fn read_value(path: &Path) -> Result<EarlierValue> {
    read(path, |file| {
        let value = file::read_value(&file.group("value")?)?;
        let spectrum = file.link_exists("spectrum").then(|| read_spectrum(&file.group("spectrum")?)).transpose()?;
        Ok(EarlierValue { value, spectrum })
    })
}

fn read_spectrum(group: &Group) -> hdf5::Result<Spectrum> {
    let lambdas: Vec<f64> = values(group, "lambdas")?;
    let (places, conjugate): (Vec<u32>, Vec<u8>) = (values(group, "places")?, values(group, "conjugate")?);
    Ok(Spectrum {
        lambdas: lambdas.as_chunks().0.iter().map(|&[re, im]| Complex64::new(re, im)).collect(),
        places: places.iter().zip(conjugate).map(|(&place, conjugate)| (place as usize, conjugate != 0)).collect(),
    })
}

/// Opens a file and reads from it.
fn read<T>(path: &Path, body: impl FnOnce(&Group) -> hdf5::Result<T>) -> Result<T> {
    let file = hdf::open(path, &FORMAT)?;
    body(&file).map_err(|reason| hdf::damaged(path, &FORMAT, reason))
}

fn read_block(comm: &Comm, group: &Group, name: &str) -> hdf5::Result<Block> {
    let dataset = group.dataset(name)?;
    let [n_columns, n_local] = dataset.shape()[..] else { return Err(format!("{name} is no table").into()) };
    let mut block = Block::zeros(comm, n_local, n_columns);
    let values: Vec<f32> = dataset.read_raw()?;
    block.values_mut().iter_mut().zip(values).for_each(|(to, from)| *to = f64::from(from));
    Ok(block)
}

fn write_block(group: &Group, name: &str, block: &Block) -> hdf5::Result<()> {
    let values: Vec<f32> = block.values().iter().map(|&x| x as f32).collect();
    array(group, name, &[block.n_columns(), block.n_local()], &values)
}
