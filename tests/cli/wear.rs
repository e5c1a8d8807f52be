//! `squeal wear` and gap fields, as a user meets them.

use std::collections::BTreeMap;

use squeal::structure::FullModel;
use squeal::{Comm, Session};

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, assert_refused, end, signal, start, swap};

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
    let two = place.run(&["wear", "brake.toml", "--distance", "1", "--friction", "0.1,0.2"]);
    assert_refused(&two, &["at one friction coefficient"]);
    let usage = place.run(&["wear", "brake.toml"]);
    assert!(usage.code == 2 && usage.err.contains("--distance"), "{}", usage.err);
}

/// Wear that ends early, in whatever way, goes on with the same command and ends with the same files.
#[test]
fn wear_that_is_killed_ends_with_the_same_files() {
    let place = place();
    let arguments = ["wear", "brake.toml", "--distance", "2e4", "--steps", "12", "-o", "run"];
    done(place.run(&arguments));
    let files = ["worn.csv", "steps.csv", "contact_before.vtu", "contact_worn.vtu"];
    let expected = files.map(|file| place.read(&format!("run/{file}")));
    std::fs::remove_dir_all(place.path("run")).unwrap();
    for n in [1, 4] {
        let mut child = start(&place, 1, &arguments);
        place.wait_for(&mut child, "step-", n);
        child.kill().unwrap();
        assert_ne!(end(child).code, 0, "killed before its end");
        assert!(place.n_kept("step-") >= n && !place.path("run").exists());
    }
    let n = place.n_kept("step-");
    let mut child = start(&place, 1, &arguments);
    place.wait_for(&mut child, "step-", n + 1);
    signal("TERM", child.id());
    let Finished { code, out, err } = end(child);
    assert_eq!((code, out.as_str()), (143, ""), "{err}");
    for part in ["stopping after this value", "stopped after ", " equilibria are done. The same command goes on"] {
        assert!(err.contains(part), "{part}: {err}");
    }
    let other = place.run(&[&arguments[..4], &["--steps", "13", "-o", "run"]].concat());
    assert_refused(&other, &["run is unfinished (", "equilibria are done", "goal was Distance", "--force"]);
    let text = place.read("brake.toml");
    place.write("brake.toml", swap(&text, "-1000", "-1001"));
    assert_refused(&place.run(&arguments), &["SHA-256 of the model was "]);
    place.write("brake.toml", &text);
    let finished = done(place.run(&arguments));
    assert!(finished.err.contains("an earlier run has finished"), "{}", finished.err);
    for (file, expected) in files.iter().zip(expected) {
        assert!(place.read(&format!("run/{file}")) == expected, "{file} differs");
    }
    assert!(!place.path(".run.unfinished").exists());
}

/// A file that another rank than the first one cannot read is refused, and begun again with --force.
#[test]
fn wear_with_a_damaged_file_of_the_second_rank_begins_again_by_force() {
    let place = place();
    let arguments = ["wear", "brake.toml", "--distance", "2e4", "--steps", "60", "-o", "run"];
    let mut child = start(&place, 2, &arguments);
    place.wait_for(&mut child, "step-", 2);
    let ranks = std::fs::read_to_string(format!("/proc/{0}/task/{0}/children", child.id())).unwrap();
    signal("KILL", ranks.split_whitespace().last().unwrap().parse().unwrap());
    let stopped = end(child);
    assert!(stopped.code != 0 && place.n_kept("step-") >= 2, "{}{}", stopped.out, stopped.err);
    place.write(".run.unfinished/.resume/state-0000.1.bin", [1]);
    let refused = place.run_on(2, &arguments);
    assert_refused(&refused, &["state-0000.1.bin is incomplete or damaged", "--force"]);
    let finished = done(place.run_on(2, &[&arguments[..4], &["--steps", "2", "-o", "run", "--force"]].concat()));
    assert!(!finished.err.contains("an earlier run has finished"), "{}", finished.err);
}

