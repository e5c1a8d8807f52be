//! Patch test: a cube of 48 elements under a linear displacement must be in equilibrium at every inner node.
//!
//! A linear field is in the element's space on any geometry, straight or curved, so strain and stress are constant and
//! exact at every point. The forces are then `f_a = sum_q w cof(J) grad N_a . stress`, whose integrand has degree 3 on
//! a curved element (and 1 on a straight one), and only its exact integral cancels at an inner node.

use super::{EDGES, is_inverted, stiffness, stiffness_14};
use crate::algebra::{dot, norm};
use crate::element::samples::{Random, triclinic};
use std::collections::BTreeMap;

type Kernel = fn(&[[f64; 3]; 10], &[[f64; 6]; 6], &mut [f64]);

/// Corners of the six tetrahedra of a cube (Kuhn's subdivision along the diagonal 0-7; corner bits are x, y, z).
const KUHN: [[usize; 4]; 6] = [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

struct Patch {
    nodes: Vec<[f64; 3]>,
    inner: Vec<bool>,
    tets: Vec<[usize; 10]>,
}

impl Patch {
    /// The unit cube in 2x2x2 cubes of six tetrahedra; nodes are points of the 5x5x5 grid of quarter steps.
    ///
    /// The inner corner is moved by `0.1` at random, its midsides follow, and then every midside moves by up to
    /// `offset`.
    fn new(random: &mut Random, offset: f64) -> Self {
        let mut numbers = BTreeMap::new();
        let mut tets = Vec::new();
        for cube in 0..8 {
            let corner = |bits: usize| [0, 1, 2].map(|i| 2 * (cube >> i & 1) + 2 * (bits >> i & 1));
            for corners in KUHN {
                let c = corners.map(corner);
                let midsides = EDGES.map(|[i, j]| [0, 1, 2].map(|k| (c[i][k] + c[j][k]) / 2));
                let grid: Vec<[usize; 3]> = c.into_iter().chain(midsides).collect();
                tets.push(std::array::from_fn(|a| {
                    let next = numbers.len();
                    *numbers.entry(grid[a]).or_insert(next)
                }));
            }
        }
        let mut patch = Patch { nodes: vec![[0.0; 3]; numbers.len()], inner: vec![false; numbers.len()], tets };
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
        for tet in self.tets.clone() {
            for (midside, [i, j]) in EDGES.iter().enumerate() {
                let (n, a, b) = (tet[4 + midside], self.nodes[tet[*i]], self.nodes[tet[*j]]);
                if !std::mem::replace(&mut bent[n], true) {
                    let shift = random.vector();
                    self.nodes[n] = std::array::from_fn(|k| 0.5 * (a[k] + b[k]) + offset * shift[k]);
                }
            }
        }
    }

    fn coordinates(&self, tet: &[usize; 10]) -> [[f64; 3]; 10] {
        tet.map(|n| self.nodes[n])
    }

    /// Largest force at an inner node over the largest force that an element puts on one, for a random linear field.
    fn residual(&self, random: &mut Random, kernel: Kernel) -> f64 {
        let d = triclinic(random);
        let h = [random.vector(), random.vector(), random.vector()];
        let mut force = vec![[0.0; 3]; self.nodes.len()];
        let mut scale = 0.0_f64;
        let mut k = [0.0; 900];
        for tet in &self.tets {
            let x = self.coordinates(tet);
            kernel(&x, &d, &mut k);
            let u: Vec<f64> = x.iter().flat_map(|&p| h.map(|row| dot(row, p))).collect();
            for (dof, row) in k.chunks_exact(30).enumerate() {
                let f: f64 = row.iter().zip(&u).map(|(k, u)| k * u).sum();
                force[tet[dof / 3]][dof % 3] += f;
                scale = scale.max(f.abs());
            }
        }
        let inner = force.iter().zip(&self.inner).filter(|(_, inner)| **inner);
        inner.map(|(f, _)| norm(*f)).fold(0.0, f64::max) / scale
    }
}

#[test]
fn the_patch_fills_the_cube_with_well_shaped_elements() {
    let patch = Patch::new(&mut Random::seeded(81), 0.0);
    assert_eq!((patch.nodes.len(), patch.tets.len()), (125, 48));
    assert_eq!(patch.inner.iter().filter(|inner| **inner).count(), 27);
    let volume: f64 = patch.tets.iter().map(|tet| super::volume(&patch.coordinates(tet))).sum();
    assert!((volume - 1.0).abs() < 1e-14);
    assert!(patch.tets.iter().all(|tet| !is_inverted(&patch.coordinates(tet))));
}

#[test]
fn distorted_straight_patch_is_in_equilibrium_with_four_points() {
    let mut random = Random::seeded(82);
    for _ in 0..5 {
        let residual = Patch::new(&mut random, 0.0).residual(&mut random, stiffness);
        assert!(residual < 1e-12, "{residual:e}");
    }
}

#[test]
fn curved_patch_is_in_equilibrium_with_fourteen_points() {
    let mut random = Random::seeded(83);
    for _ in 0..5 {
        let residual = Patch::new(&mut random, 0.02).residual(&mut random, stiffness_14);
        assert!(residual < 1e-12, "{residual:e}");
    }
}

#[test]
fn curved_patch_with_four_points_errs_with_the_square_of_the_offset() {
    // Offsets of 4 % and 2 % of an edge's length; the same random numbers, so the same shape twice as flat.
    let residual = |offset| {
        let mut random = Random::seeded(84);
        Patch::new(&mut random, offset).residual(&mut random, stiffness)
    };
    let (coarse, fine) = (residual(0.02), residual(0.01));
    assert!(coarse < 2e-3 && ((coarse / fine).log2() - 2.0).abs() < 0.2, "{coarse:e} {fine:e}");
}
