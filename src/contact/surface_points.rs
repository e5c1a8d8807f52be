//! The contact points of a slave surface: quadrature points of its facets.
//!
//! | facet | points | weights |
//! |---|---|---|
//! | 3-node triangle | its corners | A/3 |
//! | 6-node triangle | its midsides | A/3 |
//! | 4-node, 8-node quadrilateral | 2 x 2 points of Gauss, in the order of the corners | A J_q / sum J |
//!
//! with the facet's area A and the area of a unit of dr ds, J. On plane facets these rules integrate the shape
//! functions exactly, so that a uniform pressure gives the consistent nodal forces; and no weight is negative. Points
//! at nodes are shared by the facets around them, and their weights added up.

use super::facet::FacetGeometry;
use crate::element::FacetShape;
use crate::element::quadrature::QUADRILATERAL_4;
use crate::mesh::{Facet, Surface};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Where a contact point lies on its slave surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Place {
    /// At a node of the mesh.
    Node(u32),
    /// Inside a facet.
    Inside {
        /// The facet's index in the surface.
        facet: u32,
        /// Which of its points.
        point: u8,
    },
}

/// Nodes with their shares in the displacement of a point, `u = sum_i N_i u_i`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Interpolated {
    /// The nodes.
    pub nodes: Vec<u32>,
    /// `N_i`, one a node.
    pub shape: Vec<f64>,
}

/// A contact point before it meets a master.
#[derive(Debug, Clone, Default)]
pub struct SurfacePoint {
    /// The slave's nodes that it moves with.
    pub slave: Interpolated,
    /// Where it is, m.
    pub position: Vector3<f64>,
    /// Area that it stands for, m2.
    pub weight: f64,
    /// `sum A n` over the facets around it, not normalised.
    pub normal: Vector3<f64>,
    /// Sum of these facets' sizes and their number.
    sizes: [f64; 2],
}

impl SurfacePoint {
    /// A point of no surface, with the outward normal of the one that it is on.
    pub fn alone(position: Vector3<f64>, normal: Vector3<f64>) -> Self {
        SurfacePoint { position, normal, sizes: [0.0, 1.0], ..SurfacePoint::default() }
    }

    /// Mean edge length of the facets around the point, m.
    pub fn size(&self) -> f64 {
        self.sizes[0] / self.sizes[1]
    }
}

/// The places of a facet's contact points, in the order of its corners or midsides.
pub fn places(index: usize, facet: &Facet) -> Vec<Place> {
    match facet.shape() {
        FacetShape::Triangle3 => facet.corners().iter().map(|&n| Place::Node(n)).collect(),
        FacetShape::Triangle6 => facet.midsides().iter().map(|&n| Place::Node(n)).collect(),
        FacetShape::Quadrilateral4 | FacetShape::Quadrilateral8 => {
            (0..4).map(|point| Place::Inside { facet: index as u32, point }).collect()
        }
    }
}

/// Reference coordinates of a facet's contact points, in the order of [`places`].
fn coordinates(shape: FacetShape) -> Vec<[f64; 2]> {
    let nodes = shape.interpolation().nodes();
    match shape {
        FacetShape::Triangle3 => nodes.to_vec(),
        FacetShape::Triangle6 => nodes[3..].to_vec(),
        FacetShape::Quadrilateral4 | FacetShape::Quadrilateral8 => [0, 1, 3, 2].map(|q| QUADRILATERAL_4[q].at).to_vec(),
    }
}

/// The contact points of a surface by rising place, and the surface's area (m2), which is the sum of their weights.
pub fn surface_points(surface: &Surface, nodes: &[[f64; 3]]) -> (BTreeMap<Place, SurfacePoint>, f64) {
    let mut found: BTreeMap<Place, SurfacePoint> = BTreeMap::new();
    let mut total = 0.0;
    for (index, facet) in surface.facets.iter().enumerate() {
        let geometry = FacetGeometry::gather(nodes, facet);
        let (area, size) = (geometry.area(), geometry.size());
        let at = coordinates(facet.shape());
        let shares = shares(&geometry, &at);
        total += area;
        for ((place, at), share) in places(index, facet).into_iter().zip(at).zip(shares) {
            let point = found.entry(place).or_default();
            (point.slave, point.position) = match place {
                Place::Node(n) => (Interpolated { nodes: vec![n], shape: vec![1.0] }, nodes[n as usize].into()),
                Place::Inside { .. } => (interpolated(facet, at), geometry.position(at)),
            };
            point.weight += area * share;
            point.normal += area * geometry.normal(at);
            point.sizes[0] += size;
            point.sizes[1] += 1.0;
        }
    }
    (found, total)
}

/// All nodes of a surface as points that are at no place between them, by rising number; they have no weight.
pub fn surface_nodes(surface: &Surface, nodes: &[[f64; 3]]) -> BTreeMap<Place, SurfacePoint> {
    let mut found: BTreeMap<Place, SurfacePoint> = BTreeMap::new();
    for facet in &surface.facets {
        let geometry = FacetGeometry::gather(nodes, facet);
        for (&n, &at) in facet.nodes().iter().zip(facet.shape().interpolation().nodes()) {
            let point = found.entry(Place::Node(n)).or_default();
            point.slave = Interpolated { nodes: vec![n], shape: vec![1.0] };
            point.position = nodes[n as usize].into();
            point.normal += geometry.area() * geometry.normal(at);
            point.sizes[0] += geometry.size();
            point.sizes[1] += 1.0;
        }
    }
    found
}

