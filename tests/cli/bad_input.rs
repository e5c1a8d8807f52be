//! What a user meets who gives the program something it cannot analyse: one message that names file, line or item and
//! parts what to do, exit code 2, and nothing written.

use insta::assert_snapshot;

use crate::support::data;
use crate::support::pad_on_disc::{MODEL, PadOnDisc};
use crate::support::program::{Finished, Place, refusal, swap};

/// What was asked, and the refusal: exit code 2, one message, and no file or folder has appeared.
#[track_caller]
fn refused(place: &Place, arguments: &[&str]) -> String {
    let before = place.list("");
    let message = refusal(&place.run(arguments));
    assert_eq!(place.list(""), before, "something was written");
    format!("$ squeal {}\n{message}\n", arguments.join(" "))
}

/// The same on two ranks: the same message, once, no hang.
#[track_caller]
fn refused_on_two(place: &Place, arguments: &[&str]) -> String {
    let before = place.list("");
    let (one, two) = (refused(place, arguments), refusal(&place.run_on(2, arguments)));
    assert!(one.ends_with(&format!("\n{two}\n")), "{one}{two}");
    assert_eq!(place.list(""), before, "something was written");
    one
}

/// What was exchanged in a model file, and the refusal.
#[track_caller]
fn model_refused(old: &str, new: &str) -> String {
    let place = Place::with_blocks(|text| swap(&text, old, new), &PadOnDisc::default());
    exchange(old, new, &refusal(&place.run(&["static", "brake.toml"])))
}

/// What was exchanged in a mesh, and the refusal.
#[track_caller]
fn mesh_refused(old: &str, new: &str) -> String {
    let place = Place::blocks();
    place.write("blocks.msh", swap(&PadOnDisc::default().gmsh(), old, new));
    exchange(old, new, &refusal(&place.run(&["static", "brake.toml"])))
}

fn exchange(old: &str, new: &str, message: &str) -> String {
    let lines = |mark: &str, text: &str| text.lines().map(|line| format!("{mark} {line}\n")).collect::<String>();
    lines("-", old) + &lines("+", new) + message + "\n"
}

#[test]
fn a_model_file_that_cannot_be_read() {
    let place = Place::blocks();
    let mut bytes = MODEL.as_bytes().to_vec();
    bytes.splice(20..20, [0xE9]);
    place.write("latin.toml", bytes);
    place.write("empty.toml", "");
    let files = ["brake.tml", ".", "blocks.msh", "latin.toml", "empty.toml"];
    let messages: String = files.iter().map(|file| refused(&place, &["static", file])).collect();
    assert_snapshot!(messages + &refused_on_two(&place, &["stability", "brake.tml"]));
}

#[test]
fn a_mesh_that_cannot_be_read() {
    let place = Place::blocks();
    std::fs::remove_file(place.path("blocks.msh")).unwrap();
    let mut messages = refused_on_two(&place, &["static", "brake.toml"]);
    let whole = PadOnDisc::default().gmsh();
    for n_bytes in [0, whole.len() / 5, whole.len() * 4 / 5] {
        place.write("blocks.msh", &whole[..n_bytes]);
        messages += &refused(&place, &["static", "brake.toml"]);
    }
    assert_snapshot!(messages + &mesh_refused("4.1 0 8", "2.2 0 8"));
}

