//! Eigenvalues and right eigenvectors of a small dense complex matrix, by QR steps with one shift. (Tracking spends its time here, and
//! nalgebra's Schur form, whose steps are made for real matrices, took four times as long.)

use nalgebra::{DMatrix, Hessenberg};
use num_complex::Complex64;

/// Eigenvalues with their vectors, a column each.
pub struct Eigen {
    pub values: Vec<Complex64>,
    pub vectors: DMatrix<Complex64>,
}

/// QR steps for one eigenvalue at most; 2 or 3 are usual.
const STEPS: usize = 60;
/// Every so many steps the shift is changed, so that no cycle lasts.
const EXCEPTIONAL: usize = 10;

/// Solves `A v = lambda v` by Schur's form `A = Q U Q^H`; none where its iteration fails. Vectors have length 1.
pub fn eigen(a: DMatrix<Complex64>) -> Option<Eigen> {
    let n = a.nrows();
    if n == 0 {
        return Some(Eigen { values: Vec::new(), vectors: a });
    }
    let smallest = (f64::EPSILON * a.camax()).max(f64::MIN_POSITIVE);
    let (mut q, mut u) = Hessenberg::new(a).unpack();
    triangularise(&mut u, &mut q)?;
    let mut vectors = q * back_substituted(&u, smallest);
    vectors.column_iter_mut().for_each(|mut v| v /= Complex64::from(v.norm()));
    Some(Eigen { values: (0..n).map(|i| u[(i, i)]).collect(), vectors })
}

/// Makes a Hessenberg matrix triangular, `H = Q U Q^H`; Q is taken over into `q`. None where it does not converge.
fn triangularise(h: &mut DMatrix<Complex64>, q: &mut DMatrix<Complex64>) -> Option<()> {
    let (mut last, mut steps, smallest) = (h.nrows() - 1, 0, f64::EPSILON * h.camax());
    while last > 0 {
        let first = deflated(h, last, smallest);
        if first == last {
            (last, steps) = (last - 1, 0);
            continue;
        }
        steps += 1;
        if steps > STEPS {
            return None;
        }
        let shift =
            if steps % EXCEPTIONAL == 0 { h[(last, last - 1)] * 1.5 + h[(last, last)] } else { wilkinson(h, last) };
        step(h, q, first, last, shift);
    }
    Some(())
}

/// The first row of the last block that does not fall apart; what is negligible below the diagonal is removed.
fn deflated(h: &mut DMatrix<Complex64>, last: usize, smallest: f64) -> usize {
    let mut first = last;
    while first > 0 {
        let neighbours = h[(first, first)].norm() + h[(first - 1, first - 1)].norm();
        if h[(first, first - 1)].norm() <= (f64::EPSILON * neighbours).max(0.1 * smallest) {
            h[(first, first - 1)] = Complex64::default();
            break;
        }
        first -= 1;
    }
    first
}

/// The eigenvalue of the last 2x2 block that is nearer to its last entry.
fn wilkinson(h: &DMatrix<Complex64>, last: usize) -> Complex64 {
    let [a, b] = [h[(last - 1, last - 1)], h[(last - 1, last)]];
    let [c, d] = [h[(last, last - 1)], h[(last, last)]];
    // lambda = d + r -+ sqrt(r^2 + bc)    r = (a - d)/2
    let r = 0.5 * (a - d);
    let root = (r * r + b * c).sqrt();
    let [near, far] = [d + r - root, d + r + root];
    if (near - d).norm() < (far - d).norm() { near } else { far }
}

/// `H - s I = Q R`, `H <- R Q + s I` on the rows and columns `first..=last`. A column takes all rotations of those before it in one pass.
fn step(h: &mut DMatrix<Complex64>, q: &mut DMatrix<Complex64>, first: usize, last: usize, shift: Complex64) {
    let n = h.nrows();
    (first..=last).for_each(|i| h[(i, i)] -= shift);
    let mut rotations: Vec<(Complex64, Complex64)> = Vec::with_capacity(last - first);
    for (j, mut column) in h.column_iter_mut().enumerate().skip(first) {
        // G = [c* s*; -s c]
        let turned =
            |(c, s): (Complex64, Complex64), x: Complex64, y: Complex64| [c.conj() * x + s.conj() * y, c * y - s * x];
        let mut x = column[first];
        for (k, &rotation) in (first..).zip(&rotations) {
            [column[k], x] = turned(rotation, x, column[k + 1]);
        }
        column[first + rotations.len()] = x;
        if j < last {
            let y = column[j + 1];
            let length = (x.norm_sqr() + y.norm_sqr()).sqrt();
            // It turns (x, y) into (length, 0).
            let (c, s) =
                if length > 0.0 { (x / length, y / length) } else { (Complex64::from(1.0), Complex64::default()) };
            [column[j], column[j + 1]] = turned((c, s), x, y);
            rotations.push((c, s));
        }
    }
    for (k, (c, s)) in (first..last).zip(rotations) {
        turn_columns(h, k, k + 2, c, s);
        turn_columns(q, k, n, c, s);
    }
    (first..=last).for_each(|i| h[(i, i)] += shift);
}

/// Columns k and k + 1 times `G^H`, in the first rows.
fn turn_columns(a: &mut DMatrix<Complex64>, k: usize, n_rows: usize, c: Complex64, s: Complex64) {
    let (mut left, mut right) = a.columns_range_pair_mut(k, k + 1);
    for (x, y) in left.iter_mut().zip(right.iter_mut()).take(n_rows) {
        (*x, *y) = (*x * c + *y * s, *y * c.conj() - *x * s.conj());
    }
}

/// Eigenvectors of an upper triangular matrix; equal eigenvalues are held apart by `smallest`.
fn back_substituted(u: &DMatrix<Complex64>, smallest: f64) -> DMatrix<Complex64> {
    let n = u.nrows();
    let mut v = DMatrix::identity(n, n);
    for k in 0..n {
        for i in (0..k).rev() {
            // (u_ii - u_kk) v_i = -sum_(i < j <= k) u_ij v_j
            let sum: Complex64 = (i + 1..=k).map(|j| u[(i, j)] * v[(j, k)]).sum();
            let gap = u[(i, i)] - u[(k, k)];
            v[(i, k)] = -sum / if gap.norm() < smallest { Complex64::from(smallest) } else { gap };
        }
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
            assert!(eigen(a.transpose()).is_some(), "{k}");
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
