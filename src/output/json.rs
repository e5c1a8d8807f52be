//! Results as one JSON document: the columns of the tables are its keys.

use serde::Serialize;

use super::columns::{ContactRow, HopfRow, ModeRow, PointRow, SourceRow};
use super::sweep_text;
use crate::results::{About, ModeData, Part, Results, Status, Value};
use crate::tracking::Branch;

/// What was analysed, each friction value with its contact pairs and modes, branches and Hopf points where modes were
/// followed, the verdict, warnings, and the folder of the results.
#[derive(Serialize)]
pub struct ResultsDocument<'a> {
    about: AboutDocument<'a>,
    frictions: Vec<ValueDocument<'a>>,
    branches: Option<Vec<BranchDocument>>,
    hopf: Option<Vec<HopfRow>>,
    verdict: Option<VerdictDocument>,
    warnings: &'a [String],
    failure: Option<&'a str>,
    costs: &'a str,
    folder: &'a str,
}

/// The status, its first reason, and both as the summary has them.
#[derive(Serialize)]
struct VerdictDocument {
    status: Status,
    reason: String,
    text: String,
}

#[derive(Serialize)]
struct AboutDocument<'a> {
    title: &'a str,
    program: &'a str,
    libraries: &'a str,
    command: &'a str,
    model: &'a str,
    model_sha256: &'a str,
    mesh: &'a str,
    mesh_sha256: &'a str,
    nodes: usize,
    elements: usize,
    equations: usize,
    ranks: usize,
    band_hz: [f64; 2],
    frictions: &'a [f64],
    parts: Vec<PartDocument<'a>>,
}

#[derive(Serialize)]
struct PartDocument<'a> {
    part: &'a str,
    material: &'a str,
    mass_kg: f64,
}

#[derive(Serialize)]
struct ValueDocument<'a> {
    friction: f64,
    asked: bool,
    seconds: f64,
    newton_steps: usize,
    contact: Vec<ContactRow<'a>>,
    count: Option<CountDocument>,
    modes: Option<Vec<ModeDocument<'a>>>,
}

#[derive(Serialize)]
struct CountDocument {
    below_hz: f64,
    expected: usize,
    found: usize,
}

#[derive(Serialize)]
struct ModeDocument<'a> {
    #[serde(flatten)]
    row: ModeRow,
    explained: Vec<SourceRow<'a>>,
}

#[derive(Serialize)]
struct BranchDocument {
    branch: usize,
    points: Vec<PointRow>,
}

impl<'a> ResultsDocument<'a> {
    /// The document of results in a folder.
    pub fn new(results: &'a Results, folder: &'a str) -> ResultsDocument<'a> {
        let diagram = results.diagram.as_ref();
        ResultsDocument {
            about: AboutDocument::new(&results.about),
            frictions: results.values.iter().map(|value| ValueDocument::new(value, &results.about)).collect(),
            branches: diagram.map(|diagram| (1..).zip(&diagram.branches).map(BranchDocument::new).collect()),
            hopf: diagram.map(|diagram| diagram.hopf.iter().map(HopfRow::new).collect()),
            verdict: (results.about.band[1] > 0.0).then(|| VerdictDocument::new(results)),
            warnings: &results.about.warnings,
            failure: results.failure.as_ref().map(|failure| failure.reason.as_str()),
            costs: &results.costs,
            folder,
        }
    }
}

impl VerdictDocument {
    fn new(results: &Results) -> VerdictDocument {
        let verdict = results.verdict();
        let text = sweep_text::verdict(results).trim_end().to_owned();
        VerdictDocument { status: verdict.status, reason: verdict.reason(), text }
    }
}

impl<'a> AboutDocument<'a> {
    fn new(about: &'a About) -> AboutDocument<'a> {
        let part = |part: &'a Part| PartDocument { part: &part.name, material: &part.material, mass_kg: part.mass };
        AboutDocument {
            title: &about.title,
            program: &about.program,
            libraries: &about.libraries,
            command: &about.command,
            model: &about.model,
            model_sha256: &about.model_digest,
            mesh: &about.mesh,
            mesh_sha256: &about.mesh_digest,
            nodes: about.n_nodes,
            elements: about.n_elements,
            equations: about.n_equations,
            ranks: about.n_ranks,
            band_hz: about.band,
            frictions: &about.frictions,
            parts: about.parts.iter().map(part).collect(),
        }
    }
}

impl<'a> ValueDocument<'a> {
    fn new(value: &'a Value, about: &'a About) -> ValueDocument<'a> {
        let mode = |(number, data): (usize, &'a ModeData)| ModeDocument {
            row: ModeRow::of(number, data),
            explained: data.sources.iter().map(SourceRow::new).collect(),
        };
        let pairs = about.pairs.iter().zip(&value.pairs);
        ValueDocument {
            friction: value.friction,
            asked: value.asked,
            seconds: value.seconds,
            newton_steps: value.steps.iter().map(|step| step.iterations.len().saturating_sub(1)).sum(),
            contact: pairs.map(|(pair, forces)| ContactRow::new(&pair.name, forces)).collect(),
            count: value.count.map(|c| CountDocument { below_hz: c.below, expected: c.expected, found: c.found }),
            modes: value.count.map(|_| (1..).zip(&value.modes).map(mode).collect()),
        }
    }
}

