//! Facets, the faces of solid elements: geometry of the skin and its consistent loads.
//!
//! ```text
//!     2                 3--6--2         corners first, counterclockwise seen from outside the body,
//!     | \               |     |         then the midsides of the edges from each corner to the next
//!     5   4             7     5
//!     |     \           |     |         triangles: (xi, eta) from 0 to 1, xi + eta <= 1
//!     0--3--1           0--4--1         quadrilaterals: from -1 to 1
//!
//!   a_xi = dx/dxi, a_eta = dx/deta       tangents
//!   a_xi x a_eta                         area normal: direction n, length dA/(dxi deta)
//!   integral of f n dA = sum_q w f (a_xi x a_eta)
//! ```
//!
//! The area normal is a polynomial, so area vectors and pressure loads are exact on curved facets with 7 points on
//! triangles and 3 x 3 on quadrilaterals; areas and traction loads, which take its length, are exact on plane facets
//! only and otherwise as good as the facet's shape (a quarter of a cylinder in 2, 4, 8 facets along the arc: 4e-4,
//! 2e-5, 2e-6 of its area).

use super::interpolation::Interpolation;
use super::quadrature::{QUADRILATERAL_9, QuadraturePoint, TRIANGLE_7};
use crate::algebra::{cross, norm};

/// The geometry of a facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FacetShape {
    /// 3 nodes.
    Triangle3,
    /// 6 nodes.
    Triangle6,
    /// 4 nodes.
    Quadrilateral4,
    /// 8 nodes.
    Quadrilateral8,
}

/// Largest number of nodes of a facet.
pub const MAX_FACET_NODES: usize = 8;

const TRIANGLE_NODES: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
const TRIANGLE_POWERS: [[u8; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];
const QUADRILATERAL_NODES: [[f64; 2]; 8] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
const QUADRILATERAL_POWERS: [[u8; 2]; 8] = [[0, 0], [1, 0], [0, 1], [1, 1], [2, 0], [2, 1], [0, 2], [1, 2]];

static TRIANGLE_3: Interpolation<2, MAX_FACET_NODES> = Interpolation::new(3, &TRIANGLE_NODES, &TRIANGLE_POWERS);
static TRIANGLE_6: Interpolation<2, MAX_FACET_NODES> = Interpolation::new(6, &TRIANGLE_NODES, &TRIANGLE_POWERS);
static QUADRILATERAL_4: Interpolation<2, MAX_FACET_NODES> =
    Interpolation::new(4, &QUADRILATERAL_NODES, &QUADRILATERAL_POWERS);
static QUADRILATERAL_8: Interpolation<2, MAX_FACET_NODES> =
    Interpolation::new(8, &QUADRILATERAL_NODES, &QUADRILATERAL_POWERS);

impl FacetShape {
    /// All shapes.
    pub const ALL: [FacetShape; 4] =
        [FacetShape::Triangle3, FacetShape::Triangle6, FacetShape::Quadrilateral4, FacetShape::Quadrilateral8];

    /// The shape of a facet with so many nodes.
    ///
    /// # Panics
    /// Where no shape has as many.
    pub const fn of(n_nodes: usize) -> FacetShape {
        match n_nodes {
            3 => FacetShape::Triangle3,
            6 => FacetShape::Triangle6,
            4 => FacetShape::Quadrilateral4,
            8 => FacetShape::Quadrilateral8,
            _ => panic!("a facet has 3, 4, 6 or 8 nodes"),
        }
    }

    /// Shape functions and the reference coordinates of the nodes.
    pub fn interpolation(self) -> &'static Interpolation<2, MAX_FACET_NODES> {
        match self {
            FacetShape::Triangle3 => &TRIANGLE_3,
            FacetShape::Triangle6 => &TRIANGLE_6,
            FacetShape::Quadrilateral4 => &QUADRILATERAL_4,
            FacetShape::Quadrilateral8 => &QUADRILATERAL_8,
        }
    }

    /// Number of nodes.
    pub const fn n_nodes(self) -> usize {
        match self {
            FacetShape::Triangle3 => 3,
            FacetShape::Triangle6 => 6,
            FacetShape::Quadrilateral4 => 4,
            FacetShape::Quadrilateral8 => 8,
        }
    }

    /// Number of corners; they are the first nodes.
    pub const fn n_corners(self) -> usize {
        if self.is_triangle() { 3 } else { 4 }
    }

    /// Whether it has three corners.
    pub const fn is_triangle(self) -> bool {
        matches!(self, FacetShape::Triangle3 | FacetShape::Triangle6)
    }

    /// Whether the edges have midsides.
    pub const fn is_quadratic(self) -> bool {
        self.n_nodes() > self.n_corners()
    }

    /// The two corners of each edge; its midside is node `n_corners + index`.
    pub fn edges(self) -> impl Iterator<Item = [usize; 2]> {
        let n = self.n_corners();
        (0..n).map(move |k| [k, (k + 1) % n])
    }

    /// Whether reference coordinates lie on the facet or its rim.
    pub fn contains(self, [xi, eta]: [f64; 2]) -> bool {
        if self.is_triangle() {
            xi >= 0.0 && eta >= 0.0 && xi + eta <= 1.0
        } else {
            xi.abs() <= 1.0 && eta.abs() <= 1.0
        }
    }

    /// The points that integrate loads.
    pub fn rule(self) -> &'static [QuadraturePoint<2>] {
        if self.is_triangle() { &TRIANGLE_7 } else { &QUADRILATERAL_9 }
    }
}

