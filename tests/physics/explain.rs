//! What explains a mode, on the two pads on a disc (tests/validation/pads_on_disc.rs) with damping.
//!
//! Energies are sums over elements and contact points, eigenvalues come from the assembled matrices: that the two fit
//! is the test. Sensitivities are held against central differences of the eigenvalue at the same equilibrium.
//!
//! In brackets: what was measured.

use crate::support::{assert_close, data};
use num_complex::Complex64;
use squeal::analysis::{Snapshot, Sweep, explain_full};
use squeal::assembly::System;
use squeal::contact::Tangential;
use squeal::equilibrium::Equilibrium;
use squeal::model::{Inertia, Rayleigh};
use squeal::native::{Comm, Session};
use squeal::results::{Kind, Source};
use squeal::stability::{Band, Complex, Mode};
use squeal::structure::FullModel;

const BAND: [f64; 2] = [0.0, 1500.0];
const FRICTION: f64 = 0.4;

fn damped(comm: &Comm) -> FullModel {
    let mut brake = FullModel::read(comm, &data("pads_on_disc.toml")).unwrap();
    for (i, part) in brake.model.parts.iter_mut().enumerate() {
        let (is_disc, is_lining) = (part.name == "disc", part.name.starts_with("lining"));
        let alpha = if is_lining { 100.0 } else { 4.0 + i as f64 };
        part.rayleigh = Rayleigh { alpha, beta: if is_disc { 1e-7 } else { 0.0 } };
    }
    // A faster disc, so that friction damping is one source among others.
    for point in &mut brake.interface.points {
        let Tangential::Sliding { speed, .. } = &mut point.law.tangential else { panic!("both pairs slide") };
        *speed *= 100.0;
    }
    brake
}

fn assembled(comm: &Comm, brake: &FullModel) -> System {
    brake.assemble(comm, &brake.families().unwrap()).unwrap()
}

/// The mode of largest growth rate: one of the pair at 1270 Hz that flutters without damping.
fn worst(band: &Band) -> usize {
    let growth = |&i: &usize| band.modes[i].growth_rate();
    (0..band.modes.len()).max_by(|i, j| growth(i).total_cmp(&growth(j))).unwrap()
}

/// That mode's eigenvalue of a changed brake at an equilibrium that is given.
fn eigenvalue(comm: &Comm, brake: &FullModel, equilibrium: &Equilibrium) -> Complex64 {
    let system = assembled(comm, brake);
    let mut sweep = Sweep::new(&system, &brake.interface, true).unwrap();
    let band = sweep.modes(equilibrium, BAND, &mut ()).unwrap();
    band.modes[worst(&band)].lambda
}

fn source<'a>(sources: &'a [Source], name: &str) -> &'a Source {
    sources.iter().find(|source| source.name == name).unwrap()
}

#[test]
fn energies_balance_and_sensitivities_are_derivatives() {
    explain(damped, &["disc", "lining_inner"]);
}

/// Gyroscopic terms do no work, and are in the left vectors' self-product.
#[test]
fn the_same_holds_where_the_disc_has_inertia_forces() {
    let turning = |comm: &Comm| {
        let mut brake = damped(comm);
        (brake.model.rotations[0].inertia, brake.model.rotations[0].speed) = (Inertia::FixedFrame, 500.0);
        brake
    };
    explain(turning, &[]);
}

/// Explains all modes, and differentiates one by friction and by constants of some parts.
fn explain(damped: impl Fn(&Comm) -> FullModel, parts: &[&str]) {
    let comm = Session::start(&[]).unwrap();
    let brake = damped(&comm);
    let system = assembled(&comm, &brake);
    let mut sweep = Sweep::new(&system, &brake.interface, true).unwrap();
    let equilibrium = sweep.equilibrium(FRICTION, &mut ()).unwrap();
    let band = sweep.modes(&equilibrium, BAND, &mut ()).unwrap();
    let snapshot = Snapshot::new(&mut sweep, &band, BAND[1]).unwrap();
    for (i, mode) in band.modes.iter().enumerate() {
        let [re, im] = snapshot.left(i).unwrap();
        let left = Complex { re: &re, im: &im };
        let sources = explain_full(&brake, &mut sweep, &equilibrium, mode, Some(left)).unwrap();
        balance(mode, &sources);
        if i == worst(&band) {
            differences(&sources, equilibrium.friction, parts, |change| {
                let mut brake = damped(&comm);
                let mut equilibrium = Equilibrium {
                    u: equilibrium.u.duplicate().unwrap(),
                    responses: equilibrium.responses.clone(),
                    friction: equilibrium.friction,
                    steps: Vec::new(),
                };
                change(&mut brake, &mut equilibrium);
                eigenvalue(&comm, &brake, &equilibrium)
            });
        }
    }
}

