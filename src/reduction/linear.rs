//! The structure between its sliding contacts, linear about an equilibrium.
//!
//! ```text
//! K   = K_elements + sum_other B_a^T D_a B_a
//! F   = F_ext + sum_other B_a^T (f_a + D_a g_a)
//! K_s = K_0 + B^T diag(k) B        K_0 = K with the stiffness of viscoelastic materials at the reference frequency
//! ```

use crate::Result;
use crate::contact::{GapOperator, Interface, Response, Status};
use crate::equilibrium::Contacts;
use crate::native::{Matrix, Vector};

use super::craig_bampton::Structure;

/// The linear structure.
pub(super) struct Linear {
    /// K, of viscoelastic materials that at rest.
    pub stiffness: Matrix,
    /// K_s, symmetric.
    pub supported: Matrix,
    /// `F - F_ext`.
    pub preload: Vector,
    /// Tangents D of the sliding contacts at the equilibrium, without friction.
    pub contacts: Vec<[[f64; 3]; 3]>,
}

impl Linear {
    pub(super) fn new(structure: &Structure, retained: &GapOperator, contacts: &[usize]) -> Result<Linear> {
        let Structure { system, interface, equilibrium, .. } = structure;
        let evaluation = Contacts::new(interface, system)?;
        let gaps = evaluation.gaps(&equilibrium.u)?;
        let none = vec![0.0; interface.pairs.len()];
        let slides = |a: usize| interface.pairs[interface.points[a].pair].is_sliding();
        let frozen = |a: usize| interface.linearise(a, gaps[a], equilibrium.responses[a].status, &none);
        let tangent = |a: usize| if slides(a) { [[0.0; 3]; 3] } else { frozen(a) };
        let mut stiffness = system.k.duplicate()?;
        evaluation.add_blocks((0..gaps.len()).map(tangent), &mut stiffness)?;
        // f + D g
        let beside = |a: usize| {
            let (d, mut response) = (tangent(a), equilibrium.responses[a]);
            response.force = [0, 1, 2].map(|i| response.force[i] + (0..3).map(|j| d[i][j] * gaps[a][j]).sum::<f64>());
            if slides(a) { Response { status: Status::Open, ..response } } else { response }
        };
        let mut preload = system.zeros()?;
        evaluation.add_forces(&(0..gaps.len()).map(beside).collect::<Vec<_>>(), 1.0, &mut preload)?;

        let sides = Interface { gap_operator: retained.clone(), ..Interface::default() };
        let support = |point: usize| {
            let contact = contacts.get(point % contacts.len().max(1)).filter(|_| point < 2 * contacts.len());
            let k = contact.map_or(0.0, |&a| interface.points[a].law.stiffness(0.0));
            [[k, 0.0, 0.0], [0.0, k, 0.0], [0.0, 0.0, k]]
        };
        let mut supported = stiffness.duplicate()?;
        structure.viscoelastic().add_to(&mut supported)?;
        Contacts::new(&sides, system)?.add_blocks((0..retained.len()).map(support), &mut supported)?;
        supported.declare_symmetric()?;
        Ok(Linear { stiffness, supported, preload, contacts: contacts.iter().map(|&a| frozen(a)).collect() })
    }
    /// K with the sliding contacts closed as at the equilibrium, without friction, and with the stiffness of
    /// viscoelastic materials at the reference frequency.
    pub(super) fn closed(&self, structure: &Structure, contacts: &[usize]) -> Result<Matrix> {
        let mut tangents = vec![[[0.0; 3]; 3]; structure.interface.points.len()];
        contacts.iter().zip(&self.contacts).for_each(|(&a, &tangent)| tangents[a] = tangent);
        let mut closed = self.stiffness.duplicate()?;
        structure.viscoelastic().add_to(&mut closed)?;
        Contacts::new(structure.interface, structure.system)?.add_blocks(tangents.into_iter(), &mut closed)?;
        closed.declare_symmetric()?;
        Ok(closed)
    }
}
