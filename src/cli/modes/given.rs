//! Modes of given matrices at the values of their parameter, followed from one to the next.

use std::f64::consts::TAU;
use std::time::Instant;

use num_complex::Complex64;
use serde_json::{Value as Json, json};

use crate::matrices::family::MatrixFamily;
use crate::matrices::{Dof, ExternalMatrices};
use crate::native::Vector;
use crate::output::branches;
use crate::output::eigenvalues::{self, Row};
use crate::output::folder::Folder;
use crate::output::overwrite::may_write_folder;
use crate::stability::{Count, Evidence, Mode};
use crate::sweep::{GivenModes, GivenSweep};
use crate::tracking::Diagram;
use crate::{Error, Result};

use super::super::Shell;
use super::super::progress::Progress;
use super::{Modes, folder};

/// From this condition number on a warning is given: of sixteen digits four are left.
const ILL_CONDITIONED: f64 = 1e12;

pub fn run(shell: &Shell, arguments: &Modes, family: &MatrixFamily) -> Result<()> {
    let comm = shell.comm;
    let start = Instant::now();
    let band = arguments.band.ok_or_else(|| Error::input("which band? Give --band FROM:TO in Hz"))?;
    let place = arguments.folder(&arguments.name());
    comm.agree(if comm.is_root() { may_write_folder(&place, arguments.force) } else { Ok(()) })?;
    let mut values = arguments.parameter.as_ref().map_or_else(|| vec![0.0], |values| values.0.clone());
    let progress = Progress::new(comm, values.len(), arguments.verbose);
    progress.say("reading");
    let given = ExternalMatrices::read(comm, &family.terms, TAU * band[1])?;
    let mut sweep = GivenSweep::new(&given, band);
    let mut found =
        Found { band, given: &given, shapes: arguments.shapes, notes: Vec::new(), values: Vec::new(), diagram: None };
    let mut follow = values.len() > 1 && !arguments.no_branches;
    if let Some(reason) = if follow { sweep.cannot_follow(values[0])? } else { None } {
        found.notes.push(format!("modes are not followed: {reason}"));
        follow = false;
    }
    let mut hear = |converged: usize, wanted: usize, solves: usize| {
        progress.say(format!("{converged} of {wanted} eigenvalues, {solves} solves"));
    };
    let asked = values.clone();
    let mut outcome = Ok(());
    if follow {
        values.sort_by(f64::total_cmp);
        let each = |value: f64, modes: &GivenModes| found.add(value, modes, asked.contains(&value));
        let (diagram, end) = sweep.follow(&values, each, &mut hear)?;
        (found.diagram, outcome) = (Some(diagram), end);
    } else {
        for &value in &values {
            let modes = sweep.modes(value, &mut hear)?;
            found.add(value, &modes, true)?;
            progress.advance(&format!("{} {value}: {} modes", family.parameter, modes.band.modes.len()));
        }
    }
    progress.finish();
    match outcome {
        Err(error @ Error::NotConverged(_)) => found.notes.push(format!("not converged: {error}")),
        Err(error) => return Err(error),
        Ok(()) => {}
    }
    let seconds = start.elapsed().as_secs_f64();
    let evidence = sweep.evidence();
    let summary = found.summary(family, evidence, &place.display().to_string(), seconds, comm.size());
    let written =
        folder(comm, &place, arguments.force)?.map_or(Ok(()), |folder| found.write(family, evidence, folder, &summary));
    comm.agree(written)?;
    shell.tell(&summary, || found.document())
}

/// The modes at one value.
struct Value {
    value: f64,
    rows: Vec<Row>,
    count: Count,
    condition: f64,
    shift: f64,
    /// Real and imaginary parts of all modes on all rows, on the root where they are asked for.
    shapes: Vec<[Vec<f64>; 2]>,
}

impl Value {
    /// A line: how many modes, which of them grow.
    fn line(&self, width: usize) -> String {
        let unstable = self.rows.iter().filter(|row| row.is_unstable);
        let named = unstable.map(|row| format!("{:.4} Hz ({:+.4} /s)", row.lambda.im / TAU, row.lambda.re));
        let list = named.collect::<Vec<_>>().join(", ");
        let doubt = if self.count.agrees() { "" } else { "  (number of modes not confirmed)" };
        let list = if list.is_empty() { "none" } else { &list };
        format!("{:>width$}  {:>5}  {list}{doubt}\n", self.value, self.rows.len())
    }
}

/// What was found so far.
struct Found<'a> {
    band: [f64; 2],
    given: &'a ExternalMatrices,
    shapes: bool,
    notes: Vec<String>,
    values: Vec<Value>,
    diagram: Option<Diagram>,
}

