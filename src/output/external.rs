//! Modes of external matrices as text and tables; real eigenvalues are shown as what they are.

use std::io;

use serde::Serialize;

use crate::Result;
use crate::results::{ExternalMode, ExternalResults, ExternalValue};
use crate::stability::{Count, CountedBy, Evidence};

use super::branches;
use super::columns::{self, AtFriction, ModeRow};
use super::folder::Folder;
use super::results_folder::write_branches;
use super::text::{self, aligned, cost};

/// From this condition number on a warning is given: of sixteen digits four are left.
const ILL_CONDITIONED: f64 = 1e12;

/// The results in words, with the files of their folder.
pub fn summary(results: &ExternalResults, place: &str) -> String {
    let [from, to] = results.band;
    let mut text = format!("{}: modes {from}-{to} Hz, {} dofs\n\n", results.title, results.n_dofs);
    text += &matrices_text(results);
    let worst = results.values.iter().map(|value| value.condition).fold(0.0, f64::max);
    text += &format!("condition number of the factorised matrix, scaled: {worst:.1e}\n");
    if worst >= ILL_CONDITIONED {
        text += &format!("warning: it is above {ILL_CONDITIONED:.0e}: few digits of the modes can be trusted\n");
    }
    if let Some(value) = results.values.iter().find(|value| value.shift != 0.0) {
        text += &format!("K is singular or nearly so: P(shift) was factorised instead, shift {:.1} 1/s\n", value.shift);
    }
    results.notes.iter().for_each(|note| text += &format!("{note}\n"));
    text.push('\n');
    match &results.values[..] {
        [value] => text += &value_text(results, value),
        values => {
            let heading = format!("{}\tmodes\tunstable: frequency (growth rate)", results.parameter);
            text += &aligned(&heading, values.iter().map(line));
        }
    }
    text += &format!("criterion of instability: {}\n", results.criterion);
    if let Some(diagram) = &results.diagram {
        text += &branches::summary(diagram, &results.parameter);
    }
    text + &cost(results.seconds, results.n_ranks) + &files_text(results, place)
}

/// What the matrices are like.
fn matrices_text(results: &ExternalResults) -> String {
    let of = |is_symmetric: bool| if is_symmetric { "symmetric" } else { "unsymmetric" };
    let symmetry = results.symmetry;
    let damping = if results.is_damped { format!("C {}", of(symmetry.damping)) } else { "no C".into() };
    let structural = match results.has_structural_damping {
        true => format!(", structural damping G {}", of(symmetry.structural)),
        false => String::new(),
    };
    let constrained = match results.n_constrained {
        0 => String::new(),
        n => format!("; {n} constrained dofs (1e36 on the diagonal of K) are left out"),
    };
    format!("M {}, {damping}, K {}{structural}{constrained}\n", of(symmetry.mass), of(symmetry.stiffness))
}

/// How many modes, and which of them grow.
fn line(value: &ExternalValue) -> String {
    let unstable = value.modes.iter().filter(|mode| mode.is_unstable);
    let named = unstable.map(|mode| format!("{:.4} Hz ({:+.4} /s)", mode.frequency(), mode.lambda.re));
    let list = named.collect::<Vec<_>>().join(", ");
    let doubt = if value.count.agrees() { "" } else { "  (number of modes not confirmed)" };
    let list = if list.is_empty() { "none" } else { &list };
    format!("{}\t{}\t{list}{doubt}", value.value, value.modes.len())
}

/// The modes at one value, and what is known of their number.
fn value_text(results: &ExternalResults, value: &ExternalValue) -> String {
    modes_text(&value.modes) + &count_text(&value.count, results)
}

/// Modes in lines.
fn modes_text(modes: &[ExternalMode]) -> String {
    let row = |mode: &ExternalMode| {
        let place = match mode.largest_dof {
            Some((node, dof)) => format!("node {node}, dof {dof}"),
            None => format!("row {}", mode.largest_row),
        };
        let mark = match (mode.is_unstable, mode.lambda.im == 0.0) {
            (true, true) => "unstable: real eigenvalue, divergence",
            (true, false) => "unstable",
            (false, true) => "real eigenvalue",
            (false, false) => "",
        };
        let (number, hertz, growth) = (mode.number, mode.frequency(), mode.lambda.re);
        let (damping, error) = (100.0 * mode.damping_ratio(), mode.backward_error);
        format!("  {number}\t{hertz:.6}\t{growth:+.5}\t{damping:.4}\t{error:.1e}\t{place}\t{mark}")
    };
    let heading = "  mode\tfrequency Hz\tgrowth 1/s\tdamping %\tbackward error\tlargest in\t";
    aligned(heading, modes.iter().map(row))
}

/// What is known of the number of modes.
fn count_text(count: &Count, results: &ExternalResults) -> String {
    let Count { below, expected, found, by } = *count;
    let how = match (results.evidence, count.agrees()) {
        (Evidence::SturmCount, true) if by == CountedBy::AnotherSearch => {
            "as many as another search found; damping has made eigenvalues real, so that a Sturm count says nothing"
                .into()
        }
        (Evidence::SturmCount, true) if !results.is_damped && !results.has_structural_damping => {
            "as many as K - omega^2 M has negative eigenvalues by Sylvester's law of inertia: none is missing".into()
        }
        (Evidence::SturmCount, true) => {
            "as many as the undamped problem has by Sylvester's law of inertia, which damping may \
             shift across the end"
                .into()
        }
        (Evidence::SturmCount, false) => format!(
            "but {expected} negative eigenvalues of K - omega^2 M: not confirmed (massless dofs, strong damping or an \
             indefinite M change the count)"
        ),
        (Evidence::Repetition { .. }, true) if results.n_dofs <= Evidence::ALL_UP_TO => {
            "and all eigenvalues were found: none is missing".into()
        }
        (Evidence::Repetition { .. }, true) => {
            "as many as the Sturm count of the symmetric parts, or as another search \
             found; of matrices that are not symmetric neither is a proof"
                .into()
        }
        (Evidence::Repetition { .. }, false) => "not confirmed: two searches did not find the same number".into(),
    };
    format!("{found} modes with |lambda| below {below:.1} Hz, {how}\n")
}