/// Each point's share of a facet's area.
fn shares(geometry: &FacetGeometry, at: &[[f64; 2]]) -> Vec<f64> {
    if geometry.shape.is_triangle() {
        return vec![1.0 / 3.0; 3];
    }
    let areas: Vec<f64> = at.iter().map(|&at| geometry.area_normal(at).norm()).collect();
    let sum: f64 = areas.iter().sum();
    areas.into_iter().map(|area| area / sum).collect()
}

/// A facet's nodes with the shape functions at a point.
pub(super) fn interpolated(facet: &Facet, at: [f64; 2]) -> Interpolated {
    let shape = facet.shape().interpolation().shape(at);
    Interpolated { nodes: facet.nodes().to_vec(), shape: shape[..facet.nodes().len()].to_vec() }
}

/// The midsides of a surface, or the corners where it is linear, by rising index, each with its share of the area of
/// the facets around it, m2.
pub fn nodal_weights(surface: &Surface, nodes: &[[f64; 3]]) -> Vec<(u32, f64)> {
    let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
    for facet in &surface.facets {
        let bearing = if facet.shape().is_quadratic() { facet.midsides() } else { facet.corners() };
        let share = FacetGeometry::gather(nodes, facet).area() / bearing.len() as f64;
        bearing.iter().for_each(|&n| *weights.entry(n).or_default() += share);
    }
    weights.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::facet::{area, traction_load};

    /// A plane facet with straight edges of uneven lengths.
    fn facet(shape: FacetShape) -> (Vec<[f64; 3]>, Facet) {
        let [a, b, c, d] = [[0.0, 0.0, 0.0], [2.0, 0.1, 0.0], [1.8, 1.6, 0.0], [-0.2, 1.1, 0.0]];
        let corners = if shape.is_triangle() { vec![a, b, d] } else { vec![a, b, c, d] };
        let middle = |[i, j]: [usize; 2]| [0, 1, 2].map(|k| 0.5 * (corners[i][k] + corners[j][k]));
        let midsides: Vec<[f64; 3]> = shape.edges().map(middle).collect();
        let n_midsides = if shape.is_quadratic() { midsides.len() } else { 0 };
        let x: Vec<[f64; 3]> = corners.iter().copied().chain(midsides.iter().copied().take(n_midsides)).collect();
        let nodes = (0..x.len() as u32).collect();
        (x, nodes)
    }

    #[test]
    fn uniform_pressure_is_exact_and_weights_are_positive_on_every_facet() {
        for shape in FacetShape::ALL {
            let (x, facet) = facet(shape);
            let surface = Surface { facets: vec![facet], parts: vec![0], inner: vec![] };
            let (points, total) = surface_points(&surface, &x);
            assert_eq!(points.len(), shape.n_corners());
            assert!((total - area(&x)).abs() < 1e-14 && points.values().all(|point| point.weight > 0.0));
            let mut forces = vec![0.0; x.len()];
            for point in points.values() {
                let slave = point.slave.nodes.iter().zip(&point.slave.shape);
                slave.for_each(|(&n, shape)| forces[n as usize] += point.weight * shape);
            }
            for (force, exact) in forces.iter().zip(traction_load(&x, [1.0, 0.0, 0.0])) {
                assert!((force - exact[0]).abs() < 1e-14, "{shape:?} {forces:?}");
            }
        }
    }

    #[test]
    fn points_at_nodes_are_shared_and_those_inside_are_not() {
        let x = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0]];
        let of = |facets: Vec<Facet>| surface_points(&Surface { parts: vec![0; 2], facets, inner: vec![] }, &x).0;
        let triangles = of(vec![[0, 1, 2].into(), [0, 2, 3].into()]);
        assert_eq!(triangles.keys().copied().collect::<Vec<_>>(), [0, 1, 2, 3].map(Place::Node));
        assert!((triangles[&Place::Node(0)].weight - 1.0 / 3.0).abs() < 1e-15);
        let squares = of(vec![[0, 1, 2, 3].into(), [1, 4, 5, 2].into()]);
        assert_eq!(squares.len(), 8);
        let near = &squares[&Place::Inside { facet: 0, point: 2 }];
        assert!(near.position[0] > 0.5 && near.position[1] > 0.5, "in the order of the corners");
    }

    #[test]
    fn nodal_weights_add_up_to_the_area_and_none_is_negative() {
        for shape in FacetShape::ALL {
            let (x, facet) = facet(shape);
            let weights = nodal_weights(&Surface { facets: vec![facet], parts: vec![0], inner: vec![] }, &x);
            assert!((weights.iter().map(|(_, w)| w).sum::<f64>() - area(&x)).abs() < 1e-14);
            assert!(weights.iter().all(|&(_, w)| w > 0.0));
        }
    }
}
