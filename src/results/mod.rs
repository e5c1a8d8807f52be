//! What a study found, as plain data: no PETSc, no ranks, whole on the root. A run fills it value by value, the results
//! file keeps it between runs, and everything that a user sees (tables, plots, report, comparisons) is made of it
//! alone.

mod certificate;
mod exploration;
pub mod exploration_file;
mod external;
pub mod file;
mod free_modes;
mod samples;
mod shape;
mod source;
#[cfg(test)]
pub mod testing;
mod verdict;
mod wear;

pub use certificate::{Certificate, CertifiedMode};
pub use exploration::{Exploration, FieldShare, PointShape};
pub use external::{ExternalMode, ExternalResults, ExternalValue};
pub use free_modes::{FreeMode, FreeModes, MeasuredComparison};
pub use samples::spread;
pub use shape::{largest, n_on_page};
pub use source::{Kind, Source};
pub use verdict::{Doubt, Status, Verdict};
pub use wear::{PairWear, Wear, WearEnd, WearStep, WornPoint};

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::equilibrium::{PairForces, Step};
use crate::model::InstabilityCriterion;
use crate::stability::{Count, RIGID_RATE};
use crate::tracking::Diagram;

/// A study and what it found.
///
/// ```
/// use squeal::Results;
/// use squeal::results::{ModeData, Value};
///
/// let mode = ModeData { unstable: true, ..ModeData::default() };
/// let value = Value { friction: 0.5, asked: true, modes: vec![mode], ..Value::default() };
/// let results = Results { values: vec![value], ..Results::default() };
/// let unstable = results.modes().filter(|(_, _, mode)| mode.unstable).map(|(mu, number, _)| (mu, number));
/// assert_eq!(unstable.collect::<Vec<_>>(), [(0.5, 1)]);
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Results {
    /// What was analysed, and by what.
    pub about: About,
    /// Where shapes are known.
    pub surface: Surface,
    /// Where contact is known.
    pub contact: ContactFaces,
    /// One value after the other, in the order in which they were finished; those asked for and those in between.
    pub values: Vec<Value>,
    /// Modes followed over friction, where that was asked for and has come to its end.
    pub diagram: Option<Diagram>,
    /// What the run cost, for people; whole only at the end.
    pub costs: String,
    /// Why the study went no further than its values; none where it came to its end.
    pub failure: Option<Failure>,
}

/// Why a study ended early.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// For people.
    pub reason: String,
    /// The friction value whose equilibrium was not reached, where it was that.
    pub friction: Option<f64>,
    /// The Newton steps towards it.
    pub steps: Vec<Step>,
}

/// What was analysed, and by what.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Title of the model.
    pub title: String,
    /// The program and its version.
    pub program: String,
    /// PETSc, SLEPc, MUMPS with their versions.
    pub libraries: String,
    /// The command as typed, without the program.
    pub command: String,
    /// The model file, or the super-element's.
    pub model: String,
    /// SHA-256 of its bytes.
    #[serde(rename = "model_sha256")]
    pub model_digest: String,
    /// Its text, as far as it is one.
    pub model_text: String,
    /// The mesh file.
    pub mesh: String,
    /// SHA-256 of its bytes.
    #[serde(rename = "mesh_sha256")]
    pub mesh_digest: String,
    /// Nodes of the mesh; none of a super-element.
    #[serde(rename = "nodes")]
    pub n_nodes: usize,
    /// Elements of the mesh.
    #[serde(rename = "elements")]
    pub n_elements: usize,
    /// Free dofs, or generalised coordinates of a super-element.
    #[serde(rename = "dofs")]
    pub n_dofs: usize,
    /// Ranks that solved them.
    #[serde(rename = "ranks")]
    pub n_ranks: usize,
    /// Band analysed, Hz.
    #[serde(rename = "band_hz")]
    pub band: [f64; 2],
    /// What counts as an unstable mode.
    #[serde(rename = "unstable", default)]
    pub criterion: InstabilityCriterion,
    /// Frictions asked for, in their order.
    pub friction_values: Vec<f64>,
    /// Whether neither a load nor an overlap presses the contacts together.
    pub unloaded: bool,
    /// Whether nothing takes energy out of the motions.
    #[serde(default)]
    pub undamped: bool,
    /// Whether a stiffness has a loss factor.
    #[serde(default)]
    pub structural_damping: bool,
    /// Whether a material is viscoelastic, so that each mode has the stiffness of its own frequency.
    #[serde(default)]
    pub viscoelastic: bool,
    /// Doubtful properties of the model, a sentence each.
    pub warnings: Vec<String>,
    /// The parts, which `Surface::part` counts.
    pub parts: Vec<Part>,
    /// The contact pairs, which `ContactFaces::pair` and `Value::pairs` count.
    pub pairs: Vec<Pair>,
}

/// A part.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Its name in the model.
    #[serde(rename = "part")]
    pub name: String,
    /// Its material's name.
    pub material: String,
    /// kg.
    #[serde(rename = "mass_kg")]
    pub mass: f64,
}

/// A contact pair.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// Its name in the model.
    #[serde(rename = "pair")]
    pub name: String,
    /// Whether its surfaces slide on each other.
    pub sliding: bool,
    /// Whether its friction coefficient is the study's parameter.
    pub swept: bool,
    /// Contact points.
    #[serde(rename = "points")]
    pub n_points: usize,
    /// Its normal stiffness, N/m3, where the user gives none and the program proposes it.
    #[serde(rename = "proposed_stiffness_n_per_m3")]
    pub proposed_stiffness: Option<f64>,
}

