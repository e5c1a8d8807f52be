//! Two pads pressed on an annular disc under friction 0 to 0.8, against an independent implementation of the same
//! formulation.
//!
//! ```text
//!        4 kN               Disc r 60-140 mm, 12 thick, cast iron, held at its bore; it turns about +z.
//!     vvvvvvvvv  backplate  Two pads, lining 10 mm on backplate 5 mm, tied; backs held in x and y.
//!     #########  lining     3292 tet10, 6750 nodes, 18776 free dofs; 118 contact points a pad.
//!  ===============  disc    Penalty 2e13 N/m3, pads may open; undamped.
//!     #########
//!     ^^^^^^^^^ 4 kN
//! ```
//!
//! Source: `data/pads_on_disc.json`, computed with numpy, scipy and SLEPc from the formulation, on the same mesh; no
//! code in common. What is compared is therefore arithmetic, not modelling, and the tolerances are the noise of the two
//! solvers.
//!
//! Goal and, in brackets, what was measured: masses and contact areas to 1e-12 [1e-14]; closed points exactly; contact
//! forces, displacement and torque to 1e-8 [6e-10, 3e-9, 1e-10; both stop Newton at a residual of 1e-9]; frequencies to
//! 1e-8 [5e-9]; growth rates to 1e-6 of their own [7e-8; a double root magnifies noise], those that are zero to 1e-11
//! of omega [1e-12]; backward errors below 1e-12 [1e-13].

use std::f64::consts::TAU;

use super::table::{Case, Row};
use crate::support::{assert_close, data};
use serde_json::Value;
use squeal::analysis::Sweep;
use squeal::assembly::System;
use squeal::element::solid;
use squeal::equilibrium::{Balance, Equilibrium};
use squeal::native::{Comm, Session};
use squeal::stability::{Band, Mode};
use squeal::structure::{Families, FullModel};

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

pub fn cases(comm: &Comm) -> Vec<Case> {
    let text = std::fs::read_to_string(data("pads_on_disc.json")).unwrap();
    let reference: Value = serde_json::from_str(&text).unwrap();
    let brake = FullModel::read(comm, &data("pads_on_disc.toml")).unwrap();
    compare_model(&brake, &reference);
    let families = brake.families().unwrap();
    let system = brake.assemble(comm, &families).unwrap();
    assert_eq!(system.dofs.n_global() as u64, reference["free_dofs"].as_u64().unwrap());
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let mut rows = Vec::new();
    for friction in [0.0, 0.2, 0.4, 0.6, 0.8] {
        println!("friction {friction}");
        let expected = &reference["results"][format!("{friction:.1}")];
        let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
        compare_equilibrium(&brake, &families, &system, &equilibrium, expected);
        let band = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
        let expected = expected["eigenvalues"].as_array().unwrap();
        compare_modes(&band, expected);
        rows.extend(unstable(friction, &band, expected));
    }
    vec![Case {
        title: "Two pads on a disc",
        text: "Two pads pressed on an annular disc by 4 kN, mu from 0 to 0.8, undamped. Reference: another implementation of the same \
               formulation on the same mesh (numpy, scipy, SLEPc; `tests/data/pads_on_disc.json`). The test compares masses (1e-12), forces, \
               torque, closed points and 24 eigenvalues at each friction (frequencies 1e-8, growth rates 1e-6); here are the unstable ones.",
        rows,
    }]
}

/// Unstable modes beside the reference's, by rising frequency.
fn unstable(friction: f64, band: &Band, expected: &[Value]) -> Vec<Row> {
    let modes = band.modes.iter().filter(|mode| mode.grows());
    let pairs = modes.filter_map(|mode| {
        let nearest = expected
            .iter()
            .filter(|e| number(&e["real"]) > 1.0)
            .find(|e| (number(&e["frequency_hz"]) - mode.frequency()).abs() < 0.1)?;
        Some((mode, number(&nearest["frequency_hz"]), number(&nearest["real"])))
    });
    let rows = pairs.flat_map(|(mode, hertz, growth)| {
        let what = |what| format!("friction {friction}: {what} of the mode at {hertz:.0} Hz");
        [
            Row::new(what("frequency"), "Hz", mode.frequency(), hertz, 1e-8),
            Row::new(what("growth rate"), "1/s", mode.growth_rate(), growth, 1e-6),
        ]
    });
    rows.collect()
}

#[test]
fn an_independent_implementation_agrees_at_every_friction() {
    cases(&Session::start(&[]).unwrap()).iter().for_each(Case::verify);
}

