//! How well shaped the elements are.

use crate::algebra::{cofactor_columns, norm, sub};
use crate::element::tet10::corner_jacobians;

/// The scaled Jacobian: over the corners, the least of `sqrt 2 detJ / (|t_1| |t_2| |t_3|)`.
///
/// t_1, t_2, t_3 are the tangents of the (curved) edges at the corner, whose determinant is `detJ` too. 1 for a regular
/// tetrahedron, towards 0 as it flattens, negative where it is inverted.
pub fn scaled_jacobian(x: &[[f64; 3]; 10]) -> f64 {
    let scaled = corner_jacobians(x).into_iter().enumerate().map(|(corner, jacobian)| {
        let lengths: f64 = edge_tangents(corner, &jacobian).map(norm).iter().product();
        2.0_f64.sqrt() * cofactor_columns(&jacobian).1 / lengths
    });
    scaled.fold(f64::INFINITY, f64::min)
}

/// The tangents `dx/dl_k - dx/dl_i` of the three edges at corner `i`, from the Jacobian's columns `dx/dl_k - dx/dl_0`.
fn edge_tangents(i: usize, jacobian: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let columns: [[f64; 3]; 3] = std::array::from_fn(|k| jacobian.map(|row| row[k]));
    let Some(own) = i.checked_sub(1) else { return columns };
    std::array::from_fn(|k| if k == own { columns[k] } else { sub(columns[k], columns[own]) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::tet10::straight;

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
