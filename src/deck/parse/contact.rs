//! Laws of contact, contact pairs and couplings.

use super::Parser;
use super::sets::entry;
use crate::Result;
use crate::deck::card::Card;
use crate::deck::catalogue::treatment;
use crate::deck::row::Row;
use crate::deck::types::{
    Action, ActionKind, Adjust, Behaviour, ContactPair, Coupling, Dependence, Entry, Friction, Interaction,
};

impl Parser {
    pub(super) fn contact(&mut self, card: &Card) -> Result<()> {
        match card.name.as_str() {
            "SURFACEINTERACTION" => self.interaction(card),
            "SURFACEBEHAVIOR" => self.behaviour(card),
            "FRICTION" => self.friction(card),
            "CONTACTPAIR" => self.pair(card),
            _ => self.change_friction(card),
        }
    }

    fn interaction(&mut self, card: &Card) -> Result<()> {
        let name = self.name_of(card, "NAME")?;
        if self.deck.interactions.iter().any(|other| other.name == name) {
            return Err(card.error(format_args!("the interaction {name} is there already. Rename one of them")));
        }
        // A line that follows is the thickness out of the plane.
        let (behaviour, no_separation, friction) = (Behaviour::Hard, false, None);
        self.deck.interactions.push(Interaction { name, behaviour, no_separation, friction, place: card.place });
        Ok(())
    }

    fn open_interaction(&mut self, card: &Card) -> Result<&mut Interaction> {
        let missing = || card.error(format_args!("{} before any *SURFACE INTERACTION", card.spelled));
        self.deck.interactions.last_mut().ok_or_else(missing)
    }

    fn behaviour(&mut self, card: &Card) -> Result<()> {
        let kind = card.choice("PRESSURE-OVERCLOSURE", &["HARD", "LINEAR", "TABULAR", "TIED"])?;
        let mut rows = Vec::new();
        let mut place = card.place;
        while let Some(row) = self.lines.row()? {
            if rows.is_empty() {
                place = row.place;
            }
            rows.push(row.reals::<2>(0, "a number of the contact law")?);
        }
        let behaviour = match (kind, &rows[..]) {
            (0, _) => Behaviour::Hard,
            (_, []) => {
                return Err(card.error(format_args!("the numbers of the contact law are missing ({})", card.spelled)));
            }
            (1, [[stiffness, _], ..]) if *stiffness > 0.0 => Behaviour::Linear(*stiffness, place),
            (3, [[stiffness, _], ..]) if *stiffness > 0.0 => Behaviour::Tied(*stiffness),
            (1 | 3, _) => return Err(self.lines.error(place, "the stiffness of the contact must be above 0")),
            _ => Behaviour::Table(rows, place),
        };
        let no_separation = card.has("NOSEPARATION");
        let interaction = self.open_interaction(card)?;
        (interaction.behaviour, interaction.no_separation) = (behaviour, no_separation);
        Ok(())
    }

    fn friction(&mut self, card: &Card) -> Result<()> {
        let friction = self.friction_values(card)?;
        self.open_interaction(card)?.friction = Some(friction);
        Ok(())
    }

    /// The coefficient, and in CalculiX's decks the stiffness of sticking.
    fn friction_values(&mut self, card: &Card) -> Result<Friction> {
        if card.has("ROUGH") {
            let (dependence, place) = (Dependence::None, card.place);
            return Ok(Friction { coefficient: f64::INFINITY, dependence, stick: None, place });
        }
        if let Some(parameter) = ["TAUMAX", "ANISOTROPIC"].into_iter().find(|name| card.has(name)) {
            return Err(
                card.error(format_args!("{parameter} is not supported ({}): Coulomb friction only", card.spelled))
            );
        }
        let first = self.lines.row()?.ok_or_else(|| card.error("the friction coefficient is missing"))?;
        let mut friction = coefficient(&first)?;
        if card.has("EXPONENTIALDECAY") {
            let [kinetic, decay] = [first.real(1, "the kinetic coefficient")?, first.real(2, "the decay")?];
            (friction.dependence, friction.stick) = (Dependence::Decay { kinetic, decay }, None);
            return Ok(friction);
        }
        let of_table = |row: &Row| row.reals::<4>(0, "coefficient, slip rate, pressure, temperature");
        let mut rows = vec![of_table(&first)?];
        while let Some(row) = self.lines.row()? {
            coefficient(&row)?;
            rows.push(of_table(&row)?);
        }
        if rows.len() > 1 {
            (friction.dependence, friction.stick) = (Dependence::Table(rows), None);
        }
        Ok(friction)
    }