/// The outer surface of all parts, undeformed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// m.
    pub nodes: Vec<[f64; 3]>,
    /// Triangles, turning so that their normals point out.
    pub triangles: Vec<[u32; 3]>,
    /// Part of each triangle.
    pub part: Vec<i32>,
    /// Some of the nodes, spread over all parts: there every mode's shape is known, so that it can be compared with
    /// another's.
    pub samples: Vec<u32>,
}

/// The slave faces of all contact pairs, each pair with nodes of its own.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactFaces {
    /// m, undeformed.
    pub nodes: Vec<[f64; 3]>,
    /// Triangles; empty where contacts are single points.
    pub triangles: Vec<[u32; 3]>,
    /// Pair of each triangle.
    pub pair: Vec<i32>,
    /// Pair of each node.
    pub pair_of_node: Vec<i32>,
}

/// One friction value. What is skipped here are arrays, which the results file has beside the rest.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Value {
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// Whether it was asked for; else tracking needed it.
    pub asked: bool,
    /// What the contact pairs carry.
    pub pairs: Vec<PairForces>,
    /// The equilibrium's checks in words, a line each.
    pub checks: String,
    /// The Newton steps that led to it.
    pub steps: Vec<Step>,
    /// Normal pressure at the nodes of the contact faces, Pa.
    #[serde(skip)]
    pub pressure: Vec<f64>,
    /// There: 0 open, 1 slip, 2 stick, -1 no contact point.
    #[serde(skip)]
    pub status: Vec<i32>,
    /// Modes of the band by frequency.
    #[serde(skip)]
    pub modes: Vec<ModeData>,
    /// The check of their number.
    pub count: Option<Count>,
    /// Of a super-element: how well its equilibrium and modes solve the full model's equations, where that was asked
    /// for.
    #[serde(default)]
    pub certificate: Option<Certificate>,
    /// Wall-clock time, s.
    pub seconds: f64,
}

/// A mode.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ModeData {
    /// Eigenvalue, 1/s.
    pub lambda: Complex64,
    /// Normwise backward error.
    pub backward_error: f64,
    /// Whether it is unstable by the criterion of [`About`].
    pub unstable: bool,
    /// Displacements at the samples of the surface.
    pub sampled: Shape,
    /// Displacements at all nodes of the surface; of unstable modes at the requested values.
    pub shape: Option<Shape>,
    /// What explains it; of the same modes.
    pub sources: Vec<Source>,
}

/// Displacements of a complex mode, scaled so that the largest one where the mode is known (at the surface, else at its
/// samples) is 1 and real.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Real part.
    pub re: Vec<[f32; 3]>,
    /// Imaginary part.
    pub im: Vec<[f32; 3]>,
}

impl Results {
    /// The modes at the requested values, with their friction value and their numbers there from 1.
    pub fn modes(&self) -> impl Iterator<Item = (f64, usize, &ModeData)> {
        self.asked().flat_map(|value| (1..).zip(&value.modes).map(|(number, mode)| (value.friction, number, mode)))
    }

    /// The results by another criterion of what is unstable. Hopf points, which are those of the criterion by which
    /// modes were followed, are left out where it differs.
    pub fn by(mut self, criterion: InstabilityCriterion) -> Results {
        if criterion == self.about.criterion {
            return self;
        }
        self.about.criterion = criterion;
        for mode in self.values.iter_mut().flat_map(|value| &mut value.modes) {
            mode.unstable = mode.lambda.re > criterion.limit(mode.lambda, RIGID_RATE);
        }
        self.diagram.iter_mut().for_each(|diagram| diagram.hopf.clear());
        self
    }

    /// The requested values.
    pub fn asked(&self) -> impl Iterator<Item = &Value> {
        self.values.iter().filter(|value| value.asked)
    }
}

impl ModeData {
    /// Hz.
    pub fn frequency(&self) -> f64 {
        self.lambda.im.abs() / std::f64::consts::TAU
    }

    /// Growth rate, 1/s.
    pub fn growth_rate(&self) -> f64 {
        self.lambda.re
    }

    /// `-Re lambda / |lambda|`.
    pub fn damping_ratio(&self) -> f64 {
        -self.lambda.re / self.lambda.norm()
    }
}

#[cfg(test)]
mod tests {
    use super::testing;
    use crate::model::InstabilityCriterion;

    #[test]
    fn another_criterion_has_other_unstable_modes_and_no_hopf_points() {
        let results = testing::results();
        let n_unstable = |results: &super::Results| results.modes().filter(|(_, _, mode)| mode.unstable).count();
        let rates = || results.modes().map(|(_, _, mode)| mode.growth_rate());
        let limit = 0.5 * rates().fold(0.0, f64::max);
        let by = results.clone().by(InstabilityCriterion::GrowthRate(limit));
        assert_eq!(n_unstable(&by), rates().filter(|&rate| rate > limit).count());
        assert!(0 < n_unstable(&by) && n_unstable(&by) < n_unstable(&results));
        assert_eq!(by.diagram.as_ref().map(|diagram| diagram.hopf.len()), Some(0));
        assert_eq!(results.clone().by(results.about.criterion), results);
    }
}
