//! The search: where the contact points of a slave surface meet the master.
//!
//! Contact points are quadrature points of the slave's facets ([`surface_points`](super::surface_points)). Each is
//! projected on the closest of the master's facets that *face* it, `n_slave . n_master < -0.5`: without that condition
//! points beside an edge grab the wrong wall.
//!
//! A tree of the facets' boxes yields candidates in the order of their boxes' distance, and the search of a point
//! ends at the first box beyond the best facet found. The result does not depend on the order of the tree: among facets
//! whose distances agree (a point that projects on a common edge) the lowest index is taken.

use super::facet::FacetGeometry;
use super::projection::{Projection, project};
use super::surface_points::{Interpolated, Place, SurfacePoint, interpolated, surface_nodes, surface_points};
use crate::mesh::Surface;
use nalgebra::Vector3;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Range;

/// Facets face each other where the product of their unit normals is below this.
const FACING: f64 = -0.5;

/// Distances that differ by less than this fraction of the slave's facet size are equal.
const TIE: f64 = 1e-9;

/// What the search may be told.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options {
    /// Points farther than this from the master are dropped, m.
    ///
    /// Where none is given, each point has half the mean edge length of the slave's facets around it. The reason:
    /// a point stands for the patch of surface up to about half an edge away; if the master is farther than that
    /// no part of the patch lies over it. The gap between two meshes of one curved wall of radius R, about `h^2/8R`,
    /// stays below `h/2` as long as `h < 4R`.
    pub search_distance: Option<f64>,
}

/// A contact point and where it meets the master.
#[derive(Debug, Clone)]
pub struct FoundPoint {
    /// Where it lies on the slave.
    pub place: Place,
    /// The slave's nodes with their shape functions at the point.
    pub slave: Interpolated,
    /// Area that it stands for, m2.
    pub weight: f64,
    /// Position of the point, m.
    pub position: [f64; 3],
    /// Mean edge length of the slave's facets around the point, m.
    pub size: f64,
    /// Index of the master's facet in its surface.
    pub facet: usize,
    /// The facet's nodes with their shape functions at the projection.
    pub master: Interpolated,
    /// The master's outward unit normal n at the projection.
    pub normal: [f64; 3],
    /// Initial gap `(x - x_projection).n`, m; negative where the surfaces overlap.
    pub gap: f64,
    /// Distance `|x - x_projection|`, m; above `|gap|` where the point lies beyond an edge of the master.
    pub distance: f64,
}

/// What a search has found.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// The points that meet the master, by rising place.
    pub points: Vec<FoundPoint>,
    /// Number of the slave's points that do not.
    pub n_dropped: usize,
    /// Area of the slave surface, m2; the weights of all points, dropped ones included, add up to it.
    pub area: f64,
}

/// Those who search together: each looks for a share of the points and tells all others what it found.
pub trait Team {
    /// This member's share of n things.
    fn share(&self, n: usize) -> Range<usize>;
    /// Everyone's values, in the order of the shares.
    fn join(&self, own: Vec<Option<Foot>>) -> Vec<Option<Foot>>;
    /// Replaces each value by the largest that any member has in its place.
    fn largest(&self, values: &mut [f64]);
}

/// Where a point's projection lies on the master.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Foot {
    /// The facet's index in the master.
    facet: usize,
    /// Coordinates on the facet.
    at: [f64; 2],
}

/// One who searches alone.
pub struct Alone;

impl Team for Alone {
    fn share(&self, n: usize) -> Range<usize> {
        0..n
    }

    fn join(&self, own: Vec<Option<Foot>>) -> Vec<Option<Foot>> {
        own
    }

    fn largest(&self, _: &mut [f64]) {}
}

/// Finds the contact points of `slave` on `master`. Both refer to `nodes`, m. All of the team find the same.
///
/// A degenerate facet of the master (no normal) faces nothing and is passed over.
pub fn find(slave: &Surface, master: &Surface, nodes: &[[f64; 3]], options: &Options, team: &dyn Team) -> Found {
    let (candidates, area) = surface_points(slave, nodes);
    Found { area, ..meet(candidates, master, nodes, options, team) }
}

/// Finds where all nodes of `slave` meet `master`; they have no weight, and the surface no area.
pub fn find_nodes(slave: &Surface, master: &Surface, nodes: &[[f64; 3]], options: &Options, team: &dyn Team) -> Found {
    meet(surface_nodes(slave, nodes), master, nodes, options, team)
}

