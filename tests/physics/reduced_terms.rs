//! Super-elements of a brake with a Maxwell lining and of one with prestress against the models that they reduce: the
//! pad of [`crate::damped_pad`], with loss factors, Rayleigh's damping and a dashpot.
//!
//! Goal and, in brackets, measured: see each test.

use crate::damped_pad::{FRICTION, solved, text};
use crate::super_element::largest_error;
use crate::support::{assert_close, brake, pressed_pad};
use crate::viscoelastic::MATERIALS;
use num_complex::Complex64;
use squeal::Structure;
use squeal::analysis::{GalerkinOptions, StabilityOptions, Sweep, explain, reduce_galerkin, stability};
use squeal::native::{Comm, Session};
use squeal::reduction::file;
use squeal::results::Source;
use squeal::stability::Complex;
use squeal::structure::{FullModel, StructureOptions};
use tempfile::TempDir;

const N_CONTACTS: usize = 4;

/// The brake, its mesh file a place of the folder.
fn model(folder: &TempDir, text: &str) -> FullModel {
    let mut brake = brake(text, pressed_pad::mesh([2, 2, 1]));
    brake.model.mesh_file = folder.path().join("pad.msh");
    std::fs::write(&brake.model.mesh_file, "").unwrap();
    brake
}

/// Eigenvalues of a structure at a friction value, and what explains the first mode.
pub fn solution(comm: &Comm, structure: &Structure, friction: f64) -> (Vec<Complex64>, Vec<Source>) {
    let (system, prestress) = (structure.assemble(comm).unwrap(), structure.prestress().unwrap());
    let mut sweep = Sweep::of(structure, &system, prestress.as_ref()).unwrap();
    let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
    let band = solved(&mut sweep, &equilibrium);
    let left = sweep.left_vectors(&band.modes, |_| 1e-9).unwrap();
    let (re, im) = (left.vector(0).unwrap(), left.vector(1).unwrap());
    let left = Some(Complex { re: &re, im: &im });
    let sources = explain(structure, &mut sweep, &equilibrium, &band.modes[0], left).unwrap();
    (band.modes.iter().map(|mode| mode.lambda).collect(), sources)
}

/// The super-element of a full model as its file has it, made at [`FRICTION`].
pub fn reduced(comm: &Comm, folder: &TempDir, full: &Structure, limit: f64) -> Structure {
    let Structure::Full(model) = full else { panic!("a model") };
    let system = full.assemble(comm).unwrap();
    let equilibrium = Sweep::new(&system, &model.interface, false).unwrap().equilibrium(FRICTION, &mut ()).unwrap();
    let (element, surface, _) = model.reduce(comm, &system, &equilibrium, limit, &mut |_| ()).unwrap();
    let path = folder.path().join("pad.se.h5");
    file::write(&path, &element, &surface, None).unwrap();
    Structure::read(comm, &path, &StructureOptions::default()).unwrap()
}

/// With reference contacts.
pub fn with_contacts(folder: &TempDir, text: &str) -> Structure {
    let mut model = model(folder, text);
    model.reduce_contacts(N_CONTACTS).unwrap();
    Structure::Full(Box::new(model))
}

/// A Maxwell lining in a super-element, with all modes kept: its model's eigenvalues to 1e-9 [3e-11], at any friction
/// value; with those below 130 kHz to 1e-4 [6e-6]. Shares and sensitivities of the parts in the first mode, all modes
/// kept, to 1e-6.
#[test]
fn a_maxwell_lining_is_in_the_super_element() {
    let (comm, folder) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let full = with_contacts(&folder, &text(MATERIALS, ""));
    let exact = [FRICTION, 0.2].map(|friction| solution(&comm, &full, friction));
    for (limit, allowed) in [(f64::INFINITY, 1e-9), (130e3, 1e-4)] {
        let element = reduced(&comm, &folder, &full, limit);
        for (friction, (exact, sources)) in [FRICTION, 0.2].into_iter().zip(&exact) {
            let (found, own) = solution(&comm, &element, friction);
            let error = largest_error(&found, exact);
            println!("limit {limit}, friction {friction}: {} modes, largest error {error:.1e}", found.len());
            assert!(error < allowed, "{error} up to {limit} Hz");
            if limit.is_infinite() {
                same_sources(&own, sources);
            }
        }
    }
}

/// The parts have the same shares and sensitivities, to 1e-6.
fn same_sources(found: &[Source], exact: &[Source]) {
    let parts = |sources: &[Source]| sources.iter().take(3).cloned().collect::<Vec<_>>();
    for (found, exact) in parts(found).iter().zip(&parts(exact)) {
        assert_eq!(found.name, exact.name);
        let scale = exact.sensitivity.unwrap().mass.norm().max(1.0);
        let sensitivities = [found, exact].map(|own| own.sensitivity.unwrap());
        assert!((sensitivities[0].mass - sensitivities[1].mass).norm() < 1e-6 * scale);
        assert!((found.share.strain - exact.share.strain).abs() < 1e-6);
        let [a, b] = [found, exact].map(|own| own.share.dissipation);
        assert!((a - b).abs() < 1e-6 * b.abs().max(1.0), "{a} {b}");
    }
}

