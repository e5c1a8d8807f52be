//! Syntax, unknown, missing and doubled keys, and names defined within the file.

use super::{GOOD, complains, parsed};

#[test]
fn wrong_syntax_and_types_are_located() {
    let said = parsed(&GOOD.replace("young = 110e9", "young = ")).unwrap_err();
    assert!(said.starts_with("cases/brake.toml:6: "), "{said}");
    complains(
        "density = 7100",
        "density = \"7100\"",
        0,
        "invalid type: string \"7100\", expected a number ([material.iron]). Correct it; squeal example explains every key",
    );
    complains(
        "axis = [0, 0, 2]",
        "axis = [0, 2]",
        0,
        "invalid length 2, expected an array of length 3 ([material.lining]). Correct it; squeal example explains every key",
    );
    complains(
        "young = 110e9",
        "young = \"stiff\"",
        0,
        "expected a number, or three of them in brackets ([material.iron]). Correct it; squeal example explains every key",
    );
}

#[test]
fn unknown_keys_offer_the_nearest() {
    complains(
        "unit = \"mm\"",
        "units = \"mm\"",
        0,
        "unknown key \"units\" ([mesh]). Did you mean \"unit\"? There is: file, unit",
    );
    let said = parsed(&GOOD.replace("[[contact]]", "[[contacts]]")).unwrap_err();
    assert!(said.contains("unknown key \"contacts\""), "{said}");
    assert!(said.contains("Did you mean \"contact\"?"), "{said}");
    let said = parsed(&GOOD.replace("friction = 0.5", "fricton = 0.5")).unwrap_err();
    assert!(said.contains(":36: unknown key \"fricton\" ([[contact]]). Did you mean \"friction\"?"), "{said}");
}

#[test]
fn missing_keys_say_what_to_add() {
    let unit =
        "\"unit\" is missing ([mesh]). Add unit = \"mm\" (or m, cm, um, in, ft), the unit of the mesh's coordinates";
    complains("[mesh]\nfile = \"brake.msh\"\nunit = \"mm\"", "[mesh]\nfile = \"brake.msh\"", 0, unit);
    let said = parsed("").unwrap_err();
    assert!(said.contains("\"mesh\" is missing (top of the file). Add [mesh]"), "{said}");
    let said = parsed(&GOOD.replace("friction = 0.5", "")).unwrap_err();
    assert!(said.contains(":31: \"friction\" is missing ([[contact]])"), "{said}");
    complains(
        "[material.iron]\nyoung = 110e9",
        "[material.iron]",
        0,
        "young is missing (material \"iron\"). Give Pa, such as 110e9",
    );
}

#[test]
fn doubled_keys_and_names_are_refused() {
    let twice = "\"young\" is given twice ([material.iron]). Keep one of them";
    complains("young = 110e9", "young = 110e9\nyoung = 1e9", 1, twice);
    let said = parsed(&GOOD.replace("part.a_pad", "part.disc")).unwrap_err();
    assert!(said.contains(":21: \"disc\" is given twice ([part.disc])"), "{said}");
    let pair = "[[contact]]\nname = \"pair\"\nslave = \"a\"\nmaster = \"b\"\nlaw = { linear = 1 }\nfriction = 0\n[[connector]]";
    complains("[[connector]]", pair, 0, "the name is taken by line 31 (contact \"pair\"). Give each its own name");
    let load = "[[load]]\non = \"back\"\npressure = 1\n[stability]";
    complains("[stability]", load, 0, "the name is taken by line 42 (load \"back\"). Give each its own name");
    let rotation = "[[rotation]]\npart = \"disc\"\naxis = [0, 0, 1]\nspeed = 1\n[[contact]]";
    complains(
        "[[contact]]",
        rotation,
        1,
        "the part turns already (rotation of \"disc\"). Keep one [[rotation]] for each part",
    );
}

#[test]
fn the_unit_must_be_known() {
    let said = "unknown unit of length \"inch\" (mesh). Did you mean \"in\"? There is: m, cm, mm, um, in, ft";
    complains("unit = \"mm\"", "unit = \"inch\"", 0, said);
}

#[test]
fn names_within_the_file_must_exist() {
    let said = "unknown material \"irn\" (part \"disc\"). Did you mean \"iron\"? There is: iron, lining";
    complains("material = \"iron\"", "material = \"irn\"", 0, said);
    let said =
        "there is no [part.disk] (rotation of \"disk\"). Did you mean \"disc\"? There is: disc, a_pad; or add it";
    complains("part = \"disc\"", "part = \"disk\"", 0, said);
    let said = parsed(&GOOD.replace("contacts = [\"pair\"]", "contacts = [\"par\"]")).unwrap_err();
    assert!(said.ends_with(":48: unknown contact \"par\" (sweep). Did you mean \"pair\"? There is: pair"), "{said}");
    let said = parsed(&GOOD.replace("material = \"lining\"", "")).unwrap_err();
    assert!(said.contains(":21: \"material\" is missing ([part.a_pad])"), "{said}");
}
