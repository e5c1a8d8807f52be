//! Connector elements: their types, elasticity and damping.

use super::Parser;
use crate::Result;
use crate::deck::card::Card;
use crate::deck::types::{ConnectorBehaviour, ConnectorSection, N_COMPONENTS};

impl Parser {
    pub(super) fn connector(&mut self, card: &Card) -> Result<()> {
        match card.name.as_str() {
            "CONNECTORSECTION" => self.connector_section(card),
            "CONNECTORBEHAVIOR" => self.connector_behaviour(card),
            _ => self.connector_constant(card),
        }
    }

    /// The types on the first line, the axes on the second.
    fn connector_section(&mut self, card: &Card) -> Result<()> {
        let set = self.name_of(card, "ELSET")?;
        let behaviour = card.word("BEHAVIOR");
        let (mut types, mut orientation) = (Vec::new(), None);
        while let Some(row) = self.lines.row()? {
            let names: Vec<String> = row.fields().filter(|name| !name.is_empty()).map(str::to_uppercase).collect();
            match &names[..] {
                _ if types.is_empty() => types = names,
                [] => {}
                [name] if orientation.is_none() => orientation = Some(name.clone()),
                _ => {
                    return Err(
                        row.error("axes at both ends of a connector are not supported. Keep those of the first")
                    );
                }
            }
        }
        if types.is_empty() {
            return Err(card.error("the type of the connector is missing (*CONNECTOR SECTION)"));
        }
        self.deck.connector_sections.push(ConnectorSection { set, types, behaviour, orientation, place: card.place });
        Ok(())
    }

    fn connector_behaviour(&mut self, card: &Card) -> Result<()> {
        let name = self.name_of(card, "NAME")?;
        let [elasticity, damping] = [[0.0; N_COMPONENTS]; 2];
        self.deck.connector_behaviours.push(ConnectorBehaviour { name, elasticity, damping, place: card.place });
        Ok(())
    }

    /// The constant of a component.
    fn connector_constant(&mut self, card: &Card) -> Result<()> {
        let component = card.number("COMPONENT")?.unwrap_or(0.0);
        let component = (1..=N_COMPONENTS).find(|&known| known as f64 == component).ok_or_else(|| {
            card.error(format_args!("COMPONENT= must be one of 1 to {N_COMPONENTS} ({})", card.spelled))
        })?;
        let mut constant = None;
        while let Some(row) = self.lines.row()? {
            let value = row.real(0, "the constant")?;
            if value < 0.0 {
                return Err(row.error(format_args!("the constant must be 0 or above, not {value}")));
            }
            if constant.replace(value).is_some() {
                return Err(row.error("a second constant: it depends on something. Keep one row"));
            }
        }
        let constant =
            constant.ok_or_else(|| card.error(format_args!("the constant is missing ({})", card.spelled)))?;
        let missing = || card.error(format_args!("{} before any *CONNECTOR BEHAVIOR", card.spelled));
        let behaviour = self.deck.connector_behaviours.last_mut().ok_or_else(missing)?;
        match card.name.as_str() {
            "CONNECTORELASTICITY" => behaviour.elasticity[component - 1] = constant,
            _ => behaviour.damping[component - 1] = constant,
        }
        Ok(())
    }
}
