//! Each deck of CalculiX's own tests is read, or refused with one line that names what is unsupported.
//!
//! Source: Debian's package calculix-ccx-test. The list goes into the manual.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use squeal::ErrorKind;
use squeal::deck::{self, KnownUnits};

/// Where Debian installs the decks.
const FOLDER: &str = "/usr/share/doc/calculix-ccx-test/examples/test";
/// What this test writes.
const LIST: &str = "docs/manual/src/calculix-decks.md";

fn decks() -> Vec<PathBuf> {
    let entries = fs::read_dir(FOLDER).expect("`scripts/setup.sh --tests` installs calculix-ccx-test");
    let all = entries.map(|entry| entry.unwrap().path());
    let mut all: Vec<PathBuf> = all.filter(|path| path.extension().is_some_and(|end| end == "inp")).collect();
    all.sort();
    all
}

#[test]
fn each_deck_of_calculix_is_read_or_refused_with_one_line() {
    let (mut rows, mut n_parsed, mut n_read) = (String::new(), 0, 0);
    let all = decks();
    assert!(all.len() > 100, "{} decks", all.len());
    for path in &all {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let parsed = deck::parse(path);
        n_parsed += usize::from(parsed.is_ok());
        let result = match parsed.and_then(|deck| deck::convert::convert(&deck, KnownUnits::default())) {
            Ok(_) => {
                n_read += 1;
                "read".to_owned()
            }
            Err(error) => {
                assert_eq!(error.kind(), ErrorKind::Input, "{name}");
                let message = error.to_string().replace(&format!("{FOLDER}/"), "");
                assert!(message.starts_with(&format!("{name}:")) && message.lines().count() == 1, "{message}");
                message.strip_prefix(&format!("{name}:")).unwrap().replace('|', "/")
            }
        };
        writeln!(rows, "| {name} | {result} |").unwrap();
    }
    let text = format!(
        "# CalculiX's own decks\n\nEach deck of Debian's package calculix-ccx-test is read, or refused with one line: the line of \
         the deck,\nand what is not supported. `make calculix` writes this page.\n\nOf {} decks the parser takes {n_parsed}, and \
         {n_read} become a model.\n\n| deck | result |\n|---|---|\n{rows}",
        all.len()
    );
    fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join(LIST), text).unwrap();
    assert!(n_parsed >= 5);
}
