//! Springs, dashpots and connector elements between reference nodes, nodes of solids and the
//! ground.
//!
//! Our connectors act along the axes of one point. A spring between two points is one where they are one point, or lie
//! one behind the other along the axis of the spring.

use nalgebra::Matrix3;

use super::Conversion;
use super::equations::Axes;
use super::joints::connector;
use super::orientations::{axes, orientation};
use super::references::References;
use super::regions::unlike;
use crate::Result;
use crate::algebra::{dot, norm, scale, sub};
use crate::deck::assembly::Element;
use crate::deck::elements::Class;
use crate::deck::sets::Kind;
use crate::deck::types::{ConnectorBehaviour, ConnectorSection, N_COMPONENTS, Property, PropertyKind};
use crate::model::elasticity::axes_from;
use crate::model::{Connector, GROUND, Model, Place, names};

/// Points this near, relative to the size of the mesh, are one, and directions this close to an axis along it.
const SAME: f64 = 1e-6;

/// What gives elements their constants.
const OWN_KEYWORDS: &str = "*SPRING, *DASHPOT, *MASS, *ROTARY INERTIA or *CONNECTOR SECTION";

/// Types of connector, with the components that are free to have elasticity and those that do not give way.
const CONNECTOR_TYPES: [(&str, [bool; N_COMPONENTS], [bool; N_COMPONENTS]); 8] = {
    const NO: [bool; 3] = [false; 3];
    const ALL: [bool; 6] = [true; 6];
    const NONE: [bool; 6] = [false; 6];
    const ALONG: [bool; 6] = [true, true, true, NO[0], NO[1], NO[2]];
    const ABOUT: [bool; 6] = [false, false, false, true, true, true];
    const ABOUT_X: [bool; 6] = [false, false, false, true, false, false];
    [
        ("CARTESIAN", ALONG, NONE),
        ("ROTATION", ABOUT, NONE),
        ("BUSHING", ALL, NONE),
        ("BEAM", NONE, ALL),
        ("WELD", NONE, ALL),
        ("JOIN", NONE, ALONG),
        ("ALIGN", NONE, ABOUT),
        ("HINGE", ABOUT_X, [true, true, true, false, true, true]),
    ]
};

/// What an element does between its ends: stiffness (N/m, N m/rad) and damping (N s/m) of the six components.
#[derive(Default)]
struct Constants {
    stiffness: [f64; 6],
    damping: [f64; 6],
    /// Of all its stiffnesses.
    loss_factor: f64,
    /// Where they are not the global ones.
    axes: Option<Axes>,
}

impl Constants {
    /// Which components act.
    fn acts(&self) -> [bool; 6] {
        [0, 1, 2, 3, 4, 5].map(|i| self.stiffness[i] != 0.0 || self.damping[i] != 0.0)
    }

    /// Along and about which global axes they may act.
    fn acts_globally(&self) -> [bool; 6] {
        let acts = self.acts();
        let [along, about] = [&acts[..3], &acts[3..]].map(|own| own.contains(&true));
        if self.axes.is_some() { [along, along, along, about, about, about] } else { acts }
    }

    /// The loss factor, where there is a stiffness.
    fn loss(&self) -> Option<f64> {
        (self.stiffness != [0.0; 6]).then_some(self.loss_factor)
    }
}

/// An end of an element.
pub(super) struct End {
    /// Node set or surface, or the ground.
    pub region: String,
    /// m
    pub at: [f64; 3],
}

