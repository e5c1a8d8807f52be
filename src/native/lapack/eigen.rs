//! Eigenvalues of dense matrices.

use nalgebra::DMatrix;
use num_complex::Complex64;
use squeal_sys as sys;

use crate::{Error, Result};

/// Eigenvalues with their vectors, a column each.
pub struct Eigen {
    /// The eigenvalues.
    pub values: Vec<Complex64>,
    /// Vectors of length 1.
    pub vectors: DMatrix<Complex64>,
}

/// Eigenvalues and right eigenvectors, `A v = lambda v`, of a square complex matrix (zgeev). Not collective.
///
/// # Errors
/// [`Error::Lapack`] where the QR iteration fails, [`Error::NotConverged`] where an entry is not finite, with which it
/// cannot succeed.
///
/// # Panics
/// Where the matrix is not square.
pub fn eigen(mut a: DMatrix<Complex64>) -> Result<Eigen> {
    /// Columns of a panel that LAPACK's reduction to Hessenberg form works on at a time.
    const PANEL: usize = 32;
    let n = a.nrows();
    assert!(a.is_square());
    finite("complex", n, a.iter().flat_map(|z| [z.re, z.im]))?;
    let (size, mut info, mut unused) = (n as i32, 0, Complex64::default());
    let (mut values, mut vectors) = (vec![Complex64::default(); n], DMatrix::<Complex64>::zeros(n, n));
    let (mut work, mut real_work) = (vec![Complex64::default(); (PANEL + 1) * n.max(1)], vec![0.0; 2 * n.max(1)]);
    let n_work = work.len() as i32;
    // SAFETY: sizes are those of the arrays; Complex64 has the layout of Fortran's COMPLEX*16; left vectors are not
    // made.
    unsafe {
        sys::zgeev_(
            c"N".as_ptr(),
            c"V".as_ptr(),
            &size,
            a.as_mut_slice().as_mut_ptr().cast(),
            &size.max(1),
            values.as_mut_ptr().cast(),
            (&raw mut unused).cast(),
            &1,
            vectors.as_mut_slice().as_mut_ptr().cast(),
            &size.max(1),
            work.as_mut_ptr().cast(),
            &n_work,
            real_work.as_mut_ptr(),
            &mut info,
        );
    }
    match info {
        0 => Ok(Eigen { values, vectors }),
        _ => Err(Error::Lapack { routine: "zgeev", info, n_rows: n }),
    }
}

/// Eigenvalues, ascending, of a symmetric `n x n` matrix, which its orthonormal eigenvectors replace column by column.
/// Not collective.
///
/// # Errors
/// [`Error::Lapack`] where the QR iteration fails, [`Error::NotConverged`] where an entry is not finite, with which it
/// cannot succeed.
///
/// # Panics
/// Where the slice is not `n x n`.
pub fn symmetric_eigen(n: usize, a: &mut [f64]) -> Result<Vec<f64>> {
    assert_eq!(a.len(), n * n);
    finite("symmetric", n, a.iter().copied())?;
    let (size, mut info) = (n as i32, 0);
    let (mut values, mut work) = (vec![0.0; n], vec![0.0; 40 * n.max(1)]);
    let length = work.len() as i32;
    // SAFETY: sizes are those of the arrays.
    unsafe {
        sys::dsyev_(
            c"V".as_ptr(),
            c"U".as_ptr(),
            &size,
            a.as_mut_ptr(),
            &size.max(1),
            values.as_mut_ptr(),
            work.as_mut_ptr(),
            &length,
            &mut info,
        );
    }
    match info {
        0 => Ok(values),
        _ => Err(Error::Lapack { routine: "dsyev", info, n_rows: n }),
    }
}

/// Refuses a matrix with entries that are not finite.
fn finite(what: &str, n: usize, mut entries: impl Iterator<Item = f64>) -> Result<()> {
    match entries.all(f64::is_finite) {
        true => Ok(()),
        false => Err(Error::not_converged(format!(
            "the eigenvalues of a {what} matrix of {n} rows: an entry is not finite, as the iteration before has \
             overflowed"
        ))),
    }
}

