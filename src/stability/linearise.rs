//! From an equilibrium to the quadratic eigenproblem about it.

use crate::Result;
use crate::assembly::{Prestress, System};
use crate::contact::{Response, Status, Tangent, Tangential};
use crate::equilibrium::{Contacts, Equilibrium};
use crate::native::{Matrix, Mck};

use super::{FrozenPoints, QuadraticProblem, Viscoelastic};

/// What a linearisation has beside the tangents of the contact points.
#[derive(Clone, Copy, Default)]
pub struct LinearTerms<'a> {
    /// Whether friction that turns with the velocity of sliding points damps: [`with_friction_damping`].
    pub friction_damping: bool,
    /// The geometric stiffness of the equilibrium, where it is in the problem.
    pub prestress: Option<&'a Prestress<'a>>,
    /// Frequency at which K has the stiffness of viscoelastic materials, rad/s: 0 for that at rest.
    pub reference: f64,
}

/// A system linearised about an equilibrium with the status of every point frozen; its stiffness is kept elsewhere.
#[derive(Default)]
pub struct Linearised {
    /// `C`, with friction damping where it is asked for.
    pub c: Option<Matrix>,
    /// `K + K_g + B^T S B` with the tangents S without friction's coupling, where there is a geometric stiffness `K_g`,
    /// or K is not the system's. The first differs from one equilibrium to the next, so that neither counts nor
    /// projections follow the points alone.
    own_stiffness: Option<Matrix>,
    /// Frequency at which K has the stiffness of viscoelastic materials, rad/s.
    reference: f64,
    /// What each contact point has without friction's coupling.
    symmetric: Vec<Tangent>,
    /// What each contact point does, its tangent that of the stiffness.
    frozen: Vec<Response>,
}

impl Linearised {
    /// Linearises about `equilibrium`, and writes `k = K + B^T D B`: open points give nothing, closed sliding points
    /// `(dp/dd)(n n^T + mu t n^T)`, all other closed points stick. With prestress `k` has `K_g(u)`, too,
    /// and viscoelastic stiffnesses are those at the reference frequency. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        system: &System,
        contacts: &Contacts,
        equilibrium: &Equilibrium,
        terms: LinearTerms,
        k: &mut Matrix,
    ) -> Result<Linearised> {
        let interface = contacts.interface();
        let gaps = contacts.gaps(&equilibrium.u)?;
        let (frictions, none) = (interface.frictions_at(equilibrium.friction), vec![0.0; interface.pairs.len()]);
        let damped = || with_friction_damping(system, contacts, equilibrium.friction, &equilibrium.responses);
        let tangents = |frictions: &[f64]| -> Vec<Tangent> {
            let tangent = |a: usize| interface.linearise(a, gaps[a], equilibrium.responses[a].status, frictions);
            (0..gaps.len()).map(tangent).collect()
        };
        let freeze = |(a, tangent): (usize, Tangent)| {
            let response = &equilibrium.responses[a];
            let sticks = matches!(interface.points[a].law.tangential, Tangential::StickSlip { .. });
            let status = if sticks && response.status == Status::Slip { Status::Stick } else { response.status };
            Response { tangent, status, ..*response }
        };
        let frozen: Vec<Response> = tangents(&frictions).into_iter().enumerate().map(freeze).collect();
        let symmetric = tangents(&none);
        k.copy_from(&system.k)?;
        let viscoelastic = Viscoelastic { stiffnesses: &system.viscoelastic, reference: terms.reference };
        viscoelastic.add_to(k)?;
        terms.prestress.map_or(Ok(()), |prestress| prestress.add(system, &equilibrium.u, k))?;
        let mut own_stiffness = None;
        if terms.prestress.is_some() || !system.viscoelastic.is_empty() {
            let mut stiffness = k.duplicate()?;
            contacts.add_blocks(symmetric.iter().copied(), &mut stiffness)?;
            own_stiffness = Some(stiffness);
        }
        contacts.add_blocks(frozen.iter().map(|response| response.tangent), k)?;
        let c = terms.friction_damping.then(damped).transpose()?;
        Ok(Linearised { c, own_stiffness, reference: terms.reference, symmetric, frozen })
    }

    /// The problem, with the stiffness that [`Linearised::new`] has written.
    pub fn problem<'a>(
        &'a self,
        system: &'a System,
        contacts: &'a Contacts<'a>,
        k: &'a Matrix,
    ) -> QuadraticProblem<'a> {
        let matrices = Mck { m: &system.m, c: self.c.as_ref().unwrap_or(&system.c), k, g: system.g.as_ref() };
        let points = FrozenPoints { contacts, responses: &self.frozen, symmetric: &self.symmetric };
        let (k_symmetric, points) = match &self.own_stiffness {
            Some(stiffness) => (stiffness, None),
            None => (&system.k, Some(points)),
        };
        let viscoelastic = Viscoelastic { stiffnesses: &system.viscoelastic, reference: self.reference };
        QuadraticProblem { matrices, k_symmetric, points, symmetric_mc: !system.is_gyroscopic, viscoelastic }
    }
}

/// `C + B^T [mu p / |v| (I - n n^T - t t^T)] B` with the responses of all points: friction turns with the velocity of
/// sliding points. Collective.
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
