//! A Galerkin super-element of two pads on a disc against an independent program's eigenvalues of full contact: see
//! `tests/validation/pads_on_disc.rs` for the model.
//!
//! Goal and, in brackets, what was measured, relative to the moduli: eigenvalues at the samples to 1e-8 [5e-9], the
//! accuracy of the reference; between them to 1e-5 [2e-6].

use num_complex::Complex64;
use serde_json::Value;
use squeal::analysis::{GalerkinOptions, StabilityOptions, reduce_galerkin, stability};
use squeal::native::{Comm, Session};
use squeal::reduction::super_element::Sample;
use squeal::results::CertifiedMode;
use squeal::structure::{FullModel, StructureOptions};
use squeal::{Results, Structure};

use crate::support::data;

/// Samples of the modes, and values at which equilibria alone join the basis.
const SAMPLES: [f64; 2] = [0.2, 0.6];
const BETWEEN: [f64; 2] = [0.3, 0.5];
/// Hz: the lower half of the reference's modes, among them an instability.
const BAND: [f64; 2] = [0.0, 3000.0];

/// Around the instability, Hz.
const AROUND_INSTABILITY: [f64; 2] = [1000.0, 1500.0];

/// Parts and contacts of the super-element have the shares of the full model in its unstable mode at 0.6, whose vector
/// is as exact as the basis, to 1e-5.
fn same_shares(full: &Results, reduced: &Results) {
    let sources = |results: &Results| {
        let (_, _, mode) = results.modes().find(|(friction, _, mode)| *friction == 0.6 && mode.unstable).unwrap();
        mode.sources.clone()
    };
    let (expected, found) = (sources(full), sources(reduced));
    assert!(expected.len() > 3 && expected.len() == found.len());
    for (expected, found) in expected.iter().zip(&found) {
        assert_eq!((expected.kind, &expected.name), (found.kind, &found.name));
        let (a, b) = (expected.share, found.share);
        let errors = [a.kinetic - b.kinetic, a.strain - b.strain, (a.energy_input - b.energy_input) / 1e3];
        println!("{}: {errors:?}", found.name);
        assert!(errors.iter().all(|error| error.abs() < 1e-5), "{expected:?} {found:?}");
    }
}

/// Compared with its full model, the super-element has the errors that it has against the reference: at a sample next
/// to none, between the samples some; and the correction takes most of them away.
fn certified(comm: &Comm, reduced: &Structure, reference: &Value) {
    let options = StabilityOptions {
        friction_values: Some(vec![0.4, 0.6]),
        branches: false,
        certify: Some(data("pads_on_disc.toml")),
        ..StabilityOptions::default()
    };
    let results = stability(comm, reduced, &options, &mut ()).unwrap();
    for value in &results.values {
        let certificate = value.certificate.as_ref().unwrap();
        assert_eq!(certificate.modes.len(), value.modes.len());
        let worst = |of: fn(&CertifiedMode) -> Complex64| {
            let error = |e: &Complex64| {
                let distance = |mode: &&CertifiedMode| (mode.lambda - e).norm();
                let nearest = certificate.modes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
                (of(nearest) - e).norm() / e.norm()
            };
            eigenvalues(reference, value.friction).iter().map(error).fold(0.0, f64::max)
        };
        let [before, after] = [worst(|mode| mode.lambda), worst(|mode| mode.corrected)];
        println!(
            "friction {}: {before:.1e}, corrected {after:.1e}; equilibrium {:.1e}, backward {:.1e}",
            value.friction,
            certificate.equilibrium_error,
            certificate.backward_error()
        );
        let is_sample = SAMPLES.contains(&value.friction);
        assert!(after < if is_sample { 2e-7 } else { 0.6 * before }, "{before:e} {after:e}");
    }
}

fn eigenvalues(reference: &Value, friction: f64) -> Vec<Complex64> {
    let all = reference["results"][format!("{friction:.1}")]["eigenvalues"].as_array().unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let of = |e: &Value| Complex64::new(number(&e["real"]), std::f64::consts::TAU * number(&e["frequency_hz"]));
    all.iter().map(of).filter(|z| z.im < std::f64::consts::TAU * BAND[1]).collect()
}

/// The largest distance of an eigenvalue of the reference, which has the 24 lowest, from the nearest mode, relative to
/// its modulus.
fn error(results: &Results, reference: &Value, friction: f64) -> f64 {
    let value = results.values.iter().find(|value| value.friction == friction).unwrap();
    let distance = |e: Complex64| value.modes.iter().map(|m| (m.lambda - e).norm()).fold(f64::INFINITY, f64::min);
    let error = eigenvalues(reference, friction).into_iter().map(|e| distance(e) / e.norm()).fold(0.0, f64::max);
    println!("friction {friction}: eigenvalues off by {error:.1e}");
    error
}

#[test]
fn a_galerkin_super_element_has_the_eigenvalues_of_full_contact() {
    let comm = Session::start(&[]).unwrap();
    let reference: Value = serde_json::from_str(&std::fs::read_to_string(data("pads_on_disc.json")).unwrap()).unwrap();
    let mut model = FullModel::read(&comm, &data("pads_on_disc.toml")).unwrap();
    model.model.band = BAND;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("pads.se.h5");
    let options = GalerkinOptions {
        modes: SAMPLES.map(Sample::at).to_vec(),
        equilibria: BETWEEN.map(Sample::at).to_vec(),
        negligible: 1e-6,
        keep_basis: true,
        ..GalerkinOptions::over(&SAMPLES, file.clone())
    };
    let reduction = reduce_galerkin(&comm, &model, &options, &mut ()).unwrap();
    println!("{} coordinates: {:?}", reduction.element.n_coordinates(), reduction.report);
    assert!(reduction.element.n_coordinates() < 400);
    assert_eq!(reduction.element.contacts.len(), 236);

    let reduced = Structure::read(&comm, &file, &StructureOptions::default()).unwrap();
    let friction_values = Some(vec![0.2, 0.4, 0.6]);
    let options = StabilityOptions { friction_values, branches: false, ..StabilityOptions::default() };
    let results = stability(&comm, &reduced, &options, &mut ()).unwrap();
    for (friction, tolerance) in [(0.2, 1e-8), (0.6, 1e-8), (0.4, 1e-5)] {
        assert!(error(&results, &reference, friction) < tolerance, "at {friction}");
    }
    certified(&comm, &reduced, &reference);
    let full = StabilityOptions { friction_values: Some(vec![0.6]), band: Some(AROUND_INSTABILITY), ..options };
    let full = stability(&comm, &Structure::Full(Box::new(model)), &full, &mut ()).unwrap();
    same_shares(&full, &results);
}
