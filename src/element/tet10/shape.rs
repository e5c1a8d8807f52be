//! Shape functions, their gradients and the Jacobian.

use crate::algebra::cofactor_columns;
use crate::element::quadrature::{QuadraturePoint, TETRAHEDRON_4, TETRAHEDRON_14};

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

/// The nodes of each face as a 6-node facet: corners, then midsides, turning so that the normal points out of the
/// element.
pub const FACES: [[usize; 6]; 4] = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [2, 0, 3, 6, 7, 9]];

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
pub(super) const fn shapes_at<const Q: usize>(rule: &[QuadraturePoint<3>; Q]) -> [[f64; 10]; Q] {
    let mut table = [[0.0; 10]; Q];
    let mut q = 0;
    while q < Q {
        table[q] = shape(rule[q].at);
        q += 1;
    }
    table
}

/// Reference gradients at the points of a rule; made at compile time.
pub(super) const fn gradients_at<const Q: usize>(rule: &[QuadraturePoint<3>; Q]) -> [[[f64; 3]; 10]; Q] {
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

/// The element with straight edges, its midsides in the middle.
pub fn straight(corners: [[f64; 3]; 4]) -> [[f64; 3]; 10] {
    std::array::from_fn(|a| match a {
        0..4 => corners[a],
        _ => {
            let [i, j] = EDGES[a - 4].map(|corner| corners[corner]);
            std::array::from_fn(|k| 0.5 * (i[k] + j[k]))
        }
    })
}

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

/// The Jacobians at the four corners.
pub fn corner_jacobians(x: &[[f64; 3]; 10]) -> [[[f64; 3]; 3]; 4] {
    std::array::from_fn(|corner| jacobian(x, &gradients(NODES[corner])))
}

/// `detJ` (six times the local volume, m3) at the ten nodes and at the four points of the stiffness rule.
pub fn determinants(x: &[[f64; 3]; 10]) -> [f64; 14] {
    std::array::from_fn(|p| {
        let at = if p < 10 { NODES[p] } else { TETRAHEDRON_4[p - 10].at };
        cofactor_columns(&jacobian(x, &gradients(at))).1
    })
}

/// Whether the element is turned inside out somewhere, or flat: `detJ <= 0` at a node or at a point of the stiffness
/// rule.
pub fn is_inverted(x: &[[f64; 3]; 10]) -> bool {
    // Written so that a determinant that is not a number counts as inverted.
    !determinants(x).iter().all(|&det| det > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{cross, dot, sub};
    use crate::element::samples::{Random, curved_tet};

    const UNIT: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn faces_look_out_and_their_midsides_lie_between_their_corners() {
        for [a, b, c, ab, bc, ca] in FACES {
            let normal = cross(sub(NODES[b], NODES[a]), sub(NODES[c], NODES[a]));
            assert!(dot(normal, sub(NODES[a], [0.25; 3])) > 0.0);
            for (middle, [i, k]) in [(ab, [a, b]), (bc, [b, c]), (ca, [c, a])] {
                assert_eq!(NODES[middle], [0, 1, 2].map(|axis| 0.5 * (NODES[i][axis] + NODES[k][axis])));
            }
        }
    }

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
    fn a_midside_pulled_through_the_element_inverts_it() {
        let mut x = straight(UNIT);
        x[4] = [0.2, 0.0, 0.0];
        assert!(is_inverted(&x));
        x[4] = [0.4, 0.0, 0.0];
        assert!(!is_inverted(&x));
        x[4][1] = f64::NAN;
        assert!(is_inverted(&x), "a coordinate that is not a number is not taken for a good element");
    }

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
