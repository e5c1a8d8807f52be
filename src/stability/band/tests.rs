use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use nalgebra::DMatrix;

use super::*;
use crate::native::{Comm, Mck, Precision, Session};
use crate::stability::testing::{Blocks, dense, diagonal, eigenvalues, found, masses};
use crate::stability::{BlockedOptions, CountedBy, Evidence};

/// A solver that finds what the test gives it, and keeps the requests.
struct Scripted {
    results: VecDeque<Option<SearchResult>>,
    requests: Rc<RefCell<Vec<SearchRequest>>>,
}

impl Eigensolver for Scripted {
    fn search(&mut self, search: Search) -> Result<Option<SearchResult>> {
        self.requests.borrow_mut().push(search.request);
        Ok(self.results.pop_front().expect("one more result than asked for"))
    }
}

/// Solves for the modes below 4 Hz of masses with modes at 1, 2, 3 and 5 Hz, with searches that find what is given.
fn scripted(comm: &Comm, shift: f64, results: Vec<Option<SearchResult>>) -> (Result<Band>, Vec<SearchRequest>) {
    let requests = Rc::new(RefCell::new(Vec::new()));
    let mut solver = BandSolver::new(EigenOptions::default(), Vec::new());
    solver.toar = Box::new(Scripted { results: results.into(), requests: requests.clone() });
    let matrices = masses(comm, &[1.0, 2.0, 3.0, 5.0]);
    let (problem, request) = (QuadraticProblem::symmetric(matrices.as_ref()), BandRequest { band: [0.0, 4.0], shift });
    let band = solver.solve_band(&problem, &mut LabelledFactor::new(Precision::Double), &request, &mut |_| ());
    let requests = requests.borrow().clone();
    (band, requests)
}

