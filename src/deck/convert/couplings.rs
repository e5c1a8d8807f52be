//! Couplings of reference nodes, and the springs and dashpots between them.
//!
//! A kinematic coupling whose reference node is held is a support of its surface. A distributing coupling spreads a
//! force on its reference node, or is one end of a connector: springs and dashpots between the reference nodes of two
//! of them, which lie at one point.

use super::Conversion;
use super::history::State;
use crate::Result;
use crate::algebra::{cross, norm, sub};
use crate::deck::elements::Class;
use crate::deck::geometry::surface_centroid;
use crate::deck::sets::{Faces, Kind};
use crate::deck::types::{ActionKind, Coupling, Property, PropertyKind};
use crate::model::{Connector, Fix, Load, LoadKind, Place};

/// Points this near, relative to the size of the mesh, are one.
const SAME_POINT: f64 = 1e-6;

/// A coupling with what acts on its reference node.
struct Reference<'d> {
    coupling: &'d Coupling,
    /// Node of the assembly.
    node: u32,
    /// Surface or node set of the mesh.
    region: String,
    /// Which of its six displacements are held.
    held: [bool; 6],
    /// Force and moment on it, in the deck's unit.
    force: [f64; 6],
    /// Where that stands.
    force_place: Option<Place>,
}

impl Conversion<'_> {
    /// The connectors; supports and loads of reference nodes are added to those of solids.
    pub(super) fn couplings(
        &mut self,
        state: &State,
        fixes: &mut Vec<Fix>,
        loads: &mut Vec<Load>,
    ) -> Result<Vec<Connector>> {
        let mut references = Vec::new();
        for coupling in &self.deck.couplings {
            references.push(self.reference(coupling)?);
        }
        self.require_known_nodes(state, &mut references)?;
        for reference in &references {
            if reference.coupling.is_kinematic {
                fixes.push(self.held_surface(reference)?);
            } else if reference.force != [0.0; 6] {
                loads.push(self.spread(reference)?);
            }
        }
        self.connectors(&references)
    }

    fn reference<'d>(&mut self, coupling: &'d Coupling) -> Result<Reference<'d>> {
        let node = match self.assembly.set(Kind::Node, 0, &coupling.node, coupling.place)?[..] {
            [node] => node,
            _ => return Err(self.assembly.error(coupling.place, "the reference node of a coupling must be one node")),
        };
        let (space, surface) = self.assembly.surface(&coupling.surface, coupling.place)?;
        let region = if surface.of_nodes {
            let Faces::Nodes(nodes) = self.assembly.faces(space, surface)? else { unreachable!("a surface of nodes") };
            let nodes = self.bodies.used(&nodes);
            self.regions.add_node_set(&self.deck.spelled(&coupling.surface), nodes)
        } else {
            self.surface_name(&coupling.surface, coupling.place)?
        };
        Ok(Reference { coupling, node, region, held: [false; 6], force: [0.0; 6], force_place: None })
    }

    /// Collects what acts on reference nodes, and refuses forces on nodes without any stiffness.
    fn require_known_nodes(&self, state: &State, references: &mut [Reference]) -> Result<()> {
        for (_, action) in state.actions() {
            let (of, axes, value, is_force) = match &action.what {
                ActionKind::Boundary(of, axes, value) => (of, *axes, *value, false),
                ActionKind::Force(of, axis, value) => (of, [*axis; 2], *value, true),
                _ => continue,
            };
            for node in self.assembly.set(Kind::Node, 0, of, action.place)? {
                if self.is_used(node) {
                    continue;
                }
                let Some(reference) = references.iter_mut().find(|reference| reference.node == node) else {
                    if is_force && value != 0.0 {
                        return Err(self
                            .assembly
                            .error(action.place, "a force on a node that belongs to no solid and no coupling"));
                    }
                    continue;
                };
                let axes = usize::from(axes[0]) - 1..usize::from(axes[1]);
                if is_force {
                    reference.force[axes.start] = value;
                    reference.force_place = Some(action.place);
                } else if value == 0.0 {
                    axes.for_each(|axis| reference.held[axis] = true);
                } else {
                    let what = "a displacement other than 0 is not supported. Press the parts together by a load";
                    return Err(self.assembly.error(action.place, what));
                }
            }
        }
        match references.iter().find(|one| !one.coupling.is_kinematic && one.held.contains(&true)) {
            None => Ok(()),
            Some(one) => {
                let what = "a support of the reference node of a distributing coupling is not supported: it holds a mean motion";
                Err(self.assembly.error(one.coupling.place, what))
            }
        }
    }

    /// The support that a kinematic coupling with a held reference node is.
    fn held_surface(&self, reference: &Reference) -> Result<Fix> {
        let (coupling, place) = (reference.coupling, reference.coupling.place);
        if reference.held != [true; 6] {
            let what = "a kinematic coupling is supported where all six displacements of its reference node are held. \
                        Hold them by *BOUNDARY, or use *DISTRIBUTING";
            return Err(self.assembly.error(place, what));
        }
        let is_coupled =
            |axis: u8| coupling.dofs.is_empty() || coupling.dofs.iter().any(|[a, b]| (*a..=*b).contains(&axis));
        Ok(Fix { nodes: reference.region.clone(), axes: [1, 2, 3].map(is_coupled), place })
    }

    /// The uniform traction that a force on the reference node of a distributing coupling becomes. Its line must go
    /// through the centroid, about which a uniform traction has no moment.
    fn spread(&self, reference: &Reference) -> Result<Load> {
        let place = reference.force_place.unwrap_or(reference.coupling.place);
        let [x, y, z, moment @ ..] = reference.force;
        let Some((centroid, size)) = self.centroid(&reference.region) else {
            return Err(self
                .assembly
                .error(place, "a force on a coupling of nodes is not supported. Couple element faces"));
        };
        let at = self.assembly.coordinates[reference.node as usize].map(|x| x * self.units.length);
        let about = norm(cross(sub(at, centroid), [x, y, z]));
        if moment != [0.0; 3] || about > 1e-3 * size * norm([x, y, z]) {
            let what = "a force on a distributing coupling is supported where its line goes through the centroid of the \
                        surface, and without a moment";
            return Err(self.assembly.error(place, what));
        }
        let kind = LoadKind::ForceByArea([x, y, z].map(|f| f * self.units.force()));
        Ok(Load { name: format!("force on {}", reference.region), on: reference.region.clone(), kind, place })
    }

    /// Centroid and size of a surface of the mesh, m.
    fn centroid(&self, surface: &str) -> Option<([f64; 3], f64)> {
        let mesh = &self.regions.mesh;
        let (area, centroid) = surface_centroid(mesh, mesh.surfaces.get(surface)?);
        Some((centroid, area.sqrt()))
    }

    fn connectors(&mut self, references: &[Reference]) -> Result<Vec<Connector>> {
        let mut connectors: Vec<Connector> = Vec::new();
        for (element, property) in self.discrete_elements()? {
            let place = self.assembly.elements[element as usize].place;
            let pair = self.ends(element, references);
            let Some(([first, second], property)) = pair.zip(property) else {
                let kind = self.assembly.elements[element as usize].kind.name;
                let what = "is supported between the reference nodes of two distributing couplings at one point, with the same \
                            displacement of both";
                return Err(self.assembly.error(place, format_args!("a {kind} {what}")));
            };
            let between = [&references[first], &references[second]].map(|end| end.region.clone());
            let at = self.assembly.coordinates[references[first].node as usize].map(|x| x * self.units.length);
            let name = format!("{} / {}", between[0], between[1]);
            let known = connectors.iter().position(|connector| connector.between == between).unwrap_or_else(|| {
                let [stiffness, rotational_stiffness, damping] = [[0.0; 3]; 3];
                connectors.push(Connector {
                    name,
                    between,
                    at: Some(at),
                    stiffness,
                    rotational_stiffness,
                    damping,
                    place,
                });
                connectors.len() - 1
            });
            self.add_constant(&mut connectors[known], property)?;
        }
        Ok(connectors)
    }

    /// Springs, dashpots and masses with their properties.
    fn discrete_elements(&self) -> Result<Vec<(u32, Option<&Property>)>> {
        let mut all: Vec<(u32, Option<&Property>)> = Vec::new();
        for (space, own) in self.assembly.spaces.iter().enumerate() {
            for property in own.scopes.iter().flat_map(|scope| &scope.properties) {
                let entry = crate::deck::parse::entry(&property.set);
                let elements = self.assembly.set(Kind::Element, space, &entry, property.place)?;
                all.extend(elements.into_iter().map(|element| (element, Some(property))));
            }
        }
        let is_discrete = |e: &u32| self.assembly.elements[*e as usize].kind.class == Class::Discrete;
        let without: Vec<u32> = (0..self.assembly.elements.len() as u32)
            .filter(|e| is_discrete(e) && !all.iter().any(|(own, _)| own == e))
            .collect();
        all.extend(without.into_iter().map(|e| (e, None)));
        Ok(all)
    }

    /// The distributing couplings at the two ends of an element that lie at one point.
    fn ends(&self, element: u32, references: &[Reference]) -> Option<[usize; 2]> {
        let &[first, second] = self.assembly.nodes(element) else { return None };
        let at = |node: u32| self.assembly.coordinates[node as usize];
        let size = norm(at(first)).max(norm(at(second))).max(1.0);
        if norm(sub(at(first), at(second))) > SAME_POINT * size {
            return None;
        }
        let coupling = |node: u32| references.iter().position(|one| one.node == node && !one.coupling.is_kinematic);
        Some([coupling(first)?, coupling(second)?])
    }

    fn add_constant(&self, connector: &mut Connector, property: &Property) -> Result<()> {
        let Some([first, second]) = property.dofs.filter(|[a, b]| a == b && (1..=6).contains(a)) else {
            let what = "a spring or dashpot acts between the same displacement (1 to 6) of both ends";
            return Err(self.assembly.error(property.place, what));
        };
        let (axis, units) = ((usize::from(first) - 1) % 3, &self.units);
        match (property.kind, second > 3) {
            (PropertyKind::Spring, false) => connector.stiffness[axis] += property.value * units.stiffness(),
            (PropertyKind::Spring, true) => {
                connector.rotational_stiffness[axis] += property.value * units.rotational_stiffness();
            }
            (PropertyKind::Dashpot, false) => connector.damping[axis] += property.value * units.damping(),
            _ => {
                return Err(self
                    .assembly
                    .error(property.place, "masses and dashpots against rotation are not supported"));
            }
        }
        Ok(())
    }
}
