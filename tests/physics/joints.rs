//! Ties, rigid sets, point masses, equations and forces at points in models that are solved.
//!
//! Blocks of steel, 20 mm wide, stand on one another. In brackets: what was measured.

use std::f64::consts::TAU;

use crate::support::block::Block;
use crate::support::{assert_close, brake, nodes_where};
use squeal::assembly::System;
use squeal::element::ElementKind;
use squeal::equilibrium::{Balance, LabelledFactor};
use squeal::mesh::Mesh;
use squeal::native::{Comm, Factor, FactorKind, Precision, Session, Vector};
use squeal::stability::{BandRequest, BandSolver, EigenOptions, QuadraticProblem};
use squeal::structure::{FullModel, free_motions};

const YOUNG: f64 = 210e9;
const POISSON: f64 = 0.3;
const WIDTH: f64 = 0.02;

/// Kinds with faces of 6, 8 and 4 nodes.
const KINDS: [ElementKind; 3] = [ElementKind::C3D10, ElementKind::C3D20, ElementKind::C3D8I];

const STEEL: &str = r#"
[stability]
band = [0, 100000]
[material.steel]
young = 210e9
poisson = 0.3
density = 7850
[part.lower]
material = "steel"
"#;

const UPPER: &str = "[part.upper]\nmaterial = \"steel\"\n";
const TIE: &str = "[[tie]]\nslave = \"upper_z0\"\nmaster = \"lower_z1\"\n";
const CLAMP: &str = "[[fix]]\nnodes = \"lower_z0\"\naxes = \"xyz\"\n";

/// Adds a block between two heights.
fn block(mesh: &mut Mesh, part: &str, kind: ElementKind, cells: [usize; 3], heights: [f64; 2]) {
    let map = |[x, y, z]: [f64; 3]| [WIDTH * x, WIDTH * y, heights[0] + (heights[1] - heights[0]) * z];
    Block { part, cells, wraps: false, map: &map }.add_solids_to(mesh, kind);
}

/// Two blocks, 10 mm high each, of n x n x 1 cells.
fn two(kind: ElementKind, n: [usize; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    block(&mut mesh, "lower", kind, [n[0], n[0], 1], [0.0, 0.01]);
    block(&mut mesh, "upper", kind, [n[1], n[1], 1], [0.01, 0.02]);
    mesh
}

/// One block in their place.
fn one(kind: ElementKind, n: usize) -> Mesh {
    let mut mesh = Mesh::default();
    block(&mut mesh, "lower", kind, [n, n, 2], [0.0, 0.02]);
    mesh
}

/// Adds the one node that is nearest to a point as a set.
fn name_node(mesh: &mut Mesh, name: &str, point: [f64; 3]) {
    let distance = |n: &u32| (0..3).map(|i| (mesh.nodes[*n as usize][i] - point[i]).powi(2)).sum::<f64>();
    let nearest = (0..mesh.nodes.len() as u32).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    mesh.node_sets.insert(name.into(), vec![nearest]);
}

fn assembled(comm: &Comm, brake: &FullModel) -> System {
    brake.assemble(comm, &brake.families().unwrap()).unwrap()
}

/// Displacements under the loads.
fn displacements(comm: &Comm, brake: &FullModel) -> Vec<[f64; 3]> {
    let mut system = assembled(comm, brake);
    system.k.declare_symmetric().unwrap();
    let mut factor = Factor::new(FactorKind::Symmetric);
    factor.factorise(&system.k).unwrap();
    let mut u = system.zeros().unwrap();
    factor.solve(&system.load, &mut u).unwrap();
    brake.displacements(&system, &u).unwrap()
}

/// Frequencies, Hz, of a band.
fn frequencies(comm: &Comm, brake: &FullModel, band: [f64; 2]) -> Vec<f64> {
    let system = assembled(comm, brake);
    let problem = QuadraticProblem::symmetric(system.matrices());
    let mut solver = BandSolver::new(EigenOptions::default(), system.dofs.labels());
    let mut factor = LabelledFactor::new(Precision::Double);
    let request = BandRequest { band, shift: 0.5 * TAU * band[1] };
    let band = solver.solve_band(&problem, &mut factor, &request, &mut |_| ()).unwrap();
    assert!(band.count.agrees(), "{:?}", band.count);
    band.modes.iter().map(|mode| mode.frequency()).collect()
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| most.max(value.abs()))
}

