//! How the friction coefficient of a contact depends on sliding speed, pressure and temperature.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::grid::{Grid, GridInterval, columns};
use super::item::Item;
use super::keys;
use crate::Result;

/// Friction above this is taken for a mistake.
pub const LARGEST_FRICTION: f64 = 2.0;

/// The coefficient of rough surfaces, which never slip where they touch.
pub const ROUGH: f64 = 1e9;

/// A coefficient as a function of the sliding speed v (m/s) and the pressure q (Pa), divided by the friction value
/// `mu_0` of its contact: `mu = mu_0 phi(v, q)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum FrictionCurve {
    /// It falls with the speed.
    Decay(SpeedDecay),
    /// It falls with the speed and rises again.
    Stribeck(Stribeck),
    /// As a table has it.
    Table(FrictionTable),
}

/// `phi = r + (1 - r) exp(-d v)`
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SpeedDecay {
    /// r, the kinetic coefficient divided by the static one.
    pub kinetic_ratio: f64,
    /// d, s/m.
    pub decay: f64,
}

/// `phi = r + (1 - r) exp(-(v / v_s)^delta) + b v`
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stribeck {
    /// r, the kinetic coefficient divided by the static one.
    pub kinetic_ratio: f64,
    /// `v_s`, m/s.
    pub speed: f64,
    /// delta, at least 1.
    pub exponent: f64,
    /// b, s/m: the viscous coefficient divided by the static one.
    pub viscous: f64,
}

/// phi at the points of a grid; linear between them in each variable, constant beyond them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrictionTable {
    /// Rising speeds, m/s; one where phi does not depend on it.
    pub speeds: Vec<f64>,
    /// Rising pressures, Pa; one where phi does not depend on it.
    pub pressures: Vec<f64>,
    /// phi, speed by speed.
    pub values: Vec<f64>,
}

/// What a table may depend on.
const VARIABLES: [&str; 3] = ["speed", "pressure", "temperature"];

/// The friction value of a contact, and how its coefficient depends on other things.
pub fn contact_friction(item: &Item, raw: &Spanned<keys::Friction>) -> Result<(f64, Option<FrictionCurve>)> {
    match raw.get_ref() {
        keys::Friction::Constant(mu) => Ok((friction(item, &Spanned::new(raw.span(), *mu))?, None)),
        keys::Friction::Word(keys::FrictionWord::Rough) => Ok((ROUGH, None)),
        &keys::Friction::Decay(keys::DecayTable { at_rest, kinetic, decay }) => {
            let holds = is_positive(at_rest) && is_coefficient(kinetic) && decay > 0.0 && decay.is_finite();
            let what = format_args!("friction has static = {at_rest}, kinetic = {kinetic}, decay = {decay}");
            let advice = "Give static above 0 and kinetic from 0, both up to 2, and a decay above 0 in s/m";
            item.require_at(&raw.span(), holds, what, advice)?;
            Ok((at_rest, Some(FrictionCurve::Decay(SpeedDecay { kinetic_ratio: kinetic / at_rest, decay }))))
        }
        keys::Friction::Stribeck(table) => stribeck(item, raw, table),
        keys::Friction::Table(table) => tabular(item, raw, table),
    }
}

/// A coefficient of friction.
pub fn friction(item: &Item, value: &Spanned<f64>) -> Result<f64> {
    let holds = is_coefficient(*value.get_ref());
    item.check(value, holds, "friction", "must be from 0 to 2", "Give a coefficient, such as 0.5")
}

fn is_coefficient(mu: f64) -> bool {
    (0.0..=LARGEST_FRICTION).contains(&mu)
}

fn is_positive(mu: f64) -> bool {
    mu > 0.0 && is_coefficient(mu)
}

fn stribeck(
    item: &Item,
    raw: &Spanned<keys::Friction>,
    table: &keys::StribeckTable,
) -> Result<(f64, Option<FrictionCurve>)> {
    let &keys::StribeckTable { at_rest, kinetic, stribeck_speed: speed, exponent, viscous } = table;
    let numbers = [speed, exponent, viscous].into_iter().all(f64::is_finite);
    let holds = numbers && is_positive(at_rest) && is_coefficient(kinetic) && speed > 0.0;
    let advice = "Give static above 0 and kinetic from 0, both up to 2, a stribeck_speed above 0 in m/s, \
                  an exponent of 1 or above, and viscous from 0 in s/m";
    let falling = format_args!("static = {at_rest}, kinetic = {kinetic}, stribeck_speed = {speed}");
    let what = format_args!("friction has {falling}, exponent = {exponent}, viscous = {viscous}");
    item.require_at(&raw.span(), holds && exponent >= 1.0 && viscous >= 0.0, what, advice)?;
    let curve = Stribeck { kinetic_ratio: kinetic / at_rest, speed, exponent, viscous: viscous / at_rest };
    Ok((at_rest, Some(FrictionCurve::Stribeck(curve))))
}

