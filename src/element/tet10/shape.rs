//! Shape functions, their gradients and the Jacobian.

use crate::element::quadrature::{Point, TETRAHEDRON_4, TETRAHEDRON_14};

/// Reference coordinates of the ten nodes.
pub const NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];

/// The two corners of each edge; its midside is node `4 + index`.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// Shape functions `N_a` at reference coordinates `at`.
///
/// Corners `N_i = l_i (2 l_i - 1)`, midsides `N_ij = 4 l_i l_j`.
pub const fn shape(at: [f64; 3]) -> [f64; 10] {
    let [l1, l2, l3] = at;
    let l0 = 1.0 - l1 - l2 - l3;
    [
        l0 * (2.0 * l0 - 1.0),
        l1 * (2.0 * l1 - 1.0),
        l2 * (2.0 * l2 - 1.0),
        l3 * (2.0 * l3 - 1.0),
        4.0 * l0 * l1,
        4.0 * l1 * l2,
        4.0 * l2 * l0,
        4.0 * l0 * l3,
        4.0 * l1 * l3,
        4.0 * l2 * l3,
    ]
}

/// Gradients `dN_a / d(xi, eta, zeta)` in reference coordinates, one row a node.
///
/// With `grad l_0 = (-1, -1, -1)` and `grad l_k = e_k`: corners `(4 l_i - 1) grad l_i`,
/// midsides `4 (l_j grad l_i + l_i grad l_j)`.
pub const fn gradients(at: [f64; 3]) -> [[f64; 3]; 10] {
    let [l1, l2, l3] = at;
    let l0 = 1.0 - l1 - l2 - l3;
    let g0 = 1.0 - 4.0 * l0;
    [
        [g0, g0, g0],
        [4.0 * l1 - 1.0, 0.0, 0.0],
        [0.0, 4.0 * l2 - 1.0, 0.0],
        [0.0, 0.0, 4.0 * l3 - 1.0],
        [4.0 * (l0 - l1), -4.0 * l1, -4.0 * l1],
        [4.0 * l2, 4.0 * l1, 0.0],
        [-4.0 * l2, 4.0 * (l0 - l2), -4.0 * l2],
        [-4.0 * l3, -4.0 * l3, 4.0 * (l0 - l3)],
        [4.0 * l3, 0.0, 4.0 * l1],
        [0.0, 4.0 * l3, 4.0 * l2],
    ]
}

/// Shape functions at the points of a rule, one row a point; made at compile time.
pub(super) const fn shapes_at<const Q: usize>(rule: &[Point<3>; Q]) -> [[f64; 10]; Q] {
    let mut table = [[0.0; 10]; Q];
    let mut q = 0;
    while q < Q {
        table[q] = shape(rule[q].at);
        q += 1;
    }
    table
}

/// Reference gradients at the points of a rule; made at compile time.
pub(super) const fn gradients_at<const Q: usize>(rule: &[Point<3>; Q]) -> [[[f64; 3]; 10]; Q] {
    let mut table = [[[0.0; 3]; 10]; Q];
    let mut q = 0;
    while q < Q {
        table[q] = gradients(rule[q].at);
        q += 1;
    }
    table
}

pub(super) static GRADIENTS_4: [[[f64; 3]; 10]; 4] = gradients_at(&TETRAHEDRON_4);
pub(super) static GRADIENTS_14: [[[f64; 3]; 10]; 14] = gradients_at(&TETRAHEDRON_14);

/// The point of the element at reference coordinates `at`, m: `x = sum_a N_a x_a`.
pub fn position(x: &[[f64; 3]; 10], at: [f64; 3]) -> [f64; 3] {
    let n = shape(at);
    std::array::from_fn(|i| (0..10).map(|a| n[a] * x[a][i]).sum())
}

/// Jacobian `J_ik = d x_i / d xi_k = sum_a x_a,i dN_a/dxi_k` from the reference gradients at a point.
#[inline]
pub fn jacobian(x: &[[f64; 3]; 10], gradients: &[[f64; 3]; 10]) -> [[f64; 3]; 3] {
    let mut j = [[0.0; 3]; 3];
    for a in 0..10 {
        for i in 0..3 {
            for k in 0..3 {
                j[i][k] += x[a][i] * gradients[a][k];
            }
        }
    }
    j
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::samples::{Random, curved_tet};

    #[test]
    fn shape_function_a_is_one_at_node_a_and_zero_at_the_others() {
        for a in 0..10 {
            let n = shape(NODES[a]);
            for b in 0..10 {
                assert_eq!(n[b], if a == b { 1.0 } else { 0.0 }, "N_{b} at node {a}");
            }
        }
    }

    #[test]
    fn midside_nodes_lie_in_the_middle_of_their_edges() {
        for (midside, [i, j]) in EDGES.iter().enumerate() {
            for k in 0..3 {
                assert_eq!(NODES[4 + midside][k], 0.5 * (NODES[*i][k] + NODES[*j][k]));
            }
        }
    }

    #[test]
    fn shape_functions_add_up_to_one_and_their_gradients_to_zero() {
        let mut random = Random::seeded(1);
        for _ in 0..100 {
            let at = random.in_tetrahedron();
            assert!((shape(at).iter().sum::<f64>() - 1.0).abs() < 1e-14);
            for k in 0..3 {
                assert!(gradients(at).iter().map(|g| g[k]).sum::<f64>().abs() < 1e-14);
            }
        }
    }

    #[test]
    fn gradients_are_the_central_differences_of_the_shape_functions() {
        let mut random = Random::seeded(2);
        let h = 0.01; // central differences are exact for quadratics, so only round-off remains
        for _ in 0..100 {
            let at = random.in_tetrahedron();
            let exact = gradients(at);
            for k in 0..3 {
                let (mut ahead, mut behind) = (at, at);
                ahead[k] += h;
                behind[k] -= h;
                let (ahead, behind) = (shape(ahead), shape(behind));
                for a in 0..10 {
                    assert!(((ahead[a] - behind[a]) / (2.0 * h) - exact[a][k]).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn jacobian_is_the_derivative_of_the_position() {
        let mut random = Random::seeded(3);
        let x = curved_tet(&mut random, 0.1);
        let (at, h) = ([0.2, 0.3, 0.1], 0.01);
        let j = jacobian(&x, &gradients(at));
        for k in 0..3 {
            let (mut ahead, mut behind) = (at, at);
            ahead[k] += h;
            behind[k] -= h;
            let (ahead, behind) = (position(&x, ahead), position(&x, behind));
            for i in 0..3 {
                assert!(((ahead[i] - behind[i]) / (2.0 * h) - j[i][k]).abs() < 1e-12);
            }
        }
    }
}
