//! What tracking finds: branches and Hopf points.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A mode at one value of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The parameter.
    pub value: f64,
    /// The eigenvalue, 1/s.
    pub lambda: Complex64,
    /// Place of the mode among those of its value, from 0.
    pub mode: usize,
}

/// A mode followed along the parameter.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Branch {
    /// Its points, in the order in which the parameter runs.
    pub points: Vec<Point>,
}

impl Branch {
    /// The point of largest growth rate.
    ///
    /// # Panics
    /// Where the branch has no point; those of a [`Diagram`] have.
    pub fn worst(&self) -> &Point {
        self.points.iter().max_by(|p, q| p.lambda.re.total_cmp(&q.lambda.re)).expect("a branch has a point")
    }
}

/// Another branch in the shape of an unstable one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Partner {
    /// Index of the branch.
    pub branch: usize,
    /// Share of its mode at the sweep's first value in the unstable mode; all shares add up to 1.
    pub share: f64,
}

/// A value where a growth rate passes zero. (For a real eigenvalue, which makes no oscillation, this is divergence.)
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hopf {
    /// Index of the branch.
    pub branch: usize,
    /// Two solved values, the lower one first, on which the branch is stable and unstable, no farther apart than the
    /// tolerance.
    pub bracket: [f64; 2],
    /// Where the growth rate is zero between them, by the model that joins the two.
    pub value: f64,
    /// Angular frequency there, rad/s.
    pub omega: f64,
    /// Whether the branch becomes unstable as the parameter rises; else it becomes stable.
    pub onset: bool,
    /// The branch it couples with; none where the mode becomes unstable by itself.
    pub partner: Option<Partner>,
}

/// Branches of a family and their Hopf points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Diagram {
    /// The values solved, in the order in which the parameter runs: those asked for and those in between that were
    /// needed.
    pub values: Vec<f64>,
    /// Branches, by the frequency of their first point, those that are there from the beginning first.
    pub branches: Vec<Branch>,
    /// Hopf points, by value.
    pub hopf: Vec<Hopf>,
    /// Intervals of which not all modes could be recognised, none wider than the tolerance.
    pub doubtful: Vec<[f64; 2]>,
}

impl Diagram {
    /// Removes branches that never come into the band, and sorts the Hopf points.
    pub(super) fn finish(&mut self, in_band: impl Fn(Complex64) -> bool) {
        let keep: Vec<bool> =
            self.branches.iter().map(|branch| branch.points.iter().any(|point| in_band(point.lambda))).collect();
        let renumbered = |old: usize| keep[old].then(|| keep[..old].iter().filter(|&&k| k).count());
        self.hopf.retain(|hopf| keep[hopf.branch]);
        for hopf in &mut self.hopf {
            hopf.branch = renumbered(hopf.branch).expect("retained above");
            hopf.partner = hopf.partner.and_then(|p| renumbered(p.branch).map(|branch| Partner { branch, ..p }));
        }
        let mut flags = keep.iter();
        self.branches.retain(|_| *flags.next().expect("one flag a branch"));
        self.hopf.sort_by(|a, b| a.value.total_cmp(&b.value));
    }
}
