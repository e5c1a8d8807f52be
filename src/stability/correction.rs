//! What the eigenvalues of a problem in a subspace lack.
//!
//! Let x and y be right and left vectors in the space of V with `V^T P(lambda) x = 0` and `y^H P(lambda) V = 0`. With
//! the residuals `r_x = P(lambda) x`, `r_y = P(lambda)^H y` and the answer `A` of what V lacks, the eigenvalue of the
//! whole problem is, to first order,
//!
//! ```text
//! lambda + (r_y^H A r_x - y^H r_x) / (y^H P'(lambda) x)
//! ```
//!
//! that of the Schur complement of `P(lambda)` on V (Stewart and Sun, *Matrix Perturbation Theory*, 1990, section V.2).
//! What lies outside of V is stiff beside `lambda^2 M`, so that A is a static answer.

use num_complex::Complex64;

use super::QuadraticProblem;
use super::mode::backward_errors;
use super::space::Side;
use crate::Result;
use crate::native::{Block, Matrix};

/// Eigenpairs of a problem in a subspace, as vectors of the whole: real and imaginary parts side by side.
pub struct Approximation<'a> {
    /// Eigenvalues, 1/s.
    pub lambdas: &'a [Complex64],
    /// Right vectors x.
    pub right: &'a Block,
    /// Left vectors y.
    pub left: &'a Block,
}

/// An eigenvalue as the whole problem has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// The eigenvalue to first order, 1/s.
    pub lambda: Complex64,
    /// Backward error of the approximation.
    pub backward_error: f64,
}

/// Corrects eigenvalues; `answer` is A. Collective.
///
/// # Errors
/// PETSc's; those of `answer`.
pub fn corrections(
    problem: &QuadraticProblem,
    approximation: &Approximation,
    answer: impl FnOnce(&Block) -> Result<Block>,
) -> Result<Vec<Correction>> {
    let &Approximation { lambdas, right, left } = approximation;
    let backward_errors = backward_errors(problem, lambdas, right)?;
    let r_x = residuals(problem, right, lambdas, Side::Right)?;
    let r_y = residuals(problem, left, lambdas, Side::Left)?;
    let slopes = approximation.forms(problem, &|lambda| problem.slopes(lambda))?;
    let (answered, direct) = (products(&r_y, &answer(&r_x)?), products(left, &r_x));
    let of = |(i, (&lambda, backward_error)): (usize, (&Complex64, f64))| Correction {
        lambda: lambda + (answered[i] - direct[i]) / slopes[i],
        backward_error,
    };
    Ok(lambdas.iter().zip(backward_errors).enumerate().map(of).collect())
}

impl Approximation<'_> {
    /// `sum_b c_b(lambda_i) y_i^H A_b x_i` over the matrices of a problem: with its coefficients `y^H P(lambda) x`,
    /// with its slopes `y^H P'(lambda) x`. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn forms(
        &self,
        problem: &QuadraticProblem,
        coefficients: &dyn Fn(Complex64) -> Vec<Complex64>,
    ) -> Result<Vec<Complex64>> {
        let form = |matrix: &Matrix| Ok(products(self.left, &self.right.multiplied_by(matrix)?));
        let of_matrices: Vec<Vec<Complex64>> = problem.all_matrices().into_iter().map(form).collect::<Result<_>>()?;
        let sum = |(i, lambda): (usize, &Complex64)| {
            coefficients(*lambda).iter().zip(&of_matrices).map(|(factor, own)| factor * own[i]).sum()
        };
        Ok(self.lambdas.iter().enumerate().map(sum).collect())
    }
}

/// `y_i^H x_i`. Collective.
fn products(y: &Block, x: &Block) -> Vec<Complex64> {
    let dot = |i: usize, j: usize| -> f64 { y.column(i).iter().zip(x.column(j)).map(|(a, b)| a * b).sum() };
    let product = |(re, im): (usize, usize)| [dot(re, re) + dot(im, im), dot(re, im) - dot(im, re)];
    let mut parts: Vec<f64> = (0..y.n_columns() / 2).flat_map(|i| product((2 * i, 2 * i + 1))).collect();
    y.comm().sum_all(&mut parts);
    parts.as_chunks().0.iter().map(|&[re, im]| Complex64::new(re, im)).collect()
}

