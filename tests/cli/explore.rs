//! `squeal explore`: each point is what `squeal stability` finds, whatever happens in between.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use num_complex::Complex64;

use squeal::analysis::{StabilityOptions, explore, stability};
use squeal::explore::{Outcome, PointResult};
use squeal::structure::StructureOptions;
use squeal::{Session, Structure};

use crate::support::data;
use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, assert_refused, swap};

/// A study of the small pad on its disc.
const STUDY: &str = "model = \"brake.toml\"\nband = [0, 60000]\nbin = 10000\n\
    [design]\nkind = \"sobol\"\npoints = 6\nseed = 2\n\
    [parameter.mu]\nkey = \"friction\"\nuniform = [0.2, 0.8]\n\
    [parameter.load]\nkey = \"load.*.force\"\nfactor = true\nnormal = { mean = 1, deviation = 0.2 }\n\
    [parameter.density]\nkey = \"material.iron.density\"\nuniform = [6500, 7500]\n";
/// One that brackets the friction coefficient above which the pad squeals.
const ADAPTIVE: &str = "model = \"brake.toml\"\nband = [0, 60000]\nfollow = false\n\
    [design]\nkind = \"adaptive\"\npoints = 14\nstart = 4\nresolution = 0.04\nseed = 0\n\
    [parameter.mu]\nkey = \"friction\"\nuniform = [0.0, 0.9]\n";
const EXPLORE: [&str; 4] = ["explore", "explore.toml", "-o", "run"];

fn place_with(study: &str) -> Place {
    let place = Place::blocks();
    place.write("explore.toml", study);
    place
}

#[track_caller]
fn done(finished: Finished) -> Finished {
    assert_eq!(finished.code, 0, "{}{}", finished.out, finished.err);
    finished
}

/// Rows of a table by the names of its columns.
fn table(place: &Place, file: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(place.path(file)).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {:?}", row[column]))
}

fn lambda(row: &BTreeMap<String, String>) -> Complex64 {
    Complex64::new(number(row, "growth_rate_per_s"), std::f64::consts::TAU * number(row, "frequency_hz"))
}

#[track_caller]
fn assert_same(found: Complex64, expected: Complex64) {
    assert!((found - expected).norm() < 1e-9 * expected.norm(), "{found} and {expected}");
}

/// Eigenvalues of one model file at its own friction coefficient.
fn eigenvalues(comm: &squeal::Comm, file: &Path) -> Vec<Complex64> {
    let brake = Structure::read(comm, file, &StructureOptions::default()).unwrap();
    let results = stability(comm, &brake, &StabilityOptions::default(), &mut ()).unwrap();
    results.modes().map(|(_, _, mode)| mode.lambda).collect()
}

/// The model file with other numbers, by its text.
fn model_at(values: &[f64]) -> String {
    let text = std::fs::read_to_string(data("pads_on_disc.toml")).unwrap();
    let text = text.replace("friction = 0.4", &format!("friction = {}", values[0]));
    let text = swap(&text, "young = 8e9", &format!("young = {}", 8e9 * values[1]));
    let text = swap(&text, "band = [0, 9000]", "band = [0, 1500]");
    [4000.0, -4000.0].iter().fold(text, |text, force| {
        swap(&text, &format!("force = [0, 0, {force}]"), &format!("force = [0, 0, {}]", force * values[2]))
    })
}