impl<'d> Conversion<'d> {
    /// Adds springs, dashpots, connectors and masses to a model.
    pub(super) fn discrete(&mut self, references: &References, model: &mut Model) -> Result<()> {
        let mut is_done = vec![false; self.assembly.elements.len()];
        let deck = self.deck;
        for (space, property) in self.properties() {
            let axes = self.axes_of(space, &property.orientation, property.place)?;
            for element in self.elements_of(&property.set, space, property.place, &mut is_done)? {
                match property.kind {
                    PropertyKind::Spring | PropertyKind::Dashpot => {
                        self.spring(element, property, axes, references, model)?
                    }
                    PropertyKind::Mass | PropertyKind::RotaryInertia => {
                        self.mass(element, property, references, model)?
                    }
                }
            }
        }
        for section in &deck.connector_sections {
            let axes = self.axes_of(0, &section.orientation, section.place)?;
            for element in self.elements_of(&section.set, 0, section.place, &mut is_done)? {
                self.connector_element(element, section, axes, references, model)?;
            }
        }
        match self.assembly.elements.iter().zip(is_done).find(|(own, done)| own.kind.class == Class::Discrete && !done)
        {
            None => Ok(()),
            Some((Element { number, kind, place, .. }, _)) => {
                let what = format_args!(
                    "element {number} is a {} without its constants. Give its set {}",
                    kind.name, OWN_KEYWORDS
                );
                Err(self.assembly.error(*place, what))
            }
        }
    }

    fn properties(&self) -> Vec<(usize, &'d Property)> {
        let spaces = self.assembly.spaces.iter().enumerate();
        spaces
            .flat_map(|(i, own)| own.scopes.iter().flat_map(|scope| &scope.properties).map(move |one| (i, one)))
            .collect()
    }

    fn elements_of(&self, set: &str, space: usize, place: Place, is_done: &mut [bool]) -> Result<Vec<u32>> {
        let elements = self.assembly.set(Kind::Element, space, &crate::deck::parse::entry(set), place)?;
        elements.iter().for_each(|&element| is_done[element as usize] = true);
        Ok(elements)
    }

    fn spring(
        &mut self,
        element: u32,
        property: &Property,
        axes: Option<Axes>,
        references: &References,
        model: &mut Model,
    ) -> Result<()> {
        let nodes = self.assembly.nodes(element).to_vec();
        let (axis, axes) = match (property.dofs, &nodes[..]) {
            (None, &[first, second]) => self.axis_between(element, first, second)?,
            (Some([first, second]), _) if (1..=6).contains(&first) && (nodes.len() == 1 || second == first) => {
                (usize::from(first) - 1, axes)
            }
            _ => {
                let what = "a spring or dashpot acts between the same displacement (1 to 6) of both ends. \
                            Give the same twice, or take two springs";
                return Err(self.assembly.error(property.place, what));
            }
        };
        let mut constants = Constants { axes, ..Constants::default() };
        match property.kind {
            PropertyKind::Spring => {
                let [real, imaginary] = [property.values[0], property.values[1]];
                constants.stiffness[axis] = real * self.unit_of_stiffness(axis);
                constants.loss_factor = if imaginary > 0.0 { imaginary / real } else { 0.0 };
            }
            _ => constants.damping[axis] = property.values[0] * self.units.damping(),
        }
        self.join(element, &nodes, &constants, references, model)
    }

    fn unit_of_stiffness(&self, axis: usize) -> f64 {
        if axis < 3 { self.units.stiffness() } else { self.units.rotational_stiffness() }
    }

    /// The axis along which two nodes lie: a global one, or the first of axes of their own.
    fn axis_between(&self, element: u32, first: u32, second: u32) -> Result<(usize, Option<Axes>)> {
        let line = sub(self.point(second), self.point(first));
        let length = norm(line);
        if length == 0.0 {
            let Element { kind, place, .. } = &self.assembly.elements[element as usize];
            let what = format_args!("the ends of a {} are one point, so that it has no direction", kind.name);
            return Err(self.assembly.error(*place, format_args!("{what}. Move an end, or take SPRING2")));
        }
        if let Some(axis) = (0..3).find(|&i| length - line[i].abs() <= SAME * length) {
            return Ok((axis, None));
        }
        let across = (0..3).min_by(|&i, &j| line[i].abs().total_cmp(&line[j].abs())).unwrap_or(0);
        let y_axis = std::array::from_fn(|i| if i == across { 1.0 } else { 0.0 });
        Ok((0, axes_from(scale(1.0 / length, line), y_axis).as_ref().map(rows)))
    }

