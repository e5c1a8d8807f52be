//! From a brake at its equilibrium to a super-element.

use std::collections::BTreeSet;

use crate::Result;
use crate::assembly::System;
use crate::equilibrium::Equilibrium;
use crate::native::{Block, Comm};
use crate::reduction::craig_bampton::{self, Costs, Event, Structure};
use crate::reduction::galerkin;
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
        let loaded: Vec<_> = self.loaded_names().into_iter().filter_map(|name| self.mesh.node_set(name)).collect();
        let structure = Structure { system, interface: &self.interface, equilibrium, loaded: &loaded };
        let reduced = craig_bampton::reduce(&structure, limit, progress)?;
        let centres: Vec<[f64; 3]> = loaded.iter().map(|nodes| self.centre(nodes)).collect();
        let origin = comm.agree(self.origin(comm, system, equilibrium.friction, limit))?;
        let element = SuperElement::new(origin, &structure, &reduced, &centres)?;
        let boundary = self.boundary(comm, system);
        let surface = OuterSurface::new(boundary, &self.mesh.parts, system, &reduced.basis)?;
        Ok((element, surface, reduced.costs))
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
        let origin = comm.agree(self.origin(comm, system, self.own_friction(), limit))?;
        let origin = Origin { samples: samples.to_vec(), ..origin };
        let element = galerkin::super_element(system, &self.interface, basis, origin)?;
        let surface = OuterSurface::new(self.boundary(comm, system), &self.mesh.parts, system, basis)?;
        Ok((element, surface))
    }

    /// Fixed-interface modes are kept below this, Hz: the end of the model's reduction band, else twice its band's.
    pub fn reduction_limit(&self) -> f64 {
        self.model.reduction.as_ref().map_or(2.0 * self.model.band[1], |reduction| reduction.band[1])
    }

    /// The loaded sets, those that carry several loads once.
    pub fn loaded_names(&self) -> BTreeSet<&str> {
        self.model.loads.iter().map(|load| load.on.as_str()).collect()
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
            samples: Vec::new(),
        })
    }
}
