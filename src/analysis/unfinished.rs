//! What a run finds in the folder that an earlier one has left.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::hdf::{self, Format};
use crate::native::Comm;
use crate::output::files::{write_file, write_whole};
use crate::output::folder::{self, Folder, RESUME};
use crate::{Error, Result};

/// File with what the numbers of a study depend on.
const STUDY: &str = "study.txt";

/// An analysis that may continue in the folder of an earlier run.
pub struct Unfinished<'a> {
    /// The folder of the results.
    pub target: &'a Path,
    /// Name and value of all that the numbers depend on.
    pub identity: &'a [(&'a str, String)],
    /// Names of the files of finished items, by their numbers from 0.
    pub name: fn(usize) -> String,
    /// What the items are, in the plural.
    pub unit: &'static str,
}

impl Unfinished<'_> {
    /// The folder of what an analysis keeps, and the number of items, one after the other, that an earlier run has
    /// finished; `folder` is the root's. Each rank checks items in their folder by `check`, which takes their number,
    /// too. Collective.
    ///
    /// # Errors
    /// See [`Unfinished::prepare`]; those of `check` on any rank.
    pub fn open(
        &self,
        comm: &Comm,
        folder: Option<&Folder>,
        force: bool,
        check: impl FnOnce(&Path, usize) -> Result<()>,
    ) -> Result<(PathBuf, usize)> {
        let place = folder::unfinished(self.target)?.join(RESUME);
        let numbers = comm.agree(folder.map_or(Ok(Vec::new()), |_| self.numbers(&place)))?;
        let n = comm.broadcast_value(0, numbers.iter().enumerate().take_while(|(i, number)| i == *number).count());
        // What some rank cannot read is known before the root decides.
        let checked = comm.agree(if n > 0 { check(&place, n) } else { Ok(()) });
        let n = folder.map_or(Ok(0), |folder| self.continued(folder, n, force, checked));
        let n = comm.broadcast_value(0, comm.agree(n)?);
        Ok((place, n))
    }

    /// Number of finished items in an unfinished folder, in whatever order, which is emptied where they cannot be used
    /// and `force` is set.
    ///
    /// # Errors
    /// [`Error::Input`] where another study was begun; the system's.
    pub fn prepare(&self, folder: &Folder, force: bool) -> Result<usize> {
        self.continued(folder, self.numbers(&folder.draft().join(RESUME))?.len(), force, Ok(()))
    }

    /// The number of items that are used, of `n`.
    fn continued(&self, folder: &Folder, n: usize, force: bool, checked: Result<()>) -> Result<usize> {
        let place = folder.draft().join(RESUME);
        if n > 0 {
            folder.keep();
            match self.require_same(&place, n).and(checked) {
                Ok(()) => return Ok(n),
                Err(error) if !force => return Err(error),
                Err(_) => (),
            }
        }
        folder.clear()?;
        let lines: String = self.identity.iter().map(|(name, value)| format!("{name}: {value}\n")).collect();
        write_file(&place.join(STUDY), |out| out.write_all(lines.as_bytes()))?;
        Ok(0)
    }

    /// Numbers of the items whose files there are, sorted.
    fn numbers(&self, place: &Path) -> Result<Vec<usize>> {
        let number = |name: &str| -> Option<usize> {
            let number = name.split(|c: char| !c.is_ascii_digit()).find(|digits| !digits.is_empty())?.parse().ok()?;
            ((self.name)(number) == name).then_some(number)
        };
        let entries = std::fs::read_dir(place).map_err(Error::io(place))?;
        let names = entries.flatten().map(|entry| entry.file_name());
        let mut numbers: Vec<usize> = names.filter_map(|name| number(&name.to_string_lossy())).collect();
        numbers.sort_unstable();
        Ok(numbers)
    }

    /// Refuses what another study has left.
    fn require_same(&self, place: &Path, n: usize) -> Result<()> {
        let file = place.join(STUDY);
        let begun = std::fs::read_to_string(&file).map_err(|reason| {
            Error::input(format!("{} is missing or damaged: {reason}. Use --force to begin again", file.display()))
        })?;
        for (name, value) in self.identity {
            let before = begun.lines().find_map(|line| line.strip_prefix(&format!("{name}: "))).unwrap_or("unknown");
            if before != value {
                let (target, unit) = (self.target.display(), self.unit);
                let what = format!("{target} is unfinished ({n} {unit} are done), and was begun otherwise");
                let advice = "Continue with the command that began it, use --force to begin again, or --output for \
                              another folder";
                return Err(Error::input(format!("{what}: {name} was {before}, is {value}. {advice}")));
            }
        }
        Ok(())
    }
}

/// Writes what an analysis keeps, bit by bit; the file appears when it is complete. Not collective.
///
/// # Errors
/// The system's, with the path.
pub fn write_binary<T: Serialize>(path: &Path, what: &T) -> Result<()> {
    let bytes = postcard::to_stdvec(what).map_err(Error::library("postcard"))?;
    write_whole(path, |out| out.write_all(&bytes))
}

/// Reads it again. Not collective.
///
/// # Errors
/// [`Error::Input`] where the file is damaged; the system's, with the path.
pub fn read_binary<T: DeserializeOwned>(path: &Path, format: &Format) -> Result<T> {
    let bytes = std::fs::read(path).map_err(Error::io(path))?;
    postcard::from_bytes(&bytes).map_err(|reason| hdf::damaged(path, format, reason))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    fn item(number: usize) -> String {
        format!("item-{number:02}.h5")
    }

    #[test]
    fn items_are_counted_in_any_order_and_continued_in_sequence() {
        let comm = Session::start(&[]).unwrap();
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("run");
        let folder = Folder::open(&target, false).unwrap();
        let seed = |seed: &str| [("seed", seed.to_owned())];
        let (same, other) = (seed("1"), seed("2"));
        let study = |identity| Unfinished { target: &target, identity, name: item, unit: "items" };
        let resume = folder.draft().join(RESUME);
        assert_eq!(study(&same).prepare(&folder, false).unwrap(), 0);
        for name in ["item-00.h5", "item-02.h5", "item-003.h5", "other-1.h5"] {
            std::fs::write(resume.join(name), "").unwrap();
        }
        assert_eq!(study(&same).prepare(&folder, false).unwrap(), 2);
        let message = study(&other).prepare(&folder, false).unwrap_err().to_string();
        assert!(message.contains("2 items are done") && message.contains("seed was 1, is 2"), "{message}");
        let open = |force, checked: fn() -> Result<()>| {
            study(&same).open(&comm, Some(&folder), force, |_, _| checked()).map(|(_, n)| n)
        };
        assert_eq!(open(false, || Ok(())).unwrap(), 1, "1 is missing");
        assert!(open(false, || Err(Error::input("damaged"))).is_err() && resume.join("item-00.h5").exists());
        assert_eq!(open(true, || Err(Error::input("damaged"))).unwrap(), 0);
        assert!(!resume.join("item-00.h5").exists(), "--force clears");
    }
}
