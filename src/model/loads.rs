//! External loads.

use super::item::{Item, Vector, named};
use super::keys::{self, Text};
use super::source::ModelText;
use super::{Load, LoadKind};
use crate::Result;
use toml::Spanned;

/// The loads.
pub fn loads(source: ModelText, raw: &[Spanned<keys::LoadTable>]) -> Result<Vec<Load>> {
    let called = |raw: &keys::LoadTable| raw.name.clone().unwrap_or_else(|| raw.on.clone());
    named(source, "load", raw, called, |item, name, raw| {
        Ok(Load { name, on: raw.on.clone(), kind: kind(item, raw)?, place: item.place() })
    })
}

fn kind(item: &Item, raw: &keys::LoadTable) -> Result<LoadKind> {
    let advice = "Give one of force = [x, y, z] in N, or pressure in Pa";
    match (&raw.force, &raw.pressure, &raw.spread) {
        (Some(force), None, spread) => spread_force(item, force, spread.as_ref()),
        (None, Some(pressure), None) => {
            Ok(LoadKind::Pressure(item.check(pressure, true, "pressure", "must be finite", advice)?))
        }
        (None, Some(_), Some(spread)) => {
            Err(item.error(&spread.span(), "spread says how a force acts, but this is a pressure", "Leave it out"))
        }
        (Some(_), Some(pressure), _) => {
            Err(item.error(&pressure.span(), "there are a force and a pressure", "Write two [[load]] tables"))
        }
        (None, None, _) => Err(item.error_here("nothing acts", advice)),
    }
}

fn spread_force(item: &Item, force: &Vector, spread: Option<&Text>) -> Result<LoadKind> {
    type Spread = fn([f64; 3]) -> LoadKind;
    const SPREADS: [(&str, Spread); 2] = [("nodes", LoadKind::ForceByNode), ("area", LoadKind::ForceByArea)];
    let force = item.finite(force, "force")?;
    match spread {
        None => Ok(LoadKind::ForceByNode(force)),
        Some(spread) => item.find("spread", spread, &SPREADS, |(name, _)| name).map(|(_, kind)| kind(force)),
    }
}
