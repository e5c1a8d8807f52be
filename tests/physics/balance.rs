//! The demo brake (small mesh): what an engineer expects of an equilibrium and of its modes at any friction.
//!
//! `make test` meshes it; the mesh is not committed.

use std::path::Path;

use squeal::analysis::Sweep;
use squeal::equilibrium::Balance;
use squeal::native::Session;
use squeal::structure::FullModel;

/// Hydraulic force, N.
const CLAMP: f64 = 12000.0;

/// From rest through all friction values: forces and moments balance to 1e-6 of the clamp force (measured 2e-12), the
/// pads carry it (the pins take what they are stiff along their axis, measured 0.07 %), the hub holds the torque of
/// friction.
#[test]
fn equilibria_balance_at_every_friction() {
    let comm = Session::start(&[]).unwrap();
    let brake = FullModel::read(&comm, Path::new("meshes/brake-small.toml")).unwrap();
    brake.require_constrained(&comm).unwrap();
    let families = brake.families().unwrap();
    let system = brake.assemble(&comm, &families).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    for tenths in 1..=9 {
        let friction = f64::from(tenths) / 10.0;
        let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
        let last = equilibrium.steps.last().unwrap().iterations.last().unwrap();
        assert!(last.residual <= 1e-9);
        let u = system.nodal(&[&equilibrium.u]).unwrap().remove(0);
        let points = &brake.mesh.nodes;
        let list = families.list();
        let responses = &equilibrium.responses;
        let balance = Balance::new(&system, points, &list, &brake.loads, &brake.interface, &u, responses);
        let [force, moment] = balance.residual();
        assert!(force < 1e-9 * CLAMP && moment < 1e-9 * CLAMP, "{force} N, {moment} N m");
        let normal = |name: &str| {
            let pair = brake.interface.pairs.iter().position(|pair| pair.name == name).unwrap();
            balance.pairs[pair].normal
        };
        for name in ["piston / inner pad", "caliper / outer pad"] {
            assert!((normal(name) - CLAMP).abs() < 2e-3 * CLAMP, "{name}: {} N", normal(name));
        }
        let rotation = &brake.model.rotations[0];
        let disc = brake.mesh.parts.iter().position(|part| *part == rotation.part).unwrap();
        let mut on_disc = vec![false; points.len()];
        for element in brake.mesh.elements.iter().filter(|element| element.part as usize == disc) {
            element.nodes.iter().for_each(|&n| on_disc[n as usize] = true);
        }
        let held = balance.support_torque(&comm, points, |n| on_disc[n as usize], rotation.through, rotation.axis);
        let pairs = brake.interface.pairs.iter().zip(&balance.pairs).filter(|(pair, _)| pair.is_sliding());
        let friction_torque: f64 = pairs.map(|(_, f)| f.on_slave.about(rotation.through, rotation.axis)).sum();
        assert!((held - friction_torque).abs() < 1e-6 * held.abs(), "{held} and {friction_torque} N m");
    }
}

/// Quiet at low friction, squealing at high: a coupling appears in between. Every mode solves its problem, none is
/// missed.
#[test]
fn modes_couple_as_friction_rises() {
    let comm = Session::start(&[]).unwrap();
    let brake = FullModel::read(&comm, Path::new("meshes/brake-small.toml")).unwrap();
    let families = brake.families().unwrap();
    let system = brake.assemble(&comm, &families).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let mut unstable = |friction: f64| {
        let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
        let band = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
        assert!(band.count.agrees(), "{:?}", band.count);
        assert!(band.modes.iter().all(|mode| mode.backward_error <= 1e-10));
        band.modes.iter().filter(|mode| mode.grows()).map(|mode| mode.frequency()).collect::<Vec<_>>()
    };
    assert_eq!(unstable(0.1), Vec::<f64>::new());
    assert!(!unstable(0.6).is_empty());
}
