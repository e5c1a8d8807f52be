//! Products of dense matrices, column-major, by BLAS.

use squeal_sys as sys;

/// So many columns are multiplied one by one, where the matrix has so few entries that it stays in the cache: for more,
/// BLAS copies the matrix in an order of its own first.
pub(in crate::native) const FEW: usize = 6;
const CACHED: usize = 1 << 20;

/// `C = op(A) B` with A of `rows x inner` (or its transpose where `transposed`), B of `inner x columns`. Not
/// collective.
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

/// `C += A B^T` with A of `rows x inner`, B of `columns x inner`. Not collective.
///
/// # Panics
/// Where the slices do not have those sizes.
pub fn add_product_with_transpose([rows, inner, columns]: [usize; 3], a: &[f64], b: &[f64], c: &mut [f64]) {
    assert_eq!((a.len(), b.len(), c.len()), (rows * inner, columns * inner, rows * columns));
    if a.is_empty() || b.is_empty() {
        return;
    }
    let ([m, k, n], [one, a, b]) = ([rows as i32, inner as i32, columns as i32], [&[1.0], a, b].map(<[f64]>::as_ptr));
    let (no, yes) = (c"N".as_ptr(), c"T".as_ptr());
    // SAFETY: the leading dimensions and sizes are those of the slices, checked above.
    unsafe {
        sys::dgemm_(no, yes, &m, &n, &k, one, a, &m, b, &n, one, c.as_mut_ptr(), &m);
    }
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
    fn a_product_with_a_transpose_is_added() {
        // A = [1 3; 2 4; 5 6], B = [1 2; 0 1]: A B^T = [7 3; 10 4; 17 6]
        let mut c = [1.0; 6];
        add_product_with_transpose([3, 2, 2], &[1.0, 2.0, 5.0, 3.0, 4.0, 6.0], &[1.0, 0.0, 2.0, 1.0], &mut c);
        assert_eq!(c, [8.0, 11.0, 18.0, 4.0, 5.0, 7.0]);
    }
}
