//! The 6-node facet: geometry of the skin and its consistent loads.
//!
//! ```text
//!     2
//!     | \         corners 0-2, then the midsides 3:(0,1) 4:(1,2) 5:(2,0)
//!     5   4       (xi, eta) are the barycentric coordinates l1, l2 of corners 1, 2;  l0 = 1 - xi - eta
//!     |     \     corners N_i = l_i (2 l_i - 1), midsides N_ij = 4 l_i l_j
//!     0--3--1
//!
//!   a_xi = dx/dxi, a_eta = dx/deta       tangents
//!   a_xi x a_eta                         area normal: direction n, length dA/(dxi deta)
//!   integral of f n dA = sum_q w f (a_xi x a_eta)
//! ```
//!
//! The normal points to the side from which the corners 0, 1, 2 are seen counterclockwise: out of the body for the
//! facets of a mesh. The area normal is a polynomial of degree 2, so area vectors and pressure loads are exact on
//! curved facets with the 7-point rule; areas and traction loads, which take its length, are exact on plane facets only
//! and otherwise as good as the facet's shape (a quarter of a cylinder in 2, 4, 8 facets along the arc: 4e-4, 2e-5,
//! 2e-6 of its area).

use super::quadrature::{QuadraturePoint, TRIANGLE_7};
use crate::algebra::{cross, norm};

/// Reference coordinates of the six nodes.
pub const NODES: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];

/// The two corners of each edge; its midside is node `3 + index`.
pub const EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Shape functions `N_a` at `(xi, eta)`.
pub const fn shape([xi, eta]: [f64; 2]) -> [f64; 6] {
    let zeta = 1.0 - xi - eta;
    [
        zeta * (2.0 * zeta - 1.0),
        xi * (2.0 * xi - 1.0),
        eta * (2.0 * eta - 1.0),
        4.0 * zeta * xi,
        4.0 * xi * eta,
        4.0 * eta * zeta,
    ]
}

/// Derivatives `[dN_a/dxi, dN_a/deta]` at `(xi, eta)`, one row a node.
pub const fn derivatives([xi, eta]: [f64; 2]) -> [[f64; 2]; 6] {
    let zeta = 1.0 - xi - eta;
    [
        [1.0 - 4.0 * zeta, 1.0 - 4.0 * zeta],
        [4.0 * xi - 1.0, 0.0],
        [0.0, 4.0 * eta - 1.0],
        [4.0 * (zeta - xi), -4.0 * xi],
        [4.0 * eta, 4.0 * xi],
        [-4.0 * eta, 4.0 * (zeta - eta)],
    ]
}

/// Second derivatives `[d2N_a/dxi2, d2N_a/dxi deta, d2N_a/deta2]`, the same at every point; one row a node.
///
/// What Newton's method needs to project a point onto a curved facet.
pub const SECOND_DERIVATIVES: [[f64; 3]; 6] =
    [[4.0, 4.0, 4.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0], [-8.0, -4.0, 0.0], [0.0, 4.0, 0.0], [0.0, -4.0, -8.0]];

/// Area, m2: `integral of dA = sum_q w |a_xi x a_eta|`.
pub fn area(x: &[[f64; 3]; 6]) -> f64 {
    area_normals(x).map(|(_, normal)| norm(normal)).sum()
}

/// Each node's share of the area, m2: `integral of N_a dA`. A plane straight facet: 0 at corners, area/3 at midsides.
///
/// The force of a uniform traction `t` (Pa) on node `a` is `t` times this.
fn nodal_areas(x: &[[f64; 3]; 6]) -> [f64; 6] {
    let mut areas = [0.0; 6];
    for (n, normal) in area_normals(x) {
        let da = norm(normal);
        for a in 0..6 {
            areas[a] += n[a] * da;
        }
    }
    areas
}

/// Each node's share of the area vector, m2: `integral of N_a n dA`, exact on curved facets.
fn nodal_area_vectors(x: &[[f64; 3]; 6]) -> [[f64; 3]; 6] {
    let mut vectors = [[0.0; 3]; 6];
    for (n, normal) in area_normals(x) {
        for a in 0..6 {
            add(&mut vectors[a], n[a], normal);
        }
    }
    vectors
}

/// Nodal forces, N, of a uniform traction (Pa, a vector in global axes): `f_a = traction integral of N_a dA`.
pub fn traction_load(x: &[[f64; 3]; 6], traction: [f64; 3]) -> [[f64; 3]; 6] {
    nodal_areas(x).map(|area| traction.map(|t| t * area))
}

/// Nodal forces, N, of a uniform pressure (Pa, positive into the body): `f_a = -pressure integral of N_a n dA`.
pub fn pressure_load(x: &[[f64; 3]; 6], pressure: f64) -> [[f64; 3]; 6] {
    nodal_area_vectors(x).map(|vector| vector.map(|v| -pressure * v))
}

