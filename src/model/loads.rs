//! External loads.

use super::item::{Item, Number, Vector, named};
use super::keys;
use super::source::ModelText;
use super::{Load, LoadKind};
use crate::Result;
use toml::Spanned;

/// What a load has.
const ACTING: &str = "Give one of force = [x, y, z] in N, pressure in Pa, or gravity = [x, y, z] in m/s2";
/// Name of gravity that acts on everything.
const GRAVITY: &str = "gravity";

impl Load {
    /// Whether this is gravity that acts on a part or point mass.
    pub fn is_gravity_on(&self, name: &str) -> bool {
        matches!(self.kind, LoadKind::Gravity(_)) && (self.on.is_empty() || self.on == name)
    }
}

/// The loads; `unit` is metres per unit of the mesh.
pub fn loads(source: ModelText, raw: &[Spanned<keys::LoadTable>], unit: f64) -> Result<Vec<Load>> {
    let called = |raw: &keys::LoadTable| {
        let unnamed = if raw.gravity.is_some() { GRAVITY } else { "unnamed" };
        raw.name.as_ref().or(raw.on.as_ref()).map_or(unnamed, String::as_str).to_owned()
    };
    named(source, "load", raw, called, |item, name, raw| {
        let on = match (&raw.on, &raw.gravity) {
            (None, Some(_)) => String::new(),
            (Some(on), Some(gravity)) => {
                let advice = "Name a part or [[mass]], or leave `on` out: gravity then acts on all of them";
                item.require_at(&gravity.span(), !on.is_empty(), "on is empty", advice)?;
                on.clone()
            }
            (on, _) => item.required(on, "on", "Name a physical surface, curve or point")?.clone(),
        };
        Ok(Load { name, on, kind: kind(item, raw, unit)?, place: item.place() })
    })
}

fn kind(item: &Item, raw: &keys::LoadTable, unit: f64) -> Result<LoadKind> {
    if let Some(gravity) = &raw.gravity {
        let is_alone = raw.force.is_none() && raw.moment.is_none() && raw.at.is_none() && raw.pressure.is_none();
        let what = "a load with gravity has no force, moment, at, spread or pressure";
        item.require_at(&gravity.span(), is_alone && raw.spread.is_none(), what, "Write two [[load]] tables")?;
        return Ok(LoadKind::Gravity(item.finite(gravity, "gravity")?));
    }
    let at_point = raw.moment.as_ref().or(raw.at.as_ref()).map(Spanned::span);
    let of_force = raw.spread.as_ref().map(Spanned::span).or(at_point.clone());
    match (&raw.pressure, &raw.force, of_force) {
        (Some(pressure), None, None) => pressure_kind(item, pressure),
        (Some(pressure), Some(_), _) => {
            Err(item.error(&pressure.span(), "there are a force and a pressure", "Write two [[load]] tables"))
        }
        (Some(_), None, Some(of_force)) => {
            let what = "spread, moment and at say how a force acts, but this is a pressure";
            Err(item.error(&of_force, what, "Leave them out"))
        }
        (None, None, _) if raw.moment.is_none() => Err(item.error_here("nothing acts", ACTING)),
        _ => match (at_point, &raw.spread) {
            (None, _) => force_over_nodes(item, raw),
            (Some(_), None) => force_at(item, raw, unit),
            (Some(_), Some(spread)) => {
                let what = "the load acts at a point, so that spread does not apply";
                Err(item.error(&spread.span(), what, "Leave it out, or moment and at"))
            }
        },
    }
}

fn pressure_kind(item: &Item, pressure: &Number) -> Result<LoadKind> {
    Ok(LoadKind::Pressure(item.check(pressure, true, "pressure", "must be finite", ACTING)?))
}

/// A force and a moment at a point.
fn force_at(item: &Item, raw: &keys::LoadTable, unit: f64) -> Result<LoadKind> {
    let vector = |value: &Option<Vector>, key| value.as_ref().map_or(Ok([0.0; 3]), |value| item.finite(value, key));
    Ok(LoadKind::ForceAt {
        force: vector(&raw.force, "force")?,
        moment: vector(&raw.moment, "moment")?,
        at: item.point(&raw.at, "at", unit)?,
    })
}

/// A force that is spread evenly.
fn force_over_nodes(item: &Item, raw: &keys::LoadTable) -> Result<LoadKind> {
    type Spread = fn([f64; 3]) -> LoadKind;
    const SPREADS: [(&str, Spread); 2] = [("nodes", LoadKind::ForceByNode), ("area", LoadKind::ForceByArea)];
    let force = item.finite(item.required(&raw.force, "force", ACTING)?, "force")?;
    match &raw.spread {
        None => Ok(LoadKind::ForceByNode(force)),
        Some(spread) => item.find("spread", spread, &SPREADS, |(name, _)| name).map(|(_, kind)| kind(force)),
    }
}
