//! Viscoelastic materials: a brake with a Maxwell lining against the model with internal variables, energies,
//! sensitivities, and what branches are followed by.
//!
//! The model is a pad on a sliding disc, pressed by a piston on a spring, all blocks. The lining follows Maxwell's law
//! of two elements; disc and spring have a loss factor each, beside Rayleigh's damping and a dashpot.
//!
//! Goal and, in brackets, measured: see each test.

use std::f64::consts::TAU;

use crate::damped_pad::{BAND, DampedPad, assembled, dense, solved};
use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Place, assert_refused, swap};
use nalgebra::DMatrix;
use num_complex::Complex64;
use squeal::analysis::{FrictionFamily, Snapshot, Sweep, explain_full};
use squeal::model::viscoelastic::ViscoelasticLaw;
use squeal::native::{Comm, Session, lapack};
use squeal::stability::{Complex, QuadraticProblem};
use squeal::tracking::Family;

pub const MATERIALS: &str = r#"
[material.iron]
young = 110e9
poisson = 0.27
density = 7100
[material.lining]
young = 4e9
poisson = 0.25
density = 2600
viscoelastic = { maxwell = [[3e9, 2e-5], [5e9, 3e-6]] }
[material.steel]
young = 200e9
poisson = 0.3
density = 7800
loss_factor = 0.01
"#;

fn damped_pad(comm: &Comm) -> DampedPad {
    DampedPad::new(comm, MATERIALS, "")
}

/// Eigenvalues with a positive imaginary part of the model with internal variables z_k at the dofs of the lining, in
/// units of 1e4/s for a balanced matrix:
///
/// ```text
/// M u'' + C u' + (K + i G + sum g_k K_m) u - sum g_k K_m z_k = 0,    tau_k z_k' + z_k = u
/// ```
fn with_internal_variables(problem: &QuadraticProblem) -> Vec<Complex64> {
    const UNIT: f64 = 1e4;
    let [own] = problem.viscoelastic.stiffnesses else { panic!("there is one law") };
    let ViscoelasticLaw::Maxwell(elements) = &own.law else { panic!("which is Maxwell's") };
    let matrices = problem.matrices.map(dense);
    let (k_m, n) = (dense(&own.stiffness), matrices.m.nrows());
    // From the reference frequency to high ones, where the dashpots are rigid.
    let at_reference = own.law.factor(Complex64::new(0.0, problem.viscoelastic.reference)).re;
    let unrelaxed = 1.0 + elements.iter().map(|element| element.ratio).sum::<f64>();
    let k = matrices.k + (unrelaxed - at_reference) * &k_m;
    let lining: Vec<usize> = (0..n).filter(|&i| k_m.row(i).amax() > 0.0).collect();
    let mass = matrices.m.cholesky().expect("the mass is positive");
    let complex = |a: DMatrix<f64>, unit: f64| (mass.solve(&a) / unit).map(Complex64::from);
    let size = 2 * n + elements.len() * lining.len();
    let mut a = DMatrix::from_element(size, size, Complex64::ZERO);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    let g = complex(matrices.g.expect("of the piston"), UNIT * UNIT);
    let k = complex(k, UNIT * UNIT) + g * Complex64::I;
    a.view_mut((n, 0), (n, n)).copy_from(&-k);
    a.view_mut((n, n), (n, n)).copy_from(&-complex(matrices.c, UNIT));
    let coupling = complex(k_m.select_columns(&lining), UNIT * UNIT);
    for (k, element) in elements.iter().enumerate() {
        let (first, rate) = (2 * n + k * lining.len(), Complex64::from(1.0 / (UNIT * element.relaxation_time)));
        a.view_mut((n, first), (n, lining.len())).copy_from(&(&coupling * Complex64::from(element.ratio)));
        for (at, &dof) in lining.iter().enumerate() {
            a[(first + at, first + at)] = -rate;
            a[(first + at, dof)] = rate;
        }
    }
    let values = lapack::eigen(a).unwrap().values;
    // Relaxations are real but for rounding, which multiple ones take half the digits from.
    values.into_iter().map(|z| z * UNIT).filter(|z| z.im > 0.1 * z.norm()).collect()
}

/// Maxwell's law with friction, loss factors, Rayleigh's damping and a dashpot: the eigenvalues of the model with
/// internal variables, all of them and to 1e-9 [6e-11]. Left vectors belong to their own mode alone in the product that
/// branches are followed by, to 1e-6 [2e-9].
#[test]
fn a_maxwell_lining_is_that_of_internal_variables() {
    let comm = Session::start(&[]).unwrap();
    let DampedPad { brake, system, equilibrium } = damped_pad(&comm);
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let band = solved(&mut sweep, &equilibrium);
    let snapshot = Snapshot::new(&mut sweep, &band, BAND[1]).unwrap();
    let exact = sweep.linearise(&equilibrium, |problem| Ok(with_internal_variables(problem))).unwrap();
    assert_eq!(exact.iter().filter(|z| z.im <= TAU * BAND[1]).count(), band.modes.len());
    let nearest = |z: &Complex64| exact.iter().map(|w| (w - z).norm() / z.norm()).fold(f64::INFINITY, f64::min);
    let error = band.modes.iter().map(|mode| nearest(&mode.lambda)).fold(0.0, f64::max);
    let backward = band.modes.iter().map(|mode| mode.backward_error).fold(0.0, f64::max);
    println!("{} modes of {} dofs, error {error:.1e} {backward:.1e}", band.modes.len(), system.dofs.n_global());
    assert!(error < 1e-9, "{error}");

    let mut none = |_: f64| unreachable!("nothing is solved for");
    let viscoelastic = &system.viscoelastic[..];
    let mut family = FrictionFamily { solutions: &mut none, m: &system.m, c: &system.c, viscoelastic };
    let products = family.products(&snapshot, &snapshot).unwrap();
    let n = products.nrows();
    let others =
        (0..n * n).filter(|at| at / n != at % n).map(|at| products[(at / n, at % n)] / products[(at / n, at / n)]);
    let largest = others.map(Complex64::norm).fold(0.0, f64::max);
    println!("largest product of two modes over that of one {largest:.1e}");
    assert!(largest < 1e-6, "{largest}");
}

