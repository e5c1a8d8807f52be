//! The folder of a run: it appears as a whole or not at all, and is replaced only where all in it is ours.
//!
//! Until then its files are in a hidden neighbour, `.NAME.unfinished`, which a run that is killed leaves behind and the next run to the
//! same place finds. What a run needs to go on is in that neighbour's folder [`RESUME`].

use std::cell::Cell;
use std::fs::{self, File, TryLockError};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// A results folder under construction, whose hidden neighbour takes its name at the end.
pub struct Folder {
    target: PathBuf,
    draft: PathBuf,
    /// Whether the neighbour stays where the run ends early.
    keeps: Cell<bool>,
    done: bool,
    /// Held as long as the process lives.
    _lock: File,
}

/// Marks a folder as one of ours and lists what is in it, a line each: `--force` removes nothing else.
const MARK: &str = ".squeal";
/// What a run needs to go on, in an unfinished folder.
pub const RESUME: &str = ".resume";
/// Is locked by the run that writes.
const LOCK: &str = "lock";

impl Folder {
    /// Starts a folder, or finds what an earlier run has left of it; nothing is created at `target` yet.
    ///
    /// # Errors
    /// [`Error::Input`] where `target` holds something already, unless it is an earlier run's, holds nothing else,
    /// and `force` is set; where another run is writing it.
    pub fn open(target: &Path, force: bool) -> Result<Folder> {
        Self::may_write(target, force)?;
        let draft = unfinished(target)?;
        let resume = draft.join(RESUME);
        if !resume.exists() && names(&draft).is_ok_and(|names| !names.is_empty()) {
            let what = format!("{} holds something that is not of squeal", draft.display());
            return Err(Error::input(format!("{what}. Move it, or choose another output folder with --output")));
        }
        fs::create_dir_all(&resume).map_err(|reason| {
            Error::input(format!(
                "cannot create the output folder {}: {reason}. Choose another with --output",
                target.display()
            ))
        })?;
        let lock = lock(&resume.join(LOCK), target)?;
        Ok(Folder { target: target.to_owned(), draft, keeps: Cell::new(false), done: false, _lock: lock })
    }

    /// Whether a run may write to `target`; asked before a long computation.
    ///
    /// # Errors
    /// See [`Folder::open`].
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

    /// Where files are until the folder has its name.
    pub fn draft(&self) -> &Path {
        &self.draft
    }

    /// From now on the neighbour stays where the run ends early.
    pub fn keep(&self) {
        self.keeps.set(true);
    }

    /// Removes all that an earlier run has left.
    ///
    /// # Errors
    /// The system's, with the path.
    pub fn clear(&self) -> Result<()> {
        self.keeps.set(false);
        let resume = self.draft.join(RESUME);
        for (folder, stays) in [(&self.draft, RESUME), (&resume, LOCK)] {
            let names = names(folder).map_err(Error::io(folder))?;
            for path in names.iter().filter(|name| *name != stays).map(|name| folder.join(name)) {
                remove(&path).map_err(Error::io(&path))?;
            }
        }
        Ok(())
    }

    /// Writes one file of the folder.
    ///
    /// # Errors
    /// The system's, with the file's path.
    pub fn write(&self, name: &str, body: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        write_file(&self.draft.join(name), body)
    }

    /// Gives the folder its name, in place of an earlier run's.
    ///
    /// # Errors
    /// The system's, with the folder's path.
    pub fn finish(mut self) -> Result<()> {
        let mark = self.draft.join(MARK);
        let files = names(&self.draft).map_err(Error::io(&self.draft))?;
        // What a run had half written when it was killed.
        let (half, kept): (Vec<_>, Vec<_>) = files.iter().partition(|name| name.contains(".partial-"));
        half.iter().try_for_each(|name| remove(&self.draft.join(name))).map_err(Error::io(&self.draft))?;
        let kept = kept.iter().filter(|name| **name != RESUME);
        fs::write(&mark, kept.map(|name| format!("{name}\n")).collect::<String>()).map_err(Error::io(&mark))?;
        if self.target.exists() {
            fs::remove_dir_all(&self.target).map_err(Error::io(&self.target))?;
        }
        fs::rename(&self.draft, &self.target).map_err(Error::io(&self.target))?;
        self.done = true;
        let resume = self.target.join(RESUME);
        fs::remove_dir_all(&resume).map_err(Error::io(&resume))
    }
}

/// The hidden neighbour in which a folder is made.
///
/// # Errors
/// [`Error::Input`] where the folder has no name.
pub fn unfinished(target: &Path) -> Result<PathBuf> {
    let name = target
        .file_name()
        .and_then(|name| name.to_str())
        .ok_or_else(|| Error::input(format!("{} cannot be an output folder: give it a name", target.display())))?;
    Ok(target.with_file_name(format!(".{name}.unfinished")))
}

/// Takes the lock of an unfinished folder.
fn lock(path: &Path, target: &Path) -> Result<File> {
    let file = File::options().create(true).append(true).open(path).map_err(Error::io(path))?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(Error::input(format!(
            "another run is writing {}. Wait for its end, or choose another folder with --output",
            target.display()
        ))),
        // Not every file system has locks.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
    }
}

/// Names of what is in a folder.
fn names(folder: &Path) -> std::io::Result<Vec<String>> {
    let entries = fs::read_dir(folder)?;
    let mut names =
        entries.map(|e| Ok(e?.file_name().to_string_lossy().into_owned())).collect::<std::io::Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

fn remove(path: &Path) -> std::io::Result<()> {
    if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) }
}

