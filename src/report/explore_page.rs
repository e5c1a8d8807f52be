//! The page of a study of many parameters: probabilities, what they depend on, and all points.

use super::explore_data::{Data, MAX_MODES, is_shortened, reason};
use super::explore_plots as plots;
use super::frame::{frame, shape_figure};
use crate::explore::{Estimate, Instability, PointResult, Study, shaped_modes};
use crate::output::text::plural;
use crate::results::Exploration;
use crate::{Error, Result};
use maud::{Markup, PreEscaped, html};

/// Names are declared before they are used.
const SCRIPT: [&str; 5] = [
    include_str!("assets/numbers.js"),
    include_str!("assets/base.js"),
    include_str!("assets/viewer.js"),
    include_str!("assets/shape.js"),
    include_str!("assets/explore.js"),
];

/// Tornados on the page.
const MAX_TORNADOS: usize = 8;

/// The page; it is one file and loads nothing.
///
/// # Errors
/// Where the data cannot be written as JSON.
pub fn page(study: &Study, found: &Exploration) -> Result<String> {
    let json = serde_json::to_string(&Data::new(study, found));
    let json = json.map_err(Error::library("the data of the study cannot be written as JSON"))?;
    let script = format!("(() => {{\n\"use strict\";\n{}}})();\n", SCRIPT.join("\n"));
    let [from, to] = found.about.band;
    let title = &found.about.title;
    let n = study.parameters.len();
    let body = html! {
        header.top {
            h1 { (title) }
            p {
                "Complex modes " (from) "\u{2013}" (to) " Hz at " (found.answers.n_points) " points of " (n) " parameter"
                (plural(n)) ": " (study.design.name()) ". A mode is unstable with a " (found.about.criterion.to_string()) "."
            }
        }
        main {
            (answer(study, found))
            (influences(found))
            (points_section(study, found))
            (failures(study, &found.points))
        }
        footer { p { "Written by " (found.about.program) ". This page is one file and needs no network." } }
        div #tip role="tooltip" hidden {}
        // Inside a script element a `<` could begin its end.
        script #data type="application/json" { (PreEscaped(json.replace('<', "\\u003c"))) }
        script { (PreEscaped(&script)) }
    };
    Ok(frame(&format!("{title}: squeal explore"), Some(&script), &body))
}

fn figure(svg: String) -> Markup {
    html! { figure.card.plot { (PreEscaped(svg)) } }
}

fn answer(study: &Study, found: &Exploration) -> Markup {
    let answers = &found.answers;
    let style = if answers.unstable.n_true > 0 { "unstable" } else { "quiet" };
    html! {
        section aria-label="Answer" {
            p.verdict.(style) { (headline(found)) }
            (cautions(study, found))
            div.charts {
                (figure(plots::frequencies(&answers.bins, answers.is_sample)))
                (figure(plots::distributions(study, found)))
            }
        }
        section aria-label="Instabilities" {
            h2 { "Instabilities" }
            @if answers.instabilities.is_empty() { p { "None." } } @else { (instabilities(found)) }
        }
    }
}

fn headline(found: &Exploration) -> String {
    let answers = &found.answers;
    let p = answers.unstable;
    if p.n_points == 0 {
        return "Unknown: no point that counts has a solution".to_owned();
    }
    if !answers.is_sample {
        return format!("Unstable at {} of {} points", p.n_true, p.n_points);
    }
    let [value, low, high] = [p.value, p.low, p.high].map(|p| 100.0 * p);
    format!("Squeals with a probability of {value:.1}\u{a0}% (95\u{a0}% confidence: {low:.1} to {high:.1}\u{a0}%)")
}

fn cautions(study: &Study, found: &Exploration) -> Markup {
    let answers = &found.answers;
    let n_failed = answers.n_failed;
    html! {
        @if !answers.is_sample {
            p.hint { "The points of this design represent no distribution: their fractions are no probabilities." }
        }
        @if let Some(n_start) = study.design.n_start() {
            p.hint {
                @if answers.is_sample { "Probabilities" } @else { "Fractions" }
                " are of the first " (n_start) " points, with which the design starts."
                @if !answers.hopf.points.is_empty() {
                    " The others close in on the " (answers.hopf.points.len()) " Hopf points between them (hopf.csv)."
                }
                @if answers.hopf.n_not_found > 0 {
                    " On " (answers.hopf.n_not_found) " edge" (plural(answers.hopf.n_not_found)) " of the grid a mode "
                    "turns unstable, but its Hopf point is not found: a solution there failed, or has no mode near the "
                    "frequency. Give more levels."
                }
                @if let Some(widest) = answers.boundary.first() {
                    " Most of the others lie near the boundary, of which " (answers.boundary.len())
                    " pairs of neighbours are known, at most " (format!("{:.1e}", widest.distance)) " apart."
                }
            }
        }
        @if n_failed + answers.n_doubtful > 0 {
            ul.cautions {
                @if n_failed > 0 { li { (n_failed) " point" (plural(n_failed)) " failed, see below." } }
                @if let Some([low, high]) = answers.with_failed.map(|limits| limits.map(|p| 100.0 * p)) {
                    li {
                        "Failed points are left out: with them it is " (format!("{low:.1} to {high:.1}"))
                        " % (none or all of them unstable)."
                    }
                }
                @if answers.n_doubtful > 0 {
                    li { "Links of " (answers.n_doubtful) " modes to the nominal point are doubtful; a ? marks them." }
                }
            }
        }
    }
}

