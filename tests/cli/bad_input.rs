//! What a user meets who gives the program something it cannot analyse: one message that names file, line or item and
//! says what to do, exit code 2, and nothing written.

use crate::support::data;
use crate::support::pad_on_disc::{MODEL, PadOnDisc};
use crate::support::program::{Place, Said, assert_refused, swap};

/// Requires a refusal that says all of `says`, and that no file or folder has appeared. Gives the message.
#[track_caller]
fn refused(place: &Place, arguments: &[&str], says: &[&str]) -> String {
    let before = place.list("");
    let said = place.run(arguments);
    assert_refused(&said, says);
    assert_eq!(place.list(""), before, "something was written");
    said.err
}

/// The same on two ranks: one message, no hang.
#[track_caller]
fn refused_on_two(place: &Place, arguments: &[&str], says: &[&str]) {
    let before = place.list("");
    assert_refused(&place.run_on(2, arguments), says);
    assert_eq!(place.list(""), before, "something was written");
}

/// A model file with one thing exchanged.
#[track_caller]
fn model_refused(old: &str, new: &str, says: &[&str]) {
    let place = Place::with_blocks(|text| swap(&text, old, new), &PadOnDisc::default());
    refused(&place, &["static", "brake.toml"], says);
}

/// A mesh with one thing exchanged.
#[track_caller]
fn mesh_refused(old: &str, new: &str, says: &[&str]) {
    let place = Place::blocks();
    place.write("blocks.msh", swap(&PadOnDisc::default().gmsh(), old, new));
    refused(&place, &["static", "brake.toml"], says);
}

#[test]
fn a_model_file_that_cannot_be_read() {
    let place = Place::blocks();
    let says = ["brake.tml: cannot read the model file: No such file", "Name the model file"];
    refused(&place, &["check", "brake.tml"], &says);
    refused_on_two(&place, &["stability", "brake.tml"], &says);
    refused(&place, &["static", "."], &["Is a directory", "Name the model file in it"]);
    refused(&place, &["static", "blocks.msh"], &["blocks.msh is a mesh. Name the model file that has it"]);
    let mut bytes = MODEL.as_bytes().to_vec();
    bytes.splice(20..20, [0xE9]);
    place.write("latin.toml", bytes);
    refused(&place, &["static", "latin.toml"], &["latin.toml:2: here is a byte that is not UTF-8. Save"]);
    place.write("empty.toml", "");
    refused(&place, &["static", "empty.toml"], &["empty.toml:1: \"mesh\" is missing", "Add [mesh]"]);
}

#[test]
fn a_mesh_that_cannot_be_read() {
    let place = Place::blocks();
    std::fs::remove_file(place.path("blocks.msh")).unwrap();
    let says = ["brake.toml:3: cannot open the mesh blocks.msh: No such file", "Give its path in [mesh] file"];
    refused(&place, &["static", "brake.toml"], &says);
    refused_on_two(&place, &["static", "brake.toml"], &says);
    let whole = PadOnDisc::default().gmsh();
    for (part, section) in [(0.2, "Nodes"), (0.8, "Elements")] {
        place.write("blocks.msh", &whole[..(part * whole.len() as f64) as usize]);
        let says = ["blocks.msh:", &format!("the file ends inside ${section}. It is truncated: write the mesh again")];
        refused(&place, &["static", "brake.toml"], &says);
    }
    place.write("blocks.msh", "");
    refused(&place, &["static", "brake.toml"], &["blocks.msh:1:", "Is this a Gmsh mesh?"]);
    mesh_refused("4.1 0 8", "2.2 0 8", &["blocks.msh:2", "format 2.2, not 4.1", "Mesh.MshFileVersion = 4.1"]);
}

#[test]
fn elements_that_cannot_be_computed() {
    let inverted = Place::with_blocks(|text| text, &PadOnDisc { inverted: true, ..PadOnDisc::default() });
    let says = ["elements are inverted", "first element ", "of the part \"pad\"", "HighOrderOptimize"];
    refused(&inverted, &["static", "brake.toml"], &says);
    refused_on_two(&inverted, &["static", "brake.toml"], &says);
}

