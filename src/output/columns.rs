//! Rows of tables. Their fields are the columns of the CSV files and the keys of the JSON documents, with units in
//! their names.

use std::f64::consts::TAU;
use std::io::{Error, Result, Write};

use num_complex::Complex64;
use serde::Serialize;
use serde_json::{Map, Value as Json};

use super::branches::becomes;
use crate::equilibrium::{PairForces, Step};
use crate::results::{CertifiedMode, Kind, ModeData, Source};
use crate::stability::Share;
use crate::tracking::{Hopf, Point};

/// A row at a friction value.
#[derive(Default, Serialize)]
pub struct AtFriction<R> {
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// The rest of the row.
    #[serde(flatten)]
    pub row: R,
}

/// A mode.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ModeRow {
    /// Its number, from 1.
    pub mode: usize,
    /// `Im lambda / 2 pi`
    pub frequency_hz: f64,
    /// `Re lambda`
    pub growth_rate_per_s: f64,
    /// `-Re lambda / |lambda|`
    pub damping_ratio: f64,
    /// Backward error of the scaled problem.
    pub backward_error: f64,
    /// Whether it grows more than rounding explains.
    pub unstable: bool,
}

/// A mode of a super-element compared with the full model.
#[derive(Default, Serialize)]
pub struct CertifiedRow {
    mode: usize,
    frequency_hz: f64,
    growth_rate_per_s: f64,
    corrected_frequency_hz: f64,
    corrected_growth_rate_per_s: f64,
    backward_error_of_full_model: f64,
}

impl CertifiedRow {
    /// A mode by its number.
    pub fn of(mode: usize, own: &CertifiedMode) -> CertifiedRow {
        CertifiedRow {
            mode,
            frequency_hz: own.lambda.im / TAU,
            growth_rate_per_s: own.lambda.re,
            corrected_frequency_hz: own.corrected.im / TAU,
            corrected_growth_rate_per_s: own.corrected.re,
            backward_error_of_full_model: own.backward_error,
        }
    }
}

/// What a contact pair carries.
#[derive(Default, Serialize)]
pub struct ContactRow<'a> {
    pair: &'a str,
    #[serde(flatten)]
    forces: PairForces,
}

/// A Newton iterate; `changes` counts the contact points whose status differs from the iterate before.
#[derive(Default, Serialize)]
pub struct IterationRow<'a> {
    step: &'a str,
    iteration: usize,
    relative_residual: f64,
    open: usize,
    stick: usize,
    slip: usize,
    changes: usize,
}

/// A part, connector or contact pair in a mode, and the sensitivities `growth_per_X` (1/s) and `frequency_per_X` (Hz)
/// with respect to its friction coefficient (by 1), and to a factor on its damping, stiffness and mass.
#[derive(Default, Serialize)]
pub struct SourceRow<'a> {
    kind: Kind,
    name: &'a str,
    #[serde(flatten)]
    share: Share,
    #[serde(flatten)]
    slopes: Map<String, Json>,
}

/// A source of a mode, with the mode.
#[derive(Default, Serialize)]
pub struct ModeSourceRow<'a> {
    /// The mode's number, from 1.
    pub mode: usize,
    /// The mode's frequency.
    pub frequency_hz: f64,
    /// The source.
    #[serde(flatten)]
    pub source: SourceRow<'a>,
}

/// A point of a branch.
#[derive(Default, Serialize)]
pub struct PointRow {
    friction: f64,
    frequency_hz: f64,
    growth_rate_per_s: f64,
    damping_ratio: f64,
}

/// A point with the number of its branch, from 1.
#[derive(Default, Serialize)]
pub struct BranchRow {
    /// The branch.
    pub branch: usize,
    /// The point.
    #[serde(flatten)]
    pub point: PointRow,
}

/// A Hopf point between two solved values. `becomes` is `unstable` or `stable` as the parameter rises; `partner` and
/// its `share` are those of the branch that couples, where one does.
#[derive(Default, Serialize)]
pub struct HopfRow {
    friction: f64,
    friction_low: f64,
    friction_high: f64,
    frequency_hz: f64,
    branch: usize,
    becomes: &'static str,
    partner: Option<usize>,
    share: Option<f64>,
}

impl ModeRow {
    /// The mode of a number, from 1.
    pub fn new(mode: usize, lambda: Complex64, backward_error: f64, unstable: bool) -> ModeRow {
        ModeRow {
            mode,
            frequency_hz: lambda.im.abs() / TAU,
            growth_rate_per_s: lambda.re,
            damping_ratio: damping_ratio(lambda),
            backward_error,
            unstable,
        }
    }

    /// The row of a mode of results.
    pub fn of(mode: usize, data: &ModeData) -> ModeRow {
        ModeRow::new(mode, data.lambda, data.backward_error, data.unstable)
    }
}

fn damping_ratio(lambda: Complex64) -> f64 {
    -lambda.re / lambda.norm().max(f64::MIN_POSITIVE)
}

