//! `squeal explore` when it is interrupted: killed runs and signals, on one rank and on several.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::explore::{ADAPTIVE, EXPLORE, STUDY, assert_same_modes, done, place_with, table};
use crate::support::program::{Place, assert_refused, end, signal, start};

/// Points that an unfinished study has finished.
fn n_done(place: &Place) -> usize {
    n_done_of(place, "run")
}

fn n_done_of(place: &Place, run: &str) -> usize {
    let folder = &format!(".{run}.unfinished/.resume");
    let is_point = |name: &String| name.starts_with("point-");
    if place.path(folder).exists() { place.list(folder).iter().filter(|name| is_point(name)).count() } else { 0 }
}

#[test]
fn a_study_that_is_killed_ends_with_the_same_files() {
    assert_killed_ends_the_same(STUDY, "gradients.csv");
}

#[test]
fn an_adaptive_study_that_is_killed_ends_with_the_same_files() {
    assert_killed_ends_the_same(ADAPTIVE, "boundary.csv");
}

/// Kills a study ten times, once it has two points and then at random moments, and compares its files, one more among
/// them, with those of a study that was not interrupted.
pub fn assert_killed_ends_the_same(study: &str, file: &str) {
    let place = place_with(study);
    let begun = Instant::now();
    done(place.run(&EXPLORE));
    let (whole, mut chance) = (begun.elapsed().as_secs_f64(), Pcg64::seed_from_u64(7));
    let files = ["points.csv", "modes.csv", file, "summary.json", "worst.toml", "explore.html"];
    let expected = files.map(|file| place.read(&format!("run/{file}")));
    let shapes = kept_shapes(&place);
    std::fs::remove_dir_all(place.path("run")).unwrap();
    for i in 0..10 {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("squeal"));
        command.args(EXPLORE).current_dir(place.path("")).env("OPENBLAS_NUM_THREADS", "1");
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let patience = Instant::now() + Duration::from_secs(200);
        while n_done(&place) < 2 && child.try_wait().unwrap().is_none() {
            assert!(Instant::now() < patience, "two points do not come");
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_secs_f64(if i == 0 { 0.0 } else { 0.3 * whole * chance.random::<f64>() }));
        // It may be over before.
        let _ = child.kill();
        child.wait().unwrap();
        assert!(n_done(&place) >= 2 || place.path("run").exists());
    }
    if !place.path("run").exists() {
        place.write("other.toml", study.replace("seed = ", "seed = 1"));
        let other = place.run(&["explore", "other.toml", "-o", "run"]);
        assert_refused(&other, &["points are done", "parameters and design", "--force"]);
        let finished = done(place.run(&EXPLORE));
        assert!(finished.err.contains("an earlier run has finished"), "{}", finished.err);
    }
    for (file, expected) in files.iter().zip(expected) {
        assert!(place.read(&format!("run/{file}")) == expected, "{file} differs");
    }
    assert!(kept_shapes(&place) == shapes && !shapes.is_empty(), "shapes differ");
    assert!(!place.path(".run.unfinished").exists());
}

fn kept_shapes(place: &Place) -> Vec<f32> {
    hdf5::File::open(place.path("run/results.h5")).unwrap().dataset("shapes").unwrap().read_raw().unwrap()
}

/// A signal to one rank stops all groups; a killed rank ends them. The study ends on one rank, although files are
/// damaged.
#[test]
fn a_study_continues_on_other_ranks() {
    let place = place_with(&STUDY.replace("points = 6", "points = 12"));
    done(place.run(&EXPLORE));
    let on_two = ["explore", "explore.toml", "--ranks-per-point", "1", "-o", "groups"];
    let run_until = |n: usize, name: &str| {
        let mut child = start(&place, 2, &on_two);
        let patience = Instant::now() + Duration::from_secs(200);
        while n_done_of(&place, "groups") < n && child.try_wait().unwrap().is_none() {
            assert!(Instant::now() < patience, "{n} points do not come");
            std::thread::sleep(Duration::from_millis(2));
        }
        let ranks = std::fs::read_to_string(format!("/proc/{0}/task/{0}/children", child.id())).unwrap();
        signal(name, ranks.split_whitespace().last().unwrap().parse().unwrap());
        end(child)
    };
    let stopped = run_until(2, "TERM");
    assert!(stopped.err.contains("The same command continues to groups"), "{}", stopped.err);
    let n = n_done_of(&place, "groups");
    assert_ne!(run_until(n + 1, "KILL").code, 0);
    assert!((n + 1..13).contains(&n_done_of(&place, "groups")) && !place.path("groups").exists());
    // What is damaged is computed again.
    let folder = ".groups.unfinished/.resume";
    let last = place.list(folder).into_iter().filter(|name| name.starts_with("point-")).max().unwrap();
    for name in [last.as_str(), "gradients.bin"] {
        place.write(&format!("{folder}/{name}"), [1]);
    }
    let finished = done(place.run(&["explore", "explore.toml", "-o", "groups"]));
    assert!(finished.err.contains("an earlier run has finished"), "{}", finished.err);
    assert!(finished.err.contains(&format!("{last} cannot be read")), "{}", finished.err);
    assert_same_modes(&place, ["run", "groups"]);
    let n_rows = |folder: &str| table(&place, &format!("{folder}/gradients.csv")).len();
    assert!(n_rows("groups") == n_rows("run") && n_rows("run") > 0);
}
