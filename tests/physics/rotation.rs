//! Parts that turn: a thin ring against Bryan's formula in both frames, the rotor of CalculiX's examples, and a brake
//! whose disc has inertia forces.
//!
//! ```text
//!  thin ring, n waves around, spin Omega:       w0 at rest, in the frame that turns with the ring
//!    w = sqrt(w0^2 + (n (n^2 - 1) Omega / (n^2 + 1))^2) -+ 2 n Omega / (n^2 + 1)       - forward, + backward wave
//!  seen from the fixed frame                    w + n Omega forward, w - n Omega backward
//! ```
//!
//! Source: G. H. Bryan, *On the beats in the vibrations of a revolving cylinder or bell*, Proc. Cambridge Phil. Soc. 7
//! (1890), 101; with the hoop stress of the rotation: Endo, Hatamura, Sakata and Taniguchi, J. Sound Vib. 92 (1984),
//! 261.
//!
//! Goal and, in brackets, measured: see each test.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::super_element::transposed_errors;
use crate::support::block;
use crate::support::{assert_close, brake};
use nalgebra::DMatrix;
use num_complex::Complex64;
use squeal::analysis::Sweep;
use squeal::element::ElementKind;
use squeal::equilibrium::LabelledFactor;
use squeal::mesh::Mesh;
use squeal::model::Inertia;
use squeal::native::{Block, Comm, Matrix, Mck, Precision, Session};
use squeal::stability::{Band, BandSolver, EigenOptions, Mode, QuadraticProblem, SolverKind};
use squeal::structure::FullModel;

/// The ring moves in its plane; a spring on its mean motion holds it and no wave of two lengths or more.
const RING: &str = r#"
[material.steel]
young = 210e9
poisson = 0.0
density = 7800
[part.ring]
material = "steel"
[[fix]]
nodes = "ring_z0"
axes = "z"
[[fix]]
nodes = "ring_z1"
axes = "z"
[[connector]]
between = ["ring_x1", "ground"]
stiffness = [1e5, 1e5, 0]
rotational_stiffness = [0, 0, 1e3]
[stability]
band = [0, 900]
"#;

const SPIN: f64 = 200.0;

/// Mean radius 100 mm, 2 mm thick, 4 mm wide.
fn ring(inertia: &str) -> FullModel {
    let mut mesh = Mesh::default();
    let map = |x: [f64; 3]| {
        let (r, angle) = (0.099 + 0.002 * x[0], TAU * x[1]);
        [r * angle.cos(), r * angle.sin(), 0.004 * x[2]]
    };
    block::Block { part: "ring", cells: [1, 40, 1], wraps: true, map: &map }
        .add_solids_to(&mut mesh, ElementKind::C3D20R);
    let rotation =
        format!("[[rotation]]\npart = \"ring\"\naxis = [0, 0, 1]\nspeed = {SPIN}\ninertia = \"{inertia}\"\n");
    brake(&RING.replace("[stability]", &format!("{rotation}[stability]")), mesh)
}

/// The modes about the equilibrium, all of them.
fn modes(comm: &Comm, brake: &FullModel) -> Band {
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let prestress = brake.prestress().unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap().with_prestress(prestress.as_ref());
    let equilibrium = sweep.equilibrium(0.0, &mut ()).unwrap();
    let band = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
    for mode in &band.modes {
        println!("{:.6} Hz, growth {:.1e}, {:.1e}", mode.frequency(), mode.growth_rate(), mode.backward_error);
    }
    println!("{:?}", band.count);
    band
}

/// The frequency (rad/s) nearest to one expected.
fn nearest(band: &Band, expected: f64) -> f64 {
    let all = band.modes.iter().map(|mode| mode.lambda.im);
    all.min_by(|a, b| (a - expected).abs().total_cmp(&(b - expected).abs())).expect("modes in the band")
}

/// Bryan's formula with the ring's own frequencies at rest, in the rotating frame.
fn bryan(n: f64, at_rest: f64) -> [f64; 2] {
    let centre = at_rest.hypot(n * (n * n - 1.0) * SPIN / (n * n + 1.0));
    let split = 2.0 * n * SPIN / (n * n + 1.0);
    [centre - split, centre + split]
}