/// A pull of the upper end along z; x0, y0 and z0 are planes of symmetry.
fn pulled() -> String {
    let planes = ["lower", "upper"].map(|part| {
        format!("[[fix]]\nnodes = \"{part}_x0\"\naxes = \"x\"\n[[fix]]\nnodes = \"{part}_y0\"\naxes = \"y\"\n")
    });
    let ends = "[[fix]]\nnodes = \"lower_z0\"\naxes = \"z\"\n\
                [[load]]\non = \"upper_z1\"\nforce = [0, 0, 40000]\nspread = \"area\"\n";
    format!("{STEEL}{UPPER}{TIE}{}{ends}", planes.concat())
}

/// Stress of [`pulled`], Pa.
const STRESS: f64 = 40e3 / (WIDTH * WIDTH);

/// Largest error of the von Mises stress of an element, relative to the stress.
fn stress_error(brake: &FullModel, u: &[[f64; 3]]) -> f64 {
    let solids = brake.families().unwrap().solids;
    largest((0..brake.mesh.elements.len()).map(|e| solids.von_mises(e, u) / STRESS - 1.0))
}

/// Where the meshes match, stress and strain are uniform [1e-11] and the jump is 1e-4 of what one layer of the mean
/// facet's size is stretched by [to 1e-8].
#[test]
fn the_patch_test_holds_where_meshes_match() {
    let comm = Session::start(&[]).unwrap();
    for kind in KINDS {
        let brake = brake(&pulled(), two(kind, [2, 2]));
        let u = displacements(&comm, &brake);
        let summary = &brake.joints.ties[0];
        let size = 0.5 * WIDTH;
        assert_close("penalty", summary.stiffness, 1e4 * YOUNG / size, 1e-9);
        let (strain, jump) = (STRESS / YOUNG, STRESS / summary.stiffness);
        assert_close("jump over the stretch of a layer", jump / (strain * size), 1e-4, 1e-9);
        let first_of_upper = brake.mesh.elements.iter().find(|e| e.part == 1).unwrap().nodes.iter().min().copied();
        let error = |(n, u): (usize, &[f64; 3])| {
            let [x, y, z] = brake.mesh.nodes[n];
            let jump = if n as u32 >= first_of_upper.unwrap() { jump } else { 0.0 };
            let exact = [-POISSON * strain * x, -POISSON * strain * y, strain * z + jump];
            largest((0..3).map(|i| u[i] - exact[i])) / (strain * 2.0 * size)
        };
        let displacement_error = largest(u.iter().enumerate().map(error));
        let stress_error = stress_error(&brake, &u);
        println!("{}: displacements {displacement_error:.1e}, stress {stress_error:.1e}", kind.name());
        assert!(displacement_error < 1e-9 && stress_error < 1e-9);
    }
}

/// Where facets overlap in part, nodes do not pass on the pressure's share: stress is off by a tenth beside the tie
/// [0.061, 0.041, 0.10], the length by a hundredth [0.0036, 0.0018, 0.012]. Where the finer facets divide the coarser
/// ones, stress is uniform [7e-12].
#[test]
fn stress_beside_a_tie_of_meshes_that_do_not_match_is_nearly_uniform() {
    let comm = Session::start(&[]).unwrap();
    let cases = KINDS.into_iter().flat_map(|kind| [(kind, [2, 3], 0.12), (kind, [2, 4], 1e-9)]);
    for (kind, n, allowed) in cases {
        let brake = brake(&pulled(), two(kind, n));
        let u = displacements(&comm, &brake);
        let top = brake.mesh.node_set("upper_z1").unwrap();
        let mean = top.iter().map(|&node| u[node as usize][2]).sum::<f64>() / top.len() as f64;
        let (stress, length) = (stress_error(&brake, &u), mean / (STRESS / YOUNG * 0.02) - 1.0);
        println!("{} {n:?}: stress {stress:.1e}, length {length:.1e}", kind.name());
        assert!(stress < allowed && length.abs() < 0.02);
    }
}