#[test]
fn elements_that_are_too_stiff_are_warned_of() {
    let linear = Place::with_blocks(|text| text, &PadOnDisc { quadratic: false, ..PadOnDisc::default() });
    let said = linear.run(&["check", "brake.toml"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let all = said.out + &said.err;
    assert!(all.contains("part \"disc\" has 54 elements C3D4, too stiff for squeal"), "{all}");
    assert!(all.contains("part \"pad\""), "{all}");
}

#[test]
fn elements_that_cannot_be_computed() {
    let inverted = Place::with_blocks(|text| text, &PadOnDisc { inverted: true, ..PadOnDisc::default() });
    assert_snapshot!(refused_on_two(&inverted, &["static", "brake.toml"]));
}

#[test]
fn names_that_mean_nothing_or_two_things() {
    let messages = [
        model_refused("young = 1", "yuong = 1"),
        model_refused("[stability]", "[stabilty]"),
        model_refused("material = \"iron\"", "material = \"irn\""),
        model_refused("\"disc_bottom\"", "\"disk_bottom\""),
        model_refused("\"pad_bottom\"", "\"pad_botom\""),
        model_refused("on = \"pad_top\"", "on = \"pad_tpo\""),
        model_refused("part = \"disc\"", "part = \"disk\""),
        model_refused("young = 110e9", "young = 110e9\nyoung = 1e9"),
        model_refused("[part.pad]", "[part.disc]"),
        model_refused("[[load]]", SECOND_CONTACT),
        mesh_refused("\"disc_top\"", "\"disc\""),
        mesh_refused("\"disc_top\"", "\"pad_top\""),
        mesh_refused("2 2 \"disc_top\"", "2 9 \"disc_top\""),
    ];
    assert_snapshot!(messages.concat());
}

/// A contact with the name of the first one, before the loads.
const SECOND_CONTACT: &str = "[[contact]]
name = \"disc / pad\"
slave = \"pad_top\"
master = \"disc_top\"
law = { linear = 2e13 }
friction = 0
[[load]]";

#[test]
fn a_part_without_material() {
    let messages = [
        model_refused("[part.disc]\nmaterial = \"iron\"", "[part.disc]"),
        model_refused("[part.pad]\nmaterial = \"iron\"\n", ""),
    ];
    assert_snapshot!(messages.concat());
}

#[test]
fn units_and_constants_that_cannot_be() {
    let (constants, unit) =
        ("young = 110e9\npoisson = 0.27", "0, 0, 0, 1e9, 0, 0], [0, 0, 0, 0, 1e9, 0], [0, 0, 0, 0, 0, 1e9]]");
    let full = |rows: &str| format!("kind = \"full\"\nelasticity = [{rows}, [0, 0, 1e9, 0, 0, 0], [{unit}");
    let ortho = "kind = \"orthotropic\"\nyoung = [1e9, 1e9, 1e9]\npoisson = [0.9, 0.9, 0.9]\nshear = [1e9, 1e9, 1e9]";
    let messages = [
        model_refused("unit = \"mm\"\n", ""),
        model_refused("\"mm\"", "\"mmm\""),
        model_refused("0.27", "0.5"),
        model_refused("110e9", "-110e9"),
        model_refused("7100", "0"),
        model_refused("7100", "\"7100\""),
        model_refused("young = 110e9\n", ""),
        model_refused(constants, &full("[1e9, 2e9, 0, 0, 0, 0], [2e9, 1e9, 0, 0, 0, 0]")),
        model_refused(constants, &full("[1e9, 2e8, 0, 0, 0, 0], [0, 1e9, 0, 0, 0, 0]")),
        model_refused(constants, ortho),
        model_refused("speed = 5.0", "speed = 0"),
    ];
    assert_snapshot!(messages.concat());
}

#[test]
fn a_contact_without_points() {
    let place = Place::with_blocks(|text| text, &PadOnDisc { gap: 12.0, ..PadOnDisc::default() });
    let messages = [
        refused_on_two(&place, &["static", "brake.toml"]),
        model_refused("master = \"disc_top\"", "master = \"disc_bottom\""),
        model_refused("master = \"disc_top\"", "master = \"pad_top\""),
    ];
    assert_snapshot!(messages.concat());
}

/// Variants of supports, and what of each stays free. Supports in one plane allow tilting out of it.
#[test]
fn a_part_without_constraints() {
    let (pad, disc) = ("[[fix]]\nnodes = \"pad_top\"\naxes = \"xy\"\n", "axes = \"xyz\"");
    let messages = [
        model_refused(pad, ""),
        model_refused("axes = \"xy\"", "axes = \"x\""),
        model_refused(disc, "axes = \"xz\""),
        model_refused(disc, "axes = \"xy\""),
        model_refused(disc, "axes = \"z\""),
    ];
    assert_snapshot!(messages.concat());
}

/// Two corners of one edge along z would be a hinge; a connector at the pad's axis leaves its rotation about z alone.
#[test]
fn a_pad_that_only_turns() {
    let connector =
        "[[connector]]\nbetween = [\"pad_top\", \"disc_bottom\"]\nat = [15, 15, 10]\nstiffness = [1e6, 1e6, 0]\n";
    let fix = "[[fix]]\nnodes = \"pad_top\"\naxes = \"xy\"\n";
    // In any unit: the threshold does not depend on lengths.
    let messages = ["um", "mm", "m"].map(|unit| {
        let change = |text: String| swap(&swap(&text, fix, connector), "\"mm\"", &format!("\"{unit}\""));
        let place = Place::with_blocks(change, &PadOnDisc::default());
        let message = refused(&place, &["static", "brake.toml"]);
        let stiff = swap(&place.read("brake.toml"), "1e6, 0]\n", "1e6, 0]\nrotational_stiffness = [0, 0, 1]\n");
        place.write("stiff.toml", stiff);
        assert_eq!(place.run(&["check", "stiff.toml"]).code, 0, "{unit}");
        message
    });
    assert_eq!([&messages[0], &messages[2]], [&messages[1]; 2]);
    assert_snapshot!(messages[0]);
}

/// Facets of a cylinder resist its rotation a little; that is no support.
#[test]
fn a_piston_that_spins_in_its_bore() {
    let place = Place::empty();
    std::fs::copy(data("piston_in_bore.msh"), place.path("piston_in_bore.msh")).unwrap();
    place.write("brake.toml", PISTON);
    assert_snapshot!(refused(&place, &["static", "brake.toml"]));
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
    assert_snapshot!(refused_on_two(&place, &["static", "brake.toml"]));
}

#[test]
fn options_out_of_range() {
    let place = Place::blocks();
    let friction = |values: &str| refused(&place, &["static", "brake.toml", "--friction", values]);
    let band = |band: &str| refused(&place, &["stability", "brake.toml", "--band", band]);
    let messages = [
        model_refused("friction = 0.4", "friction = 4.0"),
        model_refused("friction = 0.4", "friction = -0.4"),
        ["-0.4", "abc", "0.4,0.4", "0.9:0.1:0.1"].map(friction).concat(),
        refused_on_two(&place, &["static", "brake.toml", "--friction", "4"]),
        model_refused("[0, 20000]", "[900, 900]"),
        model_refused("[0, 20000]", "[-1, 900]"),
        ["5:5", "9:5", "-5:5"].map(band).concat(),
        refused_on_two(&place, &["static", "brake.toml", "--petsc", "snes_monitor"]),
        refused(&place, &["static", "brake.toml", "--fiction", "0.3"]),
        refused(&place, &["statik", "brake.toml"]),
    ];
    assert_snapshot!(messages.concat());
}

#[test]
fn an_output_folder_that_is_taken() {
    let place = Place::blocks();
    assert_eq!(place.run(&["static", "brake.toml", "-o", "old"]).code, 0);
    let results = place.list("old");
    let mut messages = refused_on_two(&place, &["static", "brake.toml", "-o", "old"]);
    assert_eq!(place.list("old"), results);
    place.write("old/notes.txt", "");
    std::fs::create_dir(place.path("thesis")).unwrap();
    place.write("thesis/thesis.tex", "");
    for (folder, force) in [
        ("old", &["--force"][..]),
        ("thesis", &[]),
        ("thesis", &["--force"]),
        ("blocks.msh", &["--force"]),
        ("blocks.msh/run", &[]),
    ] {
        messages += &refused(&place, &[&["static", "brake.toml", "-o", folder], force].concat());
    }
    assert_eq!(place.list("thesis"), ["thesis.tex"]);
    assert_snapshot!(messages);
}

#[test]
fn a_brake_without_load() {
    let load = "[[load]]\nname = \"piston\"\non = \"pad_top\"\nforce = [0, 0, -1000]\n";
    assert_snapshot!(model_refused("force = [0, 0, -1000]", "force = [0, 0, 0]") + &model_refused(load, ""));
    let place = Place::with_blocks(|text| swap(&text, load, ""), &PadOnDisc::default());
    let check = place.run(&["check", "brake.toml"]);
    assert!(check.code == 2 && check.err.contains("no load presses the contacts together"), "{}", check.err);
    // Parts that overlap press each other.
    let place = Place::with_blocks(|text| swap(&text, load, ""), &PadOnDisc { gap: -1e-3, ..PadOnDisc::default() });
    let overlap = place.run(&["static", "brake.toml"]);
    assert!(!overlap.err.contains("no load presses"), "{}", overlap.err);
}

/// A file is replaced only by `--force`, and then only by one of its kind: a wrong name after -o does not cost the
/// model or the mesh.
#[test]
fn an_output_file_that_is_taken() {
    let place = Place::blocks();
    let check = ["check", "brake.toml", "--contacts", "4", "-o"];
    let with = |more: &[&'static str]| [&check[..], more].concat();
    let mut messages = String::new();
    for more in [&["blocks.msh"][..], &["brake.toml"], &["blocks.msh", "--force"]] {
        let before = place.read(more[0]);
        messages += &refused(&place, &with(more));
        assert_eq!(place.read(more[0]), before);
    }
    assert_eq!(place.run(&with(&["cells.vtu"])).code, 0);
    messages += &refused(&place, &with(&["cells.vtu"]));
    assert_eq!(place.run(&with(&["cells.vtu", "--force"])).code, 0);
    assert_eq!(place.list(""), ["blocks.msh", "brake.toml", "cells.vtu"], "no draft is left");
    messages += &refused(&place, &["reduce", "brake.toml", "--contacts", "4", "--force", "-o", "blocks.msh"]);
    assert_eq!(place.run(&["stability", "brake.toml", "-o", "run"]).code, 0);
    messages += &refused(&place, &["report", "run", "--force", "-o", "brake.toml"]);
    assert_snapshot!(messages);
}

/// The address space that the program takes up to the factor, found from a run without limit, and a little: too little
/// for the factor.
#[test]
fn too_little_memory() {
    let place = Place::pads();
    let program = assert_cmd::cargo::cargo_bin("squeal");
    let limited = |kilobytes: u64| -> Finished {
        let mut shell = assert_cmd::Command::new("sh");
        shell.current_dir(place.path("")).env("OPENBLAS_NUM_THREADS", "1");
        let script = format!("ulimit -v {kilobytes}; exec {} check brake.toml", program.display());
        shell.args(["-c", &script]).output().unwrap().into()
    };
    // Above what it has been seen to take, and what a busy machine has hidden, MUMPS's estimate comes to be what lacks.
    let peak = address_space_of_a_check(&place);
    let outcomes = (1..=16).map(|step| (peak + step * 16 * 1024, limited(peak + step * 16 * 1024)));
    let is_told = |finished: &Finished| finished.err.starts_with("error: too little memory: the factor needs ");
    let (limit, finished) = outcomes.into_iter().find(|(_, finished)| is_told(finished)).expect("told at some limit");
    assert_eq!(finished.code, 2, "{}", finished.err);
    assert!(finished.err.contains("ulimit -v leaves") && finished.err.contains("A coarser mesh"), "{}", finished.err);
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
