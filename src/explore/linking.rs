//! Which mode of a point is which mode of the nominal point.

use nalgebra::DMatrix;
use num_complex::Complex64;
use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;

use super::result::Link;

/// Two modes with a smaller share are not one.
const LEAST_SHARE: f64 = 0.3;
/// A smaller share is doubtful.
const CLEAR_SHARE: f64 = 0.6;
/// Two assignments of two modes are equally good where their sums of shares differ by less than this part: the vectors
/// of a coalescence differ in the sign of their imaginary parts alone, so that both have the same shares, up to the
/// error of left vectors.
const TIE: f64 = 0.02;
/// Growth rates are equal where they differ by less than this part of the frequency.
const EQUAL_GROWTH: f64 = 1e-6;
/// Shares are counted in whole parts of one, as the assignment algorithm needs them.
const PARTS: f64 = 1e9;

/// Products of the modes of two points, and of each with itself.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeProducts {
    /// `y_i^H M x_j`: left vectors of the nominal point, right vectors of the other.
    pub nominal_left: DMatrix<Complex64>,
    /// `y_j^H M x_i`: left vectors of the other point (rows), right vectors of the nominal one (columns).
    pub nominal_right: DMatrix<Complex64>,
    /// `y_i^H M x_i` of the nominal point.
    pub nominal_own: Vec<Complex64>,
    /// `y_j^H M x_j` of the other point.
    pub own: Vec<Complex64>,
}

impl ModeProducts {
    /// Shares of nominal modes (rows) in modes of the point (columns), the modal assurance criterion of modes with
    /// different left and right vectors:
    ///
    /// ```text
    /// s_ij = |(y_i^H M x_j) (y_j^H M x_i)| / |(y_i^H M x_i) (y_j^H M x_j)|
    /// ```
    ///
    /// It does not depend on the scales of the vectors, and is 1 for a mode that has not changed, 0 for another one.
    pub fn shares(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.nominal_own.len(), self.own.len(), |i, j| {
            let across = self.nominal_left[(i, j)] * self.nominal_right[(j, i)];
            let own = (self.nominal_own[i] * self.own[j]).norm();
            if own > 0.0 { across.norm() / own } else { 0.0 }
        })
    }
}

/// The nominal mode of each mode of a point, whose eigenvalues are `lambdas`: of all assignments one to one that with
/// the largest sum of shares. Where two modes can be exchanged, the one with the larger growth rate has the larger
/// number, and at equal growth rates the one with the higher frequency.
///
/// ```
/// use nalgebra::dmatrix;
/// use num_complex::Complex64;
///
/// let lambdas = [1000.0, 2000.0].map(|omega| Complex64::new(-1.0, omega));
/// let links = squeal::explore::link(&dmatrix![0.1, 0.9; 0.5, 0.1], &lambdas);
/// let [first, second] = links[..] else { panic!("two modes") };
/// assert!(first.is_some_and(|link| link.nominal == 2 && link.doubtful));
/// assert!(second.is_some_and(|link| link.nominal == 1 && !link.doubtful));
/// ```
///
/// # Panics
/// Where there is not one eigenvalue for each column of the shares.
pub fn link(shares: &DMatrix<f64>, lambdas: &[Complex64]) -> Vec<Option<Link>> {
    assert_eq!(shares.ncols(), lambdas.len(), "an eigenvalue for each mode");
    let mut links = vec![None; shares.ncols()];
    let n = shares.nrows().max(shares.ncols());
    if n == 0 {
        return links;
    }
    // Near a coalescence a share may be large without bound.
    let share =
        |i: usize, j: usize| shares.get((i, j)).filter(|share| **share >= LEAST_SHARE).map_or(0.0, |s| s.min(1.0));
    let (_, mut columns) = kuhn_munkres(&Matrix::from_fn(n, n, |(i, j)| (PARTS * share(i, j)) as i64));
    for (i, k) in (0..n).flat_map(|k| (0..k).map(move |i| (i, k))) {
        let (j, l) = (columns[i], columns[k]);
        let is_linked = [(i, j), (k, l), (i, l), (k, j)].iter().all(|&(i, j)| share(i, j) > 0.0);
        if is_linked && should_exchange(shares, [(i, j), (k, l)], lambdas) {
            columns.swap(i, k);
        }
    }
    for (i, j) in columns.into_iter().enumerate().filter(|&(i, j)| share(i, j) > 0.0) {
        let found = shares[(i, j)];
        // Beyond 1 the vectors are those of a coalescence.
        let doubtful = !(CLEAR_SHARE..=1.0 / CLEAR_SHARE).contains(&found);
        links[j] = Some(Link { nominal: i + 1, share: found, doubtful });
    }
    links
}