/// A table of coefficients over speed, pressure and temperature, at the contact's temperature.
fn tabular(
    item: &Item,
    raw: &Spanned<keys::Friction>,
    table: &keys::FrictionRows,
) -> Result<(f64, Option<FrictionCurve>)> {
    let by: Vec<&str> = table.by.iter().map(String::as_str).collect();
    let tabulated = FrictionTable::of_rows(&by, &table.table, table.temperature);
    let (friction, table) = tabulated.map_err(|Refusal { what, advice }| item.error(&raw.span(), what, advice))?;
    Ok((friction, Some(FrictionCurve::Table(table))))
}

/// Why rows make no friction table, and what to do.
#[derive(Debug)]
pub struct Refusal {
    /// What is wrong.
    pub what: String,
    /// What to do.
    pub advice: &'static str,
}

impl FrictionTable {
    /// The table of rows `[mu, value, ...]` at a temperature, and the friction value: mu at the table's lowest speed
    /// and pressure. `by` says what the values are: `"speed"` (m/s), `"pressure"` (Pa), `"temperature"` (in the unit of
    /// the temperature given).
    ///
    /// # Errors
    /// [`Refusal`] where a row is wrong, or where the rows are not a full grid.
    pub fn of_rows(
        by: &[&str],
        rows: &[Vec<f64>],
        temperature: Option<f64>,
    ) -> std::result::Result<(f64, FrictionTable), Refusal> {
        let refuse = |what: String, advice: &'static str| Refusal { what, advice };
        let columns = columns(VARIABLES, by, 1).ok_or_else(|| {
            let advice = "Give by = [\"speed\"], or several of \"speed\", \"pressure\" and \"temperature\", each once";
            refuse(format!("the friction table is by {by:?}"), advice)
        })?;
        if columns[2].is_some() != temperature.is_some() {
            let advice = "Give temperature = ... beside a table by temperature, in the table's unit, and only there";
            return Err(refuse("the table and the temperature do not go together".into(), advice));
        }
        let grid = grid(rows, columns).map_err(|what| {
            let advice = "A row is [mu, value, ...] in the order of `by`, all finite, mu from 0 to 2; \
                          every combination of the values once";
            refuse(what, advice)
        })?;
        let table = at_temperature(grid, temperature);
        let value = table.values[0];
        if value <= 0.0 {
            let advice = "It is the friction value, and must be above 0";
            return Err(refuse("the coefficient at the lowest speed and pressure is 0".into(), advice));
        }
        Ok((value, FrictionTable { values: table.values.iter().map(|mu| mu / value).collect(), ..table }))
    }
}

/// The grid of rows `[mu, value, ...]`.
fn grid(rows: &[Vec<f64>], columns: [Option<usize>; 3]) -> std::result::Result<Grid<3>, String> {
    if rows.is_empty() {
        return Err("the friction table is empty".into());
    }
    let n_columns = 1 + columns.iter().flatten().count();
    let is_wrong =
        |row: &&Vec<f64>| row.len() != n_columns || !row.iter().all(|x| x.is_finite()) || !is_coefficient(row[0]);
    if let Some(row) = rows.iter().find(is_wrong) {
        return Err(format!("the friction table has the row {row:?}"));
    }
    Grid::new(rows, columns)
        .ok_or_else(|| "the friction table has a combination of values not at all or twice".to_owned())
}

/// mu at a temperature, linear between the table's.
fn at_temperature(grid: Grid<3>, temperature: Option<f64>) -> FrictionTable {
    let Grid { axes: [speeds, pressures, temperatures], rows } = grid;
    let interval = GridInterval::around(&temperatures, temperature.unwrap_or(0.0));
    let between = |rows: &[Vec<f64>]| interval.between(rows[interval.lower][0], rows[interval.upper][0]);
    FrictionTable { speeds, pressures, values: rows.chunks(temperatures.len()).map(between).collect() }
}
