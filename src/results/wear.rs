//! Wear of the sliding pairs: a history by steps, and the worn surface point by point.

use serde::{Deserialize, Serialize};

/// Wear of a brake at one friction value.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Wear {
    /// Title of the model.
    pub title: String,
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// The state before any wear, then the state after each step.
    pub steps: Vec<WearStep>,
    /// How the wear has ended.
    pub end: WearEnd,
    /// The contact points of the pairs that wear.
    #[serde(skip)]
    pub points: Vec<WornPoint>,
    /// Whether a super-element has worn, whose contacts have no faces.
    #[serde(skip)]
    pub is_reduced: bool,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Ranks.
    #[serde(rename = "ranks")]
    pub n_ranks: usize,
}

/// How wear ends.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WearEnd {
    /// The sliding distance asked for.
    #[default]
    Distance,
    /// `p v` is as uniform as was asked for.
    Uniform,
    /// `p v` changes no more, and is not uniform: the parts tilt at a constant rate.
    Steady,
}

/// A state of wear.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WearStep {
    /// Sliding distance so far, the mean over the points that wear, m.
    #[serde(rename = "distance_m")]
    pub distance: f64,
    /// By pair.
    pub pairs: Vec<PairWear>,
}

/// What a pair has worn off, and how it wears now. `p v` is pressure times sliding speed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PairWear {
    /// Its name.
    pub pair: String,
    /// Mean of `p v` over its area, W/m2.
    #[serde(rename = "pv_mean_w_per_m2")]
    pub mean: f64,
    /// Standard deviation of `p v` over its mean.
    #[serde(rename = "pv_spread")]
    pub spread: f64,
    /// Smallest `p v`, W/m2.
    #[serde(rename = "pv_min_w_per_m2")]
    pub smallest: f64,
    /// Largest `p v`, W/m2.
    #[serde(rename = "pv_max_w_per_m2")]
    pub largest: f64,
    /// Largest pressure, Pa.
    #[serde(rename = "pressure_max_pa")]
    pub pressure: f64,
    /// Largest depth, m.
    #[serde(rename = "depth_max_m")]
    pub depth: f64,
    /// Worn volume, `sum w h` of the gaps, m3.
    #[serde(rename = "volume_m3")]
    pub volume: f64,
    /// Worn volume by Archard's law, `k sum p v dt` over all steps, m3.
    #[serde(rename = "archard_volume_m3")]
    pub archard_volume: f64,
    /// Worn mass of the slave's material, kg.
    #[serde(rename = "mass_kg")]
    pub mass: f64,
}

/// A contact point of a pair that wears.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WornPoint {
    /// Name of its pair.
    pub contact: String,
    /// Where it is, m.
    pub x_m: f64,
    /// The same along y.
    pub y_m: f64,
    /// The same along z.
    pub z_m: f64,
    /// What is added to the mesh's gap: the model's gap field and the wear, m.
    pub gap_m: f64,
    /// Wear of this run, m.
    pub wear_m: f64,
    /// Weight of the point, m2.
    pub area_m2: f64,
    /// Sliding speed, m/s.
    pub speed_m_per_s: f64,
    /// Pressure before any wear, Pa.
    pub pressure_before_pa: f64,
    /// Pressure after it, Pa.
    pub pressure_pa: f64,
}

impl WearStep {
    /// The largest spread of `p v` of a pair.
    pub fn spread(&self) -> f64 {
        self.pairs.iter().map(|pair| pair.spread).fold(0.0, f64::max)
    }
}
