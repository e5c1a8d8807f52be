//! The reference brake with one thing wrong, and what is said about it.

use crate::mesh::Mesh;
use crate::model::{self, Model};
use std::path::Path;

const GOOD: &str = r#"
[mesh]
file = "pads_on_disc.msh"
unit = "mm"
[material.iron]
young = 110e9
poisson = 0.27
density = 7100
[part.disc]
material = "iron"
[part.lining_inner]
material = "iron"
[part.backplate_inner]
material = "iron"
[part.lining_outer]
material = "iron"
[part.backplate_outer]
material = "iron"
[[fix]]
nodes = "hub"
axes = "xyz"
[[rotation]]
part = "disc"
axis = [0, 0, 1]
speed = 5
[[contact]]
name = "inner"
slave = "lining_inner_face"
master = "disc_inner_face"
law = { linear = 2e13 }
friction = 0.5
[[contact]]
name = "outer"
slave = "lining_outer_face"
master = "disc_outer_face"
law = { linear = 2e13 }
friction = 0.5
[[contact]]
name = "pads"
slave = "backplate_inner_back"
master = "backplate_outer_back"
law = { linear = 2e13 }
friction = 0.15
stick = 1e13
[[connector]]
name = "pin"
between = ["backplate_inner_back", "backplate_outer_back"]
stiffness = [1, 1, 1]
[[load]]
on = "backplate_inner_back"
pressure = 1e6
[stability]
band = [0, 6000]
[sweep]
friction = { values = [0, 0.5] }
"#;

fn mesh() -> Mesh {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/pads_on_disc.msh");
    crate::mesh::read(&file, 1e-3).unwrap()
}

fn model(text: &str) -> Model {
    model::parse(text, Path::new("brake.toml")).unwrap()
}

/// All that is said about a model and a mesh.
fn said(text: &str, mesh: &Mesh) -> String {
    let error = model(text).check_against(mesh).expect_err("accepted");
    assert_eq!(error.exit_code(), 2);
    error.to_string()
}

#[track_caller]
fn complains(from: &str, to: &str, expected: &str) {
    assert!(GOOD.contains(from), "{from:?} is not in the file");
    let said = said(&GOOD.replacen(from, to, 1), &mesh());
    assert_eq!(said, format!("brake.toml:{expected}"));
}

const SURFACES: &str = "backplate_inner_back, backplate_outer_back, disc_inner_face, disc_outer_face, hub, \
                        lining_inner_face, lining_outer_face";

#[test]
fn a_good_model_is_accepted_and_its_sliding_pairs_are_found() {
    let (model, mesh) = (model(GOOD), mesh());
    model.check_against(&mesh).unwrap();
    let sliding = |i: usize| model.sliding(&model.contacts[i], &mesh).map(|rotation| rotation.speed);
    assert_eq!([sliding(0), sliding(1), sliding(2)], [Some(5.0), Some(5.0), None]);
    assert_eq!(model.swept_contacts(&mesh), [0, 1]);
    let named = self::model(&GOOD.replace("{ values", "{ contacts = [\"pads\"], values"));
    assert_eq!(named.swept_contacts(&mesh), [2]);
}

#[test]
fn parts_and_physical_volumes_are_the_same() {
    let said = said(&GOOD.replace("[part.lining_inner]", "[part.lining_iner]"), &mesh());
    let lines: Vec<&str> = said.lines().collect();
    let volumes = "disc, lining_inner, backplate_inner, lining_outer, backplate_outer";
    assert_eq!(
        lines,
        [
            format!(
                "brake.toml:11: the mesh has no physical volume (part \"lining_iner\"). \
                 Did you mean \"lining_inner\"? There is: {volumes}"
            ),
            "brake.toml:3: a physical volume of the mesh is no part (volume \"lining_inner\"). \
             Add [part.\"lining_inner\"] with a material"
                .to_owned(),
        ]
    );
    let mut twice = model(GOOD);
    twice.parts.push(twice.parts[0].clone());
    let said = twice.check_against(&mesh()).unwrap_err().to_string();
    assert_eq!(said, "brake.toml:9: the part is there twice (part \"disc\"). Keep one of them");
}

#[test]
fn names_of_surfaces_and_sets_exist() {
    let advice = format!("Did you mean \"hub\"? There is: {SURFACES}");
    complains(
        "nodes = \"hub\"",
        "nodes = \"hubs\"",
        &format!("19: the mesh has no surface or node set \"hubs\" (fix). {advice}"),
    );
    complains(
        "slave = \"lining_inner_face\"",
        "slave = \"lining_inner_fce\"",
        &format!(
            "26: the mesh has no physical surface \"lining_inner_fce\" (contact \"inner\"). \
             Did you mean \"lining_inner_face\"? There is: {SURFACES}"
        ),
    );
    complains(
        "on = \"backplate_inner_back\"",
        "on = \"hup\"",
        &format!("49: the mesh has no physical surface \"hup\" (load \"hup\"). {advice}"),
    );
    complains(
        "between = [\"backplate_inner_back\"",
        "between = [\"hup\"",
        &format!("45: the mesh has no surface or node set \"hup\" (connector \"pin\"). {advice}"),
    );
}

