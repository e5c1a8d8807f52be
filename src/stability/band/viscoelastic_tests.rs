//! Bands of problems whose stiffness depends on the eigenvalue.

use nalgebra::DMatrix;

use super::tests::{compare, require_left};
use super::*;
use crate::model::viscoelastic::{FractionalZener, MaxwellElement, ModulusTable, ViscoelasticLaw};
use crate::native::{Precision, Session, lapack};
use crate::stability::testing::{Blocks, entries};

const END: f64 = 6.0;

fn maxwell(elements: &[[f64; 2]]) -> ViscoelasticLaw {
    let element = |&[ratio, relaxation_time]: &[f64; 2]| MaxwellElement { ratio, relaxation_time };
    ViscoelasticLaw::Maxwell(elements.iter().map(element).collect())
}

/// Looks at the modes below 6 Hz at a friction value.
fn with_band(
    mut blocks: Blocks,
    mu: f64,
    look: impl FnOnce(&QuadraticProblem, &mut BandSolver, &mut LabelledFactor, Band),
) {
    blocks.reference = END;
    let mut solver = BandSolver::new(EigenOptions::default(), blocks.system.dofs.labels());
    let mut factor = LabelledFactor::new(Precision::Double);
    blocks.with(mu, &[], |problem| {
        let band = solver.solve_band(problem, &mut factor, &[0.0, END].into(), &mut |_| ()).unwrap();
        look(problem, &mut solver, &mut factor, band);
    });
}

/// Eigenvalues of the upper half plane up to 6 Hz of the model with internal variables `z_k`, one set for each element
/// of a Maxwell law:
///
/// ```text
/// M u'' + C u' + (K + sum g_k K_m) u - sum g_k K_m z_k = 0,    tau_k z_k' + z_k = u
/// ```
fn with_internal_variables(problem: &QuadraticProblem) -> Vec<Complex64> {
    let [m, c, k_0] = problem.matrices.map(entries).into_array();
    let (n, mut k) = (m.nrows(), k_0);
    let mut elements = Vec::new();
    for own in problem.viscoelastic.stiffnesses {
        let stiffness = entries(&own.stiffness);
        // From the reference frequency back to rest.
        k -= (own.law.factor(Complex64::new(0.0, problem.viscoelastic.reference)).re - 1.0) * &stiffness;
        let ViscoelasticLaw::Maxwell(own) = &own.law else { panic!("a Maxwell law") };
        elements.extend(own.iter().map(|element| (*element, stiffness.clone())));
    }
    let inverse = m.try_inverse().unwrap();
    let mut a = DMatrix::from_element((2 + elements.len()) * n, (2 + elements.len()) * n, Complex64::ZERO);
    let complex = |a: DMatrix<f64>| a.map(Complex64::from);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    a.view_mut((n, n), (n, n)).copy_from(&complex(-&inverse * c));
    for (i, (MaxwellElement { ratio, relaxation_time }, stiffness)) in (2..).zip(&elements) {
        k += *ratio * stiffness;
        a.view_mut((n, i * n), (n, n)).copy_from(&complex(*ratio * &inverse * stiffness));
        a.view_mut((i * n, i * n), (n, n)).fill_diagonal((-1.0 / relaxation_time).into());
        a.view_mut((i * n, 0), (n, n)).fill_diagonal((1.0 / relaxation_time).into());
    }
    a.view_mut((n, 0), (n, n)).copy_from(&complex(-inverse * k));
    let values = lapack::eigen(a).unwrap().values;
    let mut within: Vec<Complex64> = values.into_iter().filter(|z| z.im > 1e-6 && z.im <= TAU * END).collect();
    within.sort_by(|a, b| (a.im, a.re).partial_cmp(&(b.im, b.re)).unwrap());
    within
}

/// A law of two elements and one of a single element, friction and damping: eigenvalues to 1e-9 and better.
#[test]
fn modes_of_maxwell_laws_are_those_of_internal_variables() {
    let comm = Session::start(&[]).unwrap();
    for (n, mu) in [(1, 0.2), (10, 0.0), (10, 0.5), (30, 0.5)] {
        let laws = [maxwell(&[[0.4, 0.05], [1.5, 0.01]]), maxwell(&[[0.8, 0.02]])];
        with_band(Blocks::with_viscoelastic(&comm, n, laws, 0.3), mu, |problem, _, _, band| {
            assert!(band.report.solver == SolverKind::Blocked && !band.has_conjugates);
            assert!(band.count.agrees(), "{:?}", band.count);
            assert!(band.modes.iter().all(|mode| mode.backward_error < 1e-10 && mode.lambda.im > 0.0));
            compare(&band.modes, &with_internal_variables(problem));
        });
    }
}

