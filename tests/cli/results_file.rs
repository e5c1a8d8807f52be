//! The results file as other programs, other ranks and other forms of the same brake see it.

use std::path::Path;
use std::process::Command;

use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::{Finished, Place};
use squeal::results::{ModeData, Results, Shape, file};

fn results(place: &Place, folder: &str) -> Results {
    file::read(&place.path(&format!("{folder}/results.h5"))).unwrap()
}

/// `|a^H b|^2 / (a^H a b^H b)`, the modal assurance criterion (Allemang and Brown 1982).
fn mac(a: &Shape, b: &Shape) -> f64 {
    assert_eq!(a.re.len(), b.re.len());
    let product = |a: &Shape, b: &Shape| {
        let [ar, ai, br, bi] = [&a.re, &a.im, &b.re, &b.im].map(|part| part.as_flattened());
        (0..ar.len()).fold([0.0; 2], |[re, im], i| {
            let [x, y, u, v] = [ar[i], ai[i], br[i], bi[i]].map(f64::from);
            [re + x * u + y * v, im + x * v - y * u]
        })
    };
    let [re, im] = product(a, b);
    (re * re + im * im) / (product(a, a)[0] * product(b, b)[0])
}

/// The largest displacement, and whether it is 1 and real.
fn is_scaled(shape: &Shape) -> bool {
    let numbers = shape.re.as_flattened().iter().zip(shape.im.as_flattened());
    let (re, im) = numbers.max_by(|a, b| a.0.hypot(*a.1).total_cmp(&b.0.hypot(*b.1))).unwrap();
    (re - 1.0).abs() < 1e-6 && im.abs() < 1e-6
}

/// The manual's lines read the file.
#[test]
fn python_reads_the_file_in_five_lines() {
    let place = Place::pads();
    let finished =
        place.run(&["stability", "brake.toml", "--band", "0:1500", "--friction", "0.4", "-o", "brake-stability"]);
    assert_eq!(finished.code, 0, "{}", finished.err);
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/manual/src/files.md");
    let page = std::fs::read_to_string(page).unwrap();
    let script = page.split("```python\n").nth(1).unwrap().split("```").next().unwrap();
    assert!(script.lines().count() <= 5 && script.contains("h5py"), "{script}");
    let python = Command::new("/usr/bin/python3").args(["-c", script]).current_dir(place.path("")).output().unwrap();
    let Finished { code, out, err } = python.into();
    assert_eq!(code, 0, "{err}");
    let numbers = |text: &str, separator: char| -> Vec<Vec<f64>> {
        text.lines().map(|line| line.split(separator).filter_map(|word| word.parse().ok()).collect()).collect()
    };
    let table = numbers(&place.read("brake-stability/modes.csv"), ',');
    let found = numbers(&out, ' ');
    assert_eq!(found.len(), table.len() - 1);
    for (row, found) in table[1..].iter().zip(&found) {
        let expected = [row[0], row[2], row[3]];
        assert!(
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-11 * b.abs()),
            "{found:?} and {expected:?}"
        );
    }
}

/// Ranks change the numbers of nodes, not the file.
#[test]
fn two_ranks_write_what_one_writes() {
    let place = Place::pads();
    let arguments =
        |folder: &'static str| ["stability", "brake.toml", "--band", "0:1500", "--friction", "0.4", "-o", folder];
    for finished in [place.run(&arguments("one")), place.run_on(2, &arguments("two"))] {
        assert_eq!(finished.code, 0, "{}", finished.err);
    }
    let [one, two] = ["one", "two"].map(|folder| results(&place, folder));
    assert_eq!((&one.surface, one.about.n_ranks, two.about.n_ranks), (&two.surface, 1, 2));
    assert!(one.surface.samples.len() > 500);
    assert_eq!(one.about.mesh_digest, two.about.mesh_digest);
    assert_eq!(one.about.model_text, place.read("brake.toml"));
    // 4 parts of known masses: tests/validation/pads_on_disc.rs.
    let mass = |results: &Results| results.about.parts.iter().map(|part| part.mass).sum::<f64>();
    assert!(mass(&one) > 1.0 && (mass(&one) - mass(&two)).abs() < 1e-12 * mass(&one));
    let [a, b] = [&one.values[0], &two.values[0]];
    assert_eq!((a.modes.len(), &a.status), (b.modes.len(), &b.status));
    assert!(a.pressure.iter().zip(&b.pressure).all(|(p, q)| (p - q).abs() <= 1e-6 * p.abs()));
    let unstable: Vec<&ModeData> = a.modes.iter().filter(|mode| mode.unstable).collect();
    assert_eq!(unstable.len(), 1);
    for (a, b) in a.modes.iter().zip(&b.modes) {
        assert!((a.lambda - b.lambda).norm() < 1e-9 * a.lambda.norm());
        assert!(mac(&a.sampled, &b.sampled) > 1.0 - 1e-6);
        assert_eq!((a.shape.is_some(), b.shape.is_some()), (a.unstable, a.unstable));
        if let (Some(shape), Some(other)) = (&a.shape, &b.shape) {
            assert!(is_scaled(shape) && is_scaled(other) && mac(shape, other) > 1.0 - 1e-6);
            let at_samples = |i: usize| shape.re[one.surface.samples[i] as usize];
            assert!((0..a.sampled.re.len()).all(|i| a.sampled.re[i] == at_samples(i)));
        } else {
            assert!(is_scaled(&a.sampled));
        }
    }
}

/// What is recovered of a super-element is what its model does.
#[test]
fn a_super_element_has_the_shapes_of_its_model_on_two_ranks() {
    let reduction = "[reduction]\ncontacts = 4\nband = [0, 240000]\n";
    let place = Place::with_blocks(|text| text + reduction, &PadOnDisc::default());
    let run = |arguments: &[&str], ranks: usize| {
        let finished = if ranks == 1 { place.run(arguments) } else { place.run_on(ranks, arguments) };
        assert_eq!(finished.code, 0, "{}", finished.err);
    };
    let (band, friction) = ("--band=0:60000", "--friction=0.4");
    run(&["reduce", "brake.toml", "--contacts", "4", "-o", "brake.se.h5"], 1);
    run(&["stability", "brake.toml", "--contacts", "4", friction, band, "-o", "full"], 1);
    run(&["stability", "brake.toml", "--contacts", "4", friction, band, "--reduce-each", "-o", "each"], 1);
    run(&["stability", "brake.se.h5", band, "-o", "reduced"], 1);
    run(&["stability", "brake.se.h5", band, "-o", "reduced-on-two"], 2);
    let full = results(&place, "full");
    assert!(full.values[0].modes.len() > 3 && full.about.mesh_digest.len() == 64);
    for folder in ["reduced", "reduced-on-two", "each"] {
        let other = results(&place, folder);
        assert_eq!(full.surface, other.surface, "{folder}");
        assert_eq!(full.about.mesh_digest, other.about.mesh_digest, "{folder}");
        for (a, b) in full.values[0].modes.iter().zip(&other.values[0].modes) {
            let mac = mac(&a.sampled, &b.sampled);
            println!("{folder}: {:.1} Hz {:.1} Hz, MAC {mac:.6}", a.frequency(), b.frequency());
            assert!(mac > 0.999);
        }
        let [p, q] =
            [&full, &other].map(|r| r.values[0].pairs.iter().map(|pair| pair.peak_pressure).fold(0.0, f64::max));
        let most = other.values[0].pressure.iter().copied().fold(0.0, f64::max);
        assert!((p - q).abs() < 1e-6 * p && (most - q).abs() < 1e-6 * q, "{p} {q} {most}");
    }
}