/// Counts files that lie in a results folder as the folder's own, so that `--force` may replace them with it; also a folder in it that holds
/// nothing else. Other folders and files are left as they are.
///
/// # Errors
/// The system's, with the path.
pub fn adopt(folder: &Path, files: &[PathBuf]) -> Result<()> {
    let mark = folder.join(MARK);
    let Ok(mut ours) = fs::read_to_string(&mark) else { return Ok(()) };
    let first = |file: &PathBuf| file.strip_prefix(folder).ok()?.iter().next()?.to_str().map(String::from);
    for name in files.iter().filter_map(first) {
        if !ours.lines().any(|known| known == name) && holds_only(&folder.join(&name), files) {
            ours += &format!("{name}\n");
        }
    }
    fs::write(&mark, ours).map_err(Error::io(&mark))
}

/// Whether a path is one of these files, or a folder that holds nothing else.
fn holds_only(path: &Path, files: &[PathBuf]) -> bool {
    match fs::read_dir(path) {
        Ok(entries) => entries.flatten().all(|entry| holds_only(&entry.path(), files)),
        Err(_) => files.iter().any(|file| file == path),
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

/// The first entry of a folder that its list of our files does not have.
fn stranger(folder: &Path, ours: &str) -> std::io::Result<Option<String>> {
    let is_ours = |name: &String| {
        name == MARK || name == RESUME || ours.lines().any(|file| file.split('/').next() == Some(name.as_str()))
    };
    Ok(names(folder)?.into_iter().find(|name| !is_ours(name)))
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !self.done && !self.keeps.get() {
            // Best effort: the draft of a run that has found nothing is of no use to anyone.
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
        let folder = Folder::open(&target, false).unwrap();
        folder.write(FILE, |out| writeln!(out, "first")).unwrap();
        assert!(!target.exists());
        folder.finish().unwrap();
        let message = Folder::open(&target, false).err().unwrap().to_string();
        assert!(message.contains("--force"), "{message}");
        let folder = Folder::open(&target, true).unwrap();
        folder.write(FILE, |out| writeln!(out, "second")).unwrap();
        folder.finish().unwrap();
        assert_eq!(fs::read_to_string(target.join(FILE)).unwrap(), "second\n");
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_is_adopted_goes_with_the_folder() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("run");
        Folder::open(&target, false).unwrap().finish().unwrap();
        let files = ["plots/a.svg", "moving/a/1.vtu", "report.html"].map(|name| target.join(name));
        files.iter().for_each(|file| write_file(file, |_| Ok(())).unwrap());
        assert!(Folder::may_write(&target, true).is_err());
        adopt(&target, &files).unwrap();
        adopt(&target, &files).unwrap();
        Folder::may_write(&target, true).unwrap();
        assert_eq!(fs::read_to_string(target.join(MARK)).unwrap(), "plots\nmoving\nreport.html\n");
        write_file(&target.join("mine/notes.txt"), |_| Ok(())).unwrap();
        adopt(&target, &[target.join("mine/a.svg")]).unwrap();
        assert!(Folder::may_write(&target, true).is_err());
        adopt(place.path(), &files).unwrap();
        assert!(!place.path().join(MARK).exists());
    }

    #[test]
    fn a_failed_run_leaves_nothing() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(&place.path().join("run"), false).unwrap();
        folder.write(FILE, |out| writeln!(out, "half")).unwrap();
        drop(folder);
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 0);
    }

    #[test]
    fn what_a_run_keeps_is_found_by_the_next() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("run");
        let folder = Folder::open(&target, false).unwrap();
        folder.write(FILE, |out| writeln!(out, "half")).unwrap();
        folder.write(".resume/value", |out| writeln!(out, "1")).unwrap();
        folder.write(".results.h5.partial-12", |out| writeln!(out, "half")).unwrap();
        folder.keep();
        drop(folder);
        assert!(!target.exists());
        let folder = Folder::open(&target, false).unwrap();
        assert_eq!(fs::read_to_string(folder.draft().join(".resume/value")).unwrap(), "1\n");
        folder.finish().unwrap();
        assert_eq!(names(&target).unwrap(), [MARK, FILE]);
        // It may be replaced.
        let folder = Folder::open(&target, true).unwrap();
        folder.write("pieces/a", |out| writeln!(out, "half")).unwrap();
        folder.write(".resume/value", |out| writeln!(out, "2")).unwrap();
        folder.clear().unwrap();
        assert_eq!(
            (names(folder.draft()).unwrap(), names(&folder.draft().join(RESUME)).unwrap()),
            (vec![RESUME.into()], vec![LOCK.into()])
        );
    }

    #[test]
    fn two_runs_do_not_write_one_folder() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("run");
        let folder = Folder::open(&target, false).unwrap();
        let message = Folder::open(&target, false).err().unwrap().to_string();
        assert!(message.contains("another run is writing"), "{message}");
        drop(folder);
        Folder::open(&target, false).unwrap();
    }

    #[test]
    fn a_strangers_folder_is_left_alone() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("thesis.tex"), "").unwrap();
        assert!(Folder::open(place.path(), true).is_err());
        let target = place.path().join("run");
        fs::create_dir(unfinished(&target).unwrap()).unwrap();
        fs::write(unfinished(&target).unwrap().join("thesis.tex"), "").unwrap();
        assert!(Folder::open(&target, true).is_err());
        fs::remove_file(unfinished(&target).unwrap().join("thesis.tex")).unwrap();
        Folder::open(&target, false).unwrap().finish().unwrap();
        fs::write(target.join("notes.txt"), "").unwrap();
        let message = Folder::open(&target, true).err().unwrap().to_string();
        assert!(message.contains("holds notes.txt"), "{message}");
    }
}
