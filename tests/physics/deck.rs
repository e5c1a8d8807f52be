//! A brake as a deck: written, read back, in other units and in a turned assembly, it is the same brake.

use crate::support::as_deck::{as_instance, brake, brake_of, deck_of};
use crate::support::data;
use squeal::analysis::Sweep;
use squeal::model::UnitSystem;
use squeal::native::{Comm, Session, Vector};
use squeal::stability::Mode;
use squeal::structure::FullModel;

/// Relative difference of matrices whose numbers were written with 20 characters.
const SAME_MATRIX: f64 = 1e-11;
/// Relative difference of eigenvalues.
const SAME_MODES: f64 = 1e-9;
/// Friction coefficient of the modes that are compared.
const FRICTION: f64 = 0.4;

/// M x, C x, K x for a vector of waves, and the load.
fn products(comm: &Comm, brake: &FullModel) -> [Vec<f64>; 4] {
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let wave: Vec<f64> = (0..system.dofs.n_local()).map(|i| (0.7 * i as f64).sin()).collect();
    let x = Vector::from_local(comm, &wave).unwrap();
    let times = |matrix: &squeal::native::Matrix| {
        let mut y = Vector::zeros(comm, system.dofs.n_local()).unwrap();
        matrix.multiply(&x, &mut y).unwrap();
        y.to_vec().unwrap()
    };
    [times(&system.m), times(&system.c), times(&system.k), system.load.to_vec().unwrap()]
}

#[track_caller]
fn assert_same_products(comm: &Comm, one: &FullModel, two: &FullModel) {
    let names = ["M", "C", "K", "load"];
    for ((a, b), name) in products(comm, one).iter().zip(&products(comm, two)).zip(names) {
        let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
        let difference = norm(&mut a.iter().zip(b).map(|(a, b)| a - b));
        let size = norm(&mut a.iter().copied());
        println!("{name}: {difference:.1e} of {size:.1e}");
        assert!(a.len() == b.len() && difference <= SAME_MATRIX * size, "{name}");
    }
}

/// The modes at a friction value.
fn modes(comm: &Comm, brake: &FullModel) -> Vec<Mode> {
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let equilibrium = sweep.equilibrium(FRICTION, &mut ()).unwrap();
    let band = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
    assert!(band.count.agrees());
    band.modes
}

#[track_caller]
fn assert_same_modes(one: &[Mode], two: &[Mode]) {
    assert!(one.len() == two.len() && one.len() > 20, "{} and {} modes", one.len(), two.len());
    let off = |mode: &Mode| {
        let all = two.iter().map(|other| (other.lambda - mode.lambda).norm() / mode.lambda.norm());
        all.fold(f64::INFINITY, f64::min)
    };
    let worst = one.iter().map(off).fold(0.0, f64::max);
    println!("{} modes, largest difference {worst:.1e}", one.len());
    assert!(worst <= SAME_MODES, "{worst}");
}

/// M, C, K and the load of pads on a disc: written in four systems of units and read back.
#[test]
fn a_deck_has_the_matrices_of_its_model_in_any_units() {
    let comm = Session::start(&[]).unwrap();
    let file = data("pads_on_disc.toml");
    let model = brake(&file);
    for system in UnitSystem::ALL.into_iter().filter(|system| system.name != "cm-g-s") {
        let deck = brake_of(&deck_of(&file, system));
        assert_eq!(deck.model.parts.len(), 5);
        println!("{}", system.name);
        assert_same_products(&comm, &model, &deck);
        assert_eq!(model.interface.points.len(), deck.interface.points.len());
    }
}

/// Modes to 1e-9: of the deck in millimetres, tonnes and seconds, and of the same deck as an instance that is moved
/// along and turned about the disc's axis.
#[test]
fn a_deck_and_an_instance_in_a_turned_assembly_have_the_modes_of_the_model() {
    let comm = Session::start(&[]).unwrap();
    let file = data("pads_on_disc.toml");
    let expected = modes(&comm, &brake(&file));
    let text = deck_of(&file, UnitSystem::ALL[0]);
    assert_same_modes(&expected, &modes(&comm, &brake_of(&text)));
    let turned = brake_of(&as_instance(&text));
    assert!(turned.mesh.parts.iter().all(|part| part.starts_with("B-1.")), "{:?}", turned.mesh.parts);
    assert_same_modes(&expected, &modes(&comm, &turned));
}