/// The triangles of tetrahedra on the quadrilaterals of hexahedra: nodes meet nodes or centres, and stress is uniform
/// [1e-11].
#[test]
fn elements_of_different_kinds_are_tied() {
    let comm = Session::start(&[]).unwrap();
    let mut mesh = Mesh::default();
    block(&mut mesh, "lower", ElementKind::C3D20, [2, 2, 1], [0.0, 0.01]);
    block(&mut mesh, "upper", ElementKind::C3D10, [2, 2, 1], [0.01, 0.02]);
    let brake = brake(&pulled(), mesh);
    let stress_error = stress_error(&brake, &displacements(&comm, &brake));
    println!("stress {stress_error:.1e}");
    assert!(stress_error < 1e-9);
}

/// Two tied blocks beside one block of the same mesh: a side force [softer by 3.3e-5 to 3.8e-5] and the first ten
/// frequencies [lower by 3e-6 to 3e-5].
#[test]
fn tied_blocks_are_one_block() {
    let comm = Session::start(&[]).unwrap();
    let load = |part: &str| format!("{CLAMP}[[load]]\non = \"{part}_z1\"\nforce = [1000, 0, 0]\nspread = \"area\"\n");
    for kind in KINDS {
        let tied = brake(&format!("{STEEL}{UPPER}{TIE}{}", load("upper")), two(kind, [2, 2]));
        let whole = brake(&format!("{STEEL}{}", load("lower")), one(kind, 2));
        let deflection = |brake: &FullModel, surface: &str| {
            let u = displacements(&comm, brake);
            let nodes = brake.mesh.node_set(surface).unwrap();
            nodes.iter().map(|&n| u[n as usize][0]).sum::<f64>() / nodes.len() as f64
        };
        let softer = deflection(&tied, "upper_z1") / deflection(&whole, "lower_z1") - 1.0;
        let [of_tied, of_whole] = [&tied, &whole].map(|brake| frequencies(&comm, brake, [0.0, 250e3]));
        assert!(of_whole.len() >= 10);
        let lower: Vec<f64> = of_tied.iter().zip(&of_whole).take(10).map(|(tied, whole)| 1.0 - tied / whole).collect();
        println!("{}: softer by {softer:.1e}, frequencies lower by {lower:?}", kind.name());
        assert!(softer > 0.0 && softer < 1e-4);
        assert!(lower.iter().all(|lower| *lower > -1e-9 && *lower < 5e-5));
    }
}

/// Meshes that do not match, beside one block of the finer mesh: the first ten frequencies [1.5, 0.9, 2.2 %].
#[test]
fn tied_blocks_of_different_meshes_are_nearly_one_block() {
    let comm = Session::start(&[]).unwrap();
    for (kind, allowed) in KINDS.into_iter().zip([0.02, 0.01, 0.03]) {
        let tied = brake(&format!("{STEEL}{UPPER}{TIE}{CLAMP}"), two(kind, [2, 3]));
        let whole = brake(&format!("{STEEL}{CLAMP}"), one(kind, 3));
        let [of_tied, of_whole] = [&tied, &whole].map(|brake| frequencies(&comm, brake, [0.0, 150e3]));
        let errors: Vec<f64> = of_tied.iter().zip(&of_whole).take(10).map(|(tied, whole)| tied / whole - 1.0).collect();
        println!("{}: {errors:?}", kind.name());
        assert!(errors.len() == 10 && errors.iter().all(|error| error.abs() < allowed), "{errors:?}");
    }
}