    /// The axes of an orientation that a space names.
    fn axes_of(&self, space: usize, name: &Option<String>, place: Place) -> Result<Option<Axes>> {
        let Some(name) = name else { return Ok(None) };
        let orientation = orientation(&self.assembly, space, name, place)?;
        axes(&self.assembly, space, orientation).map(|axes| Some(rows(&axes)))
    }

    /// Adds the constants to the connector between the ends of an element.
    fn join(
        &mut self,
        element: u32,
        nodes: &[u32],
        constants: &Constants,
        references: &References,
        model: &mut Model,
    ) -> Result<()> {
        let place = self.assembly.elements[element as usize].place;
        let acts = constants.acts_globally();
        let first = self.end(nodes[0], acts, references, place)?;
        let second = match nodes.get(1) {
            Some(&node) => self.end(node, acts, references, place)?,
            None => End { region: GROUND.to_owned(), at: first.at },
        };
        if first.region == second.region {
            let is_ground = first.region == GROUND;
            return if is_ground {
                Ok(())
            } else {
                Err(self.assembly.error(place, "both ends are on one set. Remove the element, or name two sets"))
            };
        }
        self.require_one_point(&first, &second, constants, place)?;
        if constants.damping[3..] != [0.0; 3] {
            return Err(self.assembly.error(place, "damping of rotations is not supported. Give components 1 to 3"));
        }
        let [first, second] = if first.region == GROUND { [second, first] } else { [first, second] };
        let at = first.at;
        let own = connector_between(model, [first.region, second.region], at, constants, place);
        for i in 0..3 {
            own.stiffness[i] += constants.stiffness[i];
            own.rotational_stiffness[i] += constants.stiffness[3 + i];
            own.damping[i] += constants.damping[i];
        }
        Ok(())
    }

    /// An end of an element that acts along some axes: a reference node, a node of a solid, or one that is held there.
    pub(super) fn end(&mut self, node: u32, acts: [bool; 6], references: &References, place: Place) -> Result<End> {
        let at = self.point(node);
        if let Some(reference) = references.at(node) {
            return Ok(End { region: reference.region.clone(), at });
        }
        if self.is_used(node) {
            if acts[3..].contains(&true) {
                return Err(self.assembly.error(
                    place,
                    "a spring against the rotation of a node of solids, which do not rotate. Take a reference node",
                ));
            }
            return Ok(End { region: self.node_name(node), at });
        }
        let held = references.held.get(&node).copied().unwrap_or_default();
        match (0..6).all(|i| held[i] || !acts[i]) {
            true => Ok(End { region: GROUND.to_owned(), at }),
            false => {
                let number = self.assembly.numbers[node as usize];
                let what = format_args!(
                    "node {number} belongs to no solid and no coupling, and is unconstrained. \
                     Couple it to a surface, or take *BOUNDARY"
                );
                Err(self.assembly.error(place, what))
            }
        }
    }

    /// Refuses ends at two points, unless they lie one behind the other along the axes that act.
    fn require_one_point(&self, first: &End, second: &End, constants: &Constants, place: Place) -> Result<()> {
        let (acts, line) = (constants.acts(), sub(second.at, first.at));
        let line = constants.axes.map_or(line, |axes| axes.map(|axis| dot(axis, line)));
        let size = norm(first.at).max(norm(second.at)).max(self.units.length);
        let is_across = |i: usize| (0..3).any(|j| j != i && line[j].abs() > SAME * size);
        if (0..3).any(|i| acts[i] && is_across(i)) {
            let what = "the ends are two points, and the line between them is not along the axis of the spring. Move one \
                        of them onto the other";
            return Err(self.assembly.error(place, what));
        }
        Ok(())
    }

    fn connector_element(
        &mut self,
        element: u32,
        section: &ConnectorSection,
        axes: Option<Axes>,
        references: &References,
        model: &mut Model,
    ) -> Result<()> {
        let nodes = self.assembly.nodes(element).to_vec();
        let region =
            references.at(nodes[0]).or(references.at(nodes[1])).map_or_else(String::new, |one| one.region.clone());
        let constants = Constants { axes, ..self.connector_constants(section, &region)? };
        self.join(element, &nodes, &constants, references, model)
    }

