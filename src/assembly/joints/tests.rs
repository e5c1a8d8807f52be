//! Each kind of joint on surfaces without bodies.

use nalgebra::{DMatrix, DVector};

use super::*;
use crate::algebra::{cross, norm, sub};
use crate::assembly;
use crate::contact::search::Alone;
use crate::contact::testing::{flipped, model, patch_of, skin};
use crate::element::samples::{Random, rigid_displacement};
use crate::element::{ElementKind, FacetShape};
use crate::model::{EquationTerm, Load, LoadKind, Material, Part, Rayleigh, RigidSet, Tie};

const STIFFNESS: f64 = 3e17;

/// Two plates of 2 x 1 m with different meshes, the upper one seen from below and bent upwards at its end.
fn plates(shape: FacetShape, gap: f64) -> Mesh {
    let mut nodes = Vec::new();
    let lower = patch_of(shape, &mut nodes, [3, 2], |u, v| [2.0 * u, v, 0.1 * u * u]);
    let upper = patch_of(shape, &mut nodes, [5, 3], |u, v| [2.0 * u, v, 0.1 * u * u + gap * (1.0 + u)]);
    skin(nodes, vec![("lower", "base", lower), ("upper", "plate", flipped(&upper))])
}

fn tie(search_distance: Option<f64>) -> Tie {
    Tie {
        name: "bond".into(),
        slave: "upper".into(),
        master: "lower".into(),
        search_distance,
        stiffness: Some(STIFFNESS),
        place: Place { file: 0, line: 7 },
    }
}

fn joints(model: &Model, mesh: &Mesh) -> Result<Joints> {
    let nodes = Numbering::even(mesh.nodes.len(), 0, 1);
    Joints::new(model, mesh, &nodes, &Sets::new(model, mesh, &nodes)?, &Alone)
}

/// The joints' matrices on all nodes: stiffness and mass.
fn assembled(joints: &Joints, mesh: &Mesh) -> [DMatrix<f64>; 2] {
    let n = 3 * mesh.nodes.len();
    let mut sums = [DMatrix::zeros(n, n), DMatrix::zeros(n, n)];
    let mut own = ElementMatrices::default();
    for e in 0..joints.len() {
        joints.matrices(e, &mut own);
        let dofs: Vec<usize> = joints.nodes(e).iter().flat_map(|&n| [0, 1, 2].map(|i| 3 * n as usize + i)).collect();
        for (sum, matrix) in sums.iter_mut().zip([&own.k, &own.m]).filter(|(_, matrix)| !matrix.is_empty()) {
            for (at, entry) in matrix.iter().enumerate() {
                sum[(dofs[at / dofs.len()], dofs[at % dofs.len()])] += entry;
            }
        }
    }
    sums
}

fn field(mesh: &Mesh, u: impl Fn([f64; 3]) -> [f64; 3]) -> DVector<f64> {
    DVector::from_iterator(3 * mesh.nodes.len(), mesh.nodes.iter().flat_map(|&x| u(x)))
}

/// Whatever rigid motion: the largest force over that of a motion as large that is not rigid.
fn force_of_rigid_motions(k: &DMatrix<f64>, mesh: &Mesh) -> f64 {
    let mut random = Random::seeded(3);
    let (shift, turn, origin) = (random.vector(), random.vector(), random.vector());
    (k * field(mesh, |x| rigid_displacement(shift, turn, origin, x))).amax() / k.amax()
}

#[test]
fn a_tie_does_not_resist_rigid_motions_also_across_a_gap() {
    for (shape, gap) in FacetShape::ALL.into_iter().flat_map(|shape| [(shape, 0.0), (shape, 0.01)]) {
        let mesh = plates(shape, gap);
        let model = Model { ties: vec![tie(None)], ..model(vec![], false) };
        let joints = joints(&model, &mesh).unwrap();
        assert_eq!(joints.ties[0].n_dropped, 0, "{shape:?}");
        let [k, _] = assembled(&joints, &mesh);
        assert_eq!(k, k.transpose());
        let force = force_of_rigid_motions(&k, &mesh);
        assert!(force < 1e-13, "{shape:?} across {gap}: {force:.1e}");
    }
}

