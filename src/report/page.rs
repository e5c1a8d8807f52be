//! The report as one HTML page: words, figures, and the data as JSON for the scripts of `assets/`. It loads nothing
//! from the network, and the browser enforces that: a content security policy admits this page's own style and script,
//! by their digests, and nothing else.

use maud::{Markup, PreEscaped, html};

use super::certificate;
use super::data::Data;
use super::findings::{Findings, Instability};
use super::frame::{frame, shape_figure};
use super::model_section;
use super::plots::{self, Figure};
use super::svg::PALETTE;
use super::words::{self, Answer, unbroken};
use crate::output::overwrite::{FileKind, head_contains};
use crate::results::{Results, Status, Value};
use crate::{Error, Result};

/// Names are declared before they are used.
const SCRIPT: [&str; 11] = [
    include_str!("assets/numbers.js"),
    include_str!("assets/base.js"),
    include_str!("assets/charts.js"),
    include_str!("assets/table.js"),
    include_str!("assets/explain.js"),
    include_str!("assets/pressure.js"),
    include_str!("assets/checks.js"),
    include_str!("assets/viewer.js"),
    include_str!("assets/shape.js"),
    include_str!("assets/shapes.js"),
    include_str!("assets/main.js"),
];

/// A page that [`page`] has written.
pub const KIND: FileKind = FileKind {
    name: "a report of squeal",
    is_one: |path| head_contains(path, "<meta name=\"generator\" content=\"squeal\">"),
};

/// The page. The figures are those of [`plots::figures`].
///
/// ```
/// let html = squeal::report::page::page(&squeal::Results::default())?;
/// assert!(html.starts_with("<!DOCTYPE html>"));
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// Where the data cannot be written as JSON.
pub fn page(results: &Results) -> Result<String> {
    let findings = Findings::new(results);
    let figures = plots::figures(&findings);
    let json = serde_json::to_string(&Data::new(&findings));
    let json = json.map_err(Error::library("the report's data cannot be written as JSON"))?;
    let script = format!("(() => {{\n\"use strict\";\n{}}})();\n", SCRIPT.join("\n"));
    let about = &results.about;
    let title = if about.title.is_empty() { &about.model } else { &about.title };
    let body = html! {
        (top(title, &findings))
        main {
            (answer_section(&findings))
            (charts_section(&figures))
            (instabilities_section(&findings, &figures))
            (pressure_section())
            (modes_section())
            (checks_section(&findings, &figures))
            (model_section::section(results))
        }
        footer { p { "Written by " (about.program) ". This page is one file and needs no network." } }
        div #tip role="tooltip" hidden {}
        // Inside a script element a `<` could begin its end.
        script #data type="application/json" { (PreEscaped(json.replace('<', "\\u003c"))) }
        script { (PreEscaped(&script)) }
    };
    Ok(frame(&format!("{title}: squeal report"), Some(&script), &body))
}

fn top(title: &str, findings: &Findings) -> Markup {
    const SECTIONS: [(&str, &str); 7] = [
        ("#answer", "Answer"),
        ("#charts", "Stability chart"),
        ("#instabilities", "Instabilities"),
        ("#pressure", "Contact pressure"),
        ("#modes", "Modes"),
        ("#checks", "Checks"),
        ("#model", "Model"),
    ];
    html! {
        header.top {
            h1 { (title) }
            p { (subtitle(findings)) }
            nav aria-label="Sections" { @for (target, name) in SECTIONS { a href=(target) { (name) } " " } }
        }
    }
}

fn subtitle(findings: &Findings) -> String {
    let about = &findings.results.about;
    let [from, to] = about.band;
    let values: Vec<f64> = findings.asked.iter().map(|&v| findings.results.values[v].friction).collect();
    let values = match values[..] {
        [] => "no friction value".into(),
        [one] => format!("\u{3bc} = {one}"),
        [first, .., last] => format!("{} friction values, \u{3bc} = {first} to {last}", values.len()),
    };
    unbroken(&format!("Complex modes {from}\u{2013}{to} Hz at {values}; {} dofs", about.n_dofs))
}