/// Of two, three and four waves, to 1e-3 [1.3e-4 at rest, 2e-5 in rotation]; the two frames to 3e-5 [4.3e-6].
#[test]
fn a_thin_ring_has_bryans_frequencies_in_both_frames() {
    let comm = Session::start(&[]).unwrap();
    let [still, turning, fixed] = ["none", "rotating_frame", "fixed_frame"].map(|inertia| modes(&comm, &ring(inertia)));
    for n in [2.0, 3.0, 4.0] {
        // E I / (rho A R^4) of a thin ring.
        let thin = (210e9 * 0.002_f64.powi(2) / 12.0 / 7800.0).sqrt() / 0.01;
        let theory = thin * n * (n * n - 1.0) / (n * n + 1.0_f64).sqrt();
        let at_rest = nearest(&still, theory);
        assert_close("at rest", at_rest, theory, 1e-3);
        let [forward, backward] = bryan(n, at_rest);
        let (in_frame, seen) = (|w: f64| nearest(&turning, w), |w: f64| nearest(&fixed, w));
        assert_close("forward wave", in_frame(forward), forward, 1e-3);
        assert_close("backward wave", in_frame(backward), backward, 1e-3);
        // One ring in two frames.
        let shift = n * SPIN;
        let seen_forward = seen(forward + shift);
        assert_close("forward wave, fixed frame", seen_forward, in_frame(forward) + shift, 3e-5);
        let seen_backward = seen((backward - shift).abs());
        assert_close("backward wave, fixed frame", seen_backward, (in_frame(backward) - shift).abs(), 3e-5);
    }
    for band in [turning, fixed] {
        assert!(band.modes.iter().all(|mode| mode.growth_rate().abs() < 1e-6 * mode.lambda.norm()));
    }
}

/// The blocked search has the modes of TOAR in both frames: to 1e-9, all of the band, left vectors that solve the
/// transposed problem to 1e-10.
#[test]
fn the_blocked_search_has_gyroscopic_terms() {
    let comm = Session::start(&[]).unwrap();
    for inertia in ["rotating_frame", "fixed_frame"] {
        let brake = ring(inertia);
        let system = brake.assemble(&comm, &brake.families().unwrap()).unwrap();
        let prestress = brake.prestress().unwrap();
        let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap().with_prestress(prestress.as_ref());
        let equilibrium = sweep.equilibrium(0.0, &mut ()).unwrap();
        let by_toar = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
        sweep.search_by(EigenOptions::always_blocked());
        let blocked = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
        assert_eq!([by_toar.report.solver, blocked.report.solver], [SolverKind::Toar, SolverKind::Blocked]);
        let [exact, found] =
            [&by_toar, &blocked].map(|band| band.modes.iter().map(|mode| mode.lambda).collect::<Vec<_>>());
        assert!(found.len() == exact.len() && found.len() > 8, "{found:?} {exact:?}");
        let nearest = |z: &Complex64| exact.iter().map(|w| (w - z).norm() / z.norm()).fold(f64::INFINITY, f64::min);
        let error = found.iter().map(nearest).fold(0.0, f64::max);
        let left = sweep.left_vectors(&blocked.modes, |_| 1e-8).unwrap();
        let errors = sweep.linearise(&equilibrium, |problem| transposed_errors(problem, &found, &left)).unwrap();
        let transposed = errors.into_iter().fold(0.0, f64::max);
        println!("{inertia}: {} modes, largest error {error:.1e}, left {transposed:.1e}", found.len());
        assert!(error < 1e-9 && transposed < 1e-10, "{error} {transposed}");
    }
}

/// CalculiX's deck of a slender disc on a long axis, and what its *COMPLEX FREQUENCY, CORIOLIS finds, Hz.
const ROTOR: &str = "/usr/share/doc/calculix-ccx-test/examples/test/rotor.inp.gz";
const ROTOR_FREQUENCIES: [f64; 9] =
    [1868.105, 2313.447, 3721.268, 5546.768, 6106.517, 7168.064, 7890.561, 11041.77, 12270.98];