#[test]
fn names_that_mean_nothing_or_two_things() {
    model_refused("young = 1", "yuong = 1", &["brake.toml:6: unknown key \"yuong\"", "Did you mean \"young\"?"]);
    model_refused("[stability]", "[stabilty]", &["brake.toml:34: unknown key", "Did you mean \"stability\"?"]);
    model_refused("material = \"iron\"", "material = \"irn\"", &["unknown material \"irn\"", "Did you mean \"iron\"?"]);
    model_refused("\"disc_bottom\"", "\"disk_bottom\"", &["brake.toml:13:", "Did you mean \"disc_bottom\"?"]);
    model_refused(
        "\"pad_bottom\"",
        "\"pad_botom\"",
        &["brake.toml:24:", "(contact \"disc / pad\"). Did you mean \"pad_bottom\"?"],
    );
    model_refused("on = \"pad_top\"", "on = \"pad_tpo\"", &["(load \"piston\"). Did you mean \"pad_top\"?"]);
    model_refused(
        "part = \"disc\"",
        "part = \"disk\"",
        &["brake.toml:20:", "there is no [part.disk]", "Did you mean \"disc\"?"],
    );
    model_refused("young = 110e9", "young = 110e9\nyoung = 1e9", &["brake.toml:7: \"young\" is given twice"]);
    model_refused("[part.pad]", "[part.disc]", &["brake.toml:11: \"disc\" is given twice", "Keep one of them"]);
    mesh_refused(
        "\"disc_top\"",
        "\"disc\"",
        &["blocks.msh: the name \"disc\" is used twice", "Give each its own name"],
    );
    mesh_refused("\"disc_top\"", "\"pad_top\"", &["the name \"pad_top\" is used twice"]);
    mesh_refused("2 2 \"disc_top\"", "2 9 \"disc_top\"", &["\"disc_top\""]);
}

#[test]
fn both_contacts_with_one_name() {
    let twice = format!("{}[[contact]]\nname = \"disc / pad\"\n", &MODEL[..MODEL.find("[[load]]").unwrap()]);
    let rest = "slave = \"pad_top\"\nmaster = \"disc_top\"\nlaw = { linear = 2e13 }\nfriction = 0\n[stability]\nband = [0, 1]\n";
    let place = Place::with_blocks(|_| twice + rest, &PadOnDisc::default());
    refused(
        &place,
        &["static", "brake.toml"],
        &["brake.toml:30: the name is taken by line 24 (contact \"disc / pad\")"],
    );
}

#[test]
fn a_part_without_material() {
    let says = ["brake.toml:9: \"material\" is missing ([part.disc]). Add material ="];
    model_refused("[part.disc]\nmaterial = \"iron\"", "[part.disc]", &says);
    let says =
        ["brake.toml:3: a physical volume of the mesh is no part (volume \"pad\"). Add [part.\"pad\"] with a material"];
    model_refused("[part.pad]\nmaterial = \"iron\"\n", "", &says);
}

#[test]
fn units_and_constants_that_cannot_be() {
    model_refused("unit = \"mm\"\n", "", &["brake.toml:2: \"unit\" is missing", "Add unit = \"mm\""]);
    model_refused("\"mm\"", "\"mmm\"", &["brake.toml:4: unknown unit of length \"mmm\"", "m, cm, mm, um, in, ft"]);
    let iron = "(material \"iron\")";
    model_refused("0.27", "0.5", &["brake.toml:7: poisson must be above -1 and below 0.5, not 0.5", iron]);
    model_refused("110e9", "-110e9", &["brake.toml:6: young must be above 0, not -110e9", iron, "Give Pa"]);
    model_refused("7100", "0", &["brake.toml:8: density must be above 0, not 0", iron, "Give kg/m3"]);
    model_refused("7100", "\"7100\"", &["brake.toml:8:", "expected a number"]);
    model_refused("young = 110e9\n", "", &["brake.toml:5: young is missing", iron, "Give Pa, such as 110e9"]);
    let (constants, unit) =
        ("young = 110e9\npoisson = 0.27", "0, 0, 0, 1e9, 0, 0], [0, 0, 0, 0, 1e9, 0], [0, 0, 0, 0, 0, 1e9]]");
    let full = |rows: &str| format!("kind = \"full\"\nelasticity = [{rows}, [0, 0, 1e9, 0, 0, 0], [{unit}");
    let says = ["brake.toml:7: elasticity is not positive definite", iron, "Look at signs"];
    model_refused(constants, &full("[1e9, 2e9, 0, 0, 0, 0], [2e9, 1e9, 0, 0, 0, 0]"), &says);
    let says = ["brake.toml:7: elasticity is not symmetric: 2e8 in row 1, column 2, 0e0 in row 2, column 1", iron];
    model_refused(constants, &full("[1e9, 2e8, 0, 0, 0, 0], [0, 1e9, 0, 0, 0, 0]"), &says);
    let ortho = "kind = \"orthotropic\"\nyoung = [1e9, 1e9, 1e9]\npoisson = [0.9, 0.9, 0.9]\nshear = [1e9, 1e9, 1e9]";
    model_refused(constants, ortho, &["no material has these constants", iron, "Make the Poisson's ratios smaller"]);
    model_refused("speed = 5.0", "speed = 0", &["brake.toml:23: speed is 0", "(rotation of \"disc\")"]);
}

