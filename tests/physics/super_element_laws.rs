//! Normal laws and friction laws in super-elements: the pad of [`crate::super_element`].

use crate::super_element::{FRICTION, Full, analyse, analyse_under, blocks, largest_error, model};
use crate::support::assert_close;
use squeal::contact::FrictionLaw;
use squeal::contact::law::{FrictionFactor, FrictionFunction};
use squeal::model::NormalLaw;
use squeal::native::Session;
use squeal::reduction::file;
use squeal::reduction::recovery::OuterSurface;

/// At its creation point the reduced equilibrium has the full one's force at every contact, whatever the law of its
/// contacts.
#[test]
fn every_contact_force_is_reproduced_under_any_law() {
    let comm = Session::start(&[]).unwrap();
    let full = Full::new(&comm, &model(), FRICTION);
    let (_, element) = full.reduce(60e3);
    let pair = &full.brake.interface.pairs[0];
    let exact: Vec<[f64; 3]> = full.equilibrium.responses[pair.points.clone()].iter().map(|r| r.force).collect();
    let cubic = NormalLaw::Cubic { k1: 8e8, k3: 5e19 };
    let table = NormalLaw::Table { rows: vec![[0.0, 0.0], [1e-8, 20.0], [1e-6, 4e3]] };
    for law in [None, Some(NormalLaw::Linear { stiffness: 3e9 }), Some(cubic), Some(table)] {
        let (interface, equilibrium, _) = analyse(&comm, &element, law.clone(), FRICTION);
        let xi = interface.points.iter().map(|point| point.law.correction.abs()).fold(0.0, f64::max);
        let error = equilibrium.responses.iter().zip(&exact).flat_map(|(found, exact)| {
            let size = exact.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
            [0, 1, 2].map(|i| (found.force[i] - exact[i]).abs() / size)
        });
        let error = error.fold(0.0, f64::max);
        println!("{law:?}: largest xi {xi:.1e} m, largest error of a force {error:.1e}");
        assert!(error < 1e-8, "{law:?}: {error}");
        assert_eq!(law.is_some(), xi > 1e-9);
    }
}

/// `phi = 1 / ((1 + v) (1 + q/q_0))`, with q_0 near the pressure of the pad.
#[derive(Debug)]
struct Falling;

impl FrictionFunction for Falling {
    fn factor(&self, speed: f64, pressure: f64) -> FrictionFactor {
        let q_0 = 4e6;
        let value = 1.0 / ((1.0 + speed) * (1.0 + pressure / q_0));
        FrictionFactor { value, by_speed: -value / (1.0 + speed), by_pressure: -value / (q_0 + pressure) }
    }
}

/// With every mode kept, a super-element has its model's eigenvalues under a friction law of a user's own, and its
/// forces under any normal law. Its file does not contain the law, so that it has to be given again.
#[test]
fn a_users_friction_law_acts_in_the_super_element_as_in_its_model() {
    let comm = Session::start(&[]).unwrap();
    let mut brake = blocks(&model().replace("band = ", "friction_damping = true\nband = "));
    let law = FrictionLaw::user(Falling);
    brake.interface.set_friction_law("disc / pad", law.clone()).unwrap();
    let full = Full::of(&comm, brake, FRICTION);
    let (_, element) = full.reduce(f64::INFINITY);
    let (_, _, found) = analyse(&comm, &element, None, FRICTION);
    let error = largest_error(&found, &full.eigenvalues);
    let (constant, exact) = (Full::new(&comm, &model(), FRICTION).eigenvalues[0], full.eigenvalues[0]);
    let effect = (constant - exact).norm() / exact.norm();
    println!("largest error {error:.1e}, effect of the law on the first mode {effect:.1e}");
    assert!(error < 1e-10 && effect > 1e-4, "{error} {effect}");

    let (_, equilibrium, _) = analyse(&comm, &element, Some(NormalLaw::Cubic { k1: 8e8, k3: 5e19 }), FRICTION);
    for (found, exact) in equilibrium.responses.iter().zip(&full.equilibrium.responses) {
        assert_close("friction force", found.force[1], exact.force[1], 1e-8);
    }

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("blocks.se.h5");
    let surface = OuterSurface { parts: vec![], nodes: vec![], triangles: vec![], part: vec![], basis: vec![] };
    file::write(&path, &element, &surface, None).unwrap();
    let (read, _) = file::read(&path).unwrap();
    let mut interface = read.interface(None);
    let refused = read.assemble(&comm, &interface, 1.0).err().unwrap().to_string();
    assert!(refused.starts_with("contact \"disc / pad\": its friction law was a program's own"), "{refused}");
    assert!(interface.set_friction_law("disc", law.clone()).unwrap_err().to_string().contains("disc / pad"));
    interface.set_friction_law("disc / pad", law).unwrap();
    let (_, _, again) = analyse_under(&comm, &read, interface, FRICTION);
    assert!(largest_error(&again, &found) < 1e-12);
}

#[test]
fn the_file_of_a_super_element_contains_the_friction_curve() {
    let comm = Session::start(&[]).unwrap();
    let table = "{ by = [\"speed\"], table = [[0.4, 0], [0.3, 2]] }";
    let (_, element) =
        Full::new(&comm, &model().replace("friction = 0.4", &format!("friction = {table}")), FRICTION).reduce(60e3);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("blocks.se.h5");
    let surface = OuterSurface { parts: vec![], nodes: vec![], triangles: vec![], part: vec![], basis: vec![] };
    file::write(&path, &element, &surface, None).unwrap();
    let laws = [&element, &file::read(&path).unwrap().0].map(|element| format!("{:?}", element.pairs[0].friction_law));
    assert!(laws[0].contains("Table") && laws[0] == laws[1], "{laws:?}");
}
