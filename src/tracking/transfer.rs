//! How the modes of one value are made of those of another.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::node::Node;
use super::{Family, Options};
use crate::Result;

/// The modes that two values have in common, and the change of basis between them.
pub struct Transfer {
    /// Modes of the first value that live on, ascending.
    pub from: Vec<usize>,
    /// Modes of the second value that have lived before, ascending, as many.
    pub to: Vec<usize>,
    /// `T` with `Z_to = Z_from T`.
    pub matrix: DMatrix<Complex64>,
    /// Whether no mode of the band is lost or comes from nowhere.
    pub complete: bool,
}

/// A mode may lose this much of itself to modes that were not solved for.
const LOSS: f64 = 0.1;

impl Transfer {
    /// Compares two values. With `T_ab` and `T_ba` the coordinates of each one's modes in the basis of the other,
    /// `(T_ab T_ba)_ii` is how much of mode i is left in the other's modes: 1, or 0 where it has left the band. The
    /// trace is the number of modes in common.
    pub fn new<F: Family>(
        a: &Node<F::Modes>,
        b: &Node<F::Modes>,
        family: &mut F,
        options: &Options,
    ) -> Result<Transfer> {
        let forward = a.coordinates_of(b, family)?;
        let backward = b.coordinates_of(a, family)?;
        let [left, found] = [&forward * &backward, &backward * &forward].map(|m| m.diagonal().map(|z| z.re));
        let n = (left.sum().round().max(0.0) as usize).min(left.len()).min(found.len());
        let (from, to) = (largest(left.as_slice(), n), largest(found.as_slice(), n));
        let whole = |kept: &[usize], shares: &[f64], lambdas: &[Complex64]| {
            let own = (0..shares.len()).filter(|&i| options.in_band(lambdas[i]));
            own.into_iter().all(|i| kept.binary_search(&i).is_ok() && (shares[i] - 1.0).abs() <= LOSS)
        };
        let complete = whole(&from, left.as_slice(), &a.lambdas) && whole(&to, found.as_slice(), &b.lambdas);
        let matrix = forward.select_rows(&from).select_columns(&to);
        Ok(Transfer { from, to, matrix, complete })
    }
}

/// Places of the n largest values, ascending.
fn largest(values: &[f64], n: usize) -> Vec<usize> {
    let mut places: Vec<usize> = (0..values.len()).collect();
    places.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    places.truncate(n);
    places.sort_unstable();
    places
}
