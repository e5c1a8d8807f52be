//! From a brake at its equilibrium to a super-element.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use nalgebra::DMatrix;

use crate::Result;
use crate::assembly::{Elements, Solids, System};
use crate::equilibrium::Equilibrium;
use crate::model::{self, LoadKind, Model};
use crate::native::{Block, Comm, Mck};
use crate::reduction::craig_bampton::{self, Costs, Event, Structure};
use crate::reduction::galerkin;
use crate::reduction::part_samples::{PartSamples, SampleReport};
use crate::reduction::parts::{MatricesByPart, PartMatrices, Place};
use crate::reduction::projection;
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::{Origin, Sample, SuperElement};

use super::{FullModel, digest};

impl FullModel {
    /// Reduces the brake about an equilibrium to its sliding contacts, the mean motions of its loaded sets and its
    /// fixed-interface modes below `limit` (Hz). The surface's basis is on the root alone. Collective.
    ///
    /// # Errors
    /// See [`craig_bampton::reduce`].
    pub fn reduce(
        &self,
        comm: &Comm,
        system: &System,
        equilibrium: &Equilibrium,
        limit: f64,
        progress: &mut dyn FnMut(Event),
    ) -> Result<(SuperElement, OuterSurface, Costs)> {
        let (element, surface, costs, _) =
            self.reduce_for(comm, (system, equilibrium), limit, &PartSamples::none(), progress)?;
        Ok((element, surface, costs))
    }

    /// As [`FullModel::reduce`], in a basis that holds at other moduli and densities as well. Collective.
    ///
    /// # Errors
    /// See [`craig_bampton::reduce_for`].
    pub fn reduce_for(
        &self,
        comm: &Comm,
        (system, equilibrium): (&System, &Equilibrium),
        limit: f64,
        samples: &PartSamples,
        progress: &mut dyn FnMut(Event),
    ) -> Result<(SuperElement, OuterSurface, Costs, SampleReport)> {
        let loaded: Vec<_> = self.loaded_names().into_iter().filter_map(|name| self.mesh.node_set(name)).collect();
        let reference = TAU * self.model.band[1];
        let structure = Structure { system, interface: &self.interface, equilibrium, loaded: &loaded, reference };
        let reduced = craig_bampton::reduce_for(&structure, limit, samples, progress)?;
        let centres: Vec<[f64; 3]> = loaded.iter().map(|nodes| self.centre(nodes)).collect();
        let origin = comm.agree(self.origin(comm, system, equilibrium.friction, limit))?;
        let parts = self.project_parts(&reduced.basis)?;
        let mut element = SuperElement::new(origin, &structure, &reduced, parts, &centres)?;
        self.freeze_prestress(&mut element, system, equilibrium, &reduced.basis)?;
        element.model_text = self.own_text().map(str::to_owned);
        let boundary = self.boundary(comm, system);
        let surface = OuterSurface::new(boundary, &self.mesh.parts, system, &reduced.basis)?;
        Ok((element, surface, reduced.costs, reduced.samples))
    }

    /// The brake in a basis, with all of its contact points and modes up to `limit` (Hz) at the samples. The surface's
    /// basis is on the root alone. Collective.
    ///
    /// # Errors
    /// See [`galerkin::super_element`].
    pub fn project(
        &self,
        comm: &Comm,
        system: &System,
        basis: &Block,
        samples: &[Sample],
        limit: f64,
    ) -> Result<(SuperElement, OuterSurface)> {
        let origin = comm.agree(self.origin(comm, system, self.own_friction()?, limit))?;
        let origin = Origin { samples: samples.to_vec(), ..origin };
        let matrices = self.matrices_by_part(basis)?;
        let mut element = galerkin::super_element(system, &self.interface, basis, matrices, origin)?;
        element.model_text = self.own_text().map(str::to_owned);
        let surface = OuterSurface::new(self.boundary(comm, system), &self.mesh.parts, system, basis)?;
        Ok((element, surface))
    }