fn instabilities(found: &Exploration) -> Markup {
    let what = if found.answers.is_sample { "probability, %" } else { "points, %" };
    let has_better = found.answers.instabilities.iter().any(|own| own.by_derivatives.is_some());
    html! {
        div.over {
            table {
                thead {
                    tr {
                        th { "mode" } th { "nominal, Hz" } th { "nominal growth, 1/s" } th { (what) } th { "95 %" }
                        @if has_better { th { "with derivatives, %" } th { "95 %" } }
                        th { "unstable at, Hz" } th { "largest growth, 1/s" } th { "at point" } th { "doubtful links" }
                    }
                }
                tbody { @for own in &found.answers.instabilities { (instability(own, found, has_better)) } }
            }
        }
        p.hint { "Modes have the numbers of the nominal point. A dash: modes without a link to it." }
    }
}

fn instability(own: &Instability, found: &Exploration, has_better: bool) -> Markup {
    let dash = || "\u{2013}".to_owned();
    let p = own.probability;
    let range = |own: Estimate| format!("{:.1}\u{2013}{:.1}", 100.0 * own.low, 100.0 * own.high);
    let [from, to] = own.frequency_range_hz;
    let modes = found.points.iter().filter_map(PointResult::modes).flatten();
    let n_doubtful =
        modes.filter(|mode| mode.link.is_some_and(|link| link.doubtful && Some(link.nominal) == own.nominal));
    html! {
        tr {
            td { (own.nominal.map_or_else(dash, |n| n.to_string())) }
            td { (own.nominal_frequency_hz.map_or_else(dash, |f| format!("{f:.1}"))) }
            td { (own.nominal_growth_rate_per_s.map_or_else(dash, |a| format!("{a:+.2}"))) }
            td { (format!("{:.1}", 100.0 * p.value)) }
            td { (format!("{:.1}\u{2013}{:.1}", 100.0 * p.low, 100.0 * p.high)) }
            @if has_better {
                td { (own.by_derivatives.map_or_else(dash, |own| format!("{:.1}", 100.0 * own.value))) }
                td { (own.by_derivatives.map_or_else(dash, range)) }
            }
            td { (format!("{from:.1}\u{2013}{to:.1}")) }
            td { (format!("{:+.1}", own.largest_growth_rate_per_s)) }
            td { button type="button" data-point=(own.worst) { (own.worst) } }
            td { @match n_doubtful.count() { 0 => "0", n => { (n) " ?" } } }
        }
    }
}

fn influences(found: &Exploration) -> Markup {
    let answers = &found.answers;
    let shares = answers.gradients.iter().filter_map(|own| own.linear_share);
    let is_rough = shares.fold(1.0, f64::min) < 0.8;
    let n_figures = [answers.indices.is_some(), answers.tornado.is_some()].iter().filter(|is| **is).count();
    if n_figures + answers.gradients.len() + answers.missing_derivatives.len() == 0 {
        return html! {};
    }
    html! {
        section aria-label="Influence of the parameters" {
            h2 { "Influence of the parameters" }
            div.charts {
                @if let Some(all) = &answers.indices { (figure(plots::indices(all))) }
                @if let Some(bars) = &answers.tornado { (figure(plots::swings(bars))) }
                @for own in answers.gradients.iter().take(MAX_TORNADOS) { (figure(plots::tornado(own))) }
            }
            @if !answers.gradients.is_empty() {
                p.hint {
                    "Tornados are of first order: derivatives at the nominal point by left and right vectors, drawn over the range of each "
                    "parameter. They show the modes that are unstable at a point or that one parameter makes unstable"
                    @if answers.gradients.len() > MAX_TORNADOS { ", the first " (MAX_TORNADOS) " of " (answers.gradients.len()) } "."
                }
            }
            @for own in &answers.missing_derivatives { p.hint { "No derivative by " (own.parameter) ": " (own.reason) } }
            @if is_rough { (agreement(found)) }
        }
    }
}

/// What part of the variance over the points the derivatives explain.
fn agreement(found: &Exploration) -> Markup {
    let share = |own: &crate::explore::Tornado| {
        own.linear_share.map(|share| format!("mode {}: {:.0} %", own.nominal, 100.0 * share.max(0.0)))
    };
    let list: Vec<String> = found.answers.gradients.iter().filter_map(share).take(MAX_TORNADOS).collect();
    html! { p.hint { "Share of the variance of the growth rate over the points that they explain: " (list.join(", ")) "." } }
}

