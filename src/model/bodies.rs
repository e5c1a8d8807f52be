//! Parts, fixed displacements and imposed velocities.

use super::item::{Item, Vector};
use super::keys::{self, Text};
use super::source::{ModelText, Span};
use super::{Fix, Material, Part, Rayleigh, Rotation, names};
use crate::Result;
use crate::element::ElementKind;
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
    Ok(Part {
        name: name.get_ref().clone(),
        material: item.find("material", &raw.material, materials, |material| &material.name)?.clone(),
        rayleigh: rayleigh(&item, &raw.rayleigh)?,
        elements: elements(&item, &raw.elements)?,
        place: item.place(),
    })
}

/// Kinds of element of different shapes.
fn elements(item: &Item, raw: &[Text]) -> Result<Vec<ElementKind>> {
    let mut kinds: Vec<ElementKind> = Vec::new();
    for name in raw {
        let kind = *item.find("kind of element", name, &ElementKind::ALL, |kind| kind.name())?;
        let same = kinds.iter().find(|other| other.shape() == kind.shape());
        let what = format_args!("{} has the shape of {}", kind.name(), same.map_or("", |other| other.name()));
        item.require_at(&name.span(), same.is_none(), what, "Keep one kind for each shape")?;
        kinds.push(kind);
    }
    Ok(kinds)
}

fn rayleigh(item: &Item, raw: &keys::RayleighTable) -> Result<Rayleigh> {
    let coefficient =
        |value: &Option<_>, key, advice| value.as_ref().map_or(Ok(0.0), |value| item.not_negative(value, key, advice));
    Ok(Rayleigh {
        alpha: coefficient(&raw.alpha, "rayleigh alpha", "Give 1/s, such as 10.0")?,
        beta: coefficient(&raw.beta, "rayleigh beta", "Give s, such as 1e-8")?,
    })
}

/// The fixed displacements; `unit` is metres per unit of the mesh.
pub fn fixes(source: ModelText, raw: &[Spanned<keys::FixTable>], unit: f64) -> Result<Vec<Fix>> {
    let fix = |fix: &Spanned<keys::FixTable>| {
        let raw = fix.get_ref();
        let item = Item::new(source, format!("fix of {:?}", raw.nodes), fix.span());
        let axes = axes(&item, &raw.axes)?;
        let displacement = displacement(&item, &raw.displacement, axes, unit)?;
        Ok(Fix { nodes: raw.nodes.clone(), axes, displacement, place: item.place() })
    };
    raw.iter().map(fix).collect()
}

/// A displacement along held axes, m; zero where none is given.
fn displacement(item: &Item, raw: &Option<Vector>, held: [bool; 3], unit: f64) -> Result<[f64; 3]> {
    let (Some(raw), Some(value)) = (raw, item.point(raw, "displacement", unit)?) else { return Ok([0.0; 3]) };
    let is_along_held = (0..3).all(|i| held[i] || value[i] == 0.0);
    let what = "displacement has a part along an axis that is free";
    item.require_at(&raw.span(), is_along_held, what, "Name this axis in axes, or give 0 along it")?;
    Ok(value)
}

/// `"xz"` -> [true, false, true].
fn axes(item: &Item, text: &Text) -> Result<[bool; 3]> {
    let letters = text.get_ref();
    let held = ['x', 'y', 'z'].map(|axis| letters.contains(axis));
    let is_each_once = letters.chars().count() == held.iter().filter(|held| **held).count();
    let what = format_args!("axes = {letters:?} does not name directions");
    let advice = "Give one or more of x, y, z, each once, such as \"xyz\"";
    item.require_at(&text.span(), is_each_once && !letters.is_empty(), what, advice)?;
    Ok(held)
}

/// The imposed velocities; `unit` is metres per unit of the mesh, `parts` those that may turn, where they are known.
pub fn rotations(
    source: ModelText,
    raw: &[Spanned<keys::RotationTable>],
    parts: Option<&[Part]>,
    unit: f64,
) -> Result<Vec<Rotation>> {
    let mut seen = HashSet::new();
    let read = |rotation: &Spanned<keys::RotationTable>| {
        let part = &rotation.get_ref().part;
        let (name, at) = (part.get_ref(), part.span());
        let item = Item::new(source, format!("rotation of {name:?}"), rotation.span());
        parts.map_or(Ok(()), |parts| known_part(&item, name, &at, parts))?;
        let is_first = seen.insert(name.clone());
        item.require_at(&at, is_first, "the part turns already", "Keep one [[rotation]] for each part")?;
        self::rotation(&item, rotation.get_ref(), unit)
    };
    raw.iter().map(read).collect()
}

fn known_part(item: &Item, name: &str, span: &Span, parts: &[Part]) -> Result<()> {
    let names = || parts.iter().map(|part| part.name.as_str());
    let advice = names::advice(name, names()) + "; or add it";
    item.require_at(span, names().any(|part| part == name), format_args!("there is no [part.{name}]"), advice)
}

fn rotation(item: &Item, raw: &keys::RotationTable, unit: f64) -> Result<Rotation> {
    let through = raw.through.as_ref().map_or(Ok([0.0; 3]), |point| item.finite(point, "through"))?;
    let advice = "Give rad/s, such as 5.0; its sign is the sense of rotation";
    let turns = *raw.speed.get_ref() != 0.0;
    item.require_at(&raw.speed.span(), turns, "speed is 0, so that nothing turns", advice)?;
    Ok(Rotation {
        part: raw.part.get_ref().clone(),
        axis: item.direction(&raw.axis, "axis")?,
        through: through.map(|x| x * unit),
        speed: item.check(&raw.speed, true, "speed", "must be finite", advice)?,
        inertia: raw.inertia,
        place: item.place(),
    })
}
