//! Materials, sections, laws of contact and couplings.

use std::fmt::Write;

use super::{DeckWriter, number};
use crate::deck::geometry::surface_centroid;
use crate::model::{Connector, Contact, LoadKind, NormalLaw, Part, isotropic};

/// Upper triangle by columns in the order 11 22 33 12 13 23: row and column in our order xx yy zz xy yz zx.
const OURS: [usize; 6] = [0, 1, 2, 3, 5, 4];
/// Constants on a line.
const PER_LINE: usize = 8;
/// Overlap at which a table of a cubic law ends, m.
const MICROMETRE: f64 = 1e-6;

/// Couplings as text, and the reference nodes that forces act on.
pub struct Couplings {
    pub text: String,
    /// Number of the reference node and force, N.
    pub forces: Vec<(usize, [f64; 3])>,
}

impl DeckWriter<'_> {
    pub(super) fn properties(&self) -> String {
        let mut written: Vec<&str> = Vec::new();
        let mut out = String::new();
        for part in &self.model.parts {
            let name = self.names.material(&part.name);
            if !written.contains(&name) {
                out += &self.property(part);
                written.push(name);
            }
            writeln!(out, "*SOLID SECTION,ELSET={},MATERIAL={name}", self.names.part(&part.name))
                .expect("a string takes all");
        }
        out
    }

    fn property(&self, part: &Part) -> String {
        let (name, units) = (self.names.material(&part.name), &self.units);
        let material = &part.material;
        let elastic = match isotropic(material) {
            Some([young, poisson]) => format!("*ELASTIC\n{},{}\n", number(young / units.stress()), number(poisson)),
            None => {
                let triangle = (0..6).flat_map(|column| (0..=column).map(move |row| [row, column].map(|i| OURS[i])));
                let constants: Vec<String> =
                    triangle.map(|[i, j]| number(material.elasticity[i][j] / units.stress())).collect();
                let lines: Vec<String> = constants.chunks(PER_LINE).map(|line| line.join(",")).collect();
                format!("*ELASTIC,TYPE=ANISOTROPIC\n{}\n", lines.join("\n"))
            }
        };
        let (alpha, beta) = (part.rayleigh.alpha * units.time, part.rayleigh.beta / units.time);
        let damping = match alpha != 0.0 || beta != 0.0 {
            true => format!("*DAMPING,ALPHA={},BETA={}\n", number(alpha), number(beta)),
            false => String::new(),
        };
        let density = number(material.density / units.density());
        format!("*MATERIAL,NAME={name}\n{elastic}*DENSITY\n{density}\n{damping}")
    }

    pub(super) fn contacts(&self) -> String {
        self.model.contacts.iter().enumerate().map(|(i, contact)| self.contact(i, contact)).collect()
    }

    fn contact(&self, i: usize, contact: &Contact) -> String {
        let unit = self.units.foundation();
        let separation = if contact.separation { "" } else { ",NO SEPARATION" };
        let mut out = format!("*SURFACE INTERACTION,NAME=LAW{}\n", i + 1);
        match contact.law {
            NormalLaw::Linear { stiffness } => {
                let stiffness = number(stiffness / unit);
                out += &format!("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR{separation}\n{stiffness}\n");
            }
            NormalLaw::Cubic { k1, k3 } => {
                out += &format!("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR{separation}\n0.0,0.0\n");
                for d in (1..=10).map(|i| f64::from(i) * MICROMETRE) {
                    let pressure = number((k1 * d + k3 * d.powi(3)) / self.units.stress());
                    out += &format!("{pressure},{}\n", number(d / self.units.length));
                }
            }
        }
        let stick = contact.stick.map_or_else(String::new, |stick| format!(",{}", number(stick / unit)));
        if contact.friction > 0.0 || contact.stick.is_some() {
            out += &format!("*FRICTION\n{}{stick}\n", number(contact.friction));
        }
        let (slave, master) = (self.names.region(&contact.slave), self.names.region(&contact.master));
        out + &format!("*CONTACT PAIR,INTERACTION=LAW{},TYPE=SURFACE TO SURFACE\n{slave},{master}\n", i + 1)
    }

    /// Connectors as springs between two reference nodes at one point; forces spread over a surface by one.
    pub(super) fn couplings(&mut self) -> Couplings {
        let mut couplings = Couplings { text: String::new(), forces: Vec::new() };
        let model = self.model;
        for connector in &model.connectors {
            let text = if self.has_both_ends(connector) { self.connector(connector) } else { String::new() };
            couplings.text += &text;
        }
        for load in &model.loads {
            let LoadKind::ForceByArea(force) = load.kind else { continue };
            let node = self.reference(&load.on, self.mean_point(&load.on), &mut couplings.text);
            couplings.forces.push((node, force));
        }
        couplings
    }

    /// Writes a reference node coupled to a region; gives its number.
    fn reference(&mut self, region: &str, at: [f64; 3], out: &mut String) -> usize {
        self.n_extra_nodes += 1;
        let node = self.mesh.nodes.len() + self.n_extra_nodes;
        let [x, y, z] = at.map(|x| number(x / self.units.length));
        let mut surface = self.names.region(region).to_owned();
        let mut definition = String::new();
        if !self.mesh.surfaces.contains_key(region) {
            let set = surface;
            surface = format!("{set}-coupled-{}", self.n_extra_nodes);
            definition = format!("*SURFACE,NAME={surface},TYPE=NODE\n{set}\n");
        }
        let name = self.n_extra_nodes;
        write!(
            out,
            "*NODE\n{node},{x},{y},{z}\n{definition}*COUPLING,REF NODE={node},SURFACE={surface},CONSTRAINT NAME=COUPLING{name}\n\
             *DISTRIBUTING\n1,6\n"
        )
        .expect("a string takes all");
        node
    }

    fn connector(&mut self, connector: &Connector) -> String {
        let mut out = String::new();
        let centres = connector.between.each_ref().map(|region| self.mean_point(region));
        let middle = [0, 1, 2].map(|i| 0.5 * (centres[0][i] + centres[1][i]));
        let at = connector.at.unwrap_or(middle);
        let ends = connector.between.each_ref().map(|region| self.reference(region, at, &mut out));
        let units = self.units;
        let constants = [
            ("SPRING", 0, connector.stiffness, units.stiffness()),
            ("SPRING", 3, connector.rotational_stiffness, units.rotational_stiffness()),
            ("DASHPOT", 0, connector.damping, units.damping()),
        ];
        for (kind, first, values, unit) in constants {
            for (axis, value) in values.into_iter().enumerate().filter(|(_, value)| *value != 0.0) {
                self.n_springs += 1;
                let (n, dof) = (self.n_springs, first + axis + 1);
                let (element, [a, b]) = (self.mesh.elements.len() + n, ends);
                writeln!(out, "*ELEMENT,TYPE={kind}2,ELSET={kind}{n}\n{element},{a},{b}").expect("a string takes all");
                writeln!(out, "*{kind},ELSET={kind}{n}\n{dof},{dof}\n{}", number(value / unit))
                    .expect("a string takes all");
            }
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
