//! What the elements of a part have beside their elasticity and mass: the inertia forces of its rotation, and the
//! geometric stiffness of an equilibrium.
//!
//! ```text
//! rotating frame   C = 2 m_ab [Omega]x               K = m_ab [Omega]x^2        [Omega]x u = Omega x u
//! fixed frame      C = (h - h^T)_ab I                K = -s_ab I                ConvectiveInertia
//! both             f_a = -sum_b m_ab Omega x (Omega x (x_b - x_0))
//! ```
//!
//! C is skew, K symmetric and softens. The rotating frame is that of the mesh: Coriolis and centrifugal forces act on a
//! particle at `x + u`. In the fixed frame the material flows through the mesh
//! ([`ConvectiveInertia`](solid::ConvectiveInertia)). Both have the same centrifugal load, so that they have the same
//! equilibrium; their modes differ by the motion of the observer, `n Omega` for a wave of n lengths around.

use std::collections::BTreeMap;

use crate::Result;
use crate::algebra::cross;
use crate::element::solid::{self, spread};
use crate::model::{Inertia, Rotation};
use crate::native::{Matrix, Vector};

use super::{Connectivity, ElementMatrices, Elements, Solids, System, add_prescribed};

/// The elements whose parts have the inertia forces of their rotation.
pub struct TurningSolids<'a> {
    solids: Solids<'a>,
    /// Rotation of each mesh part that has inertia.
    rotations: Vec<Option<&'a Rotation>>,
    /// Numbers of the elements.
    elements: Vec<usize>,
    /// Whether a part of the whole model has inertia: the same on all ranks.
    has_any: bool,
}

impl<'a> TurningSolids<'a> {
    /// Those of the parts that have a rotation with inertia.
    pub fn new(solids: Solids<'a>, rotations: &'a [Rotation]) -> TurningSolids<'a> {
        let turning = rotations.iter().filter(|rotation| rotation.inertia != Inertia::None);
        let of_part = |name: &String| turning.clone().find(|rotation| rotation.part == *name);
        let rotations: Vec<Option<&Rotation>> = solids.mesh().parts.iter().map(of_part).collect();
        let has_any = rotations.iter().any(Option::is_some);
        let has_inertia = |e: &usize| rotations[solids.mesh().elements.get(*e).part as usize].is_some();
        let elements = if has_any { (0..solids.len()).filter(has_inertia).collect() } else { Vec::new() };
        TurningSolids { solids, rotations, elements, has_any }
    }

    /// Whether no part of the model has inertia.
    pub fn is_none(&self) -> bool {
        !self.has_any
    }

    fn rotation(&self, e: usize) -> &'a Rotation {
        let part = self.solids.mesh().elements.get(self.elements[e]).part;
        self.rotations[part as usize].expect("a family of parts that turn")
    }

    fn scalar_mass(&self, e: usize) -> Vec<f64> {
        let (mesh, e) = (self.solids.mesh(), self.elements[e]);
        let element = mesh.elements.get(e);
        let mut m = vec![0.0; element.nodes.len().pow(2)];
        let density = self.solids.part(e).material.density;
        solid::scalar_mass(element.shape(), &mesh.element_nodes(e), density, &mut m);
        m
    }

    /// The centrifugal forces (N) at the nodes of all elements that this rank has: complete at the nodes that it owns.
    pub fn centrifugal_forces(&self) -> Vec<(u32, [f64; 3])> {
        let mut forces = Vec::new();
        for e in 0..self.len() {
            let (rotation, m, n) = (self.rotation(e), self.scalar_mass(e), self.nodes(e).len());
            let omega = rotation.angular_velocity();
            let x = self.solids.mesh().element_nodes(self.elements[e]);
            let accelerations: Vec<[f64; 3]> = x.iter().map(|&x| cross(omega, rotation.velocity(x))).collect();
            for (a, &node) in self.nodes(e).iter().enumerate() {
                let force = |i: usize| -(0..n).map(|b| m[n * a + b] * accelerations[b][i]).sum::<f64>();
                forces.push((node, [0, 1, 2].map(force)));
            }
        }
        forces
    }
}

impl Connectivity for TurningSolids<'_> {
    fn len(&self) -> usize {
        self.elements.len()
    }

    fn nodes(&self, e: usize) -> &[u32] {
        self.solids.nodes(self.elements[e])
    }
}

