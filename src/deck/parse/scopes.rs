//! Parts, the assembly and its instances.

use super::{At, Parser};
use crate::Result;
use crate::deck::card::Card;
use crate::deck::types::{Instance, Scope, Turn};
use crate::model::Place;

impl Parser {
    pub(super) fn scope_card(&mut self, card: &Card) -> Result<()> {
        match card.name.as_str() {
            "PART" => self.part(card),
            "INSTANCE" => self.instance(card),
            "ENDPART" | "ENDINSTANCE" => self.close(card),
            // The assembly is everything outside parts.
            _ => self.require_outside(card),
        }
    }

    fn part(&mut self, card: &Card) -> Result<()> {
        self.require_outside(card)?;
        let name = self.name_of(card, "NAME")?;
        if let Some(other) = self.deck.parts.iter().find(|part| part.name == name) {
            let line = other.place.line;
            return Err(
                card.error(format_args!("the part {name} is there already, in line {line}. Rename one of them"))
            );
        }
        self.at = At::Part(self.deck.parts.len());
        self.deck.parts.push(Scope { name, place: card.place, ..Scope::default() });
        Ok(())
    }

    fn instance(&mut self, card: &Card) -> Result<()> {
        self.require_outside(card)?;
        let (name, part) = (self.name_of(card, "NAME")?, self.name_of(card, "PART")?);
        if let Some(other) = self.deck.instances.iter().find(|instance| instance.name == name) {
            let line = other.place.line;
            return Err(card.error(format_args!("two instances are called {name} (line {line}). Rename one of them")));
        }
        let mut instance = Instance {
            name,
            part,
            translation: [0.0; 3],
            rotation: None,
            own: Scope { place: card.place, ..Scope::default() },
            place: card.place,
        };
        if let Some(row) = self.lines.row()? {
            instance.translation = row.reals(0, "a component of the translation")?;
        }
        if let Some(row) = self.lines.row()? {
            let values: [f64; 7] = row.reals(0, "a number of the rotation")?;
            let [x, y, z, u, v, w, degrees] = values;
            let turn = Turn { from: [x, y, z], to: [u, v, w], degrees };
            if turn.from == turn.to {
                return Err(row.error("the two points of the axis of rotation are the same"));
            }
            instance.rotation = Some(turn);
        }
        self.at = At::Instance(self.deck.instances.len());
        self.deck.instances.push(instance);
        Ok(())
    }

    fn close(&mut self, card: &Card) -> Result<()> {
        let closes = match self.at {
            At::Part(_) => card.name == "ENDPART",
            At::Instance(_) => card.name == "ENDINSTANCE",
            At::Assembly => false,
        };
        if !closes {
            return Err(card.error(format_args!("{} ends nothing that has begun", card.spelled)));
        }
        self.at = At::Assembly;
        Ok(())
    }

    fn require_outside(&self, card: &Card) -> Result<()> {
        match self.unclosed() {
            None => Ok(()),
            Some((what, place)) => {
                let line = place.line;
                Err(card.error(format_args!("{} within the {what} of line {line}, which has not ended", card.spelled)))
            }
        }
    }

    pub(super) fn end_of_scopes(&self) -> Result<()> {
        match self.unclosed() {
            None => Ok(()),
            Some((what, place)) => {
                Err(self.lines.error(place, format_args!("the {what} does not end: the deck is cut off")))
            }
        }
    }

    fn unclosed(&self) -> Option<(&'static str, Place)> {
        match self.at {
            At::Assembly => None,
            At::Part(i) => Some(("part", self.deck.parts[i].place)),
            At::Instance(i) => Some(("instance", self.deck.instances[i].place)),
        }
    }
}
