//! `--json`: one document on standard output for scripts, and errors as one on standard error.

use crate::support::program::{Finished, Place};
use serde_json::Value;

#[track_caller]
fn document(finished: &Finished) -> Value {
    assert_eq!((finished.code, finished.err.as_str()), (0, ""));
    serde_json::from_str(&finished.out).unwrap()
}

/// Requires an object to have just these keys.
#[track_caller]
fn has_keys(object: &Value, keys: &str) {
    let found: Vec<&str> = object.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(found.join(" "), keys);
}

#[test]
fn check_tells_what_a_model_is_on_two_ranks() {
    let place = Place::blocks();
    let check = document(&place.run(&["check", "brake.toml", "--json", "--contacts", "4"]));
    has_keys(
        &check,
        "title mesh parts rotations pairs layouts constrained_dofs connectors connector_loss_factors ties rigid_sets masses equations mass_kg loads sum_of_loads_n warnings free_dofs entries factor_gb",
    );
    assert_eq!(check["parts"][0]["part"], "disc");
    // 30 x 30 x 10 mm of 7100 kg/m3.
    assert!((check["parts"][0]["mass_kg"].as_f64().unwrap() - 0.0639).abs() < 1e-9);
    assert!((check["pairs"][0]["area_m2"].as_f64().unwrap() - 4e-4).abs() < 1e-12);
    assert_eq!(check["layouts"][0]["reference_nodes"], 4);
    assert!((check["sum_of_loads_n"][2].as_f64().unwrap() + 1000.0).abs() < 1e-9);
    let two: Value =
        serde_json::from_str(&place.run_on(2, &["check", "brake.toml", "--json", "--contacts", "4"]).out).unwrap();
    assert_eq!(two["parts"][1]["elements"], check["parts"][1]["elements"]);
}

/// The columns of the tables are the keys.
#[test]
fn a_run_tells_its_tables() {
    let place = Place::pads();
    let finished =
        place.run(&["stability", "brake.toml", "--band=0:1500", "--friction=0.2,0.4", "-o", "run", "--json"]);
    let run = document(&finished);
    has_keys(&run, "about values branches hopf verdict failure costs folder");
    assert_eq!((&run["folder"], run["failure"].is_null()), (&Value::from("run"), true));
    has_keys(&run["verdict"], "status reason criterion text");
    assert_eq!(run["verdict"]["status"], "unstable");
    assert!(run["verdict"]["reason"].as_str().unwrap().starts_with("the model has no damping"));
    assert!(run["verdict"]["text"].as_str().unwrap().starts_with("unstable first at friction 0.4: 1270 Hz"));
    let rows = |name: &str| {
        let mut table = csv::Reader::from_path(place.path(name)).unwrap();
        let header: Vec<String> = table.headers().unwrap().iter().map(str::to_owned).collect();
        let rows: Vec<Vec<String>> =
            table.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect();
        (header, rows)
    };
    let asked = run["values"].as_array().unwrap().iter().filter(|friction| friction["asked"] == true);
    let asked: Vec<&Value> = asked.collect();
    assert_eq!(asked.len(), 2);
    let (header, modes) = rows("run/modes.csv");
    let listed = asked.iter().flat_map(|friction| friction["modes"].as_array().unwrap());
    for (row, mode) in modes.iter().zip(listed) {
        for (name, field) in
            header.iter().zip(row).filter(|(name, _)| !["friction", "unstable"].contains(&name.as_str()))
        {
            let (x, y): (f64, f64) = (field.parse().unwrap(), mode[name].as_f64().unwrap());
            // The reader of JSON rounds the last bit.
            assert!((x - y).abs() <= 1e-15 * y.abs(), "{name}: {x} {y}");
        }
        assert_eq!(mode["unstable"], row[6] == "1");
    }
    let (header, hopf) = rows("run/hopf.csv");
    assert_eq!(hopf.len(), run["hopf"].as_array().unwrap().len());
    header.iter().for_each(|name| assert!(!run["hopf"][0][name].is_null(), "{name}"));
    let (header, contact) = rows("run/contact.csv");
    assert_eq!(contact.len(), 4);
    header[1..].iter().for_each(|name| assert!(!asked[0]["contact"][0][name].is_null(), "{name}"));
    let (header, _) = rows("run/explained.csv");
    let unstable = asked[1]["modes"].as_array().unwrap().iter().find(|mode| mode["unstable"] == true).unwrap();
    header[3..].iter().for_each(|name| assert!(unstable["explained"][0].get(name).is_some(), "{name}"));
}

#[test]
fn statics_and_reduction_have_documents_too() {
    let place = Place::blocks();
    let run = document(&place.run(&["static", "brake.toml", "--json"]));
    assert!(run["verdict"].is_null() && run["values"][0]["modes"].as_array().unwrap().is_empty());
    assert!((run["values"][0]["contact"][0]["normal_force_n"].as_f64().unwrap() - 1000.0).abs() < 1e-3);
    let arguments = ["reduce", "brake.toml", "--contacts", "4", "--limit", "240000", "--json"];
    let reduced = document(&place.run(&arguments));
    has_keys(
        &reduced,
        "title model mesh mesh_sha256 program friction dofs_of_the_model band_hz limit_hz friction_damping unstable contacts \
         retained_points fixed_interface_modes residual_modes coordinates constraint_seconds fixed_interface_seconds fixed_interface_solves \
         projection_seconds sample_seconds seconds file",
    );
    assert_eq!((&reduced["contacts"], &reduced["file"]), (&Value::from(4), &Value::from("brake.se.h5")));
}

#[test]
fn errors_are_documents_on_two_ranks() {
    let place = Place::empty();
    let usage = place.run(&["stability", "none.toml", "--json", "--contacts", "abc"]);
    let error: Value = serde_json::from_str(&usage.err).unwrap();
    assert_eq!((usage.code, &error["exit_code"]), (2, &Value::from(2)));
    assert!(error["error"].as_str().unwrap().contains("\"abc\" is not a whole number above 0"), "{error}");
    for finished in [place.run(&["check", "none.toml", "--json"]), place.run_on(2, &["check", "none.toml", "--json"])] {
        assert_eq!((finished.code, finished.out.as_str()), (2, ""), "{}", finished.err);
        let error: Value = serde_json::from_str(finished.err.lines().next().unwrap()).unwrap();
        has_keys(&error, "error exit_code");
        assert_eq!(error["exit_code"], 2);
        assert!(error["error"].as_str().unwrap().contains("none.toml"));
    }
}
