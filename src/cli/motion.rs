//! How the outer surface of a brake moves in a mode, whatever its equations are.

use ndarray::{Array2, ArrayView2};

use crate::Result;
use crate::assembly::{Boundary, Displacements, System};
use crate::native::{Comm, Vector};
use crate::reduction::recovery::OuterSurface;
use crate::results::{ModeData, Shape, Surface, largest, spread};
use crate::stability::Mode;

/// Samples of a surface, about.
const SAMPLES: usize = 2000;

/// From vectors of a system to displacements x, y, z of nodes one after the other (m), on the root.
pub trait Motion {
    /// The surface, with its samples.
    fn surface(&self) -> &Surface;
    /// Displacements of the samples in several vectors. Collective.
    fn of_samples(&mut self, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>>;
    /// Displacements of all nodes in several vectors. Collective.
    fn of_all(&mut self, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>>;
}

/// Modes as plain data; those of which `is_drawn` is true have a shape on the whole surface. Collective.
pub fn plain(motion: &mut dyn Motion, modes: &[&Mode], is_drawn: impl Fn(&Mode) -> bool) -> Result<Vec<ModeData>> {
    let vectors: Vec<&Vector> = modes.iter().flat_map(|mode| [&mode.re, &mode.im]).collect();
    let samples = motion.of_samples(&vectors)?;
    let drawn: Vec<&&Mode> = modes.iter().filter(|mode| is_drawn(mode)).collect();
    let vectors: Vec<&Vector> = drawn.iter().flat_map(|mode| [&mode.re, &mode.im]).collect();
    let all = if vectors.is_empty() { Vec::new() } else { motion.of_all(&vectors)? };
    let mut wholes = all.chunks_exact(2);
    let whole = |mode: &&Mode| if is_drawn(mode) { wholes.next() } else { None };
    let wholes: Vec<Option<&[Vec<f64>]>> = modes.iter().map(whole).collect();
    Ok(modes
        .iter()
        .zip(samples.chunks_exact(2))
        .zip(wholes)
        .map(|((mode, samples), whole)| one(mode, samples, whole))
        .collect())
}

/// A mode by its displacements at the samples and, where it is drawn, on the whole surface.
fn one(mode: &Mode, samples: &[Vec<f64>], whole: Option<&[Vec<f64>]>) -> ModeData {
    let known = whole.unwrap_or(samples);
    let divisor = largest(&known[0], &known[1]);
    ModeData {
        lambda: mode.lambda,
        backward_error: mode.backward_error,
        unstable: mode.is_unstable(),
        sampled: Shape::over(&samples[0], &samples[1], divisor),
        shape: whole.map(|whole| Shape::over(&whole[0], &whole[1], divisor)),
        sources: Vec::new(),
    }
}

/// The motion of a mesh's nodes.
pub struct NodeMotion {
    surface: Surface,
    samples: Displacements,
    all: Displacements,
}

impl NodeMotion {
    /// Prepares to follow a surface. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(boundary: Boundary, system: &System) -> Result<NodeMotion> {
        let chosen = spread(&boundary.nodes, &boundary.triangles, &boundary.part, SAMPLES);
        let samples = boundary.follow(system, chosen.iter().map(|&n| n as usize))?;
        let all = boundary.follow(system, 0..boundary.nodes.len())?;
        let Boundary { nodes, triangles, part, .. } = boundary;
        Ok(NodeMotion { surface: Surface { nodes, triangles, part, samples: chosen }, samples, all })
    }
}

impl Motion for NodeMotion {
    fn surface(&self) -> &Surface {
        &self.surface
    }

    fn of_samples(&mut self, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>> {
        vectors.iter().map(|vector| self.samples.of(vector)).collect()
    }

    fn of_all(&mut self, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>> {
        vectors.iter().map(|vector| self.all.of(vector)).collect()
    }
}

/// The motion that the coordinates of a super-element make of its surface.
pub struct ReducedMotion<'a> {
    system: &'a System,
    outer: &'a OuterSurface,
    surface: Surface,
    /// A row a coordinate: displacements of the samples for a unit of it.
    basis: Array2<f32>,
}

impl<'a> ReducedMotion<'a> {
    /// Prepares to follow the surface of a super-element, whose basis the root has.
    pub fn new(outer: &'a OuterSurface, system: &'a System) -> ReducedMotion<'a> {
        let samples = spread(&outer.nodes, &outer.triangles, &outer.part, SAMPLES);
        let width = 3 * outer.nodes.len();
        let n = if is_root(system) { outer.basis.len() / width.max(1) } else { 0 };
        let entry = |(q, i): (usize, usize)| outer.basis[q * width + 3 * samples[i / 3] as usize + i % 3];
        let basis = Array2::from_shape_fn((n, 3 * samples.len()), entry);
        let OuterSurface { nodes, triangles, part, .. } = outer;
        let surface = Surface { nodes: nodes.clone(), triangles: triangles.clone(), part: part.clone(), samples };
        ReducedMotion { system, outer, surface, basis }
    }
}

impl Motion for ReducedMotion<'_> {
    fn surface(&self) -> &Surface {
        &self.surface
    }

    fn of_samples(&mut self, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>> {
        let coordinates = coordinates(self.system, vectors)?;
        if !is_root(self.system) {
            return Ok(vec![Vec::new(); vectors.len()]);
        }
        let n = self.basis.nrows();
        // The last node of the system may have fewer coordinates than three.
        let q: Vec<f32> = coordinates.iter().flat_map(|q| &q[..n]).map(|&x| x as f32).collect();
        let q = ArrayView2::from_shape((vectors.len(), n), &q).expect("as many as there are");
        let u = q.dot(&self.basis);
        Ok(u.rows().into_iter().map(|row| row.iter().map(|&x| f64::from(x)).collect()).collect())
    }

    fn of_all(&mut self, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>> {
        let coordinates = coordinates(self.system, vectors)?;
        if !is_root(self.system) {
            return Ok(vec![Vec::new(); vectors.len()]);
        }
        let sets: Vec<&[f64]> = coordinates.iter().map(Vec::as_slice).collect();
        Ok(self.outer.displacements(&sets).into_iter().map(Vec::into_flattened).collect())
    }
}

/// The generalised coordinates, of which held ones are zero. Collective.
///
/// # Errors
/// PETSc's.
pub fn coordinates(system: &System, vectors: &[&Vector]) -> Result<Vec<Vec<f64>>> {
    Ok(system.nodal(vectors)?.into_iter().map(|nodes| nodes.as_flattened().to_vec()).collect())
}

fn is_root(system: &System) -> bool {
    Comm::is_root(system.k.comm())
}
