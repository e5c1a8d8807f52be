//! Each deck of CalculiX's own tests is read, or refused with one line that names what is unsupported; what is read is
//! computed and compared with CalculiX's results.
//!
//! Source: Debian's package calculix-ccx-test. The table goes into the manual.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use squeal::ErrorKind;
use squeal::deck::{self, Converted, Deck, KnownUnits};
use squeal::model::{Inertia, UnitSystem};
use squeal::native::{Comm, Session};

use super::references::{Reference, compute, model, reference};

/// Where Debian installs the decks, some of them packed.
const FOLDER: &str = "/usr/share/doc/calculix-ccx-test/examples/test";
/// What this test writes.
const LIST: &str = "docs/manual/src/calculix-decks.md";
/// Largest difference of displacements, relative to the largest one, and of frequencies.
const SAME: f64 = 1e-5;

/// Decks that differ by more than [`SAME`], and why.
const DIFFERENT: &[(&str, &str)] = &[
    ("beampic.inp", "CalculiX's iterative solver stops early: its direct one differs by 1.7e-3"),
    ("beamptied6.inp", "contact points: 4 of an 8-node facet; with 9, or with the 56 of CalculiX, 2e-7"),
    ("contact4.inp", "contact points of second-order faces"),
    ("cubespring.inp", "CalculiX's springs at nodes, in place of points of a facet"),
    ("hueeber1.inp", "contact points: CalculiX's faces are cut by the master's edges"),
    ("hueeber2.inp", "contact points: CalculiX's faces are cut by the master's edges"),
    ("hueeber3.inp", "contact points: CalculiX's faces are cut by the master's edges"),
    ("hueeber4.inp", "contact points: CalculiX's faces are cut by the master's edges"),
    ("segment1.inp", "supports along the axes of *TRANSFORM are stiff equations"),
    ("rotor.inp", "CalculiX's modes are combinations of ten without Coriolis forces: among ours, 4e-4"),
    ("punch1.inp", "contact points of second-order faces, and their gaps under a round punch"),
    ("punch2.inp", "contact points of second-order faces, and their gaps under a round punch"),
];

/// Unpacks all decks and results into a folder; gives the decks in the order of their names.
fn unpack(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(FOLDER).expect("`scripts/setup.sh --tests` installs calculix-ccx-test");
    for entry in entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_file()) {
        let (mut bytes, name) = (Vec::new(), entry.file_name().unwrap().to_string_lossy().into_owned());
        match name.strip_suffix(".gz") {
            Some(_) => _ = GzDecoder::new(fs::File::open(&entry).unwrap()).read_to_end(&mut bytes).unwrap(),
            None => bytes = fs::read(&entry).unwrap(),
        }
        fs::write(folder.join(name.trim_end_matches(".gz")), bytes).unwrap();
    }
    let all = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut decks: Vec<PathBuf> = all.filter(|path| path.extension().is_some_and(|end| end == "inp")).collect();
    decks.sort();
    decks
}

/// What becomes of a deck.
enum Outcome {
    /// Refused, with this line.
    Refused(String),
    /// Read; there are no results to compare with.
    Read,
    /// Read and computed.
    Compared(Differences),
    /// Read; the computation ends with this message.
    Failed(String),
}

/// Differences from CalculiX's results.
struct Differences {
    /// From those that are published with the deck.
    published: f64,
    /// From those of ccx for the deck without NLGEOM and PERTURBATION, where it has one of them; from the published
    /// ones with the centrifugal force at x alone, where there is one.
    linear: Option<f64>,
}

impl Differences {
    fn largest(&self) -> f64 {
        self.linear.unwrap_or(self.published)
    }
}

fn outcome(comm: &Comm, path: &Path) -> Outcome {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let without_folder = |message: String| message.replace(&format!("{}/", path.parent().unwrap().display()), "");
    // Decks without meaningful units are read in theirs.
    let units = KnownUnits { system: Some(UnitSystem::named("m-kg-s").unwrap()), length: None };
    let parsed = deck::parse(path);
    let (deck, converted) =
        match parsed.and_then(|deck| deck::convert::convert(&deck, units).map(|converted| (deck, converted))) {
            Ok(both) => both,
            Err(error) => {
                assert_eq!(error.kind(), ErrorKind::Input, "{name}");
                let message = without_folder(error.to_string());
                assert!(message.starts_with(&format!("{name}:")) && message.lines().count() == 1, "{message}");
                return Outcome::Refused(message.strip_prefix(&format!("{name}:")).unwrap().trim().replace('|', "/"));
            }
        };
    let results = fs::read_to_string(path.with_extension("dat.ref")).unwrap_or_default();
    let Some(published) = reference(&results) else { return Outcome::Read };
    compared(comm, path, &deck, converted, &published).unwrap_or_else(|error| {
        Outcome::Failed(without_folder(error.split(". ").next().unwrap_or_default().replace('|', "/")))
    })
}

