//! Ties, rigid bodies, equations, multi-point constraints and local axes.

use super::Parser;
use super::contact::target;
use super::sets::entry;
use crate::Result;
use crate::deck::card::Card;
use crate::deck::row::Row;
use crate::deck::types::{
    Clearance, ConstraintKind, EquationDefinition, PointConstraint, RigidDefinition, TermDefinition, TieDefinition,
    Transform,
};

/// Fields of a term of an equation: node, displacement, coefficient.
const FIELDS_OF_TERM: usize = 3;

impl Parser {
    pub(super) fn constraint(&mut self, card: &Card) -> Result<()> {
        match card.name.as_str() {
            "TIE" => self.tie(card),
            "RIGIDBODY" => self.rigid_body(card),
            "EQUATION" => self.equations(card),
            "MPC" => self.point_constraints(card),
            "TRANSFORM" => self.transform(card),
            _ => self.clearance(card),
        }
    }

    fn tie(&mut self, card: &Card) -> Result<()> {
        let name = self.name_of(card, "NAME")?;
        let tolerance = card.number("POSITIONTOLERANCE")?;
        if tolerance.is_some_and(|distance| distance <= 0.0) {
            return Err(card.error("POSITION TOLERANCE must be above 0 (*TIE)"));
        }
        let adjust = card.has("ADJUST") && card.choice("ADJUST", &["YES", "NO"])? == 0;
        let before = self.deck.ties.len();
        while let Some(row) = self.lines.row()? {
            let [slave, master] = [row.name(0, "the slave surface")?, row.name(1, "the master surface")?];
            let (slave, master) = (slave.to_uppercase(), master.to_uppercase());
            let name = name.clone();
            self.deck.ties.push(TieDefinition { name, slave, master, tolerance, adjust, place: row.place });
        }
        if self.deck.ties.len() == before { Err(card.error("the two surfaces are missing (*TIE)")) } else { Ok(()) }
    }

    fn rigid_body(&mut self, card: &Card) -> Result<()> {
        let node = entry(card.required("REFNODE")?);
        let rotation_node = card.value("ROTNODE").map(entry);
        let sets: Vec<&str> =
            ["NSET", "ELSET", "TIENSET", "PINNSET"].into_iter().filter(|name| card.has(name)).collect();
        let &[parameter] = &sets[..] else {
            return Err(card.error("a rigid body has one set: NSET= or ELSET= (*RIGID BODY)"));
        };
        let (set, of_elements) = (self.name_of(card, parameter)?, parameter == "ELSET");
        self.deck.rigid_bodies.push(RigidDefinition { set, of_elements, node, rotation_node, place: card.place });
        Ok(())
    }

    /// The number of terms on a line, then the terms, some a line; again for each equation.
    fn equations(&mut self, card: &Card) -> Result<()> {
        let before = self.deck.equations.len();
        while let Some(row) = self.lines.row()? {
            let (n, place) = (row.number(row.field(0), "the number of terms")? as usize, row.place);
            if n < 2 {
                return Err(row.error("an equation has two terms at least. Take *BOUNDARY for one"));
            }
            let mut terms = Vec::new();
            while terms.len() < n {
                let Some(row) = self.lines.row()? else {
                    let what = format_args!("{} terms, but the equation has {n}", terms.len());
                    return Err(self.lines.error(place, what));
                };
                push_terms(&row, n, &mut terms)?;
            }
            self.deck.equations.push(EquationDefinition { terms, place });
        }
        if self.deck.equations.len() == before { Err(card.error("the equation is missing")) } else { Ok(()) }
    }

    fn point_constraints(&mut self, card: &Card) -> Result<()> {
        let before = self.deck.point_constraints.len();
        while let Some(row) = self.lines.row()? {
            let kind = match row.field(0).to_uppercase().as_str() {
                "BEAM" => ConstraintKind::Beam,
                "TIE" | "PIN" => ConstraintKind::Same,
                other => {
                    let what =
                        format_args!("the constraint {other:?} is not supported (*MPC). There is: BEAM, TIE, PIN");
                    return Err(row.error(what));
                }
            };
            if row.fields().count() != 3 {
                return Err(row.error(format_args!("{} is between two nodes or sets (*MPC)", row.field(0))));
            }
            let nodes = [target(&row, 1)?, target(&row, 2)?];
            self.deck.point_constraints.push(PointConstraint { kind, nodes, place: row.place });
        }
        match self.deck.point_constraints.len() == before {
            true => Err(card.error("the constraint and its nodes are missing (*MPC)")),
            false => Ok(()),
        }
    }

    fn transform(&mut self, card: &Card) -> Result<()> {
        let set = self.name_of(card, "NSET")?;
        let is_cylindrical = card.choice("TYPE", &["R", "C"])? == 1;
        let Some(row) = self.lines.row()? else {
            return Err(card.error("the points of the axes are missing (*TRANSFORM)"));
        };
        let (a, b) = (row.reals(0, "a coordinate")?, row.reals(3, "a coordinate")?);
        let place = row.place;
        self.deck.transforms.push(Transform { set, is_cylindrical, a, b, place });
        Ok(())
    }

    /// The gap of a contact pair, in place of the mesh's.
    fn clearance(&mut self, card: &Card) -> Result<()> {
        let [slave, master] = [self.name_of(card, "SLAVE")?, self.name_of(card, "MASTER")?];
        let Some(value) = card.number("VALUE")? else {
            return Err(card.error("VALUE= is missing (*CLEARANCE). Give VALUE=: a gap by tables is not supported"));
        };
        self.deck.clearances.push(Clearance { slave, master, value, place: card.place });
        Ok(())
    }
}

fn push_terms(row: &Row, most: usize, terms: &mut Vec<TermDefinition>) -> Result<()> {
    let n = row.fields().count();
    if !n.is_multiple_of(FIELDS_OF_TERM) || terms.len() + n / FIELDS_OF_TERM > most {
        return Err(row.error(format_args!("{n} fields: a term is a node, a displacement and a coefficient")));
    }
    for first in (0..n).step_by(FIELDS_OF_TERM) {
        let text = row.field(first + 1);
        let axis = text.parse().ok().filter(|axis| (1..=6).contains(axis));
        let axis = axis.ok_or_else(|| row.error(format_args!("the displacement {text:?} is not supported: 1 to 3")))?;
        let coefficient = row.real(first + 2, "the coefficient")?;
        terms.push(TermDefinition { of: target(row, first)?, axis, coefficient });
    }
    Ok(())
}
