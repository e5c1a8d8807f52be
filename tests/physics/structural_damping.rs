//! Structural damping, `K (1 + i g)`: exact eigenvalues of one material, and a dense complex solver.
//!
//! The model of four loss factors is a pad on a sliding disc, pressed by a piston on a spring, all blocks: three
//! materials and the spring have a loss factor each, beside Rayleigh's damping and a dashpot.
//!
//! Goal and, in brackets, measured: see each test.

use std::f64::consts::PI;

use crate::damped_pad::{BAND, DampedPad, assembled, dense, solved};
use crate::support::block::add_block;
use crate::support::{assert_close, brake};
use nalgebra::DMatrix;
use num_complex::Complex64;
use squeal::analysis::{Snapshot, Sweep, explain_full};
use squeal::equilibrium::LabelledFactor;
use squeal::mesh::Mesh;
use squeal::native::{Comm, Matrix, Mck, Precision, Session, lapack};
use squeal::stability::{BandSolver, Complex, EigenOptions, QuadraticProblem};

const ROD: &str = r#"
[material.steel]
young = 200e9
poisson = 0.0
density = 8000
loss_factor = 0.1
[part.rod]
material = "steel"
[[fix]]
nodes = "rod_x0"
axes = "xyz"
[[fix]]
nodes = "rod_y0"
axes = "yz"
[[fix]]
nodes = "rod_y1"
axes = "yz"
[[fix]]
nodes = "rod_z0"
axes = "yz"
[[fix]]
nodes = "rod_z1"
axes = "yz"
[stability]
band = [0, 120000]
"#;

/// All modes of a system without contact below 120 kHz.
fn eigenvalues(problem: &QuadraticProblem, labels: Vec<u64>) -> Vec<Complex64> {
    let (mut solver, mut factor) =
        (BandSolver::new(EigenOptions::default(), labels), LabelledFactor::new(Precision::Double));
    let band = solver.solve_band(problem, &mut factor, &[0.0, 120e3].into(), &mut |_| ()).unwrap();
    assert!(band.count.agrees());
    band.modes.iter().map(|mode| mode.lambda).collect()
}

/// A loss factor turns every eigenvalue `i omega` of a single material into `i omega sqrt(1 + i g)`, to 1e-9 [3e-13];
/// the first of the rod is `i pi / (2 L) sqrt(E (1 + i g) / rho)`, to 1e-4, the error of its elements [3e-7].
#[test]
fn one_material_turns_every_eigenvalue_by_its_loss_factor() {
    let comm = Session::start(&[]).unwrap();
    let mut mesh = Mesh::default();
    add_block(&mut mesh, "rod", [10, 1, 1], [0.0; 3], [100.0, 5.0, 5.0]);
    let rod = brake(ROD, mesh);
    let system = rod.assemble(&comm, &rod.families().unwrap()).unwrap();
    let solve = |matrices: Mck<&Matrix>| eigenvalues(&QuadraticProblem::symmetric(matrices), system.dofs.labels());
    let (elastic, found) = (solve(Mck { g: None, ..system.matrices() }), solve(system.matrices()));
    let turn = Complex64::new(1.0, 0.1).sqrt();
    assert!(elastic.len() >= 3 && elastic.len() == found.len(), "{elastic:?} {found:?}");
    let error = elastic.iter().zip(&found).map(|(z, w)| (w / z - turn).norm()).fold(0.0, f64::max);
    println!("{} modes, largest error {error:.1e}", found.len());
    assert!(error < 1e-9, "{error}");
    let rods = Complex64::I * PI / 0.2 * (200e9 * Complex64::new(1.0, 0.1) / 8000.0).sqrt();
    assert!((found[0] / rods - 1.0).norm() < 1e-4, "{} {rods}", found[0]);
}

const MATERIALS: &str = r#"
[material.iron]
young = 110e9
poisson = 0.27
density = 7100
loss_factor = 0.002
[material.lining]
young = 9e9
poisson = 0.25
density = 2600
loss_factor = 0.1
[material.steel]
young = 200e9
poisson = 0.3
density = 7800
loss_factor = 0.01
"#;

fn damped_pad(comm: &Comm) -> DampedPad {
    DampedPad::new(comm, MATERIALS, "loss_factor = 0.3\n")
}

/// Eigenvalues of `[0 I; -M^-1 (K + i G), -M^-1 C]` with a positive imaginary part, in units of 1e4/s for a balanced
/// matrix.
fn dense_eigenvalues(problem: &QuadraticProblem) -> Vec<Complex64> {
    const UNIT: f64 = 1e4;
    let Mck { m, c, k, g } = problem.matrices.map(dense);
    let (n, g) = (m.nrows(), g.expect("there are loss factors"));
    let mass = m.cholesky().expect("the mass is positive");
    let [c, k, g] = [(c, UNIT), (k, UNIT * UNIT), (g, UNIT * UNIT)].map(|(a, unit)| -mass.solve(&a) / unit);
    let mut companion = DMatrix::from_element(2 * n, 2 * n, Complex64::ZERO);
    companion.view_mut((0, n), (n, n)).fill_with_identity();
    companion.view_mut((n, 0), (n, n)).copy_from(&k.zip_map(&g, Complex64::new));
    companion.view_mut((n, n), (n, n)).copy_from(&c.map(Complex64::from));
    let values = lapack::eigen(companion).unwrap().values;
    values.into_iter().map(|z| z * UNIT).filter(|z| z.im > 1.0).collect()
}

