//! The program as a tool among others: help, pipes, and files that other programs can read.

use std::io::{BufRead, BufReader, Read};
use std::process::Stdio;

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place, swap};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use insta::assert_snapshot;
use roxmltree::Document;

const LONGEST_LINE: usize = 110;

#[test]
fn help_on_two_ranks() {
    let place = Place::empty();
    let commands =
        "new example schema check convert static reduce export modes stability report study compare completions";
    let help = |arguments: &[&str]| {
        let Finished { code, out, err } = place.run(arguments);
        assert_eq!((code, err.as_str()), (0, ""), "{arguments:?}");
        assert!(out.lines().all(|line| line.len() <= LONGEST_LINE), "{out}");
        format!("$ squeal {}\n{out}\n", arguments.join(" "))
    };
    let texts = commands.split(' ').map(|command| help(&[command, "--help"]));
    let program = help(&["--help"]);
    assert_snapshot!(program + &texts.collect::<String>());
    let version = format!("squeal {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(place.run_on(2, &["-V"]).out, version);
    let libraries = place.run_on(2, &["--version"]).out;
    assert!(libraries.starts_with(&version), "{libraries}");
    for library in ["Petsc ", "SLEPc ", "MUMPS ", "METIS ", "BLAS: ", "MPI "] {
        assert!(libraries.contains(library), "{library}: {libraries}");
    }
    assert_eq!(place.run(&["help", "model"]).out, place.run(&["example"]).out);
    assert_eq!(place.run(&[]).code, 2);
}

/// `squeal ... | head -1`: a reader that leaves is no accident.
#[test]
fn a_reader_may_leave() {
    for arguments in [&["check", "brake.toml"][..], &["static", "brake.toml"], &["stability", "brake.toml"]] {
        let place = Place::blocks();
        let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("squeal"))
            .args(arguments)
            .current_dir(place.path(""))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let mut err = String::new();
        child.stderr.take().unwrap().read_to_string(&mut err).unwrap();
        assert_eq!(err, "", "{arguments:?}");
        assert_eq!(child.wait().unwrap().code(), Some(0), "{arguments:?}");
    }
}

#[test]
fn a_full_disc_is_an_accident() {
    let place = Place::blocks();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("squeal"));
    let output = command.args(["check", "brake.toml"]).current_dir(place.path("")).stdout(full).output().unwrap();
    let finished = Finished::from(output);
    assert_eq!(finished.code, 1);
    assert!(finished.err.starts_with("error: standard output: No space left on device"), "{}", finished.err);
}

