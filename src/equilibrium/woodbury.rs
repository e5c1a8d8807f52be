//! The inverse of a matrix that differs by a low rank from one with a known inverse.
//!
//! ```text
//! (A + U V^T)^-1 = A^-1 - W S^-1 V^T A^-1        W = A^-1 U,  S = I + V^T W
//! ```
//!
//! Source: Sherman, Morrison and Woodbury; Golub and Van Loan, Matrix Computations, 4th ed., section 2.1.4.

use nalgebra::DMatrix;

use crate::native::{Block, lapack};

/// `W` and `S^-1`.
pub struct Woodbury {
    w: Block,
    inverse: DMatrix<f64>,
}

impl Woodbury {
    /// From `W` and `V^T W`; none where the changed matrix is singular. Not collective.
    pub fn new(w: Block, projected: DMatrix<f64>) -> Option<Woodbury> {
        let n = projected.nrows();
        let inverse = (DMatrix::identity(n, n) + projected).try_inverse()?;
        inverse.iter().all(|x| x.is_finite()).then_some(Woodbury { w, inverse })
    }

    /// `x -= W S^-1 V^T x` on this rank's rows, given `V^T x`: turns `A^-1 b` into `(A + U V^T)^-1 b`. Not collective.
    pub fn correct(&self, projected: &[f64], x: &mut [f64]) {
        let rank = projected.len();
        let mut y = vec![0.0; rank];
        lapack::multiply(false, [rank, rank, 1], self.inverse.as_slice(), projected, &mut y);
        lapack::subtract_product([x.len(), rank, 1], self.w.values(), &y, x);
    }

    /// W.
    pub fn into_columns(self) -> Block {
        self.w
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;
    use nalgebra::DVector;

    #[test]
    fn a_corrected_solution_is_that_of_the_changed_matrix() {
        let comm = Session::start(&[]).unwrap();
        let a = DMatrix::from_fn(
            6,
            6,
            |i, j| if i == j { 4.0 + i as f64 } else { 0.3 * (i as f64 - 0.5 * j as f64).sin() },
        );
        let u = DMatrix::from_fn(6, 2, |i, j| (1 + i + 3 * j) as f64 * 0.2);
        let v = DMatrix::from_fn(6, 2, |i, j| ((i * (j + 1)) as f64).cos());
        let b = DVector::from_fn(6, |i, _| 1.0 - i as f64);
        let lu = a.clone().lu();
        let w = lu.solve(&u).unwrap();
        let woodbury = Woodbury::new(Block::from_columns(&comm, 6, w.as_slice().to_vec()), v.transpose() * &w).unwrap();
        let mut x = lu.solve(&b).unwrap();
        let projected = v.transpose() * &x;
        woodbury.correct(projected.as_slice(), x.as_mut_slice());
        assert!(((a + u * v.transpose()) * x - b).norm() < 1e-12);
    }

    #[test]
    fn a_change_that_makes_the_matrix_singular_is_refused() {
        let comm = Session::start(&[]).unwrap();
        // I - e e^T
        let w = Block::from_columns(&comm, 2, vec![-1.0, 0.0]);
        assert!(Woodbury::new(w, DMatrix::from_element(1, 1, -1.0)).is_none());
    }
}
