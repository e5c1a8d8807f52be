//! The report as one HTML page: templates of `assets/`, figures, words, and the data as JSON. It asks nothing of the network, and the browser
//! holds it to that: a content security policy admits this page's own style and program, by their digests, and nothing else.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use super::data::Data;
use super::findings::{Findings, Instability};
use super::plots::{self, Figure};
use super::svg::{PALETTE, escaped};
use super::words::{self, Answer};
use crate::output::overwrite::{FileKind, head_contains};
use crate::results::{About, Pair, Part, Results, Status};
use crate::{Error, Result};

const PAGE: &str = include_str!("assets/page.html");
const STYLE: &str = include_str!("assets/page.css");
/// Names are declared before they are used.
const SCRIPT: [&str; 9] = [
    include_str!("assets/base.js"),
    include_str!("assets/charts.js"),
    include_str!("assets/table.js"),
    include_str!("assets/explain.js"),
    include_str!("assets/pressure.js"),
    include_str!("assets/checks.js"),
    include_str!("assets/viewer.js"),
    include_str!("assets/shape.js"),
    include_str!("assets/main.js"),
];

/// A page that [`page`] has written.
pub const KIND: FileKind = FileKind {
    name: "a report of squeal",
    is_one: |path| head_contains(path, "<meta name=\"generator\" content=\"squeal\">"),
};

/// The page. The figures are those of [`plots::figures`].
///
/// # Errors
/// Where the data cannot be written as JSON.
pub fn page(results: &Results) -> Result<String> {
    let findings = Findings::new(results);
    let figures = plots::figures(&findings);
    let about = &results.about;
    let json = serde_json::to_string(&Data::new(&findings));
    let json = json.map_err(Error::library("the report's data cannot be written as JSON"))?;
    let script = format!("(() => {{\n\"use strict\";\n{}}})();\n", SCRIPT.join("\n"));
    let values = [
        ("style-hash", digest(STYLE)),
        ("script-hash", digest(&script)),
        ("style", STYLE.to_owned()),
        ("script", script),
        // Inside a script element a `<` could begin its end.
        ("data", json.replace('<', "\\u003c")),
        ("title", escaped(title(results))),
        ("subtitle", escaped(&subtitle(&findings))),
        ("headline", said(&words::headline(&findings))),
        ("verdict-class", verdict_class(results).into()),
        ("cautions", list("cautions", &words::cautions(&findings))),
        ("answers", answers(&findings)),
        ("charts", plot(&figures, "stability-chart") + &plot(&figures, "growth-rates")),
        ("instabilities", instabilities(&findings, &figures)),
        ("convergence", plot(&figures, "convergence")),
        ("counts", counts(&findings)),
        ("model", model(results)),
        ("model-text", escaped(&about.model_text)),
        ("costs", escaped(&results.costs)),
        ("program", escaped(&about.program)),
    ];
    Ok(filled(PAGE, &values))
}

/// The style of the first sentence.
fn verdict_class(results: &Results) -> &'static str {
    match results.verdict().status {
        Status::Unstable => "unstable",
        Status::Stable => "quiet",
        Status::Unknown => "unknown",
    }
}

/// A digest as a content security policy wants it.
fn digest(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

/// Words as HTML, which keeps a friction on one line.
fn said(text: &str) -> String {
    escaped(text).replace("\u{3bc} = ", "\u{3bc}\u{a0}=\u{a0}")
}

/// A template with its `{{names}}` replaced, once: what a value says is left alone.
fn filled(template: &str, values: &[(&str, String)]) -> String {
    let mut out = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").expect("a template closes its braces");
        let value = values.iter().find(|(known, _)| *known == name);
        out += before;
        out += &value.unwrap_or_else(|| panic!("the template names {name}")).1;
        rest = after;
    }
    out + rest
}

fn title(results: &Results) -> &str {
    if results.about.title.is_empty() { &results.about.model } else { &results.about.title }
}

fn subtitle(findings: &Findings) -> String {
    let about = &findings.results.about;
    let [from, to] = about.band;
    let frictions: Vec<f64> = findings.asked.iter().map(|&v| findings.results.values[v].friction).collect();
    let frictions = match frictions[..] {
        [] => "no friction".into(),
        [one] => format!("friction {one}"),
        [first, .., last] => format!("{} frictions from {first} to {last}", frictions.len()),
    };
    format!("Complex modes {from}\u{2013}{to} Hz at {frictions}; {} equations", about.n_equations)
}

fn answers(findings: &Findings) -> String {
    findings.instabilities.iter().enumerate().map(|(i, one)| answer(findings, i, one)).collect()
}

fn answer(findings: &Findings, i: usize, one: &Instability) -> String {
    let Answer { squeals, moves, couples, fed, held, helps } = words::answer(findings, one);
    let row = |name: &str, text: &str| match text {
        "" => String::new(),
        _ => format!("<dt>{name}</dt><dd>{}</dd>\n", said(text)),
    };
    let helps = match &helps[..] {
        [] => String::new(),
        _ => format!("<dt>Would help, to first order</dt><dd>{}</dd>\n", list("", &helps)),
    };
    format!(
        "<article class=\"card answer own{}\"><h2>{}</h2>\n<dl>\n{}{}{}{}{}{helps}</dl></article>\n",
        i % PALETTE.len(),
        escaped(&words::frequency(findings.mode(one.worst).frequency())),
        row("Squeals", &squeals),
        row("Moves", &moves),
        row("Why", &couples),
        row("Fed by", &fed),
        row("Held by damping", &held),
    )
}

