//! Contact pairs.

use super::friction::contact_friction;
use super::gap_field::GapField;
use super::item::{Item, Number, named};
use super::keys;
use super::source::ModelText;
use super::{Contact, NormalLaw};
use crate::Result;
use std::ops::Range;
use toml::Spanned;

/// The contact pairs; `unit` is metres per unit of the mesh.
pub fn contacts(source: ModelText, raw: &[Spanned<keys::ContactTable>], unit: f64) -> Result<Vec<Contact>> {
    let called =
        |raw: &keys::ContactTable| raw.name.clone().unwrap_or_else(|| format!("{} / {}", raw.slave, raw.master));
    named(source, "contact", raw, called, |item, name, raw| contact(item, name, raw, unit))
}

fn contact(item: &Item, name: String, raw: &keys::ContactTable, unit: f64) -> Result<Contact> {
    let what = format_args!("slave and master are both {:?}", raw.slave);
    item.require(raw.slave != raw.master, what, "Name the two surfaces that meet")?;
    let (friction, friction_curve) = contact_friction(item, &raw.friction)?;
    Ok(Contact {
        slave: raw.slave.clone(),
        master: raw.master.clone(),
        law: law(item, &raw.law)?,
        friction,
        friction_curve,
        stick: item.positive_if_given(&raw.stick, "stick", "Give N/m3, such as 1e13")?,
        separation: raw.separation.unwrap_or(true),
        search_distance: search_distance(item, &raw.search, unit)?,
        adjust: item.positive_if_given(&raw.adjust, "adjust", "Give a distance in the mesh's unit")?.unwrap_or(0.0)
            * unit,
        clearance: clearance(item, raw, unit)?,
        gap_field: gap_field(item, raw, &name)?,
        wear: wear(item, raw)?,
        name,
        place: item.place(),
    })
}

/// The distance beyond which points are left out, m; `unit` is metres per unit of the mesh.
pub fn search_distance(item: &Item, raw: &Option<Number>, unit: f64) -> Result<Option<f64>> {
    let advice = "Give a distance in the mesh's unit, or leave it out for no limit";
    Ok(item.positive_if_given(raw, "search", advice)?.map(|distance| distance * unit))
}

/// The gap of all points, m.
fn clearance(item: &Item, raw: &keys::ContactTable, unit: f64) -> Result<Option<f64>> {
    let Some(gap) = &raw.clearance else { return Ok(None) };
    let what = "there are adjust and clearance, which both say what the gaps are";
    item.require_at(&gap.span(), raw.adjust.is_none(), what, "Leave one of them out")?;
    let value = item.check(gap, true, "clearance", "must be finite", "Give a distance in the mesh's unit")?;
    Ok(Some(value * unit))
}

/// The gap field of a file beside the model file.
fn gap_field(item: &Item, raw: &keys::ContactTable, name: &str) -> Result<Option<GapField>> {
    let Some(file) = &raw.gap else { return Ok(None) };
    require_separation(item, raw, "gap", &file.span())?;
    GapField::read(&item.beside(file.get_ref()), name).map(Some).map_err(|what| {
        let advice = "Give a table (CSV) with the columns x_mm, y_mm, z_mm (two of them are enough) and gap_um";
        item.error(&file.span(), &what, advice)
    })
}

/// Archard's coefficient.
fn wear(item: &Item, raw: &keys::ContactTable) -> Result<Option<f64>> {
    let Some(coefficient) = &raw.wear else { return Ok(None) };
    require_separation(item, raw, "wear", &coefficient.span())?;
    item.positive(coefficient, "wear", "Give m2/N, such as 1e-14").map(Some)
}

/// The gap of a pair that may not open counts as zero.
fn require_separation(item: &Item, raw: &keys::ContactTable, key: &str, span: &Range<usize>) -> Result<()> {
    let what = format!("there is {key}, and the gap of a pair that may not open has no effect");
    item.require_at(span, raw.separation != Some(false), &what, "Give separation = true")
}

/// The law that the file gives; none where the program is to propose one.
fn law(item: &Item, raw: &Spanned<keys::Law>) -> Result<Option<NormalLaw>> {
    let example = "Give law = { linear = 2e13 } in N/m3, { cubic = [k1, k3] } in N/m3 and N/m5, \
                   { table = [[0, 0], [1e-6, 2e7]] } in m and Pa, or \"auto\"";
    let keys::Law::Given(table) = raw.get_ref() else { return Ok(None) };
    match (&table.linear, &table.cubic, &table.table) {
        (Some(k), None, None) => Ok(Some(NormalLaw::Linear { stiffness: item.positive(k, "linear", example)? })),
        (None, Some(k), None) => item
            .each(k, |x| x > 0.0, "cubic", "must be above 0", example)
            .map(|[k1, k3]| Some(NormalLaw::Cubic { k1, k3 })),
        (None, None, Some(rows)) => {
            let what = "the table must have two rows or more, all rising, the first with pressure 0";
            item.require_at(
                &rows.span(),
                is_pressure_table(rows.get_ref()),
                what,
                "Give rows of penetration (m) and pressure (Pa)",
            )?;
            Ok(Some(NormalLaw::Table { rows: rows.get_ref().clone() }))
        }
        (None, None, None) => Err(item.error(&raw.span(), "the law is empty", example)),
        _ => Err(item.error(&raw.span(), "there are two laws", example)),
    }
}

/// Whether penetrations and pressures rise together from a pressure of 0.
pub fn is_pressure_table(rows: &[[f64; 2]]) -> bool {
    let rises = |pair: &[[f64; 2]]| pair[0][0] < pair[1][0] && pair[0][1] < pair[1][1];
    let is_finite = rows.as_flattened().iter().all(|x| x.is_finite());
    rows.len() > 1 && rows[0][1] == 0.0 && is_finite && rows.windows(2).all(rises)
}
