//! Supports and loads.

use std::collections::BTreeMap;

use super::Conversion;
use super::equations::{Axes, global_axis};
use super::history::State;
use crate::Result;
use crate::deck::sets::Kind;
use crate::deck::types::{Action, ActionKind, Entry};
use crate::model::{Equation, Fix, Load, LoadKind, Place};

/// A force on a node, by axis, with the step that it began in.
type Forces = BTreeMap<u32, [(usize, f64); 3]>;
/// A pressure with the step that it began in.
type Pressure = (usize, f64, Place);

/// Why a displacement is refused of a node that is no node of a solid, or has axes of its own.
pub(super) const OTHER_THAN_ZERO: &str = "a displacement other than 0 is supported of nodes of solids along x, y and z or along all three of their \
     local axes, and of reference nodes of which all six displacements are held. Press the parts together by a load";

/// Which displacements of a node are prescribed, what they are, and where that stands.
type Prescribed = BTreeMap<u32, ([Option<f64>; 3], Place)>;

/// Which local axes of a node are held, and where that stands.
type LocalSupports = BTreeMap<u32, ([bool; 3], Place)>;

/// Adds to a value of the same step, replaces one of an earlier step.
pub(super) fn add(known: &mut (usize, f64), step: usize, value: f64) {
    *known = if known.0 == step { (step, known.1 + value) } else { (step, value) };
}

