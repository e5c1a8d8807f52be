//! Mode shapes of `squeal explore`: those of `squeal stability` at the same point, on any number of ranks.

use num_complex::Complex64;
use squeal::results::{Results, Shape, file};

use crate::explore::{EXPLORE, done, lambda, number, table};
use crate::support::pad_on_disc::PadOnDisc;
use crate::support::program::Place;

/// A study of the small pad on its disc, whose first point is stable; the last one fails.
const STUDY: &str = "model = \"brake.toml\"\nband = [0, 60000]\n\
    [design]\nkind = \"list\"\nfile = \"points.csv\"\n\
    [parameter.mu]\nkey = \"friction\"\nuniform = [0.0, 0.8]\n\
    [parameter.density]\nkey = \"material.iron.density\"\nuniform = [6500, 7500]\n";
const POINTS: &str = "mu,density\n0.0,6700\n0.9,7300\n0.6,7400\n0.5,7000\n3,7000\n";

/// The small pad with damping, by which stable modes differ in their growth rates; it squeals above 0.4.
fn damped() -> Place {
    Place::with_blocks(|text| text + "[part.pad.rayleigh]\nalpha = 5\nbeta = 1e-8\n", &PadOnDisc::default())
}

/// A mode with its shape in a study: point, eigenvalue, displacements.
struct Shaped {
    point: usize,
    lambda: Complex64,
    u: Vec<Complex64>,
}

/// The shapes of a study, in the order of its modes.
fn shaped(place: &Place, run: &str) -> Vec<Shaped> {
    let file = hdf5::File::open(place.path(&format!("{run}/results.h5"))).unwrap();
    let shapes = file.dataset("shapes").unwrap();
    let n_nodes = file.dataset("surface/nodes").unwrap().shape()[0];
    let rows: Vec<u32> = file.dataset("shaped").unwrap().read_raw().unwrap();
    assert_eq!(shapes.shape(), [rows.len(), n_nodes, 3, 2]);
    let modes = table(place, &format!("{run}/modes.csv"));
    let numbers: Vec<f32> = shapes.read_raw().unwrap();
    let numbers = numbers.as_chunks().0.iter().map(|&[re, im]| Complex64::new(re.into(), im.into()));
    let numbers: Vec<Complex64> = numbers.collect();
    let of = |(i, row): (usize, &u32)| {
        let mode = &modes[*row as usize];
        let u = numbers[3 * n_nodes * i..3 * n_nodes * (i + 1)].to_vec();
        Shaped { point: number(mode, "point") as usize, lambda: lambda(mode), u }
    };
    rows.iter().enumerate().map(of).collect()
}

fn displacements(shape: &Shape) -> Vec<Complex64> {
    let pairs = shape.re.as_flattened().iter().zip(shape.im.as_flattened());
    pairs.map(|(&re, &im)| Complex64::new(re.into(), im.into())).collect()
}

/// Their relative distance, whatever the phase and the scale of the second one.
fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    assert!(a.len() == b.len() && !a.is_empty());
    let product: Complex64 = b.iter().zip(a).map(|(b, a)| b.conj() * a).sum();
    let norm = |v: &[Complex64]| v.iter().map(Complex64::norm_sqr).sum::<f64>();
    let factor = product / norm(b);
    let rest: f64 = a.iter().zip(b).map(|(a, b)| (a - factor * b).norm_sqr()).sum();
    (rest / norm(a)).sqrt()
}

/// That the shapes of a point are those of the same modes in results of `squeal stability`, where these have shapes.
#[track_caller]
fn assert_those_of_stability(own: &[Shaped], point: usize, results: &Results) {
    let modes: Vec<_> = results.modes().map(|(_, _, mode)| mode).collect();
    let shaped: Vec<&Shaped> = own.iter().filter(|own| own.point == point).collect();
    let n_unstable = modes.iter().filter(|mode| mode.unstable).count();
    assert!(n_unstable > 0 && shaped.len() == n_unstable.min(3), "{} of {n_unstable}", shaped.len());
    for own in shaped {
        let same = |lambda: Complex64| (lambda - own.lambda).norm() < 1e-8 * own.lambda.norm();
        let mode = modes.iter().find(|mode| same(mode.lambda)).expect("the same mode");
        let expected = displacements(mode.shape.as_ref().expect("unstable modes have shapes"));
        assert!(distance(&own.u, &expected) < 1e-5, "{}: {:.1e}", own.lambda, distance(&own.u, &expected));
        let largest = own.u.iter().fold(0.0_f64, |most, u| most.max(u.norm()));
        assert!((largest - 1.0).abs() < 1e-6, "{largest}");
    }
}

