//! A model's brake as what a command is run on.

use num_complex::Complex64;

use crate::assembly::System;
use crate::contact::{Interface, Response};
use crate::equilibrium::Equilibrium;
use crate::native::{Comm, Vector};
use crate::output::contact_surface::{ContactSurface, Fields};
use crate::output::folder::Folder;
use crate::results::{About, ContactFaces, Part};
use crate::stability::Complex;
use crate::sweep::{Brake, Source, Sweep, digest};
use crate::{Error, Result};

use super::motion::{Motion, NodeMotion};
use super::reduced::ReducedBrake;
use super::state::{self, State};
use super::subject::{self, Drawn, Subject, Told};

impl Subject for Brake {
    fn about(&self, comm: &Comm) -> Result<About> {
        let material =
            |name: &String| self.model.parts.iter().find(|part| part.name == *name).map(|p| p.material.name.clone());
        let part = |(i, name): (usize, &String)| Part {
            name: name.clone(),
            material: material(name).unwrap_or_default(),
            mass: self.part_properties(comm, i).mass,
        };
        let parts = self.mesh.parts.iter().enumerate().map(part).collect();
        let n_tets = comm.sum(self.own_tets().count() as f64) as usize;
        let [model_digest, mesh_digest] = [&self.model.file, &self.model.mesh_file]
            .map(|file| comm.agree(if comm.is_root() { digest(file) } else { Ok(String::new()) }));
        let file = &self.model.file;
        let text = comm.agree(std::fs::read_to_string(file).map_err(Error::io(file)))?;
        Ok(About {
            title: self.model.title.clone(),
            model: self.model.file.display().to_string(),
            model_digest: model_digest?,
            model_text: text,
            mesh: self.model.mesh_file.display().to_string(),
            mesh_digest: mesh_digest?,
            n_nodes: self.nodes.n_global(),
            n_tets,
            parts,
            pairs: subject::pairs(&self.interface),
            ..About::default()
        })
    }

    fn interface(&self) -> &Interface {
        &self.interface
    }

    fn band(&self, asked: Option<[f64; 2]>) -> Result<[f64; 2]> {
        Ok(asked.unwrap_or(self.model.band))
    }

    fn friction_damping(&self) -> bool {
        self.model.friction_damping
    }

    fn frictions(&self, asked: Option<&[f64]>) -> Result<Vec<f64>> {
        Brake::frictions(self, asked)
    }

    fn assemble(&self, comm: &Comm) -> Result<System> {
        Brake::assemble(self, comm, &self.families()?)
    }

    fn motion<'s>(&'s self, system: &'s System) -> Result<Box<dyn Motion + 's>> {
        Ok(Box::new(NodeMotion::new(self.boundary(system.k.comm(), system), system)?))
    }

    fn contact_faces(&self) -> ContactFaces {
        ContactSurface::new(&self.mesh, &self.interface, &[]).faces(&self.mesh)
    }

    fn contact_fields(&self, responses: &[Response]) -> (Vec<f64>, Vec<i32>) {
        let Fields { pressure, status, .. } = ContactSurface::new(&self.mesh, &self.interface, responses).fields;
        (pressure, status)
    }

    fn tell(&self, folder: Option<&Folder>, system: &System, equilibrium: &Equilibrium) -> Result<Told> {
        let (found, comm) = (State::new(self, &self.families()?, system, equilibrium)?, system.k.comm());
        found.write(comm, folder, self, &equilibrium.responses)?;
        Ok(Told { checks: found.checks(comm, self), pairs: found.balance.pairs })
    }

    fn draw(&self, folder: Option<&Folder>, system: &System, friction: f64, drawn: &Drawn) -> Result<()> {
        state::write_mode(folder, self, system, friction, (drawn.number, drawn.mode))
    }

    fn explain(
        &self,
        sweep: &mut Sweep,
        equilibrium: &Equilibrium,
        mode: (Complex64, Complex),
        left: Complex,
    ) -> Result<Vec<Source>> {
        Brake::explain(self, sweep, equilibrium, mode, Some(left))
    }

    fn reduce(&self, system: &System, equilibrium: &Equilibrium) -> Result<Box<dyn Subject>> {
        let limit = self.reduction_limit();
        let (element, surface, _) = Brake::reduce(self, system.k.comm(), system, equilibrium, limit, &mut |_| ())?;
        Ok(Box::new(ReducedBrake::new(&self.model.file, element, surface, None, 1.0)))
    }

    fn rows(&self, system: &System) -> Vec<String> {
        let row = |node: u32| {
            let ([x, y, z], number) = (self.mesh.nodes[node as usize], self.nodes.labels()[node as usize] + 1);
            let free = (0..3).filter(move |&i| system.dofs.node_dofs(node)[i] >= 0);
            free.map(move |i| format!("node,{number},{},{x:e},{y:e},{z:e}", ["x", "y", "z"][i]))
        };
        system.dofs.owned_nodes().flat_map(row).collect()
    }

    fn draw_last(&self, folder: Option<&Folder>, system: &System, u: &Vector) -> Result<String> {
        state::write_last(folder, self, system, u)?;
        let ending = if system.k.comm().size() == 1 { "vtu" } else { "pvtu" };
        Ok(format!("{}.{ending}", state::LAST_STATE))
    }
}
