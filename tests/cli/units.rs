//! Mistakes of units that are made often, and what `squeal check` prints about each.

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Place, assert_refused, swap};

/// What is changed, and the warning.
const DOUBTFUL: [(&str, &str, &str); 9] = [
    ("density = 7100", "density = 7.1e-9", "Was it given in t/mm3? That is 7100 kg/m3"),
    ("density = 7100", "density = 7.1e-6", "Was it given in kg/mm3? That is 7100 kg/m3"),
    ("density = 7100", "density = 7.1", "Was it given in g/cm3? That is 7100 kg/m3"),
    ("young = 110e9", "young = 110", "Was it given in GPa?"),
    ("young = 110e9", "young = 110e3", "Was it given in MPa (N/mm2)?"),
    ("unit = \"mm\"", "unit = \"m\"", "Is the mesh in mm? Then give unit = \"mm\""),
    ("unit = \"mm\"", "unit = \"um\"", "the model is 3.000e-5 m large"),
    ("linear = 2e13", "linear = 2e4", "Was it given in N/mm3? 1 N/mm3 is 1e9 N/m3"),
    ("force = [0, 0, -1000]", "pressure = 2.5", "Was it given in MPa? 1 MPa is 1e6 Pa"),
];

/// What is changed, and why it is refused.
const REFUSED: [(&str, &str, &str); 3] = [
    ("poisson = 0.27", "poisson = 27", "poisson must be above -1 and below 0.5, not 27"),
    ("friction = 0.4", "friction = 40", "friction must be from 0 to 2, not 40"),
    ("young = 110e9", "young = 110 # GPa\nyoung = 110e9", "given twice"),
];

#[test]
fn check_names_the_common_mistakes_of_units() {
    let right = Place::blocks().run(&["check", "brake.toml"]);
    assert!(right.code == 0 && !right.err.contains("warning"), "{}", right.err);
    for (good, bad, expected) in DOUBTFUL {
        let place = Place::with_blocks(|text| swap(&text, good, bad), &PadOnDisc::default());
        let check = place.run(&["check", "brake.toml"]);
        let is_named = |line: &str| line.starts_with("warning: ") && line.contains(expected);
        assert!(check.err.lines().any(is_named), "{bad}: {} {}", check.out, check.err);
    }
    for (good, bad, expected) in REFUSED {
        let place = Place::with_blocks(|text| swap(&text, good, bad), &PadOnDisc::default());
        assert_refused(&place.run(&["check", "brake.toml"]), &["brake.toml:", expected]);
    }
}
