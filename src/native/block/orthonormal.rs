//! Orthonormal bases from Gram matrices.

use nalgebra::DMatrix;

use super::Block;
use crate::Result;
use crate::native::lapack;

/// What makes columns W orthonormal.
pub struct Orthonormal {
    /// Q: `W Q` is orthonormal.
    pub q: DMatrix<f64>,
    /// R: `W = (W Q) R`, up to the directions left out.
    pub r: DMatrix<f64>,
}

impl Orthonormal {
    /// From the Gram matrix `G = W^T A W` in the inner product of A, with `G = V L V^T`: `Q = V L^-1/2`, `R = L^1/2
    /// V^T`, of the directions that are longer than `shortest(longest)`, at most `max_columns`, the longest first. Its
    /// accuracy is that of G, the square of the ratio of lengths: twice is enough. Not collective.
    ///
    /// # Errors
    /// Those of LAPACK's eigensolver.
    pub fn new(mut gram: DMatrix<f64>, shortest: impl Fn(f64) -> f64, max_columns: usize) -> Result<Orthonormal> {
        let n = gram.nrows();
        let squares = lapack::symmetric_eigen(n, gram.as_mut_slice())?;
        let lengths: Vec<f64> = squares.iter().map(|square| square.max(0.0).sqrt()).collect();
        let limit = shortest(lengths.last().copied().unwrap_or_default());
        let kept: Vec<usize> = (0..n).rev().filter(|&i| lengths[i] > limit).take(max_columns).collect();
        let q = DMatrix::from_fn(n, kept.len(), |i, j| gram[(i, kept[j])] / lengths[kept[j]]);
        let r = DMatrix::from_fn(kept.len(), n, |i, j| lengths[kept[i]] * gram[(j, kept[i])]);
        Ok(Orthonormal { q, r })
    }
}

impl Block {
    /// An orthonormal basis of the columns' span, of at most `max_columns`: directions smaller than `negligible` times
    /// the largest are left out, columns taken at length 1. Collective.
    ///
    /// # Errors
    /// See [`Orthonormal::new`].
    pub fn orthonormalised(&self, negligible: f64, max_columns: usize) -> Result<Block> {
        let n = self.n_columns();
        let gram = DMatrix::from_vec(n, n, self.gram(self));
        // A column whose square underflows is zero.
        let inverse = |square: f64| if square < f64::MIN_POSITIVE { 0.0 } else { 1.0 / square.sqrt() };
        let scale: Vec<f64> = (0..n).map(|j| inverse(gram[(j, j)])).collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| scale[i] * gram[(i, j)] * scale[j]);
        let mut q = Orthonormal::new(scaled, |longest| negligible * longest, max_columns)?.q;
        q.row_iter_mut().zip(&scale).for_each(|(mut row, scale)| row *= *scale);
        Ok(self.combined(q.as_slice(), q.ncols()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    #[test]
    fn columns_are_the_basis_times_the_triangle_up_to_what_is_left_out() {
        // Columns e1, e1 + 1e-3 e2, e1 + e3 in the inner product of diag(1, 4, 9).
        let w = DMatrix::from_row_slice(3, 3, &[1.0, 1.0, 1.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 1.0]);
        let a = DMatrix::from_diagonal(&nalgebra::dvector![1.0, 4.0, 9.0]);
        let gram = || w.tr_mul(&(&a * &w));
        let Orthonormal { q, r } = Orthonormal::new(gram(), |_| 1e-6, 3).unwrap();
        let basis = &w * &q;
        assert!((basis.tr_mul(&(&a * &basis)) - DMatrix::identity(3, 3)).norm() < 1e-9);
        assert!((&basis * r - &w).norm() < 1e-9);
        assert_eq!(Orthonormal::new(gram(), |longest| 1e-2 * longest, 3).unwrap().q.ncols(), 2);
        assert_eq!(Orthonormal::new(gram(), |_| 0.0, 1).unwrap().q.ncols(), 1);
        assert_eq!(Orthonormal::new(DMatrix::zeros(0, 0), |_| 0.0, 1).unwrap().q.ncols(), 0);
    }

    #[test]
    fn a_column_counts_by_its_direction_and_not_by_its_size() {
        let comm = Session::start(&[]).unwrap();
        let block = Block::from_columns(&comm, 3, vec![1e-20, 0.0, 0.0, 1.0, 1.0, 0.0, 1e-200, 0.0, 1.0]);
        assert_eq!(block.orthonormalised(1e-7, 3).unwrap().n_columns(), 3);
        assert_eq!(block.orthonormalised(1e-7, 2).unwrap().n_columns(), 2);
        let nothing = Block::from_columns(&comm, 3, vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1e-170, 0.0, 1e-310]);
        assert_eq!(nothing.orthonormalised(1e-7, 3).unwrap().n_columns(), 1);
    }
}
