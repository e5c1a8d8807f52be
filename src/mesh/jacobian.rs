//! The Jacobian of a 10-node tetrahedron: is it positive everywhere that matters?
//!
//! With barycentric coordinates L_0..L_3 and the quadratic shape functions, `x = sum L_m (2 L_m - 1) x_m + sum 4 L_m L_k x_mk`.
//! Its gradient is linear, so the four corners hold all of it: `J(L) = sum_i L_i J(corner i)`.

#![allow(non_snake_case)] // symbols of the formulas

use nalgebra::{Matrix3, Vector3};

/// Index of the midside node between two corners; the diagonal is not used.
const MIDSIDE: [[usize; 4]; 4] = [[0, 4, 6, 7], [4, 0, 5, 8], [6, 5, 0, 9], [7, 8, 9, 0]];

/// Determinants are looked at here: corners, midsides, and the points of the 4-point rule (degree 2).
pub const N_POINTS: usize = 14;

/// Jacobians at the four corners; column k is `dx/dL_k - dx/dL_0`, k = 1..3.
///
/// At corner i: `dx/dL_i = 3 x_i`, and `dx/dL_m = 4 x_im - x_m` for the others.
pub fn at_corners(x: &[[f64; 3]; 10]) -> [Matrix3<f64>; 4] {
    std::array::from_fn(|i| {
        let gradient = |m: usize| {
            let x_m = Vector3::from(x[m]);
            if m == i { 3.0 * x_m } else { 4.0 * Vector3::from(x[MIDSIDE[i][m]]) - x_m }
        };
        let g_0 = gradient(0);
        Matrix3::from_columns(&[gradient(1) - g_0, gradient(2) - g_0, gradient(3) - g_0])
    })
}

/// `det J` (six times the local volume, m3) at 4 corners, 6 midsides and 4 quadrature points.
pub fn determinants(x: &[[f64; 3]; 10]) -> [f64; N_POINTS] {
    let J = at_corners(x);
    let sum = J[0] + J[1] + J[2] + J[3];
    // The quadrature points: L = (5 + 3 sqrt 5)/20 towards one corner, (5 - sqrt 5)/20 towards the others.
    let b = (5.0 - 5.0_f64.sqrt()) / 20.0;
    let a = 1.0 - 3.0 * b;
    let midside = |i: usize, k: usize| ((J[i] + J[k]) * 0.5).determinant();
    let inside = |i: usize| (sum * b + J[i] * (a - b)).determinant();
    let corner = |i: usize| J[i].determinant();
    [
        corner(0),
        corner(1),
        corner(2),
        corner(3),
        midside(0, 1),
        midside(1, 2),
        midside(2, 0),
        midside(0, 3),
        midside(1, 3),
        midside(2, 3),
        inside(0),
        inside(1),
        inside(2),
        inside(3),
    ]
}

/// Whether the element is turned inside out somewhere, or flat: `det J <= 0` at one of the points.
pub fn is_inverted(x: &[[f64; 3]; 10]) -> bool {
    // Written so that a determinant that is not a number counts as inverted.
    !determinants(x).iter().all(|&det| det > 0.0)
}

/// A tetrahedron with straight edges, midsides in the middle.
#[cfg(test)]
pub fn straight(corners: [[f64; 3]; 4]) -> [[f64; 3]; 10] {
    let mut x = [[0.0; 3]; 10];
    for i in 0..4 {
        for k in 0..4 {
            let at = if i == k { i } else { MIDSIDE[i][k] };
            x[at] = std::array::from_fn(|axis| 0.5 * (corners[i][axis] + corners[k][axis]));
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn a_straight_tetrahedron_has_six_times_its_volume_everywhere() {
        let mut corners = UNIT.map(|x| [2.0 * x[0] + 0.5, 3.0 * x[1] - x[0], x[2] + 7.0]);
        for det in determinants(&straight(corners)) {
            assert!((det - 6.0).abs() < 1e-12);
        }
        assert!(!is_inverted(&straight(corners)));
        corners.swap(0, 1);
        assert!(is_inverted(&straight(corners)));
    }

    #[test]
    fn corner_jacobians_are_the_derivative_of_the_quadratic_map() {
        let mut x = straight(UNIT);
        for (i, node) in x.iter_mut().enumerate() {
            node[i % 3] += 0.01 * (i as f64 + 1.0);
        }
        let map = |L: [f64; 4]| {
            let mut sum = Vector3::zeros();
            for m in 0..4 {
                sum += L[m] * (2.0 * L[m] - 1.0) * Vector3::from(x[m]);
                for k in 0..m {
                    sum += 4.0 * L[m] * L[k] * Vector3::from(x[MIDSIDE[m][k]]);
                }
            }
            sum
        };
        let h = 1e-5;
        for (i, J) in at_corners(&x).iter().enumerate() {
            for k in 1..4 {
                let moved = |by: f64| {
                    let mut L = [0.0; 4];
                    L[i] = 1.0;
                    L[k] += by;
                    L[0] -= by;
                    map(L)
                };
                let difference = (moved(h) - moved(-h)) / (2.0 * h);
                assert!((difference - J.column(k - 1)).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn a_midside_pulled_through_the_element_inverts_it() {
        let mut x = straight(UNIT);
        x[4] = [0.2, 0.0, 0.0];
        assert!(is_inverted(&x));
        x[4] = [0.4, 0.0, 0.0];
        assert!(!is_inverted(&x));
        x[4][1] = f64::NAN;
        assert!(is_inverted(&x), "a coordinate that is not a number is not taken for a good element");
    }
}
