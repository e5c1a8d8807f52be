//! The demo brake as a deck: what `squeal convert` writes of its model file, in mm-t-s, in SI units, and as an instance
//! in a turned assembly, has the equilibrium and the modes of the model file.
//!
//! All of them are one mesh with one order of nodes, so that they differ by the rounding of coordinates and constants
//! alone, to 13 digits. The brake sticks, slides and opens, its pistons and pins are joined by connectors, and an order
//! of facets that a deck lost would be seen: a point in a corner meets the wall whose facet comes first.
//!
//! Goal, and measured in the order above: modes to 1e-9 of their modulus [medium, 50 modes: 3e-10, 1e-10, 1e-10; small,
//! 54 modes: 4e-11, 3e-11, 4e-11], lengths of displacements to 1e-9 of the largest [small: 3e-12, 3e-12, 2e-12], normal
//! forces of the pairs to 1e-9 of the largest [medium: 5e-12, 1e-11, 2e-12; small: 8e-13, 6e-13, 6e-13].
//!
//! The medium brake takes four minutes of one core, in a build with optimisation.

use std::path::Path;

use crate::support::as_deck::{as_instance, brake, brake_of, deck_of};
use squeal::analysis::Sweep;
use squeal::equilibrium::PairForces;
use squeal::model::UnitSystem;
use squeal::native::{Comm, Session};
use squeal::stability::Mode;
use squeal::structure::FullModel;

const SAME: f64 = 1e-9;
const FRICTION: f64 = 0.3;

/// What a brake does at one friction value.
struct Answer {
    /// Length of each node's displacement, m.
    lengths: Vec<f64>,
    /// Normal force of each pair, N.
    forces: Vec<f64>,
    modes: Vec<Mode>,
}

fn answer(comm: &Comm, brake: &FullModel) -> Answer {
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, brake.model.friction_damping).unwrap();
    let equilibrium = sweep.equilibrium(FRICTION, &mut ()).unwrap();
    let u = brake.displacements(&system, &equilibrium.u).unwrap();
    let pairs = PairForces::all(&brake.interface, &equilibrium.responses);
    let band = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
    assert!(band.count.agrees());
    Answer {
        lengths: u.iter().map(|u| u.iter().map(|x| x * x).sum::<f64>().sqrt()).collect(),
        forces: pairs.iter().map(|pair| pair.normal).collect(),
        modes: band.modes,
    }
}

/// The largest difference over the largest value.
fn difference(one: &[f64], two: &[f64]) -> f64 {
    assert_eq!(one.len(), two.len());
    let size = one.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    one.iter().zip(two).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
}

/// The largest distance of a mode to its nearest over its modulus.
fn modes_apart(one: &[Mode], two: &[Mode]) -> f64 {
    assert!(one.len() == two.len() && one.len() > 20, "{} and {} modes", one.len(), two.len());
    let off = |mode: &Mode| {
        let all = two.iter().map(|other| (other.lambda - mode.lambda).norm() / mode.lambda.norm());
        all.fold(f64::INFINITY, f64::min)
    };
    one.iter().map(off).fold(0.0, f64::max)
}

fn compare(size: &str) {
    let comm = Session::start(&[]).unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("meshes/brake-{size}.toml"));
    let model = answer(&comm, &brake(&file));
    let text = |units: &str| deck_of(&file, UnitSystem::named(units).unwrap());
    let decks = [("mm-t-s", text("mm-t-s")), ("SI", text("m-kg-s")), ("turned", as_instance(&text("mm-t-s")))];
    for (name, text) in decks {
        let deck = answer(&comm, &brake_of(&text));
        let (u, forces) = (difference(&model.lengths, &deck.lengths), difference(&model.forces, &deck.forces));
        let modes = modes_apart(&model.modes, &deck.modes);
        println!("{name}: displacements {u:.1e}, forces {forces:.1e}, {} modes {modes:.1e}", deck.modes.len());
        assert!(u <= SAME && forces <= SAME && modes <= SAME, "{name}");
    }
}

#[test]
fn the_small_brake_as_a_deck_has_its_equilibrium_and_modes() {
    compare("small");
}

#[test]
#[ignore = "takes minutes: make validation"]
fn the_medium_brake_as_a_deck_has_its_equilibrium_and_modes() {
    compare("medium");
}
