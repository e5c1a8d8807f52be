//! Names, paths and texts that hardly anybody means.

use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::{OsStrExt, OsStringExt};

use serde_json::Value;

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, assert_refused, mpirun, swap};

#[test]
fn a_path_need_not_be_utf_8() {
    let place = Place::blocks();
    let folder = OsStr::from_bytes(b"caf\xe9");
    std::fs::create_dir(place.path("").join(folder)).unwrap();
    for name in ["brake.toml", "blocks.msh"] {
        std::fs::rename(place.path(name), place.path("").join(folder).join(name)).unwrap();
    }
    let inside = |name: &str| OsString::from_vec([folder.as_bytes(), name.as_bytes()].concat());
    let run = |words: &[&OsStr]| -> Finished { place.command().args(words).output().unwrap().into() };
    let [model, results, element] = ["/brake.toml", "/out", "/x.se.h5"].map(inside);
    let word = OsStr::new;
    for words in [
        &[word("check"), &model][..],
        &[word("static"), &model, word("-o"), &results],
        &[word("stability"), &model, word("-o"), &inside("/sweep")],
        &[word("report"), &inside("/sweep")],
        &[word("compare"), &inside("/sweep"), &inside("/sweep")],
        &[word("reduce"), &model, word("--contacts"), word("4"), word("-o"), &element],
        &[word("stability"), &element, word("-o"), &inside("/reduced")],
    ] {
        let said = run(words);
        assert_eq!(said.code, 0, "{words:?}: {}", said.err);
    }
    let mut two = mpirun(2, &assert_cmd::cargo::cargo_bin("squeal"));
    let said = two.current_dir(place.path("")).args([word("static"), &model, word("-o"), &inside("/two")]).output();
    let said: Finished = said.unwrap().into();
    assert_eq!(said.code, 0, "{}", said.err);
}

/// A mesh that is opened in a terminal must not act on it.
#[test]
fn control_characters_of_names_are_spelled_out() {
    let place = Place::with_blocks(|text| swap(&text, "[part.pad]", "[part.\"\\u001b[2Jpad\"]"), &PadOnDisc::default());
    let mesh = place.read("blocks.msh").replace("\"pad\"", "\"\u{1b}[2Jpad\"");
    place.write("blocks.msh", mesh);
    let check = place.run(&["check", "brake.toml"]);
    assert!(check.code == 0 && check.out.contains("\\u{1b}[2Jpad"), "{:?} {}", check.out, check.err);
    assert!(!check.out.contains('\u{1b}') && !check.err.contains('\u{1b}'));
    let long = place.read("blocks.msh").replacen("$Nodes\n", &format!("$Nodes\n{}\n", "x".repeat(100_000)), 1);
    place.write("blocks.msh", long);
    let refused = place.run(&["check", "brake.toml"]);
    assert!(refused.code == 2 && refused.err.len() < 500, "{}", refused.err.len());
}

#[test]
fn a_path_of_windows_in_double_quotes() {
    let name = |to: &str| Place::with_blocks(|text| swap(&text, "\"blocks.msh\"", to), &PadOnDisc::default());
    for path in ["\"C:\\users\\blocks.msh\"", "\"C:\\meshes\\blocks.msh\""] {
        let said = name(path).run(&["check", "brake.toml"]);
        assert_refused(&said, &["brake.toml:3: ", "Write a path with / or in single quotes"]);
    }
    // Both are escapes: a tab and a backspace.
    let said = name("\"C:\\temp\\blocks.msh\"").run(&["check", "brake.toml"]);
    assert_refused(&said, &["emp\\u{8}locks.msh: No such file"]);
    assert_refused(&name("'C:\\temp\\blocks.msh'").run(&["check", "brake.toml"]), &["the mesh C:\\temp\\blocks.msh"]);
}

#[test]
fn errors_of_the_command_line_are_json_too() {
    let said = Place::blocks().run(&["stability", "brake.toml", "--friction", "abc", "--json"]);
    let document: Value = serde_json::from_str(said.err.trim()).unwrap();
    assert_eq!((said.code, document["exit_code"].as_i64()), (2, Some(2)));
    assert!(document["error"].as_str().unwrap().starts_with("invalid value 'abc' for"), "{document}");
}

#[test]
fn errors_of_a_family_have_file_and_line() {
    let place = Place::empty();
    place.write("m.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 1\n2 2 1\n");
    let family = |factor: &str| {
        format!(
            "parameter = \"mu\"\n[[mass]]\nfile = \"m.mtx\"\n[[stiffness]]\nfile = \"m.mtx\"\nfactor = \"{factor}\"\n"
        )
    };
    let modes = |text: Vec<u8>| {
        place.write("family.toml", text);
        place.run(&["modes", "family.toml", "--parameter", "0:1:0.5", "--band", "0:2"])
    };
    let infinite = modes(family("1/mu").into());
    assert_refused(&infinite, &["family.toml:6: the factor \"1/mu\" is inf at the value 0 of the parameter"]);
    assert_refused(&modes(family("mu +").into()), &["family.toml:6: \"mu +\" is no expression in mu"]);
    assert_refused(&modes(b"a\n\xff\n".into()), &["family.toml:2: here is a byte that is not UTF-8"]);
    let model = modes(Place::blocks().read("brake.toml").into());
    assert_refused(&model, &["this is a model file, not a family of matrices. Give --part NAME"]);
}

#[test]
fn measured_points_of_another_unit_are_refused() {
    let place = Place::blocks();
    let run = ["modes", "brake.toml", "--part", "disc", "--band", "0:100000", "--measured", "taps.csv", "-o", "out"];
    assert_refused(&place.run(&run), &["taps.csv: the measured modes cannot be read: No such file"]);
    // The disc is 30 mm long.
    place.write("taps.csv", "x,y,z,direction,993.5\n0,0,4000,z,1\n30,30,10,z,0.5\n");
    assert_refused(&place.run(&run), &["a measured point is 3990.0 from the nearest node, and the part is 30.0 long"]);
    place.write("taps.csv", "x,y,z,direction,-5\n0,0,10,z,1\n");
    assert_refused(&place.run(&run), &["taps.csv:1: a mode has the frequency -5 Hz. Give Hz above 0"]);
}
