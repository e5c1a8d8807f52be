//! The families of elements of a brake, and what they assemble to.

use crate::Result;
use crate::assembly::{self, Connectivity, Elements, Joints, Prestress, Solids, System, TurningSolids, element_forces};
use crate::model::Model;
use crate::native::Comm;

use super::FullModel;

/// The families of elements of a brake.
pub struct Families<'a> {
    /// The solid elements.
    pub solids: Solids<'a>,
    /// Those of them that have the inertia forces of their rotation.
    pub turning: TurningSolids<'a>,
    /// The joints.
    pub joints: &'a Joints,
}

impl Families<'_> {
    /// Those that resist displacements and have mass: all but the inertia forces of rotations.
    pub fn list(&self) -> [&dyn Elements; 2] {
        [&self.solids, self.joints]
    }

    /// The inertia forces (N) of rotations at the nodes that this rank owns, under displacements (m): the centrifugal
    /// forces at `x + u`.
    pub fn inertia_forces(&self, owns: impl Fn(u32) -> bool, u: &[[f64; 3]]) -> Vec<(u32, [f64; 3])> {
        let mut forces = self.turning.centrifugal_forces();
        let displaced = |n: u32| u[n as usize];
        element_forces(&[&self.turning], |_| true, displaced, |n, force| forces.push((n, force.map(|f| -f))));
        forces.retain(|(node, _)| owns(*node));
        forces
    }
}

impl FullModel {
    /// The families of elements.
    ///
    /// # Errors
    /// [`crate::Error::Input`] where a part has no material.
    pub fn families(&self) -> Result<Families<'_>> {
        let solids = Solids::new(&self.model, &self.mesh)?;
        let turning = TurningSolids::new(solids.clone(), &self.model.rotations);
        Ok(Families { solids, turning, joints: &self.joints })
    }

    /// Assembles M, C, K and the load. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn assemble(&self, comm: &Comm, families: &Families) -> Result<System> {
        let turning = Some(&families.turning as &dyn Elements).filter(|_| !families.turning.is_none());
        let all: Vec<&dyn Elements> = families.list().into_iter().chain(turning).collect();
        let mut system = self.assemble_families(comm, &all)?;
        system.add_constant_load(&families.turning.centrifugal_forces())?;
        Ok(system)
    }

    /// As [`FullModel::assemble`], with the materials of another model. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Input`] where a part has no material; PETSc's.
    pub fn assemble_as(&self, comm: &Comm, other: &Model) -> Result<System> {
        let solids = Solids::new(other, &self.mesh)?;
        let turning = TurningSolids::new(solids.clone(), &other.rotations);
        self.assemble(comm, &Families { solids, turning, joints: &self.joints })
    }

    /// As [`FullModel::assemble`], of any families on the brake's nodes, without centrifugal loads. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn assemble_families(&self, comm: &Comm, families: &[&dyn Elements]) -> Result<System> {
        let contacts: [&dyn Connectivity; 1] = [&self.interface.gap_operator];
        let mut system = System::assemble(comm, &self.nodes, &self.held, families, &contacts)?;
        system.add_load(&self.loads)?;
        system.add_constant_load(&self.weights)?;
        system.add_constant_load(&assembly::forces_of_prescribed(families, &self.prescribed))?;
        Ok(system)
    }

    /// What makes the geometric stiffness of an equilibrium; none where the model has no prestress.
    ///
    /// # Errors
    /// [`crate::Error::Input`] where a part has no material.
    pub fn prestress(&self) -> Result<Option<Prestress<'_>>> {
        let of = || Ok(Prestress::new(Solids::new(&self.model, &self.mesh)?, &self.prescribed));
        self.model.has_prestress().then(of).transpose()
    }
}
