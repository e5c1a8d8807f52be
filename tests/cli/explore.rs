//! `squeal explore`: each point is what `squeal stability` finds, whatever happens in between.

use std::collections::BTreeMap;
use std::path::Path;

use num_complex::Complex64;

use squeal::analysis::{StabilityOptions, explore, stability};
use squeal::explore::{Outcome, PointResult};
use squeal::structure::StructureOptions;
use squeal::{Session, Structure};

use crate::support::data;
use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, assert_refused, swap};

/// A study of the small pad on its disc.
pub const STUDY: &str = "model = \"brake.toml\"\nband = [0, 60000]\nbin = 10000\n\
    [design]\nkind = \"sobol\"\npoints = 6\nseed = 2\n\
    [parameter.mu]\nkey = \"friction\"\nuniform = [0.2, 0.8]\n\
    [parameter.load]\nkey = \"load.*.force\"\nfactor = true\nnormal = { mean = 1, deviation = 0.2 }\n\
    [parameter.density]\nkey = \"material.iron.density\"\nuniform = [6500, 7500]\n";
/// One that brackets the friction coefficient above which the pad squeals.
pub const ADAPTIVE: &str = "model = \"brake.toml\"\nband = [0, 60000]\nfollow = false\n\
    [design]\nkind = \"adaptive\"\npoints = 14\nstart = 4\nresolution = 0.04\nseed = 0\n\
    [parameter.mu]\nkey = \"friction\"\nuniform = [0.0, 0.9]\n";
pub const EXPLORE: [&str; 4] = ["explore", "explore.toml", "-o", "run"];

pub fn place_with(study: &str) -> Place {
    let place = Place::blocks();
    place.write("explore.toml", study);
    place
}

#[track_caller]
pub fn done(finished: Finished) -> Finished {
    assert_eq!(finished.code, 0, "{}{}", finished.out, finished.err);
    finished
}

/// Rows of a table by the names of its columns.
pub fn table(place: &Place, file: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(place.path(file)).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

pub fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {:?}", row[column]))
}

pub fn lambda(row: &BTreeMap<String, String>) -> Complex64 {
    Complex64::new(number(row, "growth_rate_per_s"), std::f64::consts::TAU * number(row, "frequency_hz"))
}

#[track_caller]
pub fn assert_same(found: Complex64, expected: Complex64) {
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
    let found = explore(&comm, &study, None, None, &mut ()).unwrap().unwrap();
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
    assert!(text.contains("failed points are left out: with them it is "), "{text}");
    let points = table(&place, "run/points.csv");
    assert_eq!(points.len(), 5);
    assert!(points[2]["failure"].contains("friction") && points[2]["growth_rate_per_s"].is_empty());
    assert!(points[3]["failure"].contains("density") && points[3]["failure"].contains("-7"));
    assert!(points[4]["failure"].is_empty() && number(&points[4], "modes") > 0.0);
    let json: serde_json::Value = serde_json::from_str(&place.read("run/summary.json")).unwrap();
    assert_eq!((&json["n_failed"], &json["unstable"]["n_points"]), (&2.into(), &2.into()));
    assert_eq!(serde_json::from_str::<serde_json::Value>(&finished.out).unwrap(), json, "standard output is the file");
}

/// That two folders have the same modes. A stable mode in doubt may resemble two nominal modes alike: which one it is
/// said to be is a matter of rounding.
#[track_caller]
pub fn assert_same_modes(place: &Place, folders: [&str; 2]) {
    let [one, two] = folders.map(|folder| table(place, &format!("{folder}/modes.csv")));
    assert!(one.len() == two.len() && !one.is_empty());
    for (a, b) in one.iter().zip(&two) {
        assert_same(lambda(b), lambda(a));
        let in_doubt = [a, b].iter().all(|row| row["doubtful"] == "true" && row["unstable"] == "false");
        let labels = ["point", "mode", "unstable", "nominal_mode"].into_iter().take(if in_doubt { 3 } else { 4 });
        labels.for_each(|label| assert_eq!(a[label], b[label], "{label}: {a:?} {b:?}"));
    }
}