#[test]
fn a_uniform_jump_has_the_energy_of_the_area_and_every_motion_of_the_slave_has_some() {
    for shape in FacetShape::ALL {
        let mesh = plates(shape, 0.0);
        let model = Model { ties: vec![tie(None)], ..model(vec![], false) };
        let joints = joints(&model, &mesh).unwrap();
        let [k, _] = assembled(&joints, &mesh);
        let slaves = mesh.node_set("upper").unwrap();
        let jump = [1e-6, -2e-6, 3e-6];
        let mut u = field(&mesh, |_| [0.0; 3]);
        slaves.iter().for_each(|&n| (0..3).for_each(|i| u[3 * n as usize + i] = jump[i]));
        let exact = STIFFNESS * joints.ties[0].area * norm(jump).powi(2);
        assert!((u.dot(&(&k * &u)) / exact - 1.0).abs() < 1e-12, "{shape:?}");
        let dofs: Vec<usize> = slaves.iter().flat_map(|&n| [0, 1, 2].map(|i| 3 * n as usize + i)).collect();
        let of_slave = k.select_rows(&dofs).select_columns(&dofs);
        let least = of_slave.symmetric_eigenvalues().min() / k.amax();
        assert!(least > 1e-3, "{shape:?}: {least:.1e}");
    }
}

#[test]
fn facets_with_a_node_far_from_the_master_are_not_tied_and_that_is_counted() {
    let mut nodes = Vec::new();
    let shape = FacetShape::Quadrilateral4;
    let lower = patch_of(shape, &mut nodes, [2, 1], |u, v| [2.0 * u, v, 0.0]);
    let upper = patch_of(shape, &mut nodes, [4, 1], |u, v| [4.0 * u, v, 0.0]);
    let mesh = skin(nodes, vec![("lower", "base", lower), ("upper", "plate", flipped(&upper))]);
    let tied = |search| joints(&Model { ties: vec![tie(search)], ..model(vec![], false) }, &mesh);
    let of = |search: f64| tied(Some(search)).unwrap().ties[0].clone();
    assert_eq!((of(0.5).n_tied, of(0.5).n_dropped, of(0.5).area), (6, 4, 2.0));
    // At 1 m the nodes of one more column are near, and at 2 m all are.
    assert_eq!((of(1.1).n_tied, of(2.1).n_tied), (8, 10));
    assert!((of(1.1).distance - 1.0).abs() < 1e-12);
}

#[test]
fn a_tie_without_points_names_the_distance() {
    let mesh = plates(FacetShape::Triangle6, 0.5);
    let near = Model { ties: vec![tie(Some(0.1))], ..model(vec![], false) };
    let said = joints(&near, &mesh).unwrap_err().to_string();
    assert!(said.starts_with("brake.toml:7: tie \"bond\": none of the "), "{said}");
    assert!(
        said.contains("points of \"upper\" lies within the search distance 0.1 of \"lower\"; the closest is 0.5"),
        "{said}"
    );
}

fn part(name: &str, young: f64) -> Part {
    let mut elasticity = [[0.0; 6]; 6];
    (0..6).for_each(|i| elasticity[i][i] = young);
    let material = Material { name: name.into(), density: 1.0, elasticity, loss_factor: 0.0, viscoelastic: None };
    Part { name: name.into(), material, rayleigh: Rayleigh::default(), elements: vec![], place: Place::default() }
}

