//! `*DLOAD`, GRAV.

use super::*;

/// The good deck with a mass on a node of the pad and what stands below `*DLOAD`.
fn under(rows: &str) -> std::result::Result<Converted, String> {
    let mass = "*ELEMENT, TYPE=MASS, ELSET=BOLT\n101, 18\n*MASS, ELSET=BOLT\n1e-3\n*BOUNDARY\nHUB, 1, 3\n";
    let text = good().replace("*BOUNDARY\nHUB, 1, 3\n", mass);
    read(&text.replace("*MOTION, ROTATION", &format!("*DLOAD\n{rows}\n*MOTION, ROTATION")))
}

/// What has weight, and its acceleration in m/s2.
fn gravity(rows: &str) -> Vec<(String, [f64; 3])> {
    let Converted { model, .. } = under(rows).unwrap_or_else(|message| panic!("{message}"));
    let of = |load: &crate::model::Load| match load.kind {
        LoadKind::Gravity(g) => Some((load.on.clone(), g.map(|g| (1e9 * g).round() / 1e9 + 0.0))),
        _ => None,
    };
    model.loads.iter().filter_map(of).collect()
}

#[test]
fn parts_and_masses_weigh_along_a_direction_of_any_length() {
    assert_eq!(gravity("DISC, GRAV, 9810., 0., 0., -2."), [("Disc".to_owned(), [0.0, 0.0, -9.81])]);
    assert_eq!(gravity("BOLT, GRAV, 5000., 3., 0., -4.")[0].1, [3.0, 0.0, -4.0]);
    assert_eq!(gravity("PAD, GRAV, 9810., 0., 0., -1.\nDISC, GRAV, 9810., 1., 0., 0.").len(), 2);
}

#[test]
fn what_acts_on_all_parts_and_masses_is_one_load() {
    let all = vec![(String::new(), [0.0, 0.0, -9.81])];
    assert_eq!(gravity(", GRAV, 9810., 0., 0., -1."), all);
    let each = "DISC, GRAV, 9810., 0., 0., -1.\nPAD, GRAV, 9810., 0., 0., -1.\nBOLT, GRAV, 9810., 0., 0., -1.";
    assert_eq!(gravity(each), all);
    let (solids, _) = each.rsplit_once('\n').unwrap();
    assert_eq!(gravity(solids).len(), 2, "a mass outside the sets has no weight");
}

#[test]
fn gravities_of_one_step_add_up_and_a_later_step_replaces_them() {
    let rows = "DISC, GRAV, 9810., 0., 0., -1.\nDISC, GRAV, 1000., 1., 0., 0.";
    assert_eq!(gravity(rows)[0].1, [1.0, 0.0, -9.81]);
    let later = "DISC, GRAV, 9810., 0., 0., -1.\n*END STEP\n*STEP\n*STATIC\n*DLOAD\nDISC, GRAV, 2000., 0., 0., -1.";
    assert_eq!(gravity(later)[0].1, [0.0, 0.0, -2.0]);
    let ended = "DISC, GRAV, 9810., 0., 0., -1.\n*END STEP\n*STEP\n*STATIC\n*DLOAD, OP=NEW";
    assert_eq!(gravity(ended), []);
}

#[test]
fn a_part_weighs_as_a_whole_and_needs_a_direction_and_a_density() {
    let message = |rows: &str| under(rows).unwrap_err();
    assert!(message("DISC, GRAV, 9810.").ends_with("the direction of gravity is missing (GRAV)"));
    assert!(message("NONE, GRAV, 9810., 0., 0., -1.").contains("there is no element set NONE"));
    let one_section = good()
        .replace("*SOLID SECTION, ELSET=DISC, MATERIAL=STEEL\n*SOLID SECTION, ELSET=PAD, MATERIAL=STEEL\n", "")
        .replace(
            "*SURFACE INTERACTION",
            "*ELSET, ELSET=ALL\nDISC, PAD\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*SURFACE INTERACTION",
        );
    let apart = one_section.replace("*MOTION, ROTATION", "*DLOAD\nPAD, GRAV, 9810., 0., 0., -1.\n*MOTION, ROTATION");
    assert!(read(&apart).is_ok(), "two bodies of a section are two parts");
    let (statics, _) = good()
        .replace("*DENSITY\n7.85e-9\n", "")
        .split_once("*STEP\n*COMPLEX")
        .map(|(a, b)| (a.to_owned(), b.to_owned()))
        .unwrap();
    let light = read(&statics.replace("*MOTION, ROTATION", "*DLOAD\nPAD, GRAV, 9810., 0., 0., -1.\n*MOTION, ROTATION"));
    assert!(light.unwrap_err().contains("the material of the part \"PAD\" has no density, so that it has no weight"));
}

#[test]
fn gravity_is_the_same_in_a_deck_that_is_written_of_it() {
    for rows in [", GRAV, 9810., 0., 0., -1.", "DISC, GRAV, 5000., 3., 0., -4.\nBOLT, GRAV, 9810., 0., 0., -1."] {
        let Converted { model, mesh, .. } = under(rows).unwrap();
        let mut deck = Vec::new();
        crate::deck::write(&model, &mesh, UnitSystem::ALL[0], "a test", &mut deck).unwrap();
        let again = read(&String::from_utf8(deck).unwrap()).unwrap().model;
        let all = |model: &Model| -> Vec<(bool, [f64; 3])> {
            let own = model.loads.iter().filter_map(|load| match load.kind {
                LoadKind::Gravity(g) => Some((load.on.is_empty(), g.map(|g| (1e9 * g).round() / 1e9))),
                _ => None,
            });
            own.collect()
        };
        assert_eq!(all(&model), all(&again), "{rows}");
    }
}
