//! Small dense algebra by BLAS and LAPACK, column-major.

mod factor;

pub(in crate::native) use factor::DenseFactor;

use num_complex::Complex64;
use squeal_sys as sys;

use crate::{Error, Result};

/// So many columns are multiplied one by one, where the matrix has so few entries that it stays in the cache: for more, BLAS copies the matrix in
/// an order of its own first.
pub(in crate::native) const FEW: usize = 6;
const CACHED: usize = 1 << 20;

/// `C = op(A) B` with A of `rows x inner` (or its transpose where `transposed`), B of `inner x columns`. Not collective.
///
/// # Panics
/// Where the slices do not have those sizes.
pub fn multiply(transposed: bool, sizes: [usize; 3], a: &[f64], b: &[f64], c: &mut [f64]) {
    if sizes[1] == 0 {
        return c.fill(0.0);
    }
    update(transposed, sizes, [1.0, 0.0], a, b, c);
}

/// `C += op(A) B` as in [`multiply`]. Not collective.
///
/// # Panics
/// Where the slices do not have those sizes.
pub fn add_product(transposed: bool, sizes: [usize; 3], a: &[f64], b: &[f64], c: &mut [f64]) {
    update(transposed, sizes, [1.0, 1.0], a, b, c);
}

/// `C -= A B` with A of `rows x inner`, B of `inner x columns`. Not collective.
///
/// # Panics
/// Where the slices do not have those sizes.
pub fn subtract_product(sizes: [usize; 3], a: &[f64], b: &[f64], c: &mut [f64]) {
    update(false, sizes, [-1.0, 1.0], a, b, c);
}

/// `C = alpha op(A) B + beta C`
fn update(
    transposed: bool,
    [rows, inner, columns]: [usize; 3],
    [alpha, beta]: [f64; 2],
    a: &[f64],
    b: &[f64],
    c: &mut [f64],
) {
    assert_eq!((a.len(), b.len(), c.len()), (rows * inner, inner * columns, rows * columns));
    if rows == 0 || columns == 0 || inner == 0 {
        return;
    }
    let [m, k, n] = [rows as i32, inner as i32, columns as i32];
    let (op, lda) = if transposed { (c"T", k) } else { (c"N", m) };
    if columns == 1 || columns <= FEW && a.len() <= CACHED {
        let (rows_of_a, columns_of_a) = if transposed { (k, m) } else { (m, k) };
        for (b, c) in b.chunks(inner).zip(c.chunks_mut(rows)) {
            let (b, c) = (b.as_ptr(), c.as_mut_ptr());
            // SAFETY: the leading dimension and sizes are those of the slices, checked above.
            unsafe {
                sys::dgemv_(op.as_ptr(), &rows_of_a, &columns_of_a, &alpha, a.as_ptr(), &lda, b, &1, &beta, c, &1);
            }
        }
        return;
    }
    // SAFETY: the leading dimensions and sizes are those of the slices, checked above.
    unsafe {
        sys::dgemm_(
            op.as_ptr(),
            c"N".as_ptr(),
            &m,
            &n,
            &k,
            &alpha,
            a.as_ptr(),
            &lda,
            b.as_ptr(),
            &k,
            &beta,
            c.as_mut_ptr(),
            &m,
        );
    }
}

/// Eigenvalues, ascending, of a symmetric `n x n` matrix, which its orthonormal eigenvectors replace column by column. Not collective.
///
/// # Errors
/// [`Error::Lapack`] where the QR iteration fails, [`Error::NotConverged`] where an entry is not finite, with which it cannot succeed.
///
/// # Panics
/// Where the slice is not `n x n`.
pub fn symmetric_eigen(n: usize, a: &mut [f64]) -> Result<Vec<f64>> {
    assert_eq!(a.len(), n * n);
    finite("symmetric", n, a)?;
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
fn finite(what: &str, n: usize, a: &[f64]) -> Result<()> {
    match a.iter().all(|x| x.is_finite()) {
        true => Ok(()),
        false => Err(Error::not_converged(format!(
            "the eigenvalues of a {what} matrix of {n} rows: an entry is not finite, as the iteration before has overflowed"
        ))),
    }
}

/// Eigenvalues, ascending, of `A x = lambda B x`, A symmetric, B symmetric and positive definite, both `n x n`; A becomes the eigenvectors,
/// `X^T B X = I`, column by column. None where B is not positive definite. Not collective.
///
/// # Panics
/// Where a slice is not `n x n`.
pub fn generalised_eigen(n: usize, a: &mut [f64], mut b: Vec<f64>) -> Option<Vec<f64>> {
    assert!(a.len() == n * n && b.len() == n * n);
    let (size, mut info) = (n as i32, 0);
    let mut values = vec![0.0; n];
    let (mut work, mut integers) = (vec![0.0; 1 + 6 * n + 2 * n * n], vec![0; 3 + 5 * n]);
    let (n_work, n_integers) = (work.len() as i32, integers.len() as i32);
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

/// Solves `A X = B` for a complex column-major A of `n x n`, which is destroyed; X overwrites B. False where A is singular. Not
/// collective.
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

    #[test]
    fn products_are_column_major() {
        // A = [1 3; 2 4; 5 6], B = [1; -1]
        let a = [1.0, 2.0, 5.0, 3.0, 4.0, 6.0];
        let mut c = [0.0; 3];
        multiply(false, [3, 2, 1], &a, &[1.0, -1.0], &mut c);
        assert_eq!(c, [-2.0, -2.0, -1.0]);
        let mut d = [0.0; 2];
        multiply(true, [2, 3, 1], &a, &[1.0, 1.0, 1.0], &mut d);
        assert_eq!(d, [8.0, 13.0]);
    }

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