/// The area normal `a_xi x a_eta` at a point, m2: direction n, length dA/(dxi deta).
pub fn area_normal(x: &[[f64; 3]], at: [f64; 2]) -> [f64; 3] {
    let gradients = FacetShape::of(x.len()).interpolation().gradients(at);
    let [along_xi, along_eta] = [0, 1].map(|k| {
        let mut sum = [0.0; 3];
        x.iter().zip(&gradients).for_each(|(&x, gradient)| add(&mut sum, gradient[k], x));
        sum
    });
    cross(along_xi, along_eta)
}

/// Area, m2: `integral of dA = sum_q w |a_xi x a_eta|`.
pub fn area(x: &[[f64; 3]]) -> f64 {
    area_normals(x).map(|(_, normal)| norm(normal)).sum()
}

/// Nodal forces, N, of a uniform traction (Pa, a vector in global axes): `f_a = traction integral of N_a dA`.
pub fn traction_load(x: &[[f64; 3]], traction: [f64; 3]) -> Vec<[f64; 3]> {
    let mut forces = vec![[0.0; 3]; x.len()];
    for (shape, normal) in area_normals(x) {
        let da = norm(normal);
        forces.iter_mut().zip(shape).for_each(|(force, n)| add(force, n * da, traction));
    }
    forces
}

/// Nodal forces, N, of a uniform pressure (Pa, positive into the body): `f_a = -pressure integral of N_a n dA`, exact
/// on curved facets.
pub fn pressure_load(x: &[[f64; 3]], pressure: f64) -> Vec<[f64; 3]> {
    let mut forces = vec![[0.0; 3]; x.len()];
    for (shape, normal) in area_normals(x) {
        forces.iter_mut().zip(shape).for_each(|(force, n)| add(force, -pressure * n, normal));
    }
    forces
}

/// `integral of N_a N_b dA`, m2, row-major: exact on plane facets with straight edges.
pub fn shape_products(x: &[[f64; 3]]) -> Vec<f64> {
    let mut products = vec![0.0; x.len() * x.len()];
    for (shape, normal) in area_normals(x) {
        let da = norm(normal);
        for (line, left) in products.chunks_exact_mut(x.len()).zip(shape) {
            line.iter_mut().zip(shape).for_each(|(entry, right)| *entry += da * (left * right));
        }
    }
    products
}

