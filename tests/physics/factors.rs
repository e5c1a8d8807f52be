//! Factors by MUMPS on one rank and on two: many right-hand sides, the transpose, both precisions, the ordering.

use crate::support::program::{Place, run_test_on_two_ranks};
use squeal::analysis::Sweep;
use squeal::native::{Block, Comm, Factor, FactorKind, Matrix, Precision, Session};
use squeal::structure::FullModel;

/// Columns to solve for.
const N_COLUMNS: usize = 5;

/// Relative residuals of `A X = B` and `A^T X = B`.
fn residuals(a: &Matrix, factor: &Factor) -> [f64; 2] {
    let mut b = Block::zeros(a.comm(), a.n_local(), N_COLUMNS);
    let mut state = 1 + a.comm().rank() as u32;
    for x in b.values_mut() {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *x = f64::from(state) / f64::from(u32::MAX) - 0.5;
    }
    // One column of another size than the others, which single precision could not square.
    b.column_mut(2).iter_mut().for_each(|x| *x *= 1e-30);
    let direct = b.solved_by(factor).unwrap().multiplied_by(a).unwrap();
    let transposed = b.solved_by_transpose(factor).unwrap().multiplied_by_transpose(a).unwrap();
    [direct, transposed].map(|mut product| {
        product.axpy(-1.0, &b);
        product.lengths().iter().zip(b.lengths()).map(|(r, b)| r / b).fold(0.0, f64::max)
    })
}

/// A brake's unsymmetric tangent under friction, factorised and solved with.
fn solve(comm: &Comm, ordering: &str) {
    let place = Place::pads();
    let brake = FullModel::read(comm, &place.path("brake.toml")).unwrap();
    let families = brake.families().unwrap();
    let system = brake.assemble(comm, &families).unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap();
    let equilibrium = sweep.equilibrium(0.5, &mut ()).unwrap();
    let look = |problem: &squeal::stability::QuadraticProblem| {
        let mut factor = Factor::new(FactorKind::Unsymmetric);
        factor.factorise(problem.matrices.k)?;
        let [direct, transposed] = residuals(problem.matrices.k, &factor);
        assert!(factor.is_exact() && direct < 1e-10 && transposed < 1e-10, "double: {direct:e} {transposed:e}");
        let double = factor.stats();
        factor.set_precision(Precision::Single);
        factor.factorise(problem.matrices.k)?;
        let [direct, transposed] = residuals(problem.matrices.k, &factor);
        assert!(!factor.is_exact() && direct < 0.05 && transposed < 0.05, "single: {direct:e} {transposed:e}");
        assert!(direct > 1e-9, "it is in single precision: {direct:e}");
        let single = factor.stats();
        assert!(single.used_mb < 0.75 * double.used_mb, "{} MB for {} MB", single.used_mb, double.used_mb);
        assert_eq!((double.ordering_name(), single.ordering_name()), (ordering, ordering));
        Ok(())
    };
    sweep.linearise(&equilibrium, look).unwrap();
}

#[test]
fn on_one_rank() {
    solve(&Session::start(&[]).unwrap(), "METIS");
}

#[test]
fn on_two_ranks() {
    let said = run_test_on_two_ranks("factors::a_rank");
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(said.out.matches("1 passed").count(), 2, "{}", said.out);
}

#[test]
#[ignore = "one of the ranks of on_two_ranks"]
fn a_rank() {
    solve(&Session::start(&[]).unwrap(), "METIS");
}

/// No rank has the whole graph.
#[test]
fn ordered_by_two_ranks() {
    let said = run_test_on_two_ranks("factors::a_rank_that_orders");
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(said.out.matches("1 passed").count(), 2, "{}", said.out);
}

#[test]
#[ignore = "one of the ranks of ordered_by_two_ranks"]
fn a_rank_that_orders() {
    let option = |number: u32, value: &str| (format!("-mat_mumps_icntl_{number}"), value.to_owned());
    solve(&Session::start(&[option(28, "2"), option(29, "1")]).unwrap(), "PT-SCOTCH");
}
