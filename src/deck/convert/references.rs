//! Reference nodes: what follows them, and what acts on them.
//!
//! A reference node is none of the mesh's. What is on it (a force, a moment, a mass, the end of a spring, a support)
//! acts on the rigid motion that the nodes of its set make, taken at its point: exactly theirs where they follow
//! rigidly, that on average where the coupling is distributing.

use std::collections::HashMap;

use super::Conversion;
use super::history::State;
use super::supports::OTHER_THAN_ZERO;
use crate::Result;
use crate::deck::sets::{Faces, Kind};
use crate::deck::types::{ActionKind, ConstraintKind, Coupling, Entry, RigidDefinition};
use crate::model::Place;

/// Force or moment on an axis, with the step that it began in.
type Acting = (usize, f64);

/// A reference node with what follows it and what acts on it.
pub(super) struct Reference {
    /// Node of the assembly.
    pub node: u32,
    /// Node of the assembly of which the displacements are the rotations.
    pub rotation_node: Option<u32>,
    /// Surface or node set of the mesh.
    pub region: String,
    /// Whether the region is rigid, rather than following on average.
    pub is_rigid: bool,
    /// Which displacements of the region's nodes follow.
    pub coupled: [bool; 3],
    /// Which of its six displacements are held.
    pub held: [bool; 6],
    /// Its prescribed displacement, in the deck's unit.
    pub displacement: [f64; 3],
    /// Force and moment on it, in the deck's unit.
    pub force: [Acting; 6],
    /// Where that stands.
    pub force_place: Option<Place>,
    /// Where it stands.
    pub place: Place,
}

/// Reference nodes, and other nodes without elements that are held.
pub(super) struct References {
    /// The reference nodes.
    pub all: Vec<Reference>,
    /// Which displacements are held of nodes of no solid and no reference.
    pub held: HashMap<u32, [bool; 6]>,
}

impl References {
    /// The reference at a node.
    pub fn at(&self, node: u32) -> Option<&Reference> {
        self.all.iter().find(|one| one.node == node)
    }
}

