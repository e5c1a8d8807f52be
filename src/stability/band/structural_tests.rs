//! Bands of problems with structural damping.

use nalgebra::DMatrix;

use super::tests::{compare, require_left, require_start_from_the_last};
use super::*;
use crate::native::{Mck, Precision, Session};
use crate::stability::testing::{Blocks, diagonal, eigenvalues};
use crate::stability::{BlockedOptions, Evidence};

/// Looks at the modes below 6 Hz of blocks with loss factors, friction and Rayleigh damping.
fn with_band(blocks: &Blocks, look: impl FnOnce(&QuadraticProblem, &mut BandSolver, &mut LabelledFactor, Band)) {
    let mut solver = BandSolver::new(EigenOptions::default(), blocks.system.dofs.labels());
    let mut factor = LabelledFactor::new(Precision::Double);
    blocks.with(0.5, &[], |problem| {
        let band = solver.solve_band(problem, &mut factor, &[0.0, 6.0].into(), &mut |_| ()).unwrap();
        look(problem, &mut solver, &mut factor, band);
    });
}

#[test]
fn modes_are_those_of_the_complex_stiffness() {
    let comm = Session::start(&[]).unwrap();
    for n in [1, 10, 40] {
        with_band(&Blocks::with_structural_damping(&comm, n), |problem, _, _, band| {
            assert_eq!(band.report.solver, SolverKind::Blocked);
            assert!(band.count.agrees() && !band.has_conjugates);
            assert!(band.modes.iter().all(|mode| mode.backward_error < 1e-10 && mode.lambda.im > 0.0));
            compare(&band.modes, &eigenvalues(problem, 6.0));
        });
    }
}

/// The backward error is that of the complex problem: without G the same modes solve nothing.
#[test]
fn the_backward_error_has_structural_damping_in_it() {
    let comm = Session::start(&[]).unwrap();
    with_band(&Blocks::with_structural_damping(&comm, 10), |problem, _, _, band| {
        let real = QuadraticProblem { matrices: Mck { g: None, ..problem.matrices }, ..*problem };
        for (i, mode) in band.modes.iter().enumerate() {
            let x = left::right_vectors(problem.matrices.m, &band.modes).unwrap().columns(2 * i..2 * i + 2);
            let error = |problem| crate::stability::mode::backward_errors(problem, &[mode.lambda], &x).unwrap()[0];
            assert!(error(problem) < 1e-10 && error(&real) > 1e-6, "{} {}", error(problem), error(&real));
        }
    });
}

#[test]
fn left_vectors_are_those_of_the_complex_stiffness() {
    let comm = Session::start(&[]).unwrap();
    with_band(&Blocks::with_structural_damping(&comm, 20), |problem, solver, factor, band| {
        let left = solver.left_vectors(problem, factor, &band.modes, |_| 1e-8).unwrap();
        require_left(problem, &band.modes, &left, 1e-8);
        // Without the space of the search, too.
        solver.release_search_space();
        let left = solver.left_vectors(problem, factor, &band.modes, |_| 1e-8).unwrap();
        require_left(problem, &band.modes, &left, 1e-8);
    });
}

#[test]
fn a_search_starts_from_the_last_one_with_structural_damping_too() {
    let comm = Session::start(&[]).unwrap();
    let mut factor = LabelledFactor::new(Precision::Single);
    let blocks = Blocks::with_structural_damping(&comm, 40);
    require_start_from_the_last(&blocks, EigenOptions::default(), &mut factor);
    assert!(!factor.factor().is_exact(), "a factor in single precision serves");
}