fn meet(
    candidates: BTreeMap<Place, SurfacePoint>,
    master: &Surface,
    nodes: &[[f64; 3]],
    options: &Options,
    team: &dyn Team,
) -> Found {
    let target = Target::new(master, nodes);
    let candidates: Vec<(Place, SurfacePoint)> = candidates.into_iter().collect();
    let search = |(_, point): &(Place, SurfacePoint)| {
        let reach = options.search_distance.unwrap_or(0.5 * point.size());
        let hit = target.closest(point, reach);
        hit.map(|hit| Foot { facet: hit.facet, at: hit.projection.at })
    };
    let feet = team.join(candidates[team.share(candidates.len())].iter().map(search).collect());
    let mut found = Found::default();
    for ((place, point), foot) in candidates.into_iter().zip(feet) {
        match foot {
            None => found.n_dropped += 1,
            Some(Foot { facet, at }) => {
                let hit = target.hit(facet, Projection::at(&target.facets[facet], &point.position, at));
                let on_master = interpolated(&master.facets[facet], at);
                found.points.push(found_point(place, point, on_master, &hit));
            }
        }
    }
    found
}

/// Where a point of space comes down on a master.
#[derive(Debug, Clone)]
pub struct Landing {
    /// The nodes of the master's facet with their shape functions at the projection.
    pub master: Interpolated,
    /// The master's outward unit normal n at the projection.
    pub normal: [f64; 3],
    /// `(x - x_projection).n`, m.
    pub gap: f64,
}

/// Projects points, each with the outward normal of the surface that it lies on (any length), on the closest facets of
/// `master` that face them; none where no facet does.
pub fn land(points: &[([f64; 3], [f64; 3])], master: &Surface, nodes: &[[f64; 3]]) -> Vec<Option<Landing>> {
    let target = Target::new(master, nodes);
    let of = |(x, outward): &([f64; 3], [f64; 3])| {
        let point = SurfacePoint::alone((*x).into(), (*outward).into());
        let Hit { facet, projection, normal } = target.closest(&point, f64::INFINITY)?;
        let gap = (point.position - projection.position).dot(&normal);
        let on_master = interpolated(&master.facets[facet], projection.at);
        Some(Landing { master: on_master, normal: normal.into(), gap })
    };
    points.iter().map(of).collect()
}

/// The master's facets with a tree of their boxes.
struct Target {
    facets: Vec<FacetGeometry>,
    tree: RTree<GeomWithData<Rectangle<[f64; 3]>, usize>>,
}

/// A facet of the master with a point's projection on it.
struct Hit {
    facet: usize,
    projection: Projection,
    normal: Vector3<f64>,
}

impl Target {
    fn new(master: &Surface, nodes: &[[f64; 3]]) -> Self {
        let facets: Vec<_> = master.facets.iter().map(|f| FacetGeometry::gather(nodes, f)).collect();
        let boxes = facets.iter().enumerate().map(|(index, facet)| {
            let [low, high] = facet.bounds();
            GeomWithData::new(Rectangle::from_corners(low.into(), high.into()), index)
        });
        let tree = RTree::bulk_load(boxes.collect());
        Target { facets, tree }
    }

    /// The closest facing facet within `reach` of a point; the lowest index of those equally close.
    fn closest(&self, point: &SurfacePoint, reach: f64) -> Option<Hit> {
        let (x, tolerance) = (&point.position, TIE * point.size());
        let mut hits: Vec<Hit> = Vec::new();
        let mut nearest = reach;
        let boxes = self.tree.nearest_neighbor_iter_with_distance_2((*x).into());
        for (candidate, squared) in boxes {
            if squared.sqrt() > nearest + tolerance {
                break;
            }
            let hit = self.facing(candidate.data, x, &point.normal);
            if let Some(hit) = hit.filter(|hit| hit.projection.distance <= reach) {
                nearest = nearest.min(hit.projection.distance);
                hits.push(hit);
            }
        }
        hits.into_iter().filter(|hit| hit.projection.distance <= nearest + tolerance).min_by_key(|hit| hit.facet)
    }

    /// Projects on a facet, unless its normal there does not face the slave's.
    fn facing(&self, facet: usize, x: &Vector3<f64>, slave: &Vector3<f64>) -> Option<Hit> {
        let hit = self.hit(facet, project(&self.facets[facet], x));
        (hit.normal.dot(&slave.normalize()) < FACING).then_some(hit)
    }

    fn hit(&self, facet: usize, projection: Projection) -> Hit {
        Hit { facet, projection, normal: self.facets[facet].normal(projection.at) }
    }
}

/// Puts together what is known of a point that met the master.
fn found_point(place: Place, point: SurfacePoint, master: Interpolated, hit: &Hit) -> FoundPoint {
    FoundPoint {
        place,
        weight: point.weight,
        position: point.position.into(),
        size: point.size(),
        slave: point.slave,
        facet: hit.facet,
        master,
        normal: hit.normal.into(),
        gap: (point.position - hit.projection.position).dot(&hit.normal),
        distance: hit.projection.distance,
    }
}

#[cfg(test)]
mod tests;
