//! Rotations: `*MOTION, ROTATION`, and the centrifugal force of `*DLOAD`, CENTRIF.
//!
//! | deck | [`Inertia`] of the part |
//! |---|---|
//! | rotation alone | none: it turns slowly against its vibrations |
//! | centrifugal force alone | of a rotor, in the frame that turns with it |
//! | both | of a solid of revolution, seen from the fixed frame |

use super::Conversion;
use super::bodies::UNUSED;
use super::history::State;
use crate::Result;
use crate::algebra::{cross, norm, scale, sub};
use crate::deck::sets::Kind;
use crate::deck::types::{ActionKind, Procedure, Spin};
use crate::model::{Inertia, Place, Rotation};

/// The square of a speed and that of a centrifugal force are the same to this relative difference: decks round both.
const SAME_SPEED: f64 = 1e-3;
/// Axes are the same where they are parallel, and no farther apart, to this share of a unit of length.
const SAME_AXIS: f64 = 1e-6;

impl Conversion<'_> {
    /// Each part of which all nodes turn is a turning part.
    pub(super) fn rotations(&mut self, state: &State) -> Result<Vec<Rotation>> {
        let mut rotations: Vec<Rotation> = Vec::new();
        for (_, action) in state.actions() {
            let ActionKind::Rotation(of, spin) = &action.what else { continue };
            let turning = self.assembly.set(Kind::Node, 0, of, action.place)?;
            for part in self.turning_parts(&turning, action.place)? {
                rotations.retain(|rotation| rotation.part != part);
                if spin.speed != 0.0 {
                    rotations.push(self.rotation(part, *spin, action.place));
                }
            }
        }
        self.centrifugal(state, &mut rotations)?;
        self.check_coriolis(&rotations)?;
        Ok(rotations)
    }

    /// Gives the parts with a centrifugal force the inertia of their rotation. That of a later step replaces an earlier
    /// one's.
    fn centrifugal(&mut self, state: &State, rotations: &mut Vec<Rotation>) -> Result<()> {
        let slow = rotations.clone();
        for (_, action) in state.actions() {
            let ActionKind::Centrifugal(of, spin) = &action.what else { continue };
            let elements = self.assembly.set(Kind::Element, 0, of, action.place)?;
            let nodes: Vec<u32> = elements.iter().flat_map(|&e| self.assembly.nodes(e)).copied().collect();
            for part in self.turning_parts(&nodes, action.place)? {
                rotations.retain(|rotation| rotation.part != part);
                let own = self.rotation(part, *spin, action.place);
                match slow.iter().find(|slow| slow.part == own.part) {
                    Some(slow) if !is_same(slow, &own) => {
                        let what = format_args!(
                            "the centrifugal force of {} is that of {:.6} rad/s, and *MOTION turns it by {:.6} rad/s or about \
                             another axis. Give both the same rotation",
                            own.part, own.speed, slow.speed
                        );
                        return Err(self.assembly.error(action.place, what));
                    }
                    Some(slow) => rotations.push(Rotation { inertia: Inertia::FixedFrame, ..slow.clone() }),
                    None if own.speed != 0.0 => {
                        rotations.push(Rotation { inertia: Inertia::RotatingFrame, ..own });
                    }
                    None => {}
                }
            }
        }
        Ok(())
    }

    /// Refuses Coriolis forces without a rotation, and notes them where the deck leaves them out.
    fn check_coriolis(&mut self, rotations: &[Rotation]) -> Result<()> {
        let has_inertia = rotations.iter().any(|rotation| rotation.inertia != Inertia::None);
        let has_coriolis = |procedure| matches!(procedure, Procedure::ComplexFrequency { coriolis: true, .. });
        match self.deck.steps.iter().find(|step| has_coriolis(step.procedure)) {
            Some(step) if !has_inertia => {
                let what = "CORIOLIS needs a rotation: give the turning elements a *DLOAD, CENTRIF";
                return Err(self.assembly.error(step.place, what));
            }
            None if has_inertia => {
                self.notes.push("CENTRIF: modes have Coriolis forces, too (inertia in the model file)".to_owned());
            }
            _ => {}
        }
        Ok(())
    }

    fn turning_parts(&self, turning: &[u32], place: Place) -> Result<Vec<String>> {
        let mesh = &self.regions.mesh;
        let mut turns = vec![false; mesh.nodes.len()];
        let nodes = turning.iter().map(|&node| self.bodies.node_of[node as usize]).filter(|&node| node != UNUSED);
        nodes.for_each(|node| turns[node as usize] = true);
        let mut whole = vec![true; mesh.parts.len()];
        for element in mesh.elements.iter() {
            whole[element.part as usize] &= element.nodes.iter().all(|&node| turns[node as usize]);
        }
        for element in mesh.elements.iter().filter(|element| whole[element.part as usize]) {
            element.nodes.iter().for_each(|&node| turns[node as usize] = false);
        }
        let parts: Vec<String> =
            mesh.parts.iter().zip(whole).filter(|(_, whole)| *whole).map(|(part, _)| part.clone()).collect();
        if parts.is_empty() || turns.contains(&true) {
            let what = "a rotation needs all nodes of each part that turns, and no others";
            return Err(self.assembly.error(place, what));
        }
        Ok(parts)
    }

    fn rotation(&self, part: String, spin: Spin, place: Place) -> Rotation {
        let axis = sub(spin.to, spin.from);
        Rotation {
            part,
            axis: scale(1.0 / norm(axis), axis),
            through: spin.from.map(|x| x * self.units.length),
            speed: spin.speed / self.units.time,
            inertia: Inertia::None,
            place,
        }
    }
}

/// Whether a motion has a centrifugal force, which has no sign.
fn is_same(motion: &Rotation, force: &Rotation) -> bool {
    let arm = cross(sub(motion.through, force.through), motion.axis);
    let is_parallel = norm(cross(motion.axis, force.axis)) <= SAME_AXIS && norm(arm) <= SAME_AXIS;
    is_parallel && (motion.speed.powi(2) - force.speed.powi(2)).abs() <= SAME_SPEED * motion.speed.powi(2)
}
