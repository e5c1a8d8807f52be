//! A study of many parameters: points and modes as CSV, answers as JSON and as text.

use std::path::Path;

use serde::Serialize;

use super::explore_sections::{
    bins, fields, hopf_points_not_found, indices, influences, instabilities, links, percent, section, tornado,
    with_failed,
};
use super::explore_tables::{write_boundary, write_gradients, write_hopf, write_modes, write_points};
use super::folder::Folder;
use super::results_folder::RESULTS;
use super::text::{aligned, files, plural};
use crate::Result;
use crate::explore::{Answers, Outcome, Parameter, PointModel, PointResult, Study};
use crate::results::exploration_file::{self, ShapesOf};
use crate::results::{Exploration, FieldShare};

/// Name of the page in the folder of a study.
pub const PAGE: &str = "explore.html";
/// Name of the model file of the worst point.
pub const WORST: &str = "worst.toml";

/// The answers of a study, as one JSON document.
#[derive(Debug, Serialize)]
pub struct Document<'a> {
    title: &'a str,
    model: String,
    band_hz: [f64; 2],
    criterion: String,
    parameters: Vec<ParameterDocument<'a>>,
    #[serde(flatten)]
    answers: &'a Answers,
    worst_point: Option<PointDocument<'a>>,
    failures: Vec<FailureDocument<'a>>,
    fields: &'a [FieldShare],
    /// Files of the tables that the worst point's model file names.
    #[serde(skip)]
    tables: Vec<&'static str>,
    folder: String,
    /// How many modes are linked with doubt.
    #[serde(skip)]
    links: String,
    /// Points that a design starts with before it adds others.
    #[serde(skip)]
    n_start: Option<usize>,
}

#[derive(Debug, Serialize)]
struct ParameterDocument<'a> {
    name: &'a str,
    keys: Vec<&'a str>,
    factor: bool,
    nominal: f64,
}

/// The point with the largest growth rate, and the command that analyses it alone.
#[derive(Debug, Serialize)]
struct PointDocument<'a> {
    point: usize,
    values: &'a [f64],
    frequency_hz: f64,
    growth_rate_per_s: f64,
    command: String,
}

#[derive(Debug, Serialize)]
struct FailureDocument<'a> {
    point: usize,
    reason: &'a str,
}