fn files_text(results: &ExternalResults, place: &str) -> String {
    let mut files = vec![("summary.txt", "this text"), ("modes.csv", "all modes")];
    if results.values.len() > 1 {
        files.push(("details.txt", "the modes at each value in words"));
    }
    if results.diagram.is_some() {
        files.push(("branches.csv", "modes followed over the parameter"));
        files.push(("hopf.csv", "where they become unstable"));
    }
    if has_shapes(results) {
        files.push(("shapes*.csv", "shapes, a row for each dof"));
    }
    text::files(place, &files)
}

fn has_shapes(results: &ExternalResults) -> bool {
    results.values.iter().any(|value| !value.shapes.is_empty())
}

/// Writes the folder's files. Not collective.
///
/// # Errors
/// The system's, with the file's path.
pub fn write(results: &ExternalResults, folder: Folder, summary: &str) -> Result<()> {
    folder.write("summary.txt", |out| out.write_all(summary.as_bytes()))?;
    folder.write("modes.csv", |out| modes_table(out, results))?;
    if results.values.len() > 1 {
        let of = |value: &ExternalValue| {
            format!("{} = {}\n{}\n", results.parameter, value.value, value_text(results, value))
        };
        let text: String = results.values.iter().map(of).collect();
        folder.write("details.txt", |out| out.write_all(text.as_bytes()))?;
    }
    if let Some(diagram) = &results.diagram {
        write_branches(&folder, diagram, results.band, &results.parameter)?;
    }
    for value in results.values.iter().filter(|value| !value.shapes.is_empty()) {
        let name = if results.varies { format!("shapes_{}.csv", value.value) } else { "shapes.csv".into() };
        folder.write(&name, |out| shapes_table(out, results, value))?;
    }
    folder.finish()
}

/// A mode and where its vector is largest: the row, from 1, and its node and degree of freedom where rows have names.
#[derive(Default, Serialize)]
pub(super) struct ExternalModeRow {
    #[serde(flatten)]
    pub mode: ModeRow,
    pub largest_row: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_node: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_dof: Option<i32>,
}

impl From<&ExternalMode> for ExternalModeRow {
    fn from(mode: &ExternalMode) -> Self {
        ExternalModeRow {
            mode: ModeRow::new(mode.number, mode.lambda, mode.backward_error, mode.is_unstable),
            largest_row: mode.largest_row,
            largest_node: mode.largest_dof.map(|(node, _)| node),
            largest_dof: mode.largest_dof.map(|(_, dof)| dof),
        }
    }
}

/// Modes as CSV, with the parameter under its name where it varies.
fn modes_table(out: &mut dyn io::Write, results: &ExternalResults) -> io::Result<()> {
    let rows_of = |value: &ExternalValue| value.modes.iter().map(ExternalModeRow::from).collect::<Vec<_>>();
    if !results.varies {
        return columns::write_csv(out, results.values.iter().flat_map(rows_of));
    }
    let with_value = |value: &ExternalValue| {
        let friction = value.value;
        rows_of(value).into_iter().map(move |row| AtFriction { friction, row })
    };
    columns::write_csv_over(out, &results.parameter, results.values.iter().flat_map(with_value))
}

/// Shapes as CSV, a line for each dof: `row`, `node, dof` where rows have names, and `re_1, im_1, re_2, ...` of the
/// modes, the largest entry of each of modulus 1.
fn shapes_table(out: &mut dyn io::Write, results: &ExternalResults, value: &ExternalValue) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let names: &[&str] = if results.names.is_some() { &["node", "dof"] } else { &[] };
    let of_modes = (1..=value.shapes.len()).flat_map(|i| [format!("re_{i}"), format!("im_{i}")]);
    let header = std::iter::once("row").chain(names.iter().copied()).map(String::from);
    table.write_record(header.chain(of_modes))?;
    for (i, row) in results.rows.iter().enumerate() {
        let name = results.names.iter().flat_map(|names| [names[i].0.to_string(), names[i].1.to_string()]);
        let entries = value.shapes.iter().flat_map(|[re, im]| [format!("{:.9e}", re[i]), format!("{:.9e}", im[i])]);
        table.write_record(std::iter::once((row + 1).to_string()).chain(name).chain(entries))?;
    }
    table.flush()
}

/// The results as one JSON document.
#[derive(Serialize)]
pub struct ExternalDocument {
    pub(super) dofs: usize,
    pub(super) band_hz: [f64; 2],
    pub(super) values: Vec<ExternalValueDocument>,
}

#[derive(Serialize)]
pub(super) struct ExternalValueDocument {
    pub parameter: f64,
    pub condition: f64,
    pub confirmed: bool,
    pub modes: Vec<ExternalModeRow>,
}

impl From<&ExternalResults> for ExternalDocument {
    fn from(results: &ExternalResults) -> Self {
        let value = |value: &ExternalValue| ExternalValueDocument {
            parameter: value.value,
            condition: value.condition,
            confirmed: value.count.agrees(),
            modes: value.modes.iter().map(ExternalModeRow::from).collect(),
        };
        ExternalDocument {
            dofs: results.n_dofs,
            band_hz: results.band,
            values: results.values.iter().map(value).collect(),
        }
    }
}
