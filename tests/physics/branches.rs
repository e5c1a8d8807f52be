//! Modes followed over friction on the two pads on a disc (tests/validation/pads_on_disc.rs), whose reference has
//! eigenvalues at 0, 0.2 ... 0.8.
//!
//! The reference's eigenvalues show four couplings: the pair at 6381 Hz grows at 0.2 and is at rest at 0, that at 1270
//! Hz grows at 0.4, those at 5190 and 7371 Hz at 0.8. Every Hopf point has to lie between the two values, bracketed by
//! solves to 1e-3.

use std::f64::consts::TAU;

use crate::support::data;
use crate::support::program::{Finished, Place};
use squeal::analysis::{FrictionFamily, Snapshot, Sweep, tracking_options, widened};
use squeal::model::InstabilityCriterion;
use squeal::native::{Comm, Session};
use squeal::structure::FullModel;
use squeal::tracking::{Diagram, track};

fn followed(comm: &Comm, values: &[f64], band: [f64; 2]) -> Diagram {
    let brake = FullModel::read(comm, &data("pads_on_disc.toml")).unwrap();
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let mut solve = |friction: f64| {
        let equilibrium = sweep.equilibrium(friction, &mut ())?;
        let modes = sweep.modes(&equilibrium, widened(band), &mut ())?;
        Snapshot::new(&mut sweep, &modes, band[1])
    };
    let mut family =
        FrictionFamily { solutions: &mut solve, m: &system.m, c: &system.c, viscoelastic: &system.viscoelastic };
    let (diagram, outcome) = track(&mut family, values, &tracking_options(band, InstabilityCriterion::default()));
    outcome.unwrap();
    assert_eq!(diagram.doubtful, Vec::<[f64; 2]>::new());
    diagram
}

/// (Hz, from, to) of each Hopf point. The two that couple were neighbours at the first value.
fn assert_couplings(diagram: &Diagram, expected: &[(f64, f64, f64)]) {
    assert_eq!(diagram.hopf.len(), expected.len(), "{:?}", diagram.hopf);
    for (hopf, &(hertz, from, to)) in diagram.hopf.iter().zip(expected) {
        println!("{:.2} Hz from friction {:.6} on, {:?}", hopf.omega / TAU, hopf.value, hopf.bracket);
        assert!((hopf.omega / TAU - hertz).abs() < 1.0 && hopf.onset);
        let [low, high] = hopf.bracket;
        assert!(from <= low && high <= to && high - low <= 1e-3);
        let partner = hopf.partner.unwrap();
        assert!(partner.branch + 1 == hopf.branch && (partner.share - 0.5).abs() < 0.15, "{partner:?}");
    }
}

#[test]
fn four_pairs_couple_between_the_values_of_the_reference() {
    let comm = Session::start(&[]).unwrap();
    let diagram = followed(&comm, &[0.0, 0.2, 0.4, 0.6, 0.8], [0.0, 7500.0]);
    let expected = [(6381.0, 0.0, 0.2), (1270.1, 0.2, 0.4), (5190.3, 0.6, 0.8), (7371.4, 0.6, 0.8)];
    assert_couplings(&diagram, &expected);
    assert_eq!(diagram.branches.len(), 23);
    for branch in &diagram.branches {
        assert_eq!(branch.points.len(), diagram.values.len(), "no branch is lost");
    }
}

/// Steps of 0.05 find what a step of 0.6 finds.
#[test]
fn the_step_does_not_matter() {
    let comm = Session::start(&[]).unwrap();
    let fine: Vec<f64> = (0..=12).map(|i| f64::from(i) * 0.05).collect();
    let [coarse, fine] = [&[0.0, 0.6], &fine[..]].map(|values| followed(&comm, values, [0.0, 1800.0]));
    for diagram in [&coarse, &fine] {
        assert_couplings(diagram, &[(1270.1, 0.2, 0.4)]);
        assert_eq!(diagram.branches.len(), 7);
    }
    assert_eq!(coarse.hopf[0].branch, fine.hopf[0].branch);
    assert!((coarse.hopf[0].value - fine.hopf[0].value).abs() < 1e-3);
    for (a, b) in coarse.branches.iter().zip(&fine.branches) {
        for (a, b) in [(a.points[0], b.points[0]), (*a.points.last().unwrap(), *b.points.last().unwrap())] {
            assert!((a.lambda - b.lambda).norm() < 1e-5 * a.lambda.norm(), "{a:?} {b:?}");
        }
    }
}

/// What the program writes, on one rank and on two.
#[test]
fn the_program_reports_where_a_mode_becomes_unstable_on_two_ranks() {
    let place = Place::pads();
    let arguments = ["stability", "brake.toml", "--band", "0:1500", "--friction", "0.2,0.4", "-o"];
    let with = |folder: &'static str| [&arguments[..], &[folder]].concat();
    for finished in [place.run(&with("one")), place.run_on(2, &with("two"))] {
        let Finished { code, out, err } = finished;
        assert_eq!(code, 0, "{err}");
        for part in [
            "unstable from friction 0.304",
            "coalesces with 1268.2 Hz, branch 4",
            "energy input by disc / ",
            "branches.csv",
        ] {
            assert!(out.contains(part), "{part}: {out}");
        }
    }
    let numbers = |name: &str| {
        let table = place.read(name);
        let fields = table.lines().skip(1).flat_map(|line| line.split(',')).filter_map(|field| field.parse().ok());
        fields.collect::<Vec<f64>>()
    };
    // Beside a coalescence the growth rate follows friction like a square root.
    for (name, tolerance) in [("branches.csv", 1e-5), ("hopf.csv", 1e-6)] {
        let [one, two] = ["one", "two"].map(|folder| numbers(&format!("{folder}/{name}")));
        assert!(!one.is_empty() && one.len() == two.len(), "{name}");
        for (a, b) in one.iter().zip(&two) {
            assert!((a - b).abs() <= tolerance * a.abs().max(1.0), "{name}: {a} and {b}");
        }
    }
    let explained = place.read("one/explained.csv");
    assert!(explained.lines().any(|line| line.contains(",contact,disc / inner pad,")), "{explained}");
}

/// Without branches only what was asked for is solved.
#[test]
fn branches_can_be_left_out() {
    let place = Place::pads();
    let finished =
        place.run(&["stability", "brake.toml", "--band", "0:1500", "--friction", "0.2,0.4", "--no-branches"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(!finished.out.contains("branches.csv") && finished.out.contains("explained.csv"), "{}", finished.out);
    assert_eq!(place.read("brake-stability/modes.csv").lines().count(), 11);
}
