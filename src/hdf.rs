//! What all our HDF5 files share: how they appear, how they are recognised, and how lists, tables and texts are kept.
//!
//! A file has the attributes `format` and `version`, and appears under its name when it is complete. Every array is
//! checksummed (Fletcher-32), and so are the names and attributes (HDF5 1.10's metadata), so that a flipped bit is an
//! error. A text is an array of bytes, UTF-8; the mark of a file is a string of fixed length, as HDF5 keeps those of
//! variable length in a heap without checksums.

use std::os::fd::AsRawFd;
use std::path::{Path, PathBuf};

use hdf5::types::{FixedUnicode, TypeDescriptor};
use hdf5::{Attribute, File, Group, H5Type};
use ndarray::{ArrayView, IxDyn};

use crate::{Error, Result};

/// A kind of file.
pub struct Format {
    /// Its mark.
    pub name: &'static str,
    /// Raised with every change of the layout.
    pub version: i32,
    /// What to do about a file that cannot be read.
    pub advice: &'static str,
}

/// First bytes of every HDF5 file.
const MAGIC: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Bytes of a chunk, about: what is checked and unpacked at a time.
const CHUNK: usize = 1 << 20;

/// Starts the library, which a session does before it starts MPI. HDF5 that meets a running MPI ends itself within
/// MPI_Finalize, where it crashes after a write that failed: a full disc would end the program with a crash for its
/// exit code.
pub fn start() {
    hdf5::sync::sync(|| ());
}

/// Whether a file is HDF5, by its first bytes; false where it cannot be read.
pub fn is_hdf5(path: &Path) -> bool {
    use std::io::Read;
    let mut start = [0; MAGIC.len()];
    std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == MAGIC
}

/// Writes a file, which appears under its name when it is complete, and on the disk. Not collective.
///
/// # Errors
/// The system's and HDF5's, with the path.
pub fn create(path: &Path, format: &Format, body: impl FnOnce(&File) -> hdf5::Result<()>) -> Result<()> {
    create_passing(path, format, body)?;
    std::fs::File::open(path).and_then(|file| file.sync_all()).map_err(Error::io(path))
}

/// The same for a file that a later one makes superfluous: it may be lost where the system itself goes down.
///
/// # Errors
/// The system's and HDF5's, with the path.
pub fn create_passing(path: &Path, format: &Format, body: impl FnOnce(&File) -> hdf5::Result<()>) -> Result<()> {
    let draft = draft(path)?;
    let written = write_draft(&draft, format, body).map_err(|reason| failure(path, &reason));
    let named = written.and_then(|()| std::fs::rename(&draft, path).map_err(Error::io(path)));
    if named.is_err() {
        // Best effort: half a file is of no use.
        let _ = std::fs::remove_file(&draft);
    }
    named
}

/// The name of a file that is not complete yet.
fn draft(path: &Path) -> Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| Error::input(format!("{} has no file name", path.display())))?;
    Ok(path.with_file_name(format!(".{}.partial-{}", name.to_string_lossy(), std::process::id())))
}

/// A name by which HDF5, which takes UTF-8 only, finds a file: its path, or else the system's name of a file that is
/// open.
struct Reachable {
    path: PathBuf,
    _open: Option<std::fs::File>,
}

impl Reachable {
    fn new(path: &Path, open: impl FnOnce(&Path) -> std::io::Result<std::fs::File>) -> std::io::Result<Reachable> {
        if path.to_str().is_some() {
            return Ok(Reachable { path: path.to_owned(), _open: None });
        }
        let file = open(path)?;
        Ok(Reachable { path: format!("/proc/self/fd/{}", file.as_raw_fd()).into(), _open: Some(file) })
    }
}

/// Opens any HDF5 file for reading.
fn open_any(path: &Path) -> hdf5::Result<File> {
    let name = Reachable::new(path, |path| std::fs::File::open(path)).map_err(|reason| reason.to_string())?;
    File::open(&name.path)
}

fn write_draft(path: &Path, format: &Format, body: impl FnOnce(&File) -> hdf5::Result<()>) -> hdf5::Result<()> {
    let name = Reachable::new(path, |path| std::fs::File::create(path)).map_err(|reason| reason.to_string())?;
    let file = File::with_options().with_fapl(|access| access.libver_v110()).create(&name.path)?;
    file.new_attr::<Mark>().create("format")?.write_scalar(&mark(format.name)?)?;
    file.new_attr::<i32>().create("version")?.write_scalar(&format.version)?;
    body(&file)?;
    file.close()
}

/// HDF5's error for a file that it could not write.
fn failure(path: &Path, reason: &hdf5::Error) -> Error {
    let what = "cannot be written. Look at the free space and the permissions there";
    Error::library("HDF5")(format!("{}: {what} ({reason})", path.display()))
}