#[test]
fn a_tie_is_ten_thousand_times_as_stiff_as_a_layer_of_the_softer_part() {
    let mesh = plates(FacetShape::Quadrilateral8, 0.0);
    let parts = vec![part("base", 2e11), part("plate", 5e9)];
    let model = Model { ties: vec![Tie { stiffness: None, ..tie(None) }], parts, ..model(vec![], false) };
    let summary = &joints(&model, &mesh).unwrap().ties[0];
    let size = (summary.area / 15.0).sqrt();
    assert!((summary.stiffness / (1e4 * 5e9 / size) - 1.0).abs() < 1e-12);
}

fn rigid(nodes: &str) -> RigidSet {
    RigidSet { name: "stiff".into(), nodes: nodes.into(), place: Place { file: 0, line: 3 } }
}

#[test]
fn a_rigid_set_has_rows_of_four_nodes_and_no_rigid_motion_moves_them() {
    let mesh = plates(FacetShape::Triangle6, 0.1);
    let parts = vec![part("base", 1.0), part("plate", 1.0)];
    let model = Model { rigid_sets: vec![rigid("upper")], parts, ..model(vec![], false) };
    let mut joints = joints(&model, &mesh).unwrap();
    let n = mesh.node_set("upper").unwrap().len();
    assert_eq!(joints.elements.len(), 1 + n - 3);
    assert!(joints.elements[1..].iter().all(|element| element.nodes.len() == 4 && element.rows.len() == 3));
    // Surfaces without elements have no stiffness beside them.
    joints.elements.iter_mut().for_each(|element| element.stiffness.fill(1.0));
    let [k, _] = assembled(&joints, &mesh);
    assert!(force_of_rigid_motions(&k, &mesh) < 1e-13);
    let eigenvalues = k.symmetric_eigenvalues();
    let n_stiff = eigenvalues.iter().filter(|e| **e > 1e-6).count();
    assert_eq!(n_stiff, 3 * n - 6);
}

#[test]
fn the_base_of_a_rigid_set_is_wide_and_does_not_depend_on_the_order_of_nodes() {
    let x: Vec<[f64; 3]> = (0..25).map(|n| [f64::from(n % 5), f64::from(n / 5), 0.0]).collect();
    let nodes: Vec<u32> = (0..25).collect();
    let base = |order: &[u32]| {
        let x: Vec<[f64; 3]> = order.iter().map(|&n| x[n as usize]).collect();
        rigid::base(&nodes, &x, order).unwrap().map(|n| order[n as usize])
    };
    assert_eq!(base(&nodes), [0, 24, 4]);
    let turned: Vec<u32> = (0..25).map(|n| (7 * n + 3) % 25).collect();
    assert_eq!(base(&turned), [0, 24, 4]);
}

#[test]
fn a_rigid_set_on_a_line_is_refused() {
    let mut mesh = plates(FacetShape::Quadrilateral4, 0.1);
    let edge =
        (0..mesh.nodes.len() as u32).filter(|&n| mesh.nodes[n as usize][0] == 0.0 && mesh.nodes[n as usize][2] == 0.0);
    mesh.node_sets.insert("edge".into(), edge.collect());
    for set in ["edge", "corner"] {
        mesh.node_sets.entry("corner".into()).or_insert(vec![0]);
        let model = Model { rigid_sets: vec![rigid(set)], ..model(vec![], false) };
        let said = joints(&model, &mesh).unwrap_err().to_string();
        assert!(said.starts_with("brake.toml:3: rigid \"stiff\": its nodes lie on a line"), "{said}");
    }
}

#[test]
fn whatever_acts_on_a_rigid_set_acts_on_its_base() {
    let mut mesh = plates(FacetShape::Triangle6, 0.1);
    let nodes = mesh.node_set("upper").unwrap();
    mesh.node_sets.insert("some".into(), nodes[4..12].to_vec());
    mesh.node_sets.insert("others".into(), vec![0, 1, 2, nodes[0]]);
    let model = Model { rigid_sets: vec![rigid("upper")], ..model(vec![], false) };
    let sets = Sets::new(&model, &mesh, &Numbering::even(mesh.nodes.len(), 0, 1)).unwrap();
    let of = |name: &str| sets.motion(name, None).unwrap().nodes;
    assert_eq!((of("upper"), of("some")), (sets.rigid_sets[0].base.to_vec(), sets.rigid_sets[0].base.to_vec()));
    assert_eq!(of("others").len(), 4);
    assert!(of("lower").len() > 3);
}

