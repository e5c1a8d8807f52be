//! What a folder of several analyses has already: so that a study that is run again makes only what is missing or out
//! of date.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::output::files::write_whole;
use crate::output::overwrite::is_free;
use crate::{Error, Result};

/// What is made.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Record {
    /// By the names of their files and folders.
    #[serde(default)]
    pub parts: BTreeMap<String, Done>,
}

/// A part that is made.
#[derive(Serialize, Deserialize)]
pub(super) struct Done {
    /// What it depends on.
    pub identity: String,
    /// What it took, s.
    pub seconds: f64,
}

/// The record's file, which marks a folder as a study's.
const PARTS: &str = "parts.toml";

impl Record {
    /// Of a folder that is a study's, or empty, or not there.
    pub fn open(place: &Path) -> Result<Record> {
        let file = place.join(PARTS);
        if let Ok(text) = std::fs::read_to_string(&file) {
            let damaged =
                |reason| Error::input(format!("{} is damaged: {reason}. Remove it to begin again", file.display()));
            return toml::from_str(&text).map_err(damaged);
        }
        if is_free(place) {
            return Ok(Record::default());
        }
        let what = format!("{} exists and is not the folder of a study", place.display());
        Err(Error::input(format!("{what}. Choose another with --output")))
    }

    /// Whether a product is made as it has to be, and its file is there.
    pub fn has(&self, product: &str, identity: &str, file: &Path) -> bool {
        self.parts.get(product).is_some_and(|done| done.identity == identity) && file.is_file()
    }

    /// Appears whole or not at all.
    pub fn write(&self, place: &Path) -> Result<()> {
        let text = toml::to_string(self).expect("texts and numbers");
        write_whole(&place.join(PARTS), |out| out.write_all(text.as_bytes()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_made_again_where_its_file_is_missing_or_its_identity_is_another() {
        let place = tempfile::TempDir::new().unwrap();
        let (product, file) = ("a.se.h5", place.path().join("a.se.h5"));
        let mut record = Record::default();
        record.parts.insert(product.into(), Done { identity: "model 1".into(), seconds: 2.0 });
        assert!(!record.has(product, "model 1", &file), "no file");
        std::fs::write(&file, "").unwrap();
        assert!(record.has(product, "model 1", &file) && !record.has(product, "model 2", &file));
        record.write(place.path()).unwrap();
        assert!(Record::open(place.path()).unwrap().has(product, "model 1", &file));
    }

    #[test]
    fn a_folder_with_something_else_is_no_study() {
        let place = tempfile::TempDir::new().unwrap();
        assert!(Record::open(&place.path().join("new")).unwrap().parts.is_empty());
        std::fs::write(place.path().join("thesis.tex"), "").unwrap();
        let error = Record::open(place.path()).err().unwrap().to_string();
        assert!(error.contains("is not the folder of a study"), "{error}");
    }
}
