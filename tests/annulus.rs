//! Free vibration of an annular plate: double modes, all of them, with the bore clamped and with nothing held.
//!
//! ```text
//!      ______      ______      r 254-508 mm, 25.4 mm thick, E = 210 GPa, nu = 0.3, rho = 7855 kg/m3
//!     |______|    |______|     n nodal diameters: for n >= 1 a mode along cos n theta and one along sin n theta
//!            bore              8 x 48 x 2 cells of six tetrahedra, midsides on the circles
//! ```
//!
//! Source: thin-plate theory, the roots of the 4x4 determinant of J_n, Y_n, I_n, K_n under the edges' conditions; Leissa, Vibration
//! of Plates, NASA SP-160 (1969), tables 2.20 to 2.30.
//!
//! The mesh repeats itself every 7.5 degrees, so doublets are exact and their splitting is that of the solver: the hardest case
//! for it. A solid is softer than a thin plate by shear and rotary inertia, as (h/wavelength)^2, and at free edges by
//! twist, as h/width, which is what lowers two modes of the free plate by 3 %: with a quarter of the thickness its n = 1 lies
//! 0.01 % below theory.
//!
//! Goal and, in brackets, measured: every mode of 0-900 Hz; doublets split by less than 1e-8 [1e-9]; frequency against theory from
//! -1.5 % to +0.3 % [-1.15 to +0.15 %] clamped, -1 to 0 % [-0.73 to -0.54 %] free, -3.5 to -2.5 % [-3.0, -3.3 %] for the two
//! modes of the free plate that twist.

mod common;

use std::f64::consts::TAU;

use common::{Block, brake};
use squeal::assembly::System;
use squeal::mesh::Mesh;
use squeal::petsc::{Factor, FactorKind, Session};
use squeal::stability::{self, Band, Mode, Pencil, Solver};

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
    let pencil =
        Pencil { m: &system.m, c: &system.c, k: &system.k, k_symmetric: &system.k, points: None, symmetric_mc: true };
    let (mut lu, mut solver) = (Factor::new(FactorKind::Unsymmetric), Solver::shifted(shift));
    let band = stability::solve(&pencil, &mut lu, &mut solver, band, &mut |_, _, _| ()).unwrap();
    assert!(band.count.agrees(), "{:?}", band.count);
    band
}

/// Frequencies of the elastic modes that bend, and number of rigid motions.
fn bending_frequencies(text: &str, shift: f64) -> (Vec<f64>, usize) {
    let comm = Session::start(&[]).unwrap();
    let brake = brake(text, mesh([8, 48, 2]));
    let families = brake.families().unwrap();
    let system = brake.assemble(&comm, &families).unwrap();
    let band = modes(&system, shift, brake.model.band);
    let elastic: Vec<&Mode> = band.modes.iter().filter(|mode| mode.frequency() > 1.0).collect();
    for mode in &elastic {
        println!("{:.7} Hz, growth {:.1e}, {:.1e}", mode.frequency(), mode.growth_rate(), mode.backward_error);
        assert!(mode.backward_error < 1e-9 && !mode.is_unstable());
    }
    let bending = elastic.iter().filter(|mode| bending_share(&system, mode) > 0.5);
    (bending.map(|mode| mode.frequency()).collect(), band.count.found - elastic.len())
}

/// Nodal diameters, thin-plate frequency (Hz), and the range of the relative difference.
type Expected = (usize, f64, [f64; 2]);

fn compare(found: &[f64], expected: &[Expected]) {
    let mut left = found;
    for &(n, theory, [low, high]) in expected {
        let multiplicity = if n == 0 { 1 } else { 2 };
        let (own, rest) = left.split_at(multiplicity);
        left = rest;
        let (off, split) = (own[0] / theory - 1.0, own[multiplicity - 1] / own[0] - 1.0);
        println!("n = {n}: {:.4} Hz, {:+.2} % from thin plates, split by {split:.1e}", own[0], 100.0 * off);
        assert!(split < 1e-8 && off > low && off < high);
    }
}

#[test]
fn clamped_at_its_bore_it_has_all_doublets() {
    let range = [-0.015, 0.003];
    let expected = [
        (0, 319.23, range),
        (1, 325.74, range),
        (2, 360.40, range),
        (3, 454.96, range),
        (4, 627.37, range),
        (5, 875.76, range),
    ];
    let (found, n_rigid) = bending_frequencies(&format!("{FREE}{BORE}"), 0.0);
    assert_eq!((found.len(), n_rigid), (11, 0), "all of the list");
    compare(&found, &expected);
}

#[test]
fn free_it_has_six_rigid_motions_and_all_doublets() {
    let range = [-0.01, 0.0];
    let (found, n_rigid) = bending_frequencies(FREE, 2000.0);
    assert_eq!((found.len(), n_rigid), (13, 6), "all of the list");
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
    compare(&found, &expected);
}

/// Six rigid motions are twelve defective zeros, which LAPACK may find too close to reorder (xTREXC, info 1); the search must
/// then go on. Which shift meets this depends on rounding: 3 or 4 of these 40 did before the search went on, none since.
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
