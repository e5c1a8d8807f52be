//! Between the equations and the contact points.

use serde::{Deserialize, Serialize};

use crate::Result;
use crate::assembly::{DofMap, System};
use crate::contact::{Interface, Response, Stage, Status};
use crate::native::{Block, Comm, Gather, Matrix, Vector};

use super::dense_gaps::DenseGaps;

/// Evaluates all contact points of an interface, on every rank alike, so that the contact state is known everywhere.
pub struct Contacts<'a> {
    interface: &'a Interface,
    dofs: &'a DofMap,
    gather: Gather,
    /// For each displacement of the gap operator's nodes its place in the gathered array, -1 where held.
    places: Vec<[i32; 3]>,
    /// Of a densely stored system, where most entries of the gap operator are not zero.
    dense: Option<DenseGaps>,
}

/// Points of a pair by status.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Without contact.
    pub open: usize,
    /// Closed and sticking.
    pub stick: usize,
    /// Closed and slipping.
    pub slip: usize,
}

impl Counts {
    /// Counts statuses.
    pub fn of(responses: &[Response]) -> Counts {
        let count = |status| responses.iter().filter(|r| r.status == status).count();
        Counts { open: count(Status::Open), stick: count(Status::Stick), slip: count(Status::Slip) }
    }

    /// Points in contact.
    pub fn closed(&self) -> usize {
        self.stick + self.slip
    }
}

impl<'a> Contacts<'a> {
    /// Prepares the evaluation. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(interface: &'a Interface, system: &'a System) -> Result<Contacts<'a>> {
        let dofs = &system.dofs;
        let mut places = vec![[-1; 3]; dofs.n_nodes()];
        let mut indices = Vec::new();
        let mut seen = vec![false; dofs.n_nodes()];
        for a in 0..interface.gap_operator.len() {
            for &node in interface.gap_operator.point(a).0 {
                if std::mem::replace(&mut seen[node as usize], true) {
                    continue;
                }
                for (place, equation) in places[node as usize].iter_mut().zip(dofs.node_dofs(node)) {
                    if equation >= 0 {
                        *place = indices.len() as i32;
                        indices.push(equation);
                    }
                }
            }
        }
        let gather = Gather::new(&system.load, &indices)?;
        let is_dense = system.k.is_dense()? && dofs.n_local() == dofs.n_global();
        let dense = if is_dense { DenseGaps::new(&interface.gap_operator, dofs) } else { None };
        Ok(Contacts { interface, dofs, gather, places, dense })
    }

    /// The interface.
    pub fn interface(&self) -> &'a Interface {
        self.interface
    }

    /// Relative displacements `g = B u` of all points. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn gaps(&self, u: &Vector) -> Result<Vec<[f64; 3]>> {
        if let Some(dense) = &self.dense {
            return u.local(|u| dense.gaps(u));
        }
        let (gap_operator, places) = (&self.interface.gap_operator, &self.places);
        self.gather.run(u, |values| {
            let value = |place: i32| if place < 0 { 0.0 } else { values[place as usize] };
            (0..gap_operator.len()).map(|a| gap_operator.gap(a, |node| places[node as usize].map(value))).collect()
        })
    }

    /// What every point does at these displacements. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn respond(&self, u: &Vector, stage: &Stage) -> Result<Vec<Response>> {
        let gaps = self.gaps(u)?;
        Ok(gaps.iter().enumerate().map(|(a, g)| self.interface.respond(a, *g, stage)).collect())
    }

    /// `r += factor B^T f` on this rank's rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_forces(&self, responses: &[Response], factor: f64, r: &mut Vector) -> Result<()> {
        if let Some(dense) = &self.dense {
            let forces: Vec<[f64; 3]> = responses.iter().map(|response| response.force.map(|f| factor * f)).collect();
            return r.local_mut(|r| dense.spread_all(&forces, r));
        }
        r.local_mut(|r| {
            for (a, response) in responses.iter().enumerate().filter(|(_, response)| response.status != Status::Open) {
                self.spread_into(a, response.force, factor, r);
            }
        })
    }

    /// `r += factor B_a^T f` on this rank's rows. Not collective.
    pub fn spread_into(&self, a: usize, force: [f64; 3], factor: f64, r: &mut [f64]) {
        if let Some(dense) = &self.dense {
            return dense.spread(a, force.map(|f| factor * f), r);
        }
        let owned = self.dofs.owned();
        self.interface.gap_operator.spread(a, force, |node, f| {
            for (equation, f) in self.dofs.node_dofs(node).into_iter().zip(f) {
                if owned.contains(&equation) {
                    r[(equation - owned.start) as usize] += factor * f;
                }
            }
        });
    }

    /// `B_a^T f` of several points side by side, on this rank's rows. Not collective.
    pub fn loads(&self, comm: &Comm, forces: &[(usize, [f64; 3])]) -> Block {
        let mut loads = Block::zeros(comm, self.dofs.owned().len(), forces.len());
        for (j, &(a, force)) in forces.iter().enumerate() {
            self.spread_into(a, force, 1.0, loads.column_mut(j));
        }
        loads
    }

    /// `A += sum B_a^T D_a B_a`. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_blocks(&self, blocks: impl Iterator<Item = [[f64; 3]; 3]>, matrix: &mut Matrix) -> Result<()> {
        if let Some(dense) = &self.dense {
            return matrix.change_dense_values(|values| dense.add_stiffness(blocks.collect(), values));
        }
        let (mut dense, mut indices) = (Vec::new(), Vec::new());
        for (a, block) in blocks.enumerate() {
            if block.as_flattened().iter().all(|&x| x == 0.0) {
                continue;
            }
            self.interface.gap_operator.expand_into(a, &block, &mut dense);
            indices.clear();
            self.dofs.indices_into(self.interface.gap_operator.point(a).0, &mut indices);
            matrix.add_block(&indices, &dense)?;
        }
        matrix.finish()
    }
}
