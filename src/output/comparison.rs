//! Two results side by side, as text for people and CSV for programs.

use std::io::Write;

use serde::Serialize;

use super::columns::write_csv;
use crate::comparison::{Comparison, ComparisonAtValue, ModePair, UnpairedMode};

/// The largest, by modulus, of some numbers of pairs, and the mean modulus.
struct Spread<'c> {
    worst: Option<(f64, &'c ModePair)>,
    mean: f64,
}

impl<'c> Spread<'c> {
    fn new(pairs: &'c [ModePair], of: impl Fn(&ModePair) -> f64) -> Spread<'c> {
        let worst = pairs.iter().map(|pair| (of(pair), pair)).max_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()));
        let sum: f64 = pairs.iter().map(|pair| of(pair).abs()).sum();
        Spread { worst, mean: sum / pairs.len().max(1) as f64 }
    }

    /// The worst in percent with its frequency, and the mean.
    fn text(&self) -> String {
        match self.worst {
            Some((x, pair)) => {
                format!("{:>+9.4} ({:>6.0} Hz) {:>8.4}", 100.0 * x, pair.frequencies[0], 100.0 * self.mean)
            }
            None => format!("{:>29}", "-"),
        }
    }
}

/// Errors at each friction, then the modes that grow, then those without partner. `names` tells what A and B are.
pub fn text(comparison: &Comparison, names: [&str; 2]) -> String {
    let Comparison { band: [from, to], n_points, interpolated, largest_growth, frictions } = comparison;
    let how = if *interpolated { "points of A, where B is interpolated" } else { "points of both" };
    let mut text = format!(
        "A: {}\nB: {}\n\nmodes of {from}-{to} Hz, shapes at {n_points} {how}; B compared with A, growth rates relative to {largest_growth:.1} /s\n\n\
         {:>8} {:>6}  {:^29}  {:^29}  {:^19}  {:^11}\n{:>8} {:>6}  {:>9} {:>11} {:>8}  {:>9} {:>11} {:>8}  {:>6} {:>11}  {:>5} {:>5}\n",
        names[0],
        names[1],
        "",
        "",
        "frequency error, %",
        "growth rate error, %",
        "MAC",
        "unmatched",
        "friction",
        "pairs",
        "worst",
        "(at)",
        "mean",
        "worst",
        "(at)",
        "mean",
        "least",
        "(at)",
        "A",
        "B"
    );
    text += &frictions.iter().map(line).collect::<String>();
    let unstable = |pair: &&ModePair| pair.unstable.contains(&true);
    if frictions.iter().any(|at| at.pairs.iter().any(|pair| unstable(&pair))) {
        text += "\nmodes unstable in A or in B\n friction       A: Hz       1/s      B: Hz       1/s  frequency, %  growth rate, %     MAC\n";
        for at in frictions {
            text += &at.pairs.iter().filter(unstable).map(|pair| unstable_line(at.friction, pair)).collect::<String>();
        }
    }
    text + &lone_text(frictions)
}

fn line(at: &ComparisonAtValue) -> String {
    let least = at.pairs.iter().min_by(|a, b| a.mac.total_cmp(&b.mac));
    let mac =
        least.map_or(format!("{:>18}", "-"), |pair| format!("{:>6.4} ({:>6.0} Hz)", pair.mac, pair.frequencies[0]));
    format!(
        "{:>8.4} {:>6}  {}  {}  {mac}  {:>5} {:>5}\n",
        at.friction,
        at.pairs.len(),
        Spread::new(&at.pairs, |pair| pair.frequency_error).text(),
        Spread::new(&at.pairs, |pair| pair.growth_error).text(),
        at.unmatched[0].len(),
        at.unmatched[1].len()
    )
}

fn unstable_line(friction: f64, pair: &ModePair) -> String {
    let [f, g] = pair.frequencies;
    let [a, b] = pair.growth_rates;
    let (df, da, mac) = (100.0 * pair.frequency_error, 100.0 * pair.growth_error, pair.mac);
    format!("{friction:>9.4} {f:>11.2} {a:>+9.2} {g:>10.2} {b:>+9.2} {df:>+13.4} {da:>+15.3} {mac:>7.4}\n")
}

fn lone_text(frictions: &[ComparisonAtValue]) -> String {
    let mut text = String::new();
    for (side, name) in ["A", "B"].iter().enumerate() {
        for at in frictions.iter().filter(|at| !at.unmatched[side].is_empty()) {
            let one = |lone: &UnpairedMode| {
                let mark = if lone.unstable { ", unstable" } else { "" };
                format!("{:.1} Hz ({:+.1} /s{mark})", lone.frequency, lone.growth_rate)
            };
            let list: Vec<String> = at.unmatched[side].iter().map(one).collect();
            text += &format!("friction {:.4}: only {name} has {}\n", at.friction, list.join(", "));
        }
    }
    if text.is_empty() { text } else { format!("\n{text}") }
}

/// A mode of A, of B, or of both; modes are numbered from 1.
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
    fn new(friction: f64, a: Option<&UnpairedMode>, b: Option<&UnpairedMode>) -> ComparisonRow {
        ComparisonRow {
            friction,
            mode_a: a.map(|mode| mode.mode + 1),
            mode_b: b.map(|mode| mode.mode + 1),
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
        let [a, b] = [0, 1].map(|side| UnpairedMode {
            mode: pair.modes[side],
            frequency: pair.frequencies[side],
            growth_rate: pair.growth_rates[side],
            unstable: pair.unstable[side],
        });
        ComparisonRow {
            frequency_error: Some(pair.frequency_error),
            growth_error: Some(pair.growth_error),
            mac: Some(pair.mac),
            ..ComparisonRow::new(friction, Some(&a), Some(&b))
        }
    }
}

/// All modes as CSV, those without partner with empty cells.
///
/// # Errors
/// The writer's.
pub fn csv(out: &mut dyn Write, comparison: &Comparison) -> std::io::Result<()> {
    let rows = comparison.frictions.iter().flat_map(|at| {
        let pairs = at.pairs.iter().map(|pair| ComparisonRow::of_pair(at.friction, pair));
        let only_a = at.unmatched[0].iter().map(|mode| ComparisonRow::new(at.friction, Some(mode), None));
        let only_b = at.unmatched[1].iter().map(|mode| ComparisonRow::new(at.friction, None, Some(mode)));
        pairs.chain(only_a).chain(only_b)
    });
    write_csv(out, rows)
}
