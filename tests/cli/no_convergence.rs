//! An equilibrium that cannot be found: exit code 3, what was tried, and the last state to look at.

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, swap};

/// Requires the report of a solve that gave up, on one rank.
#[track_caller]
fn gave_up(place: &Place, finished: &Finished, parts: &[&str]) {
    gave_up_with(place, finished, parts, "last_state.vtu");
}

/// The same, with the name of the last state's file.
#[track_caller]
fn gave_up_with(place: &Place, finished: &Finished, parts: &[&str], last_state: &str) {
    let Finished { code, err, .. } = finished;
    assert_eq!(*code, 3, "{err}");
    assert_eq!(err.lines().filter(|line| line.starts_with("error")).count(), 1, "one message: {err}");
    for part in parts {
        assert!(err.contains(part), "{part:?} is not in: {err}");
    }
    assert!(err.contains(&format!("The last state is in run/{last_state}\n")), "{err}");
    assert!(place.read(&format!("run/{last_state}")).ends_with("</VTKFile>\n"));
    let summary = place.read("run/summary.txt");
    assert!(summary.contains("not converged: no equilibrium at friction"), "{summary}");
    let convergence = place.read("run/convergence.csv");
    assert!(convergence.starts_with("friction,step,iteration,relative_residual,"), "{convergence}");
}

/// A load that pulls the pad off the disc. Its `force` points up.
fn pulled() -> Place {
    Place::with_blocks(|text| swap(&text, "[0, 0, -1000]", "[0, 0, 1000]"), &PadOnDisc::default())
}

const PULLED: [&str; 5] = [
    "no equilibrium at friction 0.000 (step `contact without friction at the disc`)",
    "Relative residuals: ",
    "(30 iterations)",
    "The loads pull disc / pad apart with 1000.0 N",
    "Look at the directions of the loads",
];

#[test]
fn a_load_that_pulls_the_pad_off() {
    let place = pulled();
    let finished = place.run(&["static", "brake.toml", "-o", "run"]);
    gave_up(&place, &finished, &PULLED);
    let steps = place.read("run/convergence.csv");
    assert_eq!(steps.lines().filter(|line| line.contains("contact without friction")).count(), 31, "{steps}");
    // A run that failed is a run: it can be replaced.
    let finished = place.run(&["stability", "brake.toml", "-o", "run", "--force"]);
    gave_up(&place, &finished, &PULLED);
    assert!(!finished.out.contains("stable"), "no verdict without modes: {}", finished.out);
}

#[test]
fn a_load_that_pulls_the_pad_off_two_ranks() {
    let place = pulled();
    let finished = place.run_on(2, &["static", "brake.toml", "-o", "run"]);
    gave_up_with(&place, &finished, &PULLED, "last_state.pvtu");
}

/// Too few iterations for large steps in friction: small ones come as far as they can.
#[test]
fn too_few_iterations() {
    let place = Place::blocks();
    let few = ["--petsc", "-equilibrium_snes_max_it 1"];
    let finished = place.run(&[&["static", "brake.toml", "-o", "run", "--friction", "1.9"][..], &few].concat());
    gave_up(&place, &finished, &["no equilibrium at friction 1.", "the last one is at 0.998"]);
}

/// What a sweep has found before it fails is kept. At high friction the pad digs into the disc.
#[test]
fn a_sweep_keeps_what_it_has() {
    let place = Place::blocks();
    let finished = place.run(&["stability", "brake.toml", "-o", "run", "--friction", "0,0.4,1.9"]);
    gave_up(&place, &finished, &["no equilibrium at friction 1.", "the last one is at 1."]);
    let modes = place.read("run/contact.csv");
    let friction_values: Vec<&str> = modes.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert_eq!(friction_values, ["0", "0.4"]);
    assert!(place.list("run").contains(&"equilibrium_mu0.400.vtu".into()));
    assert!(finished.out.contains("\nunknown: no mode lies in the band from 0 to 20000 Hz"), "{}", finished.out);
    assert!(finished.out.contains("\ndoubt: the study ended early: no equilibrium at friction 1."), "{}", finished.out);
}
