//! Areas and centroids of facets.

use crate::element::facet::area;
use crate::mesh::{Facet, Mesh, Surface};

/// Area (m2) and centroid (m) of a facet: the mean of its midsides, or of its corners where it has none, as contact and
/// connectors weight them.
fn area_and_centroid(mesh: &Mesh, facet: &Facet) -> (f64, [f64; 3]) {
    let bearing = if facet.midsides().is_empty() { facet.corners() } else { facet.midsides() };
    let mean = |i: usize| bearing.iter().map(|&n| mesh.nodes[n as usize][i]).sum::<f64>() / bearing.len() as f64;
    (area(&facet.positions(&mesh.nodes)), [0, 1, 2].map(mean))
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
