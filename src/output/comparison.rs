//! Two results side by side, as text for people and CSV for programs.

use std::io::Write;

use serde::Serialize;

use super::columns::write_csv;
use super::text::{aligned, friction, or_dash, paragraph};
use crate::comparison::{ComparedMode, Comparison, ComparisonAtValue, ModePair};

/// Errors at each friction value, then the unstable modes, then those without partner. `names` are those of A and B.
pub fn text(comparison: &Comparison, names: [&str; 2]) -> String {
    let Comparison { band: [from, to], n_points, interpolated, largest_growth, values } = comparison;
    let points = if *interpolated { "points of A, where B is interpolated" } else { "points of both" };
    format!(
        "A: {}\nB: {}\n\nmodes of {from}-{to} Hz, shapes at {n_points} {points}; B compared with A, growth rates relative to \
         {largest_growth:.1} /s\n\n{}{}{}",
        names[0],
        names[1],
        errors_text(values),
        paragraph(&unstable_text(values)),
        paragraph(&unpaired_text(values))
    )
}

fn errors_text(values: &[ComparisonAtValue]) -> String {
    let heading = "\t\tfrequency error, %\t\tgrowth rate error, %\t\tMAC\tunmatched\t\n\
                   friction\tpairs\tworst (at)\tmean\tworst (at)\tmean\tleast (at)\tA\tB";
    let row = |at: &ComparisonAtValue| {
        let frequency = spread(&at.pairs, |pair| 100.0 * pair.frequency_error);
        let growth = spread(&at.pairs, |pair| 100.0 * pair.growth_error);
        let least = at.pairs.iter().min_by(|a, b| a.mac.total_cmp(&b.mac));
        let mac = or_dash(least, |pair| format!("{:.4} ({:.0} Hz)", pair.mac, pair.a.frequency));
        let [only_a, only_b] = at.unmatched.each_ref().map(Vec::len);
        format!("{}\t{}\t{frequency}\t{growth}\t{mac}\t{only_a}\t{only_b}", friction(at.friction), at.pairs.len())
    };
    aligned(heading, values.iter().map(row))
}

/// Two cells: the largest, by modulus, of some numbers of pairs with its frequency, and the mean modulus.
fn spread(pairs: &[ModePair], of: impl Fn(&ModePair) -> f64) -> String {
    let worst = pairs.iter().max_by(|a, b| of(a).abs().total_cmp(&of(b).abs()));
    let mean = pairs.iter().map(|pair| of(pair).abs()).sum::<f64>() / pairs.len().max(1) as f64;
    worst.map_or("-\t-".into(), |pair| format!("{:+.4} ({:.0} Hz)\t{mean:.4}", of(pair), pair.a.frequency))
}

fn unstable_text(values: &[ComparisonAtValue]) -> String {
    let mut rows = Vec::new();
    for at in values {
        for ModePair { a, b, frequency_error, growth_error, mac } in at.pairs.iter().filter(|pair| pair.is_unstable()) {
            let modes = [a, b].map(|mode| format!("{:.2}\t{:+.2}", mode.frequency, mode.growth_rate)).join("\t");
            let (frequency, growth) = (100.0 * frequency_error, 100.0 * growth_error);
            rows.push(format!("{}\t{modes}\t{frequency:+.4}\t{growth:+.3}\t{mac:.4}", friction(at.friction)));
        }
    }
    if rows.is_empty() {
        return String::new();
    }
    let heading = "friction\tA: Hz\t1/s\tB: Hz\t1/s\tfrequency, %\tgrowth rate, %\tMAC";
    "modes unstable in A or in B\n".to_owned() + &aligned(heading, rows)
}

fn unpaired_text(values: &[ComparisonAtValue]) -> String {
    let mut text = String::new();
    for (side, name) in ["A", "B"].iter().enumerate() {
        for at in values.iter().filter(|at| !at.unmatched[side].is_empty()) {
            let one = |mode: &ComparedMode| {
                let mark = if mode.unstable { ", unstable" } else { "" };
                format!("{:.1} Hz ({:+.1} /s{mark})", mode.frequency, mode.growth_rate)
            };
            let list: Vec<String> = at.unmatched[side].iter().map(one).collect();
            text += &format!("friction {}: only {name} has {}\n", friction(at.friction), list.join(", "));
        }
    }
    text
}

/// A mode of A, of B, or of both.
#[derive(Default, Serialize)]
struct ComparisonRow {
    friction: f64,
    mode_a: Option<usize>,
    mode_b: Option<usize>,
    frequency_a_hz: Option<f64>,
    frequency_b_hz: Option<f64>,
    growth_rate_a_per_s: Option<f64>,
    growth_rate_b_per_s: Option<f64>,
    unstable_a: Option<bool>,
    unstable_b: Option<bool>,
    frequency_error: Option<f64>,
    growth_error: Option<f64>,
    mac: Option<f64>,
}

impl ComparisonRow {
    fn new(friction: f64, a: Option<&ComparedMode>, b: Option<&ComparedMode>) -> ComparisonRow {
        ComparisonRow {
            friction,
            mode_a: a.map(|mode| mode.mode),
            mode_b: b.map(|mode| mode.mode),
            frequency_a_hz: a.map(|mode| mode.frequency),
            frequency_b_hz: b.map(|mode| mode.frequency),
            growth_rate_a_per_s: a.map(|mode| mode.growth_rate),
            growth_rate_b_per_s: b.map(|mode| mode.growth_rate),
            unstable_a: a.map(|mode| mode.unstable),
            unstable_b: b.map(|mode| mode.unstable),
            ..ComparisonRow::default()
        }
    }

    fn of_pair(friction: f64, pair: &ModePair) -> ComparisonRow {
        ComparisonRow {
            frequency_error: Some(pair.frequency_error),
            growth_error: Some(pair.growth_error),
            mac: Some(pair.mac),
            ..ComparisonRow::new(friction, Some(&pair.a), Some(&pair.b))
        }
    }
}

/// All modes as CSV, those without partner with empty cells.
///
/// # Errors
/// The writer's.
pub fn csv(out: &mut dyn Write, comparison: &Comparison) -> std::io::Result<()> {
    let rows = comparison.values.iter().flat_map(|at| {
        let pairs = at.pairs.iter().map(|pair| ComparisonRow::of_pair(at.friction, pair));
        let only_a = at.unmatched[0].iter().map(|mode| ComparisonRow::new(at.friction, Some(mode), None));
        let only_b = at.unmatched[1].iter().map(|mode| ComparisonRow::new(at.friction, None, Some(mode)));
        pairs.chain(only_a).chain(only_b)
    });
    write_csv(out, rows)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::comparison::compare;
    use crate::results::{Results, testing};

    /// Two values of the results for tests, and a model with other eigenvalues that lacks the mode of lowest frequency.
    pub fn reference_and_model() -> [Results; 2] {
        let mut reference = testing::results();
        reference.values.retain(|value| value.asked && (0.35..0.55).contains(&value.friction));
        let mut model = reference.clone();
        for mode in model.values.iter_mut().flat_map(|value| &mut value.modes) {
            mode.lambda.im *= 1.001;
            mode.lambda.re += 0.5;
        }
        model.values[0].modes.remove(0);
        [reference, model]
    }

    #[test]
    fn a_comparison_has_errors_unstable_modes_and_modes_without_partner() {
        let [reference, model] = reference_and_model();
        insta::assert_snapshot!(text(&compare(&reference, &model).unwrap(), ["full", "reduced"]));
    }
}
