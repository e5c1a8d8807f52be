//! Random fields of `squeal explore` over the contact points of a small pad.

use crate::explore::{EXPLORE, assert_same, assert_same_modes, done, lambda, number, table};
use crate::support::program::{Place, assert_refused};

/// Friction, three modes of the contact stiffness, and two of the gap.
const STUDY: &str = "model = \"brake.toml\"\nband = [0, 60000]\nbin = 10000\n\
    [design]\nkind = \"list\"\nfile = \"points.csv\"\n\
    [parameter.mu]\nkey = \"friction\"\nuniform = [0.2, 0.8]\n\
    [field.k]\ncontact = \"disc / *\"\nof = \"stiffness\"\ndeviation = 0.5\ncorrelation_length = 8\n\
    kernel = \"gaussian\"\nmodes = 3\n\
    [field.film]\ncontact = \"disc / pad\"\nof = \"gap\"\ndeviation = 5e-5\ncorrelation_length = 15\n\
    kernel = \"exponential\"\nmodes = 2\n";
const POINTS: &str =
    "mu,k.1,k.2,k.3,film.1,film.2\n0.4,0,0,0,0,0\n0.7,1.2,-0.5,0.4,0.8,-1.1\n0.3,-0.6,0.9,1.3,-0.2,0.7\n";

#[test]
fn the_worst_point_of_random_fields_stands_alone() {
    let place = Place::blocks();
    place.write("explore.toml", STUDY);
    place.write("points.csv", POINTS);
    let out = done(place.run(&EXPLORE)).out;
    assert!(out.contains("field \"k\": 3 modes with ") && out.contains(" over 16 contact points"), "{out}");
    let modes = table(&place, "run/modes.csv");
    let at = |point: &str| modes.iter().filter(|row| row["point"] == point).map(lambda).collect::<Vec<_>>();
    at("0").iter().zip(at("1")).for_each(|(own, nominal)| assert_same(nominal, *own));
    let points = table(&place, "run/points.csv");
    let growth = |i: &usize| number(&points[*i], "growth_rate_per_s");
    let worst = (1..points.len()).max_by(|a, b| growth(a).total_cmp(&growth(b))).unwrap();
    assert!(worst > 1, "not the nominal point");
    done(place.run(&["stability", "run/worst.toml", "-o", "worst"]));
    let found: Vec<_> = table(&place, "worst/modes.csv").iter().map(lambda).collect();
    let expected = at(&worst.to_string());
    assert!(found.len() == expected.len() && found.len() > 2);
    found.iter().zip(&expected).for_each(|(own, expected)| assert_same(*own, *expected));
    // Without its tables the point is another one.
    let plain: String = place
        .read("run/worst.toml")
        .lines()
        .filter(|line| !line.contains(".csv"))
        .map(|line| line.to_owned() + "\n")
        .collect();
    place.write("run/plain.toml", plain);
    done(place.run(&["stability", "run/plain.toml", "-o", "plain"]));
    let plain = lambda(&table(&place, "plain/modes.csv")[0]);
    assert!((plain - expected[0]).norm() > 1e-4 * plain.norm(), "{plain} and {}", expected[0]);
    let gradients = table(&place, "run/gradients.csv");
    let slopes = |name: &str| -> Vec<f64> {
        let own = gradients.iter().filter(|row| row["parameter"] == name);
        own.map(|row| number(row, "frequency_slope")).collect()
    };
    assert!(slopes("k.1").iter().any(|slope| slope.abs() > 1.0) && !slopes("film.2").is_empty());
    let json: serde_json::Value = serde_json::from_str(&place.read("run/summary.json")).unwrap();
    assert_eq!((&json["fields"][1]["n_points"], &json["parameters"][5]["nominal"]), (&16.into(), &0.0.into()));
}

#[test]
fn random_fields_are_the_same_on_two_ranks_and_none_of_super_elements() {
    let place = Place::blocks();
    place.write("explore.toml", STUDY.replace("bin = 10000", "gradients = false"));
    place.write("points.csv", POINTS);
    done(place.run(&EXPLORE));
    done(place.run_on(2, &["explore", "explore.toml", "-o", "two"]));
    assert_same_modes(&place, ["run", "two"]);
    place.write("reduced.toml", STUDY.replace("brake.toml", "run/results.h5"));
    let refused = place.run(&["explore", "reduced.toml", "-o", "reduced"]);
    assert_refused(&refused, &["reduced.toml: field \"k\": a random field needs full contact"]);
}
