//! Wear of super-elements against that of the models that they reduce: a pad that a piston presses on a sliding disc.
//!
//! Goal: gaps and pressures after three steps to 1e-8 of the largest, with all fixed-interface modes kept, and in a
//! basis of all displacements.

use crate::support::{brake, pressed_pad};
use squeal::Structure;
use squeal::analysis::{Sweep, WearGoal, WearOptions, wear};
use squeal::native::{Block, Comm, Session};
use squeal::reduction::file;
use squeal::reduction::recovery::OuterSurface;
use squeal::reduction::super_element::{Sample, SuperElement};
use squeal::results::Wear;
use squeal::structure::{FullModel, StructureOptions};
use tempfile::TempDir;

const FRICTION: f64 = 0.1;

const PARTS: &str = r#"
[material.iron]
young = 110e9
poisson = 0.27
density = 7100
[material.lining]
young = 9e9
poisson = 0.25
density = 2600
[part.disc]
material = "iron"
[part.pad]
material = "lining"
[part.piston]
material = "iron"
[[tie]]
slave = "piston_z0"
master = "pad_z1"
[[fix]]
nodes = "piston_z1"
axes = "xy"
[stability]
band = [0, 42000]
"#;

/// The brake, its mesh file a place of the folder.
fn model(folder: &TempDir) -> FullModel {
    let sliding = pressed_pad::SLIDING.replace("friction = 0.4\n", "friction = 0.4\nwear = 1e-13\n");
    let mut brake = brake(&(sliding + PARTS), pressed_pad::mesh([2, 2, 1]));
    brake.model.mesh_file = folder.path().join("pad.msh");
    std::fs::write(&brake.model.mesh_file, "").unwrap();
    brake
}

/// A super-element as its file has it.
fn read(comm: &Comm, folder: &TempDir, (element, surface): (SuperElement, OuterSurface)) -> Structure {
    let path = folder.path().join("pad.se.h5");
    file::write(&path, &element, &surface, None).unwrap();
    Structure::read(comm, &path, &StructureOptions::default()).unwrap()
}

/// The super-element of a model at [`FRICTION`] with all fixed-interface modes.
fn reduced(comm: &Comm, folder: &TempDir, model: &FullModel) -> Structure {
    let system = model.assemble(comm, &model.families().unwrap()).unwrap();
    let mut sweep = Sweep::new(&system, &model.interface, false).unwrap();
    let equilibrium = sweep.equilibrium(FRICTION, &mut ()).unwrap();
    let (element, surface, _) = model.reduce(comm, &system, &equilibrium, f64::INFINITY, &mut |_| ()).unwrap();
    read(comm, folder, (element, surface))
}

/// The Galerkin super-element of a model in a basis of all displacements.
fn projected(comm: &Comm, folder: &TempDir, model: &FullModel) -> Structure {
    let system = model.assemble(comm, &model.families().unwrap()).unwrap();
    let n = system.dofs.n_global();
    let unit = (0..n * n).map(|i| if i % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
    let basis = Block::from_columns(comm, n, unit);
    read(comm, folder, model.project(comm, &system, &basis, &[Sample::at(FRICTION)], 42e3).unwrap())
}

/// Three steps over so long a distance that the wear is like the penetration.
fn worn(comm: &Comm, structure: &mut Structure) -> Wear {
    let goal = WearGoal::Distance { distance: 2.0, n_steps: 3 };
    let worn = wear(comm, structure, &WearOptions { friction: Some(FRICTION), goal, output: None }, &mut ()).unwrap();
    let [first, last] = [0, 3].map(|step: usize| &worn.steps[step].pairs[0]);
    println!("spread of p v from {:.3} to {:.3}, depth {:.1e} m", first.spread, last.spread, last.depth);
    assert!((last.spread - first.spread).abs() > 1e-3 * first.spread && last.depth > 1e-7, "wear counts");
    assert!((last.volume / last.archard_volume - 1.0).abs() < 1e-12, "mass balance");
    worn
}

#[track_caller]
fn assert_same(found: &Wear, expected: &Wear) {
    assert!(found.points.len() == expected.points.len() && found.steps.len() == expected.steps.len());
    for (what, of) in [
        ("depth", (|point| point.wear_m) as fn(&squeal::results::WornPoint) -> f64),
        ("pressure", |point| point.pressure_pa),
        ("pressure before", |point| point.pressure_before_pa),
        ("place", |point| point.x_m),
    ] {
        let [found, expected] = [found, expected].map(|wear| wear.points.iter().map(of).collect::<Vec<f64>>());
        let largest = expected.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
        println!("{what} off by {error:.1e}");
        assert!(error < 1e-8, "{what}: {error}");
    }
    let mass = |wear: &Wear| wear.steps[3].pairs[0].mass;
    assert!((mass(found) / mass(expected) - 1.0).abs() < 1e-8 && mass(found) > 0.0);
}

#[test]
fn a_super_element_with_all_modes_wears_as_the_layout_that_it_reduces() {
    let (comm, folder) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let mut layout = model(&folder);
    layout.reduce_contacts(4).unwrap();
    let mut element = reduced(&comm, &folder, &layout);
    let expected = worn(&comm, &mut Structure::Full(Box::new(layout)));
    assert_same(&worn(&comm, &mut element), &expected);
}

#[test]
fn a_galerkin_super_element_of_all_displacements_wears_as_its_model() {
    let (comm, folder) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let full = model(&folder);
    let mut element = projected(&comm, &folder, &full);
    let expected = worn(&comm, &mut Structure::Full(Box::new(full)));
    assert_same(&worn(&comm, &mut element), &expected);
}