/// Free masses, one of them on the ground by a damper: the zeros of rigid motions stay one mode each.
#[test]
fn a_free_structure_is_searched_about_its_shift() {
    let comm = Session::start(&[]).unwrap();
    let omega2 = |f: f64| (TAU * f).powi(2);
    let k = [0.0, 0.0, omega2(1.0), omega2(2.0), omega2(9.0)];
    let [m, c, g] = [[1.0; 5], [0.0, 5.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.1 * k[2], 0.3 * k[3], 0.2 * k[4]]];
    let [m, c, k, g] = [m, c, k, g].map(|values| diagonal(&comm, &values));
    let matrices = Mck { g: Some(&g), ..Mck::from([&m, &c, &k]) };
    let mut solver = BandSolver::new(EigenOptions::default(), (0..5).collect());
    let mut factor = LabelledFactor::new(Precision::Double);
    let request = BandRequest { band: [0.0, 4.0], shift: 0.31 * TAU * 4.0 };
    let band = solver.solve_band(&QuadraticProblem::symmetric(matrices), &mut factor, &request, &mut |_| ()).unwrap();
    assert!(band.count.agrees() && band.count.found == 4, "{:?}", band.count);
    let elastic: Vec<Complex64> = band.modes.iter().map(|mode| mode.lambda).filter(|z| z.im > 1.0).collect();
    let exact = [(1.0, 0.1), (2.0, 0.3)].map(|(f, g)| TAU * f * Complex64::I * Complex64::new(1.0, g).sqrt());
    assert!(elastic.len() == 2 && elastic.iter().zip(exact).all(|(z, exact)| (z - exact).norm() < 1e-9), "{elastic:?}");
    let real = band.modes.iter().find(|mode| (mode.lambda.re + 5.0).abs() < 1e-6);
    assert!(real.is_some_and(|mode| mode.lambda.im == 0.0), "the damped motion's -5/s");
}

/// A mode that friction carries across the end needs a gap farther out: every attempt of the blocked search goes there.
#[test]
fn every_attempt_of_the_only_search_that_there_is_goes_farther() {
    let comm = Session::start(&[]).unwrap();
    let mut solver = BandSolver::new(EigenOptions::default(), Vec::new());
    Blocks::with_structural_damping(&comm, 2).with(0.5, &[], |problem| {
        for (attempt, margin) in [1.03, 1.12, 1.12 * 1.12, 1.12 * 1.12 * 1.12].into_iter().enumerate() {
            let request = SearchRequest { n_modes: 5, end: 10.0, shift: 3.0, attempt };
            assert_eq!(solver.choose(problem, &request).unwrap(), [SolverKind::Blocked]);
            let reach = solver.blocked.reach(problem, &request).unwrap();
            assert!((reach - 10.0 * margin).abs() < 1e-12, "{attempt}: {reach}");
        }
    });
}

/// Nothing but the blocked search takes a complex stiffness: where that gives up, the band is not found.
#[test]
fn a_search_that_does_not_converge_is_an_error() {
    let comm = Session::start(&[]).unwrap();
    let options = EigenOptions::default();
    let hasty = EigenOptions { blocked: BlockedOptions { max_rounds: 1, ..options.blocked }, ..options };
    let blocks = Blocks::with_structural_damping(&comm, 10);
    let mut solver = BandSolver::new(hasty, blocks.system.dofs.labels());
    blocks.with(0.8, &[], |problem| {
        let mut factor = LabelledFactor::new(Precision::Double);
        let error = solver.solve_band(problem, &mut factor, &[0.0, 6.0].into(), &mut |_| ()).err().unwrap();
        assert_eq!(error.kind(), crate::ErrorKind::NotConverged);
    });
}

/// Matrices without any symmetry, whose modes two searches have to agree on.
#[test]
fn unsymmetric_matrices_may_have_structural_damping() {
    let comm = Session::start(&[]).unwrap();
    let n = 2 * Evidence::ALL_UP_TO;
    let k = DMatrix::from_fn(n, n, |i, j| if i == j { (TAU * (1.0 + 0.1 * i as f64)).powi(2) } else { 0.0 });
    let above = |value: f64| DMatrix::from_fn(n, n, move |i, j| if i + 1 == j { value } else { 0.0 });
    let (c, g) = (above(0.1) - above(0.1).transpose(), 0.05 * &k + above(0.5));
    let [m, c, k, g] = [DMatrix::identity(n, n), c, k, g].map(|a| crate::stability::testing::dense(&comm, &a));
    let matrices = Mck { g: Some(&g), ..Mck::from([&m, &c, &k]) };
    let problem = QuadraticProblem { symmetric_mc: false, ..QuadraticProblem::symmetric(matrices) };
    let evidence = Evidence::Repetition { estimated: false };
    let mut solver = BandSolver::new(EigenOptions { evidence, ..EigenOptions::default() }, (0..n as u64).collect());
    let mut factor = LabelledFactor::new(Precision::Double);
    let band = solver.solve_band(&problem, &mut factor, &[0.0, 1.55].into(), &mut |_| ()).unwrap();
    assert!(band.count.agrees() && band.report.n_attempts == 2, "{:?} {:?}", band.count, band.report);
    compare(&band.modes, &eigenvalues(&problem, 1.55));
    let left = solver.left_vectors(&problem, &mut factor, &band.modes, |_| 1e-8).unwrap();
    require_left(&problem, &band.modes, &left, 1e-8);
}
