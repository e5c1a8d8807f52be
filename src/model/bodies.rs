//! Parts, fixed displacements and imposed velocities.

use super::item::Item;
use super::keys::{self, Text};
use super::source::{ModelText, Span};
use super::{Fix, Material, Part, Rayleigh, Rotation, names};
use crate::Result;
use std::collections::HashSet;
use toml::Spanned;

/// The parts in the order of the file.
pub fn parts(source: ModelText, raw: &keys::Named<keys::PartTable>, materials: &[Material]) -> Result<Vec<Part>> {
    let mut raw: Vec<(&Text, &keys::PartTable)> = raw.iter().collect();
    raw.sort_by_key(|(name, _)| name.span().start);
    raw.into_iter().map(|(name, raw)| part(source, name, raw, materials)).collect()
}

fn part(source: ModelText, name: &Text, raw: &keys::PartTable, materials: &[Material]) -> Result<Part> {
    let item = Item::new(source, format!("part {:?}", name.get_ref()), name.span());
    let wanted = raw.material.get_ref();
    let Some(material) = materials.iter().find(|m| &m.name == wanted) else {
        let advice = names::advice(wanted, materials.iter().map(|m| m.name.as_str()));
        let what = format_args!("unknown material {wanted:?}");
        return Err(item.error(&raw.material.span(), what, advice));
    };
    Ok(Part {
        name: name.get_ref().clone(),
        material: material.clone(),
        rayleigh: rayleigh(&item, &raw.rayleigh)?,
        line: item.line(),
    })
}

fn rayleigh(item: &Item, raw: &keys::RayleighTable) -> Result<Rayleigh> {
    let coefficient = |value: &Option<_>, key, advice| match value {
        Some(value) => item.not_negative(value, key, advice),
        None => Ok(0.0),
    };
    Ok(Rayleigh {
        alpha: coefficient(&raw.alpha, "rayleigh alpha", "Give 1/s, such as 10.0")?,
        beta: coefficient(&raw.beta, "rayleigh beta", "Give s, such as 1e-8")?,
    })
}

/// The fixed displacements.
pub fn fixes(source: ModelText, raw: &[Spanned<keys::FixTable>]) -> Result<Vec<Fix>> {
    let fix = |fix: &Spanned<keys::FixTable>| {
        let raw = fix.get_ref();
        let item = Item::new(source, format!("fix of {:?}", raw.nodes), fix.span());
        Ok(Fix { nodes: raw.nodes.clone(), axes: axes(&item, &raw.axes)?, line: item.line() })
    };
    raw.iter().map(fix).collect()
}

/// `"xz"` -> [true, false, true].
fn axes(item: &Item, text: &Text) -> Result<[bool; 3]> {
    let mut held = [false; 3];
    for letter in text.get_ref().chars() {
        match "xyz".find(letter) {
            Some(axis) if !held[axis] => held[axis] = true,
            _ => return Err(wrong_axes(item, text)),
        }
    }
    if held.contains(&true) { Ok(held) } else { Err(wrong_axes(item, text)) }
}

fn wrong_axes(item: &Item, text: &Text) -> crate::Error {
    let what = format_args!("axes = {:?} does not name directions", text.get_ref());
    item.error(&text.span(), what, "Give one or more of x, y, z, each once, such as \"xyz\"")
}

/// The imposed velocities; `unit` is metres per unit of the mesh.
pub fn rotations(
    source: ModelText,
    raw: &[Spanned<keys::RotationTable>],
    parts: &[Part],
    unit: f64,
) -> Result<Vec<Rotation>> {
    let mut seen = HashSet::new();
    let mut rotations = Vec::new();
    for rotation in raw {
        let name = rotation.get_ref().part.get_ref();
        let item = Item::new(source, format!("rotation of {name:?}"), rotation.span());
        let span = rotation.get_ref().part.span();
        known_part(&item, name, &span, parts)?;
        if !seen.insert(name) {
            return Err(item.error(&span, "the part turns already", "Keep one [[rotation]] for each part"));
        }
        rotations.push(self::rotation(&item, rotation.get_ref(), unit)?);
    }
    Ok(rotations)
}

fn known_part(item: &Item, name: &str, span: &Span, parts: &[Part]) -> Result<()> {
    if parts.iter().any(|part| part.name == name) {
        return Ok(());
    }
    let advice = names::advice(name, parts.iter().map(|part| part.name.as_str()));
    let what = format_args!("there is no [part.{name}]");
    Err(item.error(span, what, format_args!("{advice}; or add it")))
}

fn rotation(item: &Item, raw: &keys::RotationTable, unit: f64) -> Result<Rotation> {
    let through = match &raw.through {
        Some(point) => item.finite(point, "through")?,
        None => [0.0; 3],
    };
    let advice = "Give rad/s, such as 5.0; its sign is the sense of rotation";
    if *raw.speed.get_ref() == 0.0 {
        return Err(item.error(&raw.speed.span(), "speed is 0, so that nothing turns", advice));
    }
    Ok(Rotation {
        part: raw.part.get_ref().clone(),
        axis: item.direction(&raw.axis, "axis")?,
        through: through.map(|x| x * unit),
        speed: item.check(&raw.speed, true, "speed", "must be finite", advice)?,
        line: item.line(),
    })
}