/// Shares add up to 1 to 1e-12 by their definition; energy input less dissipation is the growth rate to 1e-6 of what
/// passes [2e-9].
fn balance(mode: &Mode, sources: &[Source]) {
    let sum = |of: fn(&Source) -> f64| sources.iter().map(of).sum::<f64>();
    assert_close("kinetic energy", sum(|s| s.share.kinetic), 1.0, 1e-12);
    assert_close("strain energy", sum(|s| s.share.strain), 1.0, 1e-12);
    let (input, dissipation) = (sum(|s| s.share.energy_input), sum(|s| s.share.dissipation));
    let error = (input + dissipation - mode.growth_rate()).abs() / (input.abs() + dissipation.abs());
    println!(
        "{:.1} Hz: energy input {input:+.6e}, dissipation {dissipation:+.6e}, growth {:+.6e}: off by {error:.1e}",
        mode.frequency(),
        mode.growth_rate()
    );
    assert!(error < 1e-6);
    for source in sources {
        let Source { kind, share, .. } = source;
        assert!(share.dissipation <= 0.0 && share.kinetic >= 0.0, "{source:?}");
        assert!(
            *kind == Kind::Contact || share.energy_input.abs() < 1e-9 * input.abs().max(1.0),
            "only contact has energy input: {source:?}"
        );
    }
}

/// `|dlambda - (lambda_+ - lambda_-) / 2h| < 1e-5 |dlambda|` [4e-6] for friction, and for damping and stiffness of the
/// disc and a lining.
fn differences(
    sources: &[Source],
    friction: f64,
    parts: &[&str],
    solve: impl Fn(&mut dyn FnMut(&mut FullModel, &mut Equilibrium)) -> Complex64,
) {
    let check = |what: &str, exact: Complex64, h: f64, change: &dyn Fn(f64, &mut FullModel, &mut Equilibrium)| {
        let [plus, minus] = [h, -h].map(|h| solve(&mut |brake, equilibrium| change(h, brake, equilibrium)));
        let found = (plus - minus) / (2.0 * h);
        let error = (found - exact).norm() / exact.norm();
        println!("{what}: {exact:.6e}, by differences {found:.6e}: off by {error:.1e}");
        assert!(error < 1e-5);
    };
    let by_friction = sources.iter().filter_map(|source| source.friction).sum();
    check("friction", by_friction, 4e-4, &|h, _, equilibrium| equilibrium.friction = friction + h);
    let part = |brake: &mut FullModel, name: &str| brake.model.parts.iter().position(|part| part.name == name).unwrap();
    for &name in parts {
        let exact = source(sources, name).sensitivity.unwrap();
        check(&format!("damping of {name}"), exact.damping, 0.05, &|h, brake, _| {
            let i = part(brake, name);
            let Rayleigh { alpha, beta } = brake.model.parts[i].rayleigh;
            brake.model.parts[i].rayleigh = Rayleigh { alpha: (1.0 + h) * alpha, beta: (1.0 + h) * beta };
        });
        check(&format!("stiffness of {name}"), exact.stiffness, 1e-3, &|h, brake, _| {
            let i = part(brake, name);
            let part = &mut brake.model.parts[i];
            part.material.elasticity.as_flattened_mut().iter_mut().for_each(|x| *x *= 1.0 + h);
            part.rayleigh.beta /= 1.0 + h;
        });
    }
}
