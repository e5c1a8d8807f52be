//! Where the shapes of two results can be compared.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::results::{Results, Shape, Surface};
use crate::{Error, Result};

/// Two samples are one place within this, relative to the brake's extent.
const SAME_PLACE: f64 = 1e-6;
/// Where this part of the samples of either result are places of both, those suffice.
const ENOUGH: f64 = 0.5;
/// Samples of B from which a displacement at a sample of A is interpolated.
const NEIGHBOURS: usize = 12;
/// Directions in which neighbours spread so little, relative, have no gradient.
const FLAT: f64 = 1e-3;
/// Samples of A that may lie off B's surface: none but for slips of a mesh.
const ASTRAY: f64 = 0.01;

/// Points of A, and how B's displacements there come from its samples.
///
/// On one mesh samples are places of both. Else B is interpolated to the samples of A, part by part, by moving least
/// squares: the linear field that fits the nearest samples best, weighted by the inverse square of their distances, so
/// that rigid motions are exact.
pub struct CommonPoints {
    /// Samples of A.
    of_a: Vec<usize>,
    /// For each a sum over samples of B.
    of_b: Vec<Vec<(usize, f64)>>,
    interpolated: bool,
}

/// A sample's number at its position.
type Sample = GeomWithData<[f64; 3], usize>;

/// The samples of a result, part by part.
type Parts = BTreeMap<String, Vec<Sample>>;

impl CommonPoints {
    /// The places that two results have in common.
    ///
    /// # Errors
    /// [`Error::Input`] where one has no samples, parts that the other has not, or another surface.
    pub fn new(a: &Results, b: &Results) -> Result<CommonPoints> {
        let (of_a, of_b) = (samples(a), samples(b));
        require_same_parts(&of_a, &of_b)?;
        require_same_surface(a, b)?;
        require_same_surface(b, a)?;
        let points = CommonPoints::of_both(&of_a, &of_b, SAME_PLACE * extent(&a.surface));
        let n_fewer = a.surface.samples.len().min(b.surface.samples.len());
        if points.len() as f64 >= ENOUGH * n_fewer as f64 {
            return Ok(points);
        }
        Ok(CommonPoints::interpolating(&of_a, &of_b))
    }

    /// Samples of A that are within a distance of one of B.
    fn of_both(a: &Parts, b: &Parts, distance: f64) -> CommonPoints {
        let (mut of_a, mut of_b) = (Vec::new(), Vec::new());
        for (part, own) in a {
            let tree = RTree::bulk_load(b[part].clone());
            for sample in own {
                let nearest = tree.nearest_neighbor_iter_with_distance_2(*sample.geom()).next();
                if let Some((other, _)) = nearest.filter(|(_, d2)| d2.sqrt() <= distance) {
                    of_a.push(sample.data);
                    of_b.push(vec![(other.data, 1.0)]);
                }
            }
        }
        CommonPoints { of_a, of_b, interpolated: false }
    }

    fn interpolating(a: &Parts, b: &Parts) -> CommonPoints {
        let (mut of_a, mut of_b) = (Vec::new(), Vec::new());
        for (part, own) in a {
            let tree = RTree::bulk_load(b[part].clone());
            for sample in own {
                let near: Vec<&Sample> = tree.nearest_neighbor_iter(*sample.geom()).take(NEIGHBOURS).collect();
                let positions: Vec<[f64; 3]> = near.iter().map(|sample| *sample.geom()).collect();
                of_a.push(sample.data);
                of_b.push(near.iter().map(|sample| sample.data).zip(weights(*sample.geom(), &positions)).collect());
            }
        }
        CommonPoints { of_a, of_b, interpolated: true }
    }

    /// Number of places.
    pub fn len(&self) -> usize {
        self.of_a.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.of_a.is_empty()
    }

    /// Whether B's shapes are interpolated.
    pub fn are_interpolated(&self) -> bool {
        self.interpolated
    }

    /// A shape of A at the places, three components each.
    pub fn of_a(&self, shape: &Shape) -> Vec<Complex64> {
        self.of_a.iter().flat_map(|&i| displacement(shape, i)).collect()
    }

    /// A shape of B at the places, three components each.
    pub fn of_b(&self, shape: &Shape) -> Vec<Complex64> {
        let sum = |terms: &Vec<(usize, f64)>| {
            let mut u = [Complex64::ZERO; 3];
            for &(j, weight) in terms {
                u.iter_mut().zip(displacement(shape, j)).for_each(|(u, v)| *u += weight * v);
            }
            u
        };
        self.of_b.iter().flat_map(sum).collect()
    }
}

fn displacement(shape: &Shape, i: usize) -> [Complex64; 3] {
    [0, 1, 2].map(|k| Complex64::new(shape.re[i][k].into(), shape.im[i][k].into()))
}

/// `w` with `sum w_n v_n = c`, where `v(x) = c + G (x - x_0)` fits the values `v_n` at some positions best:
///
/// ```text
/// min sum omega_n^2 |c + G d_n - v_n|^2    d_n = x_n - x_0    omega_n = 1 / (|d_n|^2 + small)
/// ```
fn weights(x: [f64; 3], positions: &[[f64; 3]]) -> Vec<f64> {
    let offsets: Vec<[f64; 3]> = positions.iter().map(|p| [0, 1, 2].map(|k| p[k] - x[k])).collect();
    let squares: Vec<f64> = offsets.iter().map(|d| d.iter().map(|d| d * d).sum()).collect();
    let reach = squares.iter().copied().fold(0.0, f64::max).sqrt().max(f64::MIN_POSITIVE);
    let omega: Vec<f64> = squares.iter().map(|d2| 1.0 / (d2 / (reach * reach) + 1e-6)).collect();
    let entry = |n: usize, k: usize| omega[n] * if k == 0 { 1.0 } else { offsets[n][k - 1] / reach };
    let matrix = DMatrix::from_fn(positions.len(), 4, entry);
    // The pseudo-inverse leaves out gradients across a plane of neighbours.
    let smallest = FLAT * matrix.norm();
    let inverse = matrix.pseudo_inverse(smallest).expect("the threshold is not negative");
    let first: DVector<f64> = inverse.row(0).transpose();
    first.iter().zip(&omega).map(|(w, omega)| w * omega).collect()
}

