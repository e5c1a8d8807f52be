//! A brake in several models: what each costs, and how far it is from the reference.

use std::f64::consts::TAU;

use serde::Serialize;

use super::instabilities::{CurvePoint, lowest, spurious};
use super::{Comparison, ComparisonAtValue, ModePair, compare};
use crate::Result;
use crate::results::{About, Results};
use crate::tracking::Hopf;

/// A reference and other models of the same brake.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    /// Title of the brake.
    pub title: String,
    /// Band, Hz.
    #[serde(rename = "band_hz")]
    pub band: [f64; 2],
    /// Nodes of the mesh.
    #[serde(rename = "nodes")]
    pub n_nodes: usize,
    /// Elements of the mesh.
    #[serde(rename = "elements")]
    pub n_elements: usize,
    /// The requested friction values, rising.
    pub friction_values: Vec<f64>,
    /// Full contact on the full structure; its curves are the instabilities of lowest frequency.
    pub reference: StudiedModel,
    /// The others.
    pub models: Vec<StudiedModel>,
}

/// One of the models.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct StudiedModel {
    /// Its name for users.
    #[serde(rename = "model")]
    pub name: String,
    /// Its sizes.
    #[serde(flatten)]
    pub sizes: Sizes,
    /// Equilibrium and modes of one requested value, on average, wall-clock time in s.
    #[serde(rename = "seconds_per_value")]
    pub seconds: f64,
    /// What it cost to make, s; none where nothing is made beforehand.
    #[serde(rename = "seconds_to_make")]
    pub making_seconds: Option<f64>,
    /// Where modes become unstable, by friction, as far as they were followed.
    pub onsets: Vec<Onset>,
    /// The reference's instabilities in this model, as far as they are found.
    pub curves: Vec<Vec<CurvePoint>>,
    /// Errors at each value; of the reference none.
    pub errors: Vec<Errors>,
    /// Modes that grow here alone.
    pub spurious: Vec<CurvePoint>,
}

/// Where a mode becomes unstable as friction rises.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Onset {
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// Hz.
    #[serde(rename = "frequency_hz")]
    pub frequency: f64,
}

/// How large a model is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Sizes {
    /// Contact points of the sliding pairs.
    #[serde(rename = "contact_points")]
    pub n_contacts: usize,
    /// Points that are, or would be, retained by its super-element: both sides of each contact, and the loaded sets.
    /// None of full contact.
    #[serde(rename = "retained_points")]
    pub n_retained: Option<usize>,
    /// Free dofs.
    #[serde(rename = "dofs")]
    pub n_dofs: usize,
}

/// Errors of all modes at one friction value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// Modes with a partner.
    #[serde(rename = "modes")]
    pub n_pairs: usize,
    /// Largest relative error of a frequency.
    #[serde(rename = "worst_frequency_error")]
    pub worst_frequency: f64,
    /// Mean of them.
    #[serde(rename = "mean_frequency_error")]
    pub mean_frequency: f64,
    /// Largest error of a growth rate, relative to the largest growth rate of the reference.
    #[serde(rename = "worst_growth_error")]
    pub worst_growth: f64,
    /// Least MAC.
    pub least_mac: f64,
    /// Modes of the reference without partner.
    pub unmatched_reference: usize,
    /// Modes of the model without partner.
    pub unmatched_model: usize,
}

/// How many instabilities are followed.
const INSTABILITIES: usize = 2;

impl Study {
    /// A study of a reference, which other models join.
    pub fn new(results: &Results) -> Study {
        let mut friction_values: Vec<f64> = results.asked().map(|value| value.friction).collect();
        friction_values.sort_by(f64::total_cmp);
        let About { ref title, band, n_nodes, n_elements, n_dofs, .. } = results.about;
        let reference = StudiedModel {
            name: "full contact".into(),
            sizes: Sizes { n_contacts: n_contacts(results), n_retained: None, n_dofs },
            seconds: seconds(results),
            onsets: onsets(results),
            curves: lowest(results, INSTABILITIES).iter().map(|one| one.of(results)).collect(),
            ..StudiedModel::default()
        };
        Study { title: title.clone(), band, n_nodes, n_elements, friction_values, reference, models: Vec::new() }
    }

