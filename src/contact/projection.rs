//! The closest point of one facet.
//!
//! Wanted is the minimum of `f(r, s) = |x(r, s) - p|^2 / 2` over the closed facet. It is found from the outside in:
//!
//! 1. *Edges.* On an edge x is a quadratic in t, so f' is a cubic whose sign changes can be bracketed exactly: the
//!    lowest point of the whole boundary is known without any starting guess.
//! 2. *Inside.* Newton's method descends from that point and from a few inner samples; the lowest end wins. Steps that
//!    leave the facet or do not descend are halved, so the boundary's point moves only where f falls inwards.
//!
//! What comes out is never farther than the closest point of the boundary, and where it lies inside it is a minimum.
//! Several starts matter only beyond a facet's own radius of curvature, where f has more than one.

use super::facet::FacetGeometry;
use nalgebra::{Matrix2, Vector2, Vector3};

/// The closest point of a facet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Projection {
    /// Natural coordinates (r, s), inside the facet or on its edges.
    pub at: [f64; 2],
    /// `x(r, s)`.
    pub position: Vector3<f64>,
    /// `|p - x(r, s)|`.
    pub distance: f64,
}

/// Projects `p` on a facet: the closest point of the closed facet.
pub(super) fn project(facet: &FacetGeometry, p: &Vector3<f64>) -> Projection {
    // With p as the origin, f = |x|^2/2 keeps its digits far from the mesh's origin.
    let local = facet.about(p);
    let edges = facet.shape.edges().enumerate().flat_map(|(k, edge)| edge_candidates(&local, k, edge));
    let boundary = lowest(&local, edges);
    let inside = facet.shape.rule().iter().map(|point| point.at);
    let ends = std::iter::once(boundary).chain(inside);
    let at = lowest(&local, ends.map(|start| descend(&local, start)));
    Projection::at(facet, p, at)
}

impl Projection {
    /// The projection of `p` that lies at the coordinates `at` of a facet.
    pub fn at(facet: &FacetGeometry, p: &Vector3<f64>, at: [f64; 2]) -> Projection {
        Projection { at, position: facet.position(at), distance: facet.about(p).position(at).norm() }
    }
}

/// The candidate with the smallest f; the first of equals.
fn lowest(facet: &FacetGeometry, candidates: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    let mut best = ([0.0; 2], f64::INFINITY);
    for at in candidates {
        let f = objective(facet, at);
        if f < best.1 {
            best = (at, f);
        }
    }
    best.0
}

/// `f = |x|^2 / 2`.
fn objective(facet: &FacetGeometry, at: [f64; 2]) -> f64 {
    0.5 * facet.position(at).norm_squared()
}

/// Both ends of edge `k` and the points between them where the distance is smallest.
fn edge_candidates(facet: &FacetGeometry, k: usize, [i, j]: [usize; 2]) -> Vec<[f64; 2]> {
    let (xa, xb, xm) = (facet.nodes()[i], facet.nodes()[j], facet.midside(k, [i, j]));
    // x(t) = a + b t + c t^2 through xa, xm, xb at t = 0, 1/2, 1
    let (a, b, c) = (xa, 4.0 * xm - 3.0 * xa - xb, 2.0 * (xa + xb - 2.0 * xm));
    // f' = (a + b t + c t^2).(b + 2 c t)
    let slope = [a.dot(&b), b.dot(&b) + 2.0 * a.dot(&c), 3.0 * b.dot(&c), 2.0 * c.dot(&c)];
    let ends = [0.0, 1.0];
    let nodes = facet.shape.interpolation().nodes();
    let on_edge = |t: f64| [0, 1].map(|m| nodes[i][m] + t * (nodes[j][m] - nodes[i][m]));
    ends.into_iter().chain(minima_of_cubic_slope(slope)).map(on_edge).collect()
}

/// Points of (0, 1) where the slope `c0 + c1 t + c2 t^2 + c3 t^3` changes from falling to rising.
fn minima_of_cubic_slope(c: [f64; 4]) -> Vec<f64> {
    // Between the zeros of its own derivative the slope is monotone.
    let mut breaks = vec![0.0, 1.0];
    breaks.extend(quadratic_roots(c[1], 2.0 * c[2], 3.0 * c[3]).filter(|t| *t > 0.0 && *t < 1.0));
    breaks.sort_by(f64::total_cmp);
    let slope = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    breaks
        .windows(2)
        .filter(|ends| slope(ends[0]) < 0.0 && slope(ends[1]) > 0.0)
        .map(|ends| bracketed_root(&c, ends[0], ends[1]))
        .collect()
}

/// Real roots of `a + b t + c t^2`, by the form without cancellation; not finite where c or b vanishes.
fn quadratic_roots(a: f64, b: f64, c: f64) -> impl Iterator<Item = f64> {
    let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    [q / c, a / q].into_iter().filter(|t| t.is_finite())
}

/// The root of a cubic that rises through zero between `low` and `high`: Newton, with bisection where it strays.
fn bracketed_root(c: &[f64; 4], mut low: f64, mut high: f64) -> f64 {
    let mut t = 0.5 * (low + high);
    for _ in 0..100 {
        let value = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        if value < 0.0 {
            low = t;
        } else {
            high = t;
        }
        let newton = t - value / (c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]));
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - t).abs() <= f64::EPSILON {
            return next;
        }
        t = next;
    }
    t
}

