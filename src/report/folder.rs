//! The folder of a run: it appears as a whole or not at all.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// A results folder under construction: files go to a hidden neighbour that takes the folder's name at the end.
pub struct Folder {
    target: PathBuf,
    draft: PathBuf,
    done: bool,
}

/// Marks a folder as one of ours, which `--force` may replace.
const MARK: &str = "summary.txt";

impl Folder {
    /// Starts a folder; nothing is created at `target` yet.
    ///
    /// # Errors
    /// [`Error::Input`] where `target` holds something already, unless it is an earlier run's and `force` is set.
    pub fn create(target: &Path, force: bool) -> Result<Folder> {
        Self::may_write(target, force)?;
        let name = target
            .file_name()
            .and_then(|name| name.to_str())
            .ok_or_else(|| Error::input(format!("{} cannot be an output folder: give it a name", target.display())))?;
        let draft = target.with_file_name(format!(".{name}.partial-{}", std::process::id()));
        fs::create_dir_all(&draft).map_err(Error::io(&draft))?;
        Ok(Folder { target: target.to_owned(), draft, done: false })
    }

    /// Whether a run may write to `target`; asked before a long computation.
    ///
    /// # Errors
    /// See [`Folder::create`].
    pub fn may_write(target: &Path, force: bool) -> Result<()> {
        let occupied = fs::read_dir(target).map_or(target.exists(), |mut entries| entries.next().is_some());
        if !occupied {
            return Ok(());
        }
        let place = target.display();
        match (target.join(MARK).exists(), force) {
            (true, true) => Ok(()),
            (true, false) => Err(Error::input(format!(
                "{place} holds the results of another run. Use --force to replace them, or --output for another folder"
            ))),
            (false, _) => Err(Error::input(format!(
                "{place} exists and is not a results folder of squeal. Choose another with --output"
            ))),
        }
    }

    /// Writes one file of the folder.
    ///
    /// # Errors
    /// The system's, with the file's path.
    pub fn write(&self, name: &str, body: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        let path = self.draft.join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(Error::io(parent))?;
        }
        let mut out = BufWriter::new(File::create(&path).map_err(Error::io(&path))?);
        body(&mut out).and_then(|()| out.flush()).map_err(Error::io(&path))
    }

    /// Gives the folder its name, in place of an earlier run's.
    ///
    /// # Errors
    /// The system's, with the folder's path.
    pub fn finish(mut self) -> Result<()> {
        if self.target.exists() {
            fs::remove_dir_all(&self.target).map_err(Error::io(&self.target))?;
        }
        fs::rename(&self.draft, &self.target).map_err(Error::io(&self.target))?;
        self.done = true;
        Ok(())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !self.done {
            // Best effort: the draft of a run that failed is of no use to anyone.
            let _ = fs::remove_dir_all(&self.draft);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_appears_at_the_end_and_is_replaced_only_by_force() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("run");
        let folder = Folder::create(&target, false).unwrap();
        folder.write(MARK, |out| writeln!(out, "first")).unwrap();
        assert!(!target.exists());
        folder.finish().unwrap();
        let message = Folder::create(&target, false).err().unwrap().to_string();
        assert!(message.contains("--force"), "{message}");
        let folder = Folder::create(&target, true).unwrap();
        folder.write(MARK, |out| writeln!(out, "second")).unwrap();
        folder.finish().unwrap();
        assert_eq!(fs::read_to_string(target.join(MARK)).unwrap(), "second\n");
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failed_run_leaves_nothing() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::create(&place.path().join("run"), false).unwrap();
        folder.write(MARK, |out| writeln!(out, "half")).unwrap();
        drop(folder);
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_strangers_folder_is_left_alone() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("thesis.tex"), "").unwrap();
        assert!(Folder::create(place.path(), true).is_err());
    }
}
