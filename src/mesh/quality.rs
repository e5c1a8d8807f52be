//! How well shaped the elements are.

use crate::algebra::{cross, dot, norm};
use crate::element::Shape;

/// The scaled Jacobian: over the corners, the least of `V / (|t_1| |t_2| |t_3|)`, relative to the regular element.
///
/// t_1, t_2, t_3 are the tangents of the (curved) edges at the corner, `V` their determinant. 1 for a regular
/// tetrahedron, a wedge of equilateral triangles or a cube, towards 0 as the element flattens, negative where it is
/// inverted.
///
/// # Panics
/// Where there is not one position a node.
pub fn scaled_jacobian(shape: Shape, x: &[[f64; 3]]) -> f64 {
    assert_eq!(x.len(), shape.n_nodes());
    (0..shape.n_corners()).map(|corner| at_corner(shape, x, corner)).fold(f64::INFINITY, f64::min)
}

/// `V / (|t_1| |t_2| |t_3|)` of the tangents at a corner, relative to the regular element's.
fn at_corner(shape: Shape, x: &[[f64; 3]], corner: usize) -> f64 {
    let reference = shape.interpolation();
    let (nodes, gradients) = (reference.nodes(), reference.gradients(reference.nodes()[corner]));
    let (mut tangents, mut directions) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    for (k, other) in shape.neighbours(corner).into_iter().enumerate() {
        // t = sum_a x_a (grad N_a . d), d from the corner to the other end of the edge
        directions[k] = [0, 1, 2].map(|i| nodes[other][i] - nodes[corner][i]);
        for (x, gradient) in x.iter().zip(gradients) {
            let slope = dot(gradient, directions[k]);
            (0..3).for_each(|i| tangents[k][i] += x[i] * slope);
        }
    }
    let volume = |t: &[[f64; 3]; 3]| dot(cross(t[0], t[1]), t[2]);
    let lengths: f64 = tangents.map(norm).iter().product();
    volume(&tangents) * volume(&directions).signum() / (lengths * regular(shape))
}

/// `V / (|t_1| |t_2| |t_3|)` at a corner of a regular element.
fn regular(shape: Shape) -> f64 {
    match shape.n_corners() {
        4 => 0.5_f64.sqrt(),
        6 => 0.75_f64.sqrt(),
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Shape::{Hexahedron8, Hexahedron20, Tetrahedron4, Tetrahedron10, Wedge6};

    const REGULAR: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]];

    #[test]
    fn regular_elements_score_one_and_a_corner_of_a_cube_less() {
        assert!((scaled_jacobian(Tetrahedron10, &Tetrahedron10.straight(&REGULAR)) - 1.0).abs() < 1e-14);
        let cube = Tetrahedron4.interpolation().nodes();
        // At the corners of the slanted face: sqrt 2 / (1 * sqrt 2 * sqrt 2).
        assert!((scaled_jacobian(Tetrahedron4, cube) - 0.5_f64.sqrt()).abs() < 1e-14);
        let prism = Wedge6.interpolation().nodes().iter().map(|&[x, y, z]| [x + 0.5 * y, 0.75_f64.sqrt() * y, z]);
        assert!((scaled_jacobian(Wedge6, &prism.collect::<Vec<_>>()) - 1.0).abs() < 1e-14);
        assert!((scaled_jacobian(Hexahedron20, Hexahedron20.interpolation().nodes()) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn flat_and_inverted_elements_score_nothing_and_less() {
        let mut corners = REGULAR;
        corners.swap(0, 1);
        assert!((scaled_jacobian(Tetrahedron10, &Tetrahedron10.straight(&corners)) + 1.0).abs() < 1e-14);
        let flat = REGULAR.map(|[x, y, z]| [x, y, 1e-6 * z]);
        assert!(scaled_jacobian(Tetrahedron10, &Tetrahedron10.straight(&flat)) < 1e-5);
        let mut cube = Hexahedron8.interpolation().nodes().to_vec();
        cube[6] = [-0.9, -0.9, -0.9];
        assert!(scaled_jacobian(Hexahedron8, &cube) < 0.0);
    }
}
