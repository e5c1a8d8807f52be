//! Steps, supports, loads, motions and amplitudes.

use super::Parser;
use super::contact::{dof_range, target};
use super::sets::face;
use crate::Result;
use crate::algebra::{norm, scale};
use crate::deck::card::Card;
use crate::deck::row::Row;
use crate::deck::types::{Action, ActionKind, Entry, NothingKind, Procedure, Spin, Step};

/// Names of supports, with the axes (1 to 6) that they fix.
const SUPPORTS: [(&str, &[[u8; 2]]); 5] = [
    ("ENCASTRE", &[[1, 6]]),
    ("PINNED", &[[1, 3]]),
    ("XSYMM", &[[1, 1], [5, 6]]),
    ("YSYMM", &[[2, 2], [4, 4], [6, 6]]),
    ("ZSYMM", &[[3, 5]]),
];

impl Parser {
    pub(super) fn history(&mut self, card: &Card) -> Result<()> {
        match card.name.as_str() {
            "STEP" => self.step(card),
            "ENDSTEP" => self.end_step(card),
            "STATIC" => self.procedure(card, Procedure::Static),
            "FREQUENCY" => self.frequency(card),
            "COMPLEXFREQUENCY" => self.complex_frequency(card),
            "AMPLITUDE" => self.amplitude(card),
            "BOUNDARY" => self.boundary(card),
            "CLOAD" => self.rows(card, NothingKind::Force, force),
            "DLOAD" => self.rows(card, NothingKind::Distributed, distributed),
            "DSLOAD" => self.rows(card, NothingKind::SurfacePressure, surface_pressure),
            "MOTION" => self.motion(card),
            other => Err(card.error(format_args!("*{other} is not read yet"))),
        }
    }

    fn step(&mut self, card: &Card) -> Result<()> {
        if let Some(open) = self.open_step {
            let line = self.deck.steps[open].place.line;
            return Err(card.error(format_args!("a step within the step of line {line}, which has not ended")));
        }
        let nlgeom = card.choice("NLGEOM", &["", "YES", "NO"])? != 2 && card.has("NLGEOM");
        if nlgeom {
            self.note("NLGEOM: displacements and strains are small");
        }
        let perturbation = card.has("PERTURBATION");
        // The line below is a text.
        self.open_step = Some(self.deck.steps.len());
        let (procedure, actions) = (Procedure::None, Vec::new());
        self.deck.steps.push(Step { procedure, actions, nlgeom, perturbation, place: card.place });
        Ok(())
    }

    /// Notes what a reader should know, once.
    pub(super) fn note(&mut self, note: &str) {
        if !self.deck.notes.iter().any(|known| known == note) {
            self.deck.notes.push(note.to_owned());
        }
    }

    fn end_step(&mut self, card: &Card) -> Result<()> {
        match self.open_step.take() {
            None => Err(card.error("*END STEP without a *STEP")),
            Some(step) if self.deck.steps[step].procedure == Procedure::None => {
                let why = "the step has no procedure: *STATIC, *FREQUENCY or *COMPLEX FREQUENCY";
                Err(self.lines.error(self.deck.steps[step].place, why))
            }
            Some(_) => Ok(()),
        }
    }

    pub(super) fn end_of_step(&self) -> Result<()> {
        match self.open_step {
            None => Ok(()),
            Some(step) => {
                Err(self.lines.error(self.deck.steps[step].place, "the step does not end: the deck is cut off"))
            }
        }
    }

    fn procedure(&mut self, card: &Card, procedure: Procedure) -> Result<()> {
        let Some(step) = self.open_step else {
            return Err(card.error(format_args!("{} outside a step", card.spelled)));
        };
        if self.deck.steps[step].procedure != Procedure::None {
            return Err(card.error(format_args!("a second procedure in the step ({})", card.spelled)));
        }
        self.deck.steps[step].procedure = procedure;
        Ok(())
    }

    /// The number of modes, their lowest and highest frequency.
    fn band(&mut self) -> Result<[Option<f64>; 2]> {
        let Some(row) = self.lines.row()? else { return Ok([None; 2]) };
        let end = |i: usize| match row.field(i) {
            "" => Ok(None),
            _ => row.real(i, "a frequency").map(Some),
        };
        Ok([end(1)?, end(2)?])
    }

