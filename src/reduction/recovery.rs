//! From the coordinates of a super-element back to the brake: its outer surface moves by `u = T q`.

use crate::Result;
use crate::assembly::{Boundary, System};
use crate::petsc::Block;

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
    /// The displacements (m) of the surface's nodes under generalised coordinates.
    ///
    /// # Panics
    /// Where there are fewer coordinates than the basis has.
    pub fn displacements(&self, q: &[f64]) -> Vec<[f64; 3]> {
        let mut u = vec![[0.0; 3]; self.nodes.len()];
        for (column, &q) in self.basis.chunks_exact(3 * self.nodes.len()).zip(q) {
            for (value, &t) in u.as_flattened_mut().iter_mut().zip(column) {
                *value += q * f64::from(t);
            }
        }
        u
    }

    /// The surface of a mesh with the basis of a reduction there; the root has the basis, other ranks have none. Collective.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_moves_by_its_coordinates() {
        let mut surface = OuterSurface { nodes: vec![[0.0; 3]; 5], ..OuterSurface::default() };
        surface.basis = (0..30).map(|i| i as f32).collect();
        let u = surface.displacements(&[2.0, -1.0]);
        assert_eq!(u[1], [2.0 * 3.0 - 18.0, 2.0 * 4.0 - 19.0, 2.0 * 5.0 - 20.0]);
    }
}