impl<'a> ContactRow<'a> {
    /// The row of a pair.
    pub fn new(pair: &'a str, forces: &PairForces) -> ContactRow<'a> {
        ContactRow { pair, forces: forces.clone() }
    }
}

impl<'a> IterationRow<'a> {
    /// The iterates of a step, the start first.
    pub fn of(step: &'a Step) -> impl Iterator<Item = IterationRow<'a>> {
        step.iterations.iter().enumerate().map(|(iteration, it)| IterationRow {
            step: &step.label,
            iteration,
            relative_residual: it.residual,
            open: it.counts.open,
            stick: it.counts.stick,
            slip: it.counts.slip,
            changes: it.flips.iter().sum(),
        })
    }
}

impl<'a> SourceRow<'a> {
    /// The row of a source.
    pub fn new(source: &'a Source) -> SourceRow<'a> {
        let s = source.sensitivity;
        let slopes = [
            ("friction", source.friction),
            ("damping", s.map(|s| s.damping)),
            ("stiffness", s.map(|s| s.stiffness)),
            ("mass", s.map(|s| s.mass)),
        ];
        let columns = |(of, slope): (&str, Option<Complex64>)| {
            let [growth, frequency] = [slope.map(|z| z.re), slope.map(|z| z.im / TAU)];
            [(format!("growth_per_{of}"), growth.into()), (format!("frequency_per_{of}"), frequency.into())]
        };
        let slopes = slopes.into_iter().flat_map(columns).collect();
        SourceRow { kind: source.kind, name: &source.name, share: source.share, slopes }
    }
}

impl PointRow {
    /// The row of a point.
    pub fn new(point: &Point) -> PointRow {
        PointRow {
            friction: point.value,
            frequency_hz: point.lambda.im / TAU,
            growth_rate_per_s: point.lambda.re,
            damping_ratio: damping_ratio(point.lambda),
        }
    }
}

impl HopfRow {
    /// The row of a Hopf point.
    pub fn new(hopf: &Hopf) -> HopfRow {
        HopfRow {
            friction: hopf.value,
            friction_low: hopf.bracket[0],
            friction_high: hopf.bracket[1],
            frequency_hz: hopf.omega / TAU,
            branch: hopf.branch + 1,
            becomes: becomes(hopf),
            partner: hopf.partner.map(|partner| partner.branch + 1),
            share: hopf.partner.map(|partner| partner.share),
        }
    }
}

/// Writes rows as CSV under their fields' names. A truth value is 0 or 1, nothing is an empty cell, and a list or an
/// object within a row has no column.
///
/// # Errors
/// The writer's.
pub fn write_csv<R: Serialize + Default>(out: &mut dyn Write, rows: impl IntoIterator<Item = R>) -> Result<()> {
    write_csv_over(out, "friction", rows)
}

/// The same for another parameter than friction, whose name takes the place of `friction` in the columns' names.
///
/// # Errors
/// The writer's.
pub fn write_csv_over<R: Serialize + Default>(
    out: &mut dyn Write,
    parameter: &str,
    rows: impl IntoIterator<Item = R>,
) -> Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let mut rows = rows.into_iter().peekable();
    let columns = rows.peek().map_or_else(|| cells(&R::default()), cells)?;
    table.write_record(columns.keys().map(|column| column.replacen("friction", parameter, 1)))?;
    for row in rows {
        table.write_record(cells(&row)?.values().map(text))?;
    }
    table.flush()
}

fn cells<R: Serialize>(row: &R) -> Result<Map<String, Json>> {
    match serde_json::to_value(row)? {
        Json::Object(cells) => {
            Ok(cells.into_iter().filter(|(_, cell)| !cell.is_object() && !cell.is_array()).collect())
        }
        _ => Err(Error::other("a row of a table is a struct")),
    }
}

/// A number in as many digits as give it back.
fn text(cell: &Json) -> String {
    const PLAIN: std::ops::Range<f64> = 1e-4..1e9;
    match cell {
        Json::Null => String::new(),
        Json::Bool(is_true) => u8::from(*is_true).to_string(),
        Json::String(text) => text.clone(),
        Json::Number(number) if number.is_f64() => match number.as_f64().unwrap_or(f64::NAN) {
            // Zero has no sign.
            0.0 => "0".into(),
            x if PLAIN.contains(&x.abs()) => x.to_string(),
            x => format!("{x:e}"),
        },
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table<R: Serialize + Default>(parameter: &str, rows: Vec<R>) -> String {
        let mut out = Vec::new();
        write_csv_over(&mut out, parameter, rows).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn numbers_come_back_and_a_comma_in_a_name_is_quoted() {
        #[derive(Default, Serialize)]
        struct Row {
            name: &'static str,
            count: usize,
            x: Option<f64>,
            unstable: bool,
        }
        let row = |x| AtFriction { friction: 0.1 + 0.2, row: Row { name: "a, b", count: 3, x, unstable: true } };
        let text = table("mu", vec![row(Some(1.25e-17)), row(None), row(Some(6e10)), row(Some(-0.5)), row(Some(-0.0))]);
        let expected = ["1.25e-17", "", "6e10", "-0.5", "0"].map(|x| format!("0.30000000000000004,\"a, b\",3,{x},1\n"));
        assert_eq!(text, "mu,name,count,x,unstable\n".to_owned() + &expected.concat());
    }

    #[test]
    fn a_table_without_rows_has_its_columns() {
        assert_eq!(
            table("angle", Vec::<HopfRow>::new()),
            "angle,angle_low,angle_high,frequency_hz,branch,becomes,partner,share\n"
        );
    }
}
