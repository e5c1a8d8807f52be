//! Modes that pass others, modes of one frequency, and modes that must not become one.

use super::*;
use crate::assembly::ViscoelasticStiffness;
use crate::model::viscoelastic::{MaxwellElement, ViscoelasticLaw};
use crate::native::{Comm, Mck, Session};
use crate::stability::Viscoelastic;
use crate::stability::testing::{dense, diagonal, entries};

const OMEGA_0: f64 = 10.0;

fn law() -> ViscoelasticLaw {
    ViscoelasticLaw::Maxwell(vec![MaxwellElement { ratio: 4.0, relaxation_time: 0.1 }])
}

/// Refines the modes of unit masses on springs, some of them viscoelastic (frequencies at rest in rad/s), and on weak
/// ones between neighbours. Gives each with the norm of its residual.
fn refined(comm: &Comm, elastic: &[f64], at_rest: &[f64], coupling: f64) -> Vec<(Ritz, f64)> {
    let n = elastic.len() + at_rest.len();
    let r = law().factor(Complex64::new(0.0, OMEGA_0));
    let k_m = DMatrix::from_fn(n, n, |i, j| match i.checked_sub(elastic.len()) {
        Some(own) if i == j => at_rest[own].powi(2),
        _ => 0.0,
    });
    let k = DMatrix::from_fn(n, n, |i, j| match (i.abs_diff(j), elastic.get(i)) {
        (0, Some(omega)) => omega * omega,
        (0, None) => r.re * k_m[(i, i)],
        (1, _) => -coupling,
        _ => 0.0,
    });
    let [m, c, k] = [diagonal(comm, &vec![1.0; n]), diagonal(comm, &vec![0.0; n]), dense(comm, &k)];
    let stiffnesses = [ViscoelasticStiffness { law: law(), stiffness: dense(comm, &k_m) }];
    let viscoelastic = Viscoelastic { stiffnesses: &stiffnesses, reference: OMEGA_0 };
    let problem = QuadraticProblem { viscoelastic, ..QuadraticProblem::symmetric(Mck::from([&m, &c, &k])) };
    let matrices: Vec<DMatrix<f64>> = problem.all_matrices().into_iter().map(entries).collect();
    let start: Vec<Ritz> = (0..n)
        .map(|i| {
            let square = elastic.get(i).map_or_else(|| r * k_m[(i, i)], |omega| (omega * omega).into());
            let re = (0..n).map(|row| if row == i { 1.0 } else { 0.0 }).collect();
            Ritz { lambda: Complex64::I * square.sqrt(), re, im: vec![0.0; n] }
        })
        .collect();
    let found = refine(&Projection { problem: &problem, matrices: &matrices }, &start).unwrap().unwrap();
    let residual = |ritz: &Ritz| {
        let pair = Pair::of(ritz);
        let terms = problem.coefficients(ritz.lambda).into_iter().zip(&matrices);
        let mut sum = vec![Complex64::ZERO; n];
        terms.for_each(|(f, a)| sum.iter_mut().zip(times(a, &pair.y)).for_each(|(z, x)| *z += f * x));
        norm(&sum)
    };
    found.into_iter().map(|ritz| (ritz.clone(), residual(&ritz))).collect()
}

fn require_solved(found: &[(Ritz, f64)]) {
    assert!(found.iter().all(|(_, residual)| *residual < 1e-10), "{:?}", found.iter().map(|f| f.1).collect::<Vec<_>>());
    let pairs: Vec<Pair> = found.iter().map(|(ritz, _)| Pair::of(ritz)).collect();
    assert!(are_distinct(&pairs));
}

/// `s^2 + omega^2 (1 + 4 s tau / (1 + s tau)) = 0` of a single mass.
#[test]
fn a_mode_is_at_its_own_frequency() {
    let found = refined(&Session::start(&[]).unwrap(), &[], &[3.0], 0.0);
    require_solved(&found);
    let s = found[0].0.lambda;
    assert!((s * s + 9.0 * law().factor(s)).norm() < 1e-11 && s.im > 3.0, "{s}");
}

#[test]
fn modes_of_one_frequency_stay_as_many() {
    let found = refined(&Session::start(&[]).unwrap(), &[], &[3.0, 3.0, 3.0], 0.0);
    require_solved(&found);
    assert!(found.iter().all(|(ritz, _)| (ritz.lambda - found[0].0.lambda).norm() < 1e-11));
}

/// The viscoelastic mass begins above masses of 4.0 to 4.3 rad/s and ends below.
#[test]
fn a_mode_passes_others_on_its_way() {
    let comm = Session::start(&[]).unwrap();
    for coupling in [0.0, 0.01, 0.3] {
        let found = refined(&comm, &[4.0, 4.1, 4.2, 4.3], &[2.5], coupling);
        require_solved(&found);
    }
}

#[test]
fn two_modes_with_parallel_vectors_are_one() {
    let pair =
        |lambda: f64, y: [f64; 2]| Pair { lambda: Complex64::new(0.0, lambda), y: y.map(Complex64::from).to_vec() };
    assert!(!are_distinct(&[pair(1.0, [1.0, 0.0]), pair(1.0, [-1.0, 0.0])]));
    assert!(are_distinct(&[pair(1.0, [1.0, 0.0]), pair(1.0, [0.0, 1.0])]));
    assert!(are_distinct(&[pair(1.0, [1.0, 0.0]), pair(1.1, [1.0, 0.0])]));
}

#[test]
fn those_next_to_a_mode_go_with_it_by_frequency_and_growth() {
    let pair = |re: f64, im: f64| Pair { lambda: Complex64::new(re, im), y: vec![Complex64::ONE] };
    let pairs = [pair(0.0, 1.0), pair(0.0, 2.0), pair(0.1e-3, 2.0), pair(0.0, 2.001), pair(0.0, 2.1)];
    assert_eq!(cluster(&pairs, 1), [1, 2, 3]);
    assert_eq!(cluster(&pairs, 0), [0]);
    let lambdas: Vec<Complex64> = pairs.iter().rev().map(|pair| pair.lambda).collect();
    assert_eq!(by_frequency(&lambdas), [4, 3, 2, 1, 0]);
}
