//! External loads.

use super::contacts::unused;
use super::item::{Item, Vector};
use super::keys::{self, Text};
use super::source::ModelText;
use super::{Load, LoadKind, names};
use crate::Result;
use std::collections::HashMap;
use toml::Spanned;

/// The loads.
pub fn loads(source: ModelText, raw: &[Spanned<keys::LoadTable>]) -> Result<Vec<Load>> {
    let mut seen = HashMap::new();
    let mut loads = Vec::new();
    for load in raw {
        let raw = load.get_ref();
        let name = raw.name.clone().unwrap_or_else(|| raw.on.clone());
        let item = Item::new(source, format!("load {name:?}"), load.span());
        unused(&item, &name, &mut seen)?;
        loads.push(Load { name, on: raw.on.clone(), kind: kind(&item, raw)?, line: item.line() });
    }
    Ok(loads)
}

fn kind(item: &Item, raw: &keys::LoadTable) -> Result<LoadKind> {
    let advice = "Give one of force = [x, y, z] in N, or pressure in Pa";
    match (&raw.force, &raw.pressure, &raw.spread) {
        (Some(force), None, spread) => spread_force(item, force, spread.as_ref()),
        (None, Some(pressure), None) => {
            let pressure = item.check(pressure, true, "pressure", "must be finite", advice)?;
            Ok(LoadKind::Pressure(pressure))
        }
        (None, Some(_), Some(spread)) => {
            let what = "spread says how a force acts, but this is a pressure";
            Err(item.error(&spread.span(), what, "Leave it out"))
        }
        (Some(_), Some(pressure), _) => {
            let what = "there are a force and a pressure";
            Err(item.error(&pressure.span(), what, "Write two [[load]] tables"))
        }
        (None, None, _) => Err(item.error_here("nothing acts", advice)),
    }
}

fn spread_force(item: &Item, force: &Vector, spread: Option<&Text>) -> Result<LoadKind> {
    let force = item.finite(force, "force")?;
    let Some(spread) = spread else {
        return Ok(LoadKind::ForceByNode(force));
    };
    match spread.get_ref().as_str() {
        "nodes" => Ok(LoadKind::ForceByNode(force)),
        "area" => Ok(LoadKind::ForceByArea(force)),
        other => {
            let what = format_args!("unknown spread {other:?}");
            Err(item.error(&spread.span(), what, names::advice(other, ["nodes", "area"])))
        }
    }
}