    fn frequency(&mut self, card: &Card) -> Result<()> {
        let band = self.band()?;
        self.procedure(card, Procedure::Frequency(band))
    }

    fn complex_frequency(&mut self, card: &Card) -> Result<()> {
        let coriolis = card.has("CORIOLIS");
        let friction_damping = card.choice("FRICTIONDAMPING", &["NO", "YES"])? == 1;
        let band = self.band()?;
        self.procedure(card, Procedure::ComplexFrequency { band, friction_damping, coriolis })
    }

    /// Pairs of time and value; the last value is what a step ends with.
    fn amplitude(&mut self, card: &Card) -> Result<()> {
        let name = self.name_of(card, "NAME")?;
        card.choice("DEFINITION", &["TABULAR", "SMOOTHSTEP", "EQUALLYSPACED"])?;
        let mut last = None;
        while let Some(row) = self.lines.row()? {
            let n = row.fields().count();
            last = Some(row.real(n - 1, "a value of the amplitude")?);
        }
        let value = last.ok_or_else(|| card.error("the amplitude has no values"))?;
        self.deck.amplitudes.insert(name, value);
        Ok(())
    }

    fn boundary(&mut self, card: &Card) -> Result<()> {
        let refused = [
            ("USER", "displacements of a user's subroutine are not supported"),
            ("FIXED", "holding displacements at their values in the deformed structure is not supported"),
        ];
        if let Some((_, why)) = refused.iter().find(|(name, _)| card.has(name)) {
            return Err(card.error(format_args!("{why} (*BOUNDARY)")));
        }
        card.choice("TYPE", &["DISPLACEMENT", "VELOCITY", "ACCELERATION"])?;
        self.rows(card, NothingKind::Boundary, boundary_row)
    }

    /// A keyword with an action or more on each line.
    fn rows(
        &mut self,
        card: &Card,
        kind: NothingKind,
        read: fn(&Row, &mut Vec<ActionKind>) -> Result<()>,
    ) -> Result<()> {
        let is_new = card.choice("OP", &["MOD", "NEW"])? == 1;
        if let Some(name) = ["FOLLOWER", "USER", "SECTOR"]
            .into_iter()
            .find(|name| card.has(name) && card.word(name).as_deref() != Some("NO"))
        {
            return Err(card.error(format_args!("{name} is not supported ({})", card.spelled)));
        }
        self.check_amplitude(card)?;
        let mut found = Vec::new();
        while let Some(row) = self.lines.row()? {
            let mut actions = Vec::new();
            read(&row, &mut actions)?;
            found.extend(actions.into_iter().map(|what| Action { what, is_new, place: row.place }));
        }
        if found.is_empty() {
            found.push(Action { what: ActionKind::Nothing(kind), is_new, place: card.place });
        }
        found.into_iter().for_each(|action| self.act(action));
        Ok(())
    }

    /// Loads act with their full values at the end of a step.
    fn check_amplitude(&self, card: &Card) -> Result<()> {
        let Some(name) = card.word("AMPLITUDE") else { return Ok(()) };
        match self.deck.amplitudes.get(&name) {
            Some(value) if *value == 1.0 => Ok(()),
            Some(value) => {
                Err(card.error(format_args!("the amplitude {name} ends with {value}, not 1. Scale the values instead")))
            }
            None => Err(card.error(format_args!("there is no *AMPLITUDE {name} above"))),
        }
    }

    fn motion(&mut self, card: &Card) -> Result<()> {
        if card.has("TRANSLATION") || card.has("USER") || !card.has("ROTATION") {
            return Err(card.error("a motion is a steady rotation: *MOTION, ROTATION"));
        }
        let is_new = card.choice("OP", &["MOD", "NEW"])? == 1;
        let mut found = Vec::new();
        while let Some(row) = self.lines.row()? {
            let (of, speed) = (target(&row, 0)?, row.real(1, "the speed")?);
            let spin = Spin { speed, from: row.reals(2, "a coordinate")?, to: row.reals(5, "a coordinate")? };
            if spin.from == spin.to {
                return Err(row.error("the two points of the axis of rotation are the same"));
            }
            found.push(Action { what: ActionKind::Rotation(of, spin), is_new, place: row.place });
        }
        if found.is_empty() {
            return Err(card.error("the node set and its axis are missing (*MOTION)"));
        }
        found.into_iter().for_each(|action| self.act(action));
        Ok(())
    }

