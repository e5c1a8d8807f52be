//! From the coordinates of a super-element back to the brake: its outer surface moves by `u = T q`.

use multiversion::multiversion;

use crate::Result;
use crate::assembly::{Boundary, System};
use crate::native::Block;

/// Displacements summed up at a time, and terms that are summed in single precision.
const STRIP: usize = 16384;
const TERMS: usize = 16;

/// The outer surface of all parts, in triangles between the corners of the facets, and how it moves.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OuterSurface {
    /// Coordinates of its nodes, m.
    pub nodes: Vec<[f64; 3]>,
    /// Triangles, turning so that their normals point out.
    pub triangles: Vec<[u32; 3]>,
    /// Part of each triangle, an index into `parts`.
    pub part: Vec<i32>,
    /// Names of the parts.
    pub parts: Vec<String>,
    /// Displacements x, y, z of all nodes for a unit of each coordinate, one coordinate after the other.
    pub basis: Vec<f32>,
}

impl OuterSurface {
    /// The displacements (m) of the surface's nodes under several sets of generalised coordinates, in one pass over the
    /// basis.
    ///
    /// # Panics
    /// Where there are fewer coordinates than the basis has.
    pub fn displacements(&self, sets: &[&[f64]]) -> Vec<Vec<[f64; 3]>> {
        let width = 3 * self.nodes.len();
        let mut all = vec![vec![[0.0; 3]; self.nodes.len()]; sets.len()];
        for first in (0..width).step_by(STRIP) {
            let strip = first..(first + STRIP).min(width);
            // The basis has single precision; sums over many coordinates need more.
            for (part, columns) in self.basis.chunks(TERMS * width).enumerate() {
                for (u, q) in all.iter_mut().zip(sets) {
                    let mut sum = [0.0_f32; STRIP];
                    for (column, &q) in columns.chunks_exact(width).zip(&q[part * TERMS..]) {
                        add_scaled(&mut sum, q as f32, &column[strip.clone()]);
                    }
                    let u = &mut u.as_flattened_mut()[strip.clone()];
                    u.iter_mut().zip(&sum).for_each(|(u, &sum)| *u += f64::from(sum));
                }
            }
        }
        all
    }

    /// The surface of a mesh with the basis of a reduction there; the root has the basis, other ranks have none.
    /// Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(boundary: Boundary, parts: &[String], system: &System, basis: &Block) -> Result<OuterSurface> {
        let mut displacements = boundary.follow(system, 0..boundary.nodes.len())?;
        let mut columns = Vec::new();
        for j in 0..basis.n_columns() {
            columns.extend(displacements.of(&basis.vector(j)?)?.into_iter().map(|u| u as f32));
        }
        let Boundary { nodes, triangles, part, .. } = boundary;
        Ok(OuterSurface { nodes, triangles, part, parts: parts.to_vec(), basis: columns })
    }
}

/// `sum += q column`
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2", "aarch64+neon"))]
fn add_scaled(sum: &mut [f32], q: f32, column: &[f32]) {
    sum.iter_mut().zip(column).for_each(|(sum, t)| *sum += q * t);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_moves_by_its_coordinates() {
        let mut surface = OuterSurface { nodes: vec![[0.0; 3]; 5], ..OuterSurface::default() };
        surface.basis = (0..30).map(|i| i as f32).collect();
        let u = surface.displacements(&[&[2.0, -1.0], &[0.0, 1.0]]);
        assert_eq!(u[0][1], [2.0 * 3.0 - 18.0, 2.0 * 4.0 - 19.0, 2.0 * 5.0 - 20.0]);
        assert_eq!(u[1][1], [18.0, 19.0, 20.0]);
    }

    #[test]
    fn sums_of_many_terms_keep_single_precision() {
        let n = 1000;
        let mut surface = OuterSurface { nodes: vec![[0.0; 3]; 6000], ..OuterSurface::default() };
        surface.basis = (0..18000 * n).map(|i| ((i % 7) as f32 - 3.0) / 3.0).collect();
        let q: Vec<f64> = (0..n).map(|j| (j as f64).sin()).collect();
        let u = &surface.displacements(&[&q])[0];
        for i in [0, 16383, 16384, 17999] {
            let exact: f64 = q.iter().zip(surface.basis.chunks(18000)).map(|(q, t)| q * f64::from(t[i])).sum();
            assert!((u.as_flattened()[i] - exact).abs() < 1e-5 * exact.abs().max(1.0), "{i}");
        }
    }
}