impl<'a> Document<'a> {
    /// The document of a study whose results are in a folder.
    ///
    /// # Panics
    /// Where the answers are of other points.
    pub fn new(study: &'a Study, found: &'a Exploration, folder: &Path) -> Document<'a> {
        let Exploration { about, points, answers, .. } = found;
        let parameter = |(own, nominal): (&'a Parameter, &f64)| ParameterDocument {
            name: &own.name,
            keys: own.keys.iter().map(|key| key.text()).collect(),
            factor: own.is_factor,
            nominal: *nominal,
        };
        let worst = answers.worst.and_then(|point| {
            let mode = points[point].critical()?;
            let command = command(study, found, &points[point].values, folder);
            let (frequency_hz, growth_rate_per_s) = (mode.frequency(), mode.growth_rate());
            Some(PointDocument { point, values: &points[point].values, frequency_hz, growth_rate_per_s, command })
        });
        let failure = |(point, found): (usize, &'a PointResult)| match &found.outcome {
            Outcome::Failed(reason) => Some(FailureDocument { point, reason }),
            Outcome::Modes(_) => None,
        };
        Document {
            title: &about.title,
            model: study.model.display().to_string(),
            band_hz: about.band,
            criterion: about.criterion.to_string(),
            parameters: study.parameters.iter().zip(&points[0].values).map(parameter).collect(),
            answers,
            worst_point: worst,
            failures: points.iter().enumerate().filter_map(failure).collect(),
            fields: &found.fields,
            tables: found.worst.as_ref().map_or_else(Vec::new, PointModel::files),
            folder: folder.display().to_string(),
            links: links(&points[1..]),
            n_start: study.design.n_start(),
        }
    }

    /// Comment above the model file of the worst point.
    pub fn worst_head(&self) -> String {
        let Some(worst) = &self.worst_point else { return String::new() };
        let values = self.parameters.iter().zip(worst.values).map(|(own, value)| format!("# {} = {value}\n", own.name));
        format!(
            "# Point {} of the study {:?}: {:+.1} 1/s at {:.1} Hz.\n{}",
            worst.point,
            self.title,
            worst.growth_rate_per_s,
            worst.frequency_hz,
            values.collect::<String>()
        )
    }

    /// The answers for people.
    pub fn text(&self) -> String {
        let answers = self.answers;
        let what = if answers.is_sample { "probability" } else { "fraction of the points" };
        let mut text = self.head() + &format!("unstable ({}): {what} {}\n", self.criterion, percent(answers.unstable));
        text += &with_failed(answers.with_failed);
        text += &self.boundary();
        text += &fields(self.fields);
        text += &section("largest growth rate, 1/s", &self.growth_rates());
        text += &section(&format!("instabilities, by {what}"), &instabilities(&answers.instabilities));
        text += &section(&format!("{what} of squeal over frequency"), &bins(&answers.bins));
        let indices = answers.indices.as_deref().map_or_else(String::new, indices);
        let n_base = format!("Sobol indices of the largest growth rate, of {} base points", answers.n_base_points);
        text += &section(&format!("{n_base} with modes at all points, with intervals of 95 %"), &indices);
        text += &section("largest growth rate, one parameter at a time", &tornado(answers.tornado.as_deref()));
        let gradients: String = answers.gradients.iter().map(influences).chain(self.missing_derivatives()).collect();
        text += &section(
            "first-order changes from quantile 5 % to 95 % of a parameter, by derivatives at the nominal point",
            &gradients,
        );
        text += &self.worst();
        let failures: String = self.failures.iter().map(|f| format!("point {}: {}\n", f.point, f.reason)).collect();
        text + &section("points that have failed", &failures) + &self.files()
    }

    fn head(&self) -> String {
        let Answers { n_points, n_failed, .. } = *self.answers;
        let n = self.parameters.len();
        let [from, to] = self.band_hz;
        let failed = if n_failed > 0 { format!(", {n_failed} failed") } else { String::new() };
        format!(
            "{}: modes of {from}-{to} Hz at {n_points} point{} of {n} parameter{}{failed}\n{}",
            self.title,
            plural(n_points),
            plural(n),
            self.links
        )
    }

    /// What a design has found that adds points, and which of its points the probabilities are of.
    fn boundary(&self) -> String {
        let Some(n_start) = self.n_start else { return String::new() };
        let what = if self.answers.is_sample { "probabilities" } else { "fractions" };
        let start = format!("{what} are of the first {n_start} points, with which the design starts\n");
        let (n_hopf, n_not_found) = (self.answers.hopf.points.len(), self.answers.hopf.n_not_found);
        if n_hopf + n_not_found > 0 {
            let found = format!("{n_hopf} Hopf point{} between points of the grid (hopf.csv)\n", plural(n_hopf));
            return start + &found + &hopf_points_not_found(n_not_found);
        }
        let n = self.answers.boundary.len();
        let pairs = self.answers.boundary.first().map_or_else(String::new, |widest| {
            let (s, distance) = (plural(n), widest.distance);
            format!(
                "boundary between stable and unstable: {n} pair{s} of neighbours, the widest {distance:.2e} apart \
                (boundary.csv)\n"
            )
        });
        start + &pairs
    }

    fn missing_derivatives(&self) -> impl Iterator<Item = String> {
        let missing = self.answers.missing_derivatives.iter();
        missing.map(|own| format!("no derivative by {}: {}\n", own.parameter, own.reason))
    }

    fn growth_rates(&self) -> String {
        let of = &self.answers.growth_rate;
        let heads: String = of.iter().map(|own| format!("\t{:.0} %", 100.0 * own.fraction)).collect();
        let row: String = of.iter().map(|own| format!("\t{:.2}", own.growth_rate_per_s)).collect();
        if of.is_empty() { String::new() } else { aligned(&format!("quantile{heads}"), [format!("value{row}")]) }
    }

    fn worst(&self) -> String {
        let Some(worst) = &self.worst_point else { return String::new() };
        let rows = self.parameters.iter().zip(worst.values);
        let rows = rows.map(|(own, value)| format!("{}\t{value:.6e}\t{:.6e}", own.name, own.nominal));
        format!(
            "\nworst point: {}, {:+.2} 1/s at {:.1} Hz\n{}analyse it by: {}\n",
            worst.point,
            worst.growth_rate_per_s,
            worst.frequency_hz,
            aligned("parameter\tvalue\tnominal", rows),
            worst.command
        )
    }

    fn files(&self) -> String {
        let mut list = vec![
            (PAGE, "the page to look at"),
            ("points.csv", "parameters, and the largest growth rate at each point"),
            ("modes.csv", "modes at each point, with those of the nominal point that they are"),
            ("gradients.csv", "derivatives of the nominal modes by each parameter"),
            ("results.h5", "all of this and mode shapes, for programs"),
            ("summary.json", "the answers, for programs"),
            ("summary.txt", "this text"),
        ];
        if !self.answers.boundary.is_empty() {
            list.push(("boundary.csv", "points between stable and unstable neighbours"));
        }
        if !self.answers.hopf.points.is_empty() {
            list.push(("hopf.csv", "where modes turn unstable between points of the grid"));
        }
        if self.worst_point.as_ref().is_some_and(|worst| worst.command.contains(WORST)) {
            list.push((WORST, "the model file of the worst point"));
        }
        list.extend(self.tables.iter().map(|file| (*file, "the random field of its contact points")));
        files(&self.folder, &list)
    }
}

