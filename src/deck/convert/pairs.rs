//! Contact pairs.

use std::fmt::Display;

use super::Conversion;
use super::history::State;
use crate::Result;
use crate::deck::types::{Adjust, Behaviour, Clearance, ContactPair, Dependence, Friction, Interaction};
use crate::mesh::Mesh;
use crate::model::friction::{FrictionCurve, FrictionTable, SpeedDecay};
use crate::model::{Contact, LARGEST_FRICTION, Model, NormalLaw, Place, ROUGH, is_pressure_table, names};

/// Tables of a contact law are straight to this relative difference.
const STRAIGHT: f64 = 1e-6;

/// Decks say by coefficients from this on that surfaces are rough.
const ROUGH_FROM: f64 = 1e3;

impl<'d> Conversion<'d> {
    /// The contact pairs with their normal laws.
    pub(super) fn contacts(&mut self) -> Result<Vec<Contact>> {
        self.require_pairs_of_clearances()?;
        let mut contacts: Vec<Contact> = Vec::new();
        for pair in self.contact_pairs()? {
            let [slave, master] =
                [self.surface_name(&pair.slave, pair.place)?, self.surface_name(&pair.master, pair.place)?];
            let interaction = self.interaction(pair)?;
            let clearance = self.deck.clearances.iter().rfind(|own| is_of(own, pair));
            let name = format!("{slave} / {master}");
            if contacts.iter().any(|other| other.name == name) {
                return Err(self.assembly.error(pair.place, format_args!("the contact pair {name} is there already")));
            }
            contacts.push(Contact {
                gap_field: None,
                stiffness_field: None,
                wear: None,
                name,
                slave,
                master,
                law: self.law(interaction)?,
                friction: 0.0,
                friction_curve: None,
                stick: None,
                separation: !interaction.no_separation,
                search_distance: None,
                adjust: self.closed_gap(pair).filter(|_| clearance.is_none()).unwrap_or(0.0),
                clearance: clearance.map(|own| own.value * self.units.length),
                place: pair.place,
            });
        }
        Ok(contacts)
    }

    /// The gap up to which a pair is closed, m.
    fn closed_gap(&self, pair: &ContactPair) -> Option<f64> {
        let Some(Adjust::Within(gap)) = pair.adjust else { return None };
        Some(gap * self.units.length)
    }

    /// Refuses a clearance of surfaces that are no contact pair.
    fn require_pairs_of_clearances(&self) -> Result<()> {
        let pairs = self.contact_pairs()?;
        let Some(lost) = self.deck.clearances.iter().find(|own| !pairs.iter().any(|pair| is_of(own, pair))) else {
            return Ok(());
        };
        let name = |slave: &str, master: &str| format!("{} / {}", self.deck.spelled(slave), self.deck.spelled(master));
        let wanted = name(&lost.slave, &lost.master);
        let known: Vec<String> = pairs.iter().map(|pair| name(&pair.slave, &pair.master)).collect();
        let advice = names::advice(&wanted, known.iter().map(String::as_str));
        let what = format_args!("no *CONTACT PAIR has slave and master {wanted} (*CLEARANCE). {advice}");
        Err(self.assembly.error(lost.place, what))
    }

    /// The contact pairs that are no ties.
    fn contact_pairs(&self) -> Result<Vec<&'d ContactPair>> {
        let mut pairs = Vec::new();
        for pair in &self.deck.contact_pairs {
            if self.tied(pair)?.is_none() {
                pairs.push(pair);
            }
        }
        Ok(pairs)
    }

    pub(super) fn interaction(&self, pair: &ContactPair) -> Result<&'d Interaction> {
        let interactions = &self.deck.interactions;
        interactions.iter().find(|interaction| interaction.name == pair.interaction).ok_or_else(|| {
            let advice = names::advice(&pair.interaction, interactions.iter().map(|own| own.name.as_str()));
            let name = self.deck.spelled(&pair.interaction);
            self.assembly.error(pair.place, format_args!("there is no *SURFACE INTERACTION {name}. {advice}"))
        })
    }

    /// The normal law; none where the deck has none.
    fn law(&self, interaction: &Interaction) -> Result<Option<NormalLaw>> {
        let linear = |k: f64| NormalLaw::Linear { stiffness: k * self.units.foundation() };
        match &interaction.behaviour {
            Behaviour::Linear(stiffness, _) => Ok(Some(linear(*stiffness))),
            Behaviour::Table(rows, place) => match slope(rows) {
                Some(slope) => Ok(Some(linear(slope))),
                None => self.table(rows, *place).map(Some),
            },
            Behaviour::Hard | Behaviour::Tied(_) => Ok(None),
        }
    }

    /// A table of pressures over overlaps, in SI units.
    fn table(&self, rows: &[[f64; 2]], place: Place) -> Result<NormalLaw> {
        let without = rows.iter().take_while(|[pressure, _]| *pressure == 0.0).count();
        let (length, stress) = (self.units.length, self.units.stress());
        let pressed = rows.iter().skip(without.max(1) - 1);
        let mut rows: Vec<[f64; 2]> =
            pressed.map(|[pressure, overlap]| [overlap * length, pressure * stress]).collect();
        if without == 0 {
            rows.insert(0, [0.0; 2]);
        }
        if is_pressure_table(&rows) {
            return Ok(NormalLaw::Table { rows });
        }
        let what = "pressures and overlaps of the table do not rise from a pressure of 0. Correct it, or give LINEAR";
        Err(self.assembly.error(place, what))
    }

    /// The contacts with the friction of the last step.
    pub(super) fn with_friction_of(&mut self, state: &State, mut contacts: Vec<Contact>) -> Result<Vec<Contact>> {
        for (contact, pair) in contacts.iter_mut().zip(self.contact_pairs()?) {
            let own = self.interaction(pair)?.friction.as_ref();
            let Some(friction) = state.friction(&pair.interaction).or(own) else { continue };
            let is_rough = friction.coefficient >= ROUGH_FROM && matches!(friction.dependence, Dependence::None);
            if !is_rough && friction.coefficient > LARGEST_FRICTION {
                let what =
                    format_args!("a friction coefficient of {} is above {LARGEST_FRICTION}", friction.coefficient);
                return Err(self.assembly.error(friction.place, what));
            }
            (contact.friction, contact.friction_curve) =
                if is_rough { (ROUGH, None) } else { self.friction(friction)? };
            contact.stick =
                friction.stick.or(own.and_then(|own| own.stick)).map(|stick| stick * self.units.foundation());
        }
        Ok(contacts)
    }
}

