//! What may be overwritten: the one place that decides it, for files and for results folders.
//!
//! Without `--force` nothing is. With `--force` a file is replaced where it is of the kind that the command writes, and
//! a results folder where it contains only the files that its mark lists. So a wrong name after `-o` never costs a
//! model, a mesh or a thesis.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// Marks a results folder and lists the files in it, one path a line.
pub const MARK: &str = ".squeal";
/// What a run needs in order to resume, in an unfinished folder.
pub const RESUME: &str = ".resume";
/// The program's name in text files that it writes, near their start.
pub const SIGNATURE: &str = "<!-- squeal -->";
/// Bytes from the start of a text file in which its mark stands.
const HEAD_BYTES: u64 = 1024;

/// A kind of file that the program writes.
pub struct FileKind {
    /// Its name in messages, with article.
    pub name: &'static str,
    /// Recognises a file of the kind by its content.
    pub is_one: fn(&Path) -> bool,
}

/// Whether a text stands near the start of a file.
pub fn head_contains(path: &Path, mark: &str) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head));
    read.is_ok() && String::from_utf8_lossy(&head).contains(mark)
}

/// Whether a file of a kind may be written at `path`.
///
/// # Errors
/// [`Error::Input`] where something is there, unless it is an earlier file of the same kind and `force` is set.
pub fn may_write_file(path: &Path, kind: &FileKind, force: bool) -> Result<()> {
    let place = path.display();
    let refuse = |reason: String| Err(Error::input(format!("{place} {reason}")));
    if path.is_dir() {
        return refuse("is a folder. Give the name of a file".into());
    }
    if !path.exists() && !path.is_symlink() {
        return Ok(());
    }
    match (force, (kind.is_one)(path)) {
        (true, true) => Ok(()),
        (false, true) => refuse("exists. Use --force to replace it, or choose another name".into()),
        (_, false) => refuse(format!("exists and is not {}: it is not replaced. Choose another name", kind.name)),
    }
}

/// Whether a run may write its results folder to `target`.
///
/// # Errors
/// [`Error::Input`] where something is there, unless it is a results folder that contains nothing else and `force` is
/// set.
pub fn may_write_folder(target: &Path, force: bool) -> Result<()> {
    let place = target.display();
    let refuse = |reason: &str| Err(Error::input(format!("{place} {reason}")));
    if target.is_symlink() && !target.exists() {
        return refuse("is a symbolic link to nothing. Create the folder that it points to");
    }
    if is_free(target) {
        return Ok(());
    }
    if !target.is_dir() {
        return refuse("is a file. Choose another output folder with --output");
    }
    if !target.join(MARK).exists() {
        let first = fs::read_dir(target).map_err(Error::io(target))?.flatten().next();
        let contents = first.map_or_else(String::new, |entry| format!(": it contains {}", entry.file_name().display()));
        return refuse(&format!(
            "exists and is not a results folder of squeal{contents}. Choose another with --output"
        ));
    }
    if !force {
        return refuse(
            "contains the results of another run. Use --force to replace them, or --output for another folder",
        );
    }
    match foreign_entry(target)? {
        None => Ok(()),
        Some(name) => refuse(&format!(
            "contains {name}, which is not of the earlier run and would be lost. Move it, or choose another folder with --output"
        )),
    }
}

/// Whether nothing is at a path, or an empty folder.
pub fn is_free(path: &Path) -> bool {
    fs::read_dir(path).map_or(!path.exists(), |mut entries| entries.next().is_none())
}

/// The first entry of a results folder that its mark does not list: a file, a link, or an empty folder.
///
/// # Errors
/// The system's, with the path.
pub fn foreign_entry(folder: &Path) -> Result<Option<String>> {
    let ours = listed(folder);
    let is_ours = |name: &String| name == MARK || ours.contains(name);
    Ok(entries(folder)?.into_iter().find(|name| !is_ours(name)))
}

/// The files that the mark of a results folder lists; none where it has no mark.
pub fn listed(folder: &Path) -> Vec<String> {
    fs::read_to_string(folder.join(MARK)).unwrap_or_default().lines().map(String::from).collect()
}

/// All files, links and empty folders below a folder, as paths from there, sorted; without what a run needs in order to
/// resume.
///
/// # Errors
/// The system's, with the path.
pub fn entries(folder: &Path) -> Result<Vec<String>> {
    let mut found = Vec::new();
    collect(folder, Path::new(""), &mut found).map_err(Error::io(folder))?;
    found.retain(|name| Path::new(name).components().next().is_none_or(|first| first.as_os_str() != RESUME));
    found.sort();
    Ok(found)
}

