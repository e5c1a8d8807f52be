//! Materials.

use super::Parser;
use crate::Result;
use crate::deck::card::Card;
use crate::deck::types::{Elastic, ElasticKind, Material};

/// Numbers on a line of a table of constants.
const PER_LINE: usize = 8;

impl Parser {
    pub(super) fn material(&mut self, card: &Card) -> Result<()> {
        match card.name.as_str() {
            "MATERIAL" => self.begin_material(card),
            "ELASTIC" => self.elastic(card),
            "DENSITY" => self.density(card),
            _ => self.damping(card),
        }
    }

    fn begin_material(&mut self, card: &Card) -> Result<()> {
        let name = self.name_of(card, "NAME")?;
        if let Some(other) = self.deck.materials.iter().find(|material| material.name == name) {
            let line = other.place.line;
            return Err(
                card.error(format_args!("the material {name} is there already, in line {line}. Rename one of them"))
            );
        }
        let (elastic, density) = (None, None);
        let [alpha, beta, structural] = [0.0; 3];
        self.deck.materials.push(Material { name, elastic, density, alpha, beta, structural, place: card.place });
        Ok(())
    }

    /// Constants, eight a line; a second set of them is for another temperature.
    fn elastic(&mut self, card: &Card) -> Result<()> {
        self.open_material(card)?;
        let kind = card.choice("TYPE", &ElasticKind::ALL.map(|(name, ..)| name))?;
        let (name, kind, n) = ElasticKind::ALL[kind];
        let mut constants = Vec::new();
        let mut place = card.place;
        while let Some(row) = self.lines.row()? {
            if constants.len() >= n {
                let what =
                    "a second row of constants: they depend on the temperature, which is not analysed. Keep one row";
                return Err(row.error(what));
            }
            if constants.is_empty() {
                place = row.place;
            }
            // What follows the last constant is the temperature.
            let wanted = (n - constants.len()).min(PER_LINE);
            for i in 0..wanted.min(row.fields().count()) {
                constants.push(row.real(i, "an elastic constant")?);
            }
        }
        if constants.len() < n {
            let what = format_args!("{} elastic constants, but {name} has {n}", constants.len());
            return Err(self.lines.error(place, what));
        }
        self.open_material(card)?.elastic = Some(Elastic { kind, constants, place });
        Ok(())
    }

    fn density(&mut self, card: &Card) -> Result<()> {
        self.open_material(card)?;
        let mut density = None;
        while let Some(row) = self.lines.row()? {
            if density.is_some() {
                let what = "a second density: it depends on the temperature, which is not analysed. Keep one row";
                return Err(row.error(what));
            }
            let value = row.real(0, "the density")?;
            if value <= 0.0 {
                return Err(row.error(format_args!("the density must be above 0, not {value}")));
            }
            density = Some((value, row.place));
        }
        if density.is_none() {
            return Err(card.error("the density is missing"));
        }
        self.open_material(card)?.density = density;
        Ok(())
    }

    fn damping(&mut self, card: &Card) -> Result<()> {
        if card.number("COMPOSITE")?.is_some_and(|c| c != 0.0) {
            return Err(card.error("composite damping is not supported. Give ALPHA=, BETA= or STRUCTURAL="));
        }
        let constant = |key: &str| Ok(card.number(key)?.unwrap_or(0.0));
        let (alpha, beta, structural) = (constant("ALPHA")?, constant("BETA")?, constant("STRUCTURAL")?);
        if [alpha, beta, structural].iter().any(|&x| x < 0.0) {
            return Err(card.error("ALPHA, BETA and STRUCTURAL must be 0 or above"));
        }
        let material = self.open_material(card)?;
        (material.alpha, material.beta, material.structural) = (alpha, beta, structural);
        Ok(())
    }

    /// The material that is being defined.
    fn open_material(&mut self, card: &Card) -> Result<&mut Material> {
        self.deck.materials.last_mut().ok_or_else(|| card.error(format_args!("{} before any *MATERIAL", card.spelled)))
    }
}