/// What all sources feed and take adds up to the growth rate, to 1e-8; the lining dissipates; the sensitivity to its
/// mass is the derivative with its density, to 1e-5 [2e-6].
#[test]
fn energies_balance_and_sensitivities_are_derivatives() {
    let comm = Session::start(&[]).unwrap();
    let DampedPad { mut brake, system, equilibrium } = damped_pad(&comm);
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let band = solved(&mut sweep, &equilibrium);
    let left = sweep.left_vectors(&band.modes, |_| 1e-9).unwrap();
    let mut derivatives = Vec::new();
    for (i, mode) in band.modes.iter().enumerate() {
        let (re, im) = (left.vector(2 * i).unwrap(), left.vector(2 * i + 1).unwrap());
        let left = Some(Complex { re: &re, im: &im });
        let sources = explain_full(&brake, &mut sweep, &equilibrium, mode, left).unwrap();
        let sum: f64 = sources.iter().map(|own| own.share.energy_input + own.share.dissipation).sum();
        assert!((sum - mode.growth_rate()).abs() < 1e-8 * mode.lambda.norm(), "{sum} {}", mode.growth_rate());
        let pad = sources.iter().find(|own| own.name == "pad").unwrap();
        assert!(pad.share.dissipation < 0.0);
        derivatives.push(pad.sensitivity.unwrap().mass);
    }
    let pad = brake.model.parts.iter().position(|part| part.name == "pad").unwrap();
    let mut at = |factor: f64| {
        brake.model.parts[pad].material.density = 2600.0 * factor;
        let system = assembled(&comm, &brake);
        let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
        let band = solved(&mut sweep, &equilibrium);
        band.modes.iter().map(|mode| mode.lambda).collect::<Vec<_>>()
    };
    let (above, below) = (at(1.002), at(0.998));
    let differences = derivatives
        .iter()
        .zip(above.iter().zip(&below))
        .zip(&band.modes)
        .map(|((found, (a, b)), mode)| (found - (a - b) / 0.004).norm() / mode.lambda.norm());
    let largest = differences.fold(0.0, f64::max);
    println!("largest difference of a sensitivity {largest:.1e}");
    assert!(largest < 1e-5, "{largest}");
}

/// The modes of a sweep are followed, and the summary has their backward error. What has one stiffness whatever the
/// frequency refuses the model, and says what to do.
#[test]
fn a_brake_is_analysed_and_what_has_one_stiffness_is_refused() {
    let lining = "[material.lining]\nyoung = 9e9\npoisson = 0.25\ndensity = 2600\n\
                  viscoelastic = { unrelaxed = 20e9, relaxation_time = 1e-6, order = 0.6 }\n[part.disc]";
    let change = |text: String| {
        let text = swap(&text, "[part.disc]", lining);
        swap(&text, "[part.pad]\nmaterial = \"iron\"", "[part.pad]\nmaterial = \"lining\"")
    };
    let place = Place::with_blocks(change, &PadOnDisc::default());
    let finished = place.run(&["stability", "brake.toml", "--friction", "0.2:0.4:0.1", "-o", "run"]);
    assert_eq!(finished.code, 0, "{}{}", finished.out, finished.err);
    assert!(finished.out.contains("each mode has the stiffness of its own frequency, largest backward error"));
    assert!(!finished.out.contains("not confirmed"), "{}", finished.out);
    for arguments in [
        &["modes", "brake.toml", "--part", "pad", "-o", "part"][..],
        &["export", "brake.toml", "--friction", "0.3", "-o", "matrices"],
    ] {
        let finished = place.run(arguments);
        println!("{arguments:?}: {}", finished.err);
        assert_refused(&finished, &["viscoelastic", "Give the material a young and a loss_factor"]);
    }
    let finished = place.run(&["reduce", "brake.toml", "--contacts", "4", "-o", "brake.se.h5"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let finished = place.run(&["stability", "brake.se.h5", "--friction", "0.3", "-o", "reduced"]);
    assert!(finished.out.contains("each mode has the stiffness of its own frequency"), "{}", finished.out);
    let finished = place.run(&["export", "brake.se.h5", "--friction", "0.3", "-o", "matrices"]);
    assert_refused(&finished, &["the super-element has viscoelastic materials"]);
}
