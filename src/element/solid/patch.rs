//! Patch test: a cube of several elements under a linear displacement must be in equilibrium at every inner node.
//!
//! A linear field is in the element's space on any geometry, straight or curved, so strain and stress are constant and
//! exact at every point. The forces are then `f_a = sum_q w cof(J) grad N_a . stress`, and only their exact integral
//! cancels at an inner node.

use super::{TETRAHEDRON_10_NODES, is_inverted, stiffness, volume};
use crate::algebra::{dot, norm};
use crate::element::samples::{Random, triclinic};
use crate::element::{ElementKind, Shape};
use std::collections::BTreeMap;

/// Corners of the tetrahedra, wedges or hexahedra that a cube is cut into; corner bits are x, y, z. Tetrahedra: Kuhn's
/// subdivision along the diagonal 0-7.
fn cuts(shape: Shape) -> &'static [&'static [usize]] {
    match shape.n_corners() {
        4 => &[&[0, 1, 3, 7], &[0, 3, 2, 7], &[0, 2, 6, 7], &[0, 6, 4, 7], &[0, 4, 5, 7], &[0, 5, 1, 7]],
        6 => &[&[0, 1, 3, 4, 5, 7], &[0, 3, 2, 4, 7, 6]],
        _ => &[&[0, 1, 3, 2, 4, 5, 7, 6]],
    }
}

struct Patch {
    shape: Shape,
    nodes: Vec<[f64; 3]>,
    inner: Vec<bool>,
    elements: Vec<Vec<usize>>,
}

impl Patch {
    /// The unit cube in 2x2x2 cubes; nodes are points of the 5x5x5 grid of quarter steps.
    ///
    /// The inner corner is moved by `0.1` at random, its midsides follow, and then every midside moves by up to
    /// `offset`.
    fn new(shape: Shape, random: &mut Random, offset: f64) -> Self {
        let mut numbers = BTreeMap::new();
        let mut elements = Vec::new();
        for cube in 0..8 {
            for corners in cuts(shape) {
                let corner = |bits: usize| [0, 1, 2].map(|i| (2 * (cube >> i & 1) + 2 * (bits >> i & 1)) as f64);
                let corners: Vec<[f64; 3]> = corners.iter().map(|&bits| corner(bits)).collect();
                let nodes = shape.straight(&corners).into_iter().map(|x| x.map(|x| x as usize));
                let number = nodes.map(|grid| {
                    let next = numbers.len();
                    *numbers.entry(grid).or_insert(next)
                });
                elements.push(number.collect());
            }
        }
        let mut patch =
            Patch { shape, nodes: vec![[0.0; 3]; numbers.len()], inner: vec![false; numbers.len()], elements };
        for (grid, &n) in &numbers {
            patch.nodes[n] = grid.map(|g| 0.25 * g as f64);
            patch.inner[n] = grid.iter().all(|&g| g > 0 && g < 4);
        }
        let centre = numbers[&[2, 2, 2]];
        patch.nodes[centre] = random.vector().map(|v| 0.5 + 0.1 * v);
        patch.bend(random, offset);
        patch
    }

    /// Midsides to the middle of their edges, then moved by up to `offset` (once each, on the surface too).
    fn bend(&mut self, random: &mut Random, offset: f64) {
        let mut bent = vec![false; self.nodes.len()];
        for element in self.elements.clone() {
            let straight = self.shape.straight(&self.coordinates(&element[..self.shape.n_corners()]));
            for (&n, middle) in element.iter().zip(straight).skip(self.shape.n_corners()) {
                if !std::mem::replace(&mut bent[n], true) {
                    let shift = random.vector();
                    self.nodes[n] = std::array::from_fn(|k| middle[k] + offset * shift[k]);
                }
            }
        }
    }

    fn coordinates(&self, nodes: &[usize]) -> Vec<[f64; 3]> {
        nodes.iter().map(|&n| self.nodes[n]).collect()
    }

    /// Largest force at an inner node over the largest force that an element puts on one, for a random linear field.
    fn residual(&self, random: &mut Random, kernel: impl Fn(&[[f64; 3]], &[[f64; 6]; 6], &mut [f64])) -> f64 {
        let d = triclinic(random);
        let h = [random.vector(), random.vector(), random.vector()];
        let mut force = vec![[0.0; 3]; self.nodes.len()];
        let mut scale = 0.0_f64;
        let n_dofs = 3 * self.shape.n_nodes();
        let mut k = vec![0.0; n_dofs * n_dofs];
        for element in &self.elements {
            let x = self.coordinates(element);
            kernel(&x, &d, &mut k);
            let u: Vec<f64> = x.iter().flat_map(|&p| h.map(|row| dot(row, p))).collect();
            for (dof, row) in k.chunks_exact(n_dofs).enumerate() {
                let f: f64 = row.iter().zip(&u).map(|(k, u)| k * u).sum();
                force[element[dof / 3]][dof % 3] += f;
                scale = scale.max(f.abs());
            }
        }
        let inner = force.iter().zip(&self.inner).filter(|(_, inner)| **inner);
        inner.map(|(f, _)| norm(*f)).fold(0.0, f64::max) / scale
    }
}

#[test]
fn patches_fill_the_cube_with_well_shaped_elements() {
    for shape in Shape::ALL {
        let patch = Patch::new(shape, &mut Random::seeded(81), 0.0);
        assert_eq!(patch.elements.len(), 8 * cuts(shape).len());
        let total: f64 = patch.elements.iter().map(|element| volume(shape, &patch.coordinates(element))).sum();
        assert!((total - 1.0).abs() < 1e-14, "{shape:?}");
        assert!(patch.elements.iter().all(|element| !is_inverted(shape, &patch.coordinates(element))));
    }
}

#[test]
fn distorted_straight_patches_of_all_kinds_are_in_equilibrium() {
    let mut random = Random::seeded(82);
    for kind in ElementKind::ALL.into_iter().flat_map(|kind| [kind; 3]) {
        let patch = Patch::new(kind.shape(), &mut random, 0.0);
        let residual = patch.residual(&mut random, |x, d, k| stiffness(kind, x, d, k));
        assert!(residual < 1e-12, "{kind:?} {residual:e}");
    }
}

#[test]
fn curved_patch_is_in_equilibrium_with_fourteen_points() {
    let mut random = Random::seeded(83);
    let fourteen = |x: &[[f64; 3]], d: &[[f64; 6]; 6], k: &mut [f64]| {
        let x = super::table::positions(x);
        super::stiffness::integrate::<10, 30, 14>(x, d, &TETRAHEDRON_10_NODES.mass, k);
    };
    for _ in 0..5 {
        let residual = Patch::new(Shape::Tetrahedron10, &mut random, 0.02).residual(&mut random, fourteen);
        assert!(residual < 1e-12, "{residual:e}");
    }
}

#[test]
fn curved_patch_with_four_points_errs_with_the_square_of_the_offset() {
    // Offsets of 4 % and 2 % of an edge's length; the same random numbers, so the same shape twice as flat.
    let residual = |offset| {
        let mut random = Random::seeded(84);
        let four = |x: &[[f64; 3]], d: &[[f64; 6]; 6], k: &mut [f64]| stiffness(ElementKind::C3D10, x, d, k);
        Patch::new(Shape::Tetrahedron10, &mut random, offset).residual(&mut random, four)
    };
    let (coarse, fine) = (residual(0.02), residual(0.01));
    assert!(coarse < 2e-3 && ((coarse / fine).log2() - 2.0).abs() < 0.2, "{coarse:e} {fine:e}");
}
