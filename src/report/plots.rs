//! The figures of a report: stability chart, growth rates, couplings, convergence.

use std::f64::consts::TAU;

use super::findings::{Findings, Instability, Place};
use super::svg::{Anchor, INK, PALE, Panel, Scale, Sheet, colour};
use super::words;
use crate::algebra::span;
use crate::output::overwrite::{FileKind, SIGNATURE, head_contains};
use crate::tracking::{Branch, Hopf};

/// A figure of ours in a file.
pub const KIND: FileKind = FileKind { name: "a figure of squeal", is_one: |path| head_contains(path, SIGNATURE) };

/// A figure.
pub struct Figure {
    /// Name of its file, without an extension.
    pub name: String,
    /// The SVG element.
    pub svg: String,
}

/// All figures of the results.
pub fn figures(findings: &Findings) -> Vec<Figure> {
    let mut all = Vec::new();
    if findings.results.values.iter().any(|value| !value.modes.is_empty()) {
        all.push(Figure { name: "stability-chart".into(), svg: stability_chart(findings) });
        all.push(Figure { name: "growth-rates".into(), svg: growth_rates(findings) });
    }
    for (i, instability) in findings.instabilities.iter().enumerate() {
        let svg = coupling(findings, i, instability);
        all.extend(svg.map(|svg| Figure { name: format!("instability-{}", i + 1), svg }));
    }
    all.extend(convergence(findings).map(|svg| Figure { name: "convergence".into(), svg }));
    all
}

const FRICTION: &str = "friction coefficient \u{3bc}";
const WIDTH: f64 = 720.0;
/// Largest circle.
const RADIUS: f64 = 15.0;