/// The upper end is rigid while its edge is pulled: its own strain beside that of the block [2.3e-5].
#[test]
fn a_rigid_set_keeps_its_distances() {
    let comm = Session::start(&[]).unwrap();
    for kind in KINDS {
        let mut mesh = one(kind, 2);
        let edge = nodes_where(&mesh, |x| x[0] > 0.999 * WIDTH && x[2] > 0.0199);
        mesh.node_sets.insert("edge".into(), edge);
        let text = format!(
            "{STEEL}{CLAMP}[[rigid]]\nnodes = \"lower_z1\"\n[[load]]\non = \"edge\"\nforce = [20000, 5000, 10000]\n"
        );
        let brake = brake(&text, mesh);
        let u = displacements(&comm, &brake);
        let nodes = brake.mesh.node_set("lower_z1").unwrap();
        let mut strain = 0.0_f64;
        for (&a, &b) in nodes.iter().flat_map(|a| nodes.iter().map(move |b| (a, b))).filter(|(a, b)| a < b) {
            let [a, b] = [a, b].map(|n| n as usize);
            let apart = [0, 1, 2].map(|i| brake.mesh.nodes[b][i] - brake.mesh.nodes[a][i]);
            let change: f64 = (0..3).map(|i| apart[i] * (u[b][i] - u[a][i])).sum();
            strain = strain.max(change.abs() / apart.iter().map(|x| x * x).sum::<f64>());
        }
        let of_block = largest(u.iter().flatten().copied()) / 0.02;
        println!("{}: {strain:.1e} of {of_block:.1e}: {:.1e}", kind.name(), strain / of_block);
        assert!(strain < 5e-5 * of_block);
    }
}

/// A body without noticeable mass, on springs to the ground with a mass of 10 kg on its rigid face: `sqrt(k / m)` to
/// 1e-6 [1.4e-8].
#[test]
fn a_point_mass_on_springs_swings_at_its_frequency() {
    let comm = Session::start(&[]).unwrap();
    let light = STEEL.replace("7850", "1e-3");
    let text = format!(
        "{light}[[rigid]]\nnodes = \"lower_z1\"\n\
         [[mass]]\nnodes = \"lower_z1\"\nmass = 10\nat = [0.01, 0.01, 0.05]\ninertia = [2e-3, 3e-3, 4e-3, 0, 0, 0]\n\
         [[connector]]\nbetween = [\"lower_z1\", \"ground\"]\nat = [0.01, 0.01, 0.05]\nstiffness = [1e6, 2e6, 3e6]\n\
         rotational_stiffness = [1e3, 2e3, 3e3]\n"
    );
    let brake = brake(&text, one(ElementKind::C3D20, 1));
    let found = frequencies(&comm, &brake, [0.0, 1000.0]);
    let mut exact: Vec<f64> = [1e6 / 10.0, 2e6 / 10.0, 3e6 / 10.0, 1e3 / 2e-3, 2e3 / 3e-3, 3e3 / 4e-3]
        .map(|ratio: f64| ratio.sqrt() / TAU)
        .to_vec();
    exact.sort_by(f64::total_cmp);
    assert_eq!(found.len(), 6);
    found.iter().zip(exact).for_each(|(found, exact)| assert_close("frequency", *found, exact, 1e-6));
}

