//! Fixes, rotations, contacts and loads.

use super::{GOOD, complains, parsed};
use crate::model::{LoadKind, SpeedDecay};

#[test]
fn fixes_and_rotations_are_checked() {
    for axes in ["", "xx", "xw", "XYZ"] {
        let said = format!(
            "axes = {axes:?} does not name directions (fix of \"hub\"). Give one or more of x, y, z, each once, such as \"xyz\""
        );
        complains("axes = \"zx\"", &format!("axes = \"{axes}\""), 0, &said);
    }
    let said = "axis has no direction: it is zero (rotation of \"disc\"). Give a vector such as [0, 0, 1]";
    complains("axis = [0, 3, 4]", "axis = [0, 0, 0]", 0, said);
    let said = "speed is 0, so that nothing turns (rotation of \"disc\"). Give rad/s, such as 5.0; its sign is the sense of rotation";
    complains("speed = -5", "speed = 0", 0, said);
}

#[test]
fn contacts_are_checked() {
    let wrong = |to: &str, expected: &str| {
        let said = parsed(&GOOD.replace("law = { linear = 2e13 }", to)).unwrap_err();
        assert!(said.starts_with(&format!("cases/brake.toml:35: {expected}")), "{said}");
    };
    wrong("law = { linear = 0 }", "linear must be above 0, not 0 (contact \"pair\")");
    wrong("law = { cubic = [1e13, -1] }", "cubic must be above 0, not -1 (contact \"pair\")");
    wrong("law = {}", "the law is empty (contact \"pair\")");
    wrong("law = { linear = 1, cubic = [1, 1] }", "there are two laws (contact \"pair\")");
    wrong("law = { linar = 1 }", "unknown key \"linar\" ([[contact]]). Did you mean \"linear\"?");
    wrong("stick = 0\nlaw = { linear = 1 }", "stick must be above 0, not 0 (contact \"pair\")");
    for friction in ["-0.1", "2.5", "inf"] {
        let said =
            format!("friction must be from 0 to 2, not {friction} (contact \"pair\"). Give a coefficient, such as 0.5");
        complains("friction = 0.5", &format!("friction = {friction}"), 0, &said);
    }
    for wrong in [
        "static = 0, kinetic = 0.4, decay = 1",
        "static = 0.6, kinetic = 3, decay = 1",
        "static = 0.6, kinetic = -1, decay = 1",
        "static = 0.6, kinetic = 0.4, decay = 0",
    ] {
        let said = format!(
            "friction has {wrong} (contact \"pair\"). \
             Give static above 0 and kinetic from 0, both up to 2, and a decay above 0 in s/m"
        );
        complains("friction = 0.5", &format!("friction = {{ {wrong} }}"), 0, &said);
    }
    let said = "expected a number, or { static = 0.6, kinetic = 0.4, decay = 0.5 } ([[contact]]). \
                Correct it; the documentation explains every key";
    complains("friction = 0.5", "friction = { static = 0.6, kinetic = 0.4 }", 0, said);
    complains("friction = 0.5", "friction = { static = 0.6, kinetic = 0.4, decay = 1, p = 1 }", 0, said);
    let said = "search must be above 0, not -2 (contact \"pair\"). Give a distance in the mesh's unit, or leave it out for no limit";
    complains("search = 2", "search = -2", 0, said);
    let said = parsed(&GOOD.replace("slave = \"pad_face\"", "slave = \"disc_face\"")).unwrap_err();
    assert!(said.contains(":31: slave and master are both \"disc_face\" (contact \"pair\")"), "{said}");
}

#[test]
fn friction_that_decays_keeps_its_ratio() {
    let text = GOOD.replace("friction = 0.5", "friction = { static = 0.5, kinetic = 0.4, decay = 2 }");
    let contact = &parsed(&text).unwrap().contacts[0];
    assert_eq!(contact.friction, 0.5);
    assert_eq!(contact.decay, Some(SpeedDecay { kinetic_ratio: 0.8, decay: 2.0 }));
}

#[test]
fn loads_are_one_force_or_one_pressure() {
    let load = |text: &str| parsed(&GOOD.replace("force = [0, 0, 4000]", text));
    let kind = |text: &str| load(text).unwrap().loads[0].kind;
    assert_eq!(kind("force = [1, 0, 0]\nspread = \"area\""), LoadKind::ForceByArea([1.0, 0.0, 0.0]));
    assert_eq!(kind("pressure = 5"), LoadKind::Pressure(5.0));
    assert!(load("").unwrap_err().contains(":42: nothing acts (load \"back\")"));
    let both = load("force = [1, 0, 0]\npressure = 5").unwrap_err();
    assert!(both.contains(":45: there are a force and a pressure (load \"back\")"), "{both}");
    let spread = load("pressure = 5\nspread = \"area\"").unwrap_err();
    assert!(spread.contains(":45: spread, moment and at say how a force acts, but this is a pressure"), "{spread}");
    let unknown = load("force = [1, 0, 0]\nspread = \"areas\"").unwrap_err();
    assert!(unknown.contains("unknown spread \"areas\" (load \"back\"). Did you mean \"area\"?"), "{unknown}");
}
