//! A brake in several models: tables for people and programs.

use std::io::{Result, Write};

use serde::Serialize;

use super::columns::write_csv;
use crate::comparison::{CurvePoint, Errors, StudiedModel, Study};

/// Sizes and times, errors, and the instabilities over friction.
pub fn text(study: &Study) -> String {
    let Study { title, band: [from, to], mesh: [n_nodes, n_elements], frictions, .. } = study;
    let head = format!(
        "{title}: reduced models compared with full contact, modes of {from}-{to} Hz at {} friction value{}\nmesh: {n_nodes} nodes, {n_elements} elements\n",
        frictions.len(),
        if frictions.len() == 1 { "" } else { "s" }
    );
    let curves = (0..study.reference.curves.len()).map(|i| curve_text(study, i)).collect::<String>();
    head + "\n" + &sizes_text(study) + "\n" + &errors_text(study) + &curves + &spurious_text(study)
}

fn models(study: &Study) -> impl Iterator<Item = &StudiedModel> {
    [&study.reference].into_iter().chain(&study.models)
}

fn width(study: &Study) -> usize {
    models(study).map(|model| model.name.len()).max().unwrap_or(0)
}

fn or_dash<T>(value: Option<T>, shown: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "-".into(), shown)
}

/// Table 2 of the paper, with what a friction costs.
fn sizes_text(study: &Study) -> String {
    let w = width(study);
    let mut text = format!(
        "{:w$}  {:>8} {:>8} {:>9}  {:>12} {:>8}  {:>9}\n{:w$}  {:>8} {:>8} {:>9}  {:>12} {:>8}  {:>9}\n",
        "",
        "contact",
        "retained",
        "",
        "seconds",
        "times",
        "seconds",
        "model",
        "points",
        "points",
        "equations",
        "per friction",
        "faster",
        "to make"
    );
    for model in models(study) {
        let sizes = model.sizes;
        text += &format!(
            "{:w$}  {:>8} {:>8} {:>9}  {:>12.3} {:>8.1}  {:>9}\n",
            model.name,
            sizes.n_contacts,
            or_dash(sizes.n_retained, |n| n.to_string()),
            sizes.n_equations,
            model.seconds,
            study.reference.seconds / model.seconds.max(f64::MIN_POSITIVE),
            or_dash(model.making_seconds, |s| format!("{s:.1}"))
        );
    }
    text
}

/// What is largest over all frictions.
struct Worst {
    frequency: f64,
    mean: f64,
    growth: f64,
    mac: f64,
    n_unmatched: [usize; 2],
}

impl Worst {
    fn of(errors: &[Errors]) -> Worst {
        let largest = |of: fn(&Errors) -> f64| errors.iter().map(of).fold(0.0, f64::max);
        Worst {
            frequency: largest(|e| e.worst_frequency),
            mean: errors.iter().map(|e| e.mean_frequency).sum::<f64>() / errors.len().max(1) as f64,
            growth: largest(|e| e.worst_growth),
            mac: errors.iter().map(|e| e.least_mac).fold(1.0, f64::min),
            n_unmatched: [0, 1].map(|side| errors.iter().map(|e| e.n_unmatched[side]).sum()),
        }
    }
}

fn errors_text(study: &Study) -> String {
    let w = width(study);
    let instabilities: Vec<String> = study.reference.curves.iter().map(|curve| name(curve)).collect();
    let mut text = format!(
        "{:w$}  {:^21}  {:>10}  {:>6}  {:^13}",
        "errors over all modes", "frequency, %", "growth", "least", "unmatched"
    );
    text += &format!("{}\n", if instabilities.is_empty() { "" } else { "  unstable where the reference is" });
    text += &format!(
        "{:w$}  {:>10} {:>10}  {:>10}  {:>6}  {:>6} {:>6}",
        "and values", "worst", "mean", "rate, %", "MAC", "ref.", "model"
    );
    text += &(instabilities.iter().map(|name| format!("  {name:>9}")).collect::<String>() + "\n");
    for model in &study.models {
        let worst = Worst::of(&model.errors);
        let [a, b] = worst.n_unmatched;
        let found = (0..instabilities.len()).map(|i| {
            let [found, all] = study.found(i, model);
            format!("  {:>9}", format!("{found} of {all}"))
        });
        text += &format!(
            "{:w$}  {:>10.4} {:>10.4}  {:>10.3}  {:>6.4}  {a:>6} {b:>6}{}\n",
            model.name,
            100.0 * worst.frequency,
            100.0 * worst.mean,
            100.0 * worst.growth,
            worst.mac,
            found.collect::<String>()
        );
    }
    text + "growth rates relative to the largest of the reference\n"
}

/// An instability by its frequency where it begins to grow.
fn name(curve: &[CurvePoint]) -> String {
    curve.iter().find(|point| point.unstable).map_or_else(String::new, |point| format!("{:.0} Hz", point.frequency))
}