#[test]
fn contacts_and_pressures_act_on_surfaces_and_not_on_node_sets() {
    let mut mesh = mesh();
    mesh.node_sets.insert("rim".to_owned(), vec![1, 2, 3]);
    let text = GOOD.replace("on = \"backplate_inner_back\"\npressure = 1e6", "on = \"rim\"\nforce = [1, 0, 0]");
    model(&text).check_against(&mesh).unwrap();
    let text = GOOD.replace("on = \"backplate_inner_back\"", "on = \"rim\"");
    let said_of = said(&text, &mesh);
    assert!(
        said_of.starts_with("brake.toml:49: \"rim\" is a physical curve or point, not a surface (load \"rim\")"),
        "{said_of}"
    );
    let text = GOOD.replace("master = \"disc_inner_face\"", "master = \"rim\"");
    let said_of = said(&text, &mesh);
    assert!(
        said_of.starts_with("brake.toml:26: \"rim\" is a physical curve or point, not a surface (contact \"inner\")"),
        "{said_of}"
    );
}

#[test]
fn gravity_acts_on_a_part_or_a_mass() {
    let mesh = mesh();
    let load = |on: &str| GOOD.replace("on = \"backplate_inner_back\"\npressure = 1e6", on);
    for on in ["", "on = \"disc\"\n", "[[mass]]\nname = \"bolt\"\nnodes = \"hub\"\nmass = 1\n[[load]]\non = \"bolt\"\n"]
    {
        let text = load(&format!("{on}gravity = [0, 0, -9.81]"));
        let text = text.replace("[[load]]\n[[mass]]", "[[mass]]");
        model(&text).check_against(&mesh).unwrap();
    }
    let said_of = said(&load("on = \"disk\"\ngravity = [0, 0, -9.81]"), &mesh);
    let expected = "brake.toml:49: there is no part or [[mass]] \"disk\" (load \"disk\"). Did you mean \"disc\"?";
    assert!(said_of.starts_with(expected), "{said_of}");
    let mass = "[[mass]]\nname = \"disc\"\nnodes = \"hub\"\nmass = 1\n";
    let text = load("on = \"disc\"\ngravity = [0, 0, -9.81]").replacen("[[load]]", &format!("{mass}[[load]]"), 1);
    let said_of = said(&text, &mesh);
    let expected = "\"disc\" is a part and a [[mass]] (load \"disc\"). Give the mass another name";
    assert!(said_of.contains(expected), "{said_of}");
}

#[test]
fn contact_surfaces_lie_on_one_part_each() {
    let mut mesh = mesh();
    let outer = mesh.surfaces["lining_outer_face"].clone();
    let inner = mesh.surfaces.get_mut("lining_inner_face").unwrap();
    inner.facets.extend(outer.facets);
    inner.parts.extend(outer.parts);
    assert_eq!(mesh.part_of_surface("lining_inner_face"), None);
    assert_eq!(
        said(GOOD, &mesh),
        "brake.toml:26: the surface \"lining_inner_face\" lies on several parts: lining_inner, lining_outer (contact \"inner\"). \
         Make a physical surface for each part, and a contact for each"
    );
    complains(
        "slave = \"lining_inner_face\"",
        "slave = \"disc_outer_face\"",
        "26: slave and master both lie on the part \"disc\" (contact \"inner\"). Name surfaces of two parts",
    );
}

#[test]
fn contact_surfaces_lie_on_the_skin() {
    let mut mesh = mesh();
    mesh.surfaces.get_mut("disc_inner_face").unwrap().inner = vec![3];
    let n_facets = mesh.surfaces["disc_inner_face"].facets.len();
    assert_eq!(
        said(GOOD, &mesh),
        format!(
            "brake.toml:26: 1 of {n_facets} facets of \"disc_inner_face\" lie between two elements, not on the skin \
             (contact \"inner\"). Mesh the two parts apart, without common nodes"
        )
    );
}