#[test]
fn a_search_that_misses_no_mode_is_the_only_one() {
    let comm = Session::start(&[]).unwrap();
    let (band, requests) = scripted(&comm, 0.0, vec![Some(found(&comm, &[1.0, 2.0, 3.0, 5.0], 5.0))]);
    let Band { modes, count, report, has_conjugates } = band.unwrap();
    assert!(has_conjugates);
    assert_eq!(modes.iter().map(|mode| mode.frequency().round()).collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
    assert_eq!(count, Count { below: 4.0, expected: 3, found: 3, by: CountedBy::SturmCount });
    assert_eq!(report, BandReport { solver: SolverKind::Toar, n_attempts: 1, n_solves: 5, shift: 0.0 });
    assert_eq!((requests.len(), requests[0].n_modes, requests[0].end), (1, 3 + 4, 4.0));
}

#[test]
fn a_count_that_disagrees_widens_the_search() {
    let comm = Session::start(&[]).unwrap();
    let missing = || Some(found(&comm, &[1.0, 3.0, 5.0], 5.0));
    let (band, requests) =
        scripted(&comm, 0.0, vec![missing(), missing(), Some(found(&comm, &[1.0, 2.0, 3.0, 5.0], 5.0))]);
    let band = band.unwrap();
    assert!(band.count.agrees() && band.modes.len() == 3);
    assert_eq!((band.report.n_attempts, band.report.n_solves), (3, 15));
    assert_eq!(requests.iter().map(|r| r.n_modes).collect::<Vec<_>>(), [3 + 4, 3 + 12, 3 + 36]);
}

#[test]
fn a_search_that_does_not_reach_the_end_widens_the_next() {
    let comm = Session::start(&[]).unwrap();
    let (band, requests) =
        scripted(&comm, 0.0, vec![Some(found(&comm, &[1.0], 1.0)), Some(found(&comm, &[1.0, 2.0, 3.0, 5.0], 5.0))]);
    assert!(band.unwrap().count.agrees() && requests.len() == 2);
}

#[test]
fn a_mode_that_stays_missing_is_told_with_what_was_found() {
    let comm = Session::start(&[]).unwrap();
    let missing = || Some(found(&comm, &[1.0, 3.0, 5.0], 5.0));
    // The last attempt does not even get there: the one before counts.
    let last = Some(found(&comm, &[1.0], 1.0));
    let (band, requests) = scripted(&comm, 0.0, vec![missing(), missing(), missing(), last]);
    let band = band.unwrap();
    assert!(!band.count.agrees() && band.modes.len() == 2);
    assert_eq!((requests.len(), band.report.n_attempts), (4, 3));
}

#[test]
fn where_a_search_gives_up_the_shift_moves() {
    let comm = Session::start(&[]).unwrap();
    let all = || Some(found(&comm, &[1.0, 2.0, 3.0, 5.0], 5.0));
    let (band, requests) = scripted(&comm, 2.0, vec![None, None, all()]);
    let shifts: Vec<f64> = requests.iter().map(|r| r.shift).collect();
    assert!(shifts.iter().zip([2.0, 2.6, 3.38]).all(|(a, b)| (a - b).abs() < 1e-12), "{shifts:?}");
    assert_eq!(band.unwrap().report.shift, shifts[2]);
    let (_, requests) = scripted(&comm, 0.0, vec![None, all()]);
    assert_eq!(requests.iter().map(|r| r.shift).collect::<Vec<_>>(), [0.0, 0.0], "K is inverted as it is");
}

#[test]
fn a_band_that_no_search_completes_is_an_error() {
    let comm = Session::start(&[]).unwrap();
    let (band, requests) = scripted(&comm, 0.0, vec![None, None, None, None]);
    let text = band.err().unwrap().to_string();
    assert!(text.contains("0-4 Hz") && text.contains("3 modes expected") && requests.len() == 4, "{text}");
}

/// Who is chosen for an attempt at a problem.
fn choice(solver: &mut BandSolver, problem: &QuadraticProblem, shift: f64, attempt: usize) -> Vec<SolverKind> {
    solver.choose(problem, &SearchRequest { n_modes: 3, end: 10.0, shift, attempt }).unwrap()
}

#[test]
fn solvers_are_chosen_by_size_storage_shift_attempt_and_memory() {
    use SolverKind::{Blocked, Modal, Toar};
    let comm = Session::start(&[]).unwrap();
    let (sparse, stored_densely) = (Blocks::new(&comm, 8), Blocks::dense(&comm, 8));
    let mut small = BandSolver::new(EigenOptions::default(), Vec::new());
    assert_eq!(sparse.with(0.5, &[], |problem| choice(&mut small, problem, 0.0, 0)), [Toar]);
    assert_eq!(stored_densely.with(0.5, &[], |problem| choice(&mut small, problem, 0.0, 0)), [Modal, Toar]);
    assert_eq!(stored_densely.with(0.5, &[], |problem| choice(&mut small, problem, 1.0, 0)), [Toar]);
    let limits = |n: usize| EigenOptions { blocked_from: n, ..EigenOptions::default() };
    sparse.with(0.5, &[], |problem| {
        let choose = |options: EigenOptions, shift: f64, attempt: usize| {
            choice(&mut BandSolver::new(options, Vec::new()), problem, shift, attempt)
        };
        assert_eq!(choose(limits(24), 0.0, 0), [Blocked, Toar]);
        assert_eq!(choose(limits(25), 0.0, 0), [Toar]);
        assert_eq!(choose(limits(0), 1.0, 0), [Toar]);
        assert_eq!(choose(limits(0), 0.0, 1), [Blocked, Toar]);
        assert_eq!(choose(limits(0), 0.0, 2), [Toar]);
        let unsymmetric = QuadraticProblem { symmetric_mc: false, ..*problem };
        assert_eq!(choice(&mut BandSolver::new(limits(0), Vec::new()), &unsymmetric, 0.0, 0), [Blocked, Toar]);
        let mut short = BandSolver::new(limits(0), Vec::new());
        short.memory.has_mb = Box::new(|_, _| false);
        assert_eq!(choice(&mut short, problem, 0.0, 0), [Toar]);
    });
}

#[test]
fn a_search_for_nearly_all_modes_of_a_dense_problem_is_not_in_modal_coordinates() {
    let comm = Session::start(&[]).unwrap();
    let mut solver = BandSolver::new(EigenOptions::default(), Vec::new());
    let kinds = Blocks::dense(&comm, 2).with(0.5, &[], |problem| {
        solver.choose(problem, &SearchRequest { n_modes: 5, end: 10.0, shift: 0.0, attempt: 0 }).unwrap()
    });
    assert_eq!(kinds, [SolverKind::Toar]);
}

/// The modes below 6 Hz of blocks, by a solver of its own.
fn solved(blocks: &Blocks, options: EigenOptions, mu: f64) -> Band {
    let mut solver = BandSolver::new(options, blocks.system.dofs.labels());
    let mut factor = LabelledFactor::new(Precision::Double);
    blocks.with(mu, &[], |problem| {
        let band = solver.solve_band(problem, &mut factor, &[0.0, 6.0].into(), &mut |_| ()).unwrap();
        compare(&band.modes, &eigenvalues(problem, 6.0));
        band
    })
}

/// The same eigenvalues, to nine digits.
pub(super) fn compare(modes: &[Mode], expected: &[Complex64]) {
    assert_eq!(modes.len(), expected.len());
    for expected in expected {
        let nearest = modes.iter().map(|mode| (mode.lambda - expected).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest <= 1e-9 * expected.norm(), "{expected}: {nearest:e}");
    }
}

#[test]
fn three_solvers_find_the_same_modes() {
    let comm = Session::start(&[]).unwrap();
    let (sparse, stored_densely) = (Blocks::new(&comm, 10), Blocks::dense(&comm, 10));
    for (blocks, options, solver) in [
        (&sparse, EigenOptions::default(), SolverKind::Toar),
        (&sparse, EigenOptions::always_blocked(), SolverKind::Blocked),
        (&stored_densely, EigenOptions::default(), SolverKind::Modal),
    ] {
        let band = solved(blocks, options, 0.8);
        assert_eq!(band.report.solver, solver);
        assert!(band.count.agrees() && band.modes.iter().any(Mode::grows));
        assert!(band.modes.iter().all(|mode| mode.backward_error < 1e-10));
    }
}

#[test]
fn a_blocked_search_that_does_not_converge_leaves_it_to_toar() {
    let comm = Session::start(&[]).unwrap();
    let options = EigenOptions::always_blocked();
    let hasty = EigenOptions { blocked: BlockedOptions { max_rounds: 1, ..options.blocked }, ..options };
    let band = solved(&Blocks::new(&comm, 10), hasty, 0.8);
    assert_eq!((band.report.solver, band.report.n_attempts), (SolverKind::Toar, 1));
}

#[test]
fn modal_coordinates_that_cost_digits_leave_it_to_toar() {
    let comm = Session::start(&[]).unwrap();
    let strict = EigenOptions { backward_error: 0.0, ..EigenOptions::default() };
    assert_eq!(solved(&Blocks::dense(&comm, 10), strict, 0.8).report.solver, SolverKind::Toar);
}

#[test]
fn a_factor_in_single_precision_is_made_again_for_toar() {
    let comm = Session::start(&[]).unwrap();
    let blocks = Blocks::new(&comm, 6);
    let mut solver = BandSolver::new(EigenOptions::default(), blocks.system.dofs.labels());
    let mut factor = LabelledFactor::new(Precision::Single);
    blocks.with(0.8, &[], |problem| {
        let band = solver.solve_band(problem, &mut factor, &[0.0, 6.0].into(), &mut |_| ()).unwrap();
        compare(&band.modes, &eigenvalues(problem, 6.0));
    });
    assert!(factor.factor().is_exact());
}

/// The modes at three friction values after each other, the second with fewer solves than the first.
pub(super) fn require_start_from_the_last(blocks: &Blocks, options: EigenOptions, factor: &mut LabelledFactor) {
    let mut solver = BandSolver::new(options, blocks.system.dofs.labels());
    let mut n_solves = Vec::new();
    for (mu, open) in [(0.5, &[][..]), (0.51, &[]), (0.52, &[3, 5])] {
        blocks.with(mu, open, |problem| {
            let band = solver.solve_band(problem, factor, &[0.0, 6.0].into(), &mut |_| ()).unwrap();
            compare(&band.modes, &eigenvalues(problem, 6.0));
            n_solves.push(band.report.n_solves);
        });
    }
    assert!(n_solves[1] < n_solves[0], "{n_solves:?}");
}

#[test]
fn a_blocked_search_starts_from_the_last_one() {
    let comm = Session::start(&[]).unwrap();
    let mut factor = LabelledFactor::new(Precision::Double);
    require_start_from_the_last(&Blocks::new(&comm, 40), EigenOptions::always_blocked(), &mut factor);
}

#[test]
fn real_and_double_eigenvalues_are_found() {
    let comm = Session::start(&[]).unwrap();
    // Two equal masses; one that does not swing, -1/s and -100/s; one beyond the band.
    let omega2 = |f: f64| (TAU * f).powi(2);
    let k = diagonal(&comm, &[omega2(1.0), omega2(1.0), 100.0, omega2(9.0)]);
    let (m, c) = (diagonal(&comm, &[1.0; 4]), diagonal(&comm, &[0.1, 0.1, 101.0, 0.1]));
    let problem = QuadraticProblem::symmetric(Mck::from([&m, &c, &k]));
    let mut solver = BandSolver::new(EigenOptions::default(), vec![0, 1, 2, 3]);
    let mut factor = LabelledFactor::new(Precision::Double);
    let band = solver.solve_band(&problem, &mut factor, &[0.0, 5.0].into(), &mut |_| ()).unwrap();
    let real: Vec<f64> = band.modes.iter().filter(|m| m.lambda.im == 0.0).map(|m| m.lambda.re).collect();
    assert!(real.len() == 1 && (real[0] + 1.0).abs() < 1e-9, "{real:?}");
    let double: Vec<f64> = band.modes.iter().filter(|m| m.lambda.im > 0.0).map(Mode::frequency).collect();
    assert!(double.len() == 2 && double.iter().all(|f| (f - 1.0).abs() < 1e-3), "{double:?}");
    // Left vectors of all of them, the real one's imaginary part being zero.
    let left = solver.left_vectors(&problem, &mut factor, &band.modes, |_| 1e-8).unwrap();
    require_left(&problem, &band.modes, &left, 1e-8);
}

/// `|P(lambda)^T v| / sum |matrices|` of `v = conj(y)`, y of length 1 in M, is small for all modes.
pub(super) fn require_left(problem: &QuadraticProblem, modes: &[Mode], y: &Block, accuracy: f64) {
    let matrices: Vec<DMatrix<f64>> =
        problem.all_matrices().into_iter().map(crate::stability::testing::entries).collect();
    let m = &matrices[0];
    for (i, mode) in modes.iter().enumerate() {
        let v =
            DMatrix::from_fn(m.nrows(), 1, |row, _| Complex64::new(y.column(2 * i)[row], -y.column(2 * i + 1)[row]));
        let terms = problem.coefficients(mode.lambda).into_iter().zip(&matrices);
        let p: DMatrix<Complex64> = terms.map(|(factor, a)| a.transpose().map(Complex64::from) * factor).sum();
        let residual = (&p * &v).norm() / (p.norm() * v.norm());
        assert!(residual < accuracy, "mode {i}: {residual:e}");
        let size = (v.adjoint() * m.map(Complex64::from) * &v)[(0, 0)];
        assert!((size - 1.0).norm() < 1e-9, "y^H M y = {size}");
    }
}

#[test]
fn left_vectors_are_as_accurate_as_asked_for_by_every_way() {
    let comm = Session::start(&[]).unwrap();
    let one_by_one = EigenOptions { n_left_one_by_one: usize::MAX, ..EigenOptions::default() };
    for (blocks, options) in [
        (Blocks::new(&comm, 8), EigenOptions::default()),
        (Blocks::new(&comm, 8), EigenOptions::always_blocked()),
        (Blocks::dense(&comm, 8), EigenOptions::default()),
        (Blocks::dense(&comm, 8), one_by_one),
    ] {
        let mut solver = BandSolver::new(options, blocks.system.dofs.labels());
        let mut factor = LabelledFactor::new(Precision::Double);
        blocks.with(0.8, &[], |problem| {
            let band = solver.solve_band(problem, &mut factor, &[0.0, 7.0].into(), &mut |_| ()).unwrap();
            let left = solver.left_vectors(problem, &mut factor, &band.modes, |_| 1e-7).unwrap();
            assert!(band.modes.len() > 6);
            require_left(problem, &band.modes, &left, 1e-7);
        });
    }
}

#[test]
fn left_vectors_take_as_many_rounds_as_their_accuracy_needs() {
    let comm = Session::start(&[]).unwrap();
    let blocks = Blocks::new(&comm, 40);
    let mut solver = BandSolver::new(EigenOptions::default(), blocks.system.dofs.labels());
    let mut factor = LabelledFactor::new(Precision::Double);
    blocks.with(0.8, &[], |problem| {
        let band = solver.solve_band(problem, &mut factor, &[0.0, 4.6].into(), &mut |_| ()).unwrap();
        assert!((1..5).contains(&band.modes.len()), "few in a large space: {}", band.modes.len());
        let left = solver.left_vectors(problem, &mut factor, &band.modes, |_| 1e-10).unwrap();
        require_left(problem, &band.modes, &left, 1e-10);
    });
}

#[test]
fn left_vectors_that_do_not_converge_are_an_error_and_those_nobody_needs_cost_nothing() {
    let comm = Session::start(&[]).unwrap();
    let blocks = Blocks::new(&comm, 8);
    let hasty = EigenOptions { max_left_rounds: 1, ..EigenOptions::default() };
    let mut solver = BandSolver::new(hasty, blocks.system.dofs.labels());
    let mut factor = LabelledFactor::new(Precision::Double);
    blocks.with(0.8, &[], |problem| {
        let band = solver.solve_band(problem, &mut factor, &[0.0, 5.0].into(), &mut |_| ()).unwrap();
        let n_solves = factor.factor().stats().n_solves;
        let none = solver.left_vectors(problem, &mut factor, &band.modes, |_| f64::INFINITY).unwrap();
        assert_eq!((none.n_columns(), factor.factor().stats().n_solves), (2 * band.modes.len(), n_solves));
        let error = solver.left_vectors(problem, &mut factor, &band.modes, |_| 1e-12).err().unwrap();
        assert!(error.kind() == crate::ErrorKind::NotConverged, "{error}");
    });
}

#[test]
fn matrices_of_any_structure_are_searched_twice() {
    let comm = Session::start(&[]).unwrap();
    // Gyroscopic: C skew. More dofs than are solved for completely.
    let n = 2 * Evidence::ALL_UP_TO;
    let k = DMatrix::from_fn(n, n, |i, j| if i == j { (TAU * (1.0 + 0.1 * i as f64)).powi(2) } else { 0.0 });
    let c = DMatrix::from_fn(n, n, |i, j| {
        if i + 1 == j {
            0.1
        } else if j + 1 == i {
            -0.1
        } else {
            0.0
        }
    });
    let [m, c, k] = [DMatrix::identity(n, n), c, k].map(|a| dense(&comm, &a));
    let matrices = Mck::from([&m, &c, &k]);
    let problem = QuadraticProblem { symmetric_mc: false, ..QuadraticProblem::symmetric(matrices) };
    let evidence = Evidence::Repetition { estimated: false };
    let mut solver = BandSolver::new(EigenOptions { evidence, ..EigenOptions::default() }, (0..n as u64).collect());
    let mut factor = LabelledFactor::new(Precision::Double);
    let band = solver.solve_band(&problem, &mut factor, &[0.0, 1.55].into(), &mut |_| ()).unwrap();
    assert!(band.count.agrees() && band.report.n_attempts == 2, "{:?} {:?}", band.count, band.report);
    compare(&band.modes, &eigenvalues(&problem, 1.55));
}

#[test]
fn the_last_search_is_repeated_where_damping_has_made_eigenvalues_real() {
    let comm = Session::start(&[]).unwrap();
    let overdamped = || {
        let mut search = found(&comm, &[1.0, 2.0, 3.0, 3.5, 5.0], 5.0);
        search.pairs[3].lambda = Complex64::new(-2.0, 0.0);
        search.pairs[4].lambda = Complex64::new(-3.0, 0.0);
        Some(search)
    };
    let (band, requests) = scripted(&comm, 0.0, vec![None, None, None, overdamped(), overdamped()]);
    assert_eq!((requests.len(), requests[4].n_modes), (5, 4 + 4), "modes found, and the margin");
    assert_eq!(band.unwrap().count, Count { below: 4.0, expected: 4, found: 4, by: CountedBy::AnotherSearch });
}

#[test]
fn strong_damping_is_searched_twice() {
    let comm = Session::start(&[]).unwrap();
    // Masses at 1, 1.1, 1.2 ... Hz, those from 10 Hz on with a damping ratio of 20: slow real eigenvalues from 0.25 Hz.
    let n = 200;
    let omega = |i: usize| TAU * (1.0 + 0.1 * i as f64);
    let c =
        DMatrix::from_fn(n, n, |i, j| if i == j && i >= 90 { 40.0 * omega(i) } else { 0.01 * (i == j) as i8 as f64 });
    let k = DMatrix::from_fn(n, n, |i, j| if i == j { omega(i).powi(2) } else { 0.0 });
    let [m, c, k] = [DMatrix::identity(n, n), c, k].map(|a| dense(&comm, &a));
    let problem = QuadraticProblem::symmetric(Mck::from([&m, &c, &k]));
    let mut solver = BandSolver::new(EigenOptions::default(), (0..n as u64).collect());
    let mut factor = LabelledFactor::new(Precision::Double);
    let band = solver.solve_band(&problem, &mut factor, &[0.0, 1.55].into(), &mut |_| ()).unwrap();
    assert!(band.count.agrees() && band.count.by == CountedBy::AnotherSearch, "{:?} {:?}", band.count, band.report);
    compare(&band.modes, &eigenvalues(&problem, 1.55));
}

#[test]
fn a_band_with_too_many_modes_is_refused_by_its_count() {
    assert!(require_resolved(999, 999, 6000.0).is_ok(), "of a small model all modes may be asked for");
    assert!(require_resolved(200, 1000, 6000.0).is_ok());
    let error = require_resolved(201, 1000, 6000.0).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().starts_with("201 modes lie below 6000 Hz, of 1000 dofs. Look at the units"));
}