impl Conversion<'_> {
    /// Prescribed displacements; those of reference nodes are left to the couplings. Oblique ones are equations.
    pub(super) fn supports(&mut self, state: &State, equations: &mut Vec<Equation>) -> Result<Vec<Fix>> {
        let mut fixes: Vec<Fix> = Vec::new();
        let (mut moved, mut local) = (self.moved(state)?, LocalSupports::new());
        self.turn(&mut moved, &mut local)?;
        for (_, action) in state.actions() {
            let ActionKind::Boundary(of, [first, last], _) = &action.what else { continue };
            let nodes = self.bodies.used(&self.assembly.set(Kind::Node, 0, of, action.place)?);
            // Solids have no rotations to hold, and nodes outside them no stiffness.
            if *first > 3 || nodes.is_empty() {
                continue;
            }
            let axes: [bool; 3] = std::array::from_fn(|i| (*first..=*last).contains(&(i as u8 + 1)));
            let nodes = nodes.into_iter().filter(|node| !moved.contains_key(node));
            let (oblique, nodes): (Vec<u32>, Vec<u32>) = nodes.partition(|node| self.axes.contains_key(node));
            for node in oblique {
                let held = &mut local.entry(node).or_insert(([false; 3], action.place)).0;
                (0..3).for_each(|i| held[i] |= axes[i]);
            }
            if !nodes.is_empty() {
                let name = self.set_name(of, "support", nodes);
                fix(&mut fixes, name, axes, action.place);
            }
        }
        self.local_supports(&local, equations, &mut fixes)?;
        self.moved_supports(&moved, &mut fixes);
        Ok(fixes)
    }

    /// The nodes of solids with a displacement other than zero, and all that is prescribed of them: the last value of
    /// each axis.
    fn moved(&self, state: &State) -> Result<Prescribed> {
        let mut all = Prescribed::new();
        let is_moved = |action: &Action| matches!(action.what, ActionKind::Boundary(_, _, value) if value != 0.0);
        if !state.actions().any(|(_, action)| is_moved(action)) {
            return Ok(all);
        }
        for (_, action) in state.actions() {
            let ActionKind::Boundary(of, [first, last], value) = &action.what else { continue };
            for node in self.bodies.used(&self.assembly.set(Kind::Node, 0, of, action.place)?) {
                let (values, place) = all.entry(node).or_insert(([None; 3], action.place));
                (*first..=*last)
                    .filter(|axis| *axis <= 3)
                    .for_each(|axis| values[usize::from(axis) - 1] = Some(*value));
                *place = action.place;
            }
        }
        all.retain(|_, (values, _)| values.iter().flatten().any(|value| *value != 0.0));
        Ok(all)
    }

    /// Turns displacements along local axes into those along x, y and z. Oblique axes that are only held go to the
    /// local supports.
    fn turn(&self, moved: &mut Prescribed, local: &mut LocalSupports) -> Result<()> {
        for (node, (values, place)) in moved {
            let Some(axes) = self.axes.get(node) else { continue };
            let own = std::mem::take(values);
            if let [Some(a), Some(b), Some(c)] = own {
                // u = a e_1 + b e_2 + c e_3
                *values = [0, 1, 2].map(|j| Some(a * axes[0][j] + b * axes[1][j] + c * axes[2][j]));
                continue;
            }
            for (i, value) in own.into_iter().enumerate().filter_map(|(i, value)| Some((i, value?))) {
                match global_axis(&axes[i]) {
                    Some(j) => values[j] = Some(axes[i][j].signum() * value),
                    None if value == 0.0 => local.entry(*node).or_insert(([false; 3], *place)).0[i] = true,
                    None => return Err(self.assembly.error(*place, OTHER_THAN_ZERO)),
                }
            }
        }
        Ok(())
    }

    /// Nodes with the same prescribed displacement are one support.
    fn moved_supports(&mut self, moved: &Prescribed, fixes: &mut Vec<Fix>) {
        let mut groups: BTreeMap<[Option<u64>; 3], (Vec<u32>, Place)> = BTreeMap::new();
        for (&node, (values, place)) in moved {
            groups.entry(values.map(|value| value.map(f64::to_bits))).or_insert((Vec::new(), *place)).0.push(node);
        }
        for (bits, (nodes, place)) in groups {
            let nodes = self.regions.add_node_set("moved", nodes);
            let displacement = bits.map(|bits| bits.map_or(0.0, f64::from_bits) * self.units.length);
            fixes.push(Fix { nodes, axes: bits.map(|bits| bits.is_some()), displacement, place });
        }
    }

    /// Supports along local axes; nodes with the same global ones are one set.
    fn local_supports(
        &mut self,
        local: &LocalSupports,
        equations: &mut Vec<Equation>,
        fixes: &mut Vec<Fix>,
    ) -> Result<()> {
        let mut groups: BTreeMap<[bool; 3], (Vec<u32>, Place)> = BTreeMap::new();
        for (&node, &(held, place)) in local {
            let global = self.local_support(node, held, place, equations)?;
            if global != [false; 3] {
                groups.entry(global).or_insert((Vec::new(), place)).0.push(node);
            }
        }
        for (axes, (nodes, place)) in groups {
            let name = self.regions.add_node_set("support", nodes);
            fix(fixes, name, axes, place);
        }
        Ok(())
    }

    /// The mesh's name of a set of nodes: the deck's, or `support 1` and so on.
    fn set_name(&mut self, of: &Entry, word: &str, nodes: Vec<u32>) -> String {
        let name = match of {
            Entry::Name(name) => self.deck.spelled(name),
            Entry::Number(number) => format!("node {number}"),
            Entry::Range(..) => word.to_owned(),
        };
        self.regions.add_node_set(&name, nodes)
    }

    /// Forces on nodes of solids, and pressures.
    pub(super) fn loads(&mut self, state: &State) -> Result<Vec<Load>> {
        let mut loads = self.forces(state)?;
        loads.extend(self.face_pressures(state)?);
        let mut on_surfaces: BTreeMap<&str, Pressure> = BTreeMap::new();
        for (step, action) in state.actions() {
            let ActionKind::SurfacePressure(surface, value) = &action.what else { continue };
            let known = on_surfaces.entry(surface).or_insert((step, 0.0, action.place));
            let mut sum = (known.0, known.1);
            add(&mut sum, step, *value);
            *known = (sum.0, sum.1, action.place);
        }
        for (surface, (_, value, place)) in on_surfaces {
            let on = self.surface_name(surface, place)?;
            let kind = LoadKind::Pressure(value * self.units.stress());
            loads.push(Load { name: format!("pressure on {on}"), on, kind, place });
        }
        Ok(loads)
    }

    /// Nodes with the same force are one load.
    fn forces(&mut self, state: &State) -> Result<Vec<Load>> {
        let (mut forces, mut places, mut named) = (Forces::new(), BTreeMap::new(), Vec::new());
        for (step, action) in state.actions() {
            let ActionKind::Force(of, axis, value) = &action.what else { continue };
            let nodes = self.assembly.set(Kind::Node, 0, of, action.place)?;
            let nodes: Vec<u32> = nodes.into_iter().filter(|&node| self.is_used(node)).collect();
            if nodes.is_empty() {
                continue;
            }
            if *axis > 3 {
                return Err(self.assembly.error(action.place, "a moment on nodes of solids, which do not rotate"));
            }
            let nodes = self.bodies.used(&nodes);
            for &node in &nodes {
                add(&mut forces.entry(node).or_default()[usize::from(*axis) - 1], step, *value);
                places.insert(node, action.place);
            }
            if let Entry::Name(name) = of {
                named.push((self.deck.spelled(name), nodes));
            }
        }
        // Bits of the vector, so that equal forces find each other.
        let mut groups: BTreeMap<[u64; 3], Vec<u32>> = BTreeMap::new();
        for (&node, force) in &forces {
            let force = self.in_global_axes(node, force.map(|(_, value)| value));
            groups.entry(force.map(f64::to_bits)).or_default().push(node);
        }
        let mut loads = Vec::new();
        for (bits, nodes) in groups {
            let total = bits.map(|bits| f64::from_bits(bits) * nodes.len() as f64 * self.units.force());
            if total == [0.0; 3] {
                continue;
            }
            let place = places[&nodes[0]];
            let name = named.iter().find(|(_, own)| *own == nodes).map(|(name, _)| name.clone());
            let on = self.regions.add_node_set(&name.unwrap_or_else(|| format!("load {}", loads.len() + 1)), nodes);
            loads.push(Load { name: format!("force on {on}"), on, kind: LoadKind::ForceByNode(total), place });
        }
        Ok(loads)
    }

    /// A force on a mesh node along its local axes.
    fn in_global_axes(&self, node: u32, force: [f64; 3]) -> [f64; 3] {
        let along = |axes: &Axes| [0, 1, 2].map(|i| (0..3).map(|k| axes[k][i] * force[k]).sum());
        self.axes.get(&node).map_or(force, along)
    }

    /// Faces with the same pressure are one load.
    fn face_pressures(&mut self, state: &State) -> Result<Vec<Load>> {
        let mut pressures: BTreeMap<(u32, u8), Pressure> = BTreeMap::new();
        for (step, action) in state.actions() {
            let ActionKind::FacePressure(of, face, value) = &action.what else { continue };
            let elements = self.assembly.set(Kind::Element, 0, of, action.place)?;
            for at in self.assembly.with_face(&elements, *face, action.place)? {
                let known = pressures.entry(at).or_insert((step, 0.0, action.place));
                let mut sum = (known.0, known.1);
                add(&mut sum, step, *value);
                *known = (sum.0, sum.1, action.place);
            }
        }
        let mut groups: BTreeMap<u64, Vec<(u32, u8)>> = BTreeMap::new();
        for (&at, (_, value, _)) in &pressures {
            groups.entry(value.to_bits()).or_default().push(at);
        }
        let mut loads = Vec::new();
        for (bits, faces) in groups {
            let place = pressures[&faces[0]].2;
            let on = format!("pressure {}", loads.len() + 1);
            self.add_surface(&on, &faces, place)?;
            let kind = LoadKind::Pressure(f64::from_bits(bits) * self.units.stress());
            loads.push(Load { name: on.clone(), on, kind, place });
        }
        Ok(loads)
    }
}

/// Holds a set along axes.
fn fix(fixes: &mut Vec<Fix>, nodes: String, axes: [bool; 3], place: Place) {
    match fixes.iter_mut().find(|fix| fix.nodes == nodes) {
        Some(fix) => (0..3).for_each(|i| fix.axes[i] |= axes[i]),
        None => fixes.push(Fix { nodes, axes, displacement: [0.0; 3], place }),
    }
}