/// Mass and inertia of block and point mass together, as the rigid motions of M show them.
#[test]
fn a_mass_with_inertia_and_offset_adds_to_the_bodys() {
    let comm = Session::start(&[]).unwrap();
    let (mass, at) = (0.3, [0.05, -0.01, 0.04]);
    let with = format!(
        "{STEEL}[[rigid]]\nnodes = \"lower_z1\"\n[[mass]]\nnodes = \"lower_z1\"\nmass = {mass}\nat = {at:?}\n\
         inertia = [2e-4, 3e-4, 4e-4, 1e-5, -2e-5, 3e-5]\n"
    );
    let energies = |text: &str| {
        let brake = brake(text, one(ElementKind::C3D10, 2));
        let system = assembled(&comm, &brake);
        let energy = |motion: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let u: Vec<f64> = brake.mesh.nodes.iter().flat_map(|&x| motion(x)).collect();
            let (u, mut image) = (Vector::from_local(&comm, &u).unwrap(), system.zeros().unwrap());
            system.m.multiply(&u, &mut image).unwrap();
            let (u, image) = (u.to_vec().unwrap(), image.to_vec().unwrap());
            u.iter().zip(image).map(|(u, image)| u * image).sum::<f64>()
        };
        [
            energy(&|_| [1.0, 0.0, 0.0]),
            energy(&|_| [0.0, 1.0, 0.0]),
            energy(&|_| [0.0, 0.0, 1.0]),
            energy(&|[_, y, z]| [0.0, -z, y]),
            energy(&|[x, _, z]| [z, 0.0, -x]),
            energy(&|[x, y, _]| [-y, x, 0.0]),
        ]
    };
    let (with, without) = (energies(&with), energies(STEEL));
    let [x, y, z] = at.map(|x| x * x);
    let added = [mass, mass, mass, 2e-4 + mass * (y + z), 3e-4 + mass * (z + x), 4e-4 + mass * (x + y)];
    for i in 0..6 {
        assert_close("added inertia", with[i] - without[i], added[i], 1e-10);
    }
}

/// Two nodes of the free end that move against each other, pushed by a force at one of them [1e-5].
#[test]
fn an_equation_holds_to_its_penalty() {
    let comm = Session::start(&[]).unwrap();
    let mut mesh = one(ElementKind::C3D10, 2);
    name_node(&mut mesh, "left", [0.0, 0.0, 0.02]);
    name_node(&mut mesh, "right", [WIDTH, WIDTH, 0.02]);
    let text = format!(
        "{STEEL}{CLAMP}[[equation]]\nterms = [{{ node = \"left\", axis = \"x\", coefficient = 1 }}, \
         {{ node = \"right\", axis = \"x\", coefficient = 1 }}]\n[[load]]\non = \"left\"\nforce = [1000, 0, 0]\n"
    );
    let brake = brake(&text, mesh);
    let u = displacements(&comm, &brake);
    let of = |name: &str| u[brake.mesh.node_set(name).unwrap()[0] as usize][0];
    let (left, right) = (of("left"), of("right"));
    println!("{left:.3e} and {right:.3e}: {:.1e}", (left + right) / left);
    assert!(left > 0.0 && (left + right).abs() < 2e-5 * left);
}

/// A force at a point above the block: the moment at the clamp is that of the force and its own.
#[test]
fn a_force_at_a_point_bends_as_its_moment_does() {
    let comm = Session::start(&[]).unwrap();
    let with = |load: &str| {
        let text = format!("{STEEL}{CLAMP}[[rigid]]\nnodes = \"lower_z1\"\n[[load]]\non = \"lower_z1\"\n{load}\n");
        displacements(&comm, &brake(&text, one(ElementKind::C3D20, 1)))
    };
    let at_point = with("force = [100, 0, 0]\nat = [0.01, 0.01, 0.12]");
    let with_moment = with("force = [100, 0, 0]\nmoment = [0, 10, 0]\nat = [0.01, 0.01, 0.02]");
    let size = largest(at_point.iter().flatten().copied());
    let difference = largest((0..at_point.len()).flat_map(|n| [0, 1, 2].map(|i| at_point[n][i] - with_moment[n][i])));
    assert!(size > 0.0 && difference < 1e-9 * size, "{difference:e} of {size:e}");
}

/// What free motions of two blocks are left by some joints.
fn left_free(comm: &Comm, joints: &str) -> Vec<String> {
    let brake = brake(&format!("{STEEL}{UPPER}{joints}"), two(ElementKind::C3D8I, [2, 3]));
    let free = free_motions(comm, &brake.mesh, &brake.nodes, &brake.interface, &brake.held, &brake.joints);
    free.iter().map(ToString::to_string).collect()
}

