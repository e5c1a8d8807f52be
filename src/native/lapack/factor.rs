//! Factors of matrices that are stored densely, by LAPACK.

use std::ffi::CStr;

use num_complex::Complex64;
use squeal_sys as sys;

use super::product::FEW;
use crate::native::FactorKind;
use crate::{Error, Result};

/// `P L U` or `P L D L^T P^T` of a matrix, column-major.
pub(in crate::native) struct DenseFactor {
    kind: FactorKind,
    n: usize,
    values: Vec<f64>,
    pivots: Vec<i32>,
}

impl DenseFactor {
    /// Factorises an `n x n` matrix.
    pub(in crate::native) fn new(kind: FactorKind, n: usize, mut values: Vec<f64>) -> Result<DenseFactor> {
        assert_eq!(values.len(), n * n);
        let (size, mut pivots, mut info) = (n as i32, vec![0; n], 0);
        let leading = size.max(1);
        // SAFETY: sizes are those of the arrays.
        unsafe {
            match kind {
                FactorKind::Unsymmetric => {
                    sys::dgetrf_(&size, &size, values.as_mut_ptr(), &leading, pivots.as_mut_ptr(), &mut info);
                }
                FactorKind::Symmetric => {
                    let mut work = vec![0.0; 64 * n.max(1)];
                    let (lower, length) = (c"L".as_ptr(), work.len() as i32);
                    let (a, w) = (values.as_mut_ptr(), work.as_mut_ptr());
                    sys::dsytrf_(lower, &size, a, &leading, pivots.as_mut_ptr(), w, &length, &mut info);
                }
            }
        }
        match info {
            0 => Ok(DenseFactor { kind, n, values, pivots }),
            // A pivot is zero.
            _ => Err(Error::Singular { found_by: format!("LAPACK's factorisation, info = {info}") }),
        }
    }

    /// Overwrites right-hand sides, column by column, with the solutions, of the transposed matrix where that is asked
    /// for.
    pub(in crate::native) fn solve(&self, columns: &mut [f64], transposed: bool) {
        match self.kind {
            FactorKind::Unsymmetric if columns.len() <= FEW * self.n => {
                columns.chunks_mut(self.n.max(1)).for_each(|x| self.solve_one(x, transposed));
            }
            _ => self.solve_many(columns, transposed),
        }
    }

    /// One right-hand side: LAPACK's own solver would copy the factor to make it ready for many.
    fn solve_one(&self, x: &mut [f64], transposed: bool) {
        let (n, leading) = (self.n as i32, (self.n as i32).max(1));
        let solve = |x: &mut [f64], triangle: &CStr, diagonal: &CStr, op: &CStr| {
            let (uplo, diag, a) = (triangle.as_ptr(), diagonal.as_ptr(), self.values.as_ptr());
            // SAFETY: sizes are those of the arrays.
            unsafe { sys::dtrsv_(uplo, op.as_ptr(), diag, &n, a, &leading, x.as_mut_ptr(), &1) };
        };
        let swaps = self.pivots.iter().enumerate().map(|(i, &pivot)| (i, pivot as usize - 1));
        if transposed {
            solve(x, c"U", c"N", c"T");
            solve(x, c"L", c"U", c"T");
            swaps.rev().for_each(|(i, j)| x.swap(i, j));
        } else {
            swaps.for_each(|(i, j)| x.swap(i, j));
            solve(x, c"L", c"U", c"N");
            solve(x, c"U", c"N", c"N");
        }
    }

    fn solve_many(&self, columns: &mut [f64], transposed: bool) {
        let (n, leading, mut info) = (self.n as i32, (self.n as i32).max(1), 0);
        let count = (columns.len() / self.n.max(1)) as i32;
        let (a, pivots, b) = (self.values.as_ptr(), self.pivots.as_ptr(), columns.as_mut_ptr());
        let op = if transposed { c"T" } else { c"N" };
        // SAFETY: sizes are those of the arrays.
        unsafe {
            match self.kind {
                FactorKind::Unsymmetric => {
                    sys::dgetrs_(op.as_ptr(), &n, &count, a, &leading, pivots, b, &leading, &mut info);
                }
                FactorKind::Symmetric => {
                    sys::dsytrs_(c"L".as_ptr(), &n, &count, a, &leading, pivots, b, &leading, &mut info);
                }
            }
        }
        debug_assert_eq!(info, 0, "all arguments are good");
    }

