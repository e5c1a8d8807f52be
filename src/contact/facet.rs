//! Geometry of one quadratic facet: six nodes, a curved triangle in space. Its shape functions are the element's,
//! [`tri6`], with (r, s) for the reference coordinates.

use crate::element::tri6::{self, EDGES};
use nalgebra::Vector3;

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
        let n = tri6::shape(at);
        (0..6).map(|j| n[j] * self.nodes[j]).sum()
    }

    /// The two tangents `x_r, x_s`.
    pub fn tangents(&self, at: [f64; 2]) -> [Vector3<f64>; 2] {
        let dn = tri6::derivatives(at);
        [0, 1].map(|k| (0..6).map(|j| dn[j][k] * self.nodes[j]).sum())
    }

    /// The second derivatives `x_rr, x_rs, x_ss`.
    pub fn curvatures(&self) -> [Vector3<f64>; 3] {
        [0, 1, 2].map(|k| (0..6).map(|j| tri6::SECOND_DERIVATIVES[j][k] * self.nodes[j]).sum())
    }

    /// The outward unit normal `x_r x x_s / |x_r x x_s|`; NaN where the facet is degenerate.
    pub fn normal(&self, at: [f64; 2]) -> Vector3<f64> {
        let [xr, xs] = self.tangents(at);
        xr.cross(&xs).normalize()
    }

    /// Area, exact on plane facets.
    pub fn area(&self) -> f64 {
        tri6::area(&self.nodes.map(Into::into))
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
