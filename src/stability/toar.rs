//! TOAR by SLEPc's PEP: one right-hand side at a time, for any real problem and shift.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::eigensolver::{EigenProgress, Eigensolver, OnProgress, Search, SearchRequest, SearchResult, SolverKind};
use super::mode::backward_errors;
use super::{EigenOptions, QuadraticProblem};
use crate::Result;
use crate::native::petsc::eigen::{self, Found, Options, Pair, Quadratic};
use crate::native::{Block, Precision, Vector};

/// Restarts before TOAR gives what it has.
const MAX_RESTARTS: usize = 200;

/// Two-level orthogonal Arnoldi on `P(shift)^-1`.
pub(super) struct Toar {
    pub options: EigenOptions,
}

impl Eigensolver for Toar {
    fn search(&mut self, search: Search) -> Result<Option<SearchResult>> {
        let Search { problem, factor, request, progress } = search;
        if problem.factorise(request.shift, factor).map(|factor| !factor.is_exact())? {
            factor.set_precision(Precision::Double);
        }
        let lu = problem.factorise(request.shift, factor)?;
        let options = pep_options(problem, &request, self.options.toar_tolerance);
        let inverse = |b: &Vector, x: &mut Vector| lu.solve(b, x);
        let quadratic = Quadratic { matrices: problem.matrices, shift: request.shift, inverse: &inverse };
        let found = eigen::solve(&quadratic, &options, &mut with_wanted(options.n_wanted, progress))?;
        complete(problem, SolverKind::Toar, found)
    }
}

/// Options of PEP for all modes of a request.
pub(super) fn pep_options(problem: &QuadraticProblem, request: &SearchRequest, tolerance: f64) -> Options {
    let n_wanted = (2 * request.n_modes).min(2 * problem.n_dofs());
    Options { n_wanted, n_basis: 0, tolerance, max_restarts: MAX_RESTARTS, scale: 0.0 }
}

/// PEP's progress with the number of eigenvalues wanted.
pub(super) fn with_wanted(n_wanted: usize, progress: &mut OnProgress) -> impl FnMut(usize, usize) {
    move |n_converged, n_solves| progress(EigenProgress { n_converged, n_wanted, n_solves })
}

/// What PEP has found, with its backward errors. Complete up to the furthest eigenvalue, or everywhere where there are
/// no more.
pub(super) fn complete(
    problem: &QuadraticProblem,
    solver: SolverKind,
    found: Option<Found>,
) -> Result<Option<SearchResult>> {
    let Some(Found { pairs, n_converged, n_solves }) = found else { return Ok(None) };
    let lambdas: Vec<Complex64> = pairs.iter().map(|pair| pair.lambda).collect();
    let backward_errors = backward_errors(problem, &lambdas, &vectors(problem, &pairs)?)?;
    let furthest = lambdas.iter().map(|lambda| lambda.norm() / TAU).fold(0.0, f64::max);
    let reach = if n_converged >= 2 * problem.n_dofs() { f64::INFINITY } else { furthest };
    Ok(Some(SearchResult { solver, pairs, backward_errors, reach, n_solves }))
}

/// Real and imaginary parts as the columns of a block.
fn vectors(problem: &QuadraticProblem, pairs: &[Pair]) -> Result<Block> {
    let mut block = Block::zeros(problem.comm(), problem.n_local(), 2 * pairs.len());
    for (j, vector) in pairs.iter().flat_map(|pair| [&pair.re, &pair.im]).enumerate() {
        vector.local(|values| block.column_mut(j).copy_from_slice(values))?;
    }
    Ok(block)
}
