//! Comparisons of results of a made-up brake: a plate of two parts, whose shapes are waves.

use super::*;
use crate::results::{About, Part, Shape, Surface};
use crate::tracking::{Branch, Diagram, Point};

/// A square plate of 2 n x n cells, its halves two parts, whose nodes along the seam are apart; every node is a sample.
fn plate(n: usize) -> Surface {
    let mut surface = Surface::default();
    for part in 0..2 {
        let first = surface.nodes.len() as u32;
        let place = |i: usize, j: usize| [part as f64 + i as f64 / n as f64, j as f64 / n as f64, 0.0];
        (0..=n).for_each(|j| surface.nodes.extend((0..=n).map(|i| place(i, j))));
        let node = |i: usize, j: usize| first + (i + j * (n + 1)) as u32;
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            surface.triangles.push([node(i, j), node(i + 1, j), node(i, j + 1)]);
            surface.triangles.push([node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
            surface.part.extend([part; 2]);
        }
    }
    surface.samples = (0..surface.nodes.len() as u32).collect();
    surface
}

/// Mode `k`: a standing wave, which the phase makes a travelling one.
fn wave(surface: &Surface, k: f64, phase: f64) -> Shape {
    let at = |node: &u32| surface.nodes[*node as usize];
    let shape = |f: &dyn Fn([f64; 3]) -> f64| {
        surface.samples.iter().map(|node| [0.0, 0.0, f(at(node)) as f32]).collect::<Vec<[f32; 3]>>()
    };
    Shape { re: shape(&|x| (k * x[0]).cos() * (k * x[1]).sin()), im: shape(&|x| phase * (k * x[0]).sin()) }
}

fn results(surface: Surface, friction_values: &[f64], modes: &[(f64, f64, f64)]) -> Results {
    let part = |name: &str| Part { name: name.into(), ..Part::default() };
    let mode = |&(k, hertz, growth): &(f64, f64, f64)| ModeData {
        lambda: Complex64::new(growth, std::f64::consts::TAU * hertz),
        unstable: growth > 0.0,
        sampled: wave(&surface, k, 0.3),
        ..ModeData::default()
    };
    let value =
        |&friction: &f64| Value { friction, asked: true, modes: modes.iter().map(mode).collect(), ..Value::default() };
    let values = friction_values.iter().map(value).collect();
    let about = About { band: [0.0, 3000.0], parts: vec![part("left"), part("right")], ..About::default() };
    Results { about, surface, values, ..Results::default() }
}

const MODES: [(f64, f64, f64); 3] = [(1.0, 1000.0, -5.0), (2.0, 1500.0, 50.0), (4.0, 2000.0, -20.0)];

#[test]
fn errors_are_relative_to_the_first_result() {
    let a = results(plate(6), &[0.1, 0.2], &MODES);
    let b = results(plate(6), &[0.2, 0.3], &[(1.0, 1010.0, -5.0), (4.0, 1960.0, -10.0), (2.0, 1500.0, 45.0)]);
    let found = compare(&a, &b).unwrap();
    assert_eq!((found.n_points, found.interpolated, found.largest_growth), (98, false, 50.0));
    assert_eq!(found.values.len(), 1);
    let at = &found.values[0];
    assert_eq!((at.friction, at.pairs.len(), &at.unmatched), (0.2, 3, &[vec![], vec![]]));
    let expected = [([1, 1], 0.01, 0.0), ([2, 3], 0.0, -0.1), ([3, 2], -0.02, 0.2)];
    for (pair, (modes, frequency, growth)) in at.pairs.iter().zip(expected) {
        assert_eq!([pair.a.mode, pair.b.mode], modes);
        assert!((pair.frequency_error - frequency).abs() < 1e-12 && (pair.growth_error - growth).abs() < 1e-12);
        assert!((pair.mac - 1.0).abs() < 1e-6, "{}", pair.mac);
    }
    assert!(at.pairs[1].a.unstable && at.pairs[1].b.unstable);
}

#[test]
fn modes_without_partner_are_listed() {
    let a = results(plate(6), &[0.1], &MODES);
    let b = results(plate(6), &[0.1], &[MODES[0], (2.0, 1800.0, 1.0), (9.0, 2000.0, 2.0)]);
    let at = &compare(&a, &b).unwrap().values[0];
    let unpaired = |side: usize| at.unmatched[side].iter().map(|mode| mode.mode).collect::<Vec<_>>();
    assert_eq!((at.pairs.len(), unpaired(0), unpaired(1)), (2, vec![3], vec![3]), "{at:?}");
    // Beyond the other's band a mode has no partner to miss.
    let mut narrow = results(plate(6), &[0.1], &MODES[..2]);
    narrow.about.band[1] = 1600.0;
    assert_eq!(compare(&a, &narrow).unwrap().values[0].unmatched, [vec![], vec![]]);
}

#[test]
fn samples_in_another_order_are_matched_by_their_places() {
    let a = results(plate(6), &[0.1], &MODES);
    let mut other = plate(6);
    other.samples.reverse();
    other.samples.truncate(80);
    let found = compare(&a, &results(other, &[0.1], &MODES)).unwrap();
    assert!(!found.interpolated && found.n_points == 80);
    assert!(found.values[0].pairs.iter().all(|pair| (pair.mac - 1.0).abs() < 1e-6));
}

#[test]
fn another_mesh_is_interpolated() {
    let (a, b) = (results(plate(10), &[0.1], &MODES), results(plate(13), &[0.1], &MODES));
    for [a, b] in [[&a, &b], [&b, &a]] {
        let found = compare(a, b).unwrap();
        assert!(found.interpolated && found.n_points == a.surface.samples.len());
        let macs: Vec<f64> = found.values[0].pairs.iter().map(|pair| pair.mac).collect();
        assert!(macs.len() == 3 && macs.iter().all(|mac| *mac > 0.999), "{macs:?}");
    }
}

#[test]
fn what_has_nothing_in_common_is_refused() {
    let refusal = |a: &Results, b: &Results| match compare(a, b) {
        Err(error @ Error::Input(_)) => error.to_string(),
        other => panic!("{other:?}"),
    };
    let a = results(plate(6), &[0.1, 0.2], &MODES);
    let message = refusal(&a, &results(plate(6), &[0.3], &MODES));
    assert!(message.contains("no common friction: 0.1, 0.2 and 0.3"), "{message}");
    let mut high = results(plate(6), &[0.1], &MODES);
    high.about.band = [4000.0, 5000.0];
    assert!(refusal(&a, &high).contains("no common band: 0-3000 Hz and 4000-5000 Hz"));
    let mut moved = results(plate(6), &[0.1], &MODES);
    moved.surface.nodes.iter_mut().for_each(|node| node[1] += 0.5);
    let message = refusal(&a, &moved);
    assert!(message.contains("do not coincide") && message.contains("\"left\""), "{message}");
    let mut larger = results(plate(6), &[0.1], &MODES);
    larger.surface.nodes.iter_mut().for_each(|node| node[1] *= 2.1);
    assert!(refusal(&larger, &a).contains("do not coincide") && refusal(&a, &larger).contains("do not coincide"));
    let mut renamed = results(plate(6), &[0.1], &MODES);
    renamed.about.parts[1].name = "disc".into();
    assert!(refusal(&a, &renamed).contains("in one of both only"));
    assert!(refusal(&a, &results(Surface::default(), &[0.1], &[])).contains("second results have no shapes"));
}

/// The reference of a study: its modes at two friction values, followed; the first and the third begin to grow.
fn reference() -> Results {
    let mut results = results(plate(6), &[0.2, 0.1], &MODES);
    for (value, growths) in results.values.iter_mut().zip([[3.0, 50.0, 8.0], [-5.0, 50.0, 2.0]]) {
        for (mode, growth) in value.modes.iter_mut().zip(growths) {
            (mode.lambda.re, mode.unstable) = (growth, growth > 0.0);
        }
        value.seconds = 4.0;
    }
    let branch = |i: usize| {
        let point = |value: &Value| Point { value: value.friction, lambda: value.modes[i].lambda, mode: i };
        Branch { points: results.values.iter().rev().map(point).collect() }
    };
    let branches = (0..3).map(branch).collect();
    results.diagram = Some(Diagram { branches, ..Diagram::default() });
    results
}

#[test]
fn a_study_follows_the_two_lowest_instabilities() {
    let reference = reference();
    let mut study = Study::new(&reference);
    assert_eq!((study.friction_values.as_slice(), study.reference.seconds), ([0.1, 0.2].as_slice(), 4.0));
    let frequencies: Vec<f64> = study.reference.curves.iter().map(|curve| curve[0].frequency.round()).collect();
    assert_eq!(frequencies, [1000.0, 1500.0]);
    let unstable: Vec<bool> = study.reference.curves[0].iter().map(|point| point.unstable).collect();
    assert_eq!(unstable, [false, true], "the first grows at the higher value only");

    // The model has the first mode at another frequency and stable, and one that grows where the reference's does not.
    let model = results(
        plate(6),
        &[0.1, 0.2],
        &[(4.0, 2000.0, -1.0), (1.0, 1030.0, -4.0), (2.0, 1500.0, 40.0), (9.0, 2500.0, 7.0)],
    );
    let sizes = Sizes { n_contacts: 4, n_retained: Some(10), n_dofs: 30 };
    study.add("four", [&reference, &model], sizes, None).unwrap();
    let four = &study.models[0];
    assert_eq!([study.found(0, four), study.found(1, four)], [[0, 1], [2, 2]]);
    assert!((four.curves[0][1].frequency - 1030.0).abs() < 1e-9 && four.curves[0][1].mac > 0.9999);
    assert_eq!(four.spurious.len(), 2);
    assert!(four.spurious.iter().all(|point| (point.frequency - 2500.0).abs() < 1e-9 && point.growth_rate == 7.0));
    let errors = &four.errors[1];
    assert!((errors.worst_frequency - 0.03).abs() < 1e-12 && (errors.mean_frequency - 0.01).abs() < 1e-12);
    assert_eq!((errors.n_pairs, errors.unmatched_reference, errors.unmatched_model), (3, 0, 1));
}
