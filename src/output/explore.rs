//! A study of many parameters: points and modes as CSV, answers as JSON and as text.

use std::path::Path;

use serde::Serialize;

use super::explore_tables::{write_boundary, write_gradients, write_hopf, write_modes, write_points};
use super::folder::Folder;
use super::results_folder::RESULTS;
use super::text::{aligned, files, or_dash, plural};
use crate::Result;
use crate::explore::{
    Answers, Bar, Bin, Estimate, Indices, Influence, Instability, Outcome, Parameter, PointModel, PointResult, Study,
    Tornado,
};
use crate::results::exploration_file::{self, ShapesOf};
use crate::results::{Exploration, FieldShare};

/// Name of the page in the folder of a study.
pub const PAGE: &str = "explore.html";
/// Name of the model file of the worst point.
pub const WORST: &str = "worst.toml";
/// Bars of the squeal probability have so many signs at 100 %.
const BAR: f64 = 40.0;

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
        text += &self.boundary();
        text += &fields(self.fields);
        text += &section("largest growth rate, 1/s", &self.growth_rates());
        text += &section(&format!("instabilities, by {what}"), &instabilities(&answers.instabilities));
        text += &section(&format!("{what} of squeal over frequency"), &bins(&answers.bins));
        let indices = answers.indices.as_deref().map_or_else(String::new, indices);
        text += &section("Sobol indices of the largest growth rate, with intervals of 95 %", &indices);
        text += &section("largest growth rate, one parameter at a time", &tornado(answers.tornado.as_deref()));
        let gradients: String = answers.gradients.iter().map(influences).chain(self.missing_derivatives()).collect();
        text +=
            &section("first-order changes of the growth rate, 1/s, by left vectors at the nominal point", &gradients);
        text += &self.worst();
        let failures: String = self.failures.iter().map(|f| format!("point {}: {}\n", f.point, f.reason)).collect();
        text + &section("points that have failed", &failures) + &self.files()
    }

    fn head(&self) -> String {
        let Answers { n_points, n_failed, n_doubtful, .. } = *self.answers;
        let n = self.parameters.len();
        let [from, to] = self.band_hz;
        let failed = if n_failed > 0 { format!(", {n_failed} failed") } else { String::new() };
        let doubtful = if n_doubtful > 0 {
            format!("{n_doubtful} links of modes to the nominal point are doubtful (modes.csv)\n")
        } else {
            String::new()
        };
        format!(
            "{}: modes of {from}-{to} Hz at {n_points} point{} of {n} parameter{}{failed}\n{doubtful}",
            self.title,
            plural(n_points),
            plural(n)
        )
    }

    /// What a design has found that adds points, and which of its points the probabilities are of.
    fn boundary(&self) -> String {
        let Some(n_start) = self.n_start else { return String::new() };
        let what = if self.answers.is_sample { "probabilities" } else { "fractions" };
        let start = format!("{what} are of the first {n_start} points, with which the design starts\n");
        let n_hopf = self.answers.hopf.points.len();
        if n_hopf > 0 {
            return start + &format!("{n_hopf} Hopf point{} between points of the grid (hopf.csv)\n", plural(n_hopf));
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

/// A heading with what stands below it; nothing where that is empty.
fn section(heading: &str, body: &str) -> String {
    if body.is_empty() { String::new() } else { format!("\n{heading}\n{body}") }
}

fn percent(own: crate::explore::Probability) -> String {
    let [value, low, high] = [own.value, own.low, own.high].map(|p| 100.0 * p);
    format!("{value:.1} % (95 %: {low:.1} to {high:.1}), {} of {} points", own.n_true, own.n_points)
}

fn instabilities(all: &[Instability]) -> String {
    let row = |own: &Instability| {
        let [low, high] = own.frequency_range_hz;
        let p = own.probability;
        format!(
            "{}\t{}\t{:.1}\t{:.1}\t{:.1}\t{low:.1}\t{high:.1}\t{:+.2}\t{}",
            or_dash(own.nominal, |number| number.to_string()),
            or_dash(own.nominal_frequency_hz, |f| format!("{f:.1}")),
            100.0 * p.value,
            100.0 * p.low,
            100.0 * p.high,
            own.largest_growth_rate_per_s,
            own.worst
        )
    };
    let heading = "mode at the\t\t\t95 %\t95 %\tfrequency where unstable\t\tlargest\tat\n\
                   nominal point\tHz\t%\tfrom\tto\tfrom\tto\tgrowth, 1/s\tpoint";
    let better = |own: &Instability| {
        let Estimate { value, low, high } = own.by_derivatives?;
        let [value, low, high] = [value, low, high].map(|p| 100.0 * p);
        let number = own.nominal?;
        Some(format!("mode {number} by points and derivatives: {value:.1} % (95 %: {low:.1} to {high:.1})\n"))
    };
    let better: String = all.iter().filter_map(better).collect();
    if all.is_empty() { String::new() } else { aligned(heading, all.iter().map(row)) + &better }
}

/// A line for each random field.
fn fields(all: &[FieldShare]) -> String {
    let line = |own: &FieldShare| {
        let FieldShare { name, n_points, n_modes, share } = own;
        let (modes, share) = (plural(*n_modes), 100.0 * share);
        format!(
            "field {name:?}: {n_modes} mode{modes} with {share:.1} % of the variance over {n_points} contact points\n"
        )
    };
    all.iter().map(line).collect()
}

/// Bins up to the last one with squeal.
fn bins(all: &[Bin]) -> String {
    let n = all.iter().rposition(|bin| bin.probability.n_true > 0).map_or(0, |last| last + 1);
    let row = |bin: &Bin| {
        let p = bin.probability;
        let bar = "#".repeat((BAR * p.value).round() as usize);
        format!("{:.0}-{:.0} Hz\t{:.1} %\t{bar}", bin.from_hz, bin.to_hz, 100.0 * p.value)
    };
    if n == 0 { String::new() } else { aligned("frequency\t", all[..n].iter().map(row)) }
}

fn indices(all: &[Indices]) -> String {
    let three = |own: &Estimate| format!("{:.3}\t{:.3}\t{:.3}", own.value, own.low, own.high);
    let row = |own: &Indices| format!("{}\t{}\t{}", own.parameter, three(&own.first_order), three(&own.total));
    aligned("parameter\tfirst\tfrom\tto\ttotal\tfrom\tto", all.iter().map(row))
}

fn tornado(bars: Option<&[Bar]>) -> String {
    let row = |bar: &Bar| {
        let Bar { parameter, lowest_at, lowest, highest_at, highest } = bar;
        format!("{parameter}\t{lowest:.2}\t{lowest_at:.4e}\t{highest:.2}\t{highest_at:.4e}")
    };
    bars.filter(|bars| !bars.is_empty())
        .map_or_else(String::new, |bars| aligned("parameter\tsmallest\tat\tlargest\tat", bars.iter().map(row)))
}

/// The tornado of a mode.
fn influences(own: &Tornado) -> String {
    let share = own.linear_share.map_or_else(String::new, |share| {
        format!("; to first order {:.0} % of its variance over the points", 100.0 * share.max(0.0))
    });
    let head = format!("mode {}: {:.1} Hz, {:+.2} 1/s{share}\n", own.nominal, own.frequency_hz, own.growth_rate_per_s);
    let row = |bar: &Influence| {
        format!(
            "{}\t{:+.2}\t{:+.2}\t{:.4e}\t{:.4e}",
            bar.parameter, bar.growth_rate_change_per_s, bar.frequency_change_hz, bar.from, bar.to
        )
    };
    head + &aligned("parameter\tgrowth, 1/s\tfrequency, Hz\tfrom\tto", own.bars.iter().map(row))
}