#[test]
fn every_point_is_what_stability_finds_on_the_model_file_with_its_numbers() {
    let comm = Session::start(&[]).unwrap();
    let place = Place::with_pads(|text| swap(&text, "band = [0, 9000]", "band = [0, 1500]"));
    place.write(
        "explore.toml",
        "model = \"brake.toml\"\n[design]\nkind = \"latin-hypercube\"\npoints = 16\nseed = 4\n\
         [parameter.mu]\nkey = 'contact.\"disc / *\".friction'\nuniform = [0.1, 0.8]\n\
         [parameter.lining]\nkey = \"material.lining.young\"\nfactor = true\nlognormal = { mean = 1, deviation = 0.3 }\n\
         [parameter.load]\nkey = \"load.*.force\"\nfactor = true\nuniform = [0.3, 2]\n",
    );
    let study = squeal::explore::read(&place.path("explore.toml")).unwrap();
    let found = explore(&comm, &study, None, &mut ()).unwrap().unwrap();
    assert_eq!(found.points.len(), 17);
    for PointResult { values, outcome } in &found.points {
        let Outcome::Modes(modes) = outcome else { panic!("{outcome:?}") };
        place.write("point.toml", model_at(values));
        let expected = eigenvalues(&comm, &place.path("point.toml"));
        assert!(modes.len() == expected.len() && modes.len() > 2, "{} and {}", modes.len(), expected.len());
        modes.iter().zip(&expected).for_each(|(mode, lambda)| assert_same(mode.lambda, *lambda));
    }
    let nominal = found.points[0].modes().unwrap();
    let own = (1..).zip(nominal).all(|(number, mode)| mode.link.is_some_and(|link| link.nominal == number));
    assert!(own, "the nominal modes are themselves");
    let followed = found.points[1..].iter().flat_map(|point| point.modes().unwrap());
    let n_clear = followed.clone().filter(|mode| mode.link.is_some_and(|link| !link.doubtful)).count();
    assert!(2 * n_clear > followed.count(), "{n_clear} modes are recognised");
}

#[test]
fn the_worst_point_is_a_model_file() {
    let place = place_with(STUDY);
    let out = done(place.run(&EXPLORE)).out;
    let files =
        ".squeal explore.html gradients.csv modes.csv points.csv results.h5 summary.json summary.txt worst.toml";
    assert_eq!(place.list("run").join(" "), files);
    let points = table(&place, "run/points.csv");
    let growth = |row: &BTreeMap<String, String>| number(row, "growth_rate_per_s");
    let worst = points[1..].iter().max_by(|a, b| growth(a).total_cmp(&growth(b))).unwrap();
    assert!(out.contains(&format!("worst point: {}", worst["point"])), "{out}");
    done(place.run(&["stability", "run/worst.toml", "-o", "worst"]));
    let modes = table(&place, "worst/modes.csv");
    let found = modes.iter().max_by(|a, b| growth(a).total_cmp(&growth(b))).unwrap();
    assert_same(lambda(found), lambda(worst));
    assert_eq!(number(found, "friction"), number(worst, "mu"));
    let json: serde_json::Value = serde_json::from_str(&place.read("run/summary.json")).unwrap();
    assert_eq!(json["worst_point"]["point"].to_string(), worst["point"]);
    assert_eq!((&json["n_points"], &json["unstable"]["n_points"]), (&6.into(), &6.into()));
    assert_eq!(json["parameters"][2]["nominal"], 7100.0);
}