impl Elements for TurningSolids<'_> {
    fn mass_couples_axes(&self) -> bool {
        false
    }

    fn is_gyroscopic(&self) -> bool {
        self.has_any
    }

    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        let (rotation, n) = (self.rotation(e), self.nodes(e).len());
        out.m.clear();
        out.g.clear();
        out.k.resize(9 * n * n, 0.0);
        out.c.resize(9 * n * n, 0.0);
        if rotation.inertia == Inertia::FixedFrame {
            let (mesh, number) = (self.solids.mesh(), self.elements[e]);
            let (x, density) = (mesh.element_nodes(number), self.solids.part(number).material.density);
            let shape = mesh.elements.get(number).shape();
            let inertia = solid::convective_inertia(shape, &x, density, |x| rotation.velocity(x));
            spread(&inertia.gyroscopic, &diagonal(1.0), &mut out.c);
            spread(&inertia.softening, &diagonal(-1.0), &mut out.k);
            return;
        }
        let (m, [coriolis, softening]) = (self.scalar_mass(e), coriolis_and_softening(rotation.angular_velocity()));
        spread(&m, &coriolis, &mut out.c);
        spread(&m, &softening, &mut out.k);
    }
}

fn diagonal(value: f64) -> [[f64; 3]; 3] {
    [[value, 0.0, 0.0], [0.0, value, 0.0], [0.0, 0.0, value]]
}

/// `2 [Omega]x` and `[Omega]x^2 = Omega Omega^T - Omega^2 I`.
fn coriolis_and_softening(omega: [f64; 3]) -> [[[f64; 3]; 3]; 2] {
    let [x, y, z] = omega;
    let coriolis = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]].map(|row| row.map(|value| 2.0 * value));
    let squared = x * x + y * y + z * z;
    let softening = |i: usize, j: usize| omega[i] * omega[j] - if i == j { squared } else { 0.0 };
    [coriolis, [0, 1, 2].map(|i| [0, 1, 2].map(|j| softening(i, j)))]
}

/// What makes the geometric stiffness of an equilibrium.
pub enum Prestress<'a> {
    /// The stress of that equilibrium.
    Stress(StressedSolids<'a>),
    /// `K_g` of another one, by rows, on the first displacements of a system on one rank, N/m.
    Frozen(&'a [f64]),
}

/// Solid elements that an equilibrium stresses.
pub struct StressedSolids<'a> {
    solids: Solids<'a>,
    /// Prescribed displacements, which the system's vectors lack: by node, m.
    prescribed: &'a BTreeMap<u32, [f64; 3]>,
}

impl<'a> Prestress<'a> {
    /// Of the solid elements of a model.
    pub fn new(solids: Solids<'a>, prescribed: &'a BTreeMap<u32, [f64; 3]>) -> Prestress<'a> {
        Prestress::Stress(StressedSolids { solids, prescribed })
    }

    /// `K += K_g(u)`, on K's own pattern. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add(&self, system: &System, u: &Vector, k: &mut Matrix) -> Result<()> {
        match self {
            Prestress::Stress(stressed) => stressed.add(system, u, k),
            Prestress::Frozen(stiffness) => {
                let mut indices = Vec::new();
                let nodes: Vec<u32> = (0..stiffness.len().isqrt().div_ceil(3) as u32).collect();
                system.dofs.indices_into(&nodes, &mut indices);
                indices.truncate(stiffness.len().isqrt());
                k.add_block(&indices, stiffness)?;
                k.finish()
            }
        }
    }
}