/// At each point of the rule: shape values and `w (a_xi x a_eta)`.
fn area_normals(x: &[[f64; 3]]) -> impl Iterator<Item = ([f64; MAX_FACET_NODES], [f64; 3])> + '_ {
    let shape = FacetShape::of(x.len());
    let weighted = |point: &QuadraturePoint<2>| area_normal(x, point.at).map(|c| point.weight * c);
    shape.rule().iter().map(move |point| (shape.interpolation().shape(point.at), weighted(point)))
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
    use crate::element::Shape;
    use crate::element::samples::{Random, curved};
    use crate::element::solid::volume;

    fn facet(shape: FacetShape, map: impl Fn(f64, f64) -> [f64; 3]) -> Vec<[f64; 3]> {
        shape.interpolation().nodes().iter().map(|&[xi, eta]| map(xi, eta)).collect()
    }

    /// `integral of n dA`
    fn area_vector(x: &[[f64; 3]]) -> [f64; 3] {
        pressure_load(x, -1.0).into_iter().fold([0.0; 3], |sum, v| [0, 1, 2].map(|i| sum[i] + v[i]))
    }

    #[test]
    fn shape_functions_are_those_of_the_solid_on_its_faces() {
        let mut random = Random::seeded(51);
        for shape in Shape::ALL {
            let solid = shape.interpolation();
            for face in shape.faces() {
                let facet = FacetShape::of(face.len()).interpolation();
                let at = [0.4 * random.unit(), 0.4 * random.unit()];
                let n = facet.shape(at);
                let point = [0, 1, 2].map(|i| face.iter().zip(n).map(|(&a, n)| n * solid.nodes()[a][i]).sum());
                let on_solid = solid.shape(point);
                assert!(face.iter().zip(n).all(|(&a, n)| (on_solid[a] - n).abs() < 1e-14), "{shape:?} {face:?}");
            }
        }
    }

    #[test]
    fn shares_of_a_plane_facet_are_the_known_ones() {
        let known: [(FacetShape, &[f64]); 4] = [
            (FacetShape::Triangle3, &[1.0 / 3.0; 3]),
            (FacetShape::Triangle6, &[0.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0]),
            (FacetShape::Quadrilateral4, &[0.25; 4]),
            (
                FacetShape::Quadrilateral8,
                &[-1. / 12., -1. / 12., -1. / 12., -1. / 12., 1. / 3., 1. / 3., 1. / 3., 1. / 3.],
            ),
        ];
        for (shape, shares) in known {
            let x = facet(shape, |xi, eta| [1.0 + 3.0 * xi, 2.0 * eta, 5.0 - xi]);
            let exact = norm(cross([3.0, 0.0, -1.0], [0.0, 2.0, 0.0])) * if shape.is_triangle() { 0.5 } else { 4.0 };
            assert!((area(&x) / exact - 1.0).abs() < 1e-14);
            for (load, share) in traction_load(&x, [1.0, -2.0, 3.0]).iter().zip(shares) {
                assert!((0..3).all(|i| (load[i] - [1.0, -2.0, 3.0][i] * share * exact).abs() < 1e-13));
            }
        }
    }

    #[test]
    fn a_plane_facet_with_a_curved_edge_has_its_exact_area() {
        // A parabola of height h over an edge takes 2/3 h of its length off.
        for (shape, square) in [(FacetShape::Triangle6, 0.5), (FacetShape::Quadrilateral8, 4.0)] {
            let mut x = facet(shape, |xi, eta| [xi, eta, 0.0]);
            x[shape.n_corners()][1] += 0.06;
            let length = norm(sub(x[1], x[0]));
            assert!((area(&x) - (square - 2.0 / 3.0 * 0.06 * length)).abs() < 1e-14);
        }
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
                let triangle = FacetShape::Triangle6;
                sum += area(&facet(triangle, |xi, eta| at(s + step * xi, z + step * eta)));
                sum += area(&facet(triangle, |xi, eta| at(s + step * (1.0 - xi), z + step * (1.0 - eta))));
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
        for shape in [FacetShape::Triangle6, FacetShape::Quadrilateral8] {
            let mut x = facet(shape, |xi, eta| [xi, eta, 0.0]);
            x.iter_mut().for_each(|x| add(x, 0.1, random.vector()));
            let mut rim = [0.0; 3];
            for (k, [start, end]) in shape.edges().enumerate() {
                let (a, b, m) = (x[start], x[end], x[shape.n_corners() + k]);
                let derivative = |s: f64| -> [f64; 3] {
                    std::array::from_fn(|i| (4.0 * s - 3.0) * a[i] + (4.0 * s - 1.0) * b[i] + (4.0 - 8.0 * s) * m[i])
                };
                for (p, s, weight) in [(a, 0.0, 1.0 / 6.0), (m, 0.5, 4.0 / 6.0), (b, 1.0, 1.0 / 6.0)] {
                    add(&mut rim, 0.5 * weight, cross(p, derivative(s)));
                }
            }
            assert!(norm(sub(area_vector(&x), rim)) < 1e-13);
        }
    }

    #[test]
    fn a_closed_curved_skin_encloses_the_volume_of_the_element_and_pressure_on_it_has_no_force_and_no_moment() {
        let mut random = Random::seeded(53);
        for shape in Shape::ALL.into_iter().flat_map(|shape| [shape; 10]) {
            let x = curved(shape, &mut random, 0.06);
            let (mut force, mut moment, mut flux) = ([0.0; 3], [0.0; 3], 0.0);
            for face in shape.faces() {
                let face: Vec<[f64; 3]> = face.iter().map(|&a| x[a]).collect();
                for (f, p) in pressure_load(&face, 1.0).into_iter().zip(face) {
                    add(&mut force, 1.0, f);
                    add(&mut moment, 1.0, cross(p, f));
                    flux -= dot(f, p) / 3.0; // volume = 1/3 integral of x . n dA
                }
            }
            assert!(norm(force) < 1e-13 && norm(moment) < 1e-13, "{shape:?}");
            assert!((flux / volume(shape, &x) - 1.0).abs() < 1e-12, "{shape:?}: volume, and normals outward");
        }
    }
}