/// Derivatives by left vectors and differences of eigenvalues over the same distance, which have an error of second
/// order: in friction, loads, a modulus, a density and the contact stiffness, with prestress.
#[test]
fn derivatives_are_differences_of_the_whole_computation() {
    let steps = [("mu", 0.3, 0.5), ("load", 0.8, 1.2), ("young", 100e9, 120e9), ("density", 7000.0, 7200.0)];
    let steps = steps.into_iter().chain([("contact", 1.9e13, 2.1e13)]);
    let steps: Vec<(&str, f64, f64)> = steps.collect();
    let keys = ["friction", "load.*.force", "material.iron.young", "material.iron.density", "contact.*.law.cubic.1"];
    let nominal = [0.4, 1.0, 110e9, 7100.0, 2e13];
    // A hundredth of the range between the quantiles.
    let step = |(_, from, to): &(&str, f64, f64)| 0.009 * (to - from);
    let names: Vec<&str> = steps.iter().map(|own| own.0).collect();
    let mut list = names.join(",") + "\n";
    for (i, sign) in (0..nominal.len()).flat_map(|i| [(i, -1.0), (i, 1.0)]) {
        let value = |j: usize| nominal[j] + if i == j { sign * step(&steps[i]) } else { 0.0 };
        list += &((0..nominal.len()).map(|j| format!("{:e}", value(j))).collect::<Vec<_>>().join(",") + "\n");
    }
    let mut study =
        "model = \"brake.toml\"\nband = [0, 60000]\n[design]\nkind = \"list\"\nfile = \"points.csv\"\n".to_owned();
    for ((name, from, to), key) in steps.iter().zip(keys) {
        let factor = if *name == "load" { "factor = true\n" } else { "" };
        study += &format!("[parameter.{name}]\nkey = \"{key}\"\n{factor}uniform = [{from:e}, {to:e}]\n");
    }
    let curved = |text: String| {
        swap(&text, "{ linear = 2e13 }", "{ cubic = [2e13, 1e24] }") + "[part.pad.rayleigh]\nalpha = 5\nbeta = 1e-7\n"
    };
    let place = Place::with_blocks(curved, &PadOnDisc::default());
    place.write("explore.toml", study);
    place.write("points.csv", list);
    done(place.run(&EXPLORE));
    let (modes, gradients) = (table(&place, "run/modes.csv"), table(&place, "run/gradients.csv"));
    let of = |point: usize, nominal_mode: &str| {
        let own =
            |row: &&BTreeMap<String, String>| row["point"] == point.to_string() && row["nominal_mode"] == nominal_mode;
        lambda(modes.iter().find(own).unwrap())
    };
    assert!(gradients.len() >= 5 * 5, "{}", gradients.len());
    for row in &gradients {
        let i = names.iter().position(|name| *name == row["parameter"]).unwrap();
        let [below, above] = [2 * i + 1, 2 * i + 2].map(|point| of(point, &row["nominal_mode"]));
        let expected = (above - below) / (2.0 * step(&steps[i]));
        let slope = [number(row, "growth_rate_slope"), std::f64::consts::TAU * number(row, "frequency_slope")];
        let found = Complex64::new(slope[0], slope[1]);
        assert!((found - expected).norm() < 3e-5 * expected.norm(), "{row:?}: {expected}");
        let growth = (found.re - expected.re).abs();
        assert!(growth < 1e-3 * expected.re.abs() + 1e-7 * expected.norm(), "{row:?}: {expected}");
        assert_eq!(row["difference"], "central");
    }
}

/// Friction 3 is above what the model file may have.
#[test]
fn a_point_that_fails_is_recorded_and_the_study_continues() {
    let design = "kind = \"list\"\nfile = \"points.csv\"\n";
    let place = place_with(&STUDY.replace("kind = \"sobol\"\npoints = 6\nseed = 2\n", design));
    place.write("points.csv", "mu,load,density\n0.4,1,7000\n3,1,7000\n0.5,1,-7\n0.3,2,7000\n");
    let finished = done(place.run(&[&EXPLORE[..], &["--json"]].concat()));
    let text = place.read("run/summary.txt");
    assert!(text.contains("4 points of 3 parameters, 2 failed") && text.contains("point 2: "), "{text}");
    let points = table(&place, "run/points.csv");
    assert_eq!(points.len(), 5);
    assert!(points[2]["failure"].contains("friction") && points[2]["growth_rate_per_s"].is_empty());
    assert!(points[3]["failure"].contains("density") && points[3]["failure"].contains("-7"));
    assert!(points[4]["failure"].is_empty() && number(&points[4], "modes") > 0.0);
    let json: serde_json::Value = serde_json::from_str(&place.read("run/summary.json")).unwrap();
    assert_eq!((&json["n_failed"], &json["unstable"]["n_points"]), (&2.into(), &2.into()));
    assert_eq!(serde_json::from_str::<serde_json::Value>(&finished.out).unwrap(), json, "standard output is the file");
}

