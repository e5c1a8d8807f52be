//! Branches and Hopf points as tables.

use std::f64::consts::TAU;

use super::columns::{BranchRow, PointRow};
use crate::tracking::{Diagram, Hopf, Point};

/// The points of all branches within a band (rad/s); branches are numbered from 1.
pub fn points(diagram: &Diagram, band: [f64; 2]) -> impl Iterator<Item = BranchRow> {
    let is_inside = move |point: &&Point| (band[0]..=band[1]).contains(&point.lambda.im);
    let row = |branch| move |point: &Point| BranchRow { branch, point: PointRow::new(point) };
    let branches = (1..).zip(&diagram.branches);
    branches.flat_map(move |(number, branch)| branch.points.iter().filter(is_inside).map(row(number)))
}

/// What a branch becomes there as friction rises.
pub fn becomes(hopf: &Hopf) -> &'static str {
    if hopf.onset { "unstable" } else { "stable" }
}

/// Where growth rates pass zero, for people.
pub fn summary(diagram: &Diagram, parameter: &str) -> String {
    let Some(first) = diagram.values.first() else { return String::new() };
    let mut text =
        format!("\n{} branches over {} values of {parameter}\n", diagram.branches.len(), diagram.values.len());
    for hopf in &diagram.hopf {
        let hertz = |branch: usize| diagram.branches[branch].points[0].lambda.im / TAU;
        let coupled = match hopf.partner {
            Some(p) => format!("coalesces with {:.1} Hz, branch {}", hertz(p.branch), p.branch + 1),
            None => "without coalescence".into(),
        };
        text += &format!(
            "{} from {parameter} {:.4} on: {:.1} Hz, branch {} ({:.1} Hz at {}), {coupled}\n",
            becomes(hopf),
            hopf.value,
            hopf.omega / TAU,
            hopf.branch + 1,
            hertz(hopf.branch),
            (first * 1e6).round() / 1e6,
        );
    }
    for [low, high] in &diagram.doubtful {
        text += &format!("some branches could not be followed from {low:.4} to {high:.4}\n");
    }
    text
}