fn list(class: &str, items: &[String]) -> String {
    if items.is_empty() {
        return String::new();
    }
    let items: String = items.iter().map(|item| format!("<li>{}</li>", escaped(item))).collect();
    format!("<ul class=\"{class}\">{items}</ul>")
}

fn plot(figures: &[Figure], name: &str) -> String {
    let own = figures.iter().find(|figure| figure.name == name);
    own.map_or_else(String::new, |figure| format!("<figure class=\"card plot\">{}</figure>\n", figure.svg))
}

fn instabilities(findings: &Findings, figures: &[Figure]) -> String {
    let card = |(i, one): (usize, &Instability)| {
        let figure = figures.iter().find(|figure| figure.name == format!("instability-{}", i + 1));
        let plot = figure.map_or_else(String::new, |figure| format!("<div class=\"plot\">{}</div>", figure.svg));
        format!(
            "<article class=\"card instability own{}\"><header><h3>{}</h3>\n<div class=\"controls\"><label>Friction <select></select></label>\
             <button type=\"button\">Show its shape</button></div></header>\n<div>{plot}<img hidden alt=\"\"></div>\n\
             <div class=\"explained\"></div></article>\n",
            i % PALETTE.len(),
            escaped(&words::frequency(findings.mode(one.worst).frequency())),
        )
    };
    match findings.instabilities.is_empty() {
        true => "<p>None.</p>".into(),
        false => findings.instabilities.iter().enumerate().map(card).collect(),
    }
}

/// For each friction asked for: how many modes, the check of their number, the largest backward error, seconds.
fn counts(findings: &Findings) -> String {
    let row = |&v: &usize| {
        let value = &findings.results.values[v];
        let error = value.modes.iter().map(|mode| mode.backward_error).fold(0.0, f64::max);
        let unstable = value.modes.iter().filter(|mode| mode.unstable).count();
        let (check, class) = match value.count {
            Some(count) if count.agrees() => (format!("{} below {:.0} Hz", count.expected, count.below), ""),
            Some(count) => (format!("{} found, {} expected", count.found, count.expected), "unstable"),
            None => ("\u{2013}".into(), ""),
        };
        format!(
            "<tr class=\"{class}\"><td>{}</td><td>{}</td><td>{unstable}</td><td>{check}</td><td>{error:.1e}</td><td>{:.1}</td></tr>\n",
            value.friction,
            value.modes.len(),
            value.seconds
        )
    };
    let rows: String = findings.asked.iter().map(row).collect();
    format!(
        "<div class=\"over\"><table><thead><tr><th>friction</th><th>modes</th><th>unstable</th><th>count by inertia</th>\
         <th>largest backward error</th><th>time, s</th></tr></thead><tbody>{rows}</tbody></table></div>"
    )
}

fn model(results: &Results) -> String {
    let about = &results.about;
    let part = |p: &Part| [p.name.clone(), p.material.clone(), format!("{:.3}", p.mass)];
    let parts = table(["part", "material", "mass, kg"], about.parts.iter().map(part));
    let pair = |p: &Pair| [p.name.clone(), kind(p).into(), p.n_points.to_string()];
    let pairs = table(["contact pair", "kind", "points"], about.pairs.iter().map(pair));
    format!("<dl>{}</dl>\n<div class=\"over\">{parts}{pairs}</div>", facts(about))
}

/// What was analysed, by what.
fn facts(about: &About) -> String {
    let row = |name: &str, text: String| format!("<dt>{name}</dt><dd>{text}</dd>\n");
    let file = |name: &str, digest: &str| {
        format!("{}<br><span class=\"digest\">SHA-256 {}</span>", escaped(name), escaped(digest))
    };
    let mut rows = row("Model", file(&about.model, &about.model_digest));
    if !about.mesh.is_empty() {
        rows += &row("Mesh", file(&about.mesh, &about.mesh_digest));
        rows += &row("Size", format!("{} nodes, {} tetrahedra", about.n_nodes, about.n_tets));
    }
    let plural = if about.n_ranks == 1 { "" } else { "s" };
    rows += &row("Solved", format!("{} equations on {} rank{plural}", about.n_equations, about.n_ranks));
    rows += &row("Command", format!("<code>squeal {}</code>", escaped(&about.command)));
    rows += &row("Program", escaped(&about.program));
    rows + &row("Libraries", escaped(&about.libraries))
}

fn kind(pair: &Pair) -> &'static str {
    match (pair.sliding, pair.swept) {
        (true, true) => "slides, friction swept",
        (true, false) => "slides",
        (false, true) => "sticks, friction swept",
        (false, false) => "sticks up to its friction",
    }
}

/// A table of two texts and a number a row; nothing without rows.
fn table([a, b, c]: [&str; 3], rows: impl Iterator<Item = [String; 3]>) -> String {
    let row = |[a, b, c]: [String; 3]| {
        format!("<tr><td class=\"left\">{}</td><td class=\"left\">{}</td><td>{c}</td></tr>", escaped(&a), escaped(&b))
    };
    let rows: String = rows.map(row).collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        "<table><thead><tr><th class=\"left\">{a}</th><th class=\"left\">{b}</th><th>{c}</th></tr></thead><tbody>{rows}</tbody></table>"
    )
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;

    #[test]
    fn a_template_is_filled_once() {
        let values = [("a", "{{b}}".to_owned()), ("b", "x".to_owned())];
        assert_eq!(filled("1 {{a}} 2 {{b}}", &values), "1 {{b}} 2 x");
    }

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
        results.about.frictions = vec![0.0];
        assert!(page(&results).unwrap().contains("Quiet: none of the 8 modes"));
        assert!(page(&Results::default()).unwrap().contains("No friction has been analysed yet."));
    }
}