#[test]
fn joints_constrain_what_they_join() {
    let comm = Session::start(&[]).unwrap();
    assert_eq!(left_free(&comm, CLAMP).len(), 6);
    assert_eq!(left_free(&comm, &format!("{CLAMP}{TIE}")), Vec::<String>::new());
    let flying = left_free(&comm, TIE);
    assert_eq!(flying.len(), 6);
    assert!(flying.iter().all(|motion| motion.contains("together with upper")), "{flying:?}");
    let ground = "[[connector]]\nbetween = [\"upper_z1\", \"ground\"]\nstiffness = [1e6, 1e6, 1e6]\n";
    assert_eq!(left_free(&comm, &format!("{TIE}{ground}")).len(), 3);
    let held = format!("{TIE}{ground}rotational_stiffness = [1, 1, 1]\n");
    assert_eq!(left_free(&comm, &held), Vec::<String>::new());
}

/// A rigid set of nodes of both blocks joins them.
#[test]
fn a_rigid_set_of_two_bodies_joins_them() {
    let comm = Session::start(&[]).unwrap();
    let mut mesh = two(ElementKind::C3D8I, [1, 1]);
    let side = nodes_where(&mesh, |x| x[0] == 0.0);
    mesh.node_sets.insert("side".into(), side);
    let brake = brake(&format!("{STEEL}{UPPER}{CLAMP}[[rigid]]\nnodes = \"side\"\n"), mesh);
    let free = free_motions(&comm, &brake.mesh, &brake.nodes, &brake.interface, &brake.held, &brake.joints);
    assert_eq!(free.len(), 0);
}

/// A block that is stretched by a prescribed displacement: uniform strain and stress [2e-14], and supports that pull at
/// both ends with the force of that stress.
#[test]
fn a_prescribed_displacement_stretches_a_block() {
    let comm = Session::start(&[]).unwrap();
    let strain = 5e-4;
    let planes = ["x", "y", "z"].map(|axis| format!("[[fix]]\nnodes = \"lower_{axis}0\"\naxes = \"{axis}\"\n"));
    let moved = format!("[[fix]]\nnodes = \"lower_z1\"\naxes = \"z\"\ndisplacement = [0, 0, {}]\n", strain * 0.02);
    for kind in KINDS {
        let brake = brake(&format!("{STEEL}{}{moved}", planes.concat()), one(kind, 2));
        let u = displacements(&comm, &brake);
        let error = |(n, u): (usize, &[f64; 3])| {
            let exact: [f64; 3] =
                std::array::from_fn(|i| [-POISSON, -POISSON, 1.0][i] * strain * brake.mesh.nodes[n][i]);
            largest((0..3).map(|i| u[i] - exact[i])) / (strain * 0.02)
        };
        let displacement_error = largest(u.iter().enumerate().map(error));
        let solids = brake.families().unwrap().solids;
        let stress = |e| solids.von_mises(e, &u) / (YOUNG * strain) - 1.0;
        let stress_error = largest((0..brake.mesh.elements.len()).map(stress));
        println!("{}: displacements {displacement_error:.1e}, stress {stress_error:.1e}", kind.name());
        assert!(displacement_error < 1e-12 && stress_error < 1e-11);

        let (system, families) = (assembled(&comm, &brake), brake.families().unwrap());
        let balance =
            Balance::new(&system, &brake.mesh.nodes, &families.list(), &brake.loads, &brake.interface, &u, &[]);
        let pull = YOUNG * strain * WIDTH * WIDTH;
        let top = balance.reactions.iter().filter(|(n, _)| brake.mesh.nodes[*n as usize][2] > 0.019);
        assert_close("pull", top.map(|(_, force)| force[2]).sum(), pull, 1e-11);
        assert!(balance.residual()[0] < 1e-11 * pull && balance.residual()[1] < 1e-11 * pull * WIDTH);
    }
}