fn collect(folder: &Path, below: &Path, found: &mut Vec<String>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder.join(below))? {
        let entry = entry?;
        let path: PathBuf = below.join(entry.file_name());
        let n_before = found.len();
        if entry.file_type()?.is_dir() {
            collect(folder, &path, found)?;
        }
        if found.len() == n_before {
            found.push(path.to_string_lossy().into_owned());
        }
    }
    Ok(())
}

/// Removes from a results folder what its mark lists, and the folder where nothing else is left.
///
/// # Errors
/// The system's, with the path: where the folder is not empty afterwards, too.
pub fn remove_results(folder: &Path) -> Result<()> {
    let (resume, mark) = (folder.join(RESUME), folder.join(MARK));
    let mut parents: Vec<PathBuf> = Vec::new();
    for path in listed(folder).iter().map(|name| folder.join(name)).chain([mark]) {
        match fs::symlink_metadata(&path) {
            Err(_) => continue,
            // A folder that an earlier version lists by its name.
            Ok(what) if what.is_dir() => parents.push(path.clone()),
            Ok(_) => fs::remove_file(&path).map_err(Error::io(&path))?,
        }
        parents.extend(path.ancestors().skip(1).take_while(|parent| *parent != folder).map(Path::to_owned));
    }
    if resume.exists() {
        fs::remove_dir_all(&resume).map_err(Error::io(&resume))?;
    }
    parents.sort();
    parents.dedup();
    // The deepest first; one with foreign files in it stays.
    parents.iter().rev().for_each(|parent| drop(fs::remove_dir(parent)));
    fs::remove_dir(folder).map_err(Error::io(folder))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOTES: FileKind = FileKind { name: "a note of squeal", is_one: |path| head_contains(path, SIGNATURE) };

    #[test]
    fn a_file_is_replaced_only_by_force_and_by_its_like() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("note");
        may_write_file(&path, &NOTES, false).unwrap();
        fs::write(&path, format!("{SIGNATURE}\ntext")).unwrap();
        let message = may_write_file(&path, &NOTES, false).unwrap_err().to_string();
        assert!(message.contains("exists. Use --force"), "{message}");
        may_write_file(&path, &NOTES, true).unwrap();
        fs::write(&path, "[mesh]\nfile = \"brake.msh\"\n").unwrap();
        for force in [false, true] {
            let message = may_write_file(&path, &NOTES, force).unwrap_err().to_string();
            assert!(message.contains("exists and is not a note of squeal: it is not replaced"), "{message}");
        }
        let message = may_write_file(place.path(), &NOTES, true).unwrap_err().to_string();
        assert!(message.contains("is a folder"), "{message}");
    }

    #[test]
    fn files_below_a_listed_name_are_seen() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        fs::create_dir_all(folder.join("pieces")).unwrap();
        fs::write(folder.join("pieces/a.vtu"), "").unwrap();
        fs::write(folder.join(MARK), "details.txt\npieces/a.vtu\n").unwrap();
        may_write_folder(folder, true).unwrap();
        for mine in ["pieces/mine.txt", "details.txt/mine", "mine/deep/down"] {
            let path = folder.join(mine);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, "").unwrap();
            let message = may_write_folder(folder, true).unwrap_err().to_string();
            assert!(message.contains(&format!("contains {mine}, which is not of the earlier run")), "{message}");
            fs::remove_file(&path).unwrap();
        }
        let message = may_write_folder(folder, true).unwrap_err().to_string();
        assert!(message.contains("contains mine/deep"), "an empty folder, too: {message}");
    }

    #[test]
    fn only_what_is_listed_is_removed() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("run");
        fs::create_dir_all(folder.join("pieces")).unwrap();
        for name in ["summary.txt", "pieces/a.vtu", "pieces/mine.txt"] {
            fs::write(folder.join(name), "").unwrap();
        }
        fs::write(folder.join(MARK), "pieces/a.vtu\nsummary.txt\n").unwrap();
        assert!(remove_results(&folder).is_err());
        assert_eq!(entries(&folder).unwrap(), ["pieces/mine.txt"]);
        fs::remove_file(folder.join("pieces/mine.txt")).unwrap();
        fs::remove_dir(folder.join("pieces")).unwrap();
        fs::write(folder.join(MARK), "").unwrap();
        remove_results(&folder).unwrap();
        assert!(!folder.exists());
    }
}