/// The frequencies of CalculiX's rotor, which it finds in the space of the first ten modes without Coriolis forces: in
/// that space to 6e-4 [4.3e-4], the strain of the rotation, as CalculiX updates the geometry and we do not. Below
/// 4 kHz, where ten modes are enough, in the whole space to 2e-4 [1.2e-4].
#[test]
fn the_rotor_of_calculix_has_its_frequencies() {
    let folder = tempfile::tempdir().unwrap();
    let comm = Session::start(&[]).unwrap();
    let rotor = rotor(&comm, folder.path());
    let system = rotor.assemble(&comm, &rotor.families().unwrap()).unwrap();
    let prestress = rotor.prestress().unwrap();
    let mut sweep = Sweep::new(&system, &rotor.interface, false).unwrap().with_prestress(prestress.as_ref());
    let equilibrium = sweep.equilibrium(0.0, &mut ()).unwrap();
    let whole = sweep.modes(&equilibrium, rotor.model.band, &mut ()).unwrap();
    for frequency in &ROTOR_FREQUENCIES[..3] {
        assert_close("all modes", nearest(&whole, TAU * frequency) / TAU, *frequency, 2e-4);
    }
    let projected = sweep.linearise(&equilibrium, |problem| Ok(in_ten_modes(problem, system.dofs.labels()))).unwrap();
    for frequency in ROTOR_FREQUENCIES {
        let distance = |w: &f64| (w / TAU - frequency).abs();
        let found = projected.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
        assert_close("ten modes", found / TAU, frequency, 6e-4);
    }
}

/// The deck as it stands, of all modes below 13 kHz.
fn rotor(comm: &Comm, folder: &Path) -> FullModel {
    let deck = Command::new("zcat").arg(ROTOR).output().expect("zcat").stdout;
    assert!(!deck.is_empty(), "`scripts/setup.sh --tests` installs calculix-ccx-test");
    fs::write(folder.join("rotor.inp"), deck).unwrap();
    let mut rotor = FullModel::read(comm, &folder.join("rotor.inp")).unwrap();
    assert!(rotor.model.has_prestress() && rotor.model.rotations[0].inertia == Inertia::RotatingFrame);
    rotor.model.band = [0.0, 13e3];
    rotor
}

/// The imaginary parts (rad/s) of the eigenvalues in the space of the first ten modes without C. Two of these are
/// unstable: without Coriolis forces the rotor leaves its axis.
fn in_ten_modes(problem: &QuadraticProblem, labels: Vec<u64>) -> Vec<f64> {
    let Mck { m, c, k, .. } = problem.matrices;
    let none = c.zeros_like().unwrap();
    let still = QuadraticProblem::symmetric(Mck { m, c: &none, k, g: None });
    let (mut solver, mut factor) =
        (BandSolver::new(EigenOptions::default(), labels), LabelledFactor::new(Precision::Double));
    let band = solver.solve_band(&still, &mut factor, &[0.0, 12e3].into(), &mut |_| ()).unwrap();
    // The tenth is one of a pair, of which the other is left out.
    let (pairs, last): (Vec<&Mode>, Vec<&Mode>) = band.modes.iter().partition(|mode| mode.frequency() < 11e3);
    let parts = pairs.iter().flat_map(|mode| [&mode.re, &mode.im]).chain(Some(&last[0].re));
    let columns: Vec<f64> = parts.flat_map(|part| part.to_vec().unwrap()).collect();
    let n = problem.n_local();
    let all = DMatrix::from_vec(n, columns.len() / n, columns);
    let eigen = all.tr_mul(&all).symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let kept: Vec<usize> = (0..all.ncols()).filter(|&i| eigen.eigenvalues[i] > 1e-8 * largest).collect();
    assert_eq!(kept.len(), 10);
    let space = all * eigen.eigenvectors.select_columns(&kept);
    let basis = Block::from_columns(problem.comm(), n, space.as_slice().to_vec());
    let project = |a: &Matrix| {
        let image = basis.multiplied_by(a).unwrap();
        space.tr_mul(&DMatrix::from_column_slice(n, 10, image.values()))
    };
    let [m, c, k] = [project(m), project(c), project(k)];
    let inverse = m.try_inverse().unwrap();
    let mut companion = DMatrix::zeros(20, 20);
    companion.view_mut((0, 10), (10, 10)).fill_with_identity();
    companion.view_mut((10, 0), (10, 10)).copy_from(&(-&inverse * k));
    companion.view_mut((10, 10), (10, 10)).copy_from(&(-inverse * c));
    companion.complex_eigenvalues().iter().map(|z| z.im).collect()
}