impl Found<'_> {
    /// Keeps the modes at a value that was asked for. Collective.
    fn add(&mut self, value: f64, modes: &GivenModes, asked: bool) -> Result<()> {
        if !asked {
            return Ok(());
        }
        let inside = |mode: &&Mode| {
            let frequency = if mode.lambda.im == 0.0 { mode.lambda.norm() / TAU } else { mode.frequency() };
            mode.frequency() >= self.band[0] && frequency <= self.band[1]
        };
        let (mut rows, mut shapes) = (Vec::new(), Vec::new());
        for mode in modes.band.modes.iter().filter(inside) {
            let shape = self.unscaled(mode)?;
            let (largest, at) = self.largest(&shape);
            rows.push(self.row(rows.len() + 1, mode, at));
            if self.shapes {
                shapes.push(shape.map(|part| self.given.comm().join(&part)).map(|part| divided(part, largest)));
            }
        }
        let GivenModes { band, condition, shift } = modes;
        self.values.push(Value { value, rows, count: band.count, condition: *condition, shift: *shift, shapes });
        Ok(())
    }

    /// `x = D y` on this rank's rows.
    fn unscaled(&self, mode: &Mode) -> Result<[Vec<f64>; 2]> {
        let times =
            |part: &Vector| part.local(|values| values.iter().zip(&self.given.scale).map(|(y, d)| y * d).collect());
        Ok([times(&mode.re)?, times(&mode.im)?])
    }

    /// The largest modulus of a shape and its row; of equal ones the first. Collective.
    fn largest(&self, [re, im]: &[Vec<f64>; 2]) -> (f64, usize) {
        let moduli: Vec<f64> = re.iter().zip(im).map(|(re, im)| re.hypot(*im)).collect();
        let own = moduli.iter().copied().fold(0.0, f64::max);
        let comm = self.given.comm();
        let largest = comm.max(own);
        let here = moduli.iter().position(|&modulus| modulus == largest).map(|at| self.given.owned.start + at);
        let row = -comm.max(here.map_or(f64::NEG_INFINITY, |row| -(row as f64)));
        (largest, row as usize)
    }

    fn row(&self, number: usize, mode: &Mode, at: usize) -> Row {
        let names = &self.given.names;
        Row {
            number,
            lambda: mode.lambda,
            backward_error: mode.backward_error,
            is_unstable: mode.lambda.re > growth_threshold(mode.lambda, self.band),
            largest_row: names.rows.get(at).map_or(0, |row| row + 1),
            largest_dof: names.dofs.as_ref().map(|dofs| (dofs[at].node, dofs[at].axis)),
        }
    }

    /// All modes as one document.
    fn document(&self) -> Json {
        let mode = |row: &Row| {
            json!({"frequency_hz": row.lambda.im / TAU, "growth_rate_per_s": row.lambda.re, "unstable": row.is_unstable,
                "backward_error": row.backward_error})
        };
        let value = |value: &Value| {
            let modes: Vec<Json> = value.rows.iter().map(mode).collect();
            json!({"parameter": value.value, "condition": value.condition, "confirmed": value.count.agrees(), "modes": modes})
        };
        json!({"equations": self.given.n, "band_hz": self.band, "values": self.values.iter().map(value).collect::<Vec<_>>()})
    }

    fn summary(&self, family: &MatrixFamily, evidence: Evidence, place: &str, seconds: f64, ranks: usize) -> String {
        let [from, to] = self.band;
        let mut text = format!("{}: modes {from}-{to} Hz of {} equations\n\n", family.title, self.given.n);
        text += &self.structure();
        let worst = self.values.iter().map(|value| value.condition).fold(0.0, f64::max);
        text += &format!("condition number of the factorised matrix, scaled: {worst:.1e}\n");
        if worst >= ILL_CONDITIONED {
            text += &format!("warning: it is above {ILL_CONDITIONED:.0e}: few digits of the modes can be trusted\n");
        }
        if let Some(value) = self.values.iter().find(|value| value.shift != 0.0) {
            text +=
                &format!("K is singular or nearly so: P(shift) was factorised instead, shift {:.1} 1/s\n", value.shift);
        }
        self.notes.iter().for_each(|note| text += &format!("{note}\n"));
        text.push('\n');
        match &self.values[..] {
            [value] => text += &self.details(value, evidence),
            _ => {
                let width = family.parameter.len().max(8);
                text += &format!("{:>width$}  modes  unstable: frequency (growth rate)\n", family.parameter);
                self.values.iter().for_each(|value| text += &value.line(width));
            }
        }
        text +=
            &self.diagram.as_ref().map_or_else(String::new, |diagram| branches::summary(diagram, &family.parameter));
        text += &format!("\n{seconds:.1} s on {ranks} rank{}\n", if ranks == 1 { "" } else { "s" });
        text + &self.files_text(place)
    }

    /// The modes at one value, and what is known of their number.
    fn details(&self, value: &Value, evidence: Evidence) -> String {
        eigenvalues::text(&value.rows) + &counted(&value.count, evidence, self.given.n, self.given.is_damped())
    }

    /// What the matrices are like.
    fn structure(&self) -> String {
        let of = |is_symmetric: bool| if is_symmetric { "symmetric" } else { "unsymmetric" };
        let symmetry = self.given.symmetry;
        let damping = if self.given.is_damped() { format!("C {}", of(symmetry.damping)) } else { "no C".into() };
        let held = match self.given.names.n_held {
            0 => String::new(),
            n => format!("; {n} held displacements (1e36 on the diagonal of K) are left out"),
        };
        format!("M {}, {damping}, K {}{held}\n", of(symmetry.mass), of(symmetry.stiffness))
    }

    fn files_text(&self, place: &str) -> String {
        let mut files = vec![("summary.txt", "this text"), ("modes.csv", "all modes")];
        if self.values.len() > 1 {
            files.push(("details.txt", "the modes at each value in words"));
        }
        if self.diagram.is_some() {
            files.extend([
                ("branches.csv", "modes followed over the parameter"),
                ("hopf.csv", "where they become unstable"),
            ]);
        }
        if self.shapes {
            files.push(("shapes*.csv", "shapes, a row for each equation"));
        }
        let lines: String = files.iter().map(|(name, what)| format!("  {name:36}{what}\n")).collect();
        format!("\nresults in {place}:\n{lines}")
    }

    fn write(&self, family: &MatrixFamily, evidence: Evidence, folder: Folder, summary: &str) -> Result<()> {
        let varies = family.terms.iter().any(|term| term.factor.varies());
        let parameter = varies.then_some(family.parameter.as_str());
        folder.write("summary.txt", |out| out.write_all(summary.as_bytes()))?;
        let groups: Vec<(f64, &[Row])> = self.values.iter().map(|value| (value.value, &value.rows[..])).collect();
        folder.write("modes.csv", |out| eigenvalues::table(out, parameter, &groups))?;
        if let [_, _, ..] = self.values[..] {
            let details =
                |value: &Value| format!("{} = {}\n{}\n", family.parameter, value.value, self.details(value, evidence));
            let text: String = self.values.iter().map(details).collect();
            folder.write("details.txt", |out| out.write_all(text.as_bytes()))?;
        }
        if let Some(diagram) = &self.diagram {
            let band = self.band.map(|f| TAU * f);
            folder.write("branches.csv", |out| branches::points(out, diagram, band, &family.parameter))?;
            folder.write("hopf.csv", |out| branches::hopf(out, diagram, &family.parameter))?;
        }
        for value in self.values.iter().filter(|_| self.shapes) {
            let name = if varies { format!("shapes_{}.csv", value.value) } else { "shapes.csv".into() };
            let dofs: Option<Vec<(i64, i32)>> = self
                .given
                .names
                .dofs
                .as_ref()
                .map(|dofs| dofs.iter().map(|&Dof { node, axis }| (node, axis)).collect());
            folder
                .write(&name, |out| eigenvalues::shapes(out, &self.given.names.rows, dofs.as_deref(), &value.shapes))?;
        }
        folder.finish()
    }
}

