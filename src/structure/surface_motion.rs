//! How the outer surface moves under a vector of the system, full or reduced.

use ndarray::{Array2, ArrayView2};

use crate::Result;
use crate::assembly::{Boundary, Displacements, DofMap, System};
use crate::mesh::{Mesh, Numbering};
use crate::native::{Comm, Vector};
use crate::reduction::recovery::OuterSurface;
use crate::results::{Surface, spread};

/// Samples of a surface, about.
const N_SAMPLES: usize = 2000;

/// From vectors of a system to displacements x, y, z of the outer surface's nodes one after the other (m), on the root.
pub struct SurfaceMotion<'a> {
    surface: Surface,
    map: Map<'a>,
}

/// The map from a vector to displacements.
enum Map<'a> {
    /// Entries of the vector are displacements.
    Nodes { samples: Displacements, all: Displacements },
    /// Entries are coordinates `q` of a super-element: `u = basis^T q`.
    Coordinates {
        system: &'a System,
        outer: &'a OuterSurface,
        /// A row a coordinate: displacements of the samples for a unit of it; made when it is first used.
        basis: Option<Array2<f32>>,
    },
}

impl<'a> SurfaceMotion<'a> {
    /// The motion of a mesh's boundary. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn of_nodes(boundary: Boundary, system: &System) -> Result<SurfaceMotion<'a>> {
        let chosen = spread(&boundary.nodes, &boundary.triangles, &boundary.part, N_SAMPLES);
        let samples = boundary.follow(system, chosen.iter().map(|&n| n as usize))?;
        let all = boundary.follow(system, 0..boundary.nodes.len())?;
        let Boundary { nodes, triangles, part, .. } = boundary;
        let surface = Surface { nodes, triangles, part, samples: chosen };
        Ok(SurfaceMotion { surface, map: Map::Nodes { samples, all } })
    }

    /// The motion that the coordinates of a super-element make of its surface, whose basis the root has.
    pub fn of_coordinates(outer: &'a OuterSurface, system: &'a System) -> SurfaceMotion<'a> {
        let samples = spread(&outer.nodes, &outer.triangles, &outer.part, N_SAMPLES);
        let surface = Surface { samples, ..without_samples(outer) };
        SurfaceMotion { surface, map: Map::Coordinates { system, outer, basis: None } }
    }

    /// The surface, with its samples.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Displacements of the samples in several vectors. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn of_samples(&mut self, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>> {
        match &mut self.map {
            Map::Nodes { samples, .. } => vectors.iter().map(|vector| samples.of(vector)).collect(),
            Map::Coordinates { system, outer, basis } => of_coordinates(system, vectors, |coordinates| {
                times_basis(coordinates, basis.get_or_insert_with(|| sampled(outer, &self.surface.samples)))
            }),
        }
    }

    /// Displacements of all nodes in several vectors. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn of_all(&mut self, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>> {
        match &mut self.map {
            Map::Nodes { all, .. } => vectors.iter().map(|vector| all.of(vector)).collect(),
            Map::Coordinates { system, outer, .. } => of_coordinates(system, vectors, |coordinates| {
                let sets: Vec<&[f64]> = coordinates.iter().map(Vec::as_slice).collect();
                outer.displacements(&sets).into_iter().map(Vec::into_flattened).collect()
            }),
        }
    }
}

/// The outer surface of a mesh of which each rank has a piece. Collective.
pub(super) fn of_mesh(comm: &Comm, mesh: &Mesh, nodes: &Numbering) -> Surface {
    let dofs = DofMap::new(nodes, &vec![[false; 3]; nodes.n_local()]);
    let Boundary { nodes, triangles, part, .. } = Boundary::new(comm, mesh, nodes, &dofs);
    Surface { nodes, triangles, part, samples: Vec::new() }
}

/// The outer surface of a super-element.
pub(super) fn without_samples(outer: &OuterSurface) -> Surface {
    let OuterSurface { nodes, triangles, part, .. } = outer;
    Surface { nodes: nodes.clone(), triangles: triangles.clone(), part: part.clone(), samples: Vec::new() }
}

/// What the root makes of the coordinates; nothing on other ranks. Collective.
fn of_coordinates(
    system: &System,
    vectors: &[&Vector],
    displacements: impl FnOnce(&[Vec<f64>]) -> Vec<Vec<f64>>,
) -> Result<Vec<Vec<f64>>> {
    let coordinates = coordinates(system, vectors)?;
    Ok(if is_root(system) { displacements(&coordinates) } else { vec![Vec::new(); vectors.len()] })
}

/// The columns of a surface's basis that move its samples.
fn sampled(outer: &OuterSurface, samples: &[u32]) -> Array2<f32> {
    let width = 3 * outer.nodes.len();
    let entry = |(q, i): (usize, usize)| outer.basis[q * width + 3 * samples[i / 3] as usize + i % 3];
    Array2::from_shape_fn((outer.basis.len() / width.max(1), 3 * samples.len()), entry)
}

/// `u = basis^T q` for several q, in single precision.
fn times_basis(coordinates: &[Vec<f64>], basis: &Array2<f32>) -> Vec<Vec<f64>> {
    let n = basis.nrows();
    // The last node of the system may have fewer coordinates than three.
    let q: Vec<f32> = coordinates.iter().flat_map(|q| &q[..n]).map(|&x| x as f32).collect();
    let q = ArrayView2::from_shape((coordinates.len(), n), &q).expect("n coordinates a vector");
    q.dot(basis).rows().into_iter().map(|row| row.iter().map(|&x| f64::from(x)).collect()).collect()
}

/// The generalised coordinates of several vectors; constrained ones are zero. Collective.
///
/// # Errors
/// PETSc's.
pub fn coordinates(system: &System, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>> {
    Ok(system.nodal(vectors)?.into_iter().map(|nodes| nodes.as_flattened().to_vec()).collect())
}

fn is_root(system: &System) -> bool {
    Comm::is_root(system.k.comm())
}