/// The samples with their part's name, or its number where there is none.
fn samples(results: &Results) -> Parts {
    let of_nodes = part_of_nodes(results);
    let mut parts = Parts::new();
    for (i, &node) in results.surface.samples.iter().enumerate() {
        let sample = Sample::new(results.surface.nodes[node as usize], i);
        parts.entry(of_nodes[node as usize].clone()).or_default().push(sample);
    }
    parts
}

/// The part of each node of the surface.
fn part_of_nodes(results: &Results) -> Vec<String> {
    let surface = &results.surface;
    let mut names = vec![String::new(); surface.nodes.len()];
    for (triangle, &part) in surface.triangles.iter().zip(&surface.part) {
        let name = results.about.parts.get(part as usize).map_or(part.to_string(), |part| part.name.clone());
        triangle.iter().for_each(|&node| names[node as usize].clone_from(&name));
    }
    names
}

fn extent(surface: &Surface) -> f64 {
    let along = |k: usize| {
        let values = surface.nodes.iter().map(|node| node[k]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    (0..3).map(|k| along(k).max(0.0).powi(2)).sum::<f64>().sqrt()
}

fn require_same_parts(a: &Parts, b: &Parts) -> Result<()> {
    if a.is_empty() || b.is_empty() {
        let which = if a.is_empty() { "first" } else { "second" };
        return Err(Error::input(format!("the {which} results have no shapes to compare")));
    }
    let missing =
        |of: &Parts, from: &Parts| -> Option<String> { of.keys().find(|part| !from.contains_key(*part)).cloned() };
    match missing(a, b).or(missing(b, a)) {
        Some(part) => {
            let both: Vec<String> = [a, b].map(|parts| parts.keys().cloned().collect::<Vec<_>>().join(", ")).into();
            Err(Error::input(format!("part {part:?} is in one of both only: {} and {}", both[0], both[1])))
        }
        None => Ok(()),
    }
}

/// Refuses samples of A that lie farther from the nearest node of B's surface than its longest edge.
fn require_same_surface(a: &Results, b: &Results) -> Result<()> {
    let mut nodes: BTreeMap<String, Vec<[f64; 3]>> = BTreeMap::new();
    for (name, node) in part_of_nodes(b).into_iter().zip(&b.surface.nodes) {
        nodes.entry(name).or_default().push(*node);
    }
    let edges = longest_edges(b);
    for (part, own) in samples(a) {
        let tree = RTree::bulk_load(nodes.remove(&part).unwrap_or_default());
        let off = |sample: &&Sample| {
            let nearest = tree.nearest_neighbor_iter_with_distance_2(*sample.geom()).next();
            nearest.is_none_or(|(_, d2)| d2.sqrt() > edges[&part])
        };
        let n_astray = own.iter().filter(off).count();
        if n_astray as f64 > ASTRAY * own.len() as f64 {
            return Err(Error::input(format!(
                "the surfaces do not coincide: {n_astray} of {} points of part {part:?} are more than {:.3} mm, an edge of its mesh, off \
                 the other's surface. Results of one brake in one place can be compared",
                own.len(),
                1e3 * edges[&part]
            )));
        }
    }
    Ok(())
}

/// The longest edge of each part's surface.
fn longest_edges(results: &Results) -> BTreeMap<String, f64> {
    let (surface, names) = (&results.surface, part_of_nodes(results));
    let mut longest = BTreeMap::new();
    for triangle in &surface.triangles {
        for k in 0..3 {
            let [p, q] = [triangle[k], triangle[(k + 1) % 3]].map(|node| surface.nodes[node as usize]);
            let length = crate::algebra::norm(crate::algebra::sub(p, q));
            let most: &mut f64 = longest.entry(names[triangle[k] as usize].clone()).or_default();
            *most = most.max(length);
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(x: [f64; 3]) -> f64 {
        3.0 - 2.0 * x[0] + 5.0 * x[1] + 0.5 * x[2]
    }

    #[test]
    fn linear_fields_are_interpolated_exactly() {
        let noise = |i: usize| ((i * 7919) % 1000) as f64 * 1e-5;
        let positions: Vec<[f64; 3]> = (0..12).map(|i| [noise(i), noise(3 * i + 1), noise(5 * i + 2)]).collect();
        let x = [4e-3, 5e-3, 6e-3];
        let value: f64 = weights(x, &positions).iter().zip(&positions).map(|(w, p)| w * field(*p)).sum();
        assert!((value - field(x)).abs() < 1e-12, "{value}");
    }

    #[test]
    fn in_a_plane_of_neighbours_gradients_in_the_plane_count() {
        let positions: Vec<[f64; 3]> = (0..9).map(|i| [(i % 3) as f64, (i / 3) as f64, 0.7]).collect();
        let x = [0.8, 1.3, 0.7];
        let value: f64 = weights(x, &positions).iter().zip(&positions).map(|(w, p)| w * field(*p)).sum();
        assert!((value - field(x)).abs() < 1e-12, "{value}");
    }

    #[test]
    fn at_a_neighbour_its_value_is_taken() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
        let weights = weights([0.0; 3], &positions);
        assert!((weights[0] - 1.0).abs() < 1e-6, "{weights:?}");
    }
}
