//! Hopf curves over two parameters by `squeal explore`.

use std::collections::BTreeMap;

use super::explore::{EXPLORE, done, number, place_with, table};
use super::explore_resume::assert_killed_ends_the_same;
use crate::support::browser::Browser;

/// A map of the small pad, which squeals above a friction coefficient that depends on the contact stiffness.
const MAP: &str = "model = \"brake.toml\"\nband = [0, 60000]\n\
    [design]\nkind = \"map\"\nlevels = 3\nseed = 0\n\
    [parameter.mu]\nkey = \"friction\"\nuniform = [0, 0.9]\n\
    [parameter.stiffness]\nkey = \"contact_stiffness\"\nuniform = [0.5, 1.5]\n";

/// An edge of the map is 0.45 long, and is left with 0.002 of it; the sweep finds Hopf points to 1e-4. It also finds an
/// instability between points of the grid.
#[test]
fn a_map_has_the_hopf_points_of_the_sweep_and_draws_them() {
    let place = place_with(MAP);
    let out = done(place.run(&EXPLORE)).out;
    assert!(out.contains("fractions are of the first 9 points") && out.contains("(hopf.csv)"), "{out}");
    let rows = table(&place, "run/hopf.csv");
    done(place.run(&["stability", "brake.toml", "--friction=0,0.45,0.9", "--band=0:60000", "-o", "sweep"]));
    let hopf = table(&place, "sweep/hopf.csv");
    let own: Vec<_> = rows.iter().filter(|row| number(row, "stiffness") == 1.0).collect();
    assert!(!own.is_empty(), "{rows:?}");
    for row in own {
        let is_same = |point: &&BTreeMap<String, String>| {
            let hertz = [*point, row].map(|own| number(own, "frequency_hz"));
            (number(point, "friction") - number(row, "mu")).abs() < 1e-3 && (hertz[0] / hertz[1] - 1.0).abs() < 1e-3
        };
        assert_eq!(hopf.iter().filter(is_same).count(), 1, "{row:?} {hopf:?}");
    }
    let mut page = Browser::open(&place.path("run/explore.html"), [1400, 900]);
    page.wait_for("document.querySelectorAll('#map circle').length > 9");
    page.value("{ const s = document.getElementById('map-y'); s.value = '1'; s.dispatchEvent(new Event('change')); }");
    assert_eq!(page.number("document.querySelectorAll('#map rect.hopf').length"), rows.len() as f64);
    assert!(page.number("document.querySelectorAll('#map .zero').length") >= 2.0);
    assert_eq!(page.complaints(), Vec::<String>::new());
}

#[test]
fn a_map_that_is_killed_ends_with_the_same_files() {
    assert_killed_ends_the_same(MAP, "hopf.csv");
}

#[test]
fn a_map_is_the_same_on_any_number_of_ranks() {
    let place = place_with(MAP);
    done(place.run(&EXPLORE));
    done(place.run_on(2, &["explore", "explore.toml", "-o", "two", "--ranks-per-point", "1"]));
    let [one, two] = ["run", "two"].map(|folder| table(&place, &format!("{folder}/hopf.csv")));
    assert!(one.len() == two.len() && !one.is_empty());
    for (a, b) in one.iter().zip(&two) {
        assert!((number(a, "mu") - number(b, "mu")).abs() < 1e-6, "{a:?} {b:?}");
    }
}
