//! From the modes of one small matrix to those of a neighbouring one.

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::native::lapack::Eigen;

/// Eigenvalues and vectors, in the order of the branches.
#[derive(Clone)]
pub struct State {
    pub values: Vec<Complex64>,
    pub vectors: DMatrix<Complex64>,
}

/// The modes after a step in the order of those before it.
pub struct Matched {
    pub state: State,
    /// Whether every mode was recognised.
    pub clear: bool,
    /// Whether two modes have exchanged the order of their frequencies.
    pub swapped: bool,
}

/// A mode is recognised where its own share in its successor is at least this.
const CLEAR: f64 = 0.6;
/// Modes with more than this share in each other belong together.
const LINKED: f64 = 0.1;
/// Eigenvalues closer than this, relative, are one: what separates them is rounding.
const DEGENERATE: f64 = 1e-7;

/// Finds each mode of `before` among the eigenpairs of `after`.
///
/// With `V' = V T`, `S_ij = |T_ij (T^-1)_ji|` is the share of mode i in mode j, whatever the vectors' scales; it is 1
/// for one mode that has not changed. Modes that share make a group. A group of one is recognised by its share, a group
/// with one common eigenvalue on either side as a subspace: then the vectors of that eigenvalue are turned to continue
/// those before. Any other group is not clear; its modes are paired in the order of `Im + Re`: where two undamped modes
/// meet, the lower goes on as the one that decays.
pub fn matched(before: &State, after: Eigen) -> Matched {
    let n = before.values.len();
    let (forward, backward) = match transfers(&before.vectors, &after.vectors) {
        Some(pair) => pair,
        None => return by_order(before, after),
    };
    let share = DMatrix::from_fn(n, n, |i, j| (forward[(i, j)] * backward[(j, i)]).norm());
    let (mut order, mut vectors, mut clear) = (vec![0; n], after.vectors.clone(), true);
    for (rows, columns) in groups(&share) {
        if rows.len() != columns.len() {
            return by_order(before, after);
        }
        let pairs = paired(&rows, &columns, &before.values, &after.values);
        pairs.iter().for_each(|&(i, j)| order[i] = j);
        if let [(i, j)] = pairs[..] {
            clear &= share[(i, j)] >= CLEAR;
        } else if is_degenerate(&columns, &after.values) {
            align(&pairs, &backward, &after.vectors, &mut vectors);
        } else {
            clear &= is_degenerate(&rows, &before.values);
        }
    }
    finish(before, &after.values, vectors, &order, clear)
}

/// `T = V^-1 V'` and its inverse.
fn transfers(v: &DMatrix<Complex64>, w: &DMatrix<Complex64>) -> Option<(DMatrix<Complex64>, DMatrix<Complex64>)> {
    let forward = v.clone().lu().solve(w)?;
    let backward = w.clone().lu().solve(v)?;
    forward.iter().chain(&backward).all(|z| z.is_finite()).then_some((forward, backward))
}

/// Rows and columns that hang together by shares.
fn groups(share: &DMatrix<f64>) -> Vec<(Vec<usize>, Vec<usize>)> {
    let n = share.nrows();
    // Names of the groups: of the rows, then of the columns.
    let mut names: Vec<usize> = (0..2 * n).collect();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&(i, j)| share[(i, j)] > LINKED) {
        let (kept, lost) = (names[i], names[n + j]);
        names.iter_mut().filter(|name| **name == lost).for_each(|name| *name = kept);
    }
    let members = |name: usize, places: std::ops::Range<usize>| {
        places.clone().filter(|&k| names[k] == name).map(|k| k - places.start).collect::<Vec<_>>()
    };
    let mut distinct = names.clone();
    distinct.sort_unstable();
    distinct.dedup();
    distinct.into_iter().map(|name| (members(name, 0..n), members(name, n..2 * n))).collect()
}

fn key(z: Complex64) -> f64 {
    z.im + z.re
}

/// Pairs rows and columns, both in the order of `Im + Re`.
fn paired(rows: &[usize], columns: &[usize], before: &[Complex64], after: &[Complex64]) -> Vec<(usize, usize)> {
    let sorted = |list: &[usize], values: &[Complex64]| {
        let mut list = list.to_vec();
        list.sort_by(|&a, &b| key(values[a]).total_cmp(&key(values[b])));
        list
    };
    sorted(rows, before).into_iter().zip(sorted(columns, after)).collect()
}

