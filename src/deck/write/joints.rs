//! Connectors, ties, rigid sets, point masses, equations, and forces at points: reference nodes with couplings.

use std::fmt::Write;

use super::{DeckWriter, number};
use crate::deck::VOIGT_ORDER;
use crate::deck::geometry::surface_centroid;
use crate::model::{Connector, GROUND, LoadKind, PointMass, Tie};

/// Terms of an equation on a line.
const TERMS_PER_LINE: usize = 4;

/// What acts on a reference node.
pub struct PointForce {
    /// Its number.
    pub node: usize,
    /// N
    pub force: [f64; 3],
    /// N m
    pub moment: [f64; 3],
}

/// Joints as text, and the reference nodes that forces act on.
pub struct Joints {
    pub text: String,
    pub forces: Vec<PointForce>,
}

impl DeckWriter<'_> {
    pub(super) fn joints(&mut self) -> Joints {
        let model = self.model;
        let mut text: String = model.connectors.iter().map(|connector| self.connector(connector)).collect();
        text.extend(model.ties.iter().enumerate().map(|(i, tie)| self.tie(i + 1, tie)));
        for set in &model.rigid_sets {
            let node = self.node(self.mean_point(&set.nodes), &mut text);
            writeln!(text, "*RIGID BODY,NSET={},REF NODE={node}", self.names.region(&set.nodes))
                .expect("a string takes all");
        }
        text.extend(model.masses.iter().map(|mass| self.mass(mass)));
        text += &self.equations();
        let forces = self.forces(&mut text);
        Joints { text, forces }
    }

    /// Reference nodes of the loads that are spread over a region.
    fn forces(&mut self, text: &mut String) -> Vec<PointForce> {
        let (model, mut forces) = (self.model, Vec::new());
        for load in &model.loads {
            let (force, moment, at) = match load.kind {
                LoadKind::ForceByArea(force) => (force, [0.0; 3], None),
                LoadKind::ForceAt { force, moment, at } => (force, moment, at),
                LoadKind::ForceByNode(_) | LoadKind::Pressure(_) | LoadKind::Gravity(_) => continue,
            };
            let node = self.reference(&load.on, at.unwrap_or_else(|| self.mean_point(&load.on)), text);
            forces.push(PointForce { node, force, moment });
        }
        forces
    }

    /// Writes a node at a point; gives its number.
    fn node(&mut self, at: [f64; 3], out: &mut String) -> usize {
        self.n_extra_nodes += 1;
        let node = self.mesh.nodes.len() + self.n_extra_nodes;
        let [x, y, z] = at.map(|x| number(x / self.units.length));
        writeln!(out, "*NODE\n{node},{x},{y},{z}").expect("a string takes all");
        node
    }

    /// Writes a reference node coupled to a region; gives its number.
    fn reference(&mut self, region: &str, at: [f64; 3], out: &mut String) -> usize {
        let (node, mut surface) = (self.node(at, out), self.names.region(region).to_owned());
        let name = self.n_extra_nodes;
        if !self.mesh.surfaces.contains_key(region) {
            let set = surface;
            surface = format!("{set}-coupled-{name}");
            writeln!(out, "*SURFACE,NAME={surface},TYPE=NODE\n{set}").expect("a string takes all");
        }
        write!(out, "*COUPLING,REF NODE={node},SURFACE={surface},CONSTRAINT NAME=COUPLING{name}\n*DISTRIBUTING\n1,6\n")
            .expect("a string takes all");
        node
    }

    /// Springs and dashpots between two reference nodes at one point, or from one to the ground.
    fn connector(&mut self, connector: &Connector) -> String {
        let mut out = String::new();
        let ends: Vec<&String> = connector.between.iter().filter(|end| !self.is_ground(end)).collect();
        let at = connector.at.unwrap_or_else(|| {
            let centres: Vec<[f64; 3]> = ends.iter().map(|end| self.mean_point(end)).collect();
            [0, 1, 2].map(|i| centres.iter().map(|centre| centre[i]).sum::<f64>() / centres.len() as f64)
        });
        let ends: Vec<String> = ends.into_iter().map(|end| self.reference(end, at, &mut out).to_string()).collect();
        let units = self.units;
        let constants = [
            ("SPRING", 0, connector.stiffness, units.stiffness()),
            ("SPRING", 3, connector.rotational_stiffness, units.rotational_stiffness()),
            ("DASHPOT", 0, connector.damping, units.damping()),
        ];
        let orientation = connector.axes.map_or_else(String::new, |[x, y, _]| {
            self.n_orientations += 1;
            let points: Vec<String> = x.iter().chain(&y).map(|&x| number(x)).collect();
            let name = format!("AXES{}", self.n_orientations);
            writeln!(out, "*ORIENTATION,NAME={name}\n{}", points.join(",")).expect("a string takes all");
            format!(",ORIENTATION={name}")
        });
        for (kind, first, values, unit) in constants {
            for (axis, value) in values.into_iter().enumerate().filter(|(_, value)| *value != 0.0) {
                let (set, dof) =
                    (self.element(&format!("{kind}{}", ends.len()), kind, &ends, &mut out), first + axis + 1);
                let (option, imaginary) = match connector.loss_factor {
                    g if kind == "SPRING" && g != 0.0 => {
                        (",COMPLEX STIFFNESS", format!(",{}", number(g * value / unit)))
                    }
                    _ => ("", String::new()),
                };
                writeln!(
                    out,
                    "*{kind},ELSET={set}{orientation}{option}\n{dof},{dof}\n{}{imaginary}",
                    number(value / unit)
                )
                .expect("a string takes all");
            }
        }
        out
    }

    /// Whether an end of a connector does not move.
    fn is_ground(&self, end: &str) -> bool {
        end == GROUND && self.mesh.node_set(end).is_none()
    }

    /// Writes an element in a set of its own, whose name it gives.
    fn element(&mut self, kind: &str, set: &str, nodes: &[String], out: &mut String) -> String {
        self.n_discrete += 1;
        let (element, set) = (self.mesh.elements.len() + self.n_discrete, format!("{set}{}", self.n_discrete));
        writeln!(out, "*ELEMENT,TYPE={kind},ELSET={set}\n{element},{}", nodes.join(",")).expect("a string takes all");
        set
    }

    /// A tie whose stiffness is given is a contact pair, which can say it.
    fn tie(&self, i: usize, tie: &Tie) -> String {
        let pair = [&tie.slave, &tie.master].map(|surface| self.names.region(surface)).join(",");
        match tie.stiffness {
            None => {
                let tolerance =
                    tie.search_distance.map(|d| format!(",POSITION TOLERANCE={}", number(d / self.units.length)));
                format!("*TIE,NAME=TIE{i}{}\n{pair}\n", tolerance.unwrap_or_default())
            }
            Some(stiffness) => format!(
                "*SURFACE INTERACTION,NAME=TIE{i}\n*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TIED\n{}\n\
                 *CONTACT PAIR,INTERACTION=TIE{i},TYPE=SURFACE TO SURFACE\n{pair}\n",
                number(stiffness / self.units.foundation())
            ),
        }
    }

    fn mass(&mut self, mass: &PointMass) -> String {
        let mut out = String::new();
        let node = self.reference(&mass.nodes, mass.at.unwrap_or_else(|| self.mean_point(&mass.nodes)), &mut out);
        let nodes = [node.to_string()];
        if mass.mass > 0.0 {
            let set = self.element("MASS", "MASS", &nodes, &mut out);
            writeln!(out, "*MASS,ELSET={set}\n{}", number(mass.mass / self.units.mass)).expect("a string takes all");
            self.mass_sets.push((mass.name.clone(), set));
        }
        if mass.inertia != [0.0; 6] {
            let set = self.element("ROTARYI", "INERTIA", &nodes, &mut out);
            let unit = self.units.mass * self.units.length.powi(2);
            let values = VOIGT_ORDER.map(|own| number(mass.inertia[own] / unit));
            writeln!(out, "*ROTARY INERTIA,ELSET={set}\n{}", values.join(",")).expect("a string takes all");
        }
        out
    }

    fn equations(&self) -> String {
        let mut out = String::new();
        for equation in &self.model.equations {
            let term = |term: &crate::model::EquationTerm| {
                let node = self.mesh.node_set(&term.node).and_then(|nodes| nodes.first().copied()).unwrap_or(0);
                format!("{},{},{}", node + 1, term.axis + 1, number(term.coefficient))
            };
            let terms: Vec<String> = equation.terms.iter().map(term).collect();
            let lines: Vec<String> = terms.chunks(TERMS_PER_LINE).map(|line| line.join(",")).collect();
            write!(out, "*EQUATION\n{}\n{}\n", terms.len(), lines.join("\n")).expect("a string takes all");
        }
        out
    }

    /// Where a region is on average: the centroid of a surface, the mean of the nodes of a set.
    fn mean_point(&self, region: &str) -> [f64; 3] {
        if let Some(surface) = self.mesh.surfaces.get(region) {
            return surface_centroid(self.mesh, surface).1;
        }
        let nodes = self.mesh.node_set(region).unwrap_or_default();
        [0, 1, 2].map(|i| nodes.iter().map(|&n| self.mesh.nodes[n as usize][i]).sum::<f64>() / nodes.len() as f64)
    }
}