#[test]
fn a_contact_without_points() {
    let place = Place::with_blocks(|text| text, &PadOnDisc { gap: 12.0, ..PadOnDisc::default() });
    let says = [
        "brake.toml:24: contact \"disc / pad\"",
        "none of the 16 points",
        "the closest is 12 away, in the mesh's unit",
    ];
    refused(&place, &["static", "brake.toml"], &says);
    refused_on_two(&place, &["static", "brake.toml"], &says);
    let says = ["contact \"disc / pad\"", "no facet of \"disc_bottom\" faces \"pad_bottom\"", "Check that these"];
    model_refused("master = \"disc_top\"", "master = \"disc_bottom\"", &says);
    model_refused("master = \"disc_top\"", "master = \"pad_top\"", &["both lie on the part \"pad\""]);
}

/// Variants of supports, and what of each stays free.
#[test]
fn a_part_that_nothing_holds() {
    let free = |old: &str, new: &str, motions: &[&str]| {
        let place = Place::with_blocks(|text| swap(&text, old, new), &PadOnDisc::default());
        let message = refused(&place, &["static", "brake.toml"], &["brake.toml: held by nothing:\n", "Add a [[fix]]"]);
        let found: Vec<&str> = message.lines().filter_map(|line| line.strip_prefix("  ")).collect();
        assert_eq!(found, motions, "{old} -> {new}");
    };
    let pad = "[[fix]]\nnodes = \"pad_top\"\naxes = \"xy\"\n";
    free(pad, "", &["pad moves along x", "pad moves along y", "pad turns about z"]);
    free("axes = \"xy\"", "axes = \"x\"", &["pad moves along y"]);
    let disc = "axes = \"xyz\"";
    free(disc, "axes = \"xz\"", &["disc moves along y"]);
    // Supports in one plane allow tilting out of it.
    let tilts = [
        "disc moves along y and turns about x, together with pad",
        "disc moves along x and turns about y, together with pad",
    ];
    free(disc, "axes = \"xy\"", &["disc moves along z, together with pad", tilts[0], tilts[1]]);
    free(disc, "axes = \"z\"", &["disc moves along x", "disc moves along y", "disc turns about z"]);
}

#[test]
fn a_pad_that_only_turns() {
    // Two corners of one edge along z would be a hinge; a connector at the pad's axis leaves its rotation about z
    // alone.
    let connector =
        "[[connector]]\nbetween = [\"pad_top\", \"disc_bottom\"]\nat = [15, 15, 10]\nstiffness = [1e6, 1e6, 0]\n";
    let fix = "[[fix]]\nnodes = \"pad_top\"\naxes = \"xy\"\n";
    // In any unit: the threshold knows no lengths.
    for unit in ["um", "mm", "m"] {
        let change = |text: String| swap(&swap(&text, fix, connector), "\"mm\"", &format!("\"{unit}\""));
        let place = Place::with_blocks(change, &PadOnDisc::default());
        let message = refused(&place, &["static", "brake.toml"], &["held by nothing"]);
        let found: Vec<&str> = message.lines().filter_map(|line| line.strip_prefix("  ")).collect();
        assert_eq!(found, ["pad turns about z"], "{unit}");
        let held = swap(&place.read("brake.toml"), "1e6, 0]\n", "1e6, 0]\nrotational_stiffness = [0, 0, 1]\n");
        place.write("held.toml", held);
        assert_eq!(place.run(&["check", "held.toml"]).code, 0, "{unit}");
    }
}

/// Facets of a cylinder resist its rotation a little; that is no support.
#[test]
fn a_piston_that_spins_in_its_bore() {
    let place = Place::empty();
    std::fs::copy(data("piston_in_bore.msh"), place.path("piston_in_bore.msh")).unwrap();
    place.write("brake.toml", PISTON);
    let message = refused(&place, &["static", "brake.toml"], &["held by nothing"]);
    let found: Vec<&str> = message.lines().filter_map(|line| line.strip_prefix("  ")).collect();
    assert_eq!(found, ["piston moves along z", "piston turns about z"]);
}

