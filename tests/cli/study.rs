//! `squeal compare` and `squeal study`, as a user meets them.

use std::collections::BTreeMap;
use std::time::SystemTime;

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, assert_refused, swap};

/// The small pad on its disc up to 60 kHz, with fixed-interface modes up to four times that.
fn place() -> Place {
    place_with(&PadOnDisc::default())
}

/// The same with any mesh.
fn place_with(pair: &PadOnDisc) -> Place {
    let change = |text: String| {
        let text = swap(&text, "[part.disc]\n", "[part.disc]\nrayleigh = { alpha = 40.0, beta = 2e-7 }\n");
        let text = swap(&text, "[part.pad]\n", "[part.pad]\nrayleigh = { alpha = 900.0, beta = 1e-8 }\n");
        swap(&text, "band = [0, 20000]", "band = [0, 60000]") + "[reduction]\ncontacts = 4\nband = [0, 240000]\n"
    };
    Place::with_blocks(change, pair)
}

#[track_caller]
fn done(finished: Finished) -> Finished {
    assert_eq!(finished.code, 0, "{}{}", finished.out, finished.err);
    finished
}

/// The rows of a CSV file by the names of its columns.
fn table(place: &Place, name: &str) -> Vec<BTreeMap<String, String>> {
    let text = place.read(name);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().collect::<Result<_, _>>().unwrap()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} of {row:?} is no number"))
}

#[test]
fn a_super_element_is_compared_with_its_model_mode_by_mode() {
    let place = place();
    let stability =
        |arguments: &[&str]| done(place.run(&[&["stability", "--friction", "0.2,0.4"], arguments].concat()));
    stability(&["brake.toml", "--contacts", "4", "-o", "model"]);
    done(place.run(&["reduce", "brake.toml", "--contacts", "4", "--friction", "0.4", "-o", "brake.se.h5"]));
    stability(&["brake.se.h5", "-o", "element"]);

    let finished = done(place.run(&["compare", "model", "element", "-o", "compared"]));
    assert_eq!(place.read("compared/comparison.txt"), finished.out);
    assert!(finished.out.contains("4 sliding contact points"), "{}", finished.out);
    let rows = table(&place, "compared/comparison.csv");
    assert!(rows.len() > 10 && rows.iter().any(|row| row["friction"] == "0.2"));
    for row in &rows {
        // All other contacts are linear here, so that one super-element serves all friction values.
        let at_most = |column: &str, most: f64| assert!(number(row, column).abs() < most, "{column}: {row:?}");
        at_most("frequency_error", 1e-5);
        at_most("growth_error", 1e-3);
        assert!(number(row, "mac") > 0.9999, "{row:?}");
    }
    let figure = place.read("compared/comparison.svg");
    let figure = roxmltree::Document::parse(&figure).unwrap();
    let n_marks = figure.descendants().filter(|node| node.has_tag_name("circle")).count();
    assert_eq!(n_marks, 3 * rows.len() + 1, "a mark for each mode in three panels, and the legend's");

    let itself = done(place.run(&["compare", "model", "model"]));
    assert!(itself.out.contains("1.0000"), "{}", itself.out);
    assert!(!place.list(".").contains(&"model-model".into()), "nothing is written unasked");
}

#[test]
fn results_that_have_nothing_in_common_are_refused_on_two_ranks() {
    let place = place();
    done(place.run(&["stability", "brake.toml", "--friction", "0.2", "-o", "a"]));
    done(place.run(&["stability", "brake.toml", "--friction", "0.4", "-o", "b"]));
    let finished = place.run(&["compare", "a", "b", "-o", "compared"]);
    assert_refused(&finished, &["a and b", "no common friction: 0.2 and 0.4", "--friction"]);
    assert_refused(
        &place.run(&["compare", "a", "nowhere"]),
        &["nowhere", "contains no results.h5", "squeal stability"],
    );
    assert_refused(&place.run_on(2, &["compare", "a", "brake.toml"]), &["brake.toml"]);
    assert!(!place.path("compared").exists());
}

