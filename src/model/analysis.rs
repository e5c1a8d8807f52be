//! What to compute: the sweep and the reduction.

use super::friction::friction;
use super::item::{Item, Number};
use super::keys::{self, FrictionSweepTable, Text};
use super::source::ModelText;
use super::{Contact, InstabilityCriterion, Place, Reduction};
use crate::Result;
use toml::Spanned;

/// A sweep longer than this is taken for a mistake in its step.
const LONGEST_SWEEP: f64 = 10_000.0;

const RANGE: &str = "Give from, to and step (above 0, from <= to), or values = [0.1, 0.3, 0.5]";

/// A friction sweep.
#[derive(Default)]
pub struct SweepSettings {
    /// The contacts that it changes; none named: all that slide.
    pub contacts: Vec<String>,
    /// The values.
    pub frictions: Vec<f64>,
    /// Where it stands; line 0 where there is no sweep.
    pub place: Place,
}

/// The sweep, once the contacts it names exist, where these are known.
pub fn sweep(
    source: ModelText,
    raw: Option<&Spanned<keys::SweepTable>>,
    contacts: Option<&[Contact]>,
) -> Result<SweepSettings> {
    let Some(raw) = raw else {
        return Ok(SweepSettings::default());
    };
    let friction = &raw.get_ref().friction;
    let item = Item::new(source, "sweep".to_owned(), friction.span());
    Ok(SweepSettings {
        contacts: swept(&item, friction.get_ref().contacts.as_deref(), contacts)?,
        frictions: values(&item, friction.get_ref())?,
        place: item.place(),
    })
}

fn swept(item: &Item, wanted: Option<&[Text]>, contacts: Option<&[Contact]>) -> Result<Vec<String>> {
    let mut swept: Vec<String> = Vec::new();
    for name in wanted.unwrap_or_default() {
        let text = match contacts {
            Some(contacts) => &item.find("contact", name, contacts, |contact| &contact.name)?.name,
            None => name.get_ref(),
        };
        let what = format_args!("contact {text:?} is named twice");
        item.require_at(&name.span(), !swept.contains(text), what, "Keep one of them")?;
        swept.push(text.clone());
    }
    let advice = "Name some, or leave the key out to sweep all that slide";
    item.require(wanted.is_none_or(|names| !names.is_empty()), "contacts is an empty list", advice)?;
    Ok(swept)
}

fn values(item: &Item, raw: &FrictionSweepTable) -> Result<Vec<f64>> {
    match (&raw.values, &raw.from, &raw.to, &raw.step) {
        (Some(values), None, None, None) if !values.is_empty() => {
            let mut seen: Vec<f64> = Vec::new();
            for value in values {
                let mu = friction(item, value)?;
                let what = format_args!("friction {mu} is given twice");
                item.require_at(&value.span(), !seen.contains(&mu), what, "Keep one of them")?;
                seen.push(mu);
            }
            Ok(seen)
        }
        (None, Some(from), Some(to), Some(step)) => range(item, from, to, step),
        _ => Err(item.error_here("the values of the friction are not given, or given twice", RANGE)),
    }
}

fn range(item: &Item, from: &Number, to: &Number, step: &Number) -> Result<Vec<f64>> {
    let (low, high) = (friction(item, from)?, friction(item, to)?);
    let step_value = item.positive(step, "step", RANGE)?;
    item.require_at(&from.span(), low <= high, format_args!("the range is empty: from {low} to {high}"), RANGE)?;
    spaced(low, high, step_value).ok_or_else(|| {
        let what = format_args!("a step of {step_value} makes more than {LONGEST_SWEEP} values");
        item.error(&step.span(), what, "Give a larger step")
    })
}

/// The values `from + i step` up to `to` (reached within a millionth of a step), rounded to 12 digits, so that 0.1 + 2
/// * 0.1 is 0.3.
///
/// None where there is no such value, or more than 10000.
pub fn spaced(from: f64, to: f64, step: f64) -> Option<Vec<f64>> {
    let n_steps = ((to - from) / step + 1e-6).floor();
    let value = |i: usize| ((from + i as f64 * step) * 1e12).round() / 1e12;
    (0.0..LONGEST_SWEEP).contains(&n_steps).then(|| (0..=n_steps as usize).map(value).collect())
}

/// What counts as unstable.
pub fn criterion(item: &Item, raw: Option<&Spanned<InstabilityCriterion>>) -> Result<InstabilityCriterion> {
    let Some(raw) = raw else { return Ok(InstabilityCriterion::default()) };
    match raw.get_ref().mistake() {
        Some(mistake) => Err(item.error(&raw.span(), "unstable has a wrong limit", mistake)),
        None => Ok(*raw.get_ref()),
    }
}

/// The reduction.
pub fn reduction(source: ModelText, raw: &Spanned<keys::ReductionTable>) -> Result<Reduction> {
    let item = Item::new(source, "reduction".to_owned(), raw.span());
    let (at, contacts) = (raw.get_ref().contacts.span(), *raw.get_ref().contacts.get_ref());
    let advice = "Give the number of reference pairs, such as 104";
    item.require_at(&at, contacts > 0, "contacts must be above 0", advice)?;
    Ok(Reduction { contacts, band: item.band(&raw.get_ref().band)?, place: item.place() })
}
