//! Areas and centroids of facets, by their corners.

use crate::algebra::{cross, norm, sub};
use crate::mesh::{Facet, Mesh, Surface};

/// Area (m2) and centroid (m) of a facet with straight edges; a quadrilateral is two triangles.
pub fn area_and_centroid(mesh: &Mesh, facet: &Facet) -> (f64, [f64; 3]) {
    let corners = facet.corners();
    let x = |i: usize| mesh.nodes[corners[i] as usize];
    let (mut area, mut moment) = (0.0, [0.0; 3]);
    for second in 1..corners.len() - 1 {
        let [a, b, c] = [x(0), x(second), x(second + 1)];
        let own = 0.5 * norm(cross(sub(b, a), sub(c, a)));
        area += own;
        (0..3).for_each(|i| moment[i] += own * (a[i] + b[i] + c[i]) / 3.0);
    }
    (area, moment.map(|m| m / area))
}

/// Area (m2) and centroid (m) of a surface.
pub fn surface_centroid(mesh: &Mesh, surface: &Surface) -> (f64, [f64; 3]) {
    let (mut area, mut moment) = (0.0, [0.0; 3]);
    for facet in &surface.facets {
        let (own, centroid) = area_and_centroid(mesh, facet);
        area += own;
        (0..3).for_each(|i| moment[i] += own * centroid[i]);
    }
    (area, moment.map(|m| m / area))
}