fn compare_model(brake: &FullModel, reference: &Value) {
    let mesh = &brake.mesh;
    assert_eq!(mesh.nodes.len() as u64, reference["nodes"].as_u64().unwrap());
    assert_eq!(mesh.elements.len() as u64, reference["tets"].as_u64().unwrap());
    for (index, name) in mesh.parts.iter().enumerate() {
        let part = brake.model.parts.iter().find(|part| part.name == *name).unwrap();
        let own = mesh.elements.iter().enumerate().filter(|(_, element)| element.part as usize == index);
        let volume: f64 = own.map(|(e, element)| solid::volume(element.shape(), &mesh.element_nodes(e))).sum();
        assert_close(name, volume * part.material.density, number(&reference["mass_kg"][name]), 1e-12);
    }
    for (i, pair) in brake.interface.pairs.iter().enumerate() {
        assert_eq!(pair.points.len() as u64, reference["contact"]["points"][i].as_u64().unwrap());
        assert_close("area", pair.statistics.weight, number(&reference["contact"]["area_m2"][i]), 1e-12);
    }
}

fn compare_equilibrium(
    brake: &FullModel,
    families: &Families,
    system: &System,
    equilibrium: &Equilibrium,
    expected: &Value,
) {
    let u = system.nodal(&[&equilibrium.u]).unwrap().remove(0);
    let (points, interface) = (&brake.mesh.nodes, &brake.interface);
    let families = families.list();
    let balance = Balance::new(system, points, &families, &brake.loads, interface, &u, &equilibrium.responses);
    for (i, forces) in balance.pairs.iter().enumerate() {
        assert_eq!(forces.counts.closed() as u64, expected["closed_points"][i].as_u64().unwrap());
        assert_close("normal force", forces.normal, number(&expected["normal_force_N"][i]), 1e-10);
        assert_close("largest contact force", forces.peak_force, number(&expected["max_contact_force_N"][i]), 1e-8);
    }
    let largest = u.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    assert_close("largest displacement", largest, number(&expected["max_displacement_m"]), 1e-8);
    let hub = brake.mesh.node_set("hub").unwrap();
    let torque =
        balance.support_torque(system.k.comm(), points, |n| hub.binary_search(&n).is_ok(), [0.0; 3], [0.0, 0.0, 1.0]);
    // The reference gives the torque on the hub, ours is the hub's on the disc; the scale is that of 4 kN at 0.1 m.
    let difference = (torque.abs() - number(&expected["hub_torque_Nm"]).abs()).abs();
    println!("hub torque {torque:.9} N m, off by {difference:.1e}");
    assert!(difference <= 1e-8 * 400.0);
}

/// Each eigenvalue of the reference, which has the 24 lowest, takes the nearest mode that is left.
fn compare_modes(band: &Band, expected: &[Value]) {
    assert!(band.count.agrees(), "{:?}", band.count);
    let mut left: Vec<&Mode> = band.modes.iter().collect();
    let mut worst = [0.0_f64; 3];
    for eigenvalue in expected {
        let (growth, hertz) = (number(&eigenvalue["real"]), number(&eigenvalue["frequency_hz"]));
        let distance = |mode: &Mode| (TAU * (mode.frequency() - hertz)).hypot(mode.growth_rate() - growth);
        let nearest = (0..left.len()).min_by(|&a, &b| distance(left[a]).total_cmp(&distance(left[b]))).unwrap();
        let mode = left.remove(nearest);
        let scale = growth.abs().max(1e-5 * TAU * hertz);
        worst[0] = worst[0].max((mode.frequency() / hertz - 1.0).abs());
        worst[1] = worst[1].max((mode.growth_rate() - growth).abs() / scale);
        worst[2] = worst[2].max(mode.backward_error);
    }
    println!("worst frequency {:.1e}, growth rate {:.1e}, backward error {:.1e}", worst[0], worst[1], worst[2]);
    assert!(worst[0] < 1e-8 && worst[1] < 1e-6 && worst[2] < 1e-12);
    let last = number(&expected.last().unwrap()["frequency_hz"]);
    assert!(left.iter().all(|mode| mode.frequency() > last), "a mode that the reference does not have");
}

/// Friction that turns with the velocity only takes energy out: `C` grows by a positive semidefinite matrix that scales
/// with 1/speed.
#[test]
fn friction_damping_takes_energy_out() {
    let comm = Session::start(&[]).unwrap();
    let mut brake = FullModel::read(&comm, &data("pads_on_disc.toml")).unwrap();
    brake.model.band = [0.0, 2000.0];
    let families = brake.families().unwrap();
    let system = brake.assemble(&comm, &families).unwrap();
    let growths = |damped: bool| {
        let mut sweep = Sweep::new(&system, &brake.interface, damped).unwrap();
        let equilibrium = sweep.equilibrium(0.4, &mut ()).unwrap();
        let band = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
        assert!(band.count.agrees());
        band.modes.iter().map(|mode| mode.growth_rate()).collect::<Vec<f64>>()
    };
    let (free, damped) = (growths(false), growths(true));
    assert_eq!(free.len(), damped.len());
    // The sum of the growth rates of all modes is -tr(M^-1 C) / 2; within the band every mode that did not grow decays
    // now.
    assert!(damped.iter().sum::<f64>() < free.iter().sum::<f64>() - 1.0, "{free:?} {damped:?}");
    assert!(free.iter().zip(&damped).filter(|(a, _)| a.abs() < 1e-3).all(|(_, b)| *b < 0.0), "{free:?} {damped:?}");
}