/// Newton's descent from `at` without leaving the facet; stays where no step inside it descends.
fn descend(facet: &FacetGeometry, mut at: [f64; 2]) -> [f64; 2] {
    let scale = facet.nodes().iter().map(|x| x.norm()).fold(0.0, f64::max);
    for _ in 0..50 {
        let Some(next) = acceptable(facet, at, newton_step(facet, at), scale) else {
            return at;
        };
        let moved = (next[0] - at[0]).abs().max((next[1] - at[1]).abs());
        at = next;
        if moved < 1e-15 {
            return at;
        }
    }
    at
}

/// `-H^-1 f'` with the full Hessian where it is positive definite, else with its Gauss-Newton part.
fn newton_step(facet: &FacetGeometry, at: [f64; 2]) -> Vector2<f64> {
    let x = facet.position(at);
    let [xr, xs] = facet.tangents(at);
    let [xrr, xrs, xss] = facet.curvatures(at);
    // f' = [x.x_r, x.x_s]   H = [x_r.x_r, x_r.x_s; ., x_s.x_s] + [x.x_rr, x.x_rs; ., x.x_ss]
    let slope = Vector2::new(x.dot(&xr), x.dot(&xs));
    let gauss = Matrix2::new(xr.dot(&xr), xr.dot(&xs), xr.dot(&xs), xs.dot(&xs));
    let full = gauss + Matrix2::new(x.dot(&xrr), x.dot(&xrs), x.dot(&xrs), x.dot(&xss));
    let definite = full[(0, 0)] > 0.0 && full.determinant() > 1e-6 * gauss.determinant();
    let hessian = if definite { full } else { gauss };
    hessian.try_inverse().map_or(Vector2::zeros(), |inverse| -(inverse * slope))
}

/// The longest of the step's halvings that stays in the facet and does not ascend, up to the rounding of f that
/// nodes at the distance `scale` cause.
fn acceptable(facet: &FacetGeometry, at: [f64; 2], step: Vector2<f64>, scale: f64) -> Option<[f64; 2]> {
    let f = objective(facet, at);
    // |x| is uncertain by eps scale, |x|^2/2 by |x| eps scale
    let ceiling = f + 4.0 * f64::EPSILON * scale * (2.0 * f).sqrt();
    (0..40)
        .map(|halvings| 0.5_f64.powi(halvings))
        .map(|factor| [at[0] + factor * step.x, at[1] + factor * step.y])
        .filter(|&next| facet.shape.contains(next))
        .find(|next| objective(facet, *next) <= ceiling)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::testing::{bent_facet, on_reference};
    use crate::element::FacetShape;
    use proptest::prelude::*;

    fn flat() -> FacetGeometry {
        let nodes = FacetShape::Triangle6.interpolation().nodes();
        FacetGeometry::new(&nodes.iter().map(|&[r, s]| Vector3::new(r, s, 0.0)).collect::<Vec<_>>())
    }

    #[test]
    fn a_point_above_a_flat_facet_projects_straight_down() {
        let found = project(&flat(), &Vector3::new(0.3, 0.2, 0.7));
        assert!((found.position - Vector3::new(0.3, 0.2, 0.0)).norm() < 1e-15);
        assert!((found.distance - 0.7).abs() < 1e-15);
    }

    #[test]
    fn points_beyond_edges_and_corners_clamp_to_them() {
        for (p, expected) in [
            ([0.4, -0.3, 0.1], [0.4, 0.0, 0.0]),
            ([1.0, 1.0, 0.0], [0.5, 0.5, 0.0]),
            ([-0.2, 0.6, -0.1], [0.0, 0.6, 0.0]),
            ([-1.0, -1.0, 0.0], [0.0, 0.0, 0.0]),
            ([3.0, 0.1, 0.2], [1.0, 0.0, 0.0]),
        ] {
            let found = project(&flat(), &Vector3::from(p));
            assert!((found.position - Vector3::from(expected)).norm() < 1e-14, "{p:?}");
        }
    }

    #[test]
    fn cubic_slopes_give_every_minimum() {
        // f' = (t - 0.2)(t - 0.5)(t - 0.8): minima at 0.2 and 0.8
        let minima = minima_of_cubic_slope([-0.08, 0.66, -1.5, 1.0]);
        assert_eq!(minima.len(), 2);
        assert!((minima[0] - 0.2).abs() < 1e-14 && (minima[1] - 0.8).abs() < 1e-14);
    }

    proptest! {
        #[test]
        fn nothing_on_the_facet_is_closer(
            facet in bent_facet(),
            p in prop::array::uniform3(-1.0..2.0),
        ) {
            let p = Vector3::from(p);
            let found = project(&facet, &p);
            let n = 60;
            for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
                let at = [i, j].map(|i| 2.0 * f64::from(i) / f64::from(n) - 1.0);
                if facet.shape.contains(at) {
                    prop_assert!(found.distance <= (facet.position(at) - p).norm() + 1e-12);
                }
            }
        }

        #[test]
        fn a_point_on_a_normal_comes_back_to_its_foot(
            facet in bent_facet(),
            at in on_reference(),
            height in -0.05..0.05,
        ) {
            let at = at.on(&facet);
            let foot: Vector3<f64> = facet.position(at);
            let found = project(&facet, &(foot + height * facet.normal(at)));
            prop_assert!((found.position - foot).norm() < 1e-12, "{found:?} {foot}");
        }
    }
}
