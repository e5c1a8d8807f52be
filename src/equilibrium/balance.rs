//! Checks that an equilibrium makes of itself: forces, moments, torque, contact resultants.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

use crate::algebra::{cross, dot, norm, sub};
use crate::assembly::{DofMap, Elements, System, element_forces};
use crate::contact::interface::{ContactPair, Interface};
use crate::contact::law::{Response, Status};
use crate::native::Comm;

use super::Counts;

/// Force (N) and its moment about the origin (N m).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// Force, N.
    #[serde(rename = "force_n")]
    pub force: [f64; 3],
    /// Moment about the origin, N m.
    #[serde(rename = "moment_n_m")]
    pub moment: [f64; 3],
}

impl Wrench {
    /// Adds a force at a point.
    pub fn add(&mut self, point: [f64; 3], force: [f64; 3]) {
        let moment = cross(point, force);
        for i in 0..3 {
            self.force[i] += force[i];
            self.moment[i] += moment[i];
        }
    }

    /// The sum of forces at points over all ranks. Collective.
    fn sum(comm: &Comm, forces: impl Iterator<Item = ([f64; 3], [f64; 3])>) -> Wrench {
        let mut own = Wrench::default();
        forces.for_each(|(point, force)| own.add(point, force));
        let mut all = [own.force, own.moment];
        comm.sum_all(all.as_flattened_mut());
        Wrench { force: all[0], moment: all[1] }
    }

    /// Moment about the axis through a point, N m.
    pub fn about(&self, through: [f64; 3], axis: [f64; 3]) -> f64 {
        let lever = cross(through, self.force);
        dot(sub(self.moment, lever), axis)
    }
}

impl AddAssign for Wrench {
    fn add_assign(&mut self, other: Wrench) {
        for i in 0..3 {
            self.force[i] += other.force[i];
            self.moment[i] += other.moment[i];
        }
    }
}

/// What a contact pair carries.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PairForces {
    /// Points by status.
    #[serde(flatten)]
    pub counts: Counts,
    /// Sum of the normal forces, N.
    #[serde(rename = "normal_force_n")]
    pub normal: f64,
    /// Sum of the magnitudes of the tangential forces, N.
    #[serde(rename = "tangential_force_n")]
    pub tangential: f64,
    /// Force on the slave and its moment about the origin.
    pub on_slave: Wrench,
    /// Area of closed points, m2.
    #[serde(rename = "closed_area_m2")]
    pub closed_area: f64,
    /// Largest pressure of a point, Pa.
    #[serde(rename = "peak_pressure_pa")]
    pub peak_pressure: f64,
    /// Largest normal force of a point, N.
    #[serde(rename = "peak_force_n")]
    pub peak_force: f64,
    /// Sum of the normal forces that the rounding of the coordinates alone explains, N.
    #[serde(rename = "rounding_n")]
    pub rounding: f64,
}

/// Gaps are exact to this fraction of the coordinates of their points.
const GAP_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Loads and supports of an equilibrium, which add up to nothing.
#[derive(Debug, Clone)]
pub struct Balance {
    /// All loads.
    pub applied: Wrench,
    /// All supports.
    pub support: Wrench,
    /// What contact forces add: the force on the slave and its opposite on the master cancel, but they act on either
    /// side of the initial gap, so that their moments cancel only where the surfaces touch at the start.
    pub across_gaps: Wrench,
    /// Supports at the nodes that this rank owns.
    pub reactions: Vec<(u32, [f64; 3])>,
    /// The pairs, in the interface's order.
    pub pairs: Vec<PairForces>,
}

impl Balance {
    /// Adds up an equilibrium. `u` are displacements of the nodes that this rank has, `points` their coordinates.
    /// Collective.
    pub fn new(
        system: &System,
        points: &[[f64; 3]],
        families: &[&dyn Elements],
        loads: &[(u32, [f64; 3])],
        interface: &Interface,
        u: &[[f64; 3]],
        responses: &[Response],
    ) -> Balance {
        let (comm, dofs) = (system.k.comm(), &system.dofs);
        let mut internal = internal_forces_at_supports(families, dofs, u);
        let mut subtract = |node: u32, f: [f64; 3]| {
            if let Some(sum) = internal.get_mut(&node) {
                (0..3).for_each(|i| sum[i] -= f[i]);
            }
        };
        let mut applied = Wrench::default();
        for &(node, force) in loads {
            applied.add(points[node as usize], force);
            subtract(node, force);
        }
        let mut across_gaps = Wrench::default();
        for (a, response) in responses.iter().enumerate() {
            interface.gap_operator.spread(a, response.force, |node, force| {
                across_gaps.add(points[node as usize], force);
                subtract(node, force);
            });
        }
        let held = |node: u32, f: [f64; 3]| {
            let equations = dofs.node_dofs(node);
            [0, 1, 2].map(|i| if equations[i] < 0 { f[i] } else { 0.0 })
        };
        let reactions: Vec<_> = internal.into_iter().map(|(node, f)| (node, held(node, f))).collect();
        let support = Wrench::sum(comm, reactions.iter().map(|&(node, f)| (points[node as usize], f)));
        let pairs = PairForces::all(interface, responses);
        Balance { applied, support, across_gaps, reactions, pairs }
    }

