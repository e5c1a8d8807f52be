//! `squeal wear` and gap fields, as a user meets them.

use std::collections::BTreeMap;

use squeal::structure::FullModel;
use squeal::{Comm, Session};

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, assert_refused, swap};

const COEFFICIENT: &str = "friction = 0.4\nwear = 1e-14\n";

/// The small pad on its disc, whose contact wears.
fn place() -> Place {
    place_with(COEFFICIENT)
}

fn place_with(contact: &str) -> Place {
    Place::with_blocks(|text| swap(&text, "friction = 0.4\n", contact), &PadOnDisc::default())
}

#[track_caller]
fn done(finished: Finished) -> Finished {
    assert_eq!(finished.code, 0, "{}{}", finished.out, finished.err);
    finished
}

/// A column of a table.
fn column(place: &Place, file: &str, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(place.path(file)).unwrap();
    let rows = reader.deserialize::<BTreeMap<String, String>>();
    rows.map(|row| row.unwrap()[name].parse().unwrap()).collect()
}

/// Gaps of the contact points by place, as the table has them.
fn gaps(comm: &Comm, place: &Place, model: &str) -> Vec<f64> {
    let mut points = FullModel::read(comm, &place.path(model)).unwrap().interface.points;
    points.sort_by(|a, b| a.position.partial_cmp(&b.position).unwrap());
    points.iter().map(|point| point.law.gap).collect()
}

#[test]
fn worn_gaps_are_written_and_read_again() {
    let (comm, place) = (Session::start(&[]).unwrap(), place());
    let finished = done(place.run(&["wear", "brake.toml", "--distance", "2e4", "--steps", "4", "-o", "run"]));
    assert_eq!(place.read("run/summary.txt"), finished.out);
    let off = finished.out.split("k sum p v dt differ by ").nth(1).unwrap().lines().next().unwrap();
    assert!(off.parse::<f64>().unwrap() < 1e-12, "mass balance: {off}");
    assert_eq!(column(&place, "run/steps.csv", "step"), [0.0, 1.0, 2.0, 3.0, 4.0]);
    let spread = column(&place, "run/steps.csv", "pv_spread");
    assert!(spread[4] < spread[0], "{spread:?}");
    assert!(place.path("run/contact_before.vtu").exists() && place.path("run/contact_worn.vtu").exists());

    let text = place.read("brake.toml");
    place.write("worn.toml", swap(&text, COEFFICIENT, &format!("{COEFFICIENT}gap = \"run/worn.csv\"\n")));
    let worn = column(&place, "run/worn.csv", "wear_m");
    for ((new, worn), depth) in gaps(&comm, &place, "brake.toml").iter().zip(gaps(&comm, &place, "worn.toml")).zip(worn)
    {
        assert!((worn - new - depth).abs() < 1e-18, "{worn} {new} {depth}");
    }

    // The pressure is that at the end of the wear, and wear continues from there.
    done(place.run(&["wear", "worn.toml", "--distance", "1e-6", "--steps", "1", "-o", "again"]));
    let [before, after] = [("run", "pressure_pa"), ("again", "pressure_before_pa")]
        .map(|(folder, name)| column(&place, &format!("{folder}/worn.csv"), name));
    let largest = before.iter().copied().fold(0.0, f64::max);
    assert!(before.iter().zip(&after).all(|(a, b)| (a - b).abs() < 1e-6 * largest), "{before:?} {after:?}");
    let [given, gap] = ["run", "again"].map(|folder| column(&place, &format!("{folder}/worn.csv"), "gap_m"));
    assert!(given.iter().zip(&gap).all(|(given, gap)| (gap - given).abs() < 1e-12));
}

#[test]
fn wear_on_two_ranks_is_that_on_one() {
    let place = place();
    let arguments = ["wear", "brake.toml", "--until-uniform", "0.05", "-o"];
    done(place.run(&[&arguments[..], &["one"]].concat()));
    done(place.run_on(2, &[&arguments[..], &["two"]].concat()));
    let [one, two] = ["one", "two"].map(|folder| column(&place, &format!("{folder}/worn.csv"), "wear_m"));
    assert!(one.iter().zip(&two).all(|(a, b)| (a - b).abs() < 1e-12), "{one:?} {two:?}");
    let document = done(place.run(&[&arguments[..], &["one", "--force", "--json"]].concat())).out;
    let document: serde_json::Value = serde_json::from_str(&document).unwrap();
    // Friction tilts the pad, whose wear rate becomes steady and not uniform.
    assert_eq!(document["end"], "steady", "{document}");
    let steps = document["steps"].as_array().unwrap();
    let spread = |step: &serde_json::Value| step["pairs"][0]["pv_spread"].as_f64().unwrap();
    let [before, last] = [&steps[steps.len() - 2], &steps[steps.len() - 1]].map(spread);
    assert!(last > 0.05 && (last - before).abs() < 1e-3, "{before} {last}");
}

#[test]
fn what_does_not_wear_is_refused() {
    let wear = |place: &Place| place.run(&["wear", "brake.toml", "--distance", "1"]);
    assert_refused(&wear(&Place::blocks()), &["no sliding contact has a wear coefficient", "wear = 1e-14"]);
    let still = Place::with_blocks(
        |text| {
            let start = text.find("[[rotation]]").unwrap();
            let end = text.find("[[contact]]").unwrap();
            let text = format!("{}{}", &text[..start], &text[end..]);
            swap(&text, "friction = 0.4\n", "friction = 0.4\nstick = 1e13\nwear = 1e-14\n")
        },
        &PadOnDisc::default(),
    );
    assert_refused(&wear(&still), &["contact \"disc / pad\": it has wear and does not slide"]);
    let place = place();
    done(place.run(&["wear", "brake.toml", "--distance", "1e3", "-o", "run"]));
    let text = place.read("brake.toml");
    place.write("worn.toml", swap(&text, COEFFICIENT, "friction = 0.4\ngap = \"run/worn.csv\"\n"));
    let layout = place.run(&["static", "worn.toml", "--contacts", "4"]);
    assert_refused(&layout, &["worn.toml:", "none of a gap field", "Use full contact"]);
    let usage = place.run(&["wear", "brake.toml"]);
    assert!(usage.code == 2 && usage.err.contains("--distance"), "{}", usage.err);
}