fn answer_section(findings: &Findings) -> Markup {
    let style = match findings.results.verdict().status {
        Status::Unstable => "unstable",
        Status::Stable => "quiet",
        Status::Unknown => "unknown",
    };
    html! {
        section #answer aria-label="Answer" {
            p.verdict.(style) { (unbroken(&words::headline(findings))) }
            (list("cautions", &words::cautions(findings)))
            p.hint { "A mode is unstable here with a " (findings.results.about.criterion.to_string()) "." }
            div.split {
                div.answers {
                    @for (i, one) in findings.instabilities.iter().enumerate() { (answer(findings, i, one)) }
                }
                (shape_figure())
            }
        }
    }
}

fn answer(findings: &Findings, i: usize, one: &Instability) -> Markup {
    let Answer { range, moves, mechanism, input, dissipation, remedies } = words::answer(findings, one);
    let rows = [
        ("Squeals", range),
        ("Mechanism", mechanism),
        ("Kinetic energy in", moves),
        ("Energy input by", input),
        ("Dissipation by", dissipation),
    ];
    html! {
        article.(format!("card answer own{}", i % PALETTE.len())) {
            h2 { (words::frequency(findings.mode(one.worst).frequency())) }
            dl {
                @for (name, text) in rows.iter().filter(|(_, text)| !text.is_empty()) {
                    dt { (name) }
                    dd { (unbroken(text)) }
                }
                @if !remedies.is_empty() {
                    dt { "Largest reductions of the growth rate (first-order sensitivities)" }
                    dd { (list("", &remedies)) }
                }
            }
        }
    }
}

fn list(class: &str, items: &[String]) -> Markup {
    html! { @if !items.is_empty() { ul class=(class) { @for item in items { li { (unbroken(item)) } } } } }
}

fn plot(figures: &[Figure], name: &str) -> Markup {
    let own = figures.iter().find(|figure| figure.name == name);
    html! { @if let Some(figure) = own { figure.card.plot { (PreEscaped(&figure.svg)) } } }
}

fn charts_section(figures: &[Figure]) -> Markup {
    html! {
        section #charts aria-label="Stability chart" {
            h2 { "Stability chart" }
            p.hint {
                "Point at a circle to see its values. Click to choose a mode: it is marked in all figures and tables. In a chart the arrow \
                 keys choose the next unstable mode."
            }
            p #chosen.chosen role="status" {}
            div.charts { (plot(figures, "stability-chart")) (plot(figures, "growth-rates")) }
        }
    }
}

fn instabilities_section(findings: &Findings, figures: &[Figure]) -> Markup {
    let svg = |i: usize| figures.iter().find(|figure| figure.name == format!("instability-{}", i + 1));
    html! {
        section #instabilities aria-label="Instabilities" {
            h2 { "Instabilities" }
            @if findings.instabilities.is_empty() { p { "None." } }
            @for (i, one) in findings.instabilities.iter().enumerate() {
                article.(format!("card instability own{}", i % PALETTE.len())) {
                    header {
                        h3 { (words::frequency(findings.mode(one.worst).frequency())) }
                        div.controls {
                            label { "Friction coefficient " select {} }
                            button type="button" { "Show its shape" }
                        }
                    }
                    div {
                        @if let Some(figure) = svg(i) { div.plot { (PreEscaped(&figure.svg)) } }
                        img hidden alt="";
                    }
                    div.explained {}
                }
            }
        }
    }
}

fn pressure_section() -> Markup {
    html! {
        section #pressure aria-label="Contact pressure" hidden {
            h2 { "Contact pressure" }
            div.controls {
                label { "Friction coefficient " select #pressure-friction {} }
                label {
                    "Show "
                    select #pressure-field {
                        option value="pressure" { "pressure" }
                        option value="status" { "status" }
                    }
                }
                label { input #pressure-all type="checkbox"; " all contact pairs" }
            }
            div #maps {}
        }
    }
}