fn compared(
    comm: &Comm,
    path: &Path,
    deck: &Deck,
    converted: Converted,
    published: &Reference,
) -> Result<Outcome, String> {
    let brake = model(converted)?;
    let difference = |reference: &Reference, is_linear: bool| {
        compute(comm, deck, &brake, reference, is_linear).map(|ours| ours.difference(reference))
    };
    let is_rotor = brake.model.rotations.iter().any(|rotation| rotation.inertia != Inertia::None);
    let linear = match linear_reference(path) {
        Some(reference) => Some(difference(&reference, true)?),
        None if is_rotor => Some(difference(published, true)?),
        None => None,
    };
    Ok(Outcome::Compared(Differences { published: difference(published, false)?, linear }))
}

/// What ccx finds for a deck without NLGEOM and PERTURBATION, where it has one of them. Where modes are those of a
/// contact that displacements press, which ccx computes by PERTURBATION alone, a millionth of these displacements takes
/// the stresses away.
fn linear_reference(path: &Path) -> Option<Reference> {
    let text = fs::read_to_string(path).unwrap();
    if text.contains("PERTURBATION") && text.contains("fix2,3,3,-0.05\n") {
        return computed(&text.replace("fix2,3,3,-0.05\n", "fix2,3,3,-5.e-8\n"));
    }
    let is_step = |line: &&str| line.to_uppercase().starts_with("*STEP");
    let plain = |line: &str| {
        let fields = line.split(',').map(str::trim);
        let kept = fields.filter(|field| !["NLGEOM", "PERTURBATION"].contains(&field.to_uppercase().as_str()));
        kept.collect::<Vec<_>>().join(",")
    };
    let linear: Vec<String> =
        text.lines().map(|line| if is_step(&line) { plain(line) } else { line.to_owned() }).collect();
    if linear.iter().zip(text.lines()).all(|(one, two)| one.replace(' ', "") == two.trim().replace(' ', "")) {
        return None;
    }
    computed(&(linear.join("\n") + "\n"))
}

/// What ccx finds for a deck.
fn computed(deck: &str) -> Option<Reference> {
    let folder = super::run(deck);
    reference(&fs::read_to_string(folder.path().join("deck.dat")).unwrap())
}

#[test]
fn each_deck_of_calculix_is_computed_or_refused_with_one_line() {
    let comm = Session::start(&[]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let all = unpack(folder.path());
    assert!(all.len() > 300, "{} decks", all.len());
    let (mut computed, mut refused, mut wrong) = (String::new(), BTreeMap::<String, Vec<String>>::new(), Vec::new());
    let mut n_same = 0;
    for path in &all {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let reason = DIFFERENT.iter().find(|(deck, _)| *deck == name).map(|(_, reason)| *reason);
        let row = match outcome(&comm, path) {
            Outcome::Refused(line) => {
                refused.entry(line).or_default().push(name.clone());
                continue;
            }
            Outcome::Read => "nothing to compare is printed | | |".to_owned(),
            Outcome::Compared(differences) => {
                let Differences { published, linear } = differences;
                if differences.largest().is_nan() || (differences.largest() > SAME) != reason.is_some() {
                    wrong.push(format!("{name}: {published:.1e}, {linear:?}, {reason:?}"));
                }
                n_same += usize::from(differences.largest() <= SAME);
                let linear = linear.map_or_else(String::new, |linear| format!("{linear:.0e}"));
                format!("{published:.0e} | {linear} | {} |", reason.unwrap_or_default())
            }
            Outcome::Failed(error) => {
                if reason.is_none() {
                    wrong.push(format!("{name}: {error}"));
                }
                format!("not computed: {error} | | {} |", reason.unwrap_or_default())
            }
        };
        println!("{name} {row}");
        writeln!(computed, "| {name} | {row}").unwrap();
    }
    fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join(LIST), page(all.len(), n_same, &computed, &refused)).unwrap();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn page(n: usize, n_same: usize, computed: &str, refused: &BTreeMap<String, Vec<String>>) -> String {
    let n_refused: usize = refused.values().map(Vec::len).sum();
    let mut rows: Vec<(&String, &String)> =
        refused.iter().flat_map(|(line, decks)| decks.iter().map(move |deck| (deck, line))).collect();
    rows.sort();
    let rows: String = rows.iter().map(|(deck, line)| format!("| {deck} | {line} |\n")).collect();
    format!(
        "# CalculiX's own decks\n\nEach deck of Debian's package calculix-ccx-test is read, or refused with one line. What is read is \
         computed and\ncompared with CalculiX's own results. `make calculix` writes this page.\n\nOf {n} decks {} are read and \
         {n_refused} refused. {n_same} have CalculiX's displacements or frequencies to 1e-5.\n\n## Decks that are computed\n\n\
         Difference of displacements, relative to the largest one, or of frequencies with the mass of CalculiX's points: from \
         the\nresults that come with the deck and, where it has NLGEOM or PERTURBATION, from those of ccx without them (beamptied4 to\n7: with a millionth of the displacement, as ccx has no modes in contact without PERTURBATION). With CENTRIF, the linear\ncolumn has the force at x, as CalculiX has it without NLGEOM; the program has it at x + u.\n\n\
         | deck | difference | linear | why it is above 1e-5 |\n|---|---|---|---|\n{computed}\n## Decks that are refused\n\n\
         | deck | line, and what is not supported |\n|---|---|\n{rows}",
        n - n_refused
    )
}
