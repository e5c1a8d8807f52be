//! Which mode of one result is which mode of another.

use num_complex::Complex64;
use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;

use super::mac::{MacTable, distance};

/// Eigenvalues of one mode are closer than this, relative to the larger.
const WINDOW: f64 = 0.2;
/// Two modes with less than this in common are not one.
const LEAST: f64 = 0.4;
/// Scores are counted in whole parts of one, as the assignment algorithm needs them.
const PARTS: f64 = 1e12;

/// Pairs of modes of A and B, by A's order: of all assignments one to one that with the largest sum of scores
///
/// ```text
/// s_ij = mac_ij (1 - (d_ij / d_most)^2)        d_ij = |lambda_i - lambda_j| / max(|lambda_i|, |lambda_j|)
/// ```
///
/// of pairs that are close enough in eigenvalue (`d_most`) and have enough in common. So shape decides, and the
/// eigenvalue where shape does not, as in a doublet. Source: J. Munkres, *Algorithms for the assignment and
/// transportation problems*, J. SIAM 5 (1957).
pub fn pairs(mac_table: &MacTable, [a, b]: [&[Complex64]; 2]) -> Vec<[usize; 2]> {
    let score = |i: usize, j: usize| {
        let (mac, d) = (mac_table.mac(i, j), distance(a[i], b[j]));
        if mac < LEAST || d > WINDOW { 0.0 } else { mac * (1.0 - (d / WINDOW).powi(2)) }
    };
    let n = a.len().max(b.len());
    let scores =
        Matrix::from_fn(n, n, |(i, j)| if i < a.len() && j < b.len() { (PARTS * score(i, j)) as i64 } else { 0 });
    let (_, columns) = kuhn_munkres(&scores);
    let chosen = columns.into_iter().enumerate().filter(|&place| scores[place] > 0);
    chosen.map(|(i, j)| [i, j]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn c(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    /// Real vectors in the plane by their angles, in degrees.
    fn shapes(angles: &[f64]) -> Vec<Vec<Complex64>> {
        angles.iter().map(|angle| angle.to_radians()).map(|t| vec![c(t.cos(), 0.0), c(t.sin(), 0.0)]).collect()
    }

    fn found(a: &[Complex64], b: &[Complex64], shapes: [&[Vec<Complex64>]; 2]) -> Vec<[usize; 2]> {
        pairs(&MacTable::new([a, b], shapes), [a, b])
    }

    #[test]
    fn shapes_tell_modes_that_have_changed_places() {
        let (a, b) = ([c(0.0, 5.0), c(0.0, 5.1)], [c(0.0, 5.02), c(0.0, 5.07)]);
        assert_eq!(found(&a, &b, [&shapes(&[0.0, 90.0]), &shapes(&[88.0, -3.0])]), [[0, 1], [1, 0]]);
    }

    #[test]
    fn the_sum_decides_and_not_the_first_best() {
        // Mode 0 is a little more like 0 than like 1, but mode 1 is like nothing but 0.
        let (a, b) = ([c(0.0, 5.0), c(0.0, 5.1)], [c(0.0, 5.05), c(0.0, 5.15)]);
        assert_eq!(found(&a, &b, [&shapes(&[44.0, 0.0]), &shapes(&[0.0, 90.0])]), [[0, 1], [1, 0]]);
    }

    #[test]
    fn eigenvalues_decide_within_a_doublet() {
        let (a, b) = ([c(0.0, 5.0), c(0.0, 5.001)], [c(0.0, 5.0101), c(0.0, 5.0091)]);
        assert_eq!(found(&a, &b, [&shapes(&[0.0, 90.0]), &shapes(&[45.0, 135.0])]), [[0, 1], [1, 0]]);
    }

    #[test]
    fn what_is_far_or_unlike_stays_alone() {
        let lambdas = [c(0.0, 5.0), c(0.0, 8.0)];
        assert_eq!(found(&lambdas, &lambdas[..1], [&shapes(&[0.0, 90.0]), &shapes(&[0.0])]), [[0, 0]]);
        assert!(found(&lambdas[..1], &lambdas[1..], [&shapes(&[0.0]), &shapes(&[0.0])]).is_empty());
        assert!(found(&lambdas[..1], &lambdas[..1], [&shapes(&[0.0]), &shapes(&[80.0])]).is_empty());
        assert!(found(&[], &lambdas, [&[], &shapes(&[0.0, 1.0])]).is_empty());
    }
}
