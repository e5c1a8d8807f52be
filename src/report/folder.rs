//! The folder of a run: it appears as a whole or not at all, and is replaced only where all in it is ours.

use std::cell::RefCell;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// A results folder under construction: files go to a hidden neighbour that takes the folder's name at the end.
pub struct Folder {
    target: PathBuf,
    draft: PathBuf,
    /// Files written so far.
    files: RefCell<Vec<String>>,
    done: bool,
}

/// Marks a folder as one of ours and lists its files, a line each: `--force` removes nothing else.
const MARK: &str = ".squeal";

impl Folder {
    /// Starts a folder; nothing is created at `target` yet.
    ///
    /// # Errors
    /// [`Error::Input`] where `target` holds something already, unless it is an earlier run's, holds nothing else,
    /// and `force` is set.
    pub fn create(target: &Path, force: bool) -> Result<Folder> {
        Self::may_write(target, force)?;
        let name = target
            .file_name()
            .and_then(|name| name.to_str())
            .ok_or_else(|| Error::input(format!("{} cannot be an output folder: give it a name", target.display())))?;
        let prefix = format!(".{name}.partial-");
        remove_orphans(target, &prefix);
        let draft = target.with_file_name(format!("{prefix}{}", std::process::id()));
        fs::create_dir_all(&draft).map_err(|reason| {
            Error::input(format!(
                "cannot create the output folder {}: {reason}. Choose another with --output",
                target.display()
            ))
        })?;
        Ok(Folder { target: target.to_owned(), draft, files: RefCell::default(), done: false })
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
        if !target.is_dir() {
            return Err(Error::input(format!("{place} is a file. Choose another output folder with --output")));
        }
        let Ok(ours) = fs::read_to_string(target.join(MARK)) else {
            let what = format!("{place} exists and is not a results folder of squeal");
            return Err(Error::input(format!("{what}. Choose another with --output")));
        };
        if !force {
            return Err(Error::input(format!(
                "{place} holds the results of another run. Use --force to replace them, or --output for another folder"
            )));
        }
        match stranger(target, &ours).map_err(Error::io(target))? {
            None => Ok(()),
            Some(name) => Err(Error::input(format!(
                "{place} holds {name}, which is not of the run before and would be lost. Move it, or choose another folder \
                 with --output"
            ))),
        }
    }

    /// The name that the folder will have.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Where files are until the folder has its name.
    pub fn draft(&self) -> &Path {
        &self.draft
    }

    /// Counts files as the folder's that others have written to its draft.
    pub fn adopt(&self, names: &[String]) {
        self.files.borrow_mut().extend_from_slice(names);
    }

    /// Writes one file of the folder.
    ///
    /// # Errors
    /// The system's, with the file's path.
    pub fn write(&self, name: &str, body: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        self.files.borrow_mut().push(name.to_owned());
        write_file(&self.draft.join(name), body)
    }

    /// A file of the folder that `body` writes to the path it is given.
    ///
    /// # Errors
    /// The body's.
    pub fn place(&self, name: &str, body: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
        self.files.borrow_mut().push(name.to_owned());
        body(&self.draft.join(name))
    }

    /// Gives the folder its name, in place of an earlier run's.
    ///
    /// # Errors
    /// The system's, with the folder's path.
    pub fn finish(mut self) -> Result<()> {
        let mark = self.draft.join(MARK);
        let files = self.files.borrow().iter().map(|name| format!("{name}\n")).collect::<String>();
        fs::write(&mark, files).map_err(Error::io(&mark))?;
        if self.target.exists() {
            fs::remove_dir_all(&self.target).map_err(Error::io(&self.target))?;
        }
        fs::rename(&self.draft, &self.target).map_err(Error::io(&self.target))?;
        self.done = true;
        Ok(())
    }
}

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

/// Removes the drafts of runs that were killed: their processes are gone. Best effort; a draft in the way of nobody may stay.
fn remove_orphans(target: &Path, prefix: &str) {
    let parent = target.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = fs::read_dir(parent) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(process) = name.strip_prefix(prefix).and_then(|id| id.parse::<u32>().ok()) else { continue };
        if Path::new("/proc").is_dir() && !Path::new(&format!("/proc/{process}")).exists() {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// The first entry of a folder that its list of our files does not have.
fn stranger(folder: &Path, ours: &str) -> std::io::Result<Option<String>> {
    let is_ours = |name: &str| {
        let mut files = ours.lines();
        name == MARK || files.any(|file| file == name || file.split_once('/').is_some_and(|(first, _)| first == name))
    };
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if !is_ours(&name) {
            return Ok(Some(name));
        }
    }
    Ok(None)
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

    const FILE: &str = "summary.txt";

    #[test]
    fn a_folder_appears_at_the_end_and_is_replaced_only_by_force() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("run");
        let folder = Folder::create(&target, false).unwrap();
        folder.write(FILE, |out| writeln!(out, "first")).unwrap();
        assert!(!target.exists());
        folder.finish().unwrap();
        let message = Folder::create(&target, false).err().unwrap().to_string();
        assert!(message.contains("--force"), "{message}");
        let folder = Folder::create(&target, true).unwrap();
        folder.write(FILE, |out| writeln!(out, "second")).unwrap();
        folder.finish().unwrap();
        assert_eq!(fs::read_to_string(target.join(FILE)).unwrap(), "second\n");
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failed_run_leaves_nothing() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::create(&place.path().join("run"), false).unwrap();
        folder.write(FILE, |out| writeln!(out, "half")).unwrap();
        drop(folder);
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
    }

    #[test]
    fn the_draft_of_a_killed_run_goes_with_the_next() {
        let place = tempfile::tempdir().unwrap();
        // Above the largest process number of Linux, so that no process has it.
        let orphan = place.path().join(".run.partial-4194305");
        let alive = place.path().join(format!(".run.partial-{}", std::os::unix::process::parent_id()));
        fs::create_dir_all(&orphan).unwrap();
        fs::create_dir_all(&alive).unwrap();
        drop(Folder::create(&place.path().join("run"), false).unwrap());
        assert!(!orphan.exists() && alive.exists());
    }

    #[test]
    fn a_strangers_folder_is_left_alone() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("thesis.tex"), "").unwrap();
        assert!(Folder::create(place.path(), true).is_err());
        let target = place.path().join("run");
        Folder::create(&target, false).unwrap().finish().unwrap();
        fs::write(target.join("notes.txt"), "").unwrap();
        let message = Folder::create(&target, true).err().unwrap().to_string();
        assert!(message.contains("holds notes.txt"), "{message}");
    }
}
