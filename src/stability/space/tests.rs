use super::*;
use crate::equilibrium::LabelledFactor;
use crate::native::{Comm, Precision, Session};
use crate::stability::testing::{Blocks, entries};

fn dense(block: &Block) -> DMatrix<f64> {
    DMatrix::from_column_slice(block.n_local(), block.n_columns(), block.values())
}

/// V is orthonormal, and the projections are those of the matrices, or of their transposes.
fn require_projections(space: &Space) {
    let v = dense(&space.v);
    assert!((v.tr_mul(&v) - DMatrix::identity(v.ncols(), v.ncols())).norm() < 1e-12);
    let matrices = space.problem().all_matrices().into_iter().map(entries);
    for (projected, a) in space.projected.iter().zip(matrices) {
        let a = if space.side == Side::Left { a.transpose() } else { a };
        assert!((projected - v.tr_mul(&(&a * &v))).norm() < 1e-10 * a.norm());
    }
}

/// A space on blocks, with three random columns.
fn with_space<T>(comm: &Comm, side: Side, symmetric_mc: bool, look: impl FnOnce(Space) -> T) -> T {
    let blocks = Blocks::new(comm, 4);
    let mut factor = LabelledFactor::new(Precision::Double);
    let labels = blocks.system.dofs.labels();
    blocks.with(0.5, &[], |problem| {
        let problem = QuadraticProblem { symmetric_mc, ..*problem };
        let factor = problem.factorise(0.0, &mut factor).unwrap();
        let mut space = Space::with_capacity(FactoredProblem { problem: &problem, factor, labels: &labels }, side, 0);
        let columns = space.random(3);
        space.extend(columns).unwrap();
        look(space)
    })
}

#[test]
fn projections_grow_with_the_space_on_both_sides() {
    let comm = Session::start(&[]).unwrap();
    for side in [Side::Right, Side::Left] {
        for symmetric_mc in [true, false] {
            with_space(&comm, side, symmetric_mc, |mut space| {
                let r = space.random(2);
                space.extend_by_solves(&r).unwrap();
                assert_eq!((space.v.n_columns(), space.n_solves), (5, 2));
                require_projections(&space);
                if side == Side::Right {
                    require_projections(&Space::of_left_vectors(space.searched, space.into_basis()));
                }
            });
        }
    }
}

#[test]
fn a_space_takes_in_what_it_lacks_of_columns_that_it_has_already() {
    let comm = Session::start(&[]).unwrap();
    with_space(&comm, Side::Right, true, |mut space| {
        let mut columns = space.v.clone();
        let mut new = Block::zeros(columns.comm(), 12, 1);
        new.column_mut(0)[5] = 1.0;
        columns.append(&new);
        columns.append(&new);
        space.extend(columns).unwrap();
        require_projections(&space);
        let row = dense(&space.v).row(5).norm();
        assert!((row - 1.0).abs() < 1e-12, "the new direction is in the space: {row}");
    });
}

#[test]
fn no_space_has_more_columns_than_dofs() {
    let comm = Session::start(&[]).unwrap();
    with_space(&comm, Side::Right, true, |mut space| {
        let columns = space.random(20);
        space.extend(columns).unwrap();
        assert_eq!(space.v.n_columns(), 12);
        require_projections(&space);
    });
}

/// Imaginary parts of real eigenvalues' vectors are zero, or as good as.
#[test]
fn columns_of_nothing_add_nothing() {
    let comm = Session::start(&[]).unwrap();
    with_space(&comm, Side::Right, true, |mut space| {
        for tiny in [0.0, 1e-170, 1e-300, 1e-310] {
            let mut columns = space.random(3);
            columns.column_mut(1).iter_mut().for_each(|x| *x *= tiny);
            let columns = space.what_is_new(columns).unwrap();
            let v = dense(&columns);
            assert!((2..=3).contains(&v.ncols()) && v.iter().all(|x| x.is_finite()), "{tiny:e}: {}", v.ncols());
            assert!((v.tr_mul(&v) - DMatrix::identity(v.ncols(), v.ncols())).norm() < 1e-12, "{tiny:e}");
        }
    });
}

#[test]
fn a_start_serves_a_problem_with_other_contact() {
    let comm = Session::start(&[]).unwrap();
    let blocks = Blocks::new(&comm, 4);
    let mut factor = LabelledFactor::new(Precision::Double);
    let labels = blocks.system.dofs.labels();
    let start = blocks.with(0.5, &[], |problem| {
        let factor = problem.factorise(0.0, &mut factor).unwrap();
        let searched = FactoredProblem { problem, factor, labels: &labels };
        let mut space = Space::with_capacity(searched, Side::Right, 0);
        let columns = space.random(5);
        space.extend(columns).unwrap();
        let re = |j: usize| (0..5).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        let ritz = [0, 2].map(|j| Ritz { lambda: Complex64::I, re: re(j), im: re(j + 1) });
        let start = space.start(&ritz).unwrap();
        let vectors = dense(&space.vectors(&ritz));
        assert!((dense(&space.vectors_within(&start, &ritz)) - &vectors).norm() < 1e-12);
        start
    });
    blocks.with(0.7, &[1], |problem| {
        let factor = problem.factorise(0.0, &mut factor).unwrap();
        let space = Space::started(FactoredProblem { problem, factor, labels: &labels }, start, 0).unwrap();
        assert_eq!((space.v.n_columns(), space.n_solves), (4, 0));
        require_projections(&space);
    });
}

#[test]
fn a_sketch_of_few_pairs_is_their_residuals() {
    let comm = Session::start(&[]).unwrap();
    with_space(&comm, Side::Right, true, |mut space| {
        let lambda = Complex64::new(-0.5, 20.0);
        let ritz = Ritz { lambda, re: vec![1.0, 0.5, 0.0], im: vec![0.0, 0.2, -1.0] };
        let sketch = dense(&space.sketch(&[&ritz]).unwrap());
        let x = dense(&space.vectors(std::slice::from_ref(&ritz)));
        let x = DMatrix::from_fn(12, 1, |i, _| Complex64::new(x[(i, 0)], x[(i, 1)]));
        let [m, c, k] = space.problem().matrices.map(|a| entries(a).map(Complex64::from)).into_array();
        let residual = (m * (lambda * lambda) + c * lambda + k) * x;
        for i in 0..12 {
            assert!((sketch[(i, 0)] - residual[(i, 0)].re).abs() < 1e-9);
            assert!((sketch[(i, 1)] - residual[(i, 0)].im).abs() < 1e-9);
        }
        let many = vec![&ritz; SKETCH];
        assert_eq!(space.sketch(&many).unwrap().n_columns(), SKETCH);
    });
}
