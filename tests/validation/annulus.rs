//! Free vibration of an annular plate: double modes, all of them, with the bore clamped and with nothing held.
//!
//! ```text
//!      ______      ______      r 254-508 mm, 25.4 mm thick, E = 210 GPa, nu = 0.3, rho = 7855 kg/m3
//!     |______|    |______|     n nodal diameters: for n >= 1 a mode along cos n theta and one along sin n theta
//!            bore              8 x 48 x 2 cells of six tetrahedra, midsides on the circles
//! ```
//!
//! Source: thin-plate theory, the roots of the 4x4 determinant of J_n, Y_n, I_n, K_n under the edges' conditions;
//! Leissa, Vibration of Plates, NASA SP-160 (1969), tables 2.20 to 2.30.
//!
//! The mesh repeats itself every 7.5 degrees, so doublets are exact and their splitting is that of the solver: the
//! hardest case for it. A solid is softer than a thin plate by shear and rotary inertia, as (h/wavelength)^2, and at
//! free edges by twist, as h/width, which is what lowers two modes of the free plate by 3 %: with a quarter of the
//! thickness its n = 1 lies 0.01 % below theory.
//!
//! Goal and, in brackets, measured: every mode of 0-900 Hz; doublets split by less than 1e-8 [1e-9]; frequency against
//! theory from -1.5 % to +0.3 % [-1.15 to +0.15 %] clamped, -1 to 0 % [-0.73 to -0.54 %] free, -3.5 to -2.5 % [-3.0,
//! -3.3 %] for the two modes of the free plate that twist.

use std::f64::consts::TAU;

use super::table::{Case, Row};
use crate::support::block::Block;
use crate::support::brake;
use squeal::assembly::System;
use squeal::equilibrium::LabelledFactor;
use squeal::mesh::Mesh;
use squeal::native::{Comm, Precision, Session};
use squeal::stability::{Band, BandRequest, BandSolver, EigenOptions, Mode, QuadraticProblem};

const FREE: &str = r#"
[material.steel]
young = 210e9
poisson = 0.3
density = 7855
[part.plate]
material = "steel"
[stability]
band = [0, 900]
"#;

const BORE: &str = r#"
[[fix]]
nodes = "plate_x0"
axes = "xyz"
"#;

/// Of the square sum of a mode's displacements, the part along z.
fn bending_share(system: &System, mode: &Mode) -> f64 {
    let shape = system.nodal(&[&mode.re]).unwrap().remove(0);
    let along: f64 = shape.iter().map(|u| u[2] * u[2]).sum();
    along / shape.as_flattened().iter().map(|u| u * u).sum::<f64>()
}

fn mesh(cells: [usize; 3]) -> Mesh {
    let mut mesh = Mesh::default();
    let map = |x: [f64; 3]| {
        let (r, angle) = (0.254 + 0.254 * x[0], TAU * x[1]);
        [r * angle.cos(), r * angle.sin(), 0.0254 * x[2]]
    };
    Block { part: "plate", cells, wraps: true, map: &map }.add_to(&mut mesh);
    mesh
}

/// All modes of a band without contact.
fn modes(system: &System, shift: f64, band: [f64; 2]) -> Band {
    let problem = QuadraticProblem::symmetric(system.matrices());
    let mut solver = BandSolver::new(EigenOptions::default(), system.dofs.labels());
    let request = BandRequest { band, shift };
    let mut factor = LabelledFactor::new(Precision::Double);
    let band = solver.solve_band(&problem, &mut factor, &request, &mut |_| ()).unwrap();
    assert!(band.count.agrees(), "{:?}", band.count);
    band
}

/// Frequencies of the elastic modes that bend, and number of rigid motions.
fn bending_frequencies(comm: &Comm, text: &str, shift: f64) -> (Vec<f64>, usize) {
    let brake = brake(text, mesh([8, 48, 2]));
    let families = brake.families().unwrap();
    let system = brake.assemble(comm, &families).unwrap();
    let band = modes(&system, shift, brake.model.band);
    let elastic: Vec<&Mode> = band.modes.iter().filter(|mode| mode.frequency() > 1.0).collect();
    for mode in &elastic {
        println!("{:.7} Hz, growth {:.1e}, {:.1e}", mode.frequency(), mode.growth_rate(), mode.backward_error);
        assert!(mode.backward_error < 1e-9 && !mode.grows());
    }
    let bending = elastic.iter().filter(|mode| bending_share(&system, mode) > 0.5);
    (bending.map(|mode| mode.frequency()).collect(), band.count.found - elastic.len())
}