impl StressedSolids<'_> {
    fn add(&self, system: &System, u: &Vector, k: &mut Matrix) -> Result<()> {
        let mut nodal = system.nodal(&[u])?.remove(0);
        add_prescribed(&mut nodal, self.prescribed);
        let (mut dense, mut indices) = (Vec::new(), Vec::new());
        for e in 0..self.solids.len() {
            let nodes = self.solids.nodes(e);
            if nodes.iter().any(|&n| system.dofs.owns(n)) {
                self.geometric_stiffness(e, &nodal, &mut dense);
                indices.clear();
                system.dofs.indices_into(nodes, &mut indices);
                k.add_block(&indices, &dense)?;
            }
        }
        k.finish()
    }

    fn geometric_stiffness(&self, e: usize, nodal: &[[f64; 3]], out: &mut Vec<f64>) {
        let (mesh, nodes) = (self.solids.mesh(), self.solids.nodes(e));
        let u: Vec<[f64; 3]> = nodes.iter().map(|&n| nodal[n as usize]).collect();
        out.resize(9 * nodes.len().pow(2), 0.0);
        let elasticity = &self.solids.part(e).material.elasticity;
        solid::geometric_stiffness(mesh.elements.get(e).kind, &mesh.element_nodes(e), elasticity, &u, out);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::algebra::{dot, sub};
    use crate::contact::testing::model;
    use crate::element::ElementKind;
    use crate::mesh::Mesh;
    use crate::model::{EXAMPLE, Model, Part, Place, parse};

    const SPEED: f64 = 7.0;
    const THROUGH: [f64; 3] = [0.2, -0.1, 0.0];

    fn rotor(inertia: Inertia) -> (Model, Mesh) {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.2, 0.1], [0.1, 0.0, 0.9]];
        let x = ElementKind::C3D10.shape().straight(&corners);
        let mut mesh = Mesh { nodes: x, parts: vec!["disc".into(), "hub".into()], ..Mesh::default() };
        (0..2).for_each(|part| mesh.elements.push(ElementKind::C3D10, part, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]));
        let own = parse(EXAMPLE, "brake.toml".as_ref()).unwrap().parts;
        let part = |name: &str| Part { name: name.into(), ..own[0].clone() };
        let rotation = |part: &str, inertia: Inertia| Rotation {
            part: part.into(),
            axis: [0.0, 0.0, 1.0],
            through: THROUGH,
            speed: SPEED,
            inertia,
            place: Place::default(),
        };
        let rotations = vec![rotation("hub", Inertia::None), rotation("disc", inertia)];
        (Model { parts: vec![part("disc"), part("hub")], rotations, ..model(Vec::new(), false) }, mesh)
    }

    fn matrices(family: &TurningSolids) -> [DMatrix<f64>; 2] {
        let mut out = ElementMatrices { m: vec![1.0], g: vec![1.0], ..ElementMatrices::default() };
        family.matrices(0, &mut out);
        assert!(out.m.is_empty() && out.g.is_empty());
        [out.c, out.k].map(|values| DMatrix::from_row_slice(30, 30, &values))
    }

    #[test]
    fn parts_without_inertia_add_no_elements() {
        for (inertia, n) in [(Inertia::None, 0), (Inertia::FixedFrame, 1), (Inertia::RotatingFrame, 1)] {
            let (model, mesh) = rotor(inertia);
            let family = TurningSolids::new(Solids::new(&model, &mesh).unwrap(), &model.rotations);
            assert_eq!((family.len(), family.is_none(), family.is_gyroscopic()), (n, n == 0, n == 1), "{inertia:?}");
            assert_eq!(family.centrifugal_forces().len(), 10 * n);
        }
    }

    #[test]
    fn gyroscopic_terms_are_skew_and_softening_symmetric() {
        for inertia in [Inertia::FixedFrame, Inertia::RotatingFrame] {
            let (model, mesh) = rotor(inertia);
            let [c, k] = matrices(&TurningSolids::new(Solids::new(&model, &mesh).unwrap(), &model.rotations));
            assert!(c.norm() > 0.0 && c == -c.transpose(), "{inertia:?}");
            assert!((&k - k.transpose()).norm() < 1e-14 * k.norm(), "{inertia:?}");
            assert!(k.symmetric_eigenvalues().max() < 1e-12 * k.norm(), "{inertia:?}: softens");
        }
    }

    /// A particle of the rotating frame at `x + u` has the centrifugal force of its place, and moving along the radius
    /// the Coriolis force `-2 m Omega x v`.
    #[test]
    fn a_rigid_shift_in_the_rotating_frame_has_the_forces_of_a_particle() {
        let (model, mesh) = rotor(Inertia::RotatingFrame);
        let family = TurningSolids::new(Solids::new(&model, &mesh).unwrap(), &model.rotations);
        let [c, k] = matrices(&family);
        let shift = [0.3, 0.5, -0.4];
        let all = DVector::from_fn(30, |row, _| shift[row % 3]);
        let total = |forces: DVector<f64>| [0, 1, 2].map(|i| forces.iter().skip(i).step_by(3).sum::<f64>());
        let x = mesh.element_nodes(0);
        let mass = solid::mass_properties(ElementKind::C3D10.shape(), &x, model.parts[0].material.density);
        let close =
            |a: [f64; 3], b: [f64; 3]| assert!(dot(sub(a, b), sub(a, b)).sqrt() < 1e-9 * mass.mass * SPEED * SPEED);
        let centrifugal = |arm: [f64; 3]| [arm[0], arm[1], 0.0].map(|r| mass.mass * SPEED * SPEED * r);
        close(total(-k * &all), centrifugal(shift));
        close(total(-c * &all), [2.0 * mass.mass * SPEED * shift[1], -2.0 * mass.mass * SPEED * shift[0], 0.0]);
        let load =
            family.centrifugal_forces().into_iter().fold([0.0; 3], |sum, (_, f)| [0, 1, 2].map(|i| sum[i] + f[i]));
        close(load, centrifugal(sub(mass.centre(), THROUGH)));
    }
}