#[test]
fn a_point_mass_has_its_mass_and_inertia_about_its_point() {
    let mesh = plates(FacetShape::Quadrilateral8, 0.1);
    let (kilograms, at, inertia) = (2.5, [0.3, -0.7, 1.1], [0.4, 0.5, 0.6, 0.1, -0.05, 0.02]);
    let own = PointMass {
        name: "m".into(),
        nodes: "upper".into(),
        at: Some(at),
        mass: kilograms,
        inertia,
        place: Place::default(),
    };
    let model = Model { masses: vec![own], ..model(vec![], false) };
    let joints = joints(&model, &mesh).unwrap();
    assert!(joints.mass_couples_axes());
    let [k, m] = assembled(&joints, &mesh);
    assert_eq!(k.amax(), 0.0);
    let mut random = Random::seeded(9);
    for _ in 0..5 {
        let (shift, turn) = (random.vector(), random.vector());
        let u = field(&mesh, |x| rigid_displacement(shift, turn, at, x));
        let [x, y, z] = turn;
        let [xx, yy, zz, xy, yz, zx] = inertia;
        let rotation = xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + yz * y * z + zx * z * x);
        let exact = kilograms * norm(shift).powi(2) + rotation;
        assert!((u.dot(&(&m * &u)) / exact - 1.0).abs() < 1e-11);
    }
}

#[test]
fn a_force_at_a_point_has_its_resultant_and_moment() {
    let mesh = plates(FacetShape::Triangle6, 0.1);
    let (force, moment, at) = ([1.0, -2.0, 3.0], [0.5, 0.25, -4.0], [3.0, 2.0, 1.0]);
    for rigid_sets in [vec![], vec![rigid("upper")]] {
        let kind = LoadKind::ForceAt { force, moment, at: Some(at) };
        let load = Load { name: "pull".into(), on: "upper".into(), kind, place: Place::default() };
        let model = Model { loads: vec![load], rigid_sets, ..model(vec![], false) };
        let sets = Sets::new(&model, &mesh, &Numbering::even(mesh.nodes.len(), 0, 1)).unwrap();
        let (mut sum, mut turning) = ([0.0; 3], [0.0; 3]);
        for (node, f) in assembly::loads(&model, &mesh, &sets).unwrap() {
            let lever = cross(sub(mesh.nodes[node as usize], at), f);
            (0..3).for_each(|i| (sum[i], turning[i]) = (sum[i] + f[i], turning[i] + lever[i]));
        }
        assert!(norm(sub(sum, force)) < 1e-12 && norm(sub(turning, moment)) < 1e-12, "{sum:?} {turning:?}");
    }
}

fn spring(between: [&str; 2]) -> Connector {
    Connector {
        name: "spring".into(),
        between: between.map(str::to_owned),
        at: None,
        axes: None,
        stiffness: [2.0, 3.0, 5.0],
        rotational_stiffness: [0.0; 3],
        damping: [0.0; 3],
        loss_factor: 0.0,
        place: Place::default(),
    }
}

#[test]
fn a_connector_to_the_ground_resists_the_motion_of_its_set_alone() {
    let mut mesh = plates(FacetShape::Triangle3, 0.1);
    let of = |mesh: &Mesh, between| {
        let model = Model { connectors: vec![spring(between)], ..model(vec![], false) };
        let joints = joints(&model, mesh).unwrap();
        let [k, _] = assembled(&joints, mesh);
        let u = field(mesh, |_| [1.0, 0.0, 0.0]);
        u.dot(&(&k * &u))
    };
    for between in [["upper", "ground"], ["ground", "upper"]] {
        assert!((of(&mesh, between) - 2.0).abs() < 1e-13);
    }
    // A node set of this name comes first, and moves along.
    mesh.node_sets.insert("ground".into(), mesh.node_set("lower").unwrap());
    assert!(of(&mesh, ["upper", "ground"]).abs() < 1e-13);
}