    /// Puts an action into the open step, or before all steps.
    pub(super) fn act(&mut self, action: Action) {
        match self.open_step {
            Some(step) => self.deck.steps[step].actions.push(action),
            None => self.deck.initial.push(action),
        }
    }
}

fn boundary_row(row: &Row, found: &mut Vec<ActionKind>) -> Result<()> {
    let of = target(row, 0)?;
    let word = row.field(1).to_uppercase();
    if let Some((_, ranges)) = SUPPORTS.iter().find(|(name, _)| *name == word) {
        found.extend(ranges.iter().map(|range| ActionKind::Boundary(of.clone(), *range, 0.0)));
        return Ok(());
    }
    let range = dof_range(row, 1)?;
    found.push(ActionKind::Boundary(of, range, row.real_or(3, 0.0, "the displacement")?));
    Ok(())
}

fn force(row: &Row, found: &mut Vec<ActionKind>) -> Result<()> {
    let (of, [axis, _]) = (target(row, 0)?, dof_range(&Row { text: row.field(1), ..*row }, 0)?);
    found.push(ActionKind::Force(of, axis, row.real(2, "the force")?));
    Ok(())
}

fn distributed(row: &Row, found: &mut Vec<ActionKind>) -> Result<()> {
    let label = row.field(1).to_uppercase();
    let of = || target(row, 0);
    found.push(match label.as_str() {
        "GRAV" => {
            let of: Option<Entry> = if row.field(0).is_empty() { None } else { Some(of()?) };
            ActionKind::Gravity(of, gravity(row)?)
        }
        "CENTRIF" => ActionKind::Centrifugal(of()?, centrifugal(row)?),
        _ if label.starts_with('P') => {
            ActionKind::FacePressure(of()?, face(row, &label, 'P')?, row.real(2, "the pressure")?)
        }
        _ => {
            let known = "On solids: P1 to P6, a pressure on a face, GRAV, gravity, and CENTRIF, the centrifugal force";
            return Err(row.error(format_args!("the load {:?} is not supported. {known}", row.field(1))));
        }
    });
    Ok(())
}

/// An acceleration: its size, and a direction of any length.
fn gravity(row: &Row) -> Result<[f64; 3]> {
    let size = row.real(2, "the acceleration")?;
    let direction: [f64; 3] = row.reals(3, "a component")?;
    if direction == [0.0; 3] {
        return Err(row.error("the direction of gravity is missing (GRAV)"));
    }
    Ok(scale(size / norm(direction), direction))
}

/// The square of a speed, a point of the axis and its direction.
fn centrifugal(row: &Row) -> Result<Spin> {
    let square = row.real(2, "the square of the speed of rotation")?;
    if square < 0.0 {
        return Err(row.error(format_args!("the square of the speed of rotation is {square}, below 0")));
    }
    let (from, axis): ([f64; 3], [f64; 3]) = (row.reals(3, "a coordinate")?, row.reals(6, "a component")?);
    if axis == [0.0; 3] {
        return Err(row.error("the direction of the axis of rotation is missing (CENTRIF)"));
    }
    Ok(Spin { speed: square.sqrt(), from, to: [0, 1, 2].map(|i| from[i] + axis[i]) })
}

fn surface_pressure(row: &Row, found: &mut Vec<ActionKind>) -> Result<()> {
    let surface = row.name(0, "the surface")?.to_uppercase();
    if !row.field(1).eq_ignore_ascii_case("P") {
        let what = format_args!("the load {:?} is not supported. On surfaces: P, a pressure", row.field(1));
        return Err(row.error(what));
    }
    found.push(ActionKind::SurfacePressure(surface, row.real(2, "the pressure")?));
    Ok(())
}
