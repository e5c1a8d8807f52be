//! `squeal reduce` and what is done with its file, as a user meets them.

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Place, assert_refused, swap};

/// The small pad on its disc, reduced to four contacts and the fixed-interface modes up to four times the band.
const REDUCE: [&str; 8] = ["reduce", "brake.toml", "--contacts", "4", "--limit", "240000", "--output", "brake.se.h5"];
/// The band of the tests, Hz.
const BAND: &str = "--band=0:60000";

fn reduced() -> Place {
    let reduction = "[reduction]\ncontacts = 4\nband = [0, 240000]\n";
    let place = Place::with_blocks(|text| text + reduction, &PadOnDisc::default());
    let finished = place.run(&REDUCE);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(finished.out.contains("4 contacts, 9 retained points"), "{}", finished.out);
    assert!(
        finished.out.contains("one LDL^T factor") && finished.out.contains("results in brake.se.h5"),
        "{}",
        finished.out
    );
    place
}

/// Frequencies and growth rates of a run.
fn modes(place: &Place, folder: &str) -> Vec<[f64; 2]> {
    let text = place.read(&format!("{folder}/modes.csv"));
    let row = |line: &str| {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        [fields[2], fields[3]]
    };
    text.lines().skip(1).map(row).collect()
}

/// Frequencies to the tolerance, growth rates to that part of the frequency.
#[track_caller]
fn assert_same(found: &[[f64; 2]], expected: &[[f64; 2]], tolerance: f64) {
    assert!(!expected.is_empty() && found.len() == expected.len(), "{found:?} and {expected:?}");
    for (f, e) in found.iter().zip(expected) {
        assert!((f[0] - e[0]).abs() < tolerance * e[0] && (f[1] - e[1]).abs() < tolerance * e[0], "{f:?} and {e:?}");
    }
}