pub fn is_close(a: Complex64, b: Complex64) -> bool {
    (a - b).norm() <= DEGENERATE * a.norm().max(b.norm())
}

fn is_degenerate(group: &[usize], values: &[Complex64]) -> bool {
    group.iter().all(|&i| is_close(values[i], values[group[0]]))
}

/// `V'_J <- V'_J (T^-1)_JI`: of the vectors of one eigenvalue those that continue the ones before.
fn align(
    pairs: &[(usize, usize)],
    backward: &DMatrix<Complex64>,
    from: &DMatrix<Complex64>,
    to: &mut DMatrix<Complex64>,
) {
    for &(i, j) in pairs {
        let sum = pairs.iter().map(|&(_, k)| from.column(k) * backward[(k, i)]);
        to.set_column(j, &sum.reduce(|a, b| a + b).expect("a pair has a column"));
    }
}

/// All modes by their order alone, where nothing better is known.
fn by_order(before: &State, after: Eigen) -> Matched {
    let all: Vec<usize> = (0..before.values.len()).collect();
    let mut order = vec![0; all.len()];
    paired(&all, &all, &before.values, &after.values).into_iter().for_each(|(i, j)| order[i] = j);
    finish(before, &after.values, after.vectors, &order, false)
}

fn finish(before: &State, values: &[Complex64], vectors: DMatrix<Complex64>, order: &[usize], clear: bool) -> Matched {
    let values: Vec<Complex64> = order.iter().map(|&j| values[j]).collect();
    let swapped = is_swapped(&before.values, &values);
    Matched { state: State { values, vectors: vectors.select_columns(order) }, clear, swapped }
}

/// Whether two frequencies, apart before and after, have changed their order.
fn is_swapped(before: &[Complex64], after: &[Complex64]) -> bool {
    let n = before.len();
    let pairs = (0..n).flat_map(|i| (0..i).map(move |k| (i, k)));
    pairs.filter(|&(i, k)| !is_close(before[i], before[k]) && !is_close(after[i], after[k])).any(|(i, k)| {
        let apart = |z: &[Complex64]| z[i].im - z[k].im;
        apart(before) * apart(after) < 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::lapack::eigen;

    fn c(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    fn state(values: &[Complex64]) -> State {
        State { values: values.to_vec(), vectors: DMatrix::identity(values.len(), values.len()) }
    }

    #[test]
    fn uncoupled_modes_keep_their_vectors_when_they_cross() {
        let after = eigen(DMatrix::from_diagonal(&nalgebra::dvector![c(0.0, 3.0), c(0.0, 2.0)])).unwrap();
        let found = matched(&state(&[c(0.0, 1.0), c(0.0, 4.0)]), after);
        assert!(found.clear && found.swapped);
        assert_eq!(found.state.values, [c(0.0, 3.0), c(0.0, 2.0)]);
    }

    #[test]
    fn a_doublet_is_turned_to_continue_what_was_before() {
        let mixed = DMatrix::from_row_slice(2, 2, &[0.6, 0.8, -0.8, 0.6]).map(Complex64::from);
        let after = Eigen { values: vec![c(0.0, 2.0); 2], vectors: mixed };
        let found = matched(&state(&[c(0.0, 1.0), c(0.0, 3.0)]), after);
        assert!(found.clear && !found.swapped);
        assert!((found.state.vectors - DMatrix::<Complex64>::identity(2, 2)).norm() < 1e-15);
    }

    #[test]
    fn a_coalescence_is_not_clear_and_goes_by_order() {
        let after =
            eigen(DMatrix::from_row_slice(2, 2, &[c(0.0, 2.0), c(1.0, 0.0), c(0.01, 0.0), c(0.0, 2.0)])).unwrap();
        let found = matched(&state(&[c(0.0, 2.1), c(0.0, 1.9)]), after);
        assert!(!found.clear);
        assert!(found.state.values[0].re > 0.09 && found.state.values[1].re < -0.09, "{:?}", found.state.values);
    }
}