const PISTON: &str = r#"[mesh]
file = "piston_in_bore.msh"
unit = "mm"
[material.steel]
young = 210e9
poisson = 0.3
density = 7850
[part.piston]
material = "steel"
[part.block]
material = "steel"
[[fix]]
nodes = "outer"
axes = "xyz"
[[contact]]
slave = "piston_side"
master = "bore"
law = { linear = 1e13 }
friction = 0
[stability]
band = [0, 9000]
"#;

#[test]
fn a_pad_whose_contact_is_open_before_the_load() {
    let place = Place::with_blocks(|text| text, &PadOnDisc { gap: 0.1, ..PadOnDisc::default() });
    let says =
        ["pad moves along z", "or close the gap of disc / pad: a contact that may open holds only where it touches"];
    refused(&place, &["static", "brake.toml"], &says);
    refused_on_two(&place, &["static", "brake.toml"], &says);
}

#[test]
fn friction_out_of_range() {
    model_refused(
        "friction = 0.4",
        "friction = 4.0",
        &["brake.toml:29: friction must be from 0 to 2, not 4.0", "disc / pad"],
    );
    model_refused("friction = 0.4", "friction = -0.4", &["friction must be from 0 to 2, not -0.4"]);
    let place = Place::blocks();
    let asked = |friction: &str, says: &str| {
        refused(&place, &["static", "brake.toml", "--friction", friction], &["--friction <MU>", says]);
    };
    asked("4", "friction 4 is out of range: 0 to 2");
    asked("-0.4", "friction -0.4 is out of range: 0 to 2");
    asked("abc", "\"abc\" is not a number");
    asked("0.4,0.4", "0.4 is given twice");
    asked("0.9:0.1:0.1", "the range 0.9:0.1:0.1 has no value");
    refused_on_two(&place, &["static", "brake.toml", "--friction", "4"], &["friction 4 is out of range"]);
}

#[test]
fn an_empty_band() {
    model_refused("[0, 20000]", "[900, 900]", &["brake.toml:35: band is empty: [900, 900]", "lowest < highest"]);
    model_refused("[0, 20000]", "[-1, 900]", &["brake.toml:35: band begins below 0"]);
    let place = Place::blocks();
    for band in ["5:5", "9:5", "-5:5"] {
        refused(&place, &["stability", "brake.toml", "--band", band], &["--band <FROM:TO>", "the band is empty"]);
    }
}

#[test]
fn an_output_folder_that_is_taken() {
    let place = Place::blocks();
    assert_eq!(place.run(&["static", "brake.toml", "-o", "old"]).code, 0);
    let results = place.list("old");
    let says = ["old holds the results of another run", "Use --force to replace them, or --output"];
    refused(&place, &["static", "brake.toml", "-o", "old"], &says);
    refused_on_two(&place, &["static", "brake.toml", "-o", "old"], &says);
    assert_eq!(place.list("old"), results);
    place.write("old/notes.txt", "");
    let says = ["old holds notes.txt, which is not of the run before and would be lost. Move it"];
    refused(&place, &["static", "brake.toml", "-o", "old", "--force"], &says);
    std::fs::create_dir(place.path("thesis")).unwrap();
    place.write("thesis/thesis.tex", "");
    let says = ["thesis exists and is not a results folder of squeal", "Choose another with --output"];
    refused(&place, &["static", "brake.toml", "-o", "thesis"], &says);
    refused(&place, &["static", "brake.toml", "-o", "thesis", "--force"], &says);
    assert_eq!(place.list("thesis"), ["thesis.tex"]);
    refused(
        &place,
        &["static", "brake.toml", "-o", "blocks.msh", "--force"],
        &["blocks.msh is a file. Choose another"],
    );
    let says = ["cannot create the output folder blocks.msh/run: Not a directory", "Choose another with --output"];
    refused(&place, &["static", "brake.toml", "-o", "blocks.msh/run"], &says);
}