    /// Number of negative eigenvalues, by Sylvester's law of inertia: of D, whose 2 x 2 blocks have one each.
    pub(in crate::native) fn n_negative(&self) -> usize {
        let (mut i, mut count) = (0, 0);
        while i < self.n {
            let is_pair = self.pivots[i] < 0;
            count += usize::from(is_pair || self.values[i * self.n + i] < 0.0);
            i += 1 + usize::from(is_pair);
        }
        count
    }

    /// Operations of the factorisation.
    pub(in crate::native) fn flops(&self) -> f64 {
        let cube = (self.n as f64).powi(3);
        cube / if self.kind == FactorKind::Symmetric { 3.0 } else { 1.5 }
    }

    /// Entries that are kept.
    pub(in crate::native) fn n_entries(&self) -> usize {
        self.values.len()
    }
}

/// Solves `A X = B` for a complex column-major A of `n x n`, which is destroyed; X overwrites B. False where A is
/// singular. Not collective.
///
/// # Panics
/// Where A is not `n x n`, or B has not n rows.
pub fn solve_complex(n: usize, a: &mut [Complex64], b: &mut [Complex64]) -> bool {
    assert!(a.len() == n * n && b.len().is_multiple_of(n));
    if b.is_empty() {
        return true;
    }
    let (size, columns, mut info) = (n as i32, (b.len() / n) as i32, 0);
    let mut pivots = vec![0; n];
    // SAFETY: sizes are those of the arrays; Complex64 has the layout of Fortran's COMPLEX*16.
    unsafe {
        let (a, b) = (a.as_mut_ptr().cast(), b.as_mut_ptr().cast());
        sys::zgesv_(&size, &columns, a, &size, pivots.as_mut_ptr(), b, &size, &mut info);
    }
    info == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Symmetric with the eigenvalues -1, 1 and 3: one 2 x 2 pivot.
    const SYMMETRIC: [f64; 9] = [0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 3.0];

    #[test]
    fn one_and_many_right_hand_sides_are_solved() {
        // [0 1 0; 2 0 0; 0 0 4] by columns
        let lu =
            DenseFactor::new(FactorKind::Unsymmetric, 3, vec![0.0, 2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 4.0]).unwrap();
        let mut x = [3.0, 4.0, 8.0];
        lu.solve(&mut x, false);
        assert_eq!(x, [2.0, 3.0, 2.0]);
        for n_columns in [2, 2 * FEW] {
            let mut x = [3.0, 4.0, 8.0, 0.0, 2.0, 0.0].repeat(n_columns / 2);
            lu.solve(&mut x, false);
            assert_eq!(x, [2.0, 3.0, 2.0, 1.0, 0.0, 0.0].repeat(n_columns / 2));
        }
        let mut x = [4.0, 3.0, 8.0];
        lu.solve(&mut x, true);
        assert_eq!(x, [3.0, 2.0, 2.0]);
        let ldl = DenseFactor::new(FactorKind::Symmetric, 3, SYMMETRIC.to_vec()).unwrap();
        let mut x = [5.0, 7.0, 6.0];
        ldl.solve(&mut x, false);
        assert_eq!(x, [7.0, 5.0, 2.0]);
    }

    #[test]
    fn negative_eigenvalues_are_counted_and_singular_matrices_refused() {
        assert_eq!(DenseFactor::new(FactorKind::Symmetric, 3, SYMMETRIC.to_vec()).unwrap().n_negative(), 1);
        let minus: Vec<f64> = SYMMETRIC.iter().map(|x| -x).collect();
        assert_eq!(DenseFactor::new(FactorKind::Symmetric, 3, minus).unwrap().n_negative(), 2);
        let singular = DenseFactor::new(FactorKind::Unsymmetric, 2, vec![1.0, 1.0, 1.0, 1.0]).err().unwrap();
        assert_eq!(singular.kind(), crate::ErrorKind::Singular);
    }

    #[test]
    fn complex_systems_are_solved_in_place() {
        let z = Complex64::new;
        // [i 2; 0 1] (1, i) = (3i, i)
        let mut a = [z(0.0, 1.0), z(0.0, 0.0), z(2.0, 0.0), z(1.0, 0.0)];
        let mut b = [z(0.0, 3.0), z(0.0, 1.0)];
        assert!(solve_complex(2, &mut a, &mut b));
        assert!((b[0] - 1.0).norm() < 1e-15 && (b[1] - z(0.0, 1.0)).norm() < 1e-15, "{b:?}");
        assert!(!solve_complex(1, &mut [z(0.0, 0.0)], &mut [z(1.0, 0.0)]));
    }
}