static SHAPES: [[f64; 6]; 7] = {
    let mut table = [[0.0; 6]; 7];
    let mut q = 0;
    while q < 7 {
        table[q] = shape(TRIANGLE_7[q].at);
        q += 1;
    }
    table
};

static DERIVATIVES: [[[f64; 2]; 6]; 7] = {
    let mut table = [[[0.0; 2]; 6]; 7];
    let mut q = 0;
    while q < 7 {
        table[q] = derivatives(TRIANGLE_7[q].at);
        q += 1;
    }
    table
};

/// At each point of the rule: shape values and `w (a_xi x a_eta)`.
fn area_normals(x: &[[f64; 3]; 6]) -> impl Iterator<Item = (&'static [f64; 6], [f64; 3])> + '_ {
    let weighted = |(q, point): (usize, &QuadraturePoint<2>)| {
        let [along_xi, along_eta] = [0, 1].map(|k| combine(x, &DERIVATIVES[q].map(|row| row[k])));
        (&SHAPES[q], cross(along_xi, along_eta).map(|c| point.weight * c))
    };
    TRIANGLE_7.iter().enumerate().map(weighted)
}

/// `sum_a c_a x_a`
fn combine(x: &[[f64; 3]; 6], c: &[f64; 6]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for a in 0..6 {
        add(&mut sum, c[a], x[a]);
    }
    sum
}

/// `sum += factor v`
fn add(sum: &mut [f64; 3], factor: f64, v: [f64; 3]) {
    for i in 0..3 {
        sum[i] += factor * v[i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{dot, sub};
    use crate::element::samples::{Random, curved_tet};
    use crate::element::tet10;
    use proptest::prelude::*;

    fn skin(x: &[[f64; 3]; 10]) -> [[[f64; 3]; 6]; 4] {
        tet10::FACES.map(|face| face.map(|a| x[a]))
    }

    /// `integral of n dA`
    fn area_vector(x: &[[f64; 3]; 6]) -> [f64; 3] {
        nodal_area_vectors(x).into_iter().fold([0.0; 3], |sum, v| [0, 1, 2].map(|i| sum[i] + v[i]))
    }

    fn facet(map: impl Fn(f64, f64) -> [f64; 3]) -> [[f64; 3]; 6] {
        NODES.map(|[xi, eta]| map(xi, eta))
    }

    #[test]
    fn shape_functions_are_those_of_the_tetrahedron_on_its_face() {
        let mut random = Random::seeded(51);
        for _ in 0..20 {
            let (xi, eta) = (random.unit(), random.unit());
            let (n, volume) = (shape([xi, eta]), tet10::shape([xi, eta, 0.0]));
            for (a, b) in [0, 1, 2, 4, 5, 6].into_iter().enumerate() {
                assert!((n[a] - volume[b]).abs() < 1e-14);
            }
        }
        for a in 0..6 {
            let n = shape(NODES[a]);
            assert!((0..6).all(|b| n[b] == if a == b { 1.0 } else { 0.0 }));
        }
    }

    proptest! {
        #[test]
        fn derivatives_are_central_differences(xi in -0.2..1.2, eta in -0.2..1.2) {
            let h = 0.01; // exact for quadratics up to round-off
            let d = derivatives([xi, eta]);
            for a in 0..6 {
                let along_xi = (shape([xi + h, eta])[a] - shape([xi - h, eta])[a]) / (2.0 * h);
                let along_eta = (shape([xi, eta + h])[a] - shape([xi, eta - h])[a]) / (2.0 * h);
                prop_assert!((along_xi - d[a][0]).abs() < 1e-12 && (along_eta - d[a][1]).abs() < 1e-12);
                for k in 0..2 {
                    let dxi = (derivatives([xi + h, eta])[a][k] - derivatives([xi - h, eta])[a][k]) / (2.0 * h);
                    let deta = (derivatives([xi, eta + h])[a][k] - derivatives([xi, eta - h])[a][k]) / (2.0 * h);
                    prop_assert!((dxi - SECOND_DERIVATIVES[a][k]).abs() < 1e-11);
                    prop_assert!((deta - SECOND_DERIVATIVES[a][k + 1]).abs() < 1e-11);
                }
            }
        }
    }

    #[test]
    fn plane_facet_loads_its_midsides_with_a_third_of_the_area_each_and_its_corners_not() {
        let x = facet(|xi, eta| [1.0 + 3.0 * xi, 2.0 * eta, 5.0 - xi]);
        let exact = 0.5 * norm(cross([3.0, 0.0, -1.0], [0.0, 2.0, 0.0]));
        assert!((area(&x) / exact - 1.0).abs() < 1e-14);
        let shares = nodal_areas(&x);
        for a in 0..6 {
            let expected = if a < 3 { 0.0 } else { exact / 3.0 };
            assert!((shares[a] - expected).abs() < 1e-14);
        }
        let load = traction_load(&x, [1.0, -2.0, 3.0]);
        for i in 0..3 {
            let total: f64 = load.iter().map(|f| f[i]).sum();
            assert!((total - [1.0, -2.0, 3.0][i] * exact).abs() < 1e-13);
        }
    }

    #[test]
    fn a_plane_facet_with_a_curved_edge_has_its_exact_area() {
        // A parabola of height h over the edge (0,1) takes 2/3 h off the unit triangle.
        let mut x = facet(|xi, eta| [xi, eta, 0.0]);
        x[3][1] = 0.06;
        assert!((area(&x) - (0.5 - 2.0 / 3.0 * 0.06)).abs() < 1e-15);
    }

    /// Area of a quarter cylinder of radius and height 1 in `n` by `n` squares of two facets, relative error.
    fn quarter_cylinder_error(n: usize) -> f64 {
        let (mut sum, step) = (0.0, 1.0 / n as f64);
        let at = |s: f64, z: f64| {
            let angle = s * std::f64::consts::FRAC_PI_2;
            [angle.cos(), angle.sin(), z]
        };
        for i in 0..n {
            for j in 0..n {
                let (s, z) = (i as f64 * step, j as f64 * step);
                sum += area(&facet(|xi, eta| at(s + step * xi, z + step * eta)));
                sum += area(&facet(|xi, eta| at(s + step * (1.0 - xi), z + step * (1.0 - eta))));
            }
        }
        sum / std::f64::consts::FRAC_PI_2 - 1.0
    }

    #[test]
    fn area_of_a_cylinder_converges_with_the_fourth_power_of_the_facet_size() {
        let errors = [2, 4, 8].map(quarter_cylinder_error);
        assert!(errors[0].abs() < 5e-4, "{errors:?}");
        for pair in errors.windows(2) {
            assert!(((pair[0] / pair[1]).abs().log2() - 4.0).abs() < 0.3, "{errors:?}");
        }
    }

    #[test]
    fn area_vector_of_a_curved_facet_depends_on_its_rim_only() {
        // Stokes: integral of n dA = 1/2 closed integral of x cross dx, Simpson's rule being exact on each parabolic
        // edge
        let mut random = Random::seeded(52);
        let x: [[f64; 3]; 6] = NODES.map(|[xi, eta]| {
            let bump = random.vector().map(|v| 0.1 * v);
            [xi + bump[0], eta + bump[1], bump[2]]
        });
        let mut rim = [0.0; 3];
        for [start, end, middle] in [[0, 1, 3], [1, 2, 4], [2, 0, 5]] {
            let (a, b, m) = (x[start], x[end], x[middle]);
            let derivative = |s: f64| -> [f64; 3] {
                std::array::from_fn(|i| (4.0 * s - 3.0) * a[i] + (4.0 * s - 1.0) * b[i] + (4.0 - 8.0 * s) * m[i])
            };
            for (p, s, weight) in [(a, 0.0, 1.0 / 6.0), (m, 0.5, 4.0 / 6.0), (b, 1.0, 1.0 / 6.0)] {
                add(&mut rim, 0.5 * weight, cross(p, derivative(s)));
            }
        }
        assert!(norm(sub(area_vector(&x), rim)) < 1e-14);
    }

    #[test]
    fn a_closed_curved_skin_has_no_area_vector_and_encloses_the_volume_of_the_element() {
        let mut random = Random::seeded(53);
        for _ in 0..20 {
            let x = curved_tet(&mut random, 0.08);
            let mut closed = [0.0; 3];
            let mut flux = 0.0; // volume = 1/3 integral of x . n dA, degree 4
            for face in skin(&x) {
                add(&mut closed, 1.0, area_vector(&face));
                flux += nodal_area_vectors(&face).iter().zip(&face).map(|(v, p)| dot(*v, *p)).sum::<f64>() / 3.0;
            }
            assert!(norm(closed) < 1e-14);
            assert!((flux / tet10::volume(&x) - 1.0).abs() < 1e-13, "normals must point outward");
        }
    }

    #[test]
    fn pressure_all_around_a_curved_body_has_neither_force_nor_moment() {
        let mut random = Random::seeded(54);
        let x = curved_tet(&mut random, 0.08);
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for face in skin(&x) {
            for (f, p) in pressure_load(&face, 2.0).iter().zip(&face) {
                add(&mut force, 1.0, *f);
                add(&mut moment, 1.0, cross(*p, *f));
            }
        }
        assert!(norm(force) < 1e-14 && norm(moment) < 1e-14);
    }

    #[test]
    fn pressure_pushes_into_the_body() {
        let x = facet(|xi, eta| [xi, eta, 0.0]); // normal +z
        let total: f64 = pressure_load(&x, 6.0).iter().map(|f| f[2]).sum();
        assert!((total + 3.0).abs() < 1e-14);
    }
}