#[test]
fn a_brake_that_nothing_presses() {
    let says = [
        "brake.toml: no load presses the contacts together, which alone stop these motions:\n  pad",
        "Give a [[load]]",
    ];
    model_refused("force = [0, 0, -1000]", "force = [0, 0, 0]", &says);
    let load = "[[load]]\nname = \"piston\"\non = \"pad_top\"\nforce = [0, 0, -1000]\n";
    model_refused(load, "", &says);
    let place = Place::with_blocks(|text| swap(&text, load, ""), &PadOnDisc::default());
    let said = place.run(&["check", "brake.toml"]);
    assert!(said.code == 2 && said.err.contains("no load presses the contacts together"), "{}", said.err);
    // Parts that overlap press each other.
    let place = Place::with_blocks(|text| swap(&text, load, ""), &PadOnDisc { gap: -1e-3, ..PadOnDisc::default() });
    let said = place.run(&["static", "brake.toml"]);
    assert!(!said.err.contains("no load presses"), "{}", said.err);
}

/// A file is replaced only by `--force`, and then only by its like: a wrong name after -o does not cost the model or
/// the mesh.
#[test]
fn an_output_file_that_is_taken() {
    let place = Place::blocks();
    let check = |file: &str, force: &[&'static str]| -> Vec<String> {
        ["check", "brake.toml", "--contacts", "4", "-o", file]
            .iter()
            .chain(force)
            .map(|&word| word.to_owned())
            .collect()
    };
    let run = |arguments: Vec<String>| place.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    for (file, force) in [("blocks.msh", &[][..]), ("brake.toml", &[]), ("blocks.msh", &["--force"])] {
        let before = place.read(file);
        assert_refused(&run(check(file, force)), &[file, "exists and is not a VTU file of squeal: it is not replaced"]);
        assert_eq!(place.read(file), before);
    }
    assert_eq!(run(check("cells.vtu", &[])).code, 0);
    assert_refused(&run(check("cells.vtu", &[])), &["cells.vtu exists. Use --force to replace it"]);
    assert_eq!(run(check("cells.vtu", &["--force"])).code, 0);
    assert_eq!(place.list(""), ["blocks.msh", "brake.toml", "cells.vtu"], "no draft is left");
    let reduce = ["reduce", "brake.toml", "--contacts", "4", "--force", "-o", "blocks.msh"];
    refused(&place, &reduce, &["blocks.msh exists and is not a super-element of squeal: it is not replaced"]);
    assert_eq!(place.run(&["stability", "brake.toml", "-o", "run"]).code, 0);
    let report = ["report", "run", "--force", "-o", "brake.toml"];
    refused(&place, &report, &["brake.toml exists and is not a report of squeal: it is not replaced"]);
}

#[test]
fn options_that_are_none() {
    let place = Place::blocks();
    refused(&place, &["static", "brake.toml", "--petsc", "snes_monitor"], &["\"snes_monitor\" has no -name before it"]);
    refused_on_two(&place, &["static", "brake.toml", "--petsc", "snes_monitor"], &["has no -name before it"]);
    refused(&place, &["static", "brake.toml", "--fiction", "0.3"], &["'--fiction'", "'--friction'"]);
    refused(&place, &["statik", "brake.toml"], &["'statik'", "'static'"]);
}

/// The address space that the program takes up to the factor, found from a run without limit, and a little: too little
/// for the factor.
#[test]
fn too_little_memory() {
    let place = Place::pads();
    let program = assert_cmd::cargo::cargo_bin("squeal");
    let limited = |kilobytes: u64| -> Said {
        let mut shell = assert_cmd::Command::new("sh");
        shell.current_dir(place.path("")).env("OPENBLAS_NUM_THREADS", "1");
        let script = format!("ulimit -v {kilobytes}; exec {} check brake.toml", program.display());
        shell.args(["-c", &script]).output().unwrap().into()
    };
    // Above what it has been seen to take, and what a busy machine has hidden, MUMPS's estimate comes to be what lacks.
    let peak = address_space_of_a_check(&place);
    let outcomes = (1..=16).map(|step| (peak + step * 16 * 1024, limited(peak + step * 16 * 1024)));
    let is_told = |said: &Said| said.err.starts_with("error: too little memory: the factor needs ");
    let (limit, said) = outcomes.into_iter().find(|(_, said)| is_told(said)).expect("told at some limit");
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(said.err.contains("ulimit -v leaves") && said.err.contains("A coarser mesh"), "{}", said.err);
    assert_eq!(limited(limit + 400 * 1024).code, 0);
}

/// Largest virtual size of `squeal check`, kB, as the kernel tells while it runs.
fn address_space_of_a_check(place: &Place) -> u64 {
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("squeal"))
        .args(["check", "brake.toml"])
        .current_dir(place.path(""))
        .env("OPENBLAS_NUM_THREADS", "1")
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmPeak:"));
        peak = line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(peak);
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    peak
}