    /// Adds a model of some name and sizes, whose results are compared with those of the reference.
    ///
    /// # Errors
    /// See [`compare`].
    pub fn add(
        &mut self,
        name: &str,
        [reference, results]: [&Results; 2],
        sizes: Sizes,
        making_seconds: Option<f64>,
    ) -> Result<()> {
        let comparison = compare(reference, results)?;
        self.models.push(StudiedModel {
            name: name.into(),
            sizes,
            seconds: seconds(results),
            making_seconds,
            onsets: onsets(results),
            curves: lowest(reference, INSTABILITIES).iter().map(|one| one.in_other(&comparison)).collect(),
            errors: errors(&comparison),
            spurious: spurious(&comparison),
        });
        Ok(())
    }

    /// The number of values at which an instability of the reference grows in a model, too, and in the reference.
    pub fn found(&self, instability: usize, model: &StudiedModel) -> [usize; 2] {
        let grows = || self.reference.curves[instability].iter().filter(|point| point.unstable);
        let also = |point: &&CurvePoint| {
            let same = |other: &&CurvePoint| other.friction == point.friction;
            model.curves[instability].iter().find(same).is_some_and(|other| other.unstable)
        };
        [grows().filter(also).count(), grows().count()]
    }
}

/// Contact points of the sliding pairs.
pub fn n_contacts(results: &Results) -> usize {
    results.about.pairs.iter().filter(|pair| pair.sliding).map(|pair| pair.n_points).sum()
}

fn onsets(results: &Results) -> Vec<Onset> {
    let onset = |hopf: &Hopf| Onset { friction: hopf.value, frequency: hopf.omega / TAU };
    let all = results.diagram.iter().flat_map(|diagram| &diagram.hopf);
    all.filter(|hopf| hopf.onset).map(onset).collect()
}

fn seconds(results: &Results) -> f64 {
    let all: Vec<f64> = results.asked().map(|value| value.seconds).collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
}

impl Errors {
    /// The largest errors over all values, and the mean of the mean ones.
    pub fn worst(all: &[Errors]) -> Errors {
        let largest = |of: fn(&Errors) -> f64| all.iter().map(of).fold(0.0, f64::max);
        Errors {
            friction: f64::NAN,
            n_pairs: all.iter().map(|e| e.n_pairs).sum(),
            worst_frequency: largest(|e| e.worst_frequency),
            mean_frequency: all.iter().map(|e| e.mean_frequency).sum::<f64>() / all.len().max(1) as f64,
            worst_growth: largest(|e| e.worst_growth),
            least_mac: all.iter().map(|e| e.least_mac).fold(1.0, f64::min),
            unmatched_reference: all.iter().map(|e| e.unmatched_reference).sum(),
            unmatched_model: all.iter().map(|e| e.unmatched_model).sum(),
        }
    }
}

fn errors(comparison: &Comparison) -> Vec<Errors> {
    let largest = |at: &ComparisonAtValue, of: &dyn Fn(&ModePair) -> f64| at.pairs.iter().map(of).fold(0.0, f64::max);
    let one = |at: &ComparisonAtValue| Errors {
        friction: at.friction,
        n_pairs: at.pairs.len(),
        worst_frequency: largest(at, &|pair| pair.frequency_error.abs()),
        mean_frequency: at.pairs.iter().map(|pair| pair.frequency_error.abs()).sum::<f64>()
            / at.pairs.len().max(1) as f64,
        worst_growth: largest(at, &|pair| pair.growth_error.abs()),
        least_mac: at.pairs.iter().map(|pair| pair.mac).fold(1.0, f64::min),
        unmatched_reference: at.unmatched[0].len(),
        unmatched_model: at.unmatched[1].len(),
    };
    comparison.values.iter().map(one).collect()
}