#[test]
fn check_prints_what_a_model_is() {
    let Finished { code, out, err } = Place::blocks().run(&["check", "brake.toml"]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert_snapshot!(out);
}

/// A run of the pads in which two modes grow, on which several tests look.
fn pads() -> (Place, Finished) {
    let place = Place::pads();
    let finished = place.run(&["stability", "brake.toml", "--friction", "0,0.4", "--band", "0:3000", "-o", "run"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    (place, finished)
}

#[test]
fn a_run_leaves_what_its_summary_says() {
    let (place, Finished { out, err, .. }) = pads();
    assert_eq!(err, "", "no progress lines without a terminal");
    assert_eq!(place.read("run/summary.txt"), out);
    assert_eq!(place.list(""), ["brake.toml", "pads_on_disc.msh", "run"], "no draft is left");
    assert!(out.contains("unstable first at friction 0.4: 1270 Hz; strongest 1270 Hz at friction 0.4"), "{out}");
    let files: Vec<String> = place.list("run").into_iter().filter(|name| !name.starts_with('.')).collect();
    let (_, listed) = out.split_once("results in run:\n").unwrap();
    let patterns: Vec<&str> = listed.lines().flat_map(|line| line[2..36].trim().split(", ")).collect();
    for pattern in &patterns {
        assert!(files.iter().any(|file| matches(file, pattern)), "no {pattern} among {files:?}");
    }
    for file in &files {
        assert!(patterns.iter().any(|pattern| matches(file, pattern)), "{file} is not listed: {listed}");
    }
    tables_have_the_columns_they_promise(&place, &files);
    pictures_hold_finite_numbers(&place, &files);
}

fn matches(file: &str, pattern: &str) -> bool {
    match pattern.split_once('*') {
        Some((start, end)) => file.starts_with(start) && file.ends_with(end),
        None => file == pattern,
    }
}

fn tables_have_the_columns_they_promise(place: &Place, files: &[String]) {
    let columns = |name: &str| -> (String, Vec<Vec<String>>) {
        let mut table = csv::Reader::from_path(place.path(name)).unwrap();
        let header = table.headers().unwrap().iter().collect::<Vec<_>>().join(",");
        (header, table.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect())
    };
    let (header, modes) = columns("run/modes.csv");
    assert_eq!(header, "friction,mode,frequency_hz,growth_rate_per_s,damping_ratio,backward_error,unstable");
    for row in &modes {
        let x: Vec<f64> = row.iter().map(|field| field.parse().unwrap()).collect();
        assert!((0.0..=3000.0).contains(&x[2]) && x[5] < 1e-10, "{row:?}");
        let damping = -x[3] / (x[3].powi(2) + (std::f64::consts::TAU * x[2]).powi(2)).sqrt();
        assert!((x[4] - damping).abs() <= 1e-6 * damping.abs() + 1e-15, "{row:?}: {damping}");
    }
    let unstable = modes.iter().filter(|row| row[6] == "1").count();
    assert_eq!(unstable, 1);
    assert_eq!(files.iter().filter(|file| file.starts_with("mode_")).count(), unstable);
    let (header, contact) = columns("run/contact.csv");
    let forces = "normal_force_n,tangential_force_n,closed_area_m2,peak_pressure_pa,peak_force_n,rounding_n";
    assert_eq!(header, format!("friction,pair,open,stick,slip,{forces}"));
    let pairs: Vec<[&str; 2]> = contact.iter().map(|row| [row[0].as_str(), row[1].as_str()]).collect();
    let (inner, outer) = ("disc / inner pad", "disc / outer pad");
    assert_eq!(pairs, [["0", inner], ["0", outer], ["0.4", inner], ["0.4", outer]]);
    let (header, steps) = columns("run/convergence.csv");
    assert_eq!(header, "friction,step,iteration,relative_residual,open,stick,slip,changes");
    assert!(steps.iter().any(|row| row[1] == "settle") && steps.iter().any(|row| row[1] == "friction 0.4000"));
}

fn pictures_hold_finite_numbers(place: &Place, files: &[String]) {
    let mut seen = Vec::new();
    for file in files.iter().filter(|file| file.ends_with(".vtu")) {
        let arrays = read_vtu(&place.read(&format!("run/{file}")));
        seen.push((file.as_str(), arrays.join(" ")));
    }
    let (cells, contact) = ("Points connectivity offsets types", "contact_pressure contact_traction contact_status");
    let expected = [
        ("contact_mu0.000.vtu", format!("{cells} displacement {contact} pair")),
        ("contact_mu0.400.vtu", format!("{cells} displacement {contact} pair")),
        ("equilibrium_mu0.000.vtu", format!("{cells} displacement {contact} part von_mises")),
        ("equilibrium_mu0.400.vtu", format!("{cells} displacement {contact} part von_mises")),
        ("mode_mu0.400_005_1270Hz.vtu", format!("{cells} real imaginary part")),
    ];
    assert_eq!(seen, expected);
}

/// Checks a VTU file as a reader would: well-formed, every array as long as it must be and finite, cells of existing
/// points. Gives the names of its arrays.
fn read_vtu(text: &str) -> Vec<String> {
    let document = Document::parse(text).unwrap();
    let root = document.root_element();
    assert_eq!(root.attribute("header_type"), Some("UInt64"));
    let piece = document.descendants().find(|node| node.has_tag_name("Piece")).unwrap();
    let count = |name: &str| piece.attribute(name).unwrap().parse::<usize>().unwrap();
    let (n_points, n_cells) = (count("NumberOfPoints"), count("NumberOfCells"));
    let mut names = Vec::new();
    for array in piece.descendants().filter(|node| node.has_tag_name("DataArray")) {
        let name = array.attribute("Name").unwrap();
        let section = array.parent_element().unwrap().tag_name().name();
        let values = decode(array.text().unwrap(), array.attribute("type").unwrap());
        assert!(values.iter().all(|x| x.is_finite()), "{name}");
        let components: usize = array.attribute("NumberOfComponents").unwrap().parse().unwrap();
        let width = values.len() / components;
        match (section, name) {
            ("Points" | "PointData", _) => assert_eq!(width, n_points, "{name}"),
            ("Cells", "connectivity") => {
                assert!([6 * n_cells, 10 * n_cells].contains(&width), "{width} nodes of {n_cells} cells");
                assert!(values.iter().all(|&node| (node as usize) < n_points));
            }
            _ => assert_eq!(width, n_cells, "{name}"),
        }
        if ["displacement", "real", "contact_pressure"].contains(&name) {
            assert!(values.iter().any(|&x| x != 0.0), "{name} is zero");
        }
        names.push(name.to_owned());
    }
    names
}

fn decode(text: &str, kind: &str) -> Vec<f64> {
    let bytes = STANDARD.decode(text).unwrap();
    let (header, data) = bytes.split_first_chunk::<8>().unwrap();
    assert_eq!(u64::from_le_bytes(*header) as usize, data.len());
    let words = || data.as_chunks::<4>().0.iter();
    match kind {
        "Float32" => words().map(|word| f64::from(f32::from_le_bytes(*word))).collect(),
        "Int32" => words().map(|word| f64::from(i32::from_le_bytes(*word))).collect(),
        "UInt32" => words().map(|word| f64::from(u32::from_le_bytes(*word))).collect(),
        "UInt8" => data.iter().map(|&byte| f64::from(byte)).collect(),
        other => panic!("{other} is no type of ours"),
    }
}

#[test]
fn friction_values_that_differ_little_have_their_own_files() {
    let place = Place::blocks();
    assert_eq!(place.run(&["static", "brake.toml", "--friction", "0.3,0.3001", "-o", "run"]).code, 0);
    let files = place.list("run");
    for name in ["equilibrium_mu0.300.vtu", "equilibrium_mu0.3001.vtu"] {
        assert!(files.contains(&name.into()), "{files:?}");
    }
}

#[test]
fn results_go_where_they_are_expected() {
    let place = Place::blocks();
    assert_eq!(place.run(&["static", "brake.toml"]).code, 0);
    assert_eq!(place.run(&["static", "brake.toml", "-o", "deep/down/run"]).code, 0);
    assert!(place.path("brake-static/summary.txt").exists() && place.path("deep/down/run/contact.csv").exists());
    assert_eq!(place.run(&["static", "brake.toml", "--force"]).code, 0);
    assert_eq!(place.list(""), ["blocks.msh", "brake-static", "brake.toml", "deep"]);
}

#[test]
fn a_stable_brake_is_called_stable_if_it_is_damped() {
    let without_friction = |text: String| swap(&text, "friction = 0.4", "friction = 0");
    let damped = |text: String| {
        without_friction(text)
            + "\n[[connector]]\nbetween = [\"pad_top\", \"disc_bottom\"]\nstiffness = [1, 1, 1]\ndamping = [1, 1, 1]\n"
    };
    let run = |place: Place| {
        let finished = place.run(&["stability", "brake.toml", "--band", "0:60000", "-o", "run"]);
        assert_eq!(finished.code, 0, "{}", finished.err);
        finished.out
    };
    let out = run(Place::with_blocks(damped, &PadOnDisc::default()));
    assert!(out.contains("\nstable: no mode of the band is unstable at these friction values"), "{out}");
    assert!(!out.contains("mode_*.vtu"), "{out}");
    let out = run(Place::with_blocks(without_friction, &PadOnDisc::default()));
    assert!(out.contains("\nunknown: the model has no damping"), "{out}");
}

/// Without contact force there is no friction: the verdict is unknown.
#[test]
fn an_unloaded_brake_is_neither_stable_nor_unstable() {
    let fixed =
        |text: String| swap(&swap(&text, "\"pad_top\"\naxes = \"xy\"", "\"pad_top\"\naxes = \"xyz\""), "-1000]", "0]");
    let place = Place::with_blocks(fixed, &PadOnDisc::default());
    let finished = place.run(&["stability", "brake.toml", "--band", "0:60000", "-o", "run"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    assert!(finished.out.contains("\nunknown: no load presses the contacts together"), "{}", finished.out);
    let report = place.run(&["report", "run"]);
    assert!(report.out.starts_with("Unknown: no load presses the contacts together"), "{}", report.out);
    let place = Place::with_blocks(|text| swap(&text, "[0, 20000]", "[0, 20]"), &PadOnDisc::default());
    let finished = place.run(&["stability", "brake.toml", "-o", "run"]);
    assert!(
        finished.code == 0 && finished.out.contains("\nunknown: no mode lies in the band from 0 to 20 Hz"),
        "{}",
        finished.out
    );
}

/// A model in wrong units is pointed at, and is not called stable.
#[test]
fn doubtful_numbers_have_warnings() {
    let place = Place::with_blocks(|text| swap(&text, "density = 7100", "density = 7.1e-9"), &PadOnDisc::default());
    let warning =
        "warning: density of material \"iron\" is 7.100e-9 kg/m3. Was it given in t/mm3? That is 7100 kg/m3\n";
    let finished = place.run(&["stability", "brake.toml", "-o", "run"]);
    assert_eq!((finished.code, finished.err.as_str()), (0, warning));
    assert!(finished.out.contains("\nunknown: no mode lies in the band"), "{}", finished.out);
    assert!(finished.out.contains("\ndoubt: density of material"), "{}", finished.out);
    for command in [&["check", "brake.toml"][..], &["modes", "brake.toml", "--part", "disc", "-o", "part"]] {
        assert!(place.run(command).err.contains(warning), "{command:?}");
    }
    let check = place.run(&["check", "brake.toml", "--json"]);
    assert!(check.out.contains("Was it given in t/mm3?") && check.err.starts_with("{\"warning\":"), "{}", check.err);
    // All modes of fewer than a thousand dofs may be asked for.
    let fine = PadOnDisc { pad_cells: 6, ..PadOnDisc::default() };
    let place = Place::with_blocks(|text| swap(&text, "density = 7100", "density = 7100e12"), &fine);
    let finished = place.run(&["stability", "brake.toml", "-o", "run"]);
    assert_eq!(finished.code, 2);
    assert!(
        finished.err.contains("modes lie below 20000 Hz, of ") && finished.err.contains("Look at the units"),
        "{}",
        finished.err
    );
}

/// The residual of an equilibrium is relative to its forces, however small they are.
#[test]
fn a_small_load_has_an_exact_equilibrium_too() {
    for force in ["-1e-2]", "-1e-5]"] {
        let place = Place::with_blocks(|text| swap(&text, "-1000]", force), &PadOnDisc::default());
        assert_eq!(place.run(&["static", "brake.toml", "-o", "run"]).code, 0);
        let table = place.read("run/convergence.csv");
        let last = table.lines().last().unwrap().split(',').nth(3).unwrap().parse::<f64>().unwrap();
        assert!(last <= 1e-9, "{force}\n{table}");
    }
}

#[test]
fn options_reach_petsc() {
    let place = Place::blocks();
    let quiet = place.run(&["static", "brake.toml", "-o", "quiet"]);
    let monitored = place.run(&["static", "brake.toml", "-o", "run", "--petsc", "-equilibrium_snes_monitor"]);
    assert!(!monitored.err.contains("has not read"), "{}", monitored.err);
    let unknown = place.run(&["static", "brake.toml", "-o", "unknown", "--petsc", "-equilibrium_snes_monitr"]);
    let warning = "warning: --petsc: this command has not read the option -equilibrium_snes_monitr.";
    assert!(unknown.code == 0 && unknown.err.contains(warning), "{}", unknown.err);
    assert!(!quiet.out.contains("SNES Function norm") && monitored.out.contains("0 SNES Function norm"));
    assert_eq!((quiet.code, monitored.code), (0, 0));
    let view =
        place.command().args(["static", "brake.toml", "-o", "view", "--petsc", "-equilibrium_snes_view"]).output();
    let lines: Vec<String> = BufReader::new(&view.unwrap().stdout[..]).lines().map_while(Result::ok).collect();
    assert!(lines.iter().any(|line| line.contains("SNES Object: (equilibrium_)")), "{lines:?}");
}

/// A pad 0.05 mm above its disc, as CAD leaves it.
#[test]
fn a_clearance_is_closed_by_adjust() {
    let mesh = || PadOnDisc { gap: 0.05, ..PadOnDisc::default() };
    let open = Place::with_blocks(|text| text, &mesh()).run(&["check", "brake.toml"]);
    assert_eq!(open.code, 2);
    assert!(open.err.contains("(at least 5.000e-2, in the mesh's unit) by adjust = DISTANCE"), "{}", open.err);
    let adjusted = |text: String| swap(&text, "friction = 0.4", "friction = 0.4\nadjust = 0.06");
    let check = Place::with_blocks(adjusted, &mesh()).run(&["check", "brake.toml"]);
    assert_eq!(check.code, 0, "{}", check.err);
    assert!(check.out.contains("points are closed, the largest 5.00e-2 mm"), "{}", check.out);
}
