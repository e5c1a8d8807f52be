//! Decks of Abaqus and CalculiX on the command line.

use serde_json::Value;
use squeal::element::ElementKind;
use squeal::mesh::Mesh;

use crate::support::block::Block;
use crate::support::program::{Place, assert_refused};

/// The pad on a disc as a deck `brake.inp`, without its model file and mesh.
fn place() -> Place {
    let place = Place::blocks();
    let said = place.run(&["convert", "brake.toml", "-o", "brake.inp"]);
    assert_eq!((said.code, said.out.as_str()), (0, "written: brake.inp\n"), "{}", said.err);
    std::fs::remove_file(place.path("blocks.msh")).unwrap();
    std::fs::remove_file(place.path("brake.toml")).unwrap();
    place
}

#[test]
fn check_prints_what_was_understood_of_a_deck() {
    let place = place();
    let deck = place.read("brake.inp").replace("*STEP\n*FREQUENCY", "*STEP\n*NODE PRINT,NSET=A\nU\n*FREQUENCY");
    place.write("brake.inp", deck);
    let said = place.run(&["check", "brake.inp"]);
    assert_eq!(said.code, 0, "{}", said.err);
    for text in ["lines in brake.inp", " C3D10\n", "units: mm-t-s", "*NODE PRINT (brake.inp:", "pad_bottom / disc_top"]
    {
        assert!(said.out.contains(text), "{text:?} is not in {}", said.out);
    }
    let json = place.run(&["check", "brake.inp", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&json.out).unwrap();
    assert_eq!(document["deck"]["units"], "mm-t-s");
    let two = place.run_on(2, &["check", "brake.inp"]);
    assert_eq!((two.code, two.out.lines().next()), (0, said.out.lines().next()), "{}", two.err);
}

#[test]
fn check_prints_the_seconds_and_memory_of_its_stages_where_they_are_asked_for() {
    let place = place();
    let stages = ["reading model and mesh", "dividing the mesh", "finding contact points", "checking the model"];
    let stages: Vec<&str> = stages.into_iter().chain(["assembling M, C and K", "analysing the factor"]).collect();
    for n in [1, 2] {
        let said = place.run_on(n, &["check", "brake.inp", "-v"]);
        let lines: Vec<&str> = said.err.lines().filter(|line| line.contains(" s, peak memory 0.")).collect();
        let names: Vec<&str> = lines.iter().filter_map(|line| line.split(':').next()).collect();
        assert_eq!((said.code, names), (0, stages.clone()), "{}", said.err);
    }
    assert!(!place.run(&["check", "brake.inp"]).err.contains("peak memory"));
}

#[test]
fn a_deck_squeals_as_its_model_does() {
    let place = Place::blocks();
    assert_eq!(place.run(&["convert", "brake.toml", "-o", "deck.inp"]).code, 0);
    let modes = |model: &str| {
        let said = place.run(&["stability", model, "--friction", "0.3", "--band", "0:60000", "--no-branches"]);
        assert_eq!(said.code, 0, "{}", said.err);
        said.out.lines().filter(|line| line.trim_start().starts_with("0.300 ")).map(str::to_owned).collect::<Vec<_>>()
    };
    let expected = modes("brake.toml");
    assert!(!expected.is_empty());
    assert_eq!(modes("deck.inp"), expected);
    // Named as the mesh of a model file, for what no deck says.
    let short = "[mesh]\nfile = \"deck.inp\"\nunit = \"mm\"\n[stability]\nband = [0, 20000]\n\
                 [sweep]\nfriction = { values = [0.3] }\n";
    place.write("short.toml", short);
    let said = place.run(&["check", "short.toml"]);
    assert_eq!(said.code, 0, "{}", said.err);
    // Back to a model file.
    let said = place.run(&["convert", "deck.inp", "-o", "back.toml"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(modes("back.toml"), expected);
}

#[test]
fn a_proposed_stiffness_is_printed_and_is_the_same_as_a_deck_and_back() {
    let place = Place::with_pads(|text| text.replace("{ linear = 2e13 }", "\"auto\""));
    let proposed = |model: &str| {
        let document: Value = serde_json::from_str(&place.run(&["check", model, "--json"]).out).unwrap();
        document["pairs"][0]["proposed_stiffness_n_per_m3"].as_f64().unwrap()
    };
    let stiffness = proposed("brake.toml");
    let line = format!(" gets a stiffness of {stiffness:.3e} N/m3\n");
    let said = place.run(&["check", "brake.toml"]);
    assert!(said.out.contains(&line), "{line} is not in {}", said.out);
    for (from, to) in [("brake.toml", "deck.inp"), ("deck.inp", "back.toml")] {
        let said = place.run(&["convert", from, "-o", to]);
        assert!(said.code == 0 && said.out.contains(&line), "{} {}", said.out, said.err);
        assert!((proposed(to) / stiffness - 1.0).abs() < 1e-12, "{} {stiffness}", proposed(to));
    }
    assert!(place.read("deck.inp").contains("PRESSURE-OVERCLOSURE=HARD\n"));
    assert!(place.read("back.toml").contains("law = \"auto\""));
}

#[test]
fn the_influence_of_a_proposed_stiffness_on_an_unstable_mode_is_printed() {
    let place = Place::with_pads(|text| text.replace("{ linear = 2e13 }", "\"auto\""));
    let said = place.run(&["stability", "brake.toml", "--friction=0.4", "--band=0:1500", "--no-branches"]);
    let line = "proposed: the contact disc / inner pad gets a stiffness of ";
    assert!(said.code == 0 && said.err.contains(line), "{}", said.err);
    let influence = " N/m3) was proposed: to first order +10 % changes, at friction 0.4, the mode at 12";
    assert!(said.out.contains(influence), "{}", said.out);
}

#[test]
fn what_cannot_be_converted_or_analysed_is_refused() {
    let place = place();
    let refused = |arguments: &[&str], says: &[&str]| assert_refused(&place.run(arguments), says);
    refused(&["convert", "brake.inp", "-o", "brake.msh"], &["brake.msh: the name must end with .toml or .inp"]);
    refused(&["convert", "brake.inp", "-o", "brake.inp"], &["brake.inp exists. Use --force"]);
    refused(&["check", "none.inp"], &["none.inp: cannot read the deck: No such file"]);
    refused(&["convert", "brake.inp", "-o", "a.toml", "--units", "mm"], &["mm-t-s, m-kg-s"]);
    place.write("own.toml", "title = \"mine\"\n");
    refused(&["convert", "brake.inp", "-o", "own.toml", "--force"], &["is not a file that squeal convert has written"]);
    let text = place.read("brake.inp");
    place.write("tie.inp", text.clone() + "*TIE, NAME=T\nA, B\n");
    refused(&["stability", "tie.inp"], &["tie.inp:", "there is no surface B"]);
    place.write("short.toml", "[mesh]\nfile = \"brake.inp\"\nunit = \"m\"\n[stability]\nband = [0, 9]\n");
    refused(&["check", "short.toml"], &["brake.inp:", "no system of units with a unit of length of 1 m"]);
    let parts = "[[rotation]]\npart = \"disk\"\naxis = [0, 0, 1]\nspeed = 1\n[stability]\nband = [0, 9]\n";
    place.write("short.toml", format!("[mesh]\nfile = \"brake.inp\"\nunit = \"mm-t-s\"\n{parts}"));
    refused(&["check", "short.toml"], &["short.toml:4: there is no part \"disk\" to turn. Did you mean \"disc\"?"]);
}

/// Gmsh's file knows no kinds: the part names them.
#[test]
fn the_kinds_of_elements_stay_in_a_deck_and_back() {
    let mut mesh = Mesh::default();
    Block { part: "bar", cells: [2, 2, 2], wraps: false, map: &|x| x.map(|x| 0.01 * x) }
        .add_solids_to(&mut mesh, ElementKind::C3D8I);
    let place = Place::empty();
    let mut file = Vec::new();
    squeal::mesh::write(&mesh, 1e-3, "a test", &mut file).unwrap();
    place.write("bar.msh", file);
    let model = |kinds: &str| {
        format!(
            "[mesh]\nfile = \"bar.msh\"\nunit = \"mm\"\n[material.iron]\nyoung = 1e11\npoisson = 0.3\ndensity = 7000\n\
             [part.bar]\nmaterial = \"iron\"\nelements = {kinds}\n[[fix]]\nnodes = \"bar_z0\"\naxes = \"xyz\"\n\
             [stability]\nband = [0, 1e6]\n"
        )
    };
    place.write("brake.toml", model("[\"C3D8R\"]"));
    let check = |model: &str| {
        let document: Value = serde_json::from_str(&place.run(&["check", model, "--json"]).out).unwrap();
        document["warnings"].as_array().unwrap().len()
    };
    assert_eq!(check("brake.toml"), 0);
    for (from, to) in [("brake.toml", "deck.inp"), ("deck.inp", "back.toml")] {
        let said = place.run(&["convert", from, "-o", to]);
        assert!(said.code == 0 && !said.out.contains("become"), "{} {}", said.out, said.err);
    }
    assert!(place.read("deck.inp").contains("TYPE=C3D8R,"));
    assert!(place.read("back.toml").contains("elements = [\"C3D8R\"]"));
    place.write("brake.toml", model("[\"C3D20R\"]"));
    let said = place.run(&["check", "brake.toml"]);
    assert_refused(&said, &["brake.toml:", "part \"bar\": the mesh has no elements of the shape of C3D20R"]);
}

/// A deck of statics alone needs no densities; modes are refused, also where a model file asks for them.
#[test]
fn a_deck_without_densities_has_an_equilibrium_and_no_modes() {
    let place = place();
    let text = place.read("brake.inp");
    let (statics, _) = text.rsplit_once("*STEP\n").unwrap();
    let mut lines: Vec<&str> = statics.lines().collect();
    while let Some(at) = lines.iter().position(|line| *line == "*DENSITY") {
        lines.drain(at..at + 2);
    }
    place.write("static.inp", lines.join("\n") + "\n");
    let said = place.run(&["static", "static.inp", "--friction", "0.3"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let modes = ["stability", "static.inp", "--friction", "0.3"];
    assert_refused(&place.run(&modes), &["static.inp:", "has no density, so that there are no modes"]);
}

/// Loss factors of a material and of a spring, written as a deck and read from it.
#[test]
fn loss_factors_survive_a_deck() {
    let place = Place::blocks();
    let joint = "[[connector]]\nbetween = [\"pad_top\", \"ground\"]\nstiffness = [1e6, 2e6, 3e6]\nloss_factor = 0.2\n";
    let text = place.read("brake.toml").replace("density = 7100", "density = 7100\nloss_factor = 0.05");
    place.write("brake.toml", text.replace("[[load]]", &format!("{joint}[[load]]")));
    let shown = |file: &str| {
        let finished = place.run(&["check", file]);
        assert_eq!(finished.code, 0, "{}", finished.err);
        finished.out
    };
    let first = shown("brake.toml");
    assert!(first.contains("loss factor 0.05\n") && first.contains("\": loss factor 0.2\n"), "{first}");
    let converted = place.run(&["convert", "brake.toml", "-o", "brake.inp"]);
    assert_eq!(converted.code, 0, "{}", converted.err);
    let deck = place.read("brake.inp");
    assert!(deck.contains("*DAMPING,STRUCTURAL=0.05\n") && deck.contains(",COMPLEX STIFFNESS\n"), "{deck}");
    let second = shown("brake.inp");
    assert!(second.contains("loss factor 0.05\n") && second.contains("\": loss factor 0.2\n"), "{second}");
}
