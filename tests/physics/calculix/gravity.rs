//! A deck with gravity, as the program writes it, in ccx: two bodies and a mass of a node.

use super::references::{Reference, compute, model, reference};
use super::run;
use crate::support::block::Block;
use crate::support::brake;
use squeal::deck::{self, KnownUnits};
use squeal::element::ElementKind;
use squeal::mesh::Mesh;
use squeal::model::UnitSystem;
use squeal::native::Session;

const MODEL: &str = r#"
[material.steel]
young = 210e9
poisson = 0.3
density = 7800
[part.rod]
material = "steel"
[part.pad]
material = "steel"
[[fix]]
nodes = "rod_z0"
axes = "xyz"
[[fix]]
nodes = "pad_x0"
axes = "xyz"
[[load]]
gravity = [3, 0, -9.81]
[[load]]
name = "more"
on = "pad"
gravity = [0, 100, 0]
[stability]
band = [0, 1000]
"#;

/// Displacements to 1e-5, ccx prints seven digits.
#[test]
fn calculix_finds_the_displacements_under_gravity() {
    let mut mesh = Mesh::default();
    let rod = |s: [f64; 3]| [0.01 * s[0], 0.02 * s[1] + 0.01 * s[2], 0.1 * s[2]];
    Block { part: "rod", cells: [1, 2, 3], wraps: false, map: &rod }.add_solids_to(&mut mesh, ElementKind::C3D20);
    let pad = |s: [f64; 3]| [0.1 + 0.05 * s[0], 0.02 * s[1], 0.01 * s[2] + 0.01 * s[0]];
    Block { part: "pad", cells: [3, 1, 1], wraps: false, map: &pad }.add_solids_to(&mut mesh, ElementKind::C3D10);
    let own = brake(MODEL, mesh);
    let (n, mut text) = (own.mesh.nodes.len(), Vec::new());
    deck::write(&own.model, &own.mesh, UnitSystem::named("mm-t-s").unwrap(), "a test", &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    let (statics, _) = text.split_once("*END STEP").unwrap();
    let mass = "*ELEMENT,TYPE=MASS,ELSET=BOLT\n9001,20\n*MASS,ELSET=BOLT\n2e-4\n*STEP";
    let all = format!("*NSET,NSET=ALL,GENERATE\n1,{n}\n{mass}");
    let text =
        statics.replacen("*STEP", &all, 1) + "*DLOAD\nBOLT,GRAV,1e5,1.,1.,0.\n*NODE PRINT,NSET=ALL\nU\n*END STEP\n";

    let folder = run(&text);
    let theirs = std::fs::read_to_string(folder.path().join("deck.dat")).unwrap();
    let theirs = reference(&theirs).unwrap();
    assert!(matches!(&theirs, Reference::Displacements(all) if all.len() == n));
    let parsed = deck::parse(&folder.path().join("deck.inp")).unwrap();
    let read = model(deck::convert::convert(&parsed, KnownUnits::default()).unwrap()).unwrap();
    assert_eq!(read.model.loads.len(), 3, "{:?}", read.model.loads);
    let comm = Session::start(&[]).unwrap();
    let ours = compute(&comm, &parsed, &read, &theirs, false).unwrap();
    // In metres and millimetres.
    let Reference::Displacements(ours) = ours else { panic!() };
    let ours = Reference::Displacements(ours.into_iter().map(|(node, u)| (node, u.map(|u| 1e3 * u))).collect());
    let difference = ours.difference(&theirs);
    println!("{difference:.1e}");
    assert!(difference < 1e-5, "{difference}");
}