impl Conversion<'_> {
    /// All reference nodes with what acts on them.
    pub(super) fn references(&mut self, state: &State) -> Result<References> {
        let deck = self.deck;
        let mut references = References { all: Vec::new(), held: HashMap::new() };
        for coupling in &deck.couplings {
            references.all.push(self.coupling(coupling)?);
        }
        for body in &deck.rigid_bodies {
            references.all.push(self.rigid_body(body)?);
        }
        self.beams(&mut references)?;
        references.all = self.joined(references.all)?;
        self.refuse_shared_nodes(&references)?;
        self.act_on(state, &mut references)?;
        Ok(references)
    }

    /// Rigid regions with one reference node are one region; other couplings at one node are refused.
    fn joined(&mut self, all: Vec<Reference>) -> Result<Vec<Reference>> {
        let mut joined: Vec<Reference> = Vec::new();
        for one in all {
            let Some(known) = joined.iter_mut().find(|known| known.node == one.node) else {
                joined.push(one);
                continue;
            };
            let is_rigid = |reference: &Reference| reference.is_rigid && reference.coupled == [true; 3];
            if !is_rigid(known) || !is_rigid(&one) {
                let number = self.assembly.numbers[one.node as usize];
                let advice = "Give each its own, and join the two by a connector BEAM";
                let what = format_args!("node {number} is the reference node of two couplings. {advice}");
                return Err(self.assembly.error(one.place, what));
            }
            let mut nodes: Vec<u32> = [&known.region, &one.region]
                .into_iter()
                .flat_map(|region| self.regions.mesh.node_set(region).unwrap_or_default())
                .collect();
            nodes.sort_unstable();
            nodes.dedup();
            known.region = self.regions.add_node_set(&format!("{} and {}", known.region, one.region), nodes);
            known.rotation_node = known.rotation_node.or(one.rotation_node);
        }
        Ok(joined)
    }

    /// Refuses reference nodes that belong to a solid, or have local axes.
    fn refuse_shared_nodes(&self, references: &References) -> Result<()> {
        if let Some(one) = references.all.iter().find(|one| self.is_used(one.node)) {
            let number = self.assembly.numbers[one.node as usize];
            let advice = "Give the coupling a node of its own at the same point, and join that to the solid";
            let what = format_args!("the reference node {number} belongs to a solid, which is not supported. {advice}");
            return Err(self.assembly.error(one.place, what));
        }
        for transform in &self.deck.transforms {
            let entry = crate::deck::parse::entry(&transform.set);
            let nodes = self.assembly.set(Kind::Node, 0, &entry, transform.place)?;
            if nodes.iter().any(|&node| references.at(node).is_some()) {
                let what = "local axes of a reference node are not supported (*TRANSFORM). Give its supports and forces \
                            along the global axes";
                return Err(self.assembly.error(transform.place, what));
            }
        }
        Ok(())
    }

    fn coupling(&mut self, coupling: &Coupling) -> Result<Reference> {
        let node = self.one_node(&coupling.node, coupling.place, "the reference node of a coupling")?;
        let (space, surface) = self.assembly.surface(&coupling.surface, coupling.place)?;
        let region = if surface.of_nodes {
            let Faces::Nodes(nodes) = self.assembly.faces(space, surface)? else { unreachable!("a surface of nodes") };
            let nodes = self.bodies.used(&nodes);
            self.regions.add_node_set(&self.deck.spelled(&coupling.surface), nodes)
        } else {
            self.surface_name(&coupling.surface, coupling.place)?
        };
        let is_coupled =
            |axis: u8| coupling.dofs.is_empty() || coupling.dofs.iter().any(|[a, b]| (*a..=*b).contains(&axis));
        let coupled = [1, 2, 3].map(is_coupled);
        Ok(Reference { coupled, ..Reference::new(node, region, coupling.is_kinematic, coupling.place) })
    }

    fn rigid_body(&mut self, body: &RigidDefinition) -> Result<Reference> {
        let node = self.one_node(&body.node, body.place, "the reference node of a rigid body")?;
        let rotation = body.rotation_node.as_ref();
        let rotation_node = rotation.map(|own| self.one_node(own, body.place, "the rotation node of a rigid body"));
        let entry = crate::deck::parse::entry(&body.set);
        let nodes = match body.of_elements {
            false => self.assembly.set(Kind::Node, 0, &entry, body.place)?,
            true => {
                let elements = self.assembly.set(Kind::Element, 0, &entry, body.place)?;
                elements.iter().flat_map(|&element| self.assembly.nodes(element).to_vec()).collect()
            }
        };
        let nodes = self.bodies.used(&nodes);
        if nodes.is_empty() {
            return Err(self.assembly.error(body.place, "the rigid body has no node of a solid. Name nodes of solids"));
        }
        let region = self.regions.add_node_set(&self.deck.spelled(&body.set), nodes);
        Ok(Reference { rotation_node: rotation_node.transpose()?, ..Reference::new(node, region, true, body.place) })
    }

    /// Rigid beams to one node of no solid make a rigid body.
    fn beams(&mut self, references: &mut References) -> Result<()> {
        let mut bodies: Vec<(u32, Vec<u32>, Place)> = Vec::new();
        for beam in self.deck.point_constraints.iter().filter(|one| one.kind == ConstraintKind::Beam) {
            let nodes = self.assembly.set(Kind::Node, 0, &beam.nodes[0], beam.place)?;
            let node = self.one_node(&beam.nodes[1], beam.place, "the second node of a BEAM")?;
            if self.is_used(node) {
                continue;
            }
            match bodies.iter_mut().find(|(known, ..)| *known == node) {
                Some((_, all, _)) => all.extend(nodes),
                None => bodies.push((node, nodes, beam.place)),
            }
        }
        for (node, nodes, place) in bodies {
            let nodes = self.bodies.used(&nodes);
            let region =
                self.regions.add_node_set(&format!("beams to node {}", self.assembly.numbers[node as usize]), nodes);
            references.all.push(Reference::new(node, region, true, place));
        }
        Ok(())
    }

    /// The one node that an entry means.
    pub(super) fn one_node(&self, of: &Entry, place: Place, what: &str) -> Result<u32> {
        match self.assembly.set(Kind::Node, 0, of, place)?[..] {
            [node] => Ok(node),
            _ => Err(self.assembly.error(place, format_args!("{what} must be one node"))),
        }
    }

    /// Collects what acts on reference nodes, and refuses forces on nodes without any stiffness.
    fn act_on(&self, state: &State, references: &mut References) -> Result<()> {
        for (step, action) in state.actions() {
            let (of, axes, value, is_force) = match &action.what {
                ActionKind::Boundary(of, axes, value) => (of, *axes, *value, false),
                ActionKind::Force(of, axis, value) => (of, [*axis; 2], *value, true),
                _ => continue,
            };
            for node in
                self.assembly.set(Kind::Node, 0, of, action.place)?.into_iter().filter(|&node| !self.is_used(node))
            {
                let moves = !is_force && value != 0.0;
                let Some((reference, shift)) = references.acted_on(node) else {
                    if moves {
                        return Err(self.assembly.error(action.place, OTHER_THAN_ZERO));
                    }
                    if is_force && value != 0.0 {
                        let what = "a force on a node that belongs to no solid and no coupling. \
                                    Couple it, or remove the force";
                        return Err(self.assembly.error(action.place, what));
                    }
                    let held = references.held.entry(node).or_default();
                    (axes[0]..=axes[1]).for_each(|axis| held[usize::from(axis) - 1] |= !is_force);
                    continue;
                };
                for axis in (usize::from(axes[0]) - 1 + shift..usize::from(axes[1]) + shift).filter(|&axis| axis < 6) {
                    if is_force {
                        super::supports::add(&mut reference.force[axis], step, value);
                        reference.force_place = Some(action.place);
                    } else {
                        if axis > 2 && moves {
                            return Err(self.assembly.error(action.place, OTHER_THAN_ZERO));
                        }
                        reference.held[axis] = true;
                        reference.displacement.get_mut(axis).into_iter().for_each(|own| *own = value);
                    }
                }
            }
        }
        Ok(())
    }
}

impl Reference {
    fn new(node: u32, region: String, is_rigid: bool, place: Place) -> Reference {
        Reference {
            node,
            rotation_node: None,
            region,
            is_rigid,
            coupled: [true; 3],
            held: [false; 6],
            displacement: [0.0; 3],
            force: [(0, 0.0); 6],
            force_place: None,
            place,
        }
    }
}

impl References {
    /// The reference that an action on a node is for, and by how much its axes are shifted: three on the node of the
    /// rotations.
    fn acted_on(&mut self, node: u32) -> Option<(&mut Reference, usize)> {
        let all = self.all.iter_mut();
        all.filter_map(|one| match node {
            _ if one.node == node => Some((one, 0)),
            _ if one.rotation_node == Some(node) => Some((one, 3)),
            _ => None,
        })
        .next()
    }
}