/// Prestress of a fast disc and of the pressed pad, frozen at the equilibrium of the reduction: there the model's
/// eigenvalues to 1e-9 with all modes kept, to 1e-3 with those below 130 kHz; at half the friction value they differ by
/// less than half of what prestress does [a fifth].
#[test]
fn prestress_is_frozen_in_the_super_element() {
    let (comm, folder) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let materials = MATERIALS.replace("viscoelastic", "# viscoelastic");
    let fast = text(&materials, "").replace("speed = ", "inertia = \"fixed_frame\"\nspeed = 3e3 # ");
    let without = fast.replace("[stability]", "[stability]\nprestress = false");
    let (full, bare) = (with_contacts(&folder, &fast), with_contacts(&folder, &without));
    let exact = [FRICTION, 0.2].map(|friction| solution(&comm, &full, friction).0);
    let effect = largest_error(&exact[0], &solution(&comm, &bare, FRICTION).0);
    for (limit, allowed) in [(f64::INFINITY, 1e-9), (130e3, 1e-3)] {
        let element = reduced(&comm, &folder, &full, limit);
        let errors = [0, 1].map(|i| largest_error(&solution(&comm, &element, [FRICTION, 0.2][i]).0, &exact[i]));
        println!("limit {limit}: largest errors {errors:?}, effect of prestress {effect:.1e}");
        assert!(effect > 1e-4 && errors[0] < allowed, "{errors:?} up to {limit} Hz");
        if limit.is_infinite() {
            assert!(errors[1] > 1e-6 && errors[1] < 0.5 * effect, "{errors:?}");
        }
    }
}

/// A load factor multiplies the piston's force, and not gravity (here of 1e5 m/s2): the contact force of both kinds of
/// super-element under 1.5 times the loads is that of the model with 1.5 times the force.
#[test]
fn a_load_factor_leaves_gravity_as_it_is() {
    let (comm, folder) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let heavy = text(MATERIALS, "").replace("[stability]", "[[load]]\ngravity = [0, 0, -1e5]\n[stability]");
    let pressed = heavy.replace("-1000]", "-1500]");
    let force = |structure: &Structure| {
        let system = structure.assemble(&comm).unwrap();
        let equilibrium = Sweep::of(structure, &system, None).unwrap().equilibrium(FRICTION, &mut ()).unwrap();
        equilibrium.responses.iter().map(|response| response.normal_force).sum::<f64>()
    };
    let path = folder.path().join("pad.se.h5");
    let scaled = || {
        let options = StructureOptions { load_factor: 1.5, ..StructureOptions::default() };
        Structure::read(&comm, &path, &options).unwrap()
    };
    reduced(&comm, &folder, &with_contacts(&folder, &heavy), f64::INFINITY);
    assert_close("retained contacts", force(&scaled()), force(&with_contacts(&folder, &pressed)), 1e-6);
    let options = GalerkinOptions { force: true, ..GalerkinOptions::over(&[FRICTION], path.clone()) };
    reduce_galerkin(&comm, &model(&folder, &heavy), &options, &mut ()).unwrap();
    let full = Structure::Full(Box::new(model(&folder, &pressed)));
    assert_close("all contacts", force(&scaled()), force(&full), 1e-6);
}

/// The Maxwell lining in a Galerkin super-element of all contact points: eigenvalues at the samples to 1e-8 [7e-11],
/// between them to 2e-3 [1e-3], of which the correction of its own test takes a part [a fifth]: it answers with the
/// stiffness at rest.
#[test]
fn a_galerkin_super_element_has_the_maxwell_lining() {
    let (comm, folder) = (Session::start(&[]).unwrap(), TempDir::new().unwrap());
    let full = model(&folder, &text(MATERIALS, ""));
    let path = folder.path().join("pad.se.h5");
    let options = GalerkinOptions { negligible: 1e-6, ..GalerkinOptions::over(&[0.2, 0.6], path.clone()) };
    let reduction = reduce_galerkin(&comm, &full, &options, &mut ()).unwrap();
    let element = Structure::read(&comm, &path, &StructureOptions::default()).unwrap();
    let full = Structure::Full(Box::new(full));
    let exact = [0.2, 0.6, FRICTION].map(|friction| solution(&comm, &full, friction).0);
    let found = [0.2, 0.6, FRICTION].map(|friction| solution(&comm, &element, friction).0);
    let errors = [0, 1, 2].map(|i| largest_error(&found[i], &exact[i]));
    println!("{} coordinates: {errors:?}", reduction.element.n_coordinates());
    assert!(errors[0] < 1e-8 && errors[1] < 1e-8 && errors[2] < 2e-3, "{errors:?}");
    let certificate = &reduction.certificates[0];
    let there = |structure: &Structure| solution(&comm, structure, certificate.friction).0;
    let (exact, error) = (there(&full), largest_error(&there(&element), &there(&full)));
    let corrected: Vec<Complex64> = certificate.modes.iter().map(|mode| mode.corrected).collect();
    let remains = largest_error(&corrected, &exact);
    println!("friction {}: {error:.1e}, {remains:.1e} after correction", certificate.friction);
    assert!(error > 1e-7 && remains < error);
    let options = StabilityOptions { friction_values: Some(vec![0.2, 0.4, 0.6]), ..StabilityOptions::default() };
    let results = stability(&comm, &element, &options, &mut ()).unwrap();
    assert!(results.failure.is_none() && results.diagram.is_some_and(|diagram| !diagram.branches.is_empty()));
}