fn modes_section() -> Markup {
    html! {
        section #modes aria-label="Modes" {
            h2 { "Modes" }
            div.controls {
                label { "Friction coefficient " select #mode-friction {} }
                label { input #mode-unstable type="checkbox"; " unstable only" }
                button #mode-clear type="button" { "Clear filters" }
                span #mode-count role="status" {}
            }
            p.hint.screen {
                "Click a heading to sort. A filter is a number, " code { "> 0" } ", " code { "< 1e-10" } " or "
                code { "1000 - 2000" } "."
            }
            div.scroll tabindex="0" role="region" aria-label="Table of modes" {
                table #mode-table { thead {} tbody {} }
            }
        }
    }
}

fn checks_section(findings: &Findings, figures: &[Figure]) -> Markup {
    html! {
        section #checks aria-label="Checks" {
            h2 { "Checks" }
            div.controls { label { "Friction coefficient " select #check-friction {} } }
            div #check-body {}
            (plot(figures, "convergence"))
            h3 { "Modes: their number and accuracy" }
            (counts(findings))
            (certificate::section(findings))
        }
    }
}

/// For each friction value: the number of modes, its check by the Sturm count, the largest backward error, seconds.
fn counts(findings: &Findings) -> Markup {
    html! {
        div.over {
            table {
                thead {
                    tr {
                        @for name in ["\u{3bc}", "modes", "unstable", "Sturm count", "largest backward error", "time, s"] {
                            th { (name) }
                        }
                    }
                }
                tbody { @for &v in &findings.asked { (count_row(&findings.results.values[v])) } }
            }
        }
        p.hint {
            "The Sturm count is the number of modes of the undamped, symmetric problem below a frequency, by Sylvester's law of inertia. \
             Where as many complex modes are found, none is missing. Where damping makes eigenvalues real, the count says nothing, and \
             another search has to find as many."
        }
    }
}

fn count_row(value: &Value) -> Markup {
    let error = value.modes.iter().map(|mode| mode.backward_error).fold(0.0, f64::max);
    let n_unstable = value.modes.iter().filter(|mode| mode.unstable).count();
    let agrees = value.count.is_none_or(|count| count.agrees());
    let check = match value.count {
        Some(count) if agrees => format!("{} below {:.0} Hz", count.expected, count.below),
        Some(count) => format!("{} found, {} expected", count.found, count.expected),
        None => "\u{2013}".into(),
    };
    html! {
        tr class=[(!agrees).then_some("unstable")] {
            td { (value.friction) }
            td { (value.modes.len()) }
            td { (n_unstable) }
            td { (check) }
            td { (format!("{error:.1e}")) }
            td { (format!("{:.1}", value.seconds)) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::testing;

    #[test]
    fn a_title_that_means_mischief_stays_text() {
        let html = page(&testing::results()).unwrap();
        assert!(!html.contains("<script>alert"), "a script got in");
        assert_eq!(html.matches("</script>").count(), 2);
        assert!(html.contains("disc &amp; pad &lt;/script&gt;"));
        assert!(html.contains("piston / \\u003cpad>"));
        assert!(!html.contains("{{"));
    }

    #[test]
    fn the_page_names_nothing_outside_itself() {
        let html = page(&testing::results()).unwrap();
        let own = html.replace("http://www.w3.org/2000/svg", "");
        for scheme in ["http:", "https:", "src=\"", "@import", "url("] {
            assert!(!own.contains(scheme), "{scheme}");
        }
    }

    #[test]
    fn a_study_without_surface_modes_or_values_has_a_page() {
        let mut results = testing::results();
        results.surface = Default::default();
        results.contact.triangles.clear();
        results.contact.pair.clear();
        assert!(page(&results).unwrap().contains("\"surface\":null"));
        results.values.retain(|value| value.friction == 0.0);
        results.diagram = None;
        results.about.friction_values = vec![0.0];
        assert!(page(&results).unwrap().contains("Quiet: all 8 modes"));
        assert!(page(&Results::default()).unwrap().contains("No friction value has been analysed yet."));
    }
}