/// Frequency of all modes against friction, with circles whose area is the growth rate: figure 2a of the source.
fn stability_chart(findings: &Findings) -> String {
    let mut sheet = Sheet::new([WIDTH, 440.0]);
    let band = findings.results.about.band.map(|f| f / 1000.0);
    let panel = Panel { area: [70.0, 40.0, 560.0, 340.0], x: friction_scale(findings), y: Scale::linear(band) };
    panel.draw(&mut sheet, Some(FRICTION), "frequency, kHz");
    for branch in findings.branches() {
        curve(&mut sheet, &panel, branch, |lambda| lambda.im / TAU / 1000.0, &thin(PALE));
    }
    let largest = findings.instabilities.first().map_or(1.0, |one| one.growth_rate);
    let radius = |growth: f64| RADIUS * (growth / largest).max(0.0).sqrt();
    for place in asked_modes(findings).filter(|&place| !findings.mode(place).unstable) {
        mark(
            &mut sheet,
            panel.at(findings.friction(place), findings.mode(place).frequency() / 1000.0),
            place,
            2.0,
            PALE,
        );
    }
    for (i, instability) in findings.instabilities.iter().enumerate() {
        for place in asked(findings, instability) {
            let mode = findings.mode(place);
            let at = panel.at(findings.friction(place), mode.frequency() / 1000.0);
            let style =
                format!(r#"fill="{0}" fill-opacity="0.45" stroke="{0}" stroke-width="1.5" {1}"#, colour(i), tag(place));
            sheet.circle(at, radius(mode.growth_rate()).max(3.0), &style);
        }
    }
    sheet.heading("Stability chart: circles are unstable modes, their area is the growth rate");
    let legend = [1.0, 0.3, 0.1].map(|share| rounded(share * largest));
    for (k, &growth) in legend.iter().enumerate().filter(|_| !findings.instabilities.is_empty()) {
        let y = 70.0 + 38.0 * k as f64;
        sheet.circle(
            [658.0, y],
            radius(growth).min(RADIUS * 1.2),
            &format!(r#"class="ink" fill="none" stroke="{INK}""#),
        );
        sheet.text([680.0, y + 4.5], Anchor::Start, &format!("{growth} /s"), SMALL);
    }
    let below = if findings.instabilities.is_empty() { 70.0 } else { 190.0 };
    sheet.circle([658.0, below], 2.0, &format!(r#"fill="{PALE}""#));
    sheet.text([672.0, below + 4.5], Anchor::Start, "stable", SMALL);
    sheet.finish("Stability chart: frequency of all modes against friction; the area of a circle is its growth rate")
}

/// Growth rate of all modes against friction.
fn growth_rates(findings: &Findings) -> String {
    let mut sheet = Sheet::new([WIDTH, 360.0]);
    let in_band = findings.results.values.iter().flat_map(|value| &value.modes).map(|mode| mode.growth_rate());
    let y = Scale::with_margin(span(in_band.chain([0.0])), 0.04);
    let panel = Panel { area: [70.0, 40.0, 560.0, 260.0], x: friction_scale(findings), y };
    panel.draw(&mut sheet, Some(FRICTION), "growth rate, 1/s");
    zero_line(&mut sheet, &panel, findings);
    let unstable: Vec<Option<usize>> = findings.instabilities.iter().map(|one| one.branch).collect();
    for (b, branch) in findings.branches().iter().enumerate().filter(|(b, _)| !unstable.contains(&Some(*b))) {
        let style = format!(r#"{} data-branch="{b}""#, thin(PALE));
        curve(&mut sheet, &panel, branch, |lambda| lambda.re, &style);
    }
    for (i, instability) in findings.instabilities.iter().enumerate() {
        if let Some(b) = instability.branch {
            let style = format!(r#"stroke="{}" stroke-width="2" data-branch="{b}""#, colour(i));
            curve(&mut sheet, &panel, &findings.branches()[b], |lambda| lambda.re, &style);
        }
        for place in asked(findings, instability) {
            let at = panel.at(findings.friction(place), findings.mode(place).growth_rate());
            mark(&mut sheet, at, place, 3.5, colour(i));
        }
    }
    if findings.branches().is_empty() {
        for place in asked_modes(findings).filter(|&place| !findings.mode(place).unstable) {
            mark(&mut sheet, panel.at(findings.friction(place), findings.mode(place).growth_rate()), place, 2.0, PALE);
        }
    }
    hopf_marks(&mut sheet, &panel, findings, findings.hopf().iter(), |_| 0.0);
    end_labels(&mut sheet, &panel, findings);
    sheet.heading("Growth rates: modes above zero are unstable; diamonds are Hopf points");
    sheet.finish("Growth rate of all modes against friction")
}

/// The modes of an instability at the requested values.
fn asked<'f>(findings: &'f Findings, instability: &'f Instability) -> impl Iterator<Item = Place> + 'f {
    instability.modes.iter().copied().filter(|place| findings.results.values[place.value].asked)
}

/// Frequencies at the right end of unstable branches, pushed apart where they would overlap.
fn end_labels(sheet: &mut Sheet, panel: &Panel, findings: &Findings) {
    const APART: f64 = 15.0;
    let end = |one: &Instability| {
        let last = one.modes[one.modes.len() - 1];
        let lambda = one.branch.and_then(|b| findings.branches()[b].points.last()).map(|point| point.lambda.re);
        (lambda.unwrap_or(findings.mode(last).growth_rate()), words::frequency(findings.mode(last).frequency()))
    };
    let right = panel.area[0] + panel.area[2] + 8.0;
    let mut labels: Vec<(f64, String, usize)> = findings
        .instabilities
        .iter()
        .enumerate()
        .map(|(i, one)| {
            let (growth, text) = end(one);
            (panel.at(0.0, growth)[1], text, i)
        })
        .collect();
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut free = f64::NEG_INFINITY;
    for (y, text, i) in labels {
        let y = y.max(free);
        free = y + APART;
        sheet.text([right, y + 4.5], Anchor::Start, &text, &format!(r#"fill="{}" font-weight="bold""#, colour(i)));
    }
}

/// Frequency and growth rate of an unstable branch and its partner against friction, with Hopf points: figure 2b of the
/// source. None where modes were not followed over several friction values.
fn coupling(findings: &Findings, i: usize, instability: &Instability) -> Option<String> {
    let own = instability.branch?;
    let partner = findings.onset(instability).and_then(|hopf| hopf.partner).map(|partner| partner.branch);
    let branches: Vec<usize> = [Some(own), partner].into_iter().flatten().collect();
    let points = || branches.iter().flat_map(|&b| &findings.branches()[b].points);
    let hopf = || findings.hopf().iter().filter(|hopf| branches.contains(&hopf.branch));
    let mut sheet = Sheet::new([WIDTH, 420.0]);
    let y = Scale::with_margin(span(points().map(|point| point.lambda.im / TAU)), 0.1);
    let upper = Panel { area: [80.0, 40.0, 560.0, 160.0], x: friction_scale(findings), y };
    upper.draw(&mut sheet, None, "frequency, Hz");
    let y = Scale::with_margin(span(points().map(|point| point.lambda.re).chain([0.0])), 0.1);
    let lower = Panel { area: [80.0, 215.0, 560.0, 150.0], x: friction_scale(findings), y };
    lower.draw(&mut sheet, Some(FRICTION), "growth rate, 1/s");
    zero_line(&mut sheet, &lower, findings);
    for (k, &b) in branches.iter().enumerate().rev() {
        let dash = if k == 0 { "" } else { r#" stroke-dasharray="7 4""# };
        let style = format!(r#"stroke="{}" stroke-width="2.2"{dash} data-branch="{b}""#, colour(i + 3 * k));
        let branch = &findings.branches()[b];
        curve(&mut sheet, &upper, branch, |lambda| lambda.im / TAU, &style);
        curve(&mut sheet, &lower, branch, |lambda| lambda.re, &style);
        for place in places_on(findings, b) {
            let (mode, mu) = (findings.mode(place), findings.friction(place));
            mark(&mut sheet, upper.at(mu, mode.frequency()), place, 3.0, colour(i + 3 * k));
            mark(&mut sheet, lower.at(mu, mode.growth_rate()), place, 3.0, colour(i + 3 * k));
        }
    }
    for hopf in hopf() {
        let (x, bottom) = (upper.at(hopf.value, 0.0)[0], lower.area[1] + lower.area[3]);
        sheet.line([x, upper.area[1]], [x, bottom], &format!(r#"class="ink" stroke="{INK}" stroke-dasharray="2 3""#));
        sheet.text([x, upper.area[1] - 4.0], Anchor::Middle, &format!("\u{3bc} = {:.3}", hopf.value), SMALL);
    }
    hopf_marks(&mut sheet, &upper, findings, hopf(), |hopf| hopf.omega / TAU);
    hopf_marks(&mut sheet, &lower, findings, hopf(), |_| 0.0);
    let name = words::frequency(findings.mode(instability.worst).frequency());
    let mechanism = match partner {
        Some(_) => "two modes (solid and dashed) coalesce and one becomes unstable",
        None => "a mode loses stability without coalescence",
    };
    sheet.heading(&format!("{name}: {mechanism}"));
    Some(sheet.finish(&format!("Frequency and growth rate against friction of the instability at {name}")))
}

/// Residuals of all Newton solutions.
fn convergence(findings: &Findings) -> Option<String> {
    let steps = || findings.results.values.iter().flat_map(|value| &value.steps);
    let known = |residual: f64| residual > 0.0 && residual.is_finite();
    let residuals = steps().flat_map(|step| &step.iterations).map(|it| it.residual).filter(|&r| known(r));
    let [low, high] = span(residuals);
    let longest = steps().map(|step| step.iterations.len()).max().filter(|_| low <= high)?;
    let mut sheet = Sheet::new([WIDTH, 300.0]);
    let x = Scale::linear([0.0, (longest - 1) as f64]);
    let panel = Panel { area: [70.0, 40.0, 560.0, 200.0], x, y: Scale::logarithmic([low, high]) };
    panel.draw(&mut sheet, Some("Newton iteration"), "relative residual");
    for step in steps() {
        let iterations = step.iterations.iter().enumerate().filter(|(_, it)| known(it.residual));
        let points: Vec<[f64; 2]> = iterations.map(|(i, it)| panel.at(i as f64, it.residual)).collect();
        let of = if step.converged { colour(1) } else { colour(0) };
        sheet.polyline(&points, &format!(r#"stroke="{of}" stroke-opacity="0.5" stroke-width="1.3""#));
    }
    sheet.heading("Convergence of the equilibria: a line for each Newton solution");
    Some(sheet.finish("Relative residual of each Newton solution against its iterations"))
}

const SMALL: &str = r#"font-size="12""#;

fn thin(colour: &str) -> String {
    format!(r#"stroke="{colour}" stroke-opacity="0.6""#)
}

/// The attribute by which the page's program finds the mode of a mark.
fn tag(place: Place) -> String {
    format!(r#"data-mode="{}""#, place.name())
}

/// A disc that stands for a mode.
fn mark(sheet: &mut Sheet, at: [f64; 2], place: Place, radius: f64, fill: &str) {
    sheet.circle(at, radius, &format!(r#"fill="{fill}" {}"#, tag(place)));
}

fn friction_scale(findings: &Findings) -> Scale {
    let all = span(findings.results.values.iter().map(|value| value.friction));
    Scale::with_margin(all, 0.03)
}

fn asked_modes<'f>(findings: &'f Findings) -> impl Iterator<Item = Place> + 'f {
    let modes = |value: usize| (0..findings.results.values[value].modes.len()).map(move |mode| Place { value, mode });
    findings.asked.iter().flat_map(move |&value| modes(value))
}

fn places_on(findings: &Findings, branch: usize) -> Vec<Place> {
    asked_modes(findings).filter(|place| findings.branch_of[place.value][place.mode] == Some(branch)).collect()
}

/// A branch within the panel's ordinates.
fn curve(sheet: &mut Sheet, panel: &Panel, branch: &Branch, of: impl Fn(num_complex::Complex64) -> f64, style: &str) {
    let [_, top, _, height] = panel.area;
    let points = branch.points.iter().map(|point| panel.at(point.value, of(point.lambda)));
    let inside: Vec<[f64; 2]> = points.filter(|[_, y]| (top - 1.0..=top + height + 1.0).contains(y)).collect();
    sheet.polyline(&inside, style);
}

fn zero_line(sheet: &mut Sheet, panel: &Panel, findings: &Findings) {
    let [left, right] = [panel.area[0], panel.area[0] + panel.area[2]];
    let y = panel.at(findings.results.values[0].friction, 0.0)[1];
    sheet.line([left, y], [right, y], &format!(r#"class="ink" stroke="{INK}" stroke-width="1.2""#));
}

fn hopf_marks<'h>(
    sheet: &mut Sheet,
    panel: &Panel,
    findings: &Findings,
    marks: impl Iterator<Item = &'h Hopf>,
    of: impl Fn(&Hopf) -> f64,
) {
    for hopf in marks {
        let i = findings.instabilities.iter().position(|one| one.branch == Some(hopf.branch));
        let fill = i.map_or(PALE, colour);
        let style = format!(r##"class="hopf" fill="#ffffff" stroke="{fill}" stroke-width="2""##);
        sheet.diamond(panel.at(hopf.value, of(hopf)), 5.5, &style);
    }
}

/// A number of one digit that is not 0.
fn rounded(x: f64) -> f64 {
    let power = 10_f64.powf(x.log10().floor());
    (x / power).round() * power
}