/// Opens a file of ours. Not collective.
///
/// # Errors
/// [`Error::Input`] where it is missing, damaged, another kind of file or of another version.
pub fn open(path: &Path, format: &Format) -> Result<File> {
    let place = path.display();
    if let Err(reason) = std::fs::File::open(path) {
        return Err(Error::input(format!("{place}: {reason}")));
    }
    if !is_hdf5(path) {
        return Err(Error::input(format!(
            "{place} is not a file of the kind \"{}\", nor any other HDF5 file",
            format.name
        )));
    }
    let file = open_any(path).map_err(|reason| damaged(path, format, reason))?;
    let name = file.attr("format").and_then(|attribute| read_mark(&attribute));
    if name.map_or(true, |name| name != format.name) {
        let what = format!("{place} is an HDF5 file, but not of the kind \"{}\", or of an early version", format.name);
        return Err(Error::input(format!("{what}. {}", format.advice)));
    }
    let version: i32 =
        file.attr("version").and_then(|a| a.read_scalar()).map_err(|reason| damaged(path, format, reason))?;
    if version == format.version {
        return Ok(file);
    }
    Err(Error::input(format!(
        "{place} is of version {version}, this program reads version {}. {}",
        format.version, format.advice
    )))
}

/// Whether a file is of a kind, of whatever version. Not collective.
pub fn is_of(path: &Path, format: &Format) -> bool {
    let name = || open_any(path).and_then(|file| read_mark(&file.attr("format")?));
    is_hdf5(path) && name().is_ok_and(|name| name == format.name)
}

/// The error for a file that HDF5 cannot read to its end, or that does not fit together.
pub fn damaged(path: &Path, format: &Format, reason: impl std::fmt::Display) -> Error {
    Error::input(format!("{} is incomplete or damaged: {reason}. {}", path.display(), format.advice))
}

/// The mark of a file.
type Mark = FixedUnicode<64>;

fn mark(name: &str) -> hdf5::Result<Mark> {
    name.parse().map_err(|reason| hdf5::Error::from(format!("{reason:?}")))
}

/// The mark of a file; an error where it is no string of fixed length. One of variable length stands in a heap without
/// checksums, where a flipped bit makes HDF5 read beyond its memory.
fn read_mark(attribute: &Attribute) -> hdf5::Result<String> {
    match attribute.dtype()?.to_descriptor()? {
        TypeDescriptor::FixedUnicode(_) => attribute.read_scalar::<Mark>().map(|name| name.to_string()),
        _ => Err("its mark is not a string of fixed length".into()),
    }
}

/// Writes a text.
///
/// # Errors
/// HDF5's, as of everything here.
pub fn text(group: &Group, name: &str, text: &str) -> hdf5::Result<()> {
    list(group, name, text.as_bytes())
}

/// Writes a list.
///
/// # Errors
/// HDF5's.
pub fn list<T: H5Type>(group: &Group, name: &str, values: &[T]) -> hdf5::Result<()> {
    array(group, name, &[values.len()], values)
}

/// Writes rows of so many values.
///
/// # Errors
/// HDF5's.
pub fn table<T: H5Type>(group: &Group, name: &str, width: usize, values: &[T]) -> hdf5::Result<()> {
    array(group, name, &[values.len() / width.max(1), width], values)
}

/// Writes an array, the last index running fastest.
///
/// # Errors
/// HDF5's; where the values do not fill the shape.
pub fn array<T: H5Type>(group: &Group, name: &str, shape: &[usize], values: &[T]) -> hdf5::Result<()> {
    let view = ArrayView::from_shape(IxDyn(shape), values).map_err(|reason| hdf5::Error::from(reason.to_string()))?;
    let builder = group.new_dataset_builder().with_data(view);
    // What is empty has no chunks.
    let builder = if values.is_empty() { builder } else { builder.chunk(chunk::<T>(shape)).fletcher32() };
    builder.create(name).map(|_| ())
}

/// Writes an array of rows that come one after the other, so that they need not be in memory at the same time.
///
/// # Errors
/// HDF5's; those of the rows; where the rows do not fill the shape.
pub fn array_of_rows<T: H5Type>(
    group: &Group,
    name: &str,
    shape: [usize; 4],
    rows: impl Iterator<Item = hdf5::Result<Vec<T>>>,
) -> hdf5::Result<()> {
    let [n, own @ ..] = shape;
    if shape.contains(&0) {
        return array::<T>(group, name, &shape, &[]);
    }
    // A chunk has one row at most, so that none is written twice.
    let chunk = chunk::<T>(&[1, own[0], own[1], own[2]]);
    let dataset = group.new_dataset::<T>().shape(shape).chunk(chunk).fletcher32().create(name)?;
    let mut n_written = 0;
    for (i, row) in rows.enumerate() {
        let row = row?;
        let view = ArrayView::from_shape(own, &row).map_err(|reason| hdf5::Error::from(reason.to_string()))?;
        dataset.write_slice(view, ndarray::s![i, .., .., ..])?;
        n_written += 1;
    }
    if n_written == n { Ok(()) } else { Err(format!("{name} has {n_written} of {n} rows").into()) }
}

