//! Minimal friction models with exact eigenvalues: Hoffmann (2 dofs), Hulten/Sinou (2 dofs, damped), NLEVP's `bicycle`
//! and `qep1`. Sources: Hoffmann et al., Mech. Res. Commun. 29 (2002); Sinou and Jezequel, Eur. J. Mech. A 26 (2007);
//! Betcke et al., NLEVP, ACM TOMS 39 (2013); Meijaard et al., Proc. R. Soc. A 463 (2007).

use std::f64::consts::TAU;

use num_complex::Complex64;
use squeal::native::petsc::eigen::{self, Options, Quadratic};
use squeal::native::{Comm, Factor, FactorKind, Matrix, Mck, Session};

use super::table::{Case, Row};

fn dense<const N: usize>(comm: &Comm, a: [[f64; N]; N]) -> Matrix {
    Matrix::dense(comm, N, a.as_flattened()).unwrap()
}

/// All eigenvalues of the closed upper half plane, sorted by imaginary part, equal ones by real part.
fn eigenvalues<const N: usize>(
    comm: &Comm,
    m: [[f64; N]; N],
    c: [[f64; N]; N],
    k: [[f64; N]; N],
    shift: f64,
) -> Vec<Complex64> {
    let mut p = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            p[i][j] = shift * shift * m[i][j] + shift * c[i][j] + k[i][j];
        }
    }
    let [m, c, k, p] = [m, c, k, p].map(|a| dense(comm, a));
    let mut factor = Factor::new(FactorKind::Unsymmetric);
    factor.factorise(&p).unwrap();
    let options = Options { n_wanted: 2 * N, n_basis: 0, tolerance: 1e-15, max_restarts: 100, scale: 0.0 };
    let problem = Quadratic { matrices: Mck::from([&m, &c, &k]), shift, inverse: &|b, x| factor.solve(b, x) };
    let found = eigen::solve(&problem, &options, &mut |_, _| ()).unwrap().unwrap();
    let mut lambdas: Vec<Complex64> = found.pairs.iter().map(|pair| pair.lambda).collect();
    let key = |z: &Complex64| ((z.im * 1e6).round(), z.re);
    lambdas.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap());
    lambdas
}

/// A row for each part of an eigenvalue, relative to its modulus; parts that are exactly zero in both are left out.
fn rows(name: &str, unit: &'static str, found: &[Complex64], expected: &[(f64, f64)], tolerance: f64) -> Vec<Row> {
    assert_eq!(found.len(), expected.len(), "{name}: {found:?}");
    let parts = found.iter().zip(expected).flat_map(|(f, &(re, im))| {
        let part = |part: &str, found: f64, expected: f64| {
            let what = format!("{name}: {part} part of {expected_at}", expected_at = place(re, im));
            Row::new(what, unit, found, expected, tolerance).scaled(f.norm())
        };
        [part("real", f.re, re), part("imaginary", f.im, im)]
    });
    parts.filter(|row| row.expected != 0.0 || row.found != 0.0).collect()
}

/// An eigenvalue's name.
fn place(re: f64, im: f64) -> String {
    if im == 0.0 { format!("{re:.4}") } else { format!("{re:.4} + {im:.4} i") }
}

const IDENTITY: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];
const ZERO: [[f64; 2]; 2] = [[0.0; 2]; 2];

/// `lambda^2 = -2 +- sqrt(1 - 4 mu / 3)`: coalescence at mu = 3/4.
fn hoffmann(comm: &Comm) -> Case {
    let at = |mu: f64| eigenvalues(comm, IDENTITY, ZERO, [[2.0, 1.0 - 4.0 * mu / 3.0], [1.0, 2.0]], 0.0);
    let exact = |mu: f64| {
        let root = Complex64::new(1.0 - 4.0 * mu / 3.0, 0.0).sqrt();
        let [outer, inner] = [root, -root].map(|root| (Complex64::new(-2.0, 0.0) + root).sqrt());
        if mu < 0.75 { [(0.0, outer.im), (0.0, inner.im)] } else { [(-outer.re, outer.im), (outer.re, outer.im)] }
    };
    let row = |mu: f64| rows(&format!("friction {mu}"), "1/s", &at(mu), &exact(mu), 1e-12);
    Case {
        title: "Hoffmann's model",
        text: "Two degrees of freedom that couple at a friction of 3/4. Reference: exact (Hoffmann et al., Mech. Res. Commun. 29, 2002).",
        rows: [0.5, 0.8, 0.9].into_iter().flat_map(row).collect(),
    }
}