/// Points that the ranks solve together, and points that each rank solves alone, the third of which fails.
#[test]
fn groups_of_ranks_find_what_one_rank_finds() {
    let mut list = "mu,load,density\n".to_owned();
    for (i, mu) in ["0.25", "0.8", "3", "0.7", "0.3", "0.5", "0.75"].iter().enumerate() {
        list += &format!("{mu},{},{}\n", 1.3 - 0.1 * i as f64, 6500 + 150 * i);
    }
    let place = place_with(
        &STUDY.replace("kind = \"sobol\"\npoints = 6\nseed = 2\n", "kind = \"list\"\nfile = \"points.csv\"\n"),
    );
    place.write("points.csv", list);
    done(place.run(&EXPLORE));
    done(place.run_on(2, &["explore", "explore.toml", "-o", "together"]));
    let explore = ["explore", "explore.toml", "-v", "--ranks-per-point", "1", "-o", "apart"];
    let finished = done(place.run_on(2, &explore));
    assert!(finished.err.contains("8/8 point"), "the first rank reports the points of both: {}", finished.err);
    for folder in ["together", "apart"] {
        assert_same_modes(&place, ["run", folder]);
        let failures =
            table(&place, &format!("{folder}/points.csv")).iter().map(|row| row["failure"].clone()).collect();
        let failures: Vec<String> = failures;
        assert!(failures[3].contains("friction") && failures.iter().filter(|text| !text.is_empty()).count() == 1);
        // Rows are in the order of their changes, some of which are rounding.
        let [one, own] = ["run", folder].map(|folder| {
            let mut rows = table(&place, &format!("{folder}/gradients.csv"));
            rows.sort_by_key(|row| (row["nominal_mode"].clone(), row["parameter"].clone()));
            rows
        });
        assert_eq!(one.len(), own.len());
        for (a, b) in one.iter().zip(&own) {
            let change =
                |row| Complex64::new(number(row, "growth_rate_change_per_s"), number(row, "frequency_change_hz"));
            assert!((change(a) - change(b)).norm() < 1e-5 * change(a).norm() + 1e-6, "{a:?} {b:?}");
        }
    }
    let refused = place.run_on(2, &["explore", "explore.toml", "--ranks-per-point", "3"]);
    assert_refused(&refused, &["the 2 ranks of this run cannot be divided into groups of 3", "one of 1, 2"]);
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
    place.write("explore.toml", swap(study, "\"pressure\"", "\"load.*.force.z\""));
    assert_refused(&place.run(&EXPLORE[..2]), &["cannot follow the key load.*.force.z", "It can follow friction"]);
    place.write("explore.toml", swap(study, "\"pressure\"", "\"material.iron.yuong\""));
    assert_refused(&place.run(&EXPLORE[..2]), &["explore.toml", "Did you mean \"young\""]);
}

/// A study that changes the parts of a pad on its disc, of a layout.
const PARTS: &str = "model = \"brake.toml\"\ncontacts = 4\nband = [0, 60000]\nfollow = false\n\
    [design]\nkind = \"sobol\"\npoints = 4\nseed = 5\n\
    [parameter.mu]\nkey = \"friction\"\nuniform = [0.2, 0.5]\n\
    [parameter.E]\nkey = \"material.soft.young\"\nuniform = [6.3e9, 12.6e9]\n\
    [parameter.rho]\nkey = \"material.soft.density\"\nfactor = true\nuniform = [0.7, 1.4]\n\
    [parameter.beta]\nkey = \"part.disc.rayleigh.beta\"\nuniform = [0, 3e-7]\n";

/// The small pad of a soft material, and its disc with Rayleigh damping.
fn soft_pad() -> Place {
    let damping = "rayleigh = { alpha = 5.0, beta = 1e-7 }\n[part.pad]";
    let soft = "[material.soft]\nyoung = 9e9\npoisson = 0.25\ndensity = 2600\n[part.disc]";
    let of_pad = |text: String| {
        let text = swap(&text, "band = [0, 20000]", "band = [0, 60000]");
        let text = swap(&swap(&text, "[part.pad]", damping), "[part.disc]", soft);
        swap(&text, "[part.pad]\nmaterial = \"iron\"", "[part.pad]\nmaterial = \"soft\"")
    };
    Place::with_blocks(of_pad, &PadOnDisc::default())
}

/// The eigenvalues at all points of a study.
fn explored(place: &Place, study: &str) -> (Vec<Complex64>, Finished) {
    place.write("explore.toml", study);
    let finished = done(place.run(&[&EXPLORE[..], &["--force"]].concat()));
    (table(place, "run/modes.csv").iter().map(lambda).collect(), finished)
}

/// Largest distance of the eigenvalues of the study of a super-element from others, and what `reduce` and `explore`
/// print.
fn reduced_error(place: &Place, options: &[&str], study: &str, expected: &[Complex64]) -> (f64, Finished, Finished) {
    let reduce = ["reduce", "brake.toml", "-o", "brake.se.h5", "--force"];
    let made = done(place.run(&[&reduce[..], options].concat()));
    let (found, finished) = explored(place, &swap(&swap(study, "brake.toml", "brake.se.h5"), "contacts = 4\n", ""));
    assert_eq!(found.len(), expected.len());
    let errors = found.iter().zip(expected).map(|(found, expected)| (found - expected).norm() / expected.norm());
    (errors.fold(0.0, f64::max), made, finished)
}

