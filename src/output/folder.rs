//! The folder of a run: it appears as a whole or not at all, and replaces only what an earlier run wrote.
//!
//! Until then its files are in a hidden neighbour, `.NAME.unfinished`, which a run that is killed leaves behind and the
//! next run to the same place finds. What a run needs in order to resume is in that neighbour's folder [`RESUME`].

use std::cell::Cell;
use std::fs::{self, File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

use super::files::{PARTIAL, behind_link, write_file, write_whole};
pub use super::overwrite::RESUME;
use super::overwrite::{MARK, entries, foreign_entry, is_free, listed, may_write_folder, remove_results};
use crate::native::Comm;
use crate::{Error, Result};

/// A results folder under construction, whose hidden neighbour takes its name at the end.
pub struct Folder {
    /// The folder as the user names it.
    place: PathBuf,
    /// The same, or what the symbolic link at `place` points to.
    target: PathBuf,
    draft: PathBuf,
    /// Whether an earlier run's results may be replaced.
    force: bool,
    /// Whether the neighbour stays where the run ends early.
    keeps: Cell<bool>,
    done: bool,
    /// Locked as long as the process lives.
    _lock: File,
}

/// Is locked by the run that writes.
const LOCK: &str = "lock";

impl Folder {
    /// Starts a folder, or finds what an earlier run has left of it; nothing is created at `place` yet.
    ///
    /// # Errors
    /// [`Error::Input`] where something is at `place` already, unless it is an earlier run's, nothing else is in it,
    /// and `force` is set; where another run is writing it.
    pub fn open(place: &Path, force: bool) -> Result<Folder> {
        may_write_folder(place, force)?;
        let draft = unfinished(place)?;
        let resume = draft.join(RESUME);
        if !resume.exists() && names(&draft).is_ok_and(|names| !names.is_empty()) {
            let what = format!("{} contains files that squeal did not write", draft.display());
            return Err(Error::input(format!("{what}. Move it, or choose another output folder with --output")));
        }
        fs::create_dir_all(&resume).map_err(|reason| {
            Error::input(format!(
                "cannot create the output folder {}: {reason}. Choose another with --output",
                place.display()
            ))
        })?;
        let lock = lock(&resume.join(LOCK), place)?;
        let target = behind_link(place);
        Ok(Folder { place: place.to_owned(), target, draft, force, keeps: Cell::new(false), done: false, _lock: lock })
    }

    /// The folder on the root, without what an earlier run has left; the refusal on all ranks alike. Collective.
    ///
    /// # Errors
    /// See [`Folder::open`].
    pub fn open_empty(comm: &Comm, target: &Path, force: bool) -> Result<Option<Folder>> {
        let open = || {
            let folder = Folder::open(target, force)?;
            folder.clear()?;
            Ok(Some(folder))
        };
        comm.agree(if comm.is_root() { open() } else { Ok(None) })
    }

    /// The folder as the user names it.
    pub fn place(&self) -> &Path {
        &self.place
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

    /// Gives the folder its name, in place of an earlier run's. What has come to that place since the run began is not
    /// lost: the results stay in the neighbour.
    ///
    /// # Errors
    /// [`Error::Input`] where the place is no longer free, with where the results are; the system's, with the folder's
    /// path.
    pub fn finish(mut self) -> Result<()> {
        self.list()?;
        self.keep();
        let aside = self.move_aside().map_err(|error| self.with_place_of_results(&error))?;
        // A folder that is not empty is never replaced by a rename.
        if let Err(reason) = fs::rename(&self.draft, &self.target) {
            aside.iter().for_each(|aside| drop(fs::rename(aside, &self.target)));
            return Err(self.with_place_of_results(&Error::io(&self.place)(reason)));
        }
        self.done = true;
        let resume = self.target.join(RESUME);
        fs::remove_dir_all(&resume).map_err(Error::io(&resume))?;
        aside.map_or(Ok(()), |aside| remove_results(&aside))
    }

    /// Writes the mark, and removes what a run had half written when it was killed.
    fn list(&self) -> Result<()> {
        let is_partial = |name: &String| name.contains(PARTIAL);
        let (half, whole): (Vec<_>, Vec<_>) = entries(&self.draft)?.into_iter().partition(is_partial);
        half.iter().try_for_each(|name| remove(&self.draft.join(name))).map_err(Error::io(&self.draft))?;
        let lines = whole.iter().filter(|name| *name != MARK).map(|name| format!("{name}\n"));
        write_file(&self.draft.join(MARK), |out| out.write_all(lines.collect::<String>().as_bytes()))
    }

    /// Moves an earlier run's results away, and gives where they are.
    fn move_aside(&self) -> Result<Option<PathBuf>> {
        may_write_folder(&self.target, self.force)?;
        if is_free(&self.target) {
            return Ok(None);
        }
        let aside = neighbour(&self.target, "replaced")?;
        fs::rename(&self.target, &aside).map_err(Error::io(&self.place))?;
        // From here on no other program writes to it under its name.
        match foreign_entry(&aside)? {
            None => Ok(Some(aside)),
            Some(name) => {
                fs::rename(&aside, &self.target).map_err(Error::io(&aside))?;
                Err(Error::input(format!("{} contains {name}, which would be lost", self.place.display())))
            }
        }
    }

    /// An error after which the results are in the neighbour.
    fn with_place_of_results(&self, error: &Error) -> Error {
        let draft = self.draft.display();
        Error::input(format!("{error}\nThe results are complete in {draft}: rename that folder"))
    }
}

/// The hidden neighbour in which a folder is made: of what a symbolic link points to.
///
/// # Errors
/// [`Error::Input`] where the folder has no name.
pub fn unfinished(place: &Path) -> Result<PathBuf> {
    neighbour(&behind_link(place), "unfinished")
}

fn neighbour(target: &Path, state: &str) -> Result<PathBuf> {
    let name = target
        .file_name()
        .and_then(|name| name.to_str())
        .ok_or_else(|| Error::input(format!("{} cannot be an output folder: give it a name", target.display())))?;
    Ok(target.with_file_name(format!(".{name}.{state}")))
}

/// Takes the lock of an unfinished folder.
fn lock(path: &Path, place: &Path) -> Result<File> {
    let file = File::options().create(true).append(true).open(path).map_err(Error::io(path))?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(Error::input(format!(
            "another run is writing {}. Wait for its end, or choose another folder with --output",
            place.display()
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

/// Counts files that lie in a results folder as the folder's own, so that `--force` may replace them with it.
///
/// # Errors
/// The system's, with the path.
pub fn add_to_listed(folder: &Path, files: &[PathBuf]) -> Result<()> {
    let mark = folder.join(MARK);
    if !mark.exists() {
        return Ok(());
    }
    let mut ours = listed(folder);
    ours.extend(files.iter().filter_map(|file| Some(file.strip_prefix(folder).ok()?.to_string_lossy().into_owned())));
    ours.sort();
    ours.dedup();
    write_whole(&mark, |out| ours.iter().try_for_each(|name| writeln!(out, "{name}")))
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
    fn added_files_are_replaced_with_the_folder() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("run");
        Folder::open(&target, false).unwrap().finish().unwrap();
        let files = ["plots/a.svg", "moving/a/1.vtu", "report.html"].map(|name| target.join(name));
        files.iter().for_each(|file| write_file(file, |_| Ok(())).unwrap());
        assert!(may_write_folder(&target, true).is_err());
        add_to_listed(&target, &files).unwrap();
        add_to_listed(&target, &files).unwrap();
        may_write_folder(&target, true).unwrap();
        assert_eq!(fs::read_to_string(target.join(MARK)).unwrap(), "moving/a/1.vtu\nplots/a.svg\nreport.html\n");
        write_file(&target.join("mine/notes.txt"), |_| Ok(())).unwrap();
        add_to_listed(&target, &[target.join("mine/a.svg")]).unwrap();
        assert!(may_write_folder(&target, true).is_err());
        add_to_listed(place.path(), &files).unwrap();
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

    /// A run during which the folder `run` changes; gives the error of its end, and what is in that folder then.
    fn disturbed(force: bool, disturb: impl FnOnce(&Path)) -> (String, Vec<String>) {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("run");
        if force {
            let earlier = Folder::open(&target, false).unwrap();
            earlier.write("details.txt", |out| writeln!(out, "old")).unwrap();
            earlier.finish().unwrap();
        }
        let folder = Folder::open(&target, force).unwrap();
        folder.write(FILE, |out| writeln!(out, "new")).unwrap();
        disturb(&target);
        let draft = folder.draft().to_owned();
        let message = folder.finish().unwrap_err().to_string();
        assert_eq!(fs::read_to_string(draft.join(FILE)).unwrap(), "new\n", "results are kept");
        assert!(message.contains(&format!("complete in {}", draft.display())), "{message}");
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 2);
        (message, entries(&target).unwrap())
    }

    #[test]
    fn what_appears_during_a_run_is_not_lost() {
        let (message, left) = disturbed(false, |target| write_file(&target.join("thesis.txt"), |_| Ok(())).unwrap());
        assert!(message.contains("contains thesis.txt"), "{message}");
        assert_eq!(left, ["thesis.txt"]);
        let (message, left) = disturbed(true, |target| write_file(&target.join("notes.txt"), |_| Ok(())).unwrap());
        assert!(message.contains("contains notes.txt"), "{message}");
        assert_eq!(left, [MARK, "details.txt", "notes.txt"]);
        let (message, left) = disturbed(true, |target| {
            fs::remove_file(target.join("details.txt")).unwrap();
            write_file(&target.join("details.txt/mine"), |_| Ok(())).unwrap();
        });
        assert!(message.contains("contains details.txt/mine"), "{message}");
        assert_eq!(left, [MARK, "details.txt/mine"]);
    }

    #[test]
    fn a_link_to_a_folder_stays() {
        let place = tempfile::tempdir().unwrap();
        let (scratch, link) = (place.path().join("scratch"), place.path().join("run"));
        fs::create_dir(&scratch).unwrap();
        std::os::unix::fs::symlink(&scratch, &link).unwrap();
        for force in [false, true] {
            let folder = Folder::open(&link, force).unwrap();
            folder.write(FILE, |out| writeln!(out, "{force}")).unwrap();
            folder.finish().unwrap();
            assert!(link.is_symlink());
            assert_eq!(fs::read_to_string(scratch.join(FILE)).unwrap(), format!("{force}\n"));
        }
        fs::remove_dir_all(&scratch).unwrap();
        assert!(Folder::open(&link, true).err().unwrap().to_string().contains("link to nothing"));
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
        assert!(message.contains("contains notes.txt"), "{message}");
    }
}
