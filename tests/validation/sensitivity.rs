//! Probability of squeal and Sobol indices of Hulten's oscillator with random friction and damping: against exact
//! integrals, and against SALib from the same values.
//!
//! ```text
//! (lambda^2 + e_1 w_1 lambda + w_1^2) (lambda^2 + e_2 w_2 lambda + w_2^2) + mu^2 w_1^2 w_2^2 = 0
//! ```
//!
//! Sources: Sinou and Jezequel, Eur. J. Mech. A 26 (2007) for the model; Iwanaga, Usher and Herman, Socio-Environ.
//! Syst. Model. 4 (2022) for SALib.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

use nalgebra::Matrix4;
use squeal::explore::{Design, DesignKind, Distribution, Indices, Probability, sobol_indices};

/// `w_1`, `w_2`, 1/s.
const OMEGA: [f64; 2] = [TAU * 100.0, TAU * 75.0];
const NAMES: [&str; 3] = ["mu", "e1", "e2"];
/// Of mu, `e_1` and `e_2`, all uniform.
const RANGES: [[f64; 2]; 3] = [[0.2, 0.4], [0.01, 0.05], [0.02, 0.08]];

/// Coefficients of the characteristic polynomial from `lambda^3` down.
fn polynomial([mu, e1, e2]: [f64; 3]) -> [f64; 4] {
    let [w1, w2] = OMEGA;
    [
        e1 * w1 + e2 * w2,
        w1 * w1 + w2 * w2 + e1 * e2 * w1 * w2,
        e1 * w1 * w2 * w2 + e2 * w2 * w1 * w1,
        (1.0 + mu * mu) * (w1 * w2).powi(2),
    ]
}

/// The largest growth rate, 1/s: the companion matrix, in units of `w_2`.
fn growth(values: [f64; 3]) -> f64 {
    let [a, b, c, d] = polynomial(values);
    let w = OMEGA[1];
    #[rustfmt::skip]
    let companion = Matrix4::new(
        -a / w, -b / w.powi(2), -c / w.powi(3), -d / w.powi(4),
        1.0, 0.0, 0.0, 0.0,
        0.0, 1.0, 0.0, 0.0,
        0.0, 0.0, 1.0, 0.0,
    );
    w * companion.complex_eigenvalues().iter().map(|z| z.re).fold(f64::NEG_INFINITY, f64::max)
}

/// The friction coefficient of the Hopf point by Hurwitz: `a_1 a_2 a_3 = a_3^2 + a_1^2 a_4`.
fn onset(e1: f64, e2: f64) -> f64 {
    let [a1, a2, a3, a4] = polynomial([0.0, e1, e2]);
    ((a1 * a2 * a3 - a3 * a3) / (a1 * a1 * a4) - 1.0).sqrt()
}

/// Value number i of n in the middles of equal parts of a range.
fn middle(range: [f64; 2], i: usize, n: usize) -> f64 {
    range[0] + (range[1] - range[0]) * (i as f64 + 0.5) / n as f64
}

fn points(kind: DesignKind) -> Vec<[f64; 3]> {
    let distributions = RANGES.map(|[from, to]| Distribution::Uniform { from, to });
    let design = Design { kind, seed: 7, correlation: None };
    let all = design.points(&distributions.each_ref(), &[0.3, 0.03, 0.05]).unwrap();
    all.iter().map(|point| [point[0], point[1], point[2]]).collect()
}

#[test]
fn the_onset_of_hultens_model_is_sinous() {
    assert!((onset(0.02, 0.02) - 0.289_367_13).abs() < 1e-8 && (onset(0.02, 0.06) - 0.271_790_03).abs() < 1e-8);
    assert!(growth([onset(0.02, 0.06), 0.02, 0.06]).abs() < 1e-9 * OMEGA[0]);
}

/// `P = E((0.4 - mu_H) / 0.2)`, over both dampings.
#[test]
fn the_squeal_probability_of_hultens_model_is_exact() {
    let n = 200;
    let [low, high] = RANGES[0];
    let given = |k: usize| {
        let mu = onset(middle(RANGES[1], k / n, n), middle(RANGES[2], k % n, n));
        ((high - mu) / (high - low)).clamp(0.0, 1.0)
    };
    let exact = (0..n * n).map(given).sum::<f64>() / (n * n) as f64;
    let sample = points(DesignKind::Sobol { n_points: 1024 });
    let n_unstable = sample.iter().filter(|point| growth(**point) > 0.0).count();
    let found = Probability::of(n_unstable, sample.len());
    assert!((found.value - exact).abs() < 2e-3, "{found:?}, exact {exact}");
    assert!(found.low < exact && exact < found.high);
}

