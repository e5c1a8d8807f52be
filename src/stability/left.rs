//! Left vectors of the modes: `y^H P(lambda) = 0`.
//!
//! With `v = conj(y)` that is `P(lambda)^T v = 0`, the transposed problem at an eigenvalue that is known. Friction
//! alone makes K differ from its transpose, so the right vectors span a start V; better still, the space in which they
//! were found, whose projections serve transposed. A round computes each vector again in V, by inverse iteration with
//! `V^T P(lambda)^T V` from where it was, and extends V by `K^-T R Omega`, random combinations of the residuals, as
//! the search for the right vectors does ([`super::blocked`]). A vector is found when a round hardly moves it, or only
//! within the space of the vectors that have the same eigenvalue. Vectors of one eigenvalue are combined so that each
//! is the left vector of one right vector: `y_i^H P'(lambda) x_j = 0` for two of them.
//!
//! Why it is written by hand: SLEPc's PEP has no left vectors.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use super::Mode;
use super::space::{Basis, FactoredProblem, Ritz, Space};
use crate::native::{Block, Matrix, lapack};
use crate::{Error, Result};

/// Relative steps away from an eigenvalue at which the problem is not singular.
const LAMBDA_STEPS: [f64; 3] = [0.0, 1e-14, 1e-12];

/// Eigenvalues that differ by less than this, relatively, have one space of vectors: as far as they are known, each
/// vector of that space belongs to each of them.
const SAME_EIGENVALUE: f64 = 1e-9;

/// Vectors of length 1 with no more than this between them are one.
const SAME_DIRECTION: f64 = 1e-8;

/// Left vectors of `modes`, found in the space whose `basis` is given: columns `2i` and `2i + 1` are the real and
/// imaginary part of mode i, `y^H M y = 1`, with the accuracy that each is to have: relative, by the last round's
/// change; where it is infinite, the columns are no left vector. Collective.
///
/// # Errors
/// PETSc's and MUMPS's; [`Error::NotConverged`] where a vector does not come to its accuracy in `max_rounds`.
pub(super) fn left_vectors(
    searched: FactoredProblem,
    modes: &[Mode],
    basis: Option<Basis>,
    accuracies: &[f64],
    max_rounds: usize,
) -> Result<Block> {
    let m = searched.problem.matrices.m;
    let start = right_vectors(m, modes)?;
    let mut space = match basis {
        Some(basis) => Space::of_left_vectors(searched, basis),
        None => Space::spanned(searched, start.clone())?,
    };
    let right = start_from(&space, modes, &start);
    let mut vectors = right.clone();
    let mut open: Vec<usize> = (0..modes.len()).filter(|&i| accuracies[i].is_finite()).collect();
    for round in 0..max_rounds {
        open.retain(|&i| {
            let moved = improve(&space, &mut vectors, i);
            round == 0 || moved > accuracies[i]
        });
        let before = space.v.n_columns();
        if !open.is_empty() {
            let open: Vec<&Ritz> = open.iter().map(|&i| &vectors[i]).collect();
            let residuals = space.sketch(&open)?;
            space.extend_by_solves(&residuals)?;
        }
        if space.v.n_columns() == before {
            pair(&space, &mut vectors, &right);
            return normalised_left(m, space.vectors(&vectors));
        }
    }
    Err(Error::not_converged(format!(
        "left vectors of the modes: after {max_rounds} rounds of corrections {} of {} are not accurate. A narrower band may help",
        open.len(),
        modes.len()
    )))
}

/// The vectors' coefficients in a space that holds them, of length 1.
fn start_from(space: &Space, modes: &[Mode], vectors: &Block) -> Vec<Ritz> {
    let coefficients = space.v.gram(vectors);
    let n = space.v.n_columns();
    let column = |j: usize| coefficients[j * n..(j + 1) * n].to_vec();
    let ritz = |(i, mode): (usize, &Mode)| Ritz { lambda: mode.lambda, re: column(2 * i), im: column(2 * i + 1) };
    modes.iter().enumerate().map(ritz).collect()
}

