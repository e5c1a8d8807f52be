use super::*;
use crate::equilibrium::{Counts, Iteration, PairForces, Step, Wrench};
use crate::results::{Certificate, CertifiedMode, Kind};
use crate::results::{Failure, Pair, Part};
use crate::stability::{Count, CountedBy, Sensitivity, Share};
use crate::tracking::Partner;

fn shape(n: usize, seed: f32) -> Shape {
    let part = |sign: f32| (0..n).map(|i| [sign * seed + i as f32, 1e-7, -seed]).collect();
    Shape { re: part(1.0), im: part(-1.0) }
}

fn source(friction: Option<Complex64>) -> Source {
    let share = Share { kinetic: 0.25, strain: 1.0 / 3.0, energy_input: 3e-5, dissipation: -0.0 };
    let [mass, damping, stiffness] = [0.1, 0.2, 0.7].map(|x| Complex64::new(x, -x));
    let sensitivity = friction.map(|_| Sensitivity { mass, damping, stiffness });
    Source { kind: Kind::Contact, name: "disc / \"pad\"".into(), share, sensitivity, friction }
}

fn value(friction: f64, asked: bool) -> Value {
    let counts = Counts { open: 1, stick: 2, slip: 3 };
    let mode = |i: usize| ModeData {
        lambda: Complex64::new(0.1 + i as f64, 1.0 / 3.0),
        backward_error: 1e-14,
        unstable: i == 1,
        sampled: shape(2, i as f32),
        shape: (asked && i == 1).then(|| shape(4, 0.3)),
        sources: if i == 1 { vec![source(Some(Complex64::I)), source(None)] } else { Vec::new() },
    };
    // A diverged iteration is kept, too.
    let iteration = |residual| Iteration { residual, counts, flips: vec![0, 4] };
    Value {
        friction,
        asked,
        pairs: vec![PairForces {
            counts,
            normal: 1000.1,
            tangential: 0.1,
            on_slave: Wrench { force: [1.0, 2.0, 3.0], moment: [0.1; 3] },
            closed_area: 1e-4,
            peak_pressure: 1e6,
            peak_force: 3.0,
            rounding: 1e-7,
        }],
        checks: "balance\nof two lines".into(),
        steps: vec![Step { label: "settle".into(), converged: true, iterations: vec![iteration(1e-9)] }],
        pressure: vec![1e6, 0.0],
        status: vec![1, -1],
        modes: (0..3).map(mode).collect(),
        count: Some(Count { below: 1e4, expected: 3, found: 3, by: CountedBy::SturmCount }),
        certificate: asked.then(|| Certificate {
            friction,
            equilibrium_error: 1e-5,
            modes: vec![CertifiedMode { lambda: Complex64::I, corrected: Complex64::ONE, backward_error: 1e-6 }],
        }),
        seconds: 1.25,
    }
}

fn results() -> Results {
    let point = |value| Point { value, lambda: Complex64::new(0.1, 0.2), mode: 2 };
    let partner = Some(Partner { branch: 0, share: 0.49 });
    let hopf = Hopf { branch: 1, bracket: [0.3, 0.301], value: 0.3004, omega: 1e4, onset: true, partner };
    Results {
        about: About {
            title: "Bremse, 23 °C".into(),
            friction_values: vec![0.1, 0.3],
            band: [0.0, 6000.0],
            parts: vec![Part { name: "disc".into(), material: "iron".into(), mass: 0.1 + 0.2 }],
            pairs: vec![Pair {
                name: "disc / pad".into(),
                sliding: true,
                swept: true,
                n_points: 6,
                proposed_stiffness: Some(1.3e13),
            }],
            ..About::default()
        },
        surface: Surface {
            nodes: vec![[0.1; 3]; 4],
            triangles: vec![[0, 1, 2], [1, 2, 3]],
            part: vec![0, 0],
            samples: vec![1, 3],
        },
        contact: ContactFaces { nodes: vec![[0.2; 3]; 2], pair_of_node: vec![0, 0], ..ContactFaces::default() },
        values: vec![value(0.1, true), value(0.2, false), Value { modes: Vec::new(), count: None, ..value(0.3, true) }],
        diagram: Some(Diagram {
            values: vec![0.1, 0.2],
            branches: vec![Branch { points: vec![point(0.1)] }, Branch { points: vec![point(0.1), point(0.2)] }],
            hopf: vec![hopf, Hopf { partner: None, ..hopf }],
            doubtful: vec![[0.1, 0.2]],
        }),
        costs: "12 s".into(),
        failure: None,
    }
}

/// What a message says of a file.
#[track_caller]
fn refused(path: &Path, says: &str) {
    let message = read(path).unwrap_err().to_string();
    assert!(message.contains(says) && message.contains("results.h5"), "{message}");
}

#[test]
fn what_is_written_is_read_to_the_last_bit() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("results.h5");
    let mut whole = results();
    write(&path, &whole).unwrap();
    assert_eq!(read(&path).unwrap(), whole);
    let steps = whole.values[0].steps.clone();
    whole.failure = Some(Failure { reason: "no equilibrium".into(), friction: Some(0.4), steps });
    whole.diagram = None;
    write(&path, &whole).unwrap();
    assert_eq!(read(&path).unwrap(), whole);
    assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 1, "no draft is left");
    let empty = Results::default();
    write(&path, &empty).unwrap();
    assert_eq!(read(&path).unwrap(), empty);
}

/// A diverged step has a residual that is no number.
#[test]
fn a_residual_may_be_no_number() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("results.h5");
    let mut results = results();
    let iterations = &mut results.values[0].steps[0].iterations;
    iterations[0].residual = f64::NAN;
    iterations.push(Iteration { residual: f64::INFINITY, ..iterations[0].clone() });
    write(&path, &results).unwrap();
    let found = read(&path).unwrap();
    let residuals: Vec<f64> = found.values[0].steps[0].iterations.iter().map(|it| it.residual).collect();
    assert!(residuals[0].is_nan() && residuals[1] == f64::INFINITY);
}

#[test]
fn files_that_are_none_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("results.h5");
    refused(&path, "No such file");
    std::fs::write(&path, "friction,mode\n").unwrap();
    refused(&path, "nor any other HDF5 file");
    File::create(&path).unwrap().close().unwrap();
    refused(&path, "not of the kind \"squeal results\"");
    write(&path, &results()).unwrap();
    let file = File::open_rw(&path).unwrap();
    file.attr("version").unwrap().write_scalar(&7).unwrap();
    file.close().unwrap();
    refused(&path, "is of version 7, this program reads version 2");
    write(&path, &results()).unwrap();
    let file = File::open_rw(&path).unwrap();
    file.dataset("surface/samples").unwrap().write_raw(&[1_u32, 9]).unwrap();
    file.close().unwrap();
    refused(&path, "names nodes that it does not have");
}

/// A file cut anywhere, or with a flipped bit in what it says, is refused or says the same as before.
#[test]
fn damage_is_noticed() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("results.h5");
    let whole = results();
    write(&path, &whole).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    for part in [0.1, 0.5, 0.9, 0.9999] {
        std::fs::write(&path, &bytes[..(part * bytes.len() as f64) as usize]).unwrap();
        refused(&path, "incomplete or damaged");
    }
    let mut n_refused = 0;
    for at in (0..bytes.len()).step_by(bytes.len() / 400) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 4;
        std::fs::write(&path, &flipped).unwrap();
        match read(&path) {
            Ok(found) => assert_eq!(found, whole, "byte {at}"),
            Err(_) => n_refused += 1,
        }
    }
    assert!(n_refused > 100, "{n_refused}");
}
