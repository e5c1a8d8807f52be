//! The solid elements of a model on its mesh, by part.

use crate::element::solid;
use crate::mesh::Mesh;
use crate::model::viscoelastic::ViscoelasticLaw;
use crate::model::{Model, Part};
use crate::{Error, Result};

use super::{Connectivity, ElementMatrices, Elements};

/// The solid elements of a mesh with the materials of their parts.
#[derive(Clone)]
pub struct Solids<'a> {
    mesh: &'a Mesh,
    /// Model part of each mesh part.
    parts: Vec<&'a Part>,
    /// The viscoelastic laws of the materials, each once.
    laws: Vec<ViscoelasticLaw>,
    /// For each mesh part the number of its law.
    law_of_part: Vec<Option<usize>>,
}

impl<'a> Solids<'a> {
    /// Matches the mesh's parts with the model's by name.
    ///
    /// # Errors
    /// [`Error::Input`] where a part of the mesh is not in the model.
    pub fn new(model: &'a Model, mesh: &'a Mesh) -> Result<Solids<'a>> {
        let part = |name: &String| {
            model.parts.iter().find(|part| part.name == *name).ok_or_else(|| {
                Error::input(format!("{}: the mesh's part {name:?} has no material", model.file.display()))
            })
        };
        let parts: Vec<&Part> = mesh.parts.iter().map(part).collect::<Result<_>>()?;
        let mut laws: Vec<ViscoelasticLaw> = Vec::new();
        let mut number = |law: &ViscoelasticLaw| {
            laws.iter().position(|known| known == law).unwrap_or_else(|| {
                laws.push(law.clone());
                laws.len() - 1
            })
        };
        let law_of_part = parts.iter().map(|part| part.material.viscoelastic.as_ref().map(&mut number)).collect();
        Ok(Solids { mesh, parts, laws, law_of_part })
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// Von Mises stress (Pa) of the mean stress of element `e`, for nodal displacements `u` (m).
    pub fn von_mises(&self, e: usize, u: &[[f64; 3]]) -> f64 {
        let element = self.mesh.elements.get(e);
        let displacements: Vec<[f64; 3]> = element.nodes.iter().map(|&n| u[n as usize]).collect();
        let elasticity = &self.part(e).material.elasticity;
        let stress = solid::mean_stress(element.kind, &self.mesh.element_nodes(e), elasticity, &displacements);
        solid::von_mises(&stress)
    }

    /// The elements of a part of the mesh, by its place in the mesh's list.
    pub fn of_part(&self, part: usize) -> PartSolids<'_> {
        let members = (0..self.len()).filter(|&e| self.mesh.elements.get(e).part as usize == part).collect();
        PartSolids { solids: self, members }
    }

    /// The parts of the model in the mesh's order.
    pub fn parts(&self) -> &[&'a Part] {
        &self.parts
    }

    /// Model part of element `e`.
    pub fn part(&self, e: usize) -> &'a Part {
        self.parts[self.mesh.elements.get(e).part as usize]
    }
}

/// The solid elements of one part.
pub struct PartSolids<'a> {
    solids: &'a Solids<'a>,
    members: Vec<usize>,
}

impl Connectivity for PartSolids<'_> {
    fn len(&self) -> usize {
        self.members.len()
    }

    fn nodes(&self, e: usize) -> &[u32] {
        self.solids.nodes(self.members[e])
    }
}

impl Elements for PartSolids<'_> {
    fn mass_couples_axes(&self) -> bool {
        self.solids.mass_couples_axes()
    }

    fn has_structural_damping(&self) -> bool {
        self.solids.has_structural_damping()
    }

    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        self.solids.matrices(self.members[e], out);
    }
}

impl Connectivity for Solids<'_> {
    fn len(&self) -> usize {
        self.mesh.elements.len()
    }

    fn nodes(&self, e: usize) -> &[u32] {
        self.mesh.elements.get(e).nodes
    }
}

impl Elements for Solids<'_> {
    fn mass_couples_axes(&self) -> bool {
        false
    }

    fn has_structural_damping(&self) -> bool {
        self.parts.iter().any(|part| part.material.loss_factor != 0.0)
    }

    fn viscoelastic_laws(&self) -> &[ViscoelasticLaw] {
        &self.laws
    }

    fn law_of(&self, e: usize) -> Option<usize> {
        self.law_of_part[self.mesh.elements.get(e).part as usize]
    }

    /// `C = alpha M + beta K` with the part's own coefficients, `G = g K` with its material's loss factor; the mass
    /// does not couple axes.
    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        let (kind, x, part) = (self.mesh.elements.get(e).kind, self.mesh.element_nodes(e), self.part(e));
        let n = x.len();
        out.k.resize(9 * n * n, 0.0);
        out.m.resize(n * n, 0.0);
        solid::stiffness(kind, &x, &part.material.elasticity, &mut out.k);
        solid::scalar_mass(kind.shape(), &x, part.material.density, &mut out.m);
        let loss_factor = part.material.loss_factor;
        out.g.clear();
        if loss_factor != 0.0 {
            out.g.extend(out.k.iter().map(|k| loss_factor * k));
        }
        let (alpha, beta) = (part.rayleigh.alpha, part.rayleigh.beta);
        out.c.clear();
        if alpha == 0.0 && beta == 0.0 {
            return;
        }
        out.c.extend(out.k.iter().map(|k| beta * k));
        for a in 0..n {
            for b in 0..n {
                (0..3).for_each(|i| out.c[3 * n * (3 * a + i) + 3 * b + i] += alpha * out.m[n * a + b]);
            }
        }
    }
}
