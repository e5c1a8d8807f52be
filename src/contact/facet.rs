//! Geometry of one quadratic facet: six nodes, a curved triangle in space.

use nalgebra::Vector3;

/// Degree-4 rule on the triangle (Strang and Fix 1973, six points): area coordinates `(1 - 2a, a, a)` and
/// permutations, weight as a fraction of the triangle's area.
const RULE: [(f64, f64); 2] =
    [(0.445_948_490_915_964_9, 0.223_381_589_678_011_47), (0.091_576_213_509_770_74, 0.109_951_743_655_321_87)];

/// Corners at the ends of each edge; edge `k` has the midside node `3 + k`.
pub(super) const EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Natural coordinates (r, s) of the six nodes.
pub(super) const NODES: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];

/// Shape functions at (r, s), with `L = 1 - r - s`: corners `L(2L-1), r(2r-1), s(2s-1)`, midsides `4Lr, 4rs, 4sL`.
pub(super) fn shape([r, s]: [f64; 2]) -> [f64; 6] {
    let l = 1.0 - r - s;
    [l * (2.0 * l - 1.0), r * (2.0 * r - 1.0), s * (2.0 * s - 1.0), 4.0 * l * r, 4.0 * r * s, 4.0 * s * l]
}

/// First derivatives `[dN/dr, dN/ds]` of each shape function.
fn gradient([r, s]: [f64; 2]) -> [[f64; 2]; 6] {
    let l = 1.0 - r - s;
    [
        [1.0 - 4.0 * l, 1.0 - 4.0 * l],
        [4.0 * r - 1.0, 0.0],
        [0.0, 4.0 * s - 1.0],
        [4.0 * (l - r), -4.0 * r],
        [4.0 * s, 4.0 * r],
        [-4.0 * s, 4.0 * (l - s)],
    ]
}

/// Second derivatives `[d2N/dr2, d2N/drds, d2N/ds2]`, constant on the triangle.
const CURVATURE: [[f64; 3]; 6] =
    [[4.0, 4.0, 4.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0], [-8.0, -4.0, 0.0], [0.0, 4.0, 0.0], [0.0, -4.0, -8.0]];

/// The points of the degree-4 rule with their fractions of the area.
pub(super) fn rule() -> impl Iterator<Item = ([f64; 2], f64)> {
    RULE.into_iter().flat_map(|(a, w)| {
        let b = 1.0 - 2.0 * a;
        [([a, a], w), ([b, a], w), ([a, b], w)]
    })
}

/// The six nodes' positions of a facet; all geometry follows from `x(r, s) = sum N_j x_j`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    /// Positions in the mesh's node order.
    pub nodes: [Vector3<f64>; 6],
}

impl Facet {
    /// Gathers a facet's nodes out of the mesh's.
    pub fn gather(nodes: &[[f64; 3]], facet: &[u32; 6]) -> Self {
        Facet { nodes: facet.map(|n| Vector3::from(nodes[n as usize])) }
    }

    /// `x = sum N_j x_j`.
    pub fn position(&self, at: [f64; 2]) -> Vector3<f64> {
        let n = shape(at);
        (0..6).map(|j| n[j] * self.nodes[j]).sum()
    }

    /// The two tangents `x_r, x_s`.
    pub fn tangents(&self, at: [f64; 2]) -> [Vector3<f64>; 2] {
        let dn = gradient(at);
        [0, 1].map(|k| (0..6).map(|j| dn[j][k] * self.nodes[j]).sum())
    }

    /// The second derivatives `x_rr, x_rs, x_ss`.
    pub fn curvatures(&self) -> [Vector3<f64>; 3] {
        [0, 1, 2].map(|k| (0..6).map(|j| CURVATURE[j][k] * self.nodes[j]).sum())
    }

    /// The outward unit normal `x_r x x_s / |x_r x x_s|`; NaN where the facet is degenerate.
    pub fn normal(&self, at: [f64; 2]) -> Vector3<f64> {
        let [xr, xs] = self.tangents(at);
        xr.cross(&xs).normalize()
    }