#[test]
fn pairs_have_what_their_motion_needs() {
    complains(
        "stick = 1e13\n",
        "",
        "38: the pair does not slide and has friction, but no stick (contact \"pads\"). \
         Add stick in N/m3, such as half the normal stiffness, or set friction = 0",
    );
    complains(
        "friction = 0.5\n",
        "friction = \"rough\"\n",
        "26: the pair slides and is rough (contact \"inner\"). Rough surfaces never slip: give a friction coefficient",
    );
    let without = GOOD.replace("friction = 0.15\nstick = 1e13", "friction = 0");
    model(&without).check_against(&mesh()).unwrap();
    let swept = without.replace("{ values", "{ contacts = [\"pads\"], values");
    assert!(said(&swept, &mesh()).contains("has friction, but no stick (contact \"pads\")"));
    complains(
        "friction = 0.5\n",
        "friction = 0.5\nstick = 1e13\n",
        "26: the pair slides for ever, as its master's part \"disc\" turns and its slave does not (contact \"inner\"). \
         Leave stick out",
    );
}

#[test]
fn the_turning_side_is_the_master() {
    complains(
        "slave = \"lining_inner_face\"\nmaster = \"disc_inner_face\"",
        "slave = \"disc_inner_face\"\nmaster = \"lining_inner_face\"",
        "26: the slave's part \"disc\" turns, but the turning side must be the master (contact \"inner\"). \
         Swap slave and master",
    );
    let both = |rotation: &str| {
        GOOD.replacen("[[contact]]", &format!("[[rotation]]\npart = \"lining_inner\"\n{rotation}\n[[contact]]"), 1)
    };
    let differently = said(&both("axis = [0, 0, 1]\nspeed = 4"), &mesh());
    assert!(
        differently.contains(":30: the parts \"lining_inner\" and \"disc\" turn differently (contact \"inner\")"),
        "{differently}"
    );
    let elsewhere = said(&both("axis = [0, 0, 1]\nthrough = [1, 0, 0]\nspeed = 5"), &mesh());
    assert!(elsewhere.contains("turn differently"), "{elsewhere}");
    // Together, with the axis given the other way round and another of its points: such a pair sticks.
    let together = said(&both("axis = [0, 0, -1]\nthrough = [0, 0, 7]\nspeed = -5"), &mesh());
    assert!(
        together.contains(":31: the pair does not slide and has friction, but no stick (contact \"inner\")"),
        "{together}"
    );
}

#[test]
fn a_sweep_needs_something_that_slides() {
    let still = GOOD.replace("[[rotation]]\npart = \"disc\"\naxis = [0, 0, 1]\nspeed = 5\n", "");
    let said = said(&still.replace("friction = 0.5", "friction = 0"), &mesh());
    assert_eq!(
        said,
        "brake.toml:51: no contact slides, so there is none to sweep (sweep). \
         Name contacts in it, or add a [[rotation]] of the disc"
    );
}

#[test]
fn all_that_is_wrong_is_said_at_once() {
    let text = GOOD.replace("nodes = \"hub\"", "nodes = \"hup\"").replace("stick = 1e13\n", "");
    assert_eq!(said(&text, &mesh()).lines().count(), 2);
}

#[test]
fn joints_name_what_is_in_the_mesh() {
    let mut mesh = mesh();
    mesh.node_sets.insert("tip".to_owned(), vec![4]);
    mesh.node_sets.insert("rim".to_owned(), vec![1, 2, 3]);
    let with = |table: &str| format!("{GOOD}{table}\n");
    let tie = |slave: &str| with(&format!("[[tie]]\nslave = {slave:?}\nmaster = \"backplate_outer_back\""));
    let equation = |node: &str| {
        let term = |node: &str| format!("{{ node = {node:?}, axis = \"x\", coefficient = 1 }}");
        with(&format!("[[equation]]\nterms = [{}, {}]", term("tip"), term(node)))
    };
    let grounded = GOOD.replace("\"backplate_outer_back\"]", "\"ground\"]");
    model(&grounded).check_against(&mesh).unwrap();
    model(&tie("backplate_inner_back")).check_against(&mesh).unwrap();
    for (text, what) in [
        (tie("hup"), "the mesh has no physical surface \"hup\" (tie \"hup / backplate_outer_back\")"),
        (tie("rim"), "\"rim\" is a physical curve or point, not a surface (tie \"rim / backplate_outer_back\")"),
        (with("[[rigid]]\nnodes = \"hup\""), "the mesh has no surface or node set \"hup\" (rigid \"hup\")"),
        (with("[[mass]]\nnodes = \"hup\"\nmass = 1"), "the mesh has no surface or node set \"hup\" (mass \"hup\")"),
        (equation("hup"), "the mesh has no surface or node set \"hup\" (equation \"tip x, hup x\")"),
        (equation("rim"), "\"rim\" has 3 nodes, but a term of an equation is of one (equation \"tip x, rim x\")"),
    ] {
        let said = said(&text, &mesh);
        assert!(said.contains(what), "{said}");
    }
}
