//! What an equilibrium is checked by: forces of the contact pairs, balance of forces and moments, torque of each
//! rotation.

use crate::Result;
use crate::algebra::norm;
use crate::assembly::System;
use crate::equilibrium::{Balance, Equilibrium, PairForces};
use crate::model::Rotation;
use crate::native::Comm;

use super::{FullModel, ReducedModel};

/// The checks of an equilibrium.
pub struct EquilibriumChecks {
    /// Forces of the pairs, in the interface's order.
    pub pairs: Vec<PairForces>,
    /// Balances and torques in words, a line each; none of a super-element, whose supports are condensed.
    pub text: String,
}

impl EquilibriumChecks {
    /// Those of a full model. Collective.
    pub(super) fn of_full(full: &FullModel, system: &System, equilibrium: &Equilibrium) -> Result<EquilibriumChecks> {
        let (u, families) = (full.displacements(system, &equilibrium.u)?, full.families()?);
        let mut balance = Balance::new(
            system,
            &full.mesh.nodes,
            &families.list(),
            &full.loads,
            &full.interface,
            &u,
            &equilibrium.responses,
        );
        let inertia = families.inertia_forces(|node| system.dofs.owns(node), &u);
        balance.add_body_forces(system, &full.mesh.nodes, &inertia);
        balance.add_body_forces(system, &full.mesh.nodes, &full.weights);
        // Joints to the ground, and equations, are supports; of all others the forces cancel.
        for (node, force) in full.joints.elements.iter().flat_map(|element| element.forces(&u)) {
            balance.support.add(full.mesh.nodes[node as usize], force.map(|f| -f));
        }
        let text = balance_text(&balance) + &torques_text(system.k.comm(), full, &balance);
        Ok(EquilibriumChecks { pairs: balance.pairs, text })
    }

    /// Those of a super-element. Not collective.
    pub(super) fn of_reduced(reduced: &ReducedModel, equilibrium: &Equilibrium) -> EquilibriumChecks {
        let pairs = PairForces::all(&reduced.interface, &equilibrium.responses);
        EquilibriumChecks { pairs, text: String::new() }
    }
}

fn balance_text(balance: &Balance) -> String {
    let [force, moment] = balance.residual();
    let clamp = balance.pairs.iter().map(|pair| pair.normal.abs()).fold(0.0, f64::max);
    format!(
        "loads and supports balance to {force:.1e} N and {moment:.1e} N m (largest contact force {clamp:.1} N)\n\
         moment of contact forces across initial gaps: {:.1e} N m\n",
        norm(balance.across_gaps.moment)
    )
}

/// The torque at the supports of each rotating part against that of friction on it. Collective.
fn torques_text(comm: &Comm, full: &FullModel, balance: &Balance) -> String {
    let torques = full.model.rotations.iter().map(|rotation| {
        let of_part = part_nodes(full, &rotation.part);
        let (through, axis) = (rotation.through, rotation.axis);
        let held = balance.support_torque(comm, &full.mesh.nodes, |node: u32| of_part[node as usize], through, axis);
        let friction = -friction_torque(full, balance, rotation);
        format!("reaction torque on {}: {held:.3} N m; friction torque: {friction:.3} N m\n", rotation.part)
    });
    torques.collect()
}

/// Moment that the sliding pairs' friction exerts on a rotating part about its axis, N m: minus that on the slaves.
fn friction_torque(full: &FullModel, balance: &Balance, rotation: &Rotation) -> f64 {
    let part_of = |surface: &str| full.mesh.part_of_surface(surface).map(|part| &full.mesh.parts[part as usize]);
    let pairs = full.interface.pairs.iter().zip(&balance.pairs);
    let own = pairs.filter(|(pair, _)| pair.is_sliding() && part_of(&pair.master) == Some(&rotation.part));
    -own.map(|(_, forces)| forces.on_slave.about(rotation.through, rotation.axis)).sum::<f64>()
}

/// Whether each node belongs to a part.
fn part_nodes(full: &FullModel, part: &str) -> Vec<bool> {
    let mut inside = vec![false; full.mesh.nodes.len()];
    let index = full.mesh.parts.iter().position(|name| name == part);
    for element in full.mesh.elements.iter() {
        if Some(element.part as usize) == index {
            element.nodes.iter().for_each(|&n| inside[n as usize] = true);
        }
    }
    inside
}