/// Four loss factors, Rayleigh's damping, a dashpot and friction: the eigenvalues of a dense complex solver to 1e-9
/// [2e-11], left vectors that solve the transposed problem and belong to their own mode alone in the product that
/// branches are followed by, to 1e-6 [6e-11].
#[test]
fn four_loss_factors_give_what_a_dense_complex_solver_gives() {
    let comm = Session::start(&[]).unwrap();
    let DampedPad { brake, system, equilibrium } = damped_pad(&comm);
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let band = solved(&mut sweep, &equilibrium);
    let exact = sweep.linearise(&equilibrium, |problem| Ok(dense_eigenvalues(problem))).unwrap();
    let n_within = exact.iter().filter(|z| z.im <= 2.0 * PI * BAND[1]).count();
    assert_eq!(n_within, band.modes.len());
    let nearest = |z: &Complex64| exact.iter().map(|w| (w - z).norm() / z.norm()).fold(f64::INFINITY, f64::min);
    let error = band.modes.iter().map(|mode| nearest(&mode.lambda)).fold(0.0, f64::max);
    println!("{} modes of {} dofs, largest error {error:.1e}", band.modes.len(), system.dofs.n_global());
    assert!(error < 1e-9, "{error}");

    solved(&mut sweep, &equilibrium);
    let left = sweep.left_vectors(&band.modes, |_| 1e-8).unwrap();
    let right = sweep.right_vectors(&band.modes).unwrap();
    let complex = |block: &squeal::native::Block| {
        DMatrix::from_fn(block.n_local(), band.modes.len(), |row, i| {
            Complex64::new(block.column(2 * i)[row], block.column(2 * i + 1)[row])
        })
    };
    let (y, x) = (complex(&left), complex(&right));
    let [m, c] = [&system.m, &system.c].map(|a| y.adjoint() * dense(a).map(Complex64::from) * &x);
    let product = |i: usize, j: usize| (band.modes[i].lambda + band.modes[j].lambda) * m[(i, j)] + c[(i, j)];
    let own = |i: usize| product(i, i).norm();
    let n = band.modes.len();
    let others = (0..n * n).filter(|at| at / n != at % n).map(|at| product(at / n, at % n).norm() / own(at / n));
    let largest = others.fold(0.0, f64::max);
    println!("largest product of two modes over that of one {largest:.1e}");
    assert!(largest < 1e-6, "{largest}");
}

/// What all sources feed and take adds up to the growth rate, to 1e-8; loss factors alone dissipate in the pad, and
/// most in the mode that strains it; the sensitivity to a part's damping is the derivative with its loss factor, to
/// 1e-5.
#[test]
fn energies_balance_and_sensitivities_are_derivatives() {
    let comm = Session::start(&[]).unwrap();
    let DampedPad { mut brake, system, equilibrium } = damped_pad(&comm);
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let band = solved(&mut sweep, &equilibrium);
    let snapshot = Snapshot::new(&mut sweep, &band, BAND[1]).unwrap();
    assert_eq!(snapshot.spectrum().lambdas.len(), band.modes.len(), "no conjugates are followed");
    let left = sweep.left_vectors(&band.modes, |_| 1e-9).unwrap();
    let mut derivatives = Vec::new();
    for (i, mode) in band.modes.iter().enumerate() {
        let (re, im) = (left.vector(2 * i).unwrap(), left.vector(2 * i + 1).unwrap());
        let left = Some(Complex { re: &re, im: &im });
        let sources = explain_full(&brake, &mut sweep, &equilibrium, mode, left).unwrap();
        let sum: f64 = sources.iter().map(|own| own.share.energy_input + own.share.dissipation).sum();
        assert!((sum - mode.growth_rate()).abs() < 1e-8 * mode.lambda.norm(), "{sum} {}", mode.growth_rate());
        let of = |name: &str| sources.iter().find(|own| own.name == name).unwrap();
        assert!(of("pad").share.dissipation < 0.0 && of("pin").share.dissipation < 0.0);
        derivatives.push(of("pad").sensitivity.unwrap().damping);
    }
    let pad = brake.model.parts.iter().position(|part| part.name == "pad").unwrap();
    let mut at = |factor: f64| {
        brake.model.parts[pad].material.loss_factor = 0.1 * factor;
        let system = assembled(&comm, &brake);
        let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
        let band = solved(&mut sweep, &equilibrium);
        band.modes.iter().map(|mode| mode.lambda).collect::<Vec<_>>()
    };
    let (above, below) = (at(1.002), at(0.998));
    for (i, found) in derivatives.iter().enumerate() {
        let exact = (above[i] - below[i]) / 0.004;
        assert!((found - exact).norm() < 1e-5 * band.modes[i].lambda.norm(), "{found} {exact}");
    }
    assert_close("largest", derivatives[0].norm(), ((above[0] - below[0]) / 0.004).norm(), 1e-2);
}