/// What analyses a point alone.
fn command(study: &Study, found: &Exploration, values: &[f64], folder: &Path) -> String {
    if found.worst.is_some() {
        let contacts = found.contacts.map_or_else(String::new, |n| format!(" --contacts {n}"));
        return format!("squeal stability {}{contacts}", folder.join(WORST).display());
    }
    let option = |(own, value): (&Parameter, &f64)| {
        let key = own.shared_key().unwrap_or_default().replace('_', "-");
        format!(" --{key} {value}")
    };
    let options: String = study.parameters.iter().zip(values).map(option).collect();
    format!("squeal stability {}{options}", study.model.display())
}

/// Writes tables, answers and summary. Not collective.
///
/// # Errors
/// The system's, with the file's path.
pub fn write(
    folder: &Folder,
    study: &Study,
    document: &Document,
    found: &Exploration,
    shapes_of: ShapesOf,
) -> Result<()> {
    let points = &found.points;
    exploration_file::write(&folder.draft().join(RESULTS), study, found, shapes_of)?;
    let names: Vec<&str> = document.parameters.iter().map(|own| own.name).collect();
    folder.write("points.csv", |out| write_points(out, &names, points))?;
    folder.write("modes.csv", |out| write_modes(out, points))?;
    folder.write("gradients.csv", |out| write_gradients(out, &study.parameters, &found.gradients, points))?;
    if !found.answers.boundary.is_empty() {
        folder.write("boundary.csv", |out| write_boundary(out, &names, &found.answers.boundary))?;
    }
    if !found.answers.hopf.points.is_empty() {
        folder.write("hopf.csv", |out| write_hopf(out, &names, &found.answers.hopf.points))?;
    }
    folder.write("summary.json", |out| out.write_all(super::json::text(document).as_bytes()))?;
    folder.write("summary.txt", |out| out.write_all(document.text().as_bytes()))
}
