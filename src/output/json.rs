//! Results as one JSON document: the columns of the tables are its keys.

use serde::Serialize;

use super::columns::{ContactRow, HopfRow, ModeRow, PointRow, SourceRow};
use super::sweep_text;
use crate::equilibrium::Step;
use crate::results::{About, Certificate, ModeData, Results, Status, Value};
use crate::stability::Count;
use crate::tracking::Branch;

/// What was analysed, each friction value with its contact pairs and modes, branches and Hopf points where modes were
/// followed, the verdict, and the folder of the results.
#[derive(Serialize)]
pub struct ResultsDocument<'a> {
    about: &'a About,
    values: Vec<ValueDocument<'a>>,
    branches: Option<Vec<BranchDocument>>,
    hopf: Option<Vec<HopfRow>>,
    verdict: Option<VerdictDocument>,
    failure: Option<&'a str>,
    costs: &'a str,
    folder: &'a str,
}

/// The status, its reasons, what counts as unstable, and all as the summary has them.
#[derive(Serialize)]
struct VerdictDocument {
    status: Status,
    reason: String,
    criterion: String,
    text: String,
}

/// A friction value with its contact pairs, checks, Newton steps and modes.
#[derive(Serialize)]
pub struct ValueDocument<'a> {
    friction: f64,
    asked: bool,
    seconds: f64,
    contact: Vec<ContactRow<'a>>,
    checks: Vec<&'a str>,
    steps: &'a [Step],
    count: Option<Count>,
    /// Of a super-element that was compared with its full model.
    #[serde(skip_serializing_if = "Option::is_none")]
    certificate: Option<&'a Certificate>,
    modes: Vec<ModeDocument<'a>>,
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
            about: &results.about,
            values: results.values.iter().map(|value| ValueDocument::new(value, &results.about)).collect(),
            branches: diagram.map(|diagram| (1..).zip(&diagram.branches).map(BranchDocument::new).collect()),
            hopf: diagram.map(|diagram| diagram.hopf.iter().map(HopfRow::new).collect()),
            verdict: (results.about.band[1] > 0.0).then(|| VerdictDocument::new(results)),
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
        let criterion = results.about.criterion.to_string();
        VerdictDocument { status: verdict.status, reason: verdict.reason(), criterion, text }
    }
}

impl<'a> ValueDocument<'a> {
    /// The document of a value among results.
    pub fn new(value: &'a Value, about: &'a About) -> ValueDocument<'a> {
        let mode = |(number, data): (usize, &'a ModeData)| ModeDocument {
            row: ModeRow::of(number, data),
            explained: data.sources.iter().map(SourceRow::new).collect(),
        };
        let pairs = about.pairs.iter().zip(&value.pairs);
        ValueDocument {
            friction: value.friction,
            asked: value.asked,
            seconds: value.seconds,
            contact: pairs.map(|(pair, forces)| ContactRow::new(&pair.name, forces)).collect(),
            checks: value.checks.lines().collect(),
            steps: &value.steps,
            count: value.count,
            certificate: value.certificate.as_ref(),
            modes: (1..).zip(&value.modes).map(mode).collect(),
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
    pub dofs: usize,
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
            ("modes", serde_json::to_value(ExternalDocument { dofs: 3, band_hz: [0.0, 9.0], values })),
            (
                "modes --part",
                serde_json::to_value(FreeModesDocument {
                    part: text.clone(),
                    rigid_motions: 6,
                    frequencies_hz: vec![],
                }),
            ),
            ("export", serde_json::to_value(ExportDocument { folder: text.clone(), friction: None, dofs: 3 })),
            ("report", serde_json::to_value(Reported { headline: text.clone(), files: vec![] })),
            ("error", serde_json::to_value(Failed { error: text, exit_code: 2 })),
        ];
        let mut keys = String::new();
        for (command, document) in documents {
            keys += &format!("{command}:\n");
            list(&mut keys, "  ", &document.unwrap());
        }
        insta::assert_snapshot!(keys);
    }
}