/// Largest difference of two columns, relative to the largest number.
fn difference(place: &Place, files: [&str; 2], name: &str) -> f64 {
    let [a, b] = files.map(|file| column(place, file, name));
    assert!(a.len() == b.len() && !a.is_empty());
    let largest = a.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

/// A layout and the super-element of it with all modes wear alike, and have the same modes with their worn gaps, read
/// from the model file and by `--gap`.
#[test]
fn a_super_element_wears_as_the_layout_that_it_reduces() {
    let place = place();
    // A stiffness that depends on the pressure.
    let cubic = swap(&place.read("brake.toml"), "law = { linear = 2e13 }", "law = { cubic = [2e13, 1e27] }");
    place.write("brake.toml", cubic);
    let layout = ["--contacts", "4"];
    done(place.run(&[&["reduce", "brake.toml", "--limit", "1e9", "--output", "brake.se.h5"], &layout[..]].concat()));
    let goal = ["--distance", "2e4", "--steps", "3", "-o"];
    let out = done(place.run(&[&["wear", "brake.toml"], &goal[..], &["layout"], &layout].concat())).out;
    assert!(out.contains("contact_before.vtu") && place.path("layout/contact_worn.vtu").exists());
    let out = done(place.run(&[&["wear", "brake.se.h5"], &goal[..], &["element"]].concat())).out;
    assert!(out.contains("--gap reads it") && !out.contains(".vtu"), "{out}");
    let files = ["layout/worn.csv", "element/worn.csv"];
    for (name, allowed) in [("x_m", 1e-14), ("gap_m", 1e-8), ("wear_m", 1e-8), ("pressure_pa", 1e-8)] {
        let found = difference(&place, files, name);
        println!("{name}: {found:.1e}");
        assert!(found < allowed, "{name}: {found}");
    }
    let steps = ["layout/steps.csv", "element/steps.csv"];
    assert!(difference(&place, steps, "mass_kg") < 1e-8 && difference(&place, steps, "pv_spread") < 1e-8);
    // Two ranks give the same: the first works alone.
    done(place.run_on(2, &[&["wear", "brake.se.h5"], &goal[..], &["two"]].concat()));
    assert_eq!(place.read("two/worn.csv"), place.read("element/worn.csv"));

    let text = place.read("brake.toml");
    place.write("worn.toml", swap(&text, COEFFICIENT, &format!("{COEFFICIENT}gap = \"layout/worn.csv\"\n")));
    let sweep = ["--friction", "0.4", "--band", "0:60000", "--no-branches", "-o"];
    done(place.run(&[&["stability", "worn.toml"], &sweep[..], &["full"], &layout].concat()));
    done(place.run(&[&["stability", "brake.se.h5", "--gap", "element/worn.csv"], &sweep[..], &["reduced"]].concat()));
    done(place.run(&[&["stability", "brake.se.h5"], &sweep[..], &["new"]].concat()));
    let error = difference(&place, ["full/modes.csv", "reduced/modes.csv"], "frequency_hz");
    println!("frequencies: {error:.1e}");
    assert!(error < 1e-7, "{error}");
    assert!(difference(&place, ["full/modes.csv", "new/modes.csv"], "frequency_hz") > 1e-5, "wear counts");

    // A super-element of the worn layout has its gaps, in whose place a field comes.
    done(place.run(&[&["reduce", "worn.toml", "--limit", "1e9", "--output", "worn.se.h5"], &layout[..]].concat()));
    for gap in [&[][..], &["--gap", "element/worn.csv"]] {
        done(place.run(&[&["stability", "worn.se.h5", "--force"], &sweep[..], &["worn"], gap].concat()));
        let error = difference(&place, ["full/modes.csv", "worn/modes.csv"], "frequency_hz");
        assert!(error < 1e-7, "{error}");
    }
}

#[test]
fn gap_fields_of_super_elements_are_read_and_refused_as_those_of_models() {
    let place = Place::blocks();
    done(place.run(&["reduce", "brake.toml", "--contacts", "4", "--output", "brake.se.h5"]));
    let run = |gap: &str| place.run(&["static", "brake.se.h5", "--gap", gap, "-o", "run"]);
    assert_refused(&run("none.csv"), &["--gap, contact \"disc / pad\"", "none.csv"]);
    place.write("other.csv", "contact,x_mm,y_mm,gap_um\nother,1,2,3\n");
    assert_refused(&run("other.csv"), &["other.csv has no row of this contact"]);
    assert_refused(&place.run(&["static", "brake.toml", "--gap", "other.csv"]), &["--gap", "are for super-elements"]);
    let wear = place.run(&["wear", "brake.se.h5", "--distance", "1"]);
    assert_refused(&wear, &["brake.se.h5: no sliding contact has a wear coefficient", "squeal reduce"]);
}