/// Eigenvalues, ascending, of `A x = lambda B x`, A symmetric, B symmetric and positive definite, both `n x n`; A
/// becomes the eigenvectors, `X^T B X = I`, column by column. None where B is not positive definite, or the workspace
/// longer than LAPACK counts. Not collective.
///
/// # Panics
/// Where a slice is not `n x n`.
pub fn generalised_eigen(n: usize, a: &mut [f64], mut b: Vec<f64>) -> Option<Vec<f64>> {
    assert!(a.len() == n * n && b.len() == n * n);
    let (size, mut info) = (n as i32, 0);
    let mut values = vec![0.0; n];
    let (mut work, mut integers) = (vec![0.0; 1 + 6 * n + 2 * n * n], vec![0; 3 + 5 * n]);
    let (n_work, n_integers) = (i32::try_from(work.len()).ok()?, integers.len() as i32);
    // SAFETY: sizes are those of the arrays.
    unsafe {
        sys::dsygvd_(
            &1,
            c"V".as_ptr(),
            c"U".as_ptr(),
            &size,
            a.as_mut_ptr(),
            &size.max(1),
            b.as_mut_ptr(),
            &size.max(1),
            values.as_mut_ptr(),
            work.as_mut_ptr(),
            &n_work,
            integers.as_mut_ptr(),
            &n_integers,
            &mut info,
        );
    }
    (info == 0).then_some(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn symmetric_eigenvalues_ascend_with_their_vectors() {
        // [2 1; 1 2] has 1 with (1, -1) and 3 with (1, 1)
        let mut a = [2.0, 1.0, 1.0, 2.0];
        let values = symmetric_eigen(2, &mut a).unwrap();
        assert!((values[0] - 1.0).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15);
        assert!((a[0] + a[1]).abs() < 1e-15 && (a[2] - a[3]).abs() < 1e-15);
    }

    #[test]
    fn entries_that_are_not_finite_are_refused() {
        let error = symmetric_eigen(2, &mut [1.0, f64::NAN, f64::NAN, 1.0]).unwrap_err();
        assert_eq!(error.kind(), crate::ErrorKind::NotConverged);
        assert!(error.to_string().contains("not finite"), "{error}");
    }

    #[test]
    fn generalised_eigenvectors_are_normal_to_one_another_by_b() {
        // [2 0; 0 3] x = lambda [4 0; 0 1] x: 1/2 with (1/2, 0) and 3 with (0, 1)
        let mut a = [2.0, 0.0, 0.0, 3.0];
        let values = generalised_eigen(2, &mut a, vec![4.0, 0.0, 0.0, 1.0]).unwrap();
        assert!((values[0] - 0.5).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15);
        assert!((a[0].abs() - 0.5).abs() < 1e-15 && (a[3].abs() - 1.0).abs() < 1e-15, "{a:?}");
        assert!(generalised_eigen(2, &mut [1.0, 0.0, 0.0, 1.0], vec![1.0, 2.0, 2.0, 1.0]).is_none());
    }

    fn entry() -> impl Strategy<Value = Complex64> {
        (-1.0..1.0, -1.0..1.0).prop_map(|(re, im)| Complex64::new(re, im))
    }

    proptest! {
        #[test]
        fn pairs_solve_their_problem(entries in prop::collection::vec(entry(), 36)) {
            let a = DMatrix::from_vec(6, 6, entries);
            let Eigen { values, vectors } = eigen(a.clone()).unwrap();
            for (k, &lambda) in values.iter().enumerate() {
                let v = vectors.column(k);
                prop_assert!((v.norm() - 1.0).abs() < 1e-14);
                prop_assert!((&a * v - v * lambda).norm() < 1e-13 * a.norm());
            }
        }
    }

    #[test]
    fn symmetric_spectra_do_not_stop_the_iteration() {
        // Companion matrices of [2 1; k 2]: lambda^2 = -2 +- sqrt(k)
        for k in (0..=100).map(|i| 1.0 - f64::from(i) / 75.0) {
            let rows = [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], [-2.0, -1.0, 0.0, 0.0], [-k, -2.0, 0.0, 0.0]];
            let a = DMatrix::from_row_slice(4, 4, rows.as_flattened()).map(Complex64::from);
            assert!(eigen(a.transpose()).is_ok(), "{k}");
            let found = eigen(a).unwrap();
            let exact = (Complex64::new(k, 0.0).sqrt() - 2.0).sqrt();
            let error = found.values.iter().map(|z| (z - exact).norm()).fold(f64::INFINITY, f64::min);
            assert!(error < if k.abs() < 1e-12 { 1e-7 } else { 1e-13 }, "{k}: {:?}", found.values);
        }
    }

    #[test]
    fn a_double_eigenvalue_keeps_its_plane() {
        let a = DMatrix::from_diagonal(&nalgebra::dvector![2.0, 3.0, 2.0].map(Complex64::from));
        let Eigen { values, vectors } = eigen(a).unwrap();
        assert_eq!(values.iter().filter(|z| z.re == 2.0).count(), 2);
        assert!(vectors.determinant().norm() > 0.99);
    }
}
