//! From an equilibrium to the pencil about it.

use crate::Result;
use crate::assembly::System;
use crate::contact::{Response, Status, Tangential};
use crate::equilibrium::{Contacts, Equilibrium};
use crate::native::Matrix;

use super::{Pencil, Points};

/// A system linearised about an equilibrium with the status of every point frozen; its stiffness has a place elsewhere.
#[derive(Default)]
pub struct Linearised {
    /// `C`, with friction damping where it is asked for.
    pub c: Option<Matrix>,
    /// What each contact point has without friction's coupling.
    symmetric: Vec<[[f64; 3]; 3]>,
    /// The same with it.
    tangents: Vec<[[f64; 3]; 3]>,
    /// What each contact point does, its tangent that of the stiffness.
    frozen: Vec<Response>,
}

impl Linearised {
    /// Linearises about `equilibrium`, with `k = K + B^T D B`: open points give nothing, closed sliding points `(dp/dd)(n n^T + mu t n^T)`,
    /// all other closed points stick. With `friction_damping`, C is [`with_friction_damping`]. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn update(
        &mut self,
        system: &System,
        (contacts, k): (&mut Contacts, &mut Matrix),
        equilibrium: &Equilibrium,
        friction_damping: bool,
    ) -> Result<()> {
        let interface = contacts.interface();
        let gaps = contacts.gaps(&equilibrium.u)?;
        let (frictions, none) = (interface.frictions_at(equilibrium.friction), vec![0.0; interface.pairs.len()]);
        if friction_damping {
            self.c = Some(with_friction_damping(system, contacts, equilibrium.friction, &equilibrium.responses)?);
        }
        let blocks = |frictions: &[f64]| -> Vec<[[f64; 3]; 3]> {
            let block = |a: usize| interface.linearise(a, gaps[a], equilibrium.responses[a].status, frictions);
            (0..gaps.len()).map(block).collect()
        };
        let tangents = blocks(&frictions);
        self.symmetric = blocks(&none);
        k.copy_from(&system.k)?;
        contacts.add_blocks(tangents.iter().copied(), k)?;
        let freeze = |(a, tangent): (usize, _)| {
            let response = &equilibrium.responses[a];
            let sticks = matches!(interface.points[a].law.tangential, Tangential::StickSlip { .. });
            let status = if sticks && response.status == Status::Slip { Status::Stick } else { response.status };
            Response { tangent, status, ..*response }
        };
        self.frozen = tangents.iter().copied().enumerate().map(freeze).collect();
        self.tangents = tangents;
        Ok(())
    }

    /// What each contact point does, its tangent that of the stiffness.
    pub fn frozen(&self) -> &[Response] {
        &self.frozen
    }

    /// The pencil, with the stiffness that [`Linearised::update`] has made.
    pub fn pencil<'a>(&'a self, system: &'a System, contacts: &'a Contacts<'a>, k: &'a Matrix) -> Pencil<'a> {
        let c = self.c.as_ref().unwrap_or(&system.c);
        let points = Some(Points { contacts, tangents: &self.tangents, symmetric: &self.symmetric });
        Pencil { m: &system.m, c, k, k_symmetric: &system.k, points, symmetric_mc: true }
    }
}

/// `C + B^T [mu p / |v| (I - n n^T - t t^T)] B` with the responses of all points: friction turns with the velocity of sliding points.
/// Collective.
///
/// # Errors
/// PETSc's.
pub fn with_friction_damping(
    system: &System,
    contacts: &Contacts,
    friction: f64,
    responses: &[Response],
) -> Result<Matrix> {
    let (interface, mut c) = (contacts.interface(), system.c.duplicate()?);
    let frictions = interface.frictions_at(friction);
    let block = |(a, response): (usize, &Response)| interface.friction_damping(a, response.normal_force, &frictions);
    contacts.add_blocks(responses.iter().enumerate().map(block), &mut c)?;
    Ok(c)
}
