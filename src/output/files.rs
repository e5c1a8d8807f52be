//! Files that appear whole or not at all, and what is behind symbolic links.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// Part of the name of a file that is not complete yet.
pub const PARTIAL: &str = ".partial-";

/// Writes a file, and the folders to it where they are missing.
///
/// # Errors
/// The system's, with the file's path.
pub fn write_file(path: &Path, body: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(Error::io(parent))?;
    }
    let mut out = BufWriter::new(File::create(path).map_err(Error::io(path))?);
    body(&mut out).and_then(|()| out.flush()).map_err(Error::io(path))
}

/// Writes a file that appears under its name when it is complete, and on the disk. Where that fails, what was there
/// before is untouched. A symbolic link stays; the file behind it is replaced.
///
/// # Errors
/// The system's, with the file's path.
pub fn write_whole(path: &Path, body: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    let target = behind_link(path);
    let name = target.file_name().ok_or_else(|| Error::input(format!("{} is no name of a file", path.display())))?;
    let draft = target.with_file_name(format!(".{}{PARTIAL}{}", name.to_string_lossy(), std::process::id()));
    let named = || File::open(&draft)?.sync_data().and_then(|()| fs::rename(&draft, &target));
    write_file(&draft, body).and_then(|()| named().map_err(Error::io(path))).inspect_err(|_| {
        // Best effort: half a file is of no use to anyone.
        let _ = fs::remove_file(&draft);
    })
}

/// The place that a symbolic link points to; any other path is its own place.
pub fn behind_link(path: &Path) -> PathBuf {
    match path.is_symlink() {
        true => fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()),
        false => path.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("page.html");
        write_whole(&file, |out| out.write_all(b"first")).unwrap();
        let full =
            |out: &mut dyn Write| out.write_all(b"half").and_then(|()| Err(std::io::ErrorKind::StorageFull.into()));
        assert!(write_whole(&file, full).is_err());
        assert_eq!(fs::read(&file).unwrap(), b"first");
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1, "no draft is left");
    }

    #[test]
    fn a_link_stays_and_the_file_behind_it_is_replaced() {
        let place = tempfile::tempdir().unwrap();
        let (file, link) = (place.path().join("far.html"), place.path().join("near.html"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_whole(&link, |out| out.write_all(b"new")).unwrap();
        assert!(link.is_symlink() && fs::read(&file).unwrap() == b"new");
    }
}
