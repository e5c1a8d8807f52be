//! Contact pairs.

use super::friction::contact_friction;
use super::gap_field::{GapField, StiffnessField};
use super::gap_image::ImageFrame;
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
        gap_field: gap_field(item, raw, &name, unit)?,
        stiffness_field: stiffness_field(item, raw, &name)?,
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

/// The gap field of a file beside the model file; `unit` is metres per unit of the mesh.
fn gap_field(item: &Item, raw: &keys::ContactTable, name: &str, unit: f64) -> Result<Option<GapField>> {
    let is_image = raw.gap.as_ref().is_some_and(|file| file.get_ref().to_ascii_lowercase().ends_with(".png"));
    if let (Some(frame), false) = (&raw.gap_image, is_image) {
        let what = "there is gap_image, and gap names no image";
        return Err(item.error(&frame.span(), what, "Give gap = \"FILE.png\", or leave gap_image out"));
    }
    let Some(file) = &raw.gap else { return Ok(None) };
    require_separation(item, raw, "gap", &file.span())?;
    if is_image {
        let frame = image_frame(item, raw, &file.span(), unit)?;
        let field = GapField::read_image(&item.beside(file.get_ref()), frame);
        return field.map(Some).map_err(|what| item.error(&file.span(), &what, "Give a PNG file in grey levels"));
    }
    GapField::read(&item.beside(file.get_ref()), name).map(Some).map_err(|what| {
        let advice = "Give a table (CSV) with the columns x_mm, y_mm, z_mm (two of them are enough) and gap_um";
        item.error(&file.span(), &what, advice)
    })
}

/// The factors on the normal law of a file beside the model file.
fn stiffness_field(item: &Item, raw: &keys::ContactTable, name: &str) -> Result<Option<StiffnessField>> {
    let Some(file) = &raw.stiffness_factor else { return Ok(None) };
    StiffnessField::read(&item.beside(file.get_ref()), name).map(Some).map_err(|what| {
        let advice = "Give a table (CSV) with the columns x_mm, y_mm, z_mm (two of them are enough) and factor";
        item.error(&file.span(), &what, advice)
    })
}

/// Where the image of a gap field lies, and what its grey levels mean.
fn image_frame(item: &Item, raw: &keys::ContactTable, gap: &Range<usize>, unit: f64) -> Result<ImageFrame> {
    const EXAMPLE: &str = "Give gap_image = { plane = \"xy\", lower_left = [-40, 60], upper_right = [40, 110], black = 0, \
                           white = 0.02 } in the mesh's unit, plane the axes to the right and up";
    let Some(given) = &raw.gap_image else {
        return Err(item.error(gap, "an image needs its place and the gaps of black and white", EXAMPLE));
    };
    let require = |holds: bool, what: &str| item.require_at(&given.span(), holds, what, EXAMPLE);
    let keys::GapImageTable { plane, lower_left, upper_right, black, white } = given.get_ref();
    let axes: Vec<usize> = plane.chars().filter_map(|axis| "xyz".find(axis)).collect();
    let is_plane = plane.len() == 2 && axes.len() == 2 && axes[0] != axes[1];
    require(is_plane, &format!("gap_image has the plane {plane:?}"))?;
    let numbers = [lower_left[0], lower_left[1], upper_right[0], upper_right[1], *black, *white];
    require(numbers.iter().all(|x| x.is_finite()), "gap_image has a number that is not finite")?;
    let is_wide = lower_left[0] != upper_right[0] && lower_left[1] != upper_right[1];
    require(is_wide, "the image of gap_image has no area")?;
    let metres = |corner: &[f64; 2]| corner.map(|x| unit * x);
    Ok(ImageFrame {
        plane: [axes[0], axes[1]],
        lower_left: metres(lower_left),
        upper_right: metres(upper_right),
        black: unit * black,
        white: unit * white,
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