/// `P(lambda_i) x_i`, or `P(lambda_i)^H y_i` of left vectors.
fn residuals(problem: &QuadraticProblem, x: &Block, lambdas: &[Complex64], side: Side) -> Result<Block> {
    let mut residuals = Block::zeros(x.comm(), x.n_local(), x.n_columns());
    let factors: Vec<Vec<Complex64>> = lambdas.iter().map(|&lambda| problem.coefficients(lambda)).collect();
    for (at, matrix) in problem.all_matrices().into_iter().enumerate() {
        let image = if side == Side::Left { x.multiplied_by_transpose(matrix)? } else { x.multiplied_by(matrix)? };
        for (i, factors) in factors.iter().enumerate() {
            let factor = if side == Side::Left { factors[at].conj() } else { factors[at] };
            for (to, [a, b]) in [(2 * i, [factor.re, -factor.im]), (2 * i + 1, [factor.im, factor.re])] {
                let parts = image.column(2 * i).iter().zip(image.column(2 * i + 1));
                residuals.column_mut(to).iter_mut().zip(parts).for_each(|(r, (re, im))| *r += a * re + b * im);
            }
        }
    }
    Ok(residuals)
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::native::{Mck, Session};
    use crate::stability::testing::{Blocks, eigenvalues, eigenvalues_of, entries};

    const END: f64 = 8.0;

    /// Vectors of a complex eigenproblem by inverse iteration: `P(lambda) x = 0`.
    fn null_vector(p: &DMatrix<Complex64>) -> DVector<Complex64> {
        let n = p.nrows();
        let near = p + DMatrix::identity(n, n) * Complex64::from(1e-9 * p.camax());
        let lu = near.lu();
        (0..4).fold(DVector::from_element(n, Complex64::ONE), |x, _| lu.solve(&x).unwrap().normalize())
    }

    /// All displacements but the stiff ones along y, whose small coupling is what the basis lacks, and those.
    fn basis_and_rest() -> [DMatrix<f64>; 2] {
        let mixed = |i: usize, j: usize| match (i, j) {
            _ if i == j => 1.0,
            _ if i + 1 == j || j + 2 == i => 0.02,
            _ => 0.0,
        };
        let all = DMatrix::from_fn(12, 12, mixed);
        let with = |is_stiff: bool| (0..12).filter(|j| (j % 3 == 1) == is_stiff).collect::<Vec<_>>();
        [false, true].map(|is_stiff| all.select_columns(&with(is_stiff)))
    }

    /// `P(lambda) = lambda^2 M + lambda C + K`
    fn at(lambda: Complex64, [m, c, k]: [&DMatrix<f64>; 3]) -> DMatrix<Complex64> {
        let complex = |a: &DMatrix<f64>| a.map(Complex64::from);
        complex(m) * lambda * lambda + complex(c) * lambda + complex(k)
    }

    /// Block on a belt without one coordinate of the last block: the correction brings the eigenvalues much nearer.
    #[test]
    fn corrected_eigenvalues_are_those_of_the_whole_problem() {
        let comm = Session::start(&[]).unwrap();
        let blocks = Blocks::new(&comm, 4);
        blocks.with(0.5, &[], |problem| {
            let [m, c, k] = problem.matrices.map(entries).into_array();
            let [v, lacking] = basis_and_rest();
            let project = |a: &DMatrix<f64>| v.transpose() * a * &v;
            let (m_r, c_r, k_r) = (project(&m), project(&c), project(&k));
            let reduced = eigenvalues_of(Mck::from([m_r.clone(), c_r.clone(), k_r.clone()]), END);
            let exact = eigenvalues(problem, END);
            let vectors = |transpose: bool| {
                let columns = reduced.iter().flat_map(|&lambda| {
                    let p = at(lambda, [&m_r, &c_r, &k_r]);
                    let q = null_vector(&if transpose { p.adjoint() } else { p });
                    let x = v.map(Complex64::from) * q;
                    [x.map(|z| z.re), x.map(|z| z.im)].map(|part| part.as_slice().to_vec())
                });
                Block::from_columns(&comm, 12, columns.flatten().collect())
            };
            let (right, left) = (vectors(false), vectors(true));
            let approximation = Approximation { lambdas: &reduced, right: &right, left: &left };
            let inner = (lacking.transpose() * &k * &lacking).try_inverse().unwrap();
            let answer = |r: &Block| {
                let r = DMatrix::from_column_slice(12, r.n_columns(), r.values());
                let x = &lacking * &inner * lacking.transpose() * r;
                Ok(Block::from_columns(&comm, 12, x.as_slice().to_vec()))
            };
            let corrected = corrections(problem, &approximation, answer).unwrap();
            assert!(!reduced.is_empty() && reduced.len() == exact.len());
            let distance = |z: Complex64| exact.iter().map(|e| (e - z).norm() / e.norm()).fold(f64::INFINITY, f64::min);
            for (before, after) in reduced.iter().zip(&corrected) {
                let [before, now] = [*before, after.lambda].map(distance);
                assert!(now < 0.4 * before, "{before:e} {now:e}");
                assert!(after.backward_error > 1e-6);
            }
        });
    }
}
