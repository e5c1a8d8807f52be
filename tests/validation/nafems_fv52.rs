//! NAFEMS FV52: a thick square plate on its four lower edges, free in its plane.
//!
//! ```text
//!        ______________________
//!       /                     /|    10 x 10 x 1 m, E = 200 GPa, nu = 0.3, rho = 8000 kg/m3
//!      /                     / |    u_z = 0 on the four lower edges: three rigid modes, so K is singular and the
//!     /_____________________/  /    eigenproblem is inverted about a real shift
//!     |_____________________| /
//!     ^      ^      ^      ^  u_z = 0 on lines
//! ```
//!
//! Source: NAFEMS, The Standard NAFEMS Benchmarks, TNSB rev. 3 (1990), test FV52: 45.897, 109.44 (twice), 167.89,
//! 193.59, 206.19 (twice) Hz. Published with quadratic tetrahedra of 1.67 m: 44.61, 108.5, 108.8, 165.8, 193.7, 202.9,
//! 207.0 Hz.
//!
//! 193.59 and 206.19 move in the plane, where nothing holds the plate: they converge. The others bend, and a solid
//! cannot be held on a line: its displacement under a line force is infinite, as the logarithm of the mesh. Measured on
//! 6x6x1, 10x10x1, 12x12x2, 16x16x2 cells: 45.02, 44.24, 43.68, 43.49 Hz; 170.3, 162.7, 158.3, 156.7 Hz. The published
//! bending frequencies are those of the meshes of their time, and only a mesh as fine as theirs can be compared.
//!
//! Goal: three rigid motions; in the plane 0.1 % from NAFEMS [0.03 %]; bending, on 8x8x1 cells of six tetrahedra, 1 %
//! from the published tetrahedra [0.5 %], 2 % for their last pair, which is double and which their mesh splits by 2 %
//! [1.7 %].

use super::table::{Case, Row};
use crate::support::block::Block;
use crate::support::{brake, nodes_where};
use squeal::assembly::System;
use squeal::equilibrium::LabelledFactor;
use squeal::mesh::Mesh;
use squeal::native::{Comm, Precision, Session};
use squeal::stability::{BandRequest, BandSolver, EigenOptions, Mode, QuadraticProblem};

const MODEL: &str = r#"
[material.steel]
young = 200e9
poisson = 0.3
density = 8000
[part.plate]
material = "steel"
[[fix]]
nodes = "edges"
axes = "z"
[stability]
band = [0, 212]
"#;

/// Of the square sum of a mode's displacements, the part along z.
fn bending_share(system: &System, mode: &Mode) -> f64 {
    let shape = system.nodal(&[&mode.re]).unwrap().remove(0);
    let along: f64 = shape.iter().map(|u| u[2] * u[2]).sum();
    along / shape.as_flattened().iter().map(|u| u * u).sum::<f64>()
}

pub fn cases(comm: &Comm) -> Vec<Case> {
    let mut mesh = Mesh::default();
    let map = |x: [f64; 3]| [10.0 * x[0], 10.0 * x[1], x[2]];
    Block { part: "plate", cells: [8, 8, 1], wraps: false, map: &map }.add_to(&mut mesh);
    let on_edge = |x: [f64; 3]| x[2] == 0.0 && x[..2].iter().any(|&x| x == 0.0 || x == 10.0);
    let nodes = nodes_where(&mesh, on_edge);
    mesh.node_sets.insert("edges".into(), nodes);
    let brake = brake(MODEL, mesh);
    let families = brake.families().unwrap();
    let system = brake.assemble(comm, &families).unwrap();
    let problem = QuadraticProblem::symmetric(system.matrices());
    let mut solver = BandSolver::new(EigenOptions::default(), system.dofs.labels());
    let request = BandRequest { band: brake.model.band, shift: 300.0 };
    let mut factor = LabelledFactor::new(Precision::Double);
    let band = solver.solve_band(&problem, &mut factor, &request, &mut |_| ()).unwrap();
    assert!(band.count.agrees(), "{:?}", band.count);
    let elastic: Vec<&Mode> = band.modes.iter().filter(|mode| mode.frequency() > 1.0).collect();
    assert_eq!(band.count.found - elastic.len(), 3, "rigid motions");
    let (mut plane, mut bending) = (Vec::new(), Vec::new());
    for mode in elastic {
        println!("{:.4} Hz, bends {:.3}, {:.1e}", mode.frequency(), bending_share(&system, mode), mode.backward_error);
        assert!(mode.backward_error < 1e-12 && !mode.grows());
        let list = if bending_share(&system, mode) < 0.5 { &mut plane } else { &mut bending };
        list.push(mode.frequency());
    }
    assert_eq!((plane.len(), bending.len()), (3, 6));
    let in_plane = plane.iter().zip([193.59, 206.19, 206.19]);
    let in_plane = in_plane.map(|(found, nafems)| Row::new("in the plane", "Hz", *found, nafems, 1e-3));
    let tetrahedra = [(44.61, 1e-2), (108.5, 1e-2), (108.8, 1e-2), (165.8, 1e-2), (202.9, 2e-2), (207.0, 2e-2)];
    let bending = bending.iter().zip(tetrahedra);
    let bending =
        bending.map(|(found, (published, tolerance))| Row::new("bending", "Hz", *found, published, tolerance));
    vec![Case {
        title: "NAFEMS FV52",
        text: "A square plate, 10 x 10 x 1 m, held along z on its four lower edges: three rigid motions, then these. Reference: in the plane \
               NAFEMS (TNSB rev. 3, 1990); bending, which depends on the mesh as a solid cannot be held on a line, the published values of \
               quadratic tetrahedra of about the same size.",
        rows: in_plane.chain(bending).collect(),
    }]
}

#[test]
fn a_plate_with_three_rigid_motions_has_the_published_modes() {
    cases(&Session::start(&[]).unwrap()).iter().for_each(Case::verify);
}