fn read(place: &Place, run: &str) -> Results {
    file::read(&place.path(&format!("{run}/results.h5"))).unwrap()
}

#[track_caller]
fn assert_same_shapes(place: &Place, runs: [&str; 2]) {
    let [one, two] = runs.map(|run| shaped(place, run));
    assert_eq!(one.len(), two.len());
    for (a, b) in one.iter().zip(&two) {
        assert!(a.point == b.point && (a.lambda - b.lambda).norm() < 1e-9 * a.lambda.norm());
        assert!(distance(&a.u, &b.u) < 1e-5, "{} {}: {:.1e}", a.point, a.lambda, distance(&a.u, &b.u));
    }
}

#[test]
fn shapes_of_points_are_those_of_stability_on_one_rank_and_on_two() {
    let place = damped();
    place.write("explore.toml", STUDY);
    place.write("points.csv", POINTS);
    done(place.run(&EXPLORE));
    let own = shaped(&place, "run");
    let points: Vec<usize> = own.iter().map(|own| own.point).collect();
    assert!((0..5).all(|point| points.contains(&point)) && !points.contains(&5), "{points:?}");
    assert_eq!(points.iter().filter(|point| **point == 1).count(), 1, "a stable point has the shape of one mode");
    for (point, mu, density) in [(2, 0.9, 7300), (3, 0.6, 7400)] {
        let model = place.read("brake.toml").replace("density = 7100", &format!("density = {density}"));
        place.write("point.toml", model);
        let options = ["--band", "0:60000", "--friction", &mu.to_string(), "-o", "point", "--force"];
        done(place.run(&[&["stability", "point.toml"][..], &options].concat()));
        let results = read(&place, "point");
        assert_those_of_stability(&own, point, &results);
        let file = hdf5::File::open(place.path("run/results.h5")).unwrap();
        let nodes: Vec<f64> = file.dataset("surface/nodes").unwrap().read_raw().unwrap();
        assert_eq!(nodes, results.surface.nodes.as_flattened());
    }
    done(place.run_on(2, &["explore", "explore.toml", "-o", "together"]));
    done(place.run_on(2, &["explore", "explore.toml", "--ranks-per-point", "1", "-o", "apart"]));
    assert_same_shapes(&place, ["run", "together"]);
    assert_same_shapes(&place, ["run", "apart"]);
}

#[test]
fn a_layout_and_its_super_element_have_shapes() {
    let place = damped();
    let reduce = ["reduce", "brake.toml", "--contacts", "4", "--limit", "240000", "--output", "brake.se.h5"];
    done(place.run(&reduce));
    let study = "model = \"MODEL\"\nband = [0, 90000]\n[design]\nkind = \"one-at-a-time\"\n\
        [parameter.mu]\nkey = \"friction\"\nvalues = [0.2, 0.5]\n";
    let layout = study.replace("model = \"MODEL\"", "contacts = 4\nmodel = \"brake.toml\"");
    for (model, study, options) in [
        ("brake.se.h5", study.replace("MODEL", "brake.se.h5"), &[][..]),
        ("brake.toml", layout, &["--contacts", "4"][..]),
    ] {
        place.write("explore.toml", study);
        done(place.run(&["explore", "explore.toml", "-o", "run", "--force"]));
        let points = table(&place, "run/points.csv");
        let point = (0..points.len()).find(|&i| number(&points[i], "mu") == 0.5).unwrap();
        let alone = ["stability", model, "--band=0:90000", "--friction", "0.5", "-o", "alone", "--force"];
        done(place.run(&[&alone[..], options].concat()));
        assert_those_of_stability(&shaped(&place, "run"), point, &read(&place, "alone"));
    }
}

/// A file of a super-element that has no surface, as another program may write it.
#[test]
fn a_super_element_without_a_surface_has_no_shapes_and_its_page_says_so() {
    let place = damped();
    done(place.run(&["reduce", "brake.toml", "--contacts", "4", "--limit", "240000", "--output", "brake.se.h5"]));
    let (element, _) = squeal::reduction::file::read(&place.path("brake.se.h5")).unwrap();
    squeal::reduction::file::write(&place.path("bare.se.h5"), &element, &Default::default(), None).unwrap();
    place.write(
        "explore.toml",
        "model = \"bare.se.h5\"\nband = [0, 60000]\n[design]\nkind = \"one-at-a-time\"\n\
         [parameter.mu]\nkey = \"friction\"\nvalues = [0.2, 0.5]\n",
    );
    done(place.run(&EXPLORE));
    assert!(shaped(&place, "run").is_empty());
    let page = place.read("run/explore.html");
    assert!(page.contains("the super-element has no surface") && !page.contains("id=\"shape\""));
}