    fn change_friction(&mut self, card: &Card) -> Result<()> {
        let name = self.name_of(card, "INTERACTION")?;
        if self.open_step.is_none() {
            return Err(card.error(format_args!("{} outside a step", card.spelled)));
        }
        let next = self.lines.card()?.filter(|next| next.name == "FRICTION");
        let next = next.ok_or_else(|| card.error(format_args!("no *FRICTION follows ({})", card.spelled)))?;
        treatment(&next)?;
        let friction = self.friction_values(&next)?;
        self.act(Action { what: ActionKind::Friction(name, friction), is_new: false, place: next.place });
        Ok(())
    }

    fn pair(&mut self, card: &Card) -> Result<()> {
        let tied = card.has("TIED");
        let interaction = self.name_of(card, "INTERACTION")?;
        let adjust = self.adjust(card)?;
        let mut n = 0;
        while let Some(row) = self.lines.row()? {
            let [slave, master] = [row.name(0, "the slave surface")?, row.name(1, "the master surface")?];
            let (slave, master) = (slave.to_uppercase(), master.to_uppercase());
            n += 1;
            let (interaction, adjust, place) = (interaction.clone(), adjust.clone(), row.place);
            self.deck.contact_pairs.push(ContactPair { slave, master, interaction, adjust, tied, place });
        }
        if n == 0 { Err(card.error("the two surfaces are missing")) } else { Ok(()) }
    }

    /// A distance, or a set of nodes.
    fn adjust(&mut self, card: &Card) -> Result<Option<Adjust>> {
        let Some(text) = card.value("ADJUST") else { return Ok(None) };
        match crate::deck::row::real(text) {
            Some(gap) if gap >= 0.0 => Ok(Some(Adjust::Within(gap))),
            Some(gap) => Err(card.error(format_args!("ADJUST must be 0 or above, not {gap} (*CONTACT PAIR)"))),
            None => Ok(Some(Adjust::Nodes(self.name_of(card, "ADJUST")?))),
        }
    }

    /// `*COUPLING`, and below it what kind it is.
    pub(super) fn coupling(&mut self, card: &Card) -> Result<()> {
        if card.name == "COUPLING" {
            let (node, surface) = (entry(card.required("REFNODE")?), self.name_of(card, "SURFACE")?);
            let next = self.lines.card()?.filter(|next| ["KINEMATIC", "DISTRIBUTING"].contains(&next.name.as_str()));
            let next = next.ok_or_else(|| card.error("no *KINEMATIC or *DISTRIBUTING follows (*COUPLING)"))?;
            let is_kinematic = next.name == "KINEMATIC";
            let mut dofs = Vec::new();
            while let Some(row) = self.lines.row()? {
                dofs.push(dof_range(&row, 0)?);
            }
            self.deck.couplings.push(Coupling { node, surface, is_kinematic, dofs, place: card.place });
            return Ok(());
        }
        Err(card.error(format_args!("{} without a *COUPLING above it", card.spelled)))
    }
}

fn coefficient(row: &Row) -> Result<Friction> {
    let coefficient = row.real(0, "the friction coefficient")?;
    if coefficient < 0.0 {
        return Err(row.error(format_args!("the friction coefficient must be 0 or above, not {coefficient}")));
    }
    // In a single row the second number is CalculiX's stick slope.
    let stick = row.real_or(1, 0.0, "the stiffness of sticking")?;
    Ok(Friction { coefficient, dependence: Dependence::None, stick: (stick > 0.0).then_some(stick), place: row.place })
}

/// First and last axis (1 to 6) from a field on; the last is the first where it is missing.
pub fn dof_range(row: &Row, first: usize) -> Result<[u8; 2]> {
    let axis = |text: &str| text.parse().ok().filter(|axis| (1..=6).contains(axis));
    let low = axis(row.field(first)).ok_or_else(|| {
        row.error(format_args!("the displacement {:?} is not supported: 1 to 3, rotations 4 to 6", row.field(first)))
    })?;
    let high = match row.field(first + 1) {
        "" => Some(low),
        text => axis(text),
    };
    match high.filter(|high| *high >= low) {
        Some(high) => Ok([low, high]),
        None => Err(row.error(format_args!(
            "the displacements {:?} to {:?} are no range",
            row.field(first),
            row.field(first + 1)
        ))),
    }
}

/// A node or set in a field.
pub fn target(row: &Row, i: usize) -> Result<Entry> {
    Ok(entry(&row.name(i, "the node or set")?))
}