fn points_section(study: &Study, found: &Exploration) -> Markup {
    let select = |id: &str, chosen: usize, label: &str| {
        html! {
            label {
                (label) " "
                select id=(id) {
                    @for (i, own) in study.parameters.iter().enumerate() {
                        option value=(i) selected[i == chosen] { (own.name) }
                    }
                }
            }
        }
    };
    let first = most_influential(study, found);
    let second = if first == 0 { 1 } else { 0 };
    html! {
        section #points aria-label="Points" {
            h2 { "Points" }
            (points_hint(study, found))
            div.charts {
                figure.card.plot {
                    div.controls { (select("scatter-x", first, "Largest growth rate over")) }
                    div #scatter {}
                }
                @if study.parameters.len() > 1 {
                    figure.card.plot {
                        div.controls { (select("map-x", first, "Stability over")) (select("map-y", second, "and")) }
                        div #map {}
                    }
                }
            }
            (shapes_hint(!found.surface.nodes.is_empty(), found.shapes.len(), n_kept_shapes(&found.points)))
            div.split {
                div #point.card {}
                @if !found.shapes.is_empty() { (shape_figure()) }
            }
        }
    }
}

fn points_hint(study: &Study, found: &Exploration) -> Markup {
    let worst = found.answers.worst.and_then(|worst| found.points[worst].critical()).filter(|mode| mode.unstable);
    html! {
        p.hint {
            "Click a point to see its modes, and the shape of the one that grows fastest; the arrow keys choose the next one. Open circles are stable points, filled ones unstable"
            @if let Some(mode) = worst {
                ", the darker the faster they grow (up to " (format!("{:.1}", mode.growth_rate())) " 1/s)"
            }
            ". The cross is the nominal point."
            @if is_shortened(&found.points) {
                " There are more than " (MAX_MODES) " modes: only the unstable ones are listed here, and all of them in modes.csv."
            }
            @if !found.answers.hopf.points.is_empty() {
                " Squares are Hopf points, located by solutions; lines join those of one mode."
            } @else if study.plane().is_some() {
                " The line is where the largest growth rate is 0, between the points."
            }
        }
    }
}

/// Which shapes the page has, where it does not have all of those that are kept.
fn shapes_hint(has_surface: bool, n: usize, n_kept: usize) -> Markup {
    html! {
        @if !has_surface {
            p.hint {
                "There are no mode shapes: the super-element has no surface, or the shapes of so many points would take more than a quarter of a gigabyte."
            }
        } @else if n < n_kept {
            p.hint {
                "This page has the shapes of " (n) " of " (n_kept) " modes: of the nominal point, of the strongest mode of each instability, "
                "and of the points with the largest growth rates. All are in results.h5."
            }
        }
    }
}

/// Modes whose shapes are kept.
fn n_kept_shapes(points: &[PointResult]) -> usize {
    points.iter().filter_map(PointResult::modes).map(|modes| shaped_modes(modes).len()).sum()
}

/// The parameter with the largest influence that is known.
fn most_influential(study: &Study, found: &Exploration) -> usize {
    let answers = &found.answers;
    let by_index =
        answers.indices.as_ref().and_then(|all| all.iter().max_by(|a, b| a.total.value.total_cmp(&b.total.value)));
    let by_gradient = answers.gradients.first().and_then(|own| own.bars.first()).map(|bar| bar.parameter.as_str());
    let name = by_index.map(|own| own.parameter.as_str()).or(by_gradient);
    name.and_then(|name| study.parameters.iter().position(|own| own.name == name)).unwrap_or(0)
}

fn failures(study: &Study, points: &[PointResult]) -> Markup {
    let failed: Vec<(usize, &PointResult, &str)> =
        points.iter().enumerate().filter_map(|(i, point)| Some((i, point, reason(point)?))).collect();
    html! {
        @if !failed.is_empty() {
            section aria-label="Failed points" {
                h2 { "Failed points" }
                div.over {
                    table {
                        thead {
                            tr { th { "point" } @for own in &study.parameters { th { (own.name) } } th.left { "reason" } }
                        }
                        tbody {
                            @for (i, point, reason) in &failed {
                                tr {
                                    td { (i) }
                                    @for value in &point.values { td { (shown(*value)) } }
                                    td.left { (reason) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Some digits of a number of any size.
fn shown(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) { format!("{value:.4}") } else { format!("{value:.4e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_says_which_shapes_it_does_not_have() {
        let hint = |has_surface, n, n_kept| shapes_hint(has_surface, n, n_kept).into_string();
        assert_eq!(hint(true, 7, 7), "");
        assert!(hint(true, 7, 90).contains("the shapes of 7 of 90 modes"));
        assert!(hint(false, 0, 90).contains("no mode shapes"));
    }

    #[test]
    fn numbers_of_any_size_have_their_digits() {
        assert_eq!([0.0, 0.4, -1.0, 2e13, 1e-7].map(shown), ["0.0000", "0.4000", "-1.0000", "2.0000e13", "1.0000e-7"]);
    }
}
