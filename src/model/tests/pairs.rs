//! Fixes, rotations, contacts and loads.

use super::{GOOD, complains, parsed};
use crate::element::ElementKind;
use crate::model::LoadKind;
use crate::model::friction::{FrictionCurve, FrictionTable, SpeedDecay, Stribeck};

#[test]
fn fixes_and_rotations_are_checked() {
    for axes in ["", "xx", "xw", "XYZ"] {
        let said = format!(
            "axes = {axes:?} does not name directions (fix of \"hub\"). Give one or more of x, y, z, each once, such as \"xyz\""
        );
        complains("axes = \"zx\"", &format!("axes = \"{axes}\""), 0, &said);
    }
    let along_y = "axes = \"zx\"\ndisplacement = [0, 0.1, 0]";
    let said = "displacement has a part along an axis that is free (fix of \"hub\"). Name this axis in axes, or give 0 along it";
    complains("axes = \"zx\"", along_y, 1, said);
    let moved = GOOD.replace("axes = \"zx\"", "axes = \"zx\"\ndisplacement = [0.1, 0, -0.2]");
    let model = parsed(&moved).unwrap();
    assert_eq!(model.fixes[0].displacement, [0.1 * 1e-3, 0.0, -0.2 * 1e-3]);
    let again = parsed(&crate::model::write(&model, "brake.msh")).unwrap();
    assert_eq!(again.fixes[0].displacement, model.fixes[0].displacement);
    let said = "axis has no direction: it is zero (rotation of \"disc\"). Give a vector such as [0, 0, 1]";
    complains("axis = [0, 3, 4]", "axis = [0, 0, 0]", 0, said);
    let said = "speed is 0, so that nothing turns (rotation of \"disc\"). Give rad/s, such as 5.0; its sign is the sense of rotation";
    complains("speed = -5", "speed = 0", 0, said);
}

#[test]
fn parts_have_one_kind_of_element_for_each_shape() {
    let of = |kinds: &str| {
        parsed(&GOOD.replace(
            "[part.a_pad]\nmaterial = \"lining\"\n",
            &format!("[part.a_pad]\nmaterial = \"lining\"\nelements = {kinds}\n"),
        ))
    };
    let model = of("[\"C3D8R\", \"C3D10\"]").unwrap();
    assert_eq!(model.parts[1].elements, [ElementKind::C3D8R, ElementKind::C3D10]);
    let again = parsed(&crate::model::write(&model, "brake.msh")).unwrap();
    assert_eq!(again.parts[1].elements, model.parts[1].elements);
    assert!(
        of("[\"C3D8\", \"C3D8R\"]")
            .unwrap_err()
            .contains("C3D8R has the shape of C3D8 (part \"a_pad\"). Keep one kind for each shape")
    );
    assert!(of("[\"C3D9\"]").unwrap_err().contains("unknown kind of element \"C3D9\""));
}

#[test]
fn wear_and_gap_fields_are_of_pairs_that_may_open() {
    let with = |keys: &str| parsed(&GOOD.replace("friction = 0.5\n", &format!("friction = 0.5\n{keys}\n")));
    let model = with("wear = 2e-14").unwrap();
    assert_eq!((model.contacts[0].wear, &model.contacts[0].gap_field), (Some(2e-14), &None));
    assert_eq!(parsed(&crate::model::write(&model, "brake.msh")).unwrap().contacts[0].wear, Some(2e-14));
    assert!(with("wear = 0").unwrap_err().contains("wear must be above 0, not 0 (contact \"pair\"). Give m2/N"));
    let closed = with("wear = 2e-14\nseparation = false").unwrap_err();
    assert!(closed.contains("there is wear, and the gap of a pair that may not open has no effect"), "{closed}");
    let missing = with("gap = \"worn.csv\"").unwrap_err();
    assert!(missing.contains("the gaps of cases/worn.csv cannot be read"), "{missing}");
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("worn.csv");
    std::fs::write(&file, "x_mm,y_mm,gap_um\n1,2,3\n").unwrap();
    let model = with(&format!("gap = \"{}\"", file.display())).unwrap();
    let again = parsed(&crate::model::write(&model, "brake.msh")).unwrap();
    assert_eq!(again.contacts[0].gap_field, model.contacts[0].gap_field);
}