/// As many rows as fill a chunk; parts of one where it is longer.
fn chunk<T>(shape: &[usize]) -> Vec<usize> {
    let mut n_left = (CHUNK / size_of::<T>().max(1)).max(1);
    let mut chunk = vec![1; shape.len()];
    for (length, &n) in chunk.iter_mut().zip(shape).rev() {
        *length = n.clamp(1, n_left);
        n_left /= *length;
        n_left = n_left.max(1);
    }
    chunk
}

/// All values of an array.
///
/// # Errors
/// HDF5's.
pub fn values<T: H5Type>(group: &Group, name: &str) -> hdf5::Result<Vec<T>> {
    let dataset = group.dataset(name)?;
    // Nothing is compressed: what the file does not have is not allocated.
    if dataset.size() as u64 * size_of::<T>() as u64 > dataset.storage_size() {
        return Err(format!("{name} is not all there").into());
    }
    dataset.read_raw()
}

/// The rows of a table of three columns.
///
/// # Errors
/// HDF5's.
pub fn triples<T: H5Type + Copy>(group: &Group, name: &str) -> hdf5::Result<Vec<[T; 3]>> {
    let flat: Vec<T> = values(group, name)?;
    Ok(flat.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect())
}

/// A text.
///
/// # Errors
/// HDF5's; where it is not UTF-8.
pub fn read_text(group: &Group, name: &str) -> hdf5::Result<String> {
    String::from_utf8(values(group, name)?).map_err(|reason| hdf5::Error::from(format!("{name}: {reason}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use hdf5::types::VarLenUnicode;

    const FORMAT: Format = Format { name: "a test of squeal", version: 3, advice: "Write it again" };

    fn reason(path: &Path, format: &Format) -> String {
        open(path, format).err().unwrap().to_string()
    }

    #[test]
    fn a_file_is_known_by_its_mark_and_version() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        create(&path, &FORMAT, |file| list(file, "x", &[1.0, 2.0])).unwrap();
        assert_eq!(values::<f64>(&open(&path, &FORMAT).unwrap(), "x").unwrap(), [1.0, 2.0]);
        assert!(reason(&path, &Format { name: "another", ..FORMAT }).contains("not of the kind \"another\""));
        assert!(reason(&path, &Format { version: 4, ..FORMAT }).contains("of version 3"));
    }

    /// HDF5 would crash where a bit of its length is flipped.
    #[test]
    fn a_mark_of_variable_length_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        let file = File::create(&path).unwrap();
        let name: VarLenUnicode = FORMAT.name.parse().unwrap();
        file.new_attr::<VarLenUnicode>().create("format").unwrap().write_scalar(&name).unwrap();
        file.new_attr::<i32>().create("version").unwrap().write_scalar(&FORMAT.version).unwrap();
        file.close().unwrap();
        assert!(reason(&path, &FORMAT).contains("or of an early version. Write it again") && !is_of(&path, &FORMAT));
    }

    #[test]
    fn rows_that_come_one_after_the_other_are_an_array() {
        let folder = tempfile::tempdir().unwrap();
        let write = |shape: [usize; 4], n: usize| {
            let rows = (0..n).map(|i| Ok(vec![i as f32; 4]));
            create(&folder.path().join("a.h5"), &FORMAT, |file| array_of_rows(file, "x", shape, rows))
        };
        write([2, 1, 2, 2], 2).unwrap();
        let read = || values::<f32>(&open(&folder.path().join("a.h5"), &FORMAT).unwrap(), "x").unwrap();
        assert_eq!(read(), [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
        assert!(write([3, 1, 2, 2], 2).is_err() && write([1, 1, 2, 2], 2).is_err() && write([2, 1, 3, 2], 2).is_err());
        write([0, 5, 3, 2], 0).unwrap();
        assert!(read().is_empty());
    }

    #[test]
    fn a_file_is_recognised_by_its_mark() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        create(&path, &FORMAT, |file| list(file, "x", &[1.0])).unwrap();
        assert!(is_of(&path, &FORMAT));
        assert!(!is_of(&path, &Format { name: "another kind", ..FORMAT }));
        std::fs::write(&path, "no HDF5").unwrap();
        assert!(!is_of(&path, &FORMAT));
    }

    #[test]
    fn a_flipped_bit_is_an_error_or_does_no_harm() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        create(&path, &FORMAT, |file| list(file, "x", &[1.0, 2.0])).unwrap();
        let whole = std::fs::read(&path).unwrap();
        for (at, bit) in (0..whole.len()).flat_map(|at| [(at, 0), (at, 5)]) {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << bit;
            std::fs::write(&path, bytes).unwrap();
            let read = open(&path, &FORMAT).map(|file| values::<f64>(&file, "x"));
            if let Ok(Ok(x)) = read {
                assert_eq!(x, [1.0, 2.0], "byte {at}, bit {bit}");
            }
        }
    }
}
