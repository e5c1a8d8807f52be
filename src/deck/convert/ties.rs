//! Surfaces that move as one: `*TIE`, and contact pairs that are tied.

use super::Conversion;
use super::regions::unlike;
use crate::Result;
use crate::deck::types::{Adjust, Behaviour, ContactPair};
use crate::model::Tie;

impl Conversion<'_> {
    /// The ties.
    pub(super) fn ties(&mut self) -> Result<Vec<Tie>> {
        let (deck, mut ties) = (self.deck, Vec::<Tie>::new());
        for tie in &deck.ties {
            let [slave, master] =
                [self.surface_name(&tie.slave, tie.place)?, self.surface_name(&tie.master, tie.place)?];
            let name = unlike(&deck.spelled(&tie.name), |name| ties.iter().any(|own| own.name == name), "tie");
            if tie.adjust {
                self.notes.push(format!("ADJUST of the tie {name} is not applied: nodes stay where they are"));
            }
            let search_distance = tie.tolerance.map(|distance| distance * self.units.length);
            ties.push(Tie { name, slave, master, search_distance, stiffness: None, place: tie.place });
        }
        for pair in &deck.contact_pairs {
            let Some(stiffness) = self.tied(pair)? else { continue };
            let [slave, master] =
                [self.surface_name(&pair.slave, pair.place)?, self.surface_name(&pair.master, pair.place)?];
            let name = format!("{slave} / {master}");
            let name = unlike(&name, |name| ties.iter().any(|own| own.name == name), "tie");
            if matches!(pair.adjust, Some(Adjust::Within(_))) {
                self.notes.push(format!("ADJUST of the tied pair {name} is not applied: nodes stay where they are"));
            }
            let stiffness = stiffness.map(|stiffness| stiffness * self.units.foundation());
            ties.push(Tie { name, slave, master, search_distance: None, stiffness, place: pair.place });
        }
        Ok(ties)
    }

    /// Whether a contact pair is a tie, and its stiffness in the deck's unit where that is known.
    pub(super) fn tied(&self, pair: &ContactPair) -> Result<Option<Option<f64>>> {
        Ok(match self.interaction(pair)?.behaviour {
            Behaviour::Tied(stiffness) => Some(Some(stiffness)),
            _ if pair.tied => Some(None),
            _ => None,
        })
    }
}