#[test]
fn a_super_element_has_the_modes_of_its_model() {
    let place = reduced();
    let full = ["stability", "brake.toml", "--contacts", "4", "--friction", "0.4", "--output", "full", BAND];
    assert_eq!(place.run(&full).code, 0);
    let finished = place.run(&["stability", "brake.se.h5", "--output", "reduced", BAND]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert_same(&modes(&place, "reduced"), &modes(&place, "full"), 1e-6);
    let each =
        ["stability", "brake.toml", "--contacts", "4", "--friction", "0.4", "--reduce-each", "--output", "each", BAND];
    assert_eq!(place.run(&each).code, 0);
    assert_same(&modes(&place, "each"), &modes(&place, "reduced"), 1e-9);
    let files = place.list("reduced");
    assert!(files.iter().any(|name| name == "equilibrium_mu0.400.vtu"), "{files:?}");
    let finished =
        place.run(&["static", "brake.se.h5", "--friction", "0.2", "--law", "cubic:1e9,1e19", "--pressure", "2"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(finished.out.contains("disc / pad"), "{}", finished.out);
}

#[test]
fn two_ranks_make_and_use_the_same_super_element() {
    let place = reduced();
    assert_eq!(place.run(&["stability", "brake.se.h5", "--output", "one", BAND]).code, 0);
    let finished = place.run_on(2, &[&REDUCE[..6], &["--output", "two.se.h5"]].concat());
    assert_eq!(finished.code, 0, "{}", finished.err);
    let finished = place.run_on(2, &["stability", "two.se.h5", "--output", "two", BAND]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert_same(&modes(&place, "two"), &modes(&place, "one"), 1e-8);
    // The first rank works alone, and all end together.
    assert!(finished.out.contains(" on 1 rank:"), "{}", finished.out);
    let finished = place.run_on(2, &["stability", "two.se.h5", "--contacts", "12"]);
    assert_eq!((finished.code, finished.err.matches("--contacts is for models").count()), (2, 1), "{}", finished.err);
}

#[test]
fn a_file_that_is_no_super_element_is_refused() {
    let place = reduced();
    let bytes = std::fs::read(place.path("brake.se.h5")).unwrap();
    place.write("cut.se.h5", &bytes[..bytes.len() / 2]);
    let stability = |file: &str| place.run(&["stability", file, "--output", "none"]);
    assert_refused(&stability("cut.se.h5"), &["cut.se.h5", "incomplete or damaged", "squeal reduce"]);

    std::fs::copy(place.path("brake.se.h5"), place.path("new.se.h5")).unwrap();
    let file = hdf5::File::open_rw(place.path("new.se.h5")).unwrap();
    file.attr("version").unwrap().write_scalar(&7).unwrap();
    file.close().unwrap();
    assert_refused(
        &stability("new.se.h5"),
        &["is of version 7, this program reads version 6", "again with `squeal reduce`"],
    );

    std::fs::copy(place.path("brake.se.h5"), place.path("nan.se.h5")).unwrap();
    let file = hdf5::File::open_rw(place.path("nan.se.h5")).unwrap();
    let load = file.dataset("load").unwrap();
    load.write_raw(&vec![f64::NAN; load.size()]).unwrap();
    drop(load);
    file.close().unwrap();
    assert_refused(&stability("nan.se.h5"), &["load holds values that are not finite"]);

    hdf5::File::create(place.path("other.h5")).unwrap().close().unwrap();
    assert_refused(&stability("other.h5"), &["not of the kind \"squeal super-element\""]);
    assert!(!place.path("none").exists());
}

/// `reduce` prints at which equilibrium the geometric stiffness is frozen, both kinds of super-element have it in their
/// file, and each the modes of its model there.
#[test]
fn prestress_is_frozen_and_printed() {
    let change = |text: String| {
        let text = swap(&text, "[stability]\nband = [0, 20000]", "[stability]\nprestress = true\nband = [0, 60000]");
        swap(&text, "[0, 0, -1000]", "[0, 0, -100000]") + "[reduction]\ncontacts = 4\nband = [0, 240000]\n"
    };
    let place = Place::with_blocks(change, &PadOnDisc::default());
    let line = "prestress is frozen: its modes have the geometric stiffness of the equilibrium at friction 0.4\n";
    let galerkin = ["reduce", "brake.toml", "--galerkin", "--samples", "0.4", "--output", "galerkin.se.h5"];
    for (arguments, file, model, tolerance) in [
        (&REDUCE[..], "brake.se.h5", &["brake.toml", "--contacts", "4"][..], 1e-5),
        (&galerkin, "galerkin.se.h5", &["brake.toml"], 1e-5),
    ] {
        let finished = place.run(arguments);
        assert_eq!(finished.code, 0, "{}", finished.err);
        assert!(finished.out.contains(line), "{}", finished.out);
        let options = ["--friction", "0.4", "--force", "--output"];
        for (structure, folder) in [(model, "full"), (&[file], "reduced")] {
            let finished = place.run(&[&["stability"], structure, &options, &[folder]].concat());
            assert_eq!(finished.code, 0, "{}", finished.err);
        }
        assert_same(&modes(&place, "reduced"), &modes(&place, "full"), tolerance);
    }
}

#[test]
fn what_a_super_element_does_not_hold_is_refused() {
    let place = reduced();
    let with = |more: &[&str]| place.run(&[&["stability", "brake.se.h5", "--output", "none"], more].concat());
    assert_refused(&with(&["--band", "0:241000"]), &["up to 240000 Hz only", "up to 241000 Hz are asked for"]);
    assert_refused(&with(&["--reduce-each"]), &["a super-element cannot be reduced again"]);
    assert_refused(&with(&["--contacts", "6"]), &["has its contacts already"]);
    assert_refused(&with(&["--law", "cubic:1e9"]), &["two coefficients", "cubic:K1,K3"]);
    assert_refused(&with(&["--law", "cubic"]), &["no coefficients"]);
    assert_refused(&with(&["--pressure", "-1"]), &["is not a number from 1e-6 to 1e6"]);
    assert!(!place.path("none").exists());
    let finished = with(&["--band", "0:121000"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(
        finished.err.contains("warning") && finished.err.contains("above 120000 Hz are less exact"),
        "{}",
        finished.err
    );
    let finished = place.run(&["stability", "brake.toml", "--law", "linear:1e9", "--output", "model"]);
    assert_refused(&finished, &["--law, --gap, --pressure and --damping are for super-elements"]);
}

#[test]
fn a_reduction_that_cannot_be_made_writes_nothing() {
    let place = Place::blocks();
    let reduce = |contacts: &str| place.run(&["reduce", "brake.toml", "--contacts", contacts, "--output", "x.se.h5"]);
    assert_refused(
        &reduce("6"),
        &["brake.toml:", "\"disc / pad\"", "6 reference nodes need at least 18 contact points"],
    );
    assert_refused(&reduce("0"), &["\"0\" is not a whole number above 0"]);
    assert_refused(&place.run(&["reduce", "brake.toml"]), &["how many contacts?", "--contacts"]);
    assert!(!place.list(".").iter().any(|name| name.contains("h5")), "{:?}", place.list("."));
    place.write("x.se.h5", "mine");
    assert_refused(&reduce("4"), &["x.se.h5 exists and is not a super-element of squeal"]);
    assert_eq!(place.read("x.se.h5"), "mine");
}

#[test]
fn check_draws_the_model() {
    let place = Place::blocks();
    let said = place.run(&["check", "brake.toml", "-o", "model.vtu"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let picture = place.read("model.vtu");
    let xml = roxmltree::Document::parse(&picture).unwrap();
    let arrays: Vec<&str> = xml.descendants().filter_map(|node| node.attribute("Name")).collect();
    let names = ["force_n", "constrained", "kind", "part", "pair", "normal"];
    assert!(names.iter().all(|name| arrays.contains(name)), "{arrays:?}");
    assert_refused(&place.run(&["check", "brake.toml", "-o", "model.vtu"]), &["model.vtu exists. Use --force"]);
    assert_refused(
        &place.run(&["check", "brake.toml", "-o", "blocks.msh", "--force"]),
        &["is not a VTU file of squeal"],
    );
    let two = place.run_on(2, &["check", "brake.toml", "-o", "two.vtu"]);
    assert_eq!(two.code, 0, "{}", two.err);
    let n_cells = |file: &str| {
        let text = place.read(file);
        text[text.find("NumberOfCells").unwrap()..].lines().next().unwrap().to_owned()
    };
    assert_eq!(n_cells("two.vtu"), n_cells("model.vtu"));
}

#[test]
fn check_shows_and_draws_a_layout() {
    let place = Place::blocks();
    let finished = place.run(&["check", "brake.toml", "--contacts", "4", "--output", "cells.vtu"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(finished.out.contains("disc / pad: 4 reference nodes, cells of 100.0 to 100.0 mm2"), "{}", finished.out);
    let picture = place.read("cells.vtu");
    roxmltree::Document::parse(&picture).unwrap();
    assert!(picture.contains("Name=\"cell\"") && picture.contains("NumberOfCells=\"24\""));
}
