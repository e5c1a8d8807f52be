//! Every message of the model file: a good file with one thing wrong, and what is said about it.

mod analysis;
mod joints;
mod keys;
mod materials;
mod pairs;
pub mod schema;

use super::*;
use std::path::Path;

const GOOD: &str = r#"
[mesh]
file = "brake.msh"
unit = "mm"
[material.iron]
young = 110e9
poisson = 0.27
density = 7100
[material.lining]
kind = "transverse"
axis = [0, 0, 2]
young = 9e9
young_axial = 1.5e9
poisson = 0.25
poisson_axial = 0.10
shear_axial = 2.0e9
density = 2600
[part.disc]
material = "iron"
rayleigh = { alpha = 10, beta = 1e-8 }
[part.a_pad]
material = "lining"
[[fix]]
nodes = "hub"
axes = "zx"
[[rotation]]
part = "disc"
axis = [0, 3, 4]
through = [1, 2, 3]
speed = -5
[[contact]]
name = "pair"
slave = "pad_face"
master = "disc_face"
law = { linear = 2e13 }
friction = 0.5
search = 2
[[connector]]
between = ["pin", "hole"]
stiffness = [1, 2, 3]
at = [10, 0, 0]
[[load]]
on = "back"
force = [0, 0, 4000]
[stability]
band = [0, 6000]
[sweep]
friction = { contacts = ["pair"], from = 0.1, to = 0.9, step = 0.1 }
"#;

fn parsed(text: &str) -> Result<Model, String> {
    parse(text, Path::new("cases/brake.toml")).map_err(|error| {
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    })
}

/// What is said about the good file with `from` replaced by `to`; its line is that of `from`, `below` lines down.
#[track_caller]
fn complains(from: &str, to: &str, below: usize, expected: &str) {
    assert_eq!(GOOD.matches(from).count(), 1, "{from:?} is not one place");
    let line = 1 + GOOD[..GOOD.find(from).unwrap()].matches('\n').count() + below;
    let message = parsed(&GOOD.replace(from, to)).expect_err("accepted");
    assert_eq!(message, format!("cases/brake.toml:{line}: {expected}"));
}

#[test]
fn the_documented_example_parses_and_uses_every_kind() {
    let model = parse(EXAMPLE, Path::new("brake.toml")).unwrap();
    assert_eq!(model.title, "floating-caliper brake");
    assert_eq!(model.parts.len(), 9);
    assert_eq!(model.frictions, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]);
    assert_eq!(model.swept, ["disc / inner pad", "disc / outer pad"]);
    let reduction = model.reduction.unwrap();
    assert_eq!((reduction.contacts, reduction.band), (104, [0.0, 12_000.0]));
    assert_eq!(model.contacts[1].law, Some(NormalLaw::Cubic { k1: 2e13, k3: 1e22 }));
    assert_eq!(model.contacts[2].law, None);
    assert_eq!(model.loads[1].kind, LoadKind::Pressure(4e6));
    let at = [-90.0, 60.0, 25.0].map(|x: f64| x * 1e-3);
    assert_eq!(
        model.loads[2].kind,
        LoadKind::ForceAt { force: [0.0, 200.0, 0.0], moment: [0.0, 0.0, 1.5], at: Some(at) }
    );
    // The shim's x axis lies along the mesh's y.
    let shim = model.parts.iter().find(|part| part.name == "shim_outer").unwrap();
    let elasticity = shim.material.elasticity;
    assert!(elasticity[1][1] > 1.2 * elasticity[0][0]);
}

#[test]
fn values_come_in_si_units_and_parts_in_the_order_of_the_file() {
    let model = parsed(GOOD).unwrap();
    assert_eq!(model.title, "brake");
    assert_eq!(model.mesh_file, Path::new("cases/brake.msh"));
    assert_eq!((model.mesh_unit, model.mesh_place.line), (1e-3, 3));
    let names: Vec<&str> = model.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["disc", "a_pad"]);
    assert_eq!(model.parts[0].rayleigh, Rayleigh { alpha: 10.0, beta: 1e-8 });
    assert_eq!(model.parts[1].rayleigh, Rayleigh::default());
    assert_eq!(model.fixes[0].axes, [true, false, true]);
    assert_eq!(model.rotations[0].through, [1e-3, 2e-3, 3e-3]);
    let axis = model.rotations[0].axis;
    assert!((axis[1] - 0.6).abs() < 1e-15 && (axis[2] - 0.8).abs() < 1e-15);
    assert_eq!(model.contacts[0].search_distance, Some(2e-3));
    assert!(model.contacts[0].separation);
    assert_eq!(model.connectors[0].name, "pin / hole");
    assert_eq!(model.connectors[0].at, Some([1e-2, 0.0, 0.0]));
    assert_eq!(model.loads[0].name, "back");
    assert_eq!(model.loads[0].kind, LoadKind::ForceByNode([0.0, 0.0, 4000.0]));
    assert_eq!((model.sweep_place.line, model.reduction), (48, None));
}

#[test]
fn a_part_alone_has_nothing_to_sweep() {
    let model = parsed(GOOD).unwrap();
    assert!(!model.frictions.is_empty() && model.sweep_place.line > 0);
    let part = model.only("disc").unwrap();
    assert_eq!((part.parts.len(), part.contacts.len(), part.loads.len()), (1, 0, 0));
    assert!(part.swept.is_empty() && part.frictions.is_empty());
    assert_eq!(part.sweep_place.line, 0);
}

#[test]
fn a_missing_file_is_the_users_mistake() {
    let error = read(Path::new("no/such.toml")).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().starts_with("no/such.toml: cannot read the model file: "));
}