fn divided(mut values: Vec<f64>, by: f64) -> Vec<f64> {
    values.iter_mut().for_each(|value| *value /= by);
    values
}

/// Growth rates above this are no noise: a millionth of the frequency; of a real eigenvalue, as which the double zero of a free motion may
/// come out, a hundred-thousandth of the band's end.
fn growth_threshold(lambda: Complex64, band: [f64; 2]) -> f64 {
    if lambda.im == 0.0 { 1e-5 * TAU * band[1] } else { 1e-6 * lambda.im.abs() }
}

/// What is known of the number of modes.
fn counted(count: &Count, evidence: Evidence, n: usize, is_damped: bool) -> String {
    let Count { below, expected, found } = *count;
    let how = match (evidence, count.agrees()) {
        (Evidence::Inertia, true) if !is_damped => {
            "as many as K - omega^2 M has negative eigenvalues by Sylvester's law of inertia: none is missing".into()
        }
        (Evidence::Inertia, true) => {
            "as many as the undamped problem has by Sylvester's law of inertia, which damping may shift across the end".into()
        }
        (Evidence::Inertia, false) => format!(
            "but {expected} negative eigenvalues of K - omega^2 M: not confirmed (massless equations, strong damping or an indefinite M \
             change the count)"
        ),
        (Evidence::Repetition { .. }, true) if n <= Evidence::ALL_UP_TO => "and all eigenvalues were found: none is missing".into(),
        (Evidence::Repetition { .. }, true) => {
            "as many as the inertia of the symmetric parts tells, or as another search found; of matrices that are not symmetric neither is \
             a proof".into()
        }
        (Evidence::Repetition { .. }, false) => "not confirmed: two searches did not find the same number".into(),
    };
    format!("{found} modes with |lambda| below {below:.1} Hz, {how}\n")
}
