//! Tables of a study of many parameters.

use std::io::{Result as IoResult, Write};

use crate::explore::{
    BoundaryPair, Gradient, HopfPoint, Link, Outcome, Parameter, PointMode, PointResult, Tornado, missing_derivatives,
    tornados,
};

/// A row for each point: values, largest growth rate, and why it has failed where it has.
pub(super) fn write_points(out: &mut dyn Write, names: &[&str], points: &[PointResult]) -> IoResult<()> {
    let mut table = csv::Writer::from_writer(out);
    let results = ["modes", "unstable_modes", "growth_rate_per_s", "frequency_hz", "failure"];
    table.write_record(["point"].iter().chain(names).chain(&results))?;
    for (number, point) in points.iter().enumerate() {
        let critical = |of: fn(&PointMode) -> f64| point.critical().map_or_else(String::new, |mode| shown(of(mode)));
        let count = |of: fn(&PointMode) -> bool| {
            point.modes().map_or_else(String::new, |modes| modes.iter().filter(|mode| of(mode)).count().to_string())
        };
        let reason = match &point.outcome {
            Outcome::Failed(reason) => reason.clone(),
            Outcome::Modes(_) => String::new(),
        };
        let values = point.values.iter().map(|value| shown(*value));
        let results = [
            count(|_| true),
            count(|mode| mode.unstable),
            critical(PointMode::growth_rate),
            critical(PointMode::frequency),
            reason,
        ];
        table.write_record([number.to_string()].into_iter().chain(values).chain(results))?;
    }
    table.flush()
}

/// A row for each mode of each point.
pub(super) fn write_modes(out: &mut dyn Write, points: &[PointResult]) -> IoResult<()> {
    let mut table = csv::Writer::from_writer(out);
    let head = [
        "point",
        "mode",
        "frequency_hz",
        "growth_rate_per_s",
        "damping_ratio",
        "backward_error",
        "unstable",
        "nominal_mode",
        "share",
        "doubtful",
    ];
    table.write_record(head)?;
    for (number, point) in points.iter().enumerate() {
        for (mode, own) in (1..).zip(point.modes().into_iter().flatten()) {
            let link = |of: fn(&Link) -> String| own.link.as_ref().map_or_else(String::new, of);
            table.write_record([
                number.to_string(),
                mode.to_string(),
                shown(own.frequency()),
                shown(own.growth_rate()),
                shown(own.damping_ratio()),
                shown(own.backward_error),
                own.unstable.to_string(),
                link(|link| link.nominal.to_string()),
                link(|link| format!("{:.4}", link.share)),
                link(|link| link.doubtful.to_string()),
            ])?;
        }
    }
    table.flush()
}

/// A row for each pair of neighbours with opposite verdicts.
pub(super) fn write_boundary(out: &mut dyn Write, names: &[&str], pairs: &[BoundaryPair]) -> IoResult<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(names.iter().chain(&["distance", "stable_point", "unstable_point"]))?;
    for BoundaryPair { stable, unstable, distance, middle } in pairs {
        let ends = [shown(*distance), stable.to_string(), unstable.to_string()];
        table.write_record(middle.iter().map(|value| shown(*value)).chain(ends))?;
    }
    table.flush()
}

/// A row for each Hopf point of a map; the mode is empty where it was not recognised.
pub(super) fn write_hopf(out: &mut dyn Write, names: &[&str], points: &[HopfPoint]) -> IoResult<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(names.iter().chain(&["frequency_hz", "nominal_mode"]))?;
    for HopfPoint { nominal, values, frequency_hz } in points {
        let numbers = values.iter().chain([frequency_hz]).map(|number| shown(*number));
        table.write_record(numbers.chain([nominal.map_or_else(String::new, |number| number.to_string())]))?;
    }
    table.flush()
}

/// A row for each nominal mode and parameter; without a derivative the numbers are empty, and the reason is the last
/// entry.
pub(super) fn write_gradients(
    out: &mut dyn Write,
    parameters: &[Parameter],
    gradients: &[Gradient],
    points: &[PointResult],
) -> IoResult<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record([
        "nominal_mode",
        "parameter",
        "growth_rate_slope",
        "frequency_slope",
        "from",
        "to",
        "growth_rate_change_per_s",
        "frequency_change_hz",
        "difference",
    ])?;
    let missing = missing_derivatives(parameters, gradients);
    for Tornado { nominal, bars, .. } in &tornados(parameters, gradients, points) {
        for bar in bars {
            let numbers = [
                bar.growth_rate_slope,
                bar.frequency_slope,
                bar.from,
                bar.to,
                bar.growth_rate_change_per_s,
                bar.frequency_change_hz,
            ];
            let head = [nominal.to_string(), bar.parameter.clone()];
            table.write_record(head.into_iter().chain(numbers.map(shown)).chain([bar.difference.clone()]))?;
        }
        for own in &missing {
            let head = [nominal.to_string(), own.parameter.clone()];
            table.write_record(head.into_iter().chain([""; 6].map(str::to_owned)).chain([own.reason.clone()]))?;
        }
    }
    table.flush()
}

/// A number to its last digit.
fn shown(number: f64) -> String {
    serde_json::Value::from(number).to_string()
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::explore::{Difference, Distribution, KeyPath};

    #[test]
    fn a_parameter_without_a_derivative_has_a_row_with_the_reason() {
        let parameter = |name: &str| Parameter {
            name: name.into(),
            keys: vec![KeyPath::parse("friction").unwrap()],
            is_factor: false,
            distribution: Distribution::Values(vec![0.0]),
        };
        let mode = PointMode { lambda: Complex64::new(-1.0, 1e3), unstable: false, backward_error: 0.0, link: None };
        let nominal = PointResult { values: vec![0.0, 0.0], outcome: Outcome::Modes(vec![mode]) };
        let known = Gradient { slopes: vec![Complex64::new(2.0, 0.0)], difference: Difference::Forward };
        let none = Gradient { slopes: Vec::new(), difference: Difference::None("lost".into()) };
        let mut text = Vec::new();
        write_gradients(&mut text, &[parameter("p"), parameter("q")], &[none, known], &[nominal]).unwrap();
        let text = String::from_utf8(text).unwrap();
        let rows: Vec<&str> = text.lines().skip(1).collect();
        assert_eq!(rows, ["1,q,2.0,0.0,0.0,0.0,0.0,0.0,forward", "1,p,,,,,,,lost"]);
    }
}
