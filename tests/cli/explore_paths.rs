//! Modes of `squeal explore` that are recognised along the straight line to the nominal point.

use super::explore::{EXPLORE, assert_same_modes, done, number, table};
use crate::support::program::Place;

/// One point far from the nominal one: twice the friction, three tenths of the lining's modulus.
const STUDY: &str = "model = \"brake.toml\"\nband = [0, 6000]\nbisections = N\ngradients = false\n\
    [design]\nkind = \"list\"\nfile = \"points.csv\"\n\
    [parameter.mu]\nkey = \"friction\"\nuniform = [0.1, 0.8]\n\
    [parameter.lining]\nkey = \"material.lining.young\"\nfactor = true\nuniform = [0.2, 4]\n";

/// Two of the three unstable modes have a share of a half; by way of a point between, each has nine tenths.
#[test]
fn unstable_modes_in_doubt_are_followed_on_any_number_of_ranks() {
    let place = Place::pads();
    place.write("points.csv", "mu,lining\n0.8,0.3\n");
    let unstable = |n_bisections: usize, folder: &str| {
        place.write("explore.toml", STUDY.replace("= N", &format!("= {n_bisections}")));
        done(place.run(&[&EXPLORE[..3], &[folder]].concat()));
        let rows = table(&place, &format!("{folder}/modes.csv"));
        rows.into_iter().filter(|row| row["point"] == "1" && row["unstable"] == "true").collect::<Vec<_>>()
    };
    let direct = unstable(0, "direct");
    let followed = unstable(2, "followed");
    assert!(direct.len() == 3 && followed.len() == 3);
    assert_eq!(direct.iter().filter(|row| row["doubtful"] == "true").count(), 2, "{direct:?}");
    for (a, b) in direct.iter().zip(&followed) {
        assert!(a["nominal_mode"] == b["nominal_mode"] && b["doubtful"] == "false", "{a:?} {b:?}");
        assert!(a["doubtful"] == "false" || number(b, "share") > 0.8, "{b:?}");
    }
    done(place.run_on(2, &["explore", "explore.toml", "-o", "two"]));
    assert_same_modes(&place, ["followed", "two"]);
}
