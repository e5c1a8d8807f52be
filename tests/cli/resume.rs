//! A run that ends early, at whatever moment and by whatever signal, goes on with the same command and finds what it
//! would have found.
//!
//! Counts and not clocks decide when a factor is made again, so that a run on one rank repeats itself. A run that
//! continues starts with another factor than the one that was never stopped had at that point, which changes rounding.
//! So eigenvalues at the values asked for are compared to 1e-9, and what tracking solves in between to the tolerance of
//! Hopf points.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::program::{Finished, Place, end, signal, start, swap};
use squeal::results::{Results, Value, file};

/// A sweep in which two modes couple between the friction values asked for.
const SWEEP: [&str; 6] = ["stability", "brake.toml", "--band=0:1500", "--friction=0.2,0.4", "-o", "run"];

/// Values that an unfinished run has finished.
fn n_done(place: &Place) -> usize {
    place.n_kept("value-")
}

/// Waits until so many values are done, or the run is over.
fn wait_for(place: &Place, child: &mut Child, n: usize) {
    place.wait_for(child, "value-", n);
}

fn results(place: &Place, folder: &str) -> Results {
    file::read(&place.path(&format!("{folder}/results.h5"))).unwrap()
}

/// The rows of a friction value in the tables of a run.
fn rows(place: &Place, folder: &str, friction: f64) -> Vec<String> {
    let tables = ["modes.csv", "contact.csv"].map(|table| place.read(&format!("{folder}/{table}")));
    let lines = tables.iter().flat_map(|table| table.lines());
    lines.filter(|line| line.starts_with(&format!("{friction},"))).map(str::to_owned).collect()
}

/// Values by friction, those asked for and the others.
fn sorted(results: &Results) -> [Vec<&Value>; 2] {
    [true, false].map(|asked| {
        let mut values: Vec<&Value> = results.values.iter().filter(|value| value.asked == asked).collect();
        values.sort_by(|a, b| a.friction.total_cmp(&b.friction));
        values
    })
}

#[track_caller]
fn assert_same(found: &Results, expected: &Results) {
    let ([asked, between], [same, others]) = (sorted(found), sorted(expected));
    assert_eq!((asked.len(), between.len()), (same.len(), others.len()));
    for (a, b) in asked.iter().zip(&same) {
        assert_eq!((a.friction, a.modes.len(), &a.status, a.count), (b.friction, b.modes.len(), &b.status, b.count));
        assert!(a.pressure.iter().zip(&b.pressure).all(|(p, q)| (p - q).abs() <= 1e-6 * q.abs()));
        for (x, y) in a.modes.iter().zip(&b.modes) {
            let error = (x.lambda - y.lambda).norm() / y.lambda.norm();
            assert!(error < 1e-9, "{} and {} at {}: {error:.1e}", x.lambda, y.lambda, a.friction);
            assert_eq!(
                (x.unstable, x.shape.is_some(), x.sources.len()),
                (y.unstable, y.shape.is_some(), y.sources.len())
            );
        }
    }
    for (a, b) in between.iter().zip(&others) {
        assert!((a.friction - b.friction).abs() < 1e-3 && a.modes.len() == b.modes.len());
    }
    let [found, expected] = [found, expected].map(|results| results.diagram.as_ref().unwrap());
    let lengths = |d: &squeal::tracking::Diagram| d.branches.iter().map(|b| b.points.len()).collect::<Vec<_>>();
    assert_eq!((lengths(found), &found.doubtful), (lengths(expected), &expected.doubtful));
    assert_eq!(found.hopf.len(), expected.hopf.len());
    for (a, b) in found.hopf.iter().zip(&expected.hopf) {
        assert_eq!((a.branch, a.onset, a.partner.map(|p| p.branch)), (b.branch, b.onset, b.partner.map(|p| p.branch)));
        assert!((a.value - b.value).abs() < 1e-3 && (a.omega - b.omega).abs() < 1e-3 * b.omega, "{a:?} {b:?}");
    }
}

/// Numbers from 0 to 1 that look like chance.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Kills a run at random moments, again and again as it goes on, and lets it end after so many. Gives the moments
/// (values done, s).
fn kill_and_go_on(place: &Place, expected: &Results, chance: &mut Chance, n_kills: usize) -> Vec<(usize, f64)> {
    let n_values = expected.values.len() as f64;
    let longest = expected.values.iter().map(|value| value.seconds).fold(0.0, f64::max);
    let mut moments = Vec::new();
    for i in 0..n_kills {
        let from = n_values * i as f64 / n_kills as f64;
        let n = (from + chance.next() * n_values / n_kills as f64) as usize;
        let mut child = start(place, 1, &SWEEP);
        wait_for(place, &mut child, n);
        std::thread::sleep(Duration::from_secs_f64(longest * chance.next()));
        moments.push((n_done(place), longest));
        // The run may be over before.
        let _ = child.kill();
        let killed = end(child);
        if killed.code == 0 {
            break;
        }
        assert!(!place.path("run").exists(), "nothing half written under the name");
    }
    if !place.path("run").exists() {
        let finished = place.run(&SWEEP);
        assert_eq!(finished.code, 0, "{}", finished.err);
        assert!(n_done(place) == 0 && finished.out.contains("that an earlier run has found"), "{}", finished.out);
    }
    assert_same(&results(place, "run"), expected);
    assert!(!place.path(".run.unfinished").exists());
    assert!(
        place.list("run").iter().all(|name| name == ".squeal" || !name.starts_with('.')),
        "{:?}",
        place.list("run")
    );
    moments
}

