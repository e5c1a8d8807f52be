//! Contact pairs.

use super::item::{Item, Number, named};
use super::keys;
use super::source::ModelText;
use super::{Contact, NormalLaw, SpeedDecay};
use crate::Result;
use toml::Spanned;

/// Friction above this is taken for a mistake.
pub const LARGEST_FRICTION: f64 = 2.0;

/// The contact pairs; `unit` is metres per unit of the mesh.
pub fn contacts(source: ModelText, raw: &[Spanned<keys::ContactTable>], unit: f64) -> Result<Vec<Contact>> {
    let called =
        |raw: &keys::ContactTable| raw.name.clone().unwrap_or_else(|| format!("{} / {}", raw.slave, raw.master));
    named(source, "contact", raw, called, |item, name, raw| contact(item, name, raw, unit))
}

fn contact(item: &Item, name: String, raw: &keys::ContactTable, unit: f64) -> Result<Contact> {
    let what = format_args!("slave and master are both {:?}", raw.slave);
    item.require(raw.slave != raw.master, what, "Name the two surfaces that meet")?;
    let (friction, decay) = contact_friction(item, &raw.friction)?;
    Ok(Contact {
        name,
        slave: raw.slave.clone(),
        master: raw.master.clone(),
        law: law(item, &raw.law)?,
        friction,
        decay,
        stick: item.positive_if_given(&raw.stick, "stick", "Give N/m3, such as 1e13")?,
        separation: raw.separation.unwrap_or(true),
        search_distance: search_distance(item, &raw.search, unit)?,
        place: item.place(),
    })
}

/// The distance beyond which points are left out, m; `unit` is metres per unit of the mesh.
pub fn search_distance(item: &Item, raw: &Option<Number>, unit: f64) -> Result<Option<f64>> {
    let advice = "Give a distance in the mesh's unit, or leave it out for no limit";
    Ok(item.positive_if_given(raw, "search", advice)?.map(|distance| distance * unit))
}

/// A coefficient of friction.
pub fn friction(item: &Item, value: &Number) -> Result<f64> {
    let holds = (0.0..=LARGEST_FRICTION).contains(value.get_ref());
    item.check(value, holds, "friction", "must be from 0 to 2", "Give a coefficient, such as 0.5")
}

/// The friction value of a contact, and how it falls with the speed.
fn contact_friction(item: &Item, raw: &Spanned<keys::Friction>) -> Result<(f64, Option<SpeedDecay>)> {
    let (at_rest, kinetic, decay) = match *raw.get_ref() {
        keys::Friction::Constant(mu) => return Ok((friction(item, &Spanned::new(raw.span(), mu))?, None)),
        keys::Friction::Decay { at_rest, kinetic, decay } => (at_rest, kinetic, decay),
    };
    let is_coefficient = |mu: f64| (0.0..=LARGEST_FRICTION).contains(&mu);
    let holds = at_rest > 0.0 && is_coefficient(at_rest) && is_coefficient(kinetic) && decay > 0.0 && decay.is_finite();
    let what = format_args!("friction has static = {at_rest}, kinetic = {kinetic}, decay = {decay}");
    let advice = "Give static above 0 and kinetic from 0, both up to 2, and a decay above 0 in s/m";
    item.require_at(&raw.span(), holds, what, advice)?;
    Ok((at_rest, Some(SpeedDecay { kinetic_ratio: kinetic / at_rest, decay })))
}

fn law(item: &Item, raw: &Spanned<keys::LawTable>) -> Result<NormalLaw> {
    let example = "Give law = { linear = 2e13 } in N/m3, or { cubic = [k1, k3] } in N/m3 and N/m5";
    match (&raw.get_ref().linear, &raw.get_ref().cubic) {
        (Some(k), None) => Ok(NormalLaw::Linear { stiffness: item.positive(k, "linear", example)? }),
        (None, Some(k)) => {
            item.each(k, |x| x > 0.0, "cubic", "must be above 0", example).map(|[k1, k3]| NormalLaw::Cubic { k1, k3 })
        }
        (None, None) => Err(item.error(&raw.span(), "the law is empty", example)),
        (Some(_), Some(_)) => Err(item.error(&raw.span(), "there are two laws", example)),
    }
}
