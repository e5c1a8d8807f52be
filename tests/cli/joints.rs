//! Ties, rigid sets, masses, equations, forces at points and springs to the ground through the program.

use super::parallel::{assert_same_contact, assert_same_modes, stability};
use crate::support::block::Block;
use crate::support::gmsh::gmsh;
use crate::support::nodes_where;
use crate::support::program::{Place, assert_refused, swap};
use squeal::mesh::Mesh;

/// A pad on a disc, and a plate of another mesh tied to the pad.
const MODEL: &str = r#"
title = "joints"
[mesh]
file = "joints.msh"
unit = "mm"
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
[part.plate]
material = "iron"
[[fix]]
nodes = "disc_z0"
axes = "xyz"
[[rotation]]
part = "disc"
axis = [0, 0, 1]
through = [-100, 10, 0]
speed = 5.0
[[contact]]
slave = "pad_z0"
master = "disc_z1"
law = { linear = 2e13 }
friction = 0.4
[[tie]]
name = "bond"
slave = "plate_z0"
master = "pad_z1"
[[rigid]]
name = "stiff"
nodes = "plate_z1"
[[mass]]
name = "caliper"
nodes = "plate_z1"
mass = 0.2
at = [15, 15, 40]
inertia = [2e-5, 3e-5, 4e-5, 1e-6, 0, 0]
[[connector]]
name = "bush"
between = ["plate_z1", "ground"]
stiffness = [2e8, 1e8, 1e5]
rotational_stiffness = [1e3, 1e3, 1e3]
damping = [30, 30, 30]
[[equation]]
name = "opposite"
terms = [{ node = "left", axis = "y", coefficient = 1 }, { node = "right", axis = "y", coefficient = -2 }]
[[load]]
name = "push"
on = "plate_z1"
force = [0, 0, -1000]
moment = [0.5, 0, 0.2]
at = [14, 15, 40]
[stability]
band = [0, 20000]
"#;

fn mesh() -> Mesh {
    let mut mesh = Mesh::default();
    let mut add = |part: &str, cells: [usize; 3], corner: [f64; 3], size: [f64; 3]| {
        let map = |s: [f64; 3]| [0, 1, 2].map(|i| corner[i] + size[i] * s[i]);
        Block { part, cells, wraps: false, map: &map }.add_to(&mut mesh);
    };
    add("disc", [3, 3, 1], [0.0, 0.0, 0.0], [30.0, 30.0, 10.0]);
    add("pad", [2, 2, 1], [5.0, 5.0, 10.0], [20.0, 20.0, 8.0]);
    add("plate", [3, 3, 1], [5.0, 5.0, 18.0], [20.0, 20.0, 5.0]);
    let at = |point: [f64; 3]| nodes_where(&mesh, |x| x == point);
    let sets = [("left", at([5.0, 15.0, 14.0])), ("right", at([25.0, 15.0, 14.0]))];
    mesh.node_sets = sets.map(|(name, nodes)| (name.to_owned(), nodes)).into();
    mesh
}

fn place(text: &str) -> Place {
    let place = Place::empty();
    place.write("brake.toml", text);
    place.write("joints.msh", gmsh(&mesh()));
    place
}

/// Modes to 1e-9; forces at contact points to 1e-8, as penalties cost digits.
#[test]
fn two_ranks_find_what_one_finds() {
    let place = place(MODEL);
    let alone = stability(&place, "0:20000", 1);
    assert!(alone.0.len() > 4, "{:?}", alone.0);
    let explained = place.read("run/explained.csv");
    for source in ["tie,bond", "rigid,stiff", "mass,caliper", "connector,bush", "equation,opposite"] {
        assert!(explained.contains(source), "{source} is not in {explained}");
    }
    let two = stability(&place, "0:20000", 2);
    assert_same_modes(&alone.0, &two.0);
    assert_same_contact(&alone.1, &two.1, 1e-8);
    let shares = |table: &str| -> Vec<f64> {
        let of_row =
            |row: &str| row.split(',').skip(5).take(2).map(|share| share.parse().unwrap()).collect::<Vec<f64>>();
        table.lines().skip(1).flat_map(of_row).collect()
    };
    let (one, two) = (shares(&explained), shares(&place.read("run/explained.csv")));
    assert!(one.len() == 18 && one.len() == two.len());
    assert!((one.iter().sum::<f64>() - 2.0).abs() < 1e-9, "kinetic and strain energies add up to 1 each");
    one.iter().zip(two).for_each(|(one, two)| assert!((one - two).abs() < 1e-7, "{one} on one rank, {two} on two"));
}

#[test]
fn check_lists_joints_and_the_mass_of_all_on_any_number_of_ranks() {
    let place = place(MODEL);
    let [one, two] = [place.run(&["check", "brake.toml"]), place.run_on(2, &["check", "brake.toml"])];
    assert_eq!(one.code, 0, "{}", one.err);
    let before_the_dofs =
        |out: &str| out.lines().take_while(|line| !line.contains("free dofs")).collect::<Vec<_>>().join("\n");
    assert_eq!(before_the_dofs(&two.out), before_the_dofs(&one.out));
    for line in [
        "tie \"bond\": 49 nodes on 400.00 mm2 tied, 0 not; ",
        "rigid \"stiff\": 49 nodes",
        "1 equations",
        "mass \"caliper\" on plate_z1: 0.2000 kg",
        // 9 cm3 and 2 cm3 of iron, 3.2 cm3 of lining
        "mass of parts and point masses: 0.2864 kg",
        "load \"push\" on plate_z1: 0 0 -1000 N and 0.5 0 0.2 N m at a point",
    ] {
        assert!(one.out.contains(line), "{line:?} is not in {}", one.out);
    }
}

/// Loads and supports balance also where springs to the ground and equations are supports.
#[test]
fn statics_balance() {
    let finished = place(MODEL).run(&["static", "brake.toml", "--friction", "0.4"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let line = finished.out.lines().find(|line| line.contains("loads and supports balance")).unwrap();
    let force: f64 = line.split_whitespace().nth(5).unwrap().parse().unwrap();
    assert!(force < 1e-5, "{line}");
}

#[test]
fn joints_that_cannot_be_are_refused() {
    let refused = |old: &str, new: &str, said: &str| {
        assert_refused(&place(&swap(MODEL, old, new)).run(&["check", "brake.toml"]), &["brake.toml:", said]);
    };
    refused("master = \"pad_z1\"", "master = \"disc_z0\"", "tie \"bond\": no facet of \"disc_z0\" faces \"plate_z0\"");
    refused("master = \"pad_z1\"", "master = \"plate_z0\"", "slave and master are both \"plate_z0\" (tie \"bond\")");
    refused("inertia = [2e-5", "inertia = [-2e-5", "inertia has a negative principal moment");
    refused("mass = 0.2", "mass = -0.2", "mass must be 0 or above");
    refused("nodes = \"plate_z1\"\n[[mass]]", "nodes = \"left\"\n[[mass]]", "rigid \"stiff\": its nodes lie on a line");
    refused("node = \"left\"", "node = \"pad_z1\"", "\"pad_z1\" has 25 nodes, but a term of an equation is of one");
}