#[test]
fn an_image_needs_its_place_and_its_scale() {
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("topography.PNG");
    let mut encoder = png::Encoder::new(std::fs::File::create(&file).unwrap(), 2, 1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[0, 255]).unwrap();
    let with = |gap: &str, image: &str| {
        let keys = format!("friction = 0.5\ngap = \"{gap}\"\n{image}\n");
        parsed(&GOOD.replace("friction = 0.5\n", &keys))
    };
    let path = file.display().to_string();
    let frame = |plane: &str, right: f64| {
        let corners = format!("lower_left = [0, 0], upper_right = [{right}, 10]");
        format!("gap_image = {{ plane = \"{plane}\", {corners}, black = 0, white = 0.02 }}")
    };
    let model = with(&path, &frame("zy", 40.0)).unwrap();
    let again = parsed(&crate::model::write(&model, "brake.msh")).unwrap();
    let [field, written] = [&model, &again].map(|model| model.contacts[0].gap_field.clone().unwrap());
    assert_eq!(field.frame().unwrap().plane, [2, 1]);
    let at = |field: &crate::model::GapField| field.at(&[[9.0, 5e-3, 20e-3]]).unwrap()[0];
    assert!((at(&field) - 10e-6).abs() < 1e-15 && (at(&written) - at(&field)).abs() < 1e-15);
    let message = |gap: &str, image: &str| with(gap, image).unwrap_err();
    assert!(message(&path, "").contains("an image needs its place and the gaps of black and white"));
    assert!(message(&path, &frame("xx", 40.0)).contains("gap_image has the plane \"xx\""));
    assert!(message(&path, &frame("xy", 0.0)).contains("the image of gap_image has no area"));
    assert!(message("worn.csv", &frame("xy", 40.0)).contains("gap names no image"));
    assert!(message("no.png", &frame("xy", 40.0)).contains("cannot be read"));
}

#[test]
fn contacts_are_checked() {
    let wrong = |to: &str, expected: &str| {
        let said = parsed(&GOOD.replace("law = { linear = 2e13 }", to)).unwrap_err();
        assert!(said.starts_with(&format!("cases/brake.toml:35: {expected}")), "{said}");
    };
    wrong("law = { linear = 0 }", "linear must be above 0, not 0 (contact \"pair\")");
    wrong("law = { cubic = [1e13, -1] }", "cubic must be above 0, not -1 (contact \"pair\")");
    let rough = GOOD.replace("friction = 0.5\n", "friction = \"rough\"\nstick = 1e13\n");
    let model = parsed(&rough).unwrap();
    assert_eq!(model.contacts[0].friction, crate::model::ROUGH);
    assert_eq!(parsed(&crate::model::write(&model, "brake.msh")).unwrap().contacts[0].friction, crate::model::ROUGH);
    let refused = "the table must have two rows or more, all rising, the first with pressure 0 (contact \"pair\")";
    for rows in ["[[0, 0]]", "[[0, 1], [1, 2]]", "[[0, 0], [0, 1]]", "[[0, 0], [1, 0]]"] {
        wrong(&format!("law = {{ table = {rows} }}"), refused);
    }
    wrong("law = {}", "the law is empty (contact \"pair\")");
    wrong("law = { linear = 1, cubic = [1, 1] }", "there are two laws (contact \"pair\")");
    wrong("law = { linar = 1 }", "unknown key \"linar\" ([[contact]]). Did you mean \"linear\"?");
    let auto = "\"auto\", { linear = 2e13 } or { cubic = [2e13, 1e22] }";
    let advice = "([[contact]]). Correct it; squeal example explains every key";
    wrong("law = \"aut\"", &format!("invalid value: string \"aut\", expected {auto} {advice}"));
    wrong("law = 2e13", &format!("invalid type: floating point `20000000000000.0`, expected {auto} {advice}"));
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
    let said = "expected a number, \"rough\", { static = 0.6, kinetic = 0.4, decay = 0.5 }, the same with stribeck_speed = 0.1 in place of decay, or \
                { by = [\"speed\"], table = [[0.6, 0], [0.4, 2]] } ([[contact]]). \
                Correct it; squeal example explains every key";
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
    assert_eq!(contact.friction_curve, Some(FrictionCurve::Decay(SpeedDecay { kinetic_ratio: 0.8, decay: 2.0 })));
}

#[test]
fn stribecks_curve_is_relative_to_the_static_coefficient() {
    let with = |rest: &str| format!("friction = {{ static = 0.5, kinetic = 0.4, {rest} }}");
    let text = GOOD.replace("friction = 0.5", &with("stribeck_speed = 0.2, viscous = 0.01"));
    let contact = &parsed(&text).unwrap().contacts[0];
    let curve = Stribeck { kinetic_ratio: 0.8, speed: 0.2, exponent: 1.0, viscous: 0.02 };
    assert_eq!((contact.friction, &contact.friction_curve), (0.5, &Some(FrictionCurve::Stribeck(curve))));
    for wrong in ["stribeck_speed = 0", "stribeck_speed = 1, exponent = 0.5", "stribeck_speed = 1, viscous = -1"] {
        let said = parsed(&GOOD.replace("friction = 0.5", &with(wrong))).unwrap_err();
        assert!(said.contains("an exponent of 1 or above, and viscous from 0 in s/m"), "{said}");
    }
}

