//! What a run finds in the folder that an earlier one has left.

use std::path::Path;

use crate::output::files::write_file;
use crate::output::folder::{Folder, RESUME};
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
    /// Number of finished items in an unfinished folder, which is emptied where they cannot be used and `force` is set.
    /// `check` takes the number of items.
    ///
    /// # Errors
    /// [`Error::Input`] where another study was begun; those of `check`; the system's.
    pub fn prepare(&self, folder: &Folder, force: bool, check: impl FnOnce(usize) -> Result<()>) -> Result<usize> {
        let place = folder.draft().join(RESUME);
        let n = (0..).find(|&i| !place.join((self.name)(i)).exists()).expect("numbers do not end");
        if n > 0 {
            folder.keep();
            match self.require_same(&place, n).and_then(|()| check(n)) {
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