/// One study of a layout and of its super-element: eigenvalues to 2e-4. A super-element that was made for the model
/// alone is worse, and its study says so. The worst point is a model file of the layout.
#[test]
fn a_study_of_a_layout_is_one_of_its_super_element() {
    let place = soft_pad();
    let (expected, _) = explored(&place, PARTS);
    let layout = ["--contacts", "4", "--limit", "120000"];
    let (plain, _, finished) = reduced_error(&place, &layout, PARTS, &expected);
    assert!(finished.err.contains("part \"pad\"") && finished.err.contains("squeal reduce --for"), "{}", finished.err);
    place.write("for.toml", PARTS);
    let options = [&layout[..], &["--for", "for.toml"]].concat();
    let (sampled, made, finished) = reduced_error(&place, &options, PARTS, &expected);
    println!("{plain:.1e} without and {sampled:.1e} with samples\n{}", made.out);
    assert!(sampled < 2e-4 && sampled < 0.5 * plain, "{plain} {sampled}\n{}", made.out);
    assert!(
        made.out.contains("made for the parts of for.toml") && made.out.contains("stiffness of pad 0.7"),
        "{}",
        made.out
    );
    assert!(!finished.err.contains("warning"), "{}", finished.err);
    assert!(finished.out.contains("squeal stability run/worst.toml --contacts 4"), "{}", finished.out);
    done(place.run(&["stability", "run/worst.toml", "--contacts", "4", "-o", "worst"]));
}

/// The worst point has the friction coefficient of the reduction, not the model file's.
#[test]
fn the_worst_point_of_a_super_element_has_its_friction_coefficient() {
    let place = soft_pad();
    done(place.run(&[
        "reduce",
        "brake.toml",
        "-o",
        "brake.se.h5",
        "--contacts",
        "4",
        "--limit",
        "240000",
        "--friction",
        "0.25",
    ]));
    let of_pad = "[parameter.E]\nkey = \"material.soft.young\"\nuniform = [6.3e9, 12.6e9]\n";
    let head = PARTS.split("[parameter").next().unwrap().replace("contacts = 4\n", "");
    let (found, finished) = explored(&place, &(swap(&head, "brake.toml", "brake.se.h5") + of_pad));
    let command = finished.out.split("squeal stability run/worst.toml").nth(1).expect("a worst point");
    assert!(command.starts_with(" --contacts 4"), "{command}");
    done(place.run(&["stability", "run/worst.toml", "--contacts", "4", "-o", "worst"]));
    let worst = table(&place, "worst/modes.csv");
    assert!(!worst.is_empty() && worst.iter().all(|mode| number(mode, "friction") == 0.25));
    for mode in worst.iter().map(lambda) {
        let nearest = found.iter().map(|own| (own - mode).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-3 * mode.norm(), "{mode}: {nearest}");
    }
}

/// The same of full contact and a Galerkin super-element: eigenvalues to 1e-3.
#[test]
fn a_study_of_full_contact_is_one_of_its_galerkin_super_element() {
    let place = soft_pad();
    let study = swap(PARTS, "contacts = 4\n", "");
    let (expected, _) = explored(&place, &study);
    place.write("for.toml", &study);
    let plain = ["--galerkin", "--samples", "0.2,0.35,0.5"];
    let study = study + "# contacts = 4\n";
    let (without, ..) = reduced_error(&place, &plain, &study, &expected);
    let options = [&plain[..], &["--for", "for.toml"]].concat();
    let (sampled, made, _) = reduced_error(&place, &options, &study, &expected);
    println!("{without:.1e} without and {sampled:.1e} with samples\n{}", made.out);
    assert!(sampled < 1e-3 && sampled < 0.2 * without, "{without} {sampled}\n{}", made.out);
}

#[test]
fn a_study_without_a_solution_has_no_probability() {
    let design = "kind = \"list\"\nfile = \"points.csv\"\n";
    let place = place_with(&swap(STUDY, "kind = \"sobol\"\npoints = 6\nseed = 2\n", design));
    place.write("points.csv", "mu,load,density\n3,1,7000\n0.5,1,-7\n");
    let finished = place.run(&EXPLORE);
    assert_eq!(finished.code, 3, "{}", finished.err);
    assert!(finished.err.contains("no point of the study has a solution"), "{}", finished.err);
    assert!(finished.out.contains("unknown, as no point that counts has a solution"), "{}", finished.out);
    assert!(place.read("run/explore.html").contains("Unknown: no point that counts has a solution"));
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
    done(place.run_on(2, &["explore", "explore.toml", "-o", "apart", "--ranks-per-point", "1"]));
    for two in ["two/points.csv", "apart/points.csv"].map(|file| table(&place, file)) {
        assert!(points.len() == two.len() && points.iter().zip(&two).all(|(a, b)| a["mu"] == b["mu"]));
    }
}