impl Conversion<'_> {
    /// The friction value, and how the coefficient depends on other things, in SI units.
    fn friction(&self, friction: &Friction) -> Result<(f64, Option<FrictionCurve>)> {
        let value = friction.coefficient;
        let refuse = |what: &dyn Display| self.assembly.error(friction.place, what);
        let speed = self.units.length / self.units.time;
        match &friction.dependence {
            Dependence::None => Ok((value, None)),
            &Dependence::Decay { kinetic, decay } if value > 0.0 && kinetic >= 0.0 && decay > 0.0 => {
                let decay = SpeedDecay { kinetic_ratio: kinetic / value, decay: decay / speed };
                Ok((value, Some(FrictionCurve::Decay(decay))))
            }
            Dependence::Decay { .. } => Err(refuse(
                &"an exponential decay needs a static coefficient and a decay above 0, and a kinetic one from 0",
            )),
            Dependence::Table(rows) if rows.iter().any(|row| row[3] != rows[0][3]) => {
                let advice = "Keep the rows of one, or give the table and the temperature in a model file";
                Err(refuse(&format_args!("friction depends on the temperature, which no deck says. {advice}")))
            }
            Dependence::Table(rows) => {
                let in_si = |&[mu, v, q, _]: &[f64; 4]| vec![mu, v * speed, q * self.units.stress()];
                let rows: Vec<Vec<f64>> = rows.iter().map(in_si).collect();
                let (value, table) = FrictionTable::of_rows(&["speed", "pressure"], &rows, None)
                    .map_err(|refusal| refuse(&format_args!("{}. {}", refusal.what, refusal.advice)))?;
                Ok((value, Some(FrictionCurve::Table(table))))
            }
        }
    }
}

/// Whether a clearance is of a pair.
fn is_of(clearance: &Clearance, pair: &ContactPair) -> bool {
    clearance.slave == pair.slave && clearance.master == pair.master
}

/// The slope of a table of pressure over overlap, if it is a straight line through the origin. Rows without pressure
/// are the gap.
fn slope(rows: &[[f64; 2]]) -> Option<f64> {
    let pressed: Vec<f64> = rows.iter().filter(|[p, _]| *p != 0.0).map(|[p, overlap]| p / overlap).collect();
    let first = *pressed.first().filter(|slope| slope.is_finite() && **slope > 0.0)?;
    let begins = rows.iter().filter(|[p, _]| *p == 0.0).all(|[_, overlap]| *overlap <= 0.0);
    (begins && pressed.iter().all(|slope| (slope / first - 1.0).abs() < STRAIGHT)).then_some(first)
}

/// Gives the contacts of a deck what depends on the rotations: the turning side is the master, pairs that slide do not
/// stick, and others with friction stick with half of the normal stiffness where the deck has none. Returns what was
/// done.
pub fn settle(model: &mut Model, mesh: &Mesh, is_of_deck: impl Fn(&Contact) -> bool) -> Vec<String> {
    let mut notes = Vec::new();
    let turns = |surface: &str, model: &Model| {
        let part = mesh.part_of_surface(surface).map(|part| &mesh.parts[part as usize]);
        model.rotations.iter().any(|rotation| Some(&rotation.part) == part)
    };
    for i in 0..model.contacts.len() {
        let mut contact = model.contacts[i].clone();
        if !is_of_deck(&contact) {
            continue;
        }
        if turns(&contact.slave, model) && !turns(&contact.master, model) {
            std::mem::swap(&mut contact.slave, &mut contact.master);
            notes.push(format!("slave and master of {} are swapped: the turning side is the master", contact.name));
        }
        if model.sliding(&contact, mesh).is_some() {
            contact.stick = None;
        } else if contact.law.is_some() && contact.stick.is_none() && contact.friction > 0.0 {
            let stick = model.half_stiffness(&contact, mesh);
            contact.stick = Some(stick);
            notes.push(format!("{} sticks with {stick:.3e} N/m3, half of its stiffness", contact.name));
        }
        model.contacts[i] = contact;
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::slope;

    #[test]
    fn a_table_is_a_straight_line_through_the_origin_or_nothing() {
        assert_eq!(slope(&[[0.0, 0.0], [10.0, 0.5], [40.0, 2.0]]), Some(20.0));
        assert_eq!(slope(&[[0.0, -0.1], [0.0, 0.0], [10.0, 0.5]]), Some(20.0));
        for bad in
            [vec![[0.0, 0.0]], vec![[0.0, 0.0], [1.0, 1.0], [4.0, 2.0]], vec![[0.0, 0.1], [1.0, 0.2]], vec![[1.0, 0.0]]]
        {
            assert_eq!(slope(&bad), None, "{bad:?}");
        }
    }
}