    /// Which components of a connector are free to have elasticity, and which do not give way.
    fn components(&self, section: &ConnectorSection) -> Result<[[bool; N_COMPONENTS]; 2]> {
        let (mut free, mut rigid) = ([false; N_COMPONENTS], [false; N_COMPONENTS]);
        for name in &section.types {
            let Some((_, own_free, own_rigid)) = CONNECTOR_TYPES.iter().find(|(known, ..)| known == name) else {
                let advice = names::advice(name, CONNECTOR_TYPES.map(|(known, ..)| known));
                let what = format_args!("connectors of the type {name} are not supported. {advice}");
                return Err(self.assembly.error(section.place, what));
            };
            (0..N_COMPONENTS).for_each(|i| {
                free[i] |= own_free[i];
                rigid[i] |= own_rigid[i];
            });
        }
        Ok([free, rigid])
    }

    /// The constants of a connector beside a region.
    fn connector_constants(&self, section: &ConnectorSection, region: &str) -> Result<Constants> {
        let (behaviour, [free, rigid]) = (self.behaviour(section)?, self.components(section)?);
        let [along, about] = self.rigid_stiffness(region);
        let mut constants = Constants::default();
        for i in 0..N_COMPONENTS {
            let has_constant = behaviour.is_some_and(|own| own.elasticity[i] != 0.0 || own.damping[i] != 0.0);
            if has_constant && !free[i] {
                let (component, types) = (i + 1, section.types.join(", "));
                let advice = "Remove the constant, or change the type";
                let what =
                    format_args!("component {component} has a constant, but {types} does not have it free. {advice}");
                return Err(self.assembly.error(section.place, what));
            }
            if rigid[i] {
                constants.stiffness[i] = if i < 3 { along } else { about };
            } else if let Some(own) = behaviour {
                constants.stiffness[i] = own.elasticity[i] * self.unit_of_stiffness(i);
                constants.damping[i] = own.damping[i] * self.units.damping();
            }
        }
        if constants.stiffness == [0.0; 6] && constants.damping == [0.0; 6] {
            return Err(self.assembly.error(
                section.place,
                "the connector has neither elasticity nor damping. Give BEHAVIOR= with *CONNECTOR ELASTICITY",
            ));
        }
        Ok(constants)
    }

    fn behaviour(&self, section: &ConnectorSection) -> Result<Option<&'d ConnectorBehaviour>> {
        let Some(name) = &section.behaviour else { return Ok(None) };
        let all = &self.deck.connector_behaviours;
        all.iter().find(|own| own.name == *name).map(Some).ok_or_else(|| {
            let advice = names::advice(name, all.iter().map(|own| own.name.as_str()));
            self.assembly.error(section.place, format_args!("there is no *CONNECTOR BEHAVIOR {name}. {advice}"))
        })
    }
}

/// Axes as rows.
fn rows(axes: &Matrix3<f64>) -> Axes {
    [0, 1, 2].map(|i| axes.column(i).into_owned().into())
}

/// The connector of a model between two regions at a point, which is added where there is none: another one for other
/// axes, and for a stiffness with another loss factor.
fn connector_between<'m>(
    model: &'m mut Model,
    between: [String; 2],
    at: [f64; 3],
    constants: &Constants,
    place: Place,
) -> &'m mut Connector {
    let (axes, loss_factor) = (constants.axes, constants.loss());
    let is_stiff = |own: &Connector| [own.stiffness, own.rotational_stiffness] != [[0.0; 3]; 2];
    let known = model.connectors.iter().position(|own| {
        let fits = loss_factor.is_none_or(|wanted| wanted == own.loss_factor || !is_stiff(own));
        own.between == between && own.at == Some(at) && own.axes == axes && fits
    });
    let i = known.unwrap_or_else(|| {
        let name =
            unlike(&between.join(" / "), |name| model.connectors.iter().any(|own| own.name == name), "connector");
        model.connectors.push(Connector { axes, ..connector(name, between, at, place) });
        model.connectors.len() - 1
    });
    let own = &mut model.connectors[i];
    own.loss_factor = loss_factor.unwrap_or(own.loss_factor);
    own
}
