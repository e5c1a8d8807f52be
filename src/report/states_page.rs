//! The page of named states: verdicts, unstable modes by state, growth over friction, pressure maps side by side.

use maud::{Markup, PreEscaped, html};

use super::frame::frame;
use super::pressure_map;
use super::states::{InstabilityRow, StateDocument, StatesDocument, middle};
use super::svg::{Anchor, PALE, Panel, Scale, Sheet, colour};
use crate::algebra::span;
use crate::analysis::StateResults;
use crate::results::{ModeData, Results};

/// The page; it is one file and loads nothing.
pub fn page(document: &StatesDocument, states: &[StateResults]) -> String {
    let [from, to] = document.band_hz;
    let body = html! {
        header.top {
            h1 { (document.title) ": " (document.states.len()) " states" }
            p { "Complex modes " (from) "\u{2013}" (to) " Hz. A mode is unstable with a " (document.criterion) "." }
        }
        main {
            section aria-label="States" { h2 { "States" } (verdicts(document)) }
            section aria-label="Unstable modes" { h2 { "Unstable modes by state" } (instabilities(document)) }
            section aria-label="Growth" {
                h2 { "Largest growth rate" }
                figure.card.plot { (PreEscaped(growth(states))) }
            }
            section aria-label="Contact pressure" {
                h2 { "Contact pressure of the sliding pairs" }
                @if let Some(value) = states.first().and_then(|state| middle(&state.results)) {
                    p.hint { "At \u{3bc} = " (value.friction) "; one scale of colours for all states of a pair." }
                }
                @for map in maps(states) { figure.card.plot { (PreEscaped(map)) } }
            }
        }
        footer { p { "Written by squeal. This page is one file and needs no network." } }
    };
    frame(&format!("{}: squeal states", document.title), None, &body)
}

fn verdicts(document: &StatesDocument) -> Markup {
    html! {
        div.over {
            table {
                thead { tr { th.left { "state" } th.left { "verdict" } th { "sliding, m" } th { "worn" } th.left { "pages" } } }
                tbody { @for state in &document.states { (verdict(state)) } }
            }
        }
    }
}

fn verdict(state: &StateDocument) -> Markup {
    let depth = state.wear.iter().map(|pair| pair.depth).fold(0.0, f64::max);
    let mass: f64 = state.wear.iter().map(|pair| pair.mass).sum();
    html! {
        tr {
            td.left { (state.state) }
            td.left { (state.verdict) }
            td { (state.wear_distance_m.map_or_else(|| "\u{2013}".to_owned(), |distance| format!("{distance:.3e}"))) }
            td { @if state.wear.is_empty() { "\u{2013}" } @else { (format!("{:.1} \u{b5}m, {:.2} g", 1e6 * depth, 1e3 * mass)) } }
            td.left { a href=(format!("{}.html", state.folder)) { "report" } }
        }
    }
}

fn instabilities(document: &StatesDocument) -> Markup {
    const HEADS: [&str; 8] = [
        "onset \u{3bc}",
        "onset, Hz",
        "fastest at \u{3bc}",
        "Hz",
        "growth rate, 1/s",
        "damping ratio, %",
        "mode of the first state, Hz (1/s)",
        "MAC",
    ];
    html! {
        div.over {
            table {
                thead { tr { th.left { "state" } @for head in HEADS { th { (head) } } } }
                tbody {
                    @for state in &document.states {
                        @if state.instabilities.is_empty() { tr { td.left { (state.state) } td.left colspan="8" { "none" } } }
                        @for row in &state.instabilities { (instability(row)) }
                    }
                }
            }
        }
    }
}

fn instability(row: &InstabilityRow) -> Markup {
    let dash = || "\u{2013}".to_owned();
    let first = row.first_state_frequency_hz.zip(row.first_state_growth_rate_per_s);
    html! {
        tr {
            td.left { (row.state) }
            td { @if !row.onset_is_followed { "\u{2264} " } (format!("{:.4}", row.onset_friction)) }
            td { (format!("{:.1}", row.onset_frequency_hz)) }
            td { (row.friction) }
            td { (format!("{:.1}", row.frequency_hz)) }
            td { (format!("{:+.1}", row.growth_rate_per_s)) }
            td { (format!("{:.3}", 100.0 * row.damping_ratio)) }
            td { (first.map_or_else(dash, |(f, a)| format!("{f:.1} ({a:+.1})"))) }
            td { (row.mac.map_or_else(dash, |mac| format!("{mac:.3}"))) }
        }
    }
}

/// The largest growth rate at each friction value asked for, a line a state.
fn growth(states: &[StateResults]) -> String {
    let lines: Vec<Vec<[f64; 2]>> = states.iter().map(|state| largest_growth(&state.results)).collect();
    let range = |i: usize| span(lines.iter().flatten().map(|point| point[i]));
    let ([low, high], height) = (range(1), 20.0 * states.len().div_ceil(2) as f64);
    let mut sheet = Sheet::new([760.0, 400.0 + height]);
    let (x, y) = (Scale::with_margin(range(0), 0.03), Scale::with_margin([low.min(0.0), high.max(0.0)], 0.06));
    let panel = Panel { area: [80.0, 40.0, 640.0, 290.0], x, y };
    panel.draw(&mut sheet, Some("friction coefficient \u{3bc}"), "growth rate, 1/s");
    let [from, to] = range(0);
    sheet.line(panel.at(from, 0.0), panel.at(to, 0.0), &format!(r#"stroke="{PALE}" stroke-dasharray="4 3""#));
    for (k, (state, points)) in states.iter().zip(&lines).enumerate() {
        // States that agree are seen beside each other.
        let width = (5.0 - 1.2 * k as f64).max(1.4);
        let style = format!(r#"stroke="{}" stroke-width="{width:.1}""#, colour(k));
        let places: Vec<[f64; 2]> = points.iter().map(|&[mu, rate]| panel.at(mu, rate)).collect();
        sheet.polyline(&places, &style);
        places.iter().for_each(|place| sheet.circle(*place, 3.0, &format!(r#"fill="{}""#, colour(k))));
        let [x, y] = [80.0 + 330.0 * (k % 2) as f64, 390.0 + 20.0 * (k / 2) as f64];
        sheet.polyline(&[[x, y], [x + 28.0, y]], &style);
        sheet.text([x + 36.0, y + 4.5], Anchor::Start, &state.name, "");
    }
    sheet.heading("Largest growth rate of a mode");
    sheet.finish("Largest growth rate over the friction coefficient in each state")
}

/// Friction value and largest growth rate, by friction.
fn largest_growth(results: &Results) -> Vec<[f64; 2]> {
    let largest = |modes: &[ModeData]| modes.iter().map(ModeData::growth_rate).reduce(f64::max);
    let mut points: Vec<[f64; 2]> =
        results.asked().filter_map(|value| Some([value.friction, largest(&value.modes)?])).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// For each sliding pair its pressure in all states.
fn maps(states: &[StateResults]) -> Vec<String> {
    let first = &states[0].results;
    let sliding = (0..first.about.pairs.len()).filter(|&pair| first.about.pairs[pair].sliding);
    let fields: Vec<(&str, &Results, &[f64])> = states
        .iter()
        .filter_map(|state| Some((state.name.as_str(), &state.results, &middle(&state.results)?.pressure[..])))
        .collect();
    sliding.filter_map(|pair| pressure_map::side_by_side(&first.about.pairs[pair].name, pair, &fields)).collect()
}