/// One inverse iteration with the projected `P(lambda)^T` for vector i, from where it was, so that two vectors of one
/// eigenvalue stay two. Gives by how much it moved, relative, out of the space of all vectors with its eigenvalue.
fn improve(space: &Space, vectors: &mut [Ritz], i: usize) -> f64 {
    let lambda = vectors[i].lambda;
    let start = coefficients(space, &vectors[i]);
    // Where lambda is an eigenvalue to the last digit, a number beside it serves.
    let found = LAMBDA_STEPS.iter().find_map(|step| inverse_iterate(space, lambda * (1.0 + step), &start));
    let x = normalise(found.unwrap_or_else(|| start.clone()));
    let has_same = |other: &&Ritz| (other.lambda - lambda).norm() <= SAME_EIGENVALUE * lambda.norm();
    let same: Vec<Vec<Complex64>> = vectors.iter().filter(has_same).map(|own| coefficients(space, own)).collect();
    (vectors[i].re, vectors[i].im) = x.iter().map(|z| (z.re, z.im)).unzip();
    outside(x, &same)
}

/// The coefficients of a vector in the whole space, of length 1.
fn coefficients(space: &Space, vector: &Ritz) -> Vec<Complex64> {
    let entry = |row: usize| match (vector.re.get(row), vector.im.get(row)) {
        (Some(&re), Some(&im)) => Complex64::new(re, im),
        _ => Complex64::default(),
    };
    normalise((0..space.v.n_columns()).map(entry).collect())
}

/// How much of x is outside of what some vectors of length 1 span (Gram and Schmidt, twice).
fn outside(x: Vec<Complex64>, span: &[Vec<Complex64>]) -> f64 {
    let mut basis: Vec<DVector<Complex64>> = Vec::new();
    let rest = |x: &[Complex64], basis: &[DVector<Complex64>]| {
        let once = |x: DVector<Complex64>| basis.iter().fold(x, |x, q| &x - q * q.dotc(&x));
        once(once(DVector::from_column_slice(x)))
    };
    for own in span {
        let own = rest(own, &basis);
        let length = own.norm();
        if length > SAME_DIRECTION {
            basis.push(own / Complex64::from(length));
        }
    }
    rest(&x, &basis).norm()
}

/// Combines the left vectors of each group of equal eigenvalues, so that each belongs to one right vector.
fn pair(space: &Space, vectors: &mut [Ritz], right: &[Ritz]) {
    for i in 0..vectors.len() {
        let lambda = vectors[i].lambda;
        let is_same = |other: &Ritz| (other.lambda - lambda).norm() <= SAME_EIGENVALUE * lambda.norm();
        let group: Vec<usize> = (0..vectors.len()).filter(|&j| is_same(&vectors[j])).collect();
        if group.len() < 2 || group[0] != i {
            continue;
        }
        let columns = |of: &[Ritz]| {
            let columns: Vec<_> = group.iter().map(|&j| DVector::from_vec(coefficients(space, &of[j]))).collect();
            DMatrix::from_columns(&columns)
        };
        let (v, x) = (columns(vectors), columns(right));
        let mut slope = DMatrix::from_element(v.nrows(), v.nrows(), Complex64::ZERO);
        for (factor, projected) in space.problem().slopes(lambda).into_iter().zip(&space.projected) {
            slope.zip_apply(projected, |z, a| *z += factor * a);
        }
        let Some(paired) = biorthogonal(&v, &(x.transpose() * slope * &v)) else { continue };
        for (column, &j) in paired.column_iter().zip(&group) {
            (vectors[j].re, vectors[j].im) = column.iter().map(|z| (z.re, z.im)).unzip();
        }
    }
}

/// `V G^-1`, with columns of length 1: where `G = X^T A V`, column j has no product with the columns of X but its own.
/// None where G is singular, as it is for a defective eigenvalue.
fn biorthogonal(v: &DMatrix<Complex64>, g: &DMatrix<Complex64>) -> Option<DMatrix<Complex64>> {
    let singular = g.clone().singular_values();
    if singular.min() <= SAME_DIRECTION * singular.max() {
        return None;
    }
    let mut paired = v * g.clone().try_inverse()?;
    paired.column_iter_mut().for_each(|mut column| column /= Complex64::from(column.norm()));
    Some(paired)
}

/// The projected `P(lambda)^-T start`; none where that cannot be had.
fn inverse_iterate(space: &Space, lambda: Complex64, start: &[Complex64]) -> Option<Vec<Complex64>> {
    let n = start.len();
    let mut matrix = DMatrix::from_element(n, n, Complex64::default());
    for (factor, projected) in space.problem().coefficients(lambda).into_iter().zip(&space.projected) {
        matrix.zip_apply(projected, |z, x| *z += factor * x);
    }
    let mut x = start.to_vec();
    let is_solved = lapack::solve_complex(n, matrix.as_mut_slice(), &mut x);
    (is_solved && x.iter().all(|z| z.is_finite())).then_some(x)
}