/// Points that an unfinished study has finished.
fn n_done(place: &Place) -> usize {
    let folder = ".run.unfinished/.resume";
    let is_point = |name: &String| name.starts_with("point-");
    if place.path(folder).exists() { place.list(folder).iter().filter(|name| is_point(name)).count() } else { 0 }
}

#[test]
fn a_study_that_is_killed_ends_with_the_same_files() {
    assert_killed_ends_the_same(STUDY, "gradients.csv");
}

#[test]
fn an_adaptive_study_that_is_killed_ends_with_the_same_files() {
    assert_killed_ends_the_same(ADAPTIVE, "boundary.csv");
}

/// Kills a study twice, and compares its files, one more among them, with those of a study that was not interrupted.
fn assert_killed_ends_the_same(study: &str, file: &str) {
    let place = place_with(study);
    done(place.run(&EXPLORE));
    let files = ["points.csv", "modes.csv", file, "summary.json", "worst.toml"];
    let expected = files.map(|file| place.read(&format!("run/{file}")));
    std::fs::remove_dir_all(place.path("run")).unwrap();
    for n in [2, 4] {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("squeal"));
        command.args(EXPLORE).current_dir(place.path("")).env("OPENBLAS_NUM_THREADS", "1");
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let patience = Instant::now() + Duration::from_secs(200);
        while n_done(&place) < n && child.try_wait().unwrap().is_none() {
            assert!(Instant::now() < patience, "{n} points do not come");
            std::thread::sleep(Duration::from_millis(2));
        }
        // It may be over before.
        let _ = child.kill();
        child.wait().unwrap();
        assert!(n_done(&place) >= n || place.path("run").exists());
    }
    if !place.path("run").exists() {
        place.write("other.toml", study.replace("seed = ", "seed = 1"));
        let other = place.run(&["explore", "other.toml", "-o", "run"]);
        assert_refused(&other, &["points are done", "parameters and design", "--force"]);
        let finished = done(place.run(&EXPLORE));
        assert!(finished.err.contains("an earlier run has finished"), "{}", finished.err);
    }
    for (file, expected) in files.iter().zip(expected) {
        assert!(place.read(&format!("run/{file}")) == expected, "{file} differs");
    }
    assert!(!place.path(".run.unfinished").exists());
}

#[test]
fn two_ranks_find_what_one_finds() {
    let place = place_with(STUDY);
    done(place.run(&EXPLORE));
    done(place.run_on(2, &["explore", "explore.toml", "-o", "two"]));
    let [one, two] = ["run/modes.csv", "two/modes.csv"].map(|file| table(&place, file));
    assert!(one.len() == two.len() && !one.is_empty());
    for (a, b) in one.iter().zip(&two) {
        assert_same(lambda(b), lambda(a));
        let labels =
            |row: &BTreeMap<String, String>| ["point", "mode", "unstable", "nominal_mode"].map(|c| row[c].clone());
        assert_eq!(labels(a), labels(b));
    }
}