    /// Adds loads (N) at nodes that this rank owns, each of which one rank has. Collective.
    pub fn add_body_forces(&mut self, system: &System, points: &[[f64; 3]], forces: &[(u32, [f64; 3])]) {
        let comm = system.k.comm();
        let held = |node: u32, f: [f64; 3]| {
            let dofs = system.dofs.node_dofs(node);
            [0, 1, 2].map(|i| if dofs[i] < 0 { -f[i] } else { 0.0 })
        };
        let at = |(node, force): (u32, [f64; 3])| (points[node as usize], force);
        self.applied += Wrench::sum(comm, forces.iter().copied().map(at));
        let reactions: Vec<_> = forces.iter().map(|&(node, force)| (node, held(node, force))).collect();
        self.support += Wrench::sum(comm, reactions.iter().copied().map(at));
        self.reactions.extend(reactions);
    }

    /// Moment of some nodes' supports about an axis, N m. Collective.
    pub fn support_torque(
        &self,
        comm: &Comm,
        points: &[[f64; 3]],
        of: impl Fn(u32) -> bool,
        through: [f64; 3],
        axis: [f64; 3],
    ) -> f64 {
        let nodes = self.reactions.iter().filter(|(node, _)| of(*node));
        Wrench::sum(comm, nodes.map(|&(node, f)| (points[node as usize], f))).about(through, axis)
    }

    /// What is left of all forces (N) and moments (N m): round-off.
    pub fn residual(&self) -> [f64; 2] {
        let [a, b, c] = [self.applied, self.support, self.across_gaps];
        let left = |of: fn(&Wrench) -> [f64; 3]| norm([0, 1, 2].map(|i| of(&a)[i] + of(&b)[i] + of(&c)[i]));
        [left(|w| w.force), left(|w| w.moment)]
    }
}

/// `f = sum_e K_e u_e` at the nodes of this rank that have a held displacement.
fn internal_forces_at_supports(families: &[&dyn Elements], dofs: &DofMap, u: &[[f64; 3]]) -> BTreeMap<u32, [f64; 3]> {
    let is_held = |n: u32| dofs.owns(n) && dofs.node_dofs(n).iter().any(|&e| e < 0);
    let mut forces: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    element_forces(
        families,
        is_held,
        |n| u[n as usize],
        |n, force| {
            if is_held(n) {
                let sum = forces.entry(n).or_default();
                (0..3).for_each(|i| sum[i] += force[i]);
            }
        },
    );
    forces
}

impl PairForces {
    /// What each pair carries under the responses of all points.
    pub fn all(interface: &Interface, responses: &[Response]) -> Vec<PairForces> {
        interface.pairs.iter().map(|pair| PairForces::new(interface, pair, responses)).collect()
    }

    /// Whether the pair is pressed together by more than the rounding of the coordinates.
    pub fn is_pressed(&self) -> bool {
        self.normal > self.rounding
    }

    fn new(interface: &Interface, pair: &ContactPair, responses: &[Response]) -> PairForces {
        let own = &responses[pair.points.clone()];
        let mut forces = PairForces { counts: Counts::of(own), ..PairForces::default() };
        for (a, response) in pair.points.clone().zip(own) {
            if response.status == Status::Open {
                continue;
            }
            let point = &interface.points[a];
            let n = point.law.normal;
            let p = response.normal_force;
            forces.normal += p;
            forces.tangential += norm([0, 1, 2].map(|i| response.force[i] - p * n[i]));
            forces.on_slave.add(point.position, response.force);
            forces.closed_area += point.law.weight;
            forces.peak_pressure = forces.peak_pressure.max(p / point.law.weight);
            forces.peak_force = forces.peak_force.max(p);
            forces.rounding += point.law.stiffness(0.0) * GAP_ROUNDING * norm(point.position);
        }
        forces
    }
}