/// A vector of length 1.
fn normalise(mut x: Vec<Complex64>) -> Vec<Complex64> {
    let length = x.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
    x.iter_mut().for_each(|z| *z /= length);
    x
}

/// Right vectors in the same form, `x^H M x = 1`. Collective.
///
/// # Errors
/// PETSc's.
pub fn right_vectors(m: &Matrix, modes: &[Mode]) -> Result<Block> {
    let mut block = Block::zeros(m.comm(), m.n_local(), 2 * modes.len());
    for (j, part) in modes.iter().flat_map(|mode| [&mode.re, &mode.im]).enumerate() {
        part.local(|values| block.column_mut(j).copy_from_slice(values))?;
    }
    normalised(m, block)
}

/// `y = conj(v)` with `y^H M y = 1`. Collective.
///
/// # Errors
/// PETSc's.
pub(super) fn normalised_left(m: &Matrix, v: Block) -> Result<Block> {
    normalised(m, conjugated(v))
}

/// Complex columns with `d^H M d = 1`.
fn normalised(m: &Matrix, mut columns: Block) -> Result<Block> {
    for (j, size) in sizes(m, &columns)?.into_iter().flat_map(|size| [size, size]).enumerate() {
        columns.column_mut(j).iter_mut().for_each(|x| *x /= size);
    }
    Ok(columns)
}

/// `sqrt(d^H M d)` of complex columns.
fn sizes(m: &Matrix, columns: &Block) -> Result<Vec<f64>> {
    let product = columns.multiplied_by(m)?;
    let square = |j: usize| columns.column(j).iter().zip(product.column(j)).map(|(a, b)| a * b).sum();
    let mut squares: Vec<f64> = (0..columns.n_columns()).map(square).collect();
    m.comm().sum_all(&mut squares);
    Ok(squares.chunks(2).map(|pair| pair.iter().sum::<f64>().max(0.0).sqrt()).collect())
}

/// Turns the sign of the imaginary parts.
fn conjugated(mut block: Block) -> Block {
    for j in (1..block.n_columns()).step_by(2) {
        block.column_mut(j).iter_mut().for_each(|x| *x = -*x);
    }
    block
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_that_stays_among_those_of_its_eigenvalue_has_not_moved() {
        let vector = |entries: [f64; 3]| normalise(entries.map(|x| Complex64::from_polar(x, 0.3)).to_vec());
        let same = [vector([1.0, 0.0, 0.0]), vector([1.0, 1e-3, 0.0])];
        let turned = vector([0.6, 0.8, 0.0]);
        assert!(outside(turned.clone(), &same) < 1e-12 && (outside(turned, &same[..1]) - 0.8).abs() < 1e-15);
        let phase = same[0].iter().map(|z| -Complex64::I * z).collect();
        assert!(outside(phase, &same[..1]) < 1e-15, "a phase is no change");
        assert!((outside(vector([3.0, 0.0, 4.0]), &same) - 0.8).abs() < 1e-12);
        let twice = [same[0].clone(), same[0].clone()];
        assert!(outside(same[0].clone(), &twice) < 1e-15, "a vector that stands twice");
        assert!((outside(vector([0.0, 1.0, 0.0]), &twice) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn left_vectors_of_one_eigenvalue_are_those_of_one_right_vector_each() {
        let c = |re: f64, im: f64| Complex64::new(re, im);
        let x = nalgebra::dmatrix![c(1.0, 0.0), c(0.0, 0.0); c(0.0, 0.0), c(1.0, 0.5); c(0.0, 0.0), c(0.0, 0.0)];
        let v = nalgebra::dmatrix![c(0.6, 0.0), c(0.8, 0.1); c(0.0, 0.8), c(0.3, 0.0); c(0.0, 0.0), c(0.0, 0.0)];
        let a = DMatrix::from_diagonal(&DVector::from_vec(vec![c(2.0, 0.0), c(3.0, 1.0), c(1.0, 0.0)]));
        let paired = biorthogonal(&v, &(x.transpose() * &a * &v)).unwrap();
        let g = x.transpose() * a * &paired;
        assert!(g[(0, 1)].norm() < 1e-14 && g[(1, 0)].norm() < 1e-14 && g[(0, 0)].norm() > 0.1, "{g}");
        assert!(paired.column_iter().all(|column| (column.norm() - 1.0).abs() < 1e-14));
        let one = nalgebra::dmatrix![c(1.0, 0.0), c(2.0, 0.0); c(0.5, 0.0), c(1.0, 0.0)];
        assert!(biorthogonal(&v, &one).is_none(), "a defective eigenvalue");
    }
}
