//! A case as numbers beside their reference, and as a section of the document.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A number and what it ought to be.
pub struct Row {
    pub what: String,
    pub unit: &'static str,
    pub found: f64,
    pub expected: f64,
    /// What a difference is measured by.
    scale: f64,
    /// Range of the difference over the scale.
    allowed: [f64; 2],
}

impl Row {
    /// Within `tolerance` of the expected value.
    pub fn new(what: impl Into<String>, unit: &'static str, found: f64, expected: f64, tolerance: f64) -> Row {
        Row::between(what, unit, found, expected, [-tolerance, tolerance])
    }

    /// Off by a fraction of the expected value within a range.
    pub fn between(what: impl Into<String>, unit: &'static str, found: f64, expected: f64, allowed: [f64; 2]) -> Row {
        Row { what: what.into(), unit, found, expected, scale: expected.abs(), allowed }
    }

    /// The same as a fraction of another scale, as a value that ought to be zero has none.
    pub fn scaled(self, scale: f64) -> Row {
        Row { scale, ..self }
    }

    fn difference(&self) -> f64 {
        (self.found - self.expected) / self.scale
    }

    /// Requires the difference to be allowed, and prints it.
    fn check(&self) {
        let (difference, [low, high]) = (self.difference(), self.allowed);
        let shown = format!("{}: {:.10e} against {:.10e} {}", self.what, self.found, self.expected, self.unit);
        println!("{shown}, off by {difference:.1e}, allowed {low:.0e} to {high:.0e}");
        assert!(low <= difference && difference <= high, "{shown}: off by {difference:.2e}");
    }

    /// A line of the document.
    fn line(&self) -> String {
        let [found, expected] = [self.found, self.expected].map(|x| shown(x, self.scale));
        let difference = signed(self.difference());
        let allowed = match self.allowed {
            [low, high] if low == -high => format!("±{}", percent(high)),
            [low, high] => format!("{} to {}", signed(low), signed(high)),
        };
        format!("| {} | {} | {found} | {expected} | {difference} | {allowed} |", self.what, self.unit)
    }
}

/// Seven digits of the scale: what lies below is noise.
fn shown(x: f64, scale: f64) -> String {
    let digits = 6 - scale.log10().floor() as i32;
    if (0..=9).contains(&digits) {
        let rounded = (x * 10_f64.powi(digits)).round() / 10_f64.powi(digits) + 0.0;
        return format!("{rounded:.*}", digits as usize);
    }
    format!("{:.6e}", x)
}

/// A fraction without its sign.
fn percent(fraction: f64) -> String {
    match fraction.abs() {
        x if x < 5e-5 => format!("{x:.0e}"),
        x => format!("{:.2} %", 100.0 * x).replace(".00", ""),
    }
}

/// A difference; what is below 0.01 % is only said to be so, as noise is not the same in every run.
fn signed(fraction: f64) -> String {
    match fraction {
        0.0 => "0".to_owned(),
        x if x.abs() < 5e-5 => "below 0.01 %".to_owned(),
        x if x < 0.0 => format!("−{:.2} %", -100.0 * x),
        x => format!("+{:.2} %", 100.0 * x),
    }
}

/// A case of the document.
pub struct Case {
    pub title: &'static str,
    /// What it is, its source, what to expect.
    pub text: &'static str,
    pub rows: Vec<Row>,
}

/// A number of the document may differ by this fraction of its scale from what a run gives on another machine.
const NOISE: f64 = 2e-6;

impl Case {
    /// The section of the document.
    pub fn section(&self) -> String {
        let mut out = format!("## {}\n\n{}\n\n", self.title, self.text);
        out += "| quantity | unit | squeal | reference | difference | allowed |\n|---|---|---|---|---|---|\n";
        self.rows.iter().for_each(|row| writeln!(out, "{}", row.line()).unwrap());
        out
    }

    /// Requires all numbers to be what they ought to be, and to be those of the document.
    pub fn verify(&self) {
        self.rows.iter().for_each(Row::check);
        let document = std::fs::read_to_string(document()).unwrap_or_default();
        let section = section_of(&document, self.title);
        let (written, now) = (numbers(section), numbers(&self.section()));
        assert_eq!(written.len(), self.rows.len(), "{}: other rows in the document: {ADVICE}", self.title);
        for ((row, written), now) in self.rows.iter().zip(written).zip(now) {
            assert_eq!(written.0, now.0, "{ADVICE}");
            let [found, expected] = [written.1[0] - now.1[0], written.1[1] - now.1[1]].map(f64::abs);
            assert!(
                found.max(expected) <= NOISE * row.scale,
                "{}: {:?} in the document: {ADVICE}",
                row.what,
                written.1
            );
        }
    }
}

/// What to do where the document differs.
pub const ADVICE: &str = "`make validation` writes it again";

/// The document.
pub fn document() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/validation.md")
}

/// The text below a title.
pub fn section_of<'a>(document: &'a str, title: &str) -> &'a str {
    let start = document.find(&format!("## {title}\n")).unwrap_or(document.len());
    let rest = &document[start..];
    &rest[..rest.find("\n## ").unwrap_or(rest.len())]
}

/// The name and the two numbers of each row of a section.
fn numbers(section: &str) -> Vec<(String, [f64; 2])> {
    let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let row =
        |cells: Vec<String>| Some((cells.get(1)?.clone(), [cells.get(3)?.parse().ok()?, cells.get(4)?.parse().ok()?]));
    section.lines().filter_map(|line| row(cells(line))).collect()
}