impl BranchDocument {
    fn new((branch, data): (usize, &Branch)) -> BranchDocument {
        BranchDocument { branch, points: data.points.iter().map(PointRow::new).collect() }
    }
}

/// Matrices written by `squeal export`.
#[derive(Serialize)]
pub struct ExportDocument {
    /// Where they are.
    pub folder: String,
    /// Friction of the equilibrium; none of a free part.
    pub friction: Option<f64>,
    /// Rows of the matrices.
    pub equations: usize,
}

/// What `squeal report` wrote.
#[derive(Serialize)]
pub struct Reported {
    /// The report's first sentence.
    pub headline: String,
    /// The files that a person opens.
    pub files: Vec<String>,
}

/// A warning.
#[derive(Serialize)]
pub struct Warned<'a> {
    /// The message.
    pub warning: &'a str,
}

/// An error.
#[derive(Serialize)]
pub struct Failed {
    /// The message.
    pub error: String,
    /// The program's exit code.
    pub exit_code: i32,
}

/// A document as one line, without its end. What is not finite is `null`.
///
/// # Panics
/// Where a document cannot be JSON: a map whose keys are no texts.
pub fn line(document: &impl Serialize) -> String {
    serde_json::to_string(document).expect("keys are texts")
}

/// A document as indented lines.
///
/// # Panics
/// Where a document cannot be JSON: a map whose keys are no texts.
pub fn text(document: &impl Serialize) -> String {
    serde_json::to_string_pretty(document).expect("keys are texts") + "\n"
}

#[cfg(test)]
mod tests {
    use serde_json::Value as Json;

    use super::*;
    use crate::output::external::{ExternalDocument, ExternalModeRow, ExternalValueDocument};
    use crate::output::free_modes::FreeModesDocument;
    use crate::output::model_summary;
    use crate::results::testing;

    /// Writes the keys of an object and of what is in it, a line each; of a list those of its first item.
    fn list(keys: &mut String, prefix: &str, value: &Json) {
        match value {
            Json::Object(object) => object.iter().for_each(|(key, value)| {
                *keys += &format!("{prefix}{key}\n");
                list(keys, &format!("{prefix}  "), value);
            }),
            Json::Array(items) => items.iter().take(1).for_each(|item| list(keys, prefix, item)),
            _ => {}
        }
    }

    #[test]
    fn documents_have_the_keys_that_programs_rely_on() {
        let mut results = testing::results();
        results.values.swap(0, 5);
        let modes = vec![ExternalModeRow { largest_node: Some(7), largest_dof: Some(2), ..Default::default() }];
        let values = vec![ExternalValueDocument { parameter: 0.0, condition: 1.0, confirmed: true, modes }];
        let text = String::new();
        let documents = [
            ("stability", serde_json::to_value(ResultsDocument::new(&results, "run"))),
            ("check", serde_json::to_value(model_summary::tests::summary())),
            ("modes", serde_json::to_value(ExternalDocument { equations: 3, band_hz: [0.0, 9.0], values })),
            (
                "modes --part",
                serde_json::to_value(FreeModesDocument {
                    part: text.clone(),
                    rigid_motions: 6,
                    frequencies_hz: vec![],
                }),
            ),
            ("export", serde_json::to_value(ExportDocument { folder: text.clone(), friction: None, equations: 3 })),
            ("report", serde_json::to_value(Reported { headline: text.clone(), files: vec![] })),
            ("error", serde_json::to_value(Failed { error: text, exit_code: 2 })),
        ];
        let mut keys = String::new();
        for (command, document) in documents {
            keys += &format!("{command}:\n");
            list(&mut keys, "  ", &document.unwrap());
        }
        assert_eq!(keys, include_str!("json_keys.txt"));
    }
}