/// A study of two layouts and super-elements.
const STUDY: [&str; 8] = ["study", "brake.toml", "--friction", "0.2,0.4", "--layouts", "4,8", "--super-element", "8"];
const PARTS: [&str; 6] = ["full", "contacts-4", "contacts-8", "super-element-8", "super-element-8-each", "galerkin"];

/// When the results of all parts were written.
fn times(place: &Place) -> Vec<SystemTime> {
    let time =
        |part: &&str| place.path(&format!("brake-study/{part}/results.h5")).metadata().unwrap().modified().unwrap();
    PARTS.iter().map(time).collect()
}

#[test]
fn a_study_compares_all_models_with_full_contact_and_reuses_files_on_two_ranks() {
    let place = place_with(&PadOnDisc { pad_cells: 3, ..Default::default() });
    let finished = done(place.run(&STUDY));
    assert!(
        place.read("brake-study/summary.txt")
            == finished.out[finished.out.len() - place.read("brake-study/summary.txt").len()..]
    );
    let sizes = table(&place, "brake-study/sizes.csv");
    let column = |name: &str| sizes.iter().map(|row| row[name].as_str()).collect::<Vec<_>>();
    assert_eq!(column("retained_points"), ["", "9", "17", "17", "17", ""]);
    assert_eq!(column("contact_points")[1..5], ["4", "8", "8", "8"]);
    let dofs: Vec<f64> = sizes.iter().map(|row| number(row, "dofs")).collect();
    assert!(dofs[..3].iter().all(|n| *n == dofs[0]) && dofs[3] < dofs[0], "{dofs:?}");
    assert_eq!(dofs[3], dofs[4]);

    let errors = table(&place, "brake-study/errors.csv");
    let worst = |model: &str| {
        let own = errors.iter().filter(|row| row["model"].starts_with(model));
        own.map(|row| number(row, "worst_frequency_error")).fold(0.0, f64::max)
    };
    let at_values = errors.iter().filter(|row| ["0.2", "0.4"].contains(&row["friction"].as_str()));
    assert_eq!(at_values.count(), 10, "values in between, where both have been solved, come on top");
    assert!(worst("8 contacts") < worst("4 contacts"), "errors fall with the number of contacts");
    let difference = worst("super-element of 8, made at each") - worst("8 contacts");
    assert!(difference.abs() < 1e-5, "a super-element is its layout: {difference}");
    assert!(worst("super-element, Galerkin") < 1e-4, "it has all contact points");

    let before = times(&place);
    let again = done(place.run(&STUDY));
    assert_eq!(again.err.matches("made before").count(), 8, "{}", again.err);
    assert!(times(&place) == before && finished.out.ends_with(&again.out), "{}", again.out);

    std::fs::remove_dir_all(place.path("brake-study/contacts-4")).unwrap();
    let again = done(place.run_on(2, &STUDY));
    assert_eq!(again.err.matches("made before").count(), 7, "{}", again.err);
    let after = times(&place);
    assert!(after[1] > before[1] && after[2..] == before[2..] && after[0] == before[0]);

    place.write("brake.toml", swap(&place.read("brake.toml"), "force = [0, 0, -1000]", "force = [0, 0, -1100]"));
    let again = done(place.run(&STUDY));
    assert_eq!(again.err.matches("begins").count(), 8, "another model: all is made again: {}", again.err);
}

#[test]
fn a_study_that_cannot_be_made_writes_nothing() {
    let place = place_with(&PadOnDisc { pad_cells: 3, ..Default::default() });
    assert_refused(
        &place.run(&[&STUDY[..4], &["--layouts", "4,60"]].concat()),
        &["\"disc / pad\"", "60 reference nodes"],
    );
    assert_refused(&place.run(&[&STUDY[..4], &["--layouts", "4,2"]].concat()), &["unconstrained", "pad moves along"]);
    assert!(!place.path("brake-study").exists());
    std::fs::create_dir(place.path("mine")).unwrap();
    place.write("mine/thesis.tex", "all of it");
    assert_refused(
        &place.run(&[&STUDY[..], &["-o", "mine"]].concat()),
        &["mine", "not the folder of a study", "--output"],
    );
    assert_eq!(place.list("mine"), ["thesis.tex"]);
}