/// How often to kill: more by hand.
fn n_rounds(default: usize) -> usize {
    std::env::var("SQUEAL_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(default)
}

#[test]
fn a_killed_run_goes_on() {
    let place = Place::pads();
    let finished = place.run(&SWEEP);
    assert_eq!(finished.code, 0, "{}", finished.err);
    std::fs::rename(place.path("run"), place.path("expected")).unwrap();
    let expected = results(&place, "expected");
    let hopf = &expected.diagram.as_ref().unwrap().hopf;
    assert!(!hopf.is_empty() && expected.values.len() > 3, "{hopf:?}");
    let (mut chance, mut n_equal) = (Chance(7), 0);
    for round in 0..n_rounds(1) {
        let moments = kill_and_go_on(&place, &expected, &mut chance, 2);
        // What was finished when the run was first killed is not solved again: the same bytes.
        for value in &expected.values[..moments[0].0] {
            let [found, same] = ["run", "expected"].map(|folder| rows(&place, folder, value.friction));
            assert!(found == same && found.is_empty() != value.asked, "{}: {found:?} {same:?}", value.friction);
            n_equal += found.len();
        }
        println!("round {round}: killed at {moments:?} (values done, seconds of the longest)");
        std::fs::remove_dir_all(place.path("run")).unwrap();
    }
    println!("{n_equal} rows are the same bytes");
}

/// The second signal ends a run within a value, as the end of the seconds after the first does.
#[test]
fn a_run_that_a_second_signal_has_ended_goes_on() {
    let place = Place::pads();
    let arguments =
        ["stability", "brake.toml", "--band=0:1000", "--friction=0.1:0.6:0.1", "--no-branches", "-o", "run"];
    let finished = place.run(&arguments);
    assert_eq!(finished.code, 0, "{}", finished.err);
    std::fs::rename(place.path("run"), place.path("expected")).unwrap();
    let mut child = start(&place, 1, &arguments);
    wait_for(&place, &mut child, 2);
    signal("TERM", child.id());
    std::thread::sleep(Duration::from_millis(50));
    signal("TERM", child.id());
    assert_eq!(end(child).code, 143);
    let n = n_done(&place);
    assert!((2..6).contains(&n) && !place.path("run").exists(), "{n}");
    let finished = place.run(&arguments);
    assert!(finished.code == 0 && finished.out.contains("that an earlier run has found"), "{}", finished.err);
    let [found, expected] = ["run", "expected"].map(|folder| results(&place, folder));
    assert_eq!((found.values.len(), expected.values.len()), (6, 6));
    let pairs = found.values.iter().zip(&expected.values).flat_map(|(a, b)| a.modes.iter().zip(&b.modes));
    let error = pairs.map(|(x, y)| (x.lambda - y.lambda).norm() / y.lambda.norm()).fold(0.0, f64::max);
    assert!(error < 1e-9, "{error}");
    let equal = |mu: f64| rows(&place, "run", mu) == rows(&place, "expected", mu);
    assert!(equal(0.1) && equal(0.2) && !rows(&place, "run", 0.1).is_empty());
}

/// A rank is killed; mpirun ends the others.
#[test]
fn a_killed_rank_ends_a_run_that_goes_on() {
    let place = Place::pads();
    let arguments = ["stability", "brake.toml", "--band=0:1000", "--friction=0.2,0.3", "-o", "run"];
    let mut child = start(&place, 2, &arguments);
    wait_for(&place, &mut child, 1);
    let children = std::fs::read_to_string(format!("/proc/{0}/task/{0}/children", child.id())).unwrap();
    signal("KILL", children.split_whitespace().last().unwrap().parse().unwrap());
    assert_ne!(end(child).code, 0);
    assert!(!place.path("run").exists() && n_done(&place) >= 1);
    let finished = place.run(&arguments);
    assert_eq!(finished.code, 2, "{}", finished.err);
    assert!(finished.err.contains("number of ranks was 2, is 1"), "{}", finished.err);
    let finished = place.run_on(2, &arguments);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let alone = place.run(&[&arguments[..5], &["alone"]].concat());
    assert_eq!(alone.code, 0, "{}", alone.err);
    assert_same(&results(&place, "run"), &results(&place, "alone"));
}

/// What is followed over friction by vectors alone needs the damping of each value, too.
#[test]
fn friction_damping_goes_on() {
    let place = Place::with_pads(|text| swap(&text, "[stability]", "[stability]\nfriction_damping = true"));
    let arguments = ["stability", "brake.toml", "--band=0:1000", "--friction=0.2,0.25,0.3", "-o", "run"];
    let finished = place.run(&arguments);
    assert_eq!(finished.code, 0, "{}", finished.err);
    std::fs::rename(place.path("run"), place.path("expected")).unwrap();
    let mut child = start(&place, 1, &arguments);
    wait_for(&place, &mut child, 2);
    child.kill().unwrap();
    end(child);
    let finished = place.run(&arguments);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert_same(&results(&place, "run"), &results(&place, "expected"));
}

#[test]
fn ctrl_c_ends_after_the_friction_at_hand() {
    let place = Place::blocks();
    let arguments = ["static", "brake.toml", "--friction=0:1:0.002", "-o", "run"];
    for (name, code) in [("INT", 130), ("TERM", 143)] {
        let mut child = start(&place, 1, &arguments);
        let n = n_done(&place);
        wait_for(&place, &mut child, n + 2);
        signal(name, child.id());
        let Finished { code: found, out, err } = end(child);
        assert_eq!((found, out.as_str()), (code, ""), "{err}");
        for part in [
            "stopping after this value, or within four seconds; a second signal",
            "stopped after friction coefficient 0.",
            "The same command goes on",
        ] {
            assert!(err.contains(part), "{part}: {err}");
        }
        assert!(!err.contains("error") && n_done(&place) > n && !place.path("run").exists(), "{err}");
    }
    let finished = place.run(&arguments);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert_eq!(results(&place, "run").values.len(), 501);
    assert!(finished.err.contains("an earlier run has finished"), "{}", finished.err);
}

#[test]
fn what_was_begun_otherwise_is_not_gone_on_with() {
    let place = Place::blocks();
    let with = |friction: &'static str| ["static", "brake.toml", friction, "-o", "run"];
    let mut child = start(&place, 1, &with("--friction=0:1:0.002"));
    wait_for(&place, &mut child, 2);
    // Two runs do not write one folder.
    let finished = place.run(&with("--friction=0:1:0.002"));
    assert!(finished.code == 2 && finished.err.contains("another run is writing run"), "{}", finished.err);
    child.kill().unwrap();
    end(child);
    let refused = |parts: &str| {
        let finished = place.run(&with("--friction=0:1:0.002"));
        assert_eq!(finished.code, 2, "{}", finished.err);
        for part in ["run is unfinished (", parts, "--force to begin again"] {
            assert!(finished.err.contains(part), "{part}: {}", finished.err);
        }
    };
    let finished = place.run(&with("--friction=0.1"));
    assert!(finished.code == 2 && finished.err.contains("friction values was 0, 0.002, "), "{}", finished.err);
    let model = place.read("brake.toml");
    place.write("brake.toml", swap(&model, "-1000", "-1001"));
    refused("SHA-256 of the model was ");
    place.write("brake.toml", &model);
    let mesh = place.read("blocks.msh");
    place.write("blocks.msh", format!("{mesh}\n"));
    refused("SHA-256 of the mesh was ");
    place.write("blocks.msh", &mesh);
    let value = std::fs::read(place.path(".run.unfinished/.resume/value-0001.h5")).unwrap();
    place.write(".run.unfinished/.resume/value-0001.h5", &value[..value.len() / 2]);
    let finished = place.run(&with("--friction=0:1:0.002"));
    assert!(finished.code == 2 && finished.err.contains("value-0001.h5 is incomplete or damaged"), "{}", finished.err);
    place.write(".run.unfinished/.resume/value-0001.h5", &value);
    let fields = std::fs::read(place.path(".run.unfinished/equilibrium_mu0.000.vtu")).unwrap();
    std::fs::remove_file(place.path(".run.unfinished/equilibrium_mu0.000.vtu")).unwrap();
    let missing = place.run(&with("--friction=0:1:0.002"));
    assert!(missing.code == 2 && missing.err.contains("equilibrium_mu0.000.vtu is missing"), "{}", missing.err);
    place.write(".run.unfinished/equilibrium_mu0.000.vtu", &fields);
    let study = place.read(".run.unfinished/.resume/study.txt");
    place.write(".run.unfinished/.resume/study.txt", [0xff_u8, 0xfe]);
    let damaged = place.run(&with("--friction=0:1:0.002"));
    assert!(damaged.code == 2 && damaged.err.contains("study.txt is missing or damaged"), "{}", damaged.err);
    place.write(".run.unfinished/.resume/study.txt", study);
    let finished = place.run(&[&with("--friction=0.1")[..], &["--force"]].concat());
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert_eq!(results(&place, "run").about.friction_values, [0.1]);
}

/// A folder that somebody removes under the run, and a place where nothing can be written.
#[test]
fn a_folder_that_goes_or_cannot_be_made_is_said() {
    let place = Place::blocks();
    let mut child = start(&place, 1, &["static", "brake.toml", "--friction=0:1:0.002", "-o", "run"]);
    wait_for(&place, &mut child, 3);
    std::fs::rename(place.path(".run.unfinished"), place.path("elsewhere")).unwrap();
    let Finished { code, err, .. } = end(child);
    assert!(code == 2 && err.contains(".run.unfinished has been removed or emptied while this run"), "{code} {err}");
    assert!(!place.path("run").exists());
    let refused = place.run(&["static", "brake.toml", "-o", "/sys/run"]);
    assert!(refused.code == 2 && refused.err.contains("cannot create the output folder /sys/run: "), "{}", refused.err);
}

/// What fits on the disc is kept, and the run goes on when there is room.
#[test]
fn a_full_disc_is_told() {
    let place = Place::blocks();
    let arguments = ["static", "brake.toml", "--friction=0:0.5:0.01", "-o", "run"];
    let program = assert_cmd::cargo::cargo_bin("squeal");
    // A limit on the length of files stands for a full disc. The signal that comes with it is ignored.
    let script = format!("trap '' XFSZ; exec {} {}", program.display(), arguments.join(" "));
    let mut command = Command::new("bash");
    command.args(["-c", &script]).current_dir(place.path("")).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    wait_for(&place, &mut child, 1);
    let limit = Command::new("prlimit").args(["--pid", &child.id().to_string(), "--fsize=4096"]).status().unwrap();
    assert!(limit.success());
    let finished = end(child);
    assert_eq!(finished.code, 1, "{}", finished.err);
    assert!(finished.err.contains("File too large") && finished.err.contains(".run.unfinished"), "{}", finished.err);
    assert!(!place.path("run").exists() && n_done(&place) >= 1);
    let finished = place.run(&arguments);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert_eq!(results(&place, "run").values.len(), 51);
    assert!(Path::new(&place.path("run/equilibrium_mu0.500.vtu")).exists());
}

/// The value at hand takes minutes, and the first one is not finished either.
#[test]
fn a_signal_within_a_long_value_ends_the_run_within_five_seconds() {
    let place = Place::pads();
    let arguments = ["stability", "brake.toml", "--friction=0.4", "--band=0:25000", "--no-branches", "-o", "run", "-v"];
    let mut child = start(&place, 1, &arguments);
    while !place.path(".run.unfinished").exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_secs(2));
    assert!(child.try_wait().unwrap().is_none(), "the value is long enough");
    let sent = Instant::now();
    signal("TERM", child.id());
    let Finished { code, err, .. } = end(child);
    assert!(sent.elapsed().as_secs_f64() < 5.5, "{err}");
    assert_eq!(code, 143, "{err}");
    assert!(err.contains("stopped within a value") && !place.path("run").exists(), "{err}");
}