#[test]
fn a_friction_table_is_a_full_grid_in_any_order_at_one_temperature() {
    let table = |by: &str, rows: &str, rest: &str| {
        let friction = format!("friction = {{ by = {by}, table = [{rows}]{rest} }}");
        parsed(&GOOD.replace("friction = 0.5", &friction)).map(|model| {
            let contact = &model.contacts[0];
            (contact.friction, contact.friction_curve.clone())
        })
    };
    let curve = |speeds: &[f64], pressures: &[f64], values: &[f64]| {
        let [speeds, pressures, values] = [speeds, pressures, values].map(<[f64]>::to_vec);
        Some(FrictionCurve::Table(FrictionTable { speeds, pressures, values }))
    };
    let by_speed = table("[\"speed\"]", "[0.5, 0], [0.25, 2]", "").unwrap();
    assert_eq!(by_speed, (0.5, curve(&[0.0, 2.0], &[0.0], &[1.0, 0.5])));
    let rows = "[0.5, 1e6, 0], [0.4, 1e6, 2], [0.3, 5e6, 2], [0.375, 5e6, 0]";
    let both = table("[\"pressure\", \"speed\"]", rows, "").unwrap();
    assert_eq!(both, (0.5, curve(&[0.0, 2.0], &[1e6, 5e6], &[1.0, 0.75, 0.8, 0.6])));
    let warm = table("[\"temperature\"]", "[0.5, 100], [0.3, 300]", ", temperature = 150").unwrap();
    assert_eq!(warm, (0.45, curve(&[0.0], &[0.0], &[1.0])));
    for (by, rows, rest, said) in [
        ("[\"colour\"]", "[0.5, 0]", "", "the friction table is by [\"colour\"]"),
        ("[\"speed\", \"speed\"]", "[0.5, 0, 0]", "", "the friction table is by [\"speed\", \"speed\"]"),
        ("[\"speed\"]", "", "", "the friction table is empty"),
        ("[\"speed\"]", "[0.5, 0], [0.4]", "", "the friction table has the row [0.4]"),
        ("[\"speed\"]", "[3.0, 0]", "", "the friction table has the row [3.0, 0.0]"),
        ("[\"speed\"]", "[0.5, 0], [0.4, 0]", "", "a combination of values not at all or twice"),
        ("[\"speed\", \"pressure\"]", "[0.5, 0, 0], [0.4, 1, 1]", "", "a combination of values not at all or twice"),
        ("[\"speed\"]", "[0.0, 0], [0.4, 1]", "", "the coefficient at the lowest speed and pressure is 0"),
        ("[\"speed\"]", "[0.5, 0]", ", temperature = 20", "the table and the temperature do not go together"),
        ("[\"temperature\"]", "[0.5, 0]", "", "the table and the temperature do not go together"),
    ] {
        let message = table(by, rows, rest).unwrap_err();
        assert!(message.contains(said) && message.contains("contact \"pair\""), "{message}");
    }
}

#[test]
fn loads_are_one_force_or_one_pressure() {
    let load = |text: &str| parsed(&GOOD.replace("force = [0, 0, 4000]", text));
    let kind = |text: &str| load(text).unwrap().loads[0].kind;
    assert_eq!(kind("force = [1, 0, 0]\nspread = \"area\""), LoadKind::ForceByArea([1.0, 0.0, 0.0]));
    assert_eq!(kind("pressure = 5"), LoadKind::Pressure(5.0));
    assert_eq!(kind("gravity = [0, 0, -9.81]"), LoadKind::Gravity([0.0, 0.0, -9.81]));
    assert!(load("").unwrap_err().contains(":42: nothing acts (load \"back\")"));
    let both = load("force = [1, 0, 0]\npressure = 5").unwrap_err();
    assert!(both.contains(":45: there are a force and a pressure (load \"back\")"), "{both}");
    let both = load("gravity = [0, 0, -9.81]\npressure = 5").unwrap_err();
    assert!(
        both.contains(":44: a load with gravity has no force, moment, at, spread or pressure (load \"back\")"),
        "{both}"
    );
    let empty =
        parsed(&GOOD.replace("on = \"back\"", "on = \"\"").replace("force = [0, 0, 4000]", "gravity = [0, 0, -9.81]"));
    let empty = empty.unwrap_err();
    assert!(
        empty.contains("on is empty (load") && empty.contains("Name a part or [[mass]], or leave `on` out"),
        "{empty}"
    );
    let nowhere = parsed(&GOOD.replace("on = \"back\"\n", "")).unwrap_err();
    assert!(nowhere.contains("on is missing (load \"unnamed\"). Name a physical surface"), "{nowhere}");
    let spread = load("pressure = 5\nspread = \"area\"").unwrap_err();
    assert!(spread.contains(":45: spread, moment and at say how a force acts, but this is a pressure"), "{spread}");
    let unknown = load("force = [1, 0, 0]\nspread = \"areas\"").unwrap_err();
    assert!(unknown.contains("unknown spread \"areas\" (load \"back\"). Did you mean \"area\"?"), "{unknown}");
}