/// Damping can advance the instability: at the Hopf point of the unequally damped model a growth rate is zero.
fn hulten_sinou(comm: &Comm) -> Case {
    let (w1, w2) = (TAU * 100.0, TAU * 75.0);
    let mut rows = Vec::new();
    for (e1, e2, mu, hertz) in [(0.02, 0.02, 0.28936713, 86.60254), (0.02, 0.06, 0.27179003, 93.02605)] {
        let c = [[e1 * w1, 0.0], [0.0, e2 * w2]];
        let k = [[w1 * w1, -mu * w2 * w2], [mu * w1 * w1, w2 * w2]];
        let found = eigenvalues(comm, IDENTITY, c, k, 0.0);
        let critical = found.iter().max_by(|a, b| a.re.total_cmp(&b.re)).unwrap();
        let what = |what| format!("damping {e1} and {e2}, friction {mu}: {what}");
        rows.push(Row::new(what("largest growth rate"), "1/s", critical.re, 0.0, 1e-5).scaled(critical.im));
        rows.push(Row::new(what("its frequency"), "Hz", critical.im / TAU, hertz, 2e-5));
    }
    Case {
        title: "Hultén's model at its Hopf points",
        text: "Two damped degrees of freedom (Sinou and Jézéquel, Eur. J. Mech. A 26, 2007). At the exact friction of the Hopf point the \
               growth rate is zero; more damping makes it earlier.",
        rows,
    }
}

/// The uncontrolled bicycle of Meijaard et al. rides by itself at 5 m/s and weaves at 4 m/s.
fn bicycle(comm: &Comm) -> Case {
    let m = [[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]];
    let k0 = [[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]];
    let k2 = [[0.0, 76.59734589573222], [0.0, 2.65431523794604]];
    let c1 = [[0.0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]];
    let at = |v: f64| {
        let c = c1.map(|row| row.map(|x| v * x));
        let mut k = [[0.0; 2]; 2];
        for i in 0..2 {
            for j in 0..2 {
                k[i][j] = 9.81 * k0[i][j] + v * v * k2[i][j];
            }
        }
        eigenvalues(comm, m, c, k, 0.0)
    };
    let all = [(-14.07838969, 0.0), (-0.32286643, 0.0), (-0.77534188, 4.46486771)];
    let weave = *at(4.0).last().unwrap();
    let mut list = rows("5 m/s", "1/s", &at(5.0), &all, 1e-8);
    list.extend(rows("4 m/s", "1/s", &[weave], &[(0.41325332, 3.07910819)], 1e-8));
    Case {
        title: "NLEVP bicycle",
        text: "The bicycle of Meijaard et al. (Proc. R. Soc. A 463, 2007), which rides by itself at 5 m/s and weaves at 4 m/s. Reference: \
               published (Betcke et al., ACM TOMS 39, 2013).",
        rows: list,
    }
}

/// NLEVP's `qep1`: 1/3, 1/2, 1, i, -i and an infinite eigenvalue; M is singular.
fn qep1(comm: &Comm) -> Case {
    let k = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let c = [[1.0, -6.0, 0.0], [2.0, -7.0, 0.0], [0.0, 0.0, 0.0]];
    let m = [[0.0, 6.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 1.0]];
    let mut found = eigenvalues(comm, m, c, k, 0.0);
    found.retain(|z| z.norm() < 1e6);
    Case {
        title: "NLEVP qep1",
        text: "A quadratic eigenproblem with a singular mass matrix. Reference: exact (Betcke et al., ACM TOMS 39, 2013).",
        rows: rows("qep1", "", &found, &[(1.0 / 3.0, 0.0), (0.5, 0.0), (1.0, 0.0), (0.0, 1.0)], 1e-10),
    }
}

pub fn cases(comm: &Comm) -> Vec<Case> {
    vec![hoffmann(comm), hulten_sinou(comm), bicycle(comm), qep1(comm)]
}

#[test]
fn hoffmann_flutters_above_three_quarters() {
    hoffmann(&Session::start(&[]).unwrap()).verify();
}

#[test]
fn hulten_sinou_is_critical_at_its_hopf_points() {
    hulten_sinou(&Session::start(&[]).unwrap()).verify();
}

#[test]
fn bicycle_rides_by_itself_at_five_metres_a_second() {
    bicycle(&Session::start(&[]).unwrap()).verify();
}

#[test]
fn qep1_gives_its_finite_eigenvalues() {
    qep1(&Session::start(&[]).unwrap()).verify();
}