/// Nobody reads what the program says: it stops all the same.
#[test]
fn a_signal_ends_a_run_whose_messages_nobody_reads() {
    let place = Place::pads();
    let arguments = ["stability", "brake.toml", "--friction=0.4", "--band=0:25000", "--no-branches", "-o", "run", "-v"];
    let mut child = start(&place, 1, &arguments);
    drop(child.stderr.take());
    std::thread::sleep(Duration::from_secs(2));
    assert!(child.try_wait().unwrap().is_none(), "the value is long enough");
    let sent = Instant::now();
    signal("TERM", child.id());
    assert_eq!(end(child).code, 143);
    assert!(sent.elapsed().as_secs_f64() < 5.5 && !place.path("run").exists());
}

/// `reduce` has no values that could be kept.
#[test]
fn a_signal_ends_at_once_what_cannot_go_on() {
    let place = Place::pads();
    for (name, code) in [("INT", 130), ("TERM", 143)] {
        let mut child = start(&place, 1, &["reduce", "brake.toml", "--galerkin", "--output", "brake.se.h5"]);
        std::thread::sleep(Duration::from_secs(1));
        assert!(child.try_wait().unwrap().is_none(), "the reduction is long enough");
        let sent = Instant::now();
        signal(name, child.id());
        let Finished { code: found, err, .. } = end(child);
        assert!(found == code && sent.elapsed().as_secs_f64() < 1.0, "{found}: {err}");
        assert!(!place.path("brake.se.h5").exists());
    }
}
