//! Materials, sections and laws of contact.

use std::fmt::Write;

use super::{DeckWriter, number};
use crate::deck::VOIGT_ORDER;
use crate::model::{Contact, NormalLaw, Part, isotropic};

/// Constants on a line.
const PER_LINE: usize = 8;
/// Overlap at which a table of a cubic law ends, m.
const MICROMETRE: f64 = 1e-6;

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
                let triangle =
                    (0..6).flat_map(|column| (0..=column).map(move |row| [row, column].map(|i| VOIGT_ORDER[i])));
                let constants: Vec<String> =
                    triangle.map(|[i, j]| number(material.elasticity[i][j] / units.stress())).collect();
                let lines: Vec<String> = constants.chunks(PER_LINE).map(|line| line.join(",")).collect();
                format!("*ELASTIC,TYPE=ANISOTROPIC\n{}\n", lines.join("\n"))
            }
        };
        let (alpha, beta) = (part.rayleigh.alpha * units.time, part.rayleigh.beta / units.time);
        let constants = [("ALPHA", alpha), ("BETA", beta), ("STRUCTURAL", material.loss_factor)];
        let constants = constants.iter().filter(|(_, x)| *x != 0.0).map(|(key, x)| format!(",{key}={}", number(*x)));
        let damping = match constants.collect::<String>() {
            none if none.is_empty() => none,
            constants => format!("*DAMPING{constants}\n"),
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
        match &contact.law {
            None => out += &format!("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=HARD{separation}\n"),
            Some(NormalLaw::Linear { stiffness }) => {
                let stiffness = number(stiffness / unit);
                out += &format!("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR{separation}\n{stiffness}\n");
            }
            Some(NormalLaw::Cubic { k1, k3 }) => {
                out += &format!("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR{separation}\n0.0,0.0\n");
                for d in (1..=10).map(|i| f64::from(i) * MICROMETRE) {
                    let pressure = number((k1 * d + k3 * d.powi(3)) / self.units.stress());
                    out += &format!("{pressure},{}\n", number(d / self.units.length));
                }
            }
            Some(NormalLaw::Table { rows }) => {
                out += &format!("*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR{separation}\n");
                for [d, pressure] in rows {
                    let pressure = number(pressure / self.units.stress());
                    out += &format!("{pressure},{}\n", number(d / self.units.length));
                }
            }
        }
        let stick = contact.stick.map_or_else(String::new, |stick| format!(",{}", number(stick / unit)));
        if contact.friction > 0.0 || contact.stick.is_some() {
            out += &format!("*FRICTION\n{}{stick}\n", number(contact.friction));
        }
        let (slave, master) = (self.names.region(&contact.slave), self.names.region(&contact.master));
        let adjust = if contact.adjust > 0.0 {
            format!(",ADJUST={}", number(contact.adjust / self.units.length))
        } else {
            String::new()
        };
        let clearance = contact.clearance.map_or_else(String::new, |gap| {
            format!("*CLEARANCE,MASTER={master},SLAVE={slave},VALUE={}\n", number(gap / self.units.length))
        });
        let pair =
            format!("*CONTACT PAIR,INTERACTION=LAW{},TYPE=SURFACE TO SURFACE{adjust}\n{slave},{master}\n", i + 1);
        out + &pair + &clearance
    }
}
