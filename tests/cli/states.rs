//! `squeal states`, as a user meets it.

use std::collections::BTreeMap;

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, assert_refused, swap};

const STATES: &str = "model = \"brake.toml\"\nfriction = [0.3, 0.6]\nband = [0, 60000]\n\
    [[state]]\nname = \"new\"\n\
    [[state]]\nname = \"reverse, hot\"\nset = { \"rotation.disc.speed\" = -5.0 }\nfactor = { \"material.iron.young\" = 0.8 }\n\
    [[state]]\nname = \"worn\"\nwear = { distance = 2e4, steps = 3 }\n";

fn place() -> Place {
    let change = |text: String| swap(&text, "friction = 0.4\n", "friction = 0.4\nwear = 1e-14\n");
    let place = Place::with_blocks(change, &PadOnDisc::default());
    place.write("states.toml", STATES);
    place
}

#[track_caller]
fn done(finished: Finished) -> Finished {
    assert_eq!(finished.code, 0, "{}{}", finished.out, finished.err);
    finished
}

/// Frequencies and growth rates of all modes of a results folder.
fn modes(place: &Place, folder: &str) -> Vec<[f64; 2]> {
    let mut reader = csv::Reader::from_path(place.path(&format!("{folder}/modes.csv"))).unwrap();
    let rows = reader.deserialize::<BTreeMap<String, String>>().map(Result::unwrap);
    rows.map(|row| ["frequency_hz", "growth_rate_per_s"].map(|name| row[name].parse().unwrap())).collect()
}

#[track_caller]
fn assert_same(a: &[[f64; 2]], b: &[[f64; 2]]) {
    assert!(!a.is_empty() && a.len() == b.len());
    let near = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).abs() < 1e-7 * a[0] && (a[1] - b[1]).abs() < 1e-7 * a[0];
    assert!(a.iter().zip(b).all(near), "{a:?} {b:?}");
}

#[test]
fn a_state_is_the_model_with_its_numbers_or_its_wear() {
    let place = place();
    let stability = |model: &str, folder: &str| {
        done(place.run(&["stability", model, "--friction", "0.3,0.6", "--band", "0:60000", "-o", folder]));
    };
    let finished = done(place.run(&["states", "states.toml", "-o", "run"]));
    assert_eq!(place.read("run/summary.txt"), finished.out);
    stability("brake.toml", "alone");
    assert_same(&modes(&place, "run/new"), &modes(&place, "alone"));

    let text = place.read("brake.toml");
    let other = swap(&swap(&text, "speed = 5.0", "speed = -5.0"), "young = 110e9", "young = 88e9");
    place.write("other.toml", other);
    stability("other.toml", "other");
    assert_same(&modes(&place, "run/reverse--hot"), &modes(&place, "other"));

    done(place.run(&["wear", "brake.toml", "--distance", "2e4", "--steps", "3", "-o", "wear"]));
    assert_eq!(place.read("run/worn-worn.csv"), place.read("wear/worn.csv"));
    place.write("worn.toml", swap(&text, "wear = 1e-14", "gap = \"wear/worn.csv\""));
    stability("worn.toml", "worn");
    assert_same(&modes(&place, "run/worn"), &modes(&place, "worn"));

    let document: serde_json::Value = serde_json::from_str(&place.read("run/states.json")).unwrap();
    let states = document["states"].as_array().unwrap();
    assert_eq!(
        states.iter().map(|state| state["state"].as_str().unwrap()).collect::<Vec<_>>(),
        ["new", "reverse, hot", "worn"]
    );
    let spread = states[2]["wear"][0]["pv_spread"].as_f64().unwrap();
    assert!(spread > 0.0 && states[0]["wear"].as_array().unwrap().is_empty());
    let page = place.read("run/states.html");
    assert!(page.contains("reverse--hot.html") && page.contains("new: peak") && page.contains("worn: peak"));
    assert!(place.read("run/reverse--hot.html").starts_with("<!DOCTYPE html>"));
}

#[test]
fn only_states_that_have_changed_are_made_again() {
    let place = place();
    let made = |finished: &Finished| {
        let lines = finished.err.lines().filter(|line| line.contains(": begins"));
        lines.map(|line| line.split(": begins").next().unwrap().trim().to_owned()).collect::<Vec<_>>()
    };
    let run = || done(place.run(&["states", "states.toml", "-o", "run"]));
    let first = run();
    assert_eq!(made(&first), ["new", "reverse, hot", "worn"]);
    place.write("states.toml", swap(STATES, "-5.0", "-6.0"));
    assert_eq!(made(&run()), ["reverse, hot"]);
    let again = run();
    assert!(made(&again).is_empty() && again.err.contains("worn: made before"), "{}", again.err);
}

#[test]
fn states_that_cannot_be_are_refused_before_anything_is_computed() {
    let place = place();
    let refused = |old: &str, new: &str, parts: &[&str]| {
        place.write("states.toml", swap(STATES, old, new));
        assert_refused(&place.run(&["states", "states.toml", "-o", "run"]), parts);
        assert!(!place.path("run").exists());
    };
    refused("rotation.disc.speed", "rotation.disk.speed", &["state \"reverse, hot\"", "Did you mean \"disc\"?"]);
    refused("= -5.0", "= 0", &["state \"reverse, hot\"", "speed is 0, so that nothing turns"]);
    refused("brake.toml", "none.toml", &["none.toml", "cannot read the model file"]);
    place.write("brake.toml", swap(&place.read("brake.toml"), "wear = 1e-14\n", ""));
    refused("model", "model", &["state \"worn\"", "no sliding contact has a wear coefficient"]);
    place.write("states.toml", STATES);
    place.write("thesis.tex", "");
    assert_refused(&place.run(&["states", "states.toml", "-o", "."]), &["is not the folder of a study"]);
}