/// An instability over friction in all models: figures 7 and 8 of the paper in numbers.
fn curve_text(study: &Study, i: usize) -> String {
    let w = width(study);
    let mut text =
        format!("\nthe mode at {}: Hz and growth rate in 1/s\n{:w$}", name(&study.reference.curves[i]), "friction");
    text += &study.frictions.iter().map(|mu| format!("{:>17}", format!("{mu:.3}"))).collect::<String>();
    for model in models(study) {
        text += &format!("\n{:w$}", model.name);
        for mu in &study.frictions {
            let point = model.curves[i].iter().find(|point| point.friction == *mu);
            let cell = or_dash(point, |point| format!("{:.1} {:+.1}", point.frequency, point.growth_rate));
            text += &format!("{cell:>17}");
        }
    }
    text + "\n"
}

fn spurious_text(study: &Study) -> String {
    let mut text = String::new();
    for model in study.models.iter().filter(|model| !model.spurious.is_empty()) {
        let one = |[mu, hertz, growth]: &[f64; 3]| format!("{hertz:.1} Hz at {mu:.3} ({growth:+.1} /s)");
        let list: Vec<String> = model.spurious.iter().map(one).collect();
        text += &format!("{} is unstable where the reference is not: {}\n", model.name, list.join(", "));
    }
    if text.is_empty() { text } else { format!("\n{text}") }
}

/// Size and times of a model.
#[derive(Default, Serialize)]
struct SizesRow<'a> {
    model: &'a str,
    contact_points: usize,
    retained_points: Option<usize>,
    equations: usize,
    seconds_per_friction: f64,
    seconds_to_make: Option<f64>,
}

/// Errors of a model at a friction value.
#[derive(Default, Serialize)]
struct ErrorsRow<'a> {
    model: &'a str,
    friction: f64,
    modes: usize,
    worst_frequency_error: f64,
    mean_frequency_error: f64,
    worst_growth_error: f64,
    least_mac: f64,
    unmatched_reference: usize,
    unmatched_model: usize,
}

/// An instability (from 1) in a model at a friction value.
#[derive(Default, Serialize)]
struct CurveRow<'a> {
    instability: usize,
    model: &'a str,
    friction: f64,
    frequency_hz: f64,
    growth_rate_per_s: f64,
    unstable: bool,
    mac: f64,
}

impl<'a> SizesRow<'a> {
    fn new(model: &'a StudiedModel) -> SizesRow<'a> {
        SizesRow {
            model: &model.name,
            contact_points: model.sizes.n_contacts,
            retained_points: model.sizes.n_retained,
            equations: model.sizes.n_equations,
            seconds_per_friction: model.seconds,
            seconds_to_make: model.making_seconds,
        }
    }
}

impl<'a> ErrorsRow<'a> {
    fn new(model: &'a StudiedModel, errors: &Errors) -> ErrorsRow<'a> {
        ErrorsRow {
            model: &model.name,
            friction: errors.friction,
            modes: errors.n_pairs,
            worst_frequency_error: errors.worst_frequency,
            mean_frequency_error: errors.mean_frequency,
            worst_growth_error: errors.worst_growth,
            least_mac: errors.least_mac,
            unmatched_reference: errors.n_unmatched[0],
            unmatched_model: errors.n_unmatched[1],
        }
    }
}

impl<'a> CurveRow<'a> {
    fn new(model: &'a StudiedModel, instability: usize, point: &CurvePoint) -> CurveRow<'a> {
        CurveRow {
            instability,
            model: &model.name,
            friction: point.friction,
            frequency_hz: point.frequency,
            growth_rate_per_s: point.growth_rate,
            unstable: point.unstable,
            mac: point.mac,
        }
    }
}

/// Sizes and times as CSV.
///
/// # Errors
/// The writer's.
pub fn sizes(out: &mut dyn Write, study: &Study) -> Result<()> {
    write_csv(out, models(study).map(SizesRow::new))
}

/// Errors as CSV.
///
/// # Errors
/// The writer's.
pub fn errors(out: &mut dyn Write, study: &Study) -> Result<()> {
    let rows = |model| move |errors| ErrorsRow::new(model, errors);
    write_csv(out, study.models.iter().flat_map(|model| model.errors.iter().map(rows(model))))
}

/// The instabilities over friction as CSV.
///
/// # Errors
/// The writer's.
pub fn curves(out: &mut dyn Write, study: &Study) -> Result<()> {
    let mut rows = Vec::new();
    for model in models(study) {
        for (number, curve) in (1..).zip(&model.curves) {
            rows.extend(curve.iter().map(|point| CurveRow::new(model, number, point)));
        }
    }
    write_csv(out, rows)
}