fn hultens_indices(n_base: usize) -> (Vec<f64>, Vec<Indices>) {
    let values: Vec<f64> = points(DesignKind::Saltelli { n_base }).into_iter().map(growth).collect();
    let all: Vec<Option<f64>> = values.iter().copied().map(Some).collect();
    (values, sobol_indices(&NAMES, &all, 7).unwrap())
}

/// Variances of conditional means, on a grid of the middles of equal parts.
#[test]
fn the_indices_of_hultens_model_are_those_of_exact_integrals() {
    const N: usize = 40;
    let place = |k: usize| [k / N / N, k / N % N, k % N];
    let at = |k: usize| growth(std::array::from_fn(|i| middle(RANGES[i], place(k)[i], N)));
    let f: Vec<f64> = (0..N * N * N).map(at).collect();
    let mean = f.iter().sum::<f64>() / f.len() as f64;
    let variance = f.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / f.len() as f64;
    // The share of the variance of the means over the points of each class.
    let share = |n_classes: usize, class: &dyn Fn([usize; 3]) -> usize| {
        let mut sums = vec![0.0; n_classes];
        f.iter().enumerate().for_each(|(k, x)| sums[class(place(k))] += x);
        let part = n_classes as f64 / f.len() as f64;
        sums.iter().map(|sum| (part * sum - mean).powi(2)).sum::<f64>() / n_classes as f64 / variance
    };
    let (_, found) = hultens_indices(1024);
    for (i, own) in found.iter().enumerate() {
        let first = share(N, &|k| k[i]);
        let total = 1.0 - share(N * N, &|k| N * k[(i + 1) % 3] + k[(i + 2) % 3]);
        println!("{}: {:.4} {first:.4}, {:.4} {total:.4}", own.parameter, own.first_order.value, own.total.value);
        assert!((own.first_order.value - first).abs() < 0.01, "{own:?}, exact {first}");
        assert!((own.total.value - total).abs() < 0.01, "{own:?}, exact {total}");
    }
}

/// The same estimators (Saltelli 2010, Jansen) from the same values, but for the variance of the values, which SALib
/// divides by their number 2 n, and the program by 2 n - 1.
#[test]
#[ignore = "installs SALib from PyPI: make validation"]
fn salib_finds_the_same_indices() {
    const SCRIPT: &str = "\
import sys, numpy
from SALib.analyze.sobol import first_order, total_order
y = numpy.array([float(x) for x in sys.stdin.read().split()]).reshape(-1, 5)
y -= y[:, :2].mean()
a, b = y[:, 0], y[:, 1]
for ab in y.T[2:]: print(repr(float(first_order(a, ab, b))), repr(float(total_order(a, ab, b))))
";
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("salib");
    let python = folder.join("bin/python");
    let run = |command: &mut Command| {
        let out = command.output().unwrap();
        assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8(out.stdout).unwrap()
    };
    if !folder.join("complete").exists() {
        run(Command::new("python3").args(["-m", "venv"]).arg(&folder));
        run(Command::new(&python).args(["-m", "pip", "install", "--quiet", "SALib==1.6.0"]));
        std::fs::write(folder.join("complete"), "").unwrap();
    }
    let (values, found) = hultens_indices(256);
    let mut text = String::new();
    values.iter().for_each(|value| writeln!(text, "{value:e}").unwrap());
    let file = folder.join("values.txt");
    std::fs::write(&file, text).unwrap();
    let out = run(Command::new(&python).args(["-c", SCRIPT]).stdin(std::fs::File::open(&file).unwrap()));
    let theirs: Vec<f64> = out.split_whitespace().map(|x| x.parse().unwrap()).collect();
    assert_eq!(theirs.len(), 6, "{out}");
    let found = found.iter().flat_map(|own| [own.first_order.value, own.total.value]);
    for (own, theirs) in found.zip(theirs) {
        let expected = (1.0 - 1.0 / 512.0) * theirs;
        println!("{own} {expected}");
        assert!((own - expected).abs() < 1e-12, "{own} {expected}");
    }
}