#[test]
fn a_super_element_has_friction_loads_and_contact_stiffness() {
    let study = "model = \"brake.se.h5\"\nband = [0, 60000]\n[design]\nkind = \"one-at-a-time\"\n\
        [parameter.mu]\nkey = \"friction\"\nuniform = [0.2, 0.5]\n\
        [parameter.p]\nkey = \"pressure\"\nvalues = [0.5, 2]\n\
        [parameter.k]\nkey = \"contact_stiffness\"\nvalues = [0.5, 2]\n";
    let reduction = "[reduction]\ncontacts = 4\nband = [0, 240000]\n";
    let place = Place::with_blocks(|text| text + reduction, &PadOnDisc::default());
    let reduce = ["reduce", "brake.toml", "--contacts", "4", "--limit", "240000", "--output", "brake.se.h5"];
    done(place.run(&reduce));
    place.write("explore.toml", study);
    let out = done(place.run(&EXPLORE)).out;
    assert!(
        out.contains("one parameter at a time") && out.contains("squeal stability brake.se.h5 --friction"),
        "{out}"
    );
    let points = table(&place, "run/points.csv");
    assert_eq!(points.len(), 7);
    let row = points.iter().find(|row| number(row, "k") == 2.0).unwrap();
    let options = ["--friction", &row["mu"], "--pressure", &row["p"], "--contact-stiffness", &row["k"]];
    done(place.run(&[&["stability", "brake.se.h5", "--band=0:60000", "-o", "alone"], &options[..]].concat()));
    let modes = table(&place, "alone/modes.csv");
    let own = table(&place, "run/modes.csv").into_iter().filter(|mode| mode["point"] == row["point"]);
    let own: Vec<_> = own.collect();
    assert_eq!(own.len(), modes.len());
    own.iter().zip(&modes).for_each(|(a, b)| assert_same(lambda(a), lambda(b)));
    // Each rank has points of its own.
    done(place.run_on(2, &["explore", "explore.toml", "-o", "two"]));
    let two = table(&place, "two/modes.csv");
    let one = table(&place, "run/modes.csv");
    assert_eq!(one.len(), two.len());
    one.iter().zip(&two).for_each(|(a, b)| assert_same(lambda(a), lambda(b)));
    assert!(one.iter().zip(&two).all(|(a, b)| a["nominal_mode"] == b["nominal_mode"]));
    place.write("explore.toml", swap(study, "\"pressure\"", "\"material.iron.young\""));
    assert_refused(&place.run(&EXPLORE[..2]), &["a super-element has no key", "friction, pressure, contact_stiffness"]);
}

#[test]
fn a_study_that_cannot_be_made_writes_nothing() {
    let place = place_with(&swap(STUDY, "material.iron.density", "material.iron.densty"));
    assert_refused(&place.run(&EXPLORE), &["explore.toml", "parameter \"density\"", "Did you mean \"density\""]);
    place.write("explore.toml", swap(STUDY, "\"sobol\"", "\"sobl\""));
    assert_refused(&place.run(&EXPLORE), &["explore.toml:5", "Did you mean \"sobol\""]);
    place.write("explore.toml", swap(STUDY, "brake.toml", "bake.toml"));
    assert_refused(&place.run(&EXPLORE), &["bake.toml", "cannot read the model file"]);
    assert!(!place.path("run").exists() && !place.path(".run.unfinished").exists());
}

/// The pad squeals above a friction coefficient, which is bracketed, on two ranks as on one.
#[test]
fn an_adaptive_design_finds_the_boundary_on_any_number_of_ranks() {
    let place = place_with(ADAPTIVE);
    let out = done(place.run(&EXPLORE)).out;
    assert!(out.contains("probabilities are of the first 4 points, with which the design starts"), "{out}");
    let points = table(&place, "run/points.csv");
    assert!((6..=15).contains(&points.len()), "{}", points.len());
    let boundary = table(&place, "run/boundary.csv");
    assert!(!boundary.is_empty() && boundary.iter().all(|row| number(row, "distance") <= 0.04), "{boundary:?}");
    for row in &boundary {
        let end = |column: &str| &points[number(row, column) as usize];
        let [stable, unstable] = ["stable_point", "unstable_point"].map(end);
        assert!(number(stable, "unstable_modes") == 0.0 && number(unstable, "unstable_modes") > 0.0);
        assert!((number(row, "mu") - 0.5 * (number(stable, "mu") + number(unstable, "mu"))).abs() < 1e-12);
    }
    let json: serde_json::Value = serde_json::from_str(&place.read("run/summary.json")).unwrap();
    assert_eq!(json["unstable"]["n_points"], 4);
    done(place.run_on(2, &["explore", "explore.toml", "-o", "two"]));
    let two = table(&place, "two/points.csv");
    assert!(points.len() == two.len() && points.iter().zip(&two).all(|(a, b)| a["mu"] == b["mu"]));
}
