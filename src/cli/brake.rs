//! From a model file to what is analysed.

use std::path::Path;

use crate::assembly::{self, Connectivity, Connectors, Elements, Link, System, Tets};
use crate::contact::interface::Interface;
use crate::mesh::{self, Mesh};
use crate::model::{self, Model};
use crate::petsc::Comm;
use crate::{Error, Result};

/// A model with its mesh and contact interface, the same on every rank.
pub struct Brake {
    pub model: Model,
    pub mesh: Mesh,
    pub interface: Interface,
    pub loads: Vec<(u32, [f64; 3])>,
    pub held: Vec<[bool; 3]>,
    pub links: Vec<Link>,
}

/// The families of elements of a brake.
pub struct Families<'a> {
    pub tets: Tets<'a>,
    pub connectors: Connectors,
}

impl Families<'_> {
    pub fn list(&self) -> [&dyn Elements; 2] {
        [&self.tets, &self.connectors]
    }
}

impl Brake {
    /// Reads and checks model and mesh and finds the contact points. Collective: all ranks fail together.
    pub fn read(comm: &Comm, path: &Path) -> Result<Brake> {
        comm.agree(Brake::read_alone(path))
    }

    fn read_alone(path: &Path) -> Result<Brake> {
        let model = model::read(path)?;
        let mesh = mesh::read(&model.mesh_file, model.mesh_unit)?;
        model.check_against(&mesh)?;
        let interface = Interface::build(&model, &mesh)?;
        let loads = assembly::loads(&model, &mesh)?;
        let held = assembly::held(&model, &mesh)?;
        let links = assembly::links(&model, &mesh)?;
        Ok(Brake { model, mesh, interface, loads, held, links })
    }

    pub fn families(&self) -> Result<Families<'_>> {
        Ok(Families { tets: Tets::new(&self.model, &self.mesh)?, connectors: Connectors::new(&self.links, &self.mesh) })
    }

    /// Assembles M, C, K and the load. Collective.
    pub fn assemble(&self, comm: &Comm, families: &Families) -> Result<System> {
        let contacts: [&dyn Connectivity; 1] = [&self.interface.trace];
        let mut system = System::assemble(comm, &self.held, &families.list(), &contacts)?;
        system.add_load(&self.loads)?;
        Ok(system)
    }

    /// The friction values to analyse: the command line's, else the model's sweep, else the swept pairs' own.
    pub fn frictions(&self, asked: Option<&super::Frictions>) -> Result<Vec<f64>> {
        if let Some(list) = asked {
            return Ok(list.0.clone());
        }
        if !self.model.frictions.is_empty() {
            return Ok(self.model.frictions.clone());
        }
        let mut own = self.interface.pairs.iter().filter(|pair| pair.swept).map(|pair| pair.friction);
        own.next().map(|mu| vec![mu]).ok_or_else(|| {
            Error::input(format!(
                "{}: no contact pair slides, so there is no friction to sweep",
                self.model.file.display()
            ))
        })
    }
}