/// Constants are along and about the connector's axes: a motion along its second axis has the second stiffness.
#[test]
fn a_connector_acts_along_its_axes() {
    let mesh = plates(FacetShape::Triangle3, 0.1);
    let axes = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];
    let own = Connector { axes: Some(axes), rotational_stiffness: [7.0, 0.0, 0.0], ..spring(["upper", "ground"]) };
    let joints = joints(&Model { connectors: vec![own], ..model(vec![], false) }, &mesh).unwrap();
    let [k, _] = assembled(&joints, &mesh);
    let energy = |u: &DVector<f64>| u.dot(&(&k * u));
    for (axis, stiffness) in axes.into_iter().zip([2.0, 3.0, 5.0]) {
        assert!((energy(&field(&mesh, |_| axis)) - stiffness).abs() < 1e-12);
    }
    let centre = Sets::new(&model(vec![], false), &mesh, &Numbering::even(mesh.nodes.len(), 0, 1))
        .unwrap()
        .centroid("upper")
        .unwrap();
    let about = |axis: [f64; 3]| energy(&field(&mesh, |x| cross(axis, sub(x, centre))));
    assert!((about(axes[0]) - 7.0).abs() < 1e-10 && about(axes[1]).abs() < 1e-10);
}

#[test]
fn an_equation_has_a_row_of_length_one() {
    let mut mesh = plates(FacetShape::Triangle3, 0.1);
    mesh.node_sets.extend([("a".to_owned(), vec![3]), ("b".to_owned(), vec![8])]);
    let term = |node: &str, axis, coefficient| EquationTerm { node: node.into(), axis, coefficient };
    let terms = vec![term("a", 0, 3.0), term("b", 2, -4.0)];
    let equations = vec![Equation { name: "e".into(), terms, place: Place::default() }];
    let parts = vec![part("base", 1.0), part("plate", 1.0)];
    let joints = joints(&Model { equations, parts, ..model(vec![], false) }, &mesh).unwrap();
    assert_eq!(joints.elements[0].nodes, [3, 8]);
    assert_eq!(joints.elements[0].rows, [[0.6, 0.0, 0.0, 0.0, 0.0, -0.8]]);
    assert_eq!(joints.names, [(JointKind::Equation, "e".to_owned())]);
}

#[test]
fn neighbours_are_the_stiffest_and_largest_elements_beside_a_node() {
    let (model, mesh) = tetrahedra();
    let numbering = Numbering::whole(6, 0..4);
    let neighbours = Neighbours::new(&model, &mesh, &numbering, [0, 3, 4].into_iter(), &Alone).unwrap();
    let of = |node| (neighbours.around(&[node]).young, neighbours.around(&[node]).size);
    assert!((of(0).0 / 2e11 - 1.0).abs() < 1e-12 && of(0).1 == 3.0);
    assert!((of(3).0 / 2e11 - 1.0).abs() < 1e-12 && of(3).1 == 10.0_f64.sqrt());
    // Another rank has that node.
    assert_eq!(of(4), (0.0, 0.0));
    let both = neighbours.around(&[0, 3]);
    assert!((both.young / 2e11 - 1.0).abs() < 1e-12 && both.size == 10.0_f64.sqrt());
}