/// The backward error is that of the nonlinear problem: the modes do not solve that with a stiffness of another
/// frequency.
#[test]
fn the_backward_error_is_that_of_the_stiffness_at_the_eigenvalue() {
    let comm = Session::start(&[]).unwrap();
    let law = || maxwell(&[[1.0, 0.02]]);
    with_band(Blocks::with_viscoelastic(&comm, 10, [law(), law()], 0.3), 0.3, |problem, _, _, band| {
        let shifted = crate::stability::Viscoelastic { reference: 0.9 * TAU * END, ..problem.viscoelastic };
        let other = QuadraticProblem { viscoelastic: shifted, ..*problem };
        let x = left::right_vectors(problem.matrices.m, &band.modes).unwrap();
        let lambdas: Vec<Complex64> = band.modes.iter().map(|mode| mode.lambda).collect();
        let errors = |problem| crate::stability::mode::backward_errors(problem, &lambdas, &x).unwrap();
        assert!(errors(problem).iter().all(|error| *error < 1e-10));
        assert!(errors(&other).iter().all(|error| *error > 1e-6), "{:?}", errors(&other));
    });
}

/// Laws whose factor is the same at all frequencies are loss factors.
#[test]
fn a_table_that_is_constant_is_a_loss_factor() {
    let comm = Session::start(&[]).unwrap();
    let law =
        ViscoelasticLaw::Table(ModulusTable { frequencies: vec![1.0], ratios: vec![1.0], loss_factors: vec![0.2] });
    let blocks = Blocks::with_viscoelastic(&comm, 10, [law.clone(), law], 0.3);
    with_band(blocks, 0.5, |problem, _, _, band| {
        let mut g = problem.viscoelastic.stiffnesses[0].stiffness.duplicate().unwrap();
        g.axpy(1.0, &problem.viscoelastic.stiffnesses[1].stiffness).unwrap();
        let mut structural = crate::native::Mck { g: Some(entries(&g)), ..problem.matrices.map(entries) };
        structural.g = structural.g.map(|g| 0.2 * g);
        compare(&band.modes, &crate::stability::testing::eigenvalues_of(structural, END));
    });
}

/// Each mode solves the problem of its own frequency, whatever the law: the stiffness then kept gives the same mode.
#[test]
fn every_mode_has_the_stiffness_of_its_own_frequency() {
    let comm = Session::start(&[]).unwrap();
    let zener = FractionalZener { unrelaxed_ratio: 30.0, relaxation_time: 0.002, order: 0.6 };
    let table = ModulusTable {
        frequencies: vec![0.5, 2.0, 8.0],
        ratios: vec![1.0, 2.0, 6.0],
        loss_factors: vec![0.2, 0.6, 0.4],
    };
    let laws = [ViscoelasticLaw::FractionalZener(zener), ViscoelasticLaw::Table(table)];
    with_band(Blocks::with_viscoelastic(&comm, 8, laws, 0.2), 0.4, |problem, solver, factor, band| {
        assert!(band.count.agrees() && band.modes.len() > 3, "{:?}", band.count);
        let matrices = problem.all_matrices();
        for mode in &band.modes {
            let n = problem.n_dofs();
            let mut k = DMatrix::from_element(n, n, Complex64::ZERO);
            for (factor, matrix) in problem.coefficients(mode.lambda).into_iter().zip(&matrices).skip(2) {
                k += entries(matrix).map(|x| factor * x);
            }
            let [c, k] = [entries(problem.matrices.c).map(Complex64::from), k];
            let mut companion = DMatrix::from_element(2 * n, 2 * n, Complex64::ZERO);
            companion.view_mut((0, n), (n, n)).fill_with_identity();
            companion.view_mut((n, 0), (n, n)).copy_from(&-k);
            companion.view_mut((n, n), (n, n)).copy_from(&-c);
            let values = lapack::eigen(companion).unwrap().values;
            let nearest = values.iter().map(|z| (z - mode.lambda).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-9 * mode.lambda.norm(), "{nearest} {}", mode.lambda);
        }
        let left = solver.left_vectors(problem, factor, &band.modes, |_| 1e-8).unwrap();
        require_left(problem, &band.modes, &left, 1e-8);
    });
}