    /// Area `int |x_r x x_s| dr ds` by the degree-4 rule (exact on plane facets, also with curved edges).
    pub fn area(&self) -> f64 {
        rule()
            .map(|(at, w)| {
                let [xr, xs] = self.tangents(at);
                0.5 * w * xr.cross(&xs).norm()
            })
            .sum()
    }

    /// Mean length of the three chords between corners.
    pub fn size(&self) -> f64 {
        EDGES.iter().map(|&[a, b]| (self.nodes[a] - self.nodes[b]).norm() / 3.0).sum()
    }

    /// An axis-aligned box that holds the whole curved facet.
    ///
    /// A quadratic patch lies in the convex hull of its Bezier points, which are the corners and, for each edge,
    /// `2 x_mid - (x_a + x_b)/2`. The six nodes alone would not do: a curved facet bulges out of their box.
    pub fn bounds(&self) -> [Vector3<f64>; 2] {
        let x = &self.nodes;
        let bezier = (0..3).map(|k| 2.0 * x[3 + k] - 0.5 * (x[EDGES[k][0]] + x[EDGES[k][1]]));
        let hull = x[..3].iter().copied().chain(bezier);
        hull.fold([x[0], x[0]], |[low, high], p| [low.inf(&p), high.sup(&p)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::testing::bent_facet;
    use proptest::prelude::*;

    /// A point of the reference triangle.
    fn inside() -> impl Strategy<Value = [f64; 2]> {
        (0.0..1.0, 0.0..1.0).prop_map(|(a, b): (f64, f64)| [a * (1.0 - b), b])
    }

    #[test]
    fn shape_functions_are_one_at_their_own_node_and_zero_at_the_others() {
        for (i, at) in NODES.into_iter().enumerate() {
            for (j, n) in shape(at).into_iter().enumerate() {
                assert_eq!(n, f64::from(i == j));
            }
        }
    }

    #[test]
    fn a_plane_facet_with_a_curved_edge_has_its_exact_area() {
        // A parabola of height h over the edge (0,1) takes 2/3 h off the unit triangle.
        let mut x = NODES.map(|[r, s]| Vector3::new(r, s, 0.0));
        x[3].y = 0.06;
        let exact = 0.5 - 2.0 / 3.0 * 0.06;
        assert!((Facet { nodes: x }.area() - exact).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn tangents_and_curvatures_are_the_derivatives_of_the_position(facet in bent_facet(), at in inside()) {
            let h = 1e-5;
            let step = |dr: f64, ds: f64| [at[0] + h * dr, at[1] + h * ds];
            let difference = |f: &dyn Fn([f64; 2]) -> Vector3<f64>, dr, ds| {
                (f(step(dr, ds)) - f(step(-dr, -ds))) / (2.0 * h)
            };
            let [xr, xs] = facet.tangents(at);
            let [xrr, xrs, xss] = facet.curvatures();
            let pairs = [
                (difference(&|p| facet.position(p), 1.0, 0.0), xr),
                (difference(&|p| facet.position(p), 0.0, 1.0), xs),
                (difference(&|p| facet.tangents(p)[0], 1.0, 0.0), xrr),
                (difference(&|p| facet.tangents(p)[0], 0.0, 1.0), xrs),
                (difference(&|p| facet.tangents(p)[1], 0.0, 1.0), xss),
            ];
            for (numerical, exact) in pairs {
                prop_assert!((numerical - exact).norm() < 1e-9);
            }
        }

        #[test]
        fn the_box_holds_the_curved_facet(facet in bent_facet(), at in inside()) {
            let [low, high] = facet.bounds();
            let x = facet.position(at);
            for k in 0..3 {
                prop_assert!(low[k] - 1e-14 <= x[k] && x[k] <= high[k] + 1e-14);
            }
        }
    }
}
