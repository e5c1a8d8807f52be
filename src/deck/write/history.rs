//! Supports and steps.

use std::fmt::Write;

use super::joints::PointForce;
use super::{DeckWriter, number};
use crate::algebra::{norm, scale};
use crate::model::{Fix, Inertia, Load, LoadKind, Rotation};

/// Modes that a step asks for, at most.
const N_MODES: usize = 200;

impl DeckWriter<'_> {
    /// Supports, a static step with loads and rotations, and a step for the modes.
    pub(super) fn history(&self, forces: &[PointForce]) -> String {
        let mut out = String::new();
        for fix in &self.model.fixes {
            out += "*BOUNDARY\n";
            for axis in (0..3).filter(|&axis| fix.axes[axis]) {
                writeln!(out, "{0},{1},{1}", self.names.region(&fix.nodes), axis + 1).expect("a string takes all");
            }
        }
        out += if self.model.has_prestress() { "*STEP,NLGEOM\n*STATIC\n" } else { "*STEP\n*STATIC\n" };
        self.model.fixes.iter().for_each(|fix| out += &self.displacement(fix));
        self.model.loads.iter().for_each(|load| out += &self.load(load));
        forces.iter().for_each(|force| out += &self.point_force(force));
        self.model.rotations.iter().for_each(|rotation| out += &self.rotation(rotation));
        let [low, high] = self.model.band.map(|hertz| number(hertz * self.units.time));
        let turns = self.model.rotations.iter().any(|rotation| rotation.inertia != Inertia::None);
        let options = [(self.model.friction_damping, ",FRICTION DAMPING=YES"), (turns, ",CORIOLIS")];
        let options: String = options.into_iter().filter(|(is_set, _)| *is_set).map(|(_, option)| option).collect();
        let procedure = if options.is_empty() { "*FREQUENCY" } else { "*COMPLEX FREQUENCY" };
        let perturbation = if self.model.has_prestress() { ",PERTURBATION" } else { "" };
        out + &format!("*END STEP\n*STEP{perturbation}\n{procedure}{options}\n{N_MODES},{low},{high}\n*END STEP\n")
    }

    fn displacement(&self, fix: &Fix) -> String {
        let parts = (1..).zip(fix.displacement).filter(|(_, value)| *value != 0.0);
        let on = self.names.region(&fix.nodes);
        let lines: String =
            parts.map(|(axis, value)| format!("{on},{axis},{axis},{}\n", number(value / self.units.length))).collect();
        if lines.is_empty() { lines } else { format!("*BOUNDARY\n{lines}") }
    }

    fn load(&self, load: &Load) -> String {
        let on = self.names.region(&load.on);
        match load.kind {
            LoadKind::ForceByNode(force) => {
                let n = self.mesh.node_set(&load.on).map_or(1, |nodes| nodes.len());
                self.force(on, force, n as f64)
            }
            LoadKind::Pressure(pressure) => format!("*DSLOAD\n{on},P,{}\n", number(pressure / self.units.stress())),
            LoadKind::Gravity(acceleration) => self.gravity(load, acceleration),
            // By a coupling.
            LoadKind::ForceByArea(_) | LoadKind::ForceAt { .. } => String::new(),
        }
    }

    /// Gravity of the element sets of parts and masses.
    fn gravity(&self, load: &Load, acceleration: [f64; 3]) -> String {
        let size = norm(acceleration);
        if size == 0.0 {
            return String::new();
        }
        let parts = self.model.parts.iter().map(|part| (part.name.as_str(), self.names.part(&part.name)));
        let masses = self.mass_sets.iter().map(|(name, set)| (name.as_str(), set.as_str()));
        let sets = parts.chain(masses).filter(|(name, _)| load.is_gravity_on(name)).map(|(_, set)| set);
        let direction = acceleration.map(|g| number(g / size)).join(",");
        let size = number(size / self.units.acceleration());
        "*DLOAD\n".to_owned() + &sets.map(|set| format!("{set},GRAV,{size},{direction}\n")).collect::<String>()
    }

    fn force(&self, on: &str, force: [f64; 3], n: f64) -> String {
        let parts = (1..).zip(force).filter(|(_, value)| *value != 0.0);
        let lines = parts.map(|(axis, value)| format!("{on},{axis},{}\n", number(value / n / self.units.force())));
        let lines: String = lines.collect();
        if lines.is_empty() { lines } else { format!("*CLOAD\n{lines}") }
    }

    /// A force and moment on a reference node.
    fn point_force(&self, PointForce { node, force, moment }: &PointForce) -> String {
        let unit = self.units.force() * self.units.length;
        let parts = (4..).zip(moment).filter(|(_, value)| **value != 0.0);
        let lines: String = parts.map(|(axis, value)| format!("{node},{axis},{}\n", number(value / unit))).collect();
        let moment = if lines.is_empty() { lines } else { format!("*CLOAD\n{lines}") };
        self.force(&node.to_string(), *force, 1.0) + &moment
    }

    /// The motion, and the centrifugal force of a part that has inertia: that of a rotor has no motion in its frame.
    fn rotation(&self, rotation: &Rotation) -> String {
        let from = rotation.through.map(|x| x / self.units.length);
        let to = [0, 1, 2].map(|i| from[i] + rotation.axis[i]);
        let list = |values: &[[f64; 3]]| values.as_flattened().iter().map(|&x| number(x)).collect::<Vec<_>>().join(",");
        let speed = rotation.speed * self.units.time;
        let motion = || {
            let set = self.names.turning(&rotation.part);
            format!("*MOTION,ROTATION\n{set},{},{}\n", number(speed), list(&[from, to]))
        };
        let force = || {
            let set = self.names.part(&rotation.part);
            format!(
                "*DLOAD\n{set},CENTRIF,{},{}\n",
                number(speed * speed),
                list(&[from, scale(speed.signum(), rotation.axis)])
            )
        };
        match rotation.inertia {
            Inertia::None => motion(),
            Inertia::FixedFrame => motion() + &force(),
            Inertia::RotatingFrame => force(),
        }
    }
}
