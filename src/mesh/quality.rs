//! How well shaped the elements are.

#![allow(non_snake_case)] // symbols of the formulas

use super::jacobian;
use nalgebra::Matrix3;

/// The scaled Jacobian: over the corners, the least of `sqrt 2 det J / (|t_1| |t_2| |t_3|)`.
///
/// t_1, t_2, t_3 are the tangents of the (curved) edges at the corner, whose determinant is `det J` too. 1 for a regular tetrahedron,
/// towards 0 as it flattens, negative where it is inverted.
pub fn scaled_jacobian(x: &[[f64; 3]; 10]) -> f64 {
    let corners = jacobian::at_corners(x);
    let scaled = corners.iter().enumerate().map(|(i, J)| {
        let lengths: f64 = (0..4).filter(|&k| k != i).map(|k| tangent_length(J, i, k)).product();
        2.0_f64.sqrt() * J.determinant() / lengths
    });
    scaled.fold(f64::INFINITY, f64::min)
}

/// `|dx/dL_k - dx/dL_i|`, from the Jacobian's columns `dx/dL_k - dx/dL_0`.
fn tangent_length(J: &Matrix3<f64>, i: usize, k: usize) -> f64 {
    match (i, k) {
        (0, k) => J.column(k - 1).norm(),
        (i, 0) => J.column(i - 1).norm(),
        (i, k) => (J.column(k - 1) - J.column(i - 1)).norm(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::jacobian::straight;
    use super::*;

    const REGULAR: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]];

    #[test]
    fn a_regular_tetrahedron_scores_one_and_a_corner_of_a_cube_less() {
        assert!((scaled_jacobian(&straight(REGULAR)) - 1.0).abs() < 1e-14);
        let cube = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        // At the corners of the slanted face: sqrt 2 / (1 * sqrt 2 * sqrt 2).
        assert!((scaled_jacobian(&straight(cube)) - 0.5_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn flat_and_inverted_elements_score_nothing_and_less() {
        let mut corners = REGULAR;
        corners.swap(0, 1);
        assert!((scaled_jacobian(&straight(corners)) + 1.0).abs() < 1e-14);
        let flat = REGULAR.map(|[x, y, z]| [x, y, 1e-6 * z]);
        assert!(scaled_jacobian(&straight(flat)) < 1e-5);
    }
}