/// Nodal diameters, thin-plate frequency (Hz), and the range of the relative difference.
type Expected = (usize, f64, [f64; 2]);

/// Rows of the expected modes; each with nodal diameters has to be there twice, and nothing else.
fn compare(found: &[f64], expected: &[Expected]) -> Vec<Row> {
    let (mut left, mut rows) = (found, Vec::new());
    for &(n, theory, range) in expected {
        let multiplicity = if n == 0 { 1 } else { 2 };
        let (own, rest) = left.split_at(multiplicity);
        left = rest;
        let split = own[multiplicity - 1] / own[0] - 1.0;
        println!("n = {n}: {:.4} Hz, split by {split:.1e}", own[0]);
        assert!(split < 1e-8);
        let what = format!("{n} nodal diameters at {theory} Hz, {}", if n == 0 { "once" } else { "twice" });
        rows.push(Row::between(what, "Hz", own[0], theory, range));
    }
    assert_eq!(left.len(), 0, "all of the list");
    rows
}

fn clamped(comm: &Comm) -> Case {
    let range = [-0.015, 0.003];
    let expected = [
        (0, 319.23, range),
        (1, 325.74, range),
        (2, 360.40, range),
        (3, 454.96, range),
        (4, 627.37, range),
        (5, 875.76, range),
    ];
    let (found, n_rigid) = bending_frequencies(comm, &format!("{FREE}{BORE}"), 0.0);
    assert_eq!(n_rigid, 0);
    Case {
        title: "Annular plate, clamped at its bore",
        text: "Radii 254 and 508 mm, 25.4 mm thick, steel. Reference: thin-plate theory (Leissa, NASA SP-160). All modes of 0-900 Hz \
               that bend; doublets are split by less than 1e-8. A solid is a little softer than a thin plate.",
        rows: compare(&found, &expected),
    }
}

fn free(comm: &Comm) -> Case {
    let range = [-0.01, 0.0];
    let twist = [-0.035, -0.025];
    let expected = [
        (2, 104.69, range),
        (0, 228.28, range),
        (3, 280.04, range),
        (1, 421.54, twist),
        (4, 516.37, range),
        (2, 762.64, twist),
        (5, 808.39, range),
    ];
    let (found, n_rigid) = bending_frequencies(comm, FREE, 2000.0);
    assert_eq!(n_rigid, 6);
    Case {
        title: "Annular plate, free",
        text: "The same plate with nothing held: six rigid motions, then these. Two twist at the edges, where a thick plate is softer; with a \
               quarter of the thickness the first of them lies 0.01 % below theory.",
        rows: compare(&found, &expected),
    }
}

pub fn cases(comm: &Comm) -> Vec<Case> {
    vec![clamped(comm), free(comm)]
}

#[test]
fn clamped_at_its_bore_it_has_all_doublets() {
    clamped(&Session::start(&[]).unwrap()).verify();
}

#[test]
fn free_it_has_six_rigid_motions_and_all_doublets() {
    free(&Session::start(&[]).unwrap()).verify();
}

/// Six rigid motions are twelve defective zeros, which LAPACK may find too close to reorder (xTREXC, info 1); the
/// search must then go on. Which shift meets this depends on rounding: 3 or 4 of these 40 did before the search went
/// on, none since.
#[test]
fn free_it_has_as_many_modes_at_any_shift() {
    let comm = Session::start(&[]).unwrap();
    let brake = brake(FREE, mesh([4, 16, 1]));
    let families = brake.families().unwrap();
    let system = brake.assemble(&comm, &families).unwrap();
    for step in 0..40 {
        let band = modes(&system, 100.0 * 1.1_f64.powi(step), brake.model.band);
        assert_eq!(band.count.found, 17);
    }
}