/// A tetrahedron of 2e11 Pa along x and z and 1e8 Pa along y on one of 1e9 Pa.
fn tetrahedra() -> (Model, Mesh) {
    let mut nodes = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -2.0]];
    nodes.push([9.0; 3]);
    let mut mesh = Mesh { nodes, parts: vec!["hard".into(), "soft".into()], ..Mesh::default() };
    mesh.elements.push(ElementKind::C3D4, 0, &[0, 1, 2, 3]);
    mesh.elements.push(ElementKind::C3D4, 1, &[0, 2, 1, 4]);
    let mut parts = vec![part("hard", 2e11), part("soft", 1e9)];
    parts[0].material.elasticity[1][1] = 1e8;
    (Model { parts, ..model(vec![], false) }, mesh)
}

/// The penalties of the elements of a model's joints are these, element by element.
#[track_caller]
fn assert_penalties(model: &Model, mesh: &Mesh, expected: &[f64]) {
    let joints = joints(model, mesh).unwrap();
    assert_eq!(joints.elements.len(), expected.len());
    for (element, expected) in joints.elements.iter().zip(expected) {
        assert!(!element.stiffness.is_empty());
        assert!(element.stiffness.iter().all(|k| (k / expected - 1.0).abs() < 1e-12), "{:?}", element.stiffness);
    }
}

#[test]
fn penalties_are_1e4_times_the_stiffness_of_the_stiffest_and_largest_elements() {
    let (mut model, mut mesh) = tetrahedra();
    // Both elements are beside the set: E of the hard one, h = |x_4 - x_1| of the soft one; L = |x_4 - x_3|.
    let (young, size, length) = (2e11, 13.0_f64.sqrt(), 3.0);
    mesh.node_sets.insert("side".into(), vec![0, 2, 3, 4]);
    model.rigid_sets = vec![rigid("side")];
    assert_penalties(&model, &mesh, &[1e4 * young * length, 1e4 * young * size]);
    model.rigid_sets.clear();
    // Node 0 is a corner of both elements, node 4 of the soft one.
    mesh.node_sets.extend([("a".to_owned(), vec![0]), ("b".to_owned(), vec![4])]);
    let terms = ["a", "b"].map(|node| EquationTerm { node: node.into(), axis: 0, coefficient: 2.0 });
    model.equations = vec![Equation { name: "e".into(), terms: terms.into(), place: Place::default() }];
    assert_penalties(&model, &mesh, &[1e4 * young * size]);
}

#[test]
fn a_set_of_one_node_takes_forces_on_their_line_and_no_moments() {
    let mut mesh = plates(FacetShape::Triangle3, 0.1);
    mesh.node_sets.insert("tip".into(), vec![2]);
    let tip = mesh.nodes[2];
    let sets = Sets::new(&model(vec![], false), &mesh, &Numbering::even(mesh.nodes.len(), 0, 1)).unwrap();
    let along_x = [true, false, false, false, false, false];
    let about_x = [false, false, false, true, false, false];
    let said = |at: [f64; 3], acting| sets.motion("tip", Some(at)).unwrap().require("tip", acting).err();
    let ahead = [tip[0] + 5.0, tip[1], tip[2]];
    let above = [tip[0], tip[1], tip[2] + 0.1];
    assert_eq!((said(tip, along_x), said(ahead, along_x)), (None, None));
    assert!(said(above, along_x).unwrap().starts_with("\"tip\" is one node, and the force does not pass through it"));
    assert!(said(tip, about_x).unwrap().starts_with("\"tip\" is one node, which does not rotate"));
    let of = |mesh: &Mesh, mass: f64, inertia| {
        let own = PointMass { name: "m".into(), nodes: "tip".into(), at: None, mass, inertia, place: Place::default() };
        joints(&Model { masses: vec![own], ..model(vec![], false) }, mesh)
    };
    let [_, m] = assembled(&of(&mesh, 2.5, [0.0; 6]).unwrap(), &mesh);
    assert_eq!((m[(6, 6)], m[(7, 7)], m[(8, 8)], m.sum()), (2.5, 2.5, 2.5, 7.5));
    assert!(of(&mesh, 0.0, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).is_err());
}