/// Whether two links are better the other way round, by the shares as they are.
fn should_exchange(shares: &DMatrix<f64>, [(i, j), (k, l)]: [(usize, usize); 2], lambdas: &[Complex64]) -> bool {
    let (own, other) = (shares[(i, j)] + shares[(k, l)], shares[(i, l)] + shares[(k, j)]);
    let is_tie = (own - other).abs() < TIE * own;
    if is_tie { is_later(lambdas[j], lambdas[l]) } else { other > own }
}

/// Whether the first of two modes has the larger number where both are the same nominal modes.
fn is_later(a: Complex64, b: Complex64) -> bool {
    if (a.re - b.re).abs() > EQUAL_GROWTH * a.norm() { a.re > b.re } else { a.im > b.im }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn c(re: f64) -> Complex64 {
        Complex64::new(re, 0.0)
    }

    #[test]
    fn shares_do_not_depend_on_scales() {
        let products = |s: f64, t: f64| ModeProducts {
            nominal_left: dmatrix![c(0.9 * s), c(0.1 * s)],
            nominal_right: dmatrix![c(0.8 * t); c(0.2 * t)],
            nominal_own: vec![c(1.0)],
            own: vec![c(s * t), c(s * t)],
        };
        let shares = products(1.0, 1.0).shares();
        assert!((shares[(0, 0)] - 0.72).abs() < 1e-15 && (shares[(0, 1)] - 0.02).abs() < 1e-15);
        assert!((products(-7.0, 3.0).shares() - shares).norm() < 1e-14);
    }

    /// Damped modes of rising frequency.
    fn link(shares: &DMatrix<f64>) -> Vec<Option<Link>> {
        let lambda = |j: usize| Complex64::new(-1.0, 1000.0 + j as f64);
        super::link(shares, &(0..shares.ncols()).map(lambda).collect::<Vec<_>>())
    }

    #[test]
    fn modes_of_a_coalescence_have_the_order_of_their_growth_rates() {
        let of = |shares: DMatrix<f64>, lambdas: [[f64; 2]; 2]| {
            let links = super::link(&shares, &lambdas.map(|[re, im]| Complex64::new(re, im)));
            links.into_iter().map(|link| link.unwrap().nominal).collect::<Vec<_>>()
        };
        // What is equal but for rounding, in either order of the modes and whichever sum is larger.
        let either = [dmatrix![0.51, 0.5; 0.5, 0.5], dmatrix![0.5, 0.51; 0.5, 0.5], dmatrix![1.7, 1.65; 1.6, 1.6]];
        for shares in either {
            assert_eq!(of(shares.clone(), [[-300.0, 1000.0], [300.0, 1000.0]]), [1, 2]);
            assert_eq!(of(shares.clone(), [[300.0, 1000.0], [-300.0, 1000.0]]), [2, 1]);
            assert_eq!(of(shares, [[-1.0 + 1e-5, 1001.0], [-1.0, 1002.0]]), [1, 2], "equal growth rates");
        }
        for shares in [dmatrix![0.6, 0.5; 0.5, 0.6], dmatrix![2.0, 1.0; 1.0, 2.0]] {
            assert_eq!(of(shares.clone(), [[300.0, 1000.0], [-300.0, 1000.0]]), [1, 2], "no tie");
            assert_eq!(of(shares, [[-300.0, 1000.0], [300.0, 1000.0]]), [1, 2], "no tie");
        }
    }

    #[test]
    fn links_are_one_to_one_and_small_shares_are_none() {
        let links = link(&dmatrix![0.95, 0.8, 0.0; 0.7, 0.0, 0.2]);
        let of = |link: Option<Link>| link.map(|link| (link.nominal, link.doubtful));
        // 0.7 + 0.8 is more than 0.95 + 0.2.
        assert_eq!(links.into_iter().map(of).collect::<Vec<_>>(), [Some((2, false)), Some((1, false)), None]);
        let links = link(&dmatrix![0.45; 0.1]);
        assert!(links[0].unwrap().doubtful);
        assert!(link(&dmatrix![9.0])[0].unwrap().doubtful, "a coalescence");
        assert_eq!(link(&DMatrix::zeros(0, 2)), [None, None]);
        assert!(link(&DMatrix::zeros(2, 0)).is_empty());
    }
}
