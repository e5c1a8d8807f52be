//! Geometry of one facet: a curved triangle or quadrilateral in space, with (r, s) for the reference coordinates.

use crate::element::{FacetShape, MAX_FACET_NODES, facet};
use crate::mesh::Facet;
use nalgebra::Vector3;

/// The positions of a facet's nodes; all geometry follows from `x(r, s) = sum N_j x_j = sum_m X_m p_m(r, s)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct FacetGeometry {
    /// The shape.
    pub shape: FacetShape,
    /// Positions in the mesh's node order, as many as the shape has nodes.
    nodes: [Vector3<f64>; MAX_FACET_NODES],
    /// `X_m = sum_j C_mj x_j`, one a monomial.
    monomials: [Vector3<f64>; MAX_FACET_NODES],
}

impl FacetGeometry {
    /// From the positions of the nodes.
    pub fn new(positions: &[Vector3<f64>]) -> Self {
        let shape = FacetShape::of(positions.len());
        let (mut nodes, mut monomials) = ([Vector3::zeros(); MAX_FACET_NODES], [Vector3::zeros(); MAX_FACET_NODES]);
        nodes[..positions.len()].copy_from_slice(positions);
        for (sum, row) in monomials.iter_mut().zip(shape.interpolation().coefficients()) {
            *sum = positions.iter().zip(row).map(|(x, c)| *c * x).sum();
        }
        FacetGeometry { shape, nodes, monomials }
    }

    /// Gathers a facet's nodes out of the mesh's.
    pub fn gather(nodes: &[[f64; 3]], facet: &Facet) -> Self {
        let positions: Vec<Vector3<f64>> = facet.nodes().iter().map(|&n| nodes[n as usize].into()).collect();
        FacetGeometry::new(&positions)
    }

    /// Positions of the nodes.
    pub fn nodes(&self) -> &[Vector3<f64>] {
        &self.nodes[..self.shape.n_nodes()]
    }

    /// The facet as seen from a point.
    pub fn about(&self, p: &Vector3<f64>) -> Self {
        FacetGeometry::new(&self.nodes().iter().map(|x| x - p).collect::<Vec<_>>())
    }

    /// `sum_m X_m d p_m`, where `d` differentiates by r and s `order` times.
    fn derivative(&self, at: [f64; 2], order: [usize; 2]) -> Vector3<f64> {
        self.shape.interpolation().monomials(at, order).zip(&self.monomials).map(|(p, x)| p * x).sum()
    }

    /// `x(r, s)`.
    pub fn position(&self, at: [f64; 2]) -> Vector3<f64> {
        self.derivative(at, [0, 0])
    }

    /// The two tangents `x_r, x_s`.
    pub fn tangents(&self, at: [f64; 2]) -> [Vector3<f64>; 2] {
        [[1, 0], [0, 1]].map(|order| self.derivative(at, order))
    }

    /// The second derivatives `x_rr, x_rs, x_ss`.
    pub fn curvatures(&self, at: [f64; 2]) -> [Vector3<f64>; 3] {
        [[2, 0], [1, 1], [0, 2]].map(|order| self.derivative(at, order))
    }

    /// `x_r x x_s`: the normal, and the area of a unit of dr ds.
    pub fn area_normal(&self, at: [f64; 2]) -> Vector3<f64> {
        let [xr, xs] = self.tangents(at);
        xr.cross(&xs)
    }

    /// The outward unit normal `x_r x x_s / |x_r x x_s|`; NaN where the facet is degenerate.
    pub fn normal(&self, at: [f64; 2]) -> Vector3<f64> {
        self.area_normal(at).normalize()
    }

    /// Area, exact on plane facets.
    pub fn area(&self) -> f64 {
        facet::area(&self.nodes().iter().map(|&x| x.into()).collect::<Vec<_>>())
    }

    /// Mean length of the chords between corners.
    pub fn size(&self) -> f64 {
        let n = self.shape.n_corners() as f64;
        self.shape.edges().map(|[a, b]| (self.nodes[a] - self.nodes[b]).norm() / n).sum()
    }

    /// The midside of edge `k`; the middle of a straight one.
    pub fn midside(&self, k: usize, [a, b]: [usize; 2]) -> Vector3<f64> {
        if self.shape.is_quadratic() {
            self.nodes[self.shape.n_corners() + k]
        } else {
            0.5 * (self.nodes[a] + self.nodes[b])
        }
    }

    /// An axis-aligned box that holds the whole curved facet.
    ///
    /// A quadratic patch lies in the convex hull of its Bezier points, which are the corners, for each edge
    /// `2 x_mid - (x_a + x_b)/2`, and inside a quadrilateral `sum x_mid - 3/4 sum x_corner`. The nodes alone would not
    /// do: a curved facet bulges out of their box.
    pub fn bounds(&self) -> [Vector3<f64>; 2] {
        let corners = &self.nodes[..self.shape.n_corners()];
        let middles = || self.shape.edges().enumerate().map(|(k, edge)| (self.midside(k, edge), edge));
        let edges = middles().map(|(middle, [a, b])| 2.0 * middle - 0.5 * (corners[a] + corners[b]));
        let inside: Vector3<f64> =
            middles().map(|(middle, _)| middle).sum::<Vector3<f64>>() - 0.75 * corners.iter().sum::<Vector3<f64>>();
        let inside = (!self.shape.is_triangle()).then_some(inside);
        let hull = corners.iter().copied().chain(edges).chain(inside);
        hull.fold([corners[0], corners[0]], |[low, high], p| [low.inf(&p), high.sup(&p)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::testing::{bent_facet, on_reference};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn tangents_and_curvatures_are_the_derivatives_of_the_position(facet in bent_facet(), at in on_reference()) {
            let at = at.on(&facet);
            let h = 1e-5;
            let step = |dr: f64, ds: f64| [at[0] + h * dr, at[1] + h * ds];
            let difference = |f: &dyn Fn([f64; 2]) -> Vector3<f64>, dr, ds| {
                (f(step(dr, ds)) - f(step(-dr, -ds))) / (2.0 * h)
            };
            let [xr, xs] = facet.tangents(at);
            let [xrr, xrs, xss] = facet.curvatures(at);
            let pairs = [
                (difference(&|p| facet.position(p), 1.0, 0.0), xr),
                (difference(&|p| facet.position(p), 0.0, 1.0), xs),
                (difference(&|p| facet.tangents(p)[0], 1.0, 0.0), xrr),
                (difference(&|p| facet.tangents(p)[0], 0.0, 1.0), xrs),
                (difference(&|p| facet.tangents(p)[1], 0.0, 1.0), xss),
            ];
            for (numerical, exact) in pairs {
                prop_assert!((numerical - exact).norm() < 1e-8);
            }
        }

        #[test]
        fn the_box_holds_the_curved_facet(facet in bent_facet(), at in on_reference()) {
            let [low, high] = facet.bounds();
            let x = facet.position(at.on(&facet));
            for k in 0..3 {
                prop_assert!(low[k] - 1e-14 <= x[k] && x[k] <= high[k] + 1e-14);
            }
        }
    }
}
