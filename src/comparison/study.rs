//! A brake in several models: what each costs, and how far it is from the reference.

use serde::Serialize;

use super::instabilities::{CurvePoint, ReferenceInstability, lowest, spurious};
use super::{Comparison, ComparisonAtValue, ModePair, compare};
use crate::Result;
use crate::results::{Results, Value};

/// A reference and other models of the same brake.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Study {
    /// Title of the brake.
    pub title: String,
    /// Band, Hz.
    pub band: [f64; 2],
    /// Nodes and elements of the mesh.
    pub mesh: [usize; 2],
    /// The frictions asked for, rising.
    pub frictions: Vec<f64>,
    /// Full contact on the full structure; its curves are the instabilities of lowest frequency.
    pub reference: StudiedModel,
    /// The others.
    pub models: Vec<StudiedModel>,
}

/// One of the models.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StudiedModel {
    /// What people call it.
    pub name: String,
    /// Its sizes.
    pub sizes: Sizes,
    /// Equilibrium and modes of one friction asked for, on average, wall-clock time in s.
    pub seconds: f64,
    /// What it cost to make, s; none where nothing is made beforehand.
    pub making_seconds: Option<f64>,
    /// The reference's instabilities in this model, as far as they are found.
    pub curves: Vec<Vec<CurvePoint>>,
    /// Errors at each friction; of the reference none.
    pub errors: Vec<Errors>,
    /// Modes that grow here alone: friction, Hz, 1/s.
    pub spurious: Vec<[f64; 3]>,
}

/// How large a model is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sizes {
    /// Contact points of the sliding pairs.
    pub n_contacts: usize,
    /// Points that are, or would be, retained by its super-element: both sides of each contact, and the loaded sets.
    /// None of full contact.
    pub n_retained: Option<usize>,
    /// Equations solved.
    pub n_equations: usize,
}

/// Errors of all modes at one friction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Friction of the swept pairs.
    pub friction: f64,
    /// Modes with a partner.
    pub n_pairs: usize,
    /// Largest relative error of a frequency.
    pub worst_frequency: f64,
    /// Mean of them.
    pub mean_frequency: f64,
    /// Largest error of a growth rate, relative to the largest growth rate of the reference.
    pub worst_growth: f64,
    /// Least MAC.
    pub least_mac: f64,
    /// Modes of the reference and of the model without partner.
    pub n_unmatched: [usize; 2],
}

/// How many instabilities are followed.
const INSTABILITIES: usize = 2;

impl Study {
    /// A study of a reference, which other models join.
    pub fn new(results: &Results) -> Study {
        let mut frictions: Vec<f64> = asked(results).map(|value| value.friction).collect();
        frictions.sort_by(f64::total_cmp);
        let curves = lowest(results, INSTABILITIES).iter().map(|one| one.of(results)).collect();
        let about = &results.about;
        let reference = StudiedModel {
            name: "full contact".into(),
            sizes: Sizes { n_contacts: n_contacts(results), n_retained: None, n_equations: about.n_equations },
            seconds: seconds(results),
            making_seconds: None,
            curves,
            errors: Vec::new(),
            spurious: Vec::new(),
        };
        let (title, mesh) = (about.title.clone(), [about.n_nodes, about.n_elements]);
        Study { title, band: about.band, mesh, frictions, reference, models: Vec::new() }
    }

    /// Adds a model of some name, with `n_loaded` loaded sets and `n_equations`, judged by the results of the
    /// reference.
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
        let followed: Vec<ReferenceInstability> = lowest(reference, INSTABILITIES);
        self.models.push(StudiedModel {
            name: name.into(),
            sizes,
            seconds: seconds(results),
            making_seconds,
            curves: followed.iter().map(|one| one.in_other(&comparison)).collect(),
            errors: errors(&comparison),
            spurious: spurious(&comparison),
        });
        Ok(())
    }

    /// In how many of the frictions at which an instability of the reference grows it grows in a model, too: `[in the
    /// model, in all]`.
    pub fn found(&self, instability: usize, model: &StudiedModel) -> [usize; 2] {
        let grows = || self.reference.curves[instability].iter().filter(|point| point.unstable);
        let also = |point: &&CurvePoint| {
            let same = |other: &&CurvePoint| other.friction == point.friction;
            model.curves[instability].iter().find(same).is_some_and(|other| other.unstable)
        };
        [grows().filter(also).count(), grows().count()]
    }
}

fn asked(results: &Results) -> impl Iterator<Item = &Value> {
    results.values.iter().filter(|value| value.asked)
}

/// Contact points of the sliding pairs.
pub fn n_contacts(results: &Results) -> usize {
    results.about.pairs.iter().filter(|pair| pair.sliding).map(|pair| pair.n_points).sum()
}

fn seconds(results: &Results) -> f64 {
    let all: Vec<f64> = asked(results).map(|value| value.seconds).collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
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
        n_unmatched: [0, 1].map(|side| at.unmatched[side].len()),
    };
    comparison.frictions.iter().map(one).collect()
}
