//! How ill-conditioned a factorised matrix is.

use super::QuadraticProblem;
use crate::equilibrium::LabelledFactor;
use crate::native::{Block, Factor, Matrix};
use crate::{ErrorKind, Result};

/// Rounds at most: the estimate rarely grows after the third.
const MAX_ROUNDS: usize = 5;

/// Estimates the condition number of `P(shift)`, which `factor` becomes the factor of: infinite where the matrix is
/// singular. Collective.
///
/// # Errors
/// PETSc's and MUMPS's.
pub fn condition_at(shift: f64, problem: &QuadraticProblem, factor: &mut LabelledFactor) -> Result<f64> {
    match problem.factorise(shift, factor) {
        Ok(factor) if shift == 0.0 => condition(problem.matrices.k, factor),
        Ok(factor) => condition(&problem.shifted(shift)?, factor),
        Err(error) if error.kind() == ErrorKind::Singular => {
            // MUMPS takes no other values after it has failed.
            factor.release();
            Ok(f64::INFINITY)
        }
        Err(error) => Err(error),
    }
}

/// Estimates the condition number `|A| |A^-1|` in the maximum norm, from below and rarely by more than a factor of
/// three. Collective.
///
/// `|A^-1| = |A^-T|_1` by Hager's ascent over the unit ball: `x <- e_j` where the gradient `A^-1 sign(A^-T x)` is
/// largest. Source: Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, algorithm 15.1.
///
/// # Errors
/// PETSc's and MUMPS's.
pub fn condition(a: &Matrix, factor: &Factor) -> Result<f64> {
    let (comm, n) = (a.comm(), a.n_local());
    let total = comm.sum(n) as f64;
    let mut x = Block::from_columns(comm, n, vec![1.0 / total; n]);
    if n == 0 {
        x = Block::zeros(comm, 0, 1);
    }
    let mut estimate = 0.0_f64;
    for _ in 0..MAX_ROUNDS {
        let y = x.solved_by_transpose(factor)?;
        let norm: f64 = comm.sum(y.values().iter().map(|y| y.abs()).sum());
        if !norm.is_finite() {
            return Ok(f64::INFINITY);
        }
        let has_grown = norm > estimate;
        estimate = estimate.max(norm);
        let mut signs = y;
        signs.values_mut().iter_mut().for_each(|y| *y = if *y < 0.0 { -1.0 } else { 1.0 });
        let gradient = signs.solved_by(factor)?;
        let own = gradient.values().iter().map(|z| z.abs()).fold(0.0, f64::max);
        let largest = comm.max_loc(own);
        let slope: f64 = comm.sum(gradient.values().iter().zip(x.values()).map(|(z, x)| z * x).sum());
        if !has_grown || largest.value <= slope {
            break;
        }
        // The first of the largest entries, in the order of the ranks.
        x.values_mut().fill(0.0);
        if largest.rank() == comm.rank() {
            let at = gradient.values().iter().position(|z| z.abs() == largest.value).expect("it is here");
            x.values_mut()[at] = 1.0;
        }
    }
    Ok(estimate * a.norm_inf()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::{FactorKind, Mck, Precision, Session};

    /// Hilbert's matrix of six rows has the condition number 2.907e7 in the maximum norm.
    #[test]
    fn hilberts_matrix_is_as_bad_as_published() {
        let comm = Session::start(&[]).unwrap();
        let values: Vec<f64> = (0..36).map(|at| 1.0 / (1 + at / 6 + at % 6) as f64).collect();
        let a = Matrix::dense(&comm, 6, &values).unwrap();
        let mut factor = Factor::new(FactorKind::Unsymmetric);
        factor.factorise(&a).unwrap();
        let found = condition(&a, &factor).unwrap();
        assert!((found / 2.907_027_9e7 - 1.0).abs() < 1e-6, "{found}");
    }

    #[test]
    fn a_singular_stiffness_is_regular_at_a_shift() {
        let comm = Session::start(&[]).unwrap();
        // A free chain of two unit masses.
        let [m, c, k] = [[1.0, 0.0, 0.0, 1.0], [0.0; 4], [1.0, -1.0, -1.0, 1.0]]
            .map(|values| Matrix::dense(&comm, 2, &values).unwrap());
        let problem = QuadraticProblem::symmetric(Mck::from([&m, &c, &k]));
        let mut factor = LabelledFactor::new(Precision::Double);
        assert_eq!(condition_at(0.0, &problem, &mut factor).unwrap(), f64::INFINITY);
        assert_eq!(factor.shift(), None, "nothing is factorised");
        // [2 -1; -1 2] has the inverse [2 1; 1 2] / 3.
        assert!((condition_at(1.0, &problem, &mut factor).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(factor.shift(), Some(1.0));
    }
}