    /// Gives a super-element in a basis the geometric stiffness of an equilibrium, where the model has prestress.
    /// Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn freeze_prestress(
        &self,
        element: &mut SuperElement,
        system: &System,
        equilibrium: &Equilibrium,
        basis: &Block,
    ) -> Result<()> {
        let Some(prestress) = self.prestress()? else { return Ok(()) };
        let mut k = system.k.zeros_like()?;
        prestress.add(system, &equilibrium.u, &mut k)?;
        let projected = projection::project(DMatrix::zeros(0, 0), basis, &k)?;
        element.geometric_stiffness = Some(projected.as_slice().to_vec());
        element.origin.prestress_friction = Some(equilibrium.friction);
        Ok(())
    }

    /// What each part adds to the matrices of a super-element in a basis. Collective.
    fn project_parts(&self, basis: &Block) -> Result<Vec<PartMatrices>> {
        let solids = Solids::new(&self.model, &self.mesh)?;
        let place = self.place(basis);
        let of = |(i, part): (usize, &&_)| place.project_part(part, &solids.of_part(i));
        solids.parts().iter().enumerate().map(of).collect()
    }

    /// The same with what joints and the inertia forces of rotations add. Collective.
    fn matrices_by_part(&self, basis: &Block) -> Result<MatricesByPart> {
        let families = self.families()?;
        let all: [(&dyn Elements, bool, &str); 2] = [
            (families.joints, !self.joints.names.is_empty(), "joints"),
            (&families.turning, !families.turning.is_none(), "inertia of rotations"),
        ];
        let rest: Vec<_> = all.iter().filter(|(_, is_there, _)| *is_there).collect();
        let names: Vec<&str> = rest.iter().map(|(_, _, name)| *name).collect();
        let zeros = || vec![0.0; basis.n_columns().pow(2)];
        let rest = match rest[..] {
            [] => Mck::from([zeros(), zeros(), zeros()]),
            _ => self.place(basis).project(&rest.iter().map(|(family, ..)| *family).collect::<Vec<_>>())?,
        };
        Ok(MatricesByPart { parts: self.project_parts(basis)?, rest, rest_name: names.join(" and ") })
    }

    fn place<'a>(&'a self, basis: &'a Block) -> Place<'a> {
        Place { nodes: &self.nodes, held: &self.held, basis }
    }

    /// The text of the model file as it was read, where the model has its materials and contacts from there: not from a
    /// deck, and not from a caller.
    pub fn own_text(&self) -> Option<&str> {
        let text = self.text.as_deref()?;
        let own = model::parse(text, &self.model.file).ok()?;
        let materials = |model: &Model| model.parts.iter().map(|part| part.material.clone()).collect::<Vec<_>>();
        (materials(&own) == materials(&self.model)).then_some(text)
    }

    /// Fixed-interface modes are kept below this, Hz: the end of the model's reduction band, else twice its band's.
    pub fn reduction_limit(&self) -> f64 {
        self.model.reduction.as_ref().map_or(2.0 * self.model.band[1], |reduction| reduction.band[1])
    }

    /// The loaded sets, those that carry several loads once; gravity loads none.
    pub fn loaded_names(&self) -> BTreeSet<&str> {
        let on_sets = self.model.loads.iter().filter(|load| !matches!(load.kind, LoadKind::Gravity(_)));
        on_sets.map(|load| load.on.as_str()).collect()
    }

    fn centre(&self, nodes: &[u32]) -> [f64; 3] {
        let sum = |i: usize| nodes.iter().map(|&n| self.mesh.nodes[n as usize][i]).sum::<f64>();
        [0, 1, 2].map(|i| sum(i) / nodes.len() as f64)
    }

    fn origin(&self, comm: &Comm, system: &System, friction: f64, limit: f64) -> Result<Origin> {
        let mesh_hash = if comm.is_root() { digest(&self.model.mesh_file)? } else { String::new() };
        Ok(Origin {
            title: self.model.title.clone(),
            model: self.model.file.display().to_string(),
            mesh: self.model.mesh_file.display().to_string(),
            mesh_hash,
            program: format!("squeal {}", env!("CARGO_PKG_VERSION")),
            friction,
            n_dofs: system.dofs.n_global(),
            band: self.model.band,
            limit,
            friction_damping: self.model.friction_damping,
            criterion: self.model.criterion,
            prestress_friction: None,
            made_for: None,
            samples: Vec::new(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    /// What comes to the model file's place during a reduction is not the model that is reduced.
    #[test]
    fn the_text_is_that_of_the_model_as_it_was_read() {
        let (comm, place) = (Session::start(&[]).unwrap(), tempfile::tempdir().unwrap());
        let text = std::fs::read_to_string("tests/data/pads_on_disc.toml").unwrap();
        std::fs::copy("tests/data/pads_on_disc.msh", place.path().join("pads_on_disc.msh")).unwrap();
        let file = place.path().join("brake.toml");
        std::fs::write(&file, &text).unwrap();
        let mut brake = FullModel::read(&comm, &file).unwrap();
        std::fs::write(&file, text.replace("friction = 0.4", "friction = 0.6")).unwrap();
        assert_eq!(brake.own_text(), Some(text.as_str()));
        brake.model.parts[0].material.density *= 2.0;
        assert_eq!(brake.own_text(), None, "a caller has changed the model");
    }
}
