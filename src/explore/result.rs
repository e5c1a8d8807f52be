//! What a study finds at a point.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A point of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointResult {
    /// Values of the parameters.
    pub values: Vec<f64>,
    /// What was found.
    pub outcome: Outcome,
}

/// What was found at a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Outcome {
    /// The modes of the band, by frequency.
    Modes(Vec<PointMode>),
    /// Why there are none.
    Failed(String),
}

/// A mode at a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PointMode {
    /// Eigenvalue, 1/s.
    pub lambda: Complex64,
    /// Whether it is unstable by the study's criterion.
    pub unstable: bool,
    /// Backward error of the eigenpair.
    pub backward_error: f64,
    /// The mode of the nominal point that it is, where one was recognised.
    pub link: Option<Link>,
}

/// A mode recognised as one of the nominal point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Link {
    /// Number of the nominal mode, from 1.
    pub nominal: usize,
    /// Share of the nominal mode in it: 1 for the same mode, above 1 near a coalescence.
    pub share: f64,
    /// Whether the share is too small, or too large, to be sure.
    pub doubtful: bool,
}

impl PointResult {
    /// The modes; none where the point has failed.
    pub fn modes(&self) -> Option<&[PointMode]> {
        match &self.outcome {
            Outcome::Modes(modes) => Some(modes),
            Outcome::Failed(_) => None,
        }
    }

    /// The mode that grows most, or decays least.
    pub fn critical(&self) -> Option<&PointMode> {
        self.modes()?.iter().max_by(|a, b| a.lambda.re.total_cmp(&b.lambda.re))
    }

    /// Whether a mode is unstable.
    pub fn is_unstable(&self) -> bool {
        self.modes().is_some_and(|modes| modes.iter().any(|mode| mode.unstable))
    }
}

impl PointMode {
    /// Frequency, Hz.
    pub fn frequency(&self) -> f64 {
        self.lambda.im / std::f64::consts::TAU
    }

    /// Growth rate, 1/s.
    pub fn growth_rate(&self) -> f64 {
        self.lambda.re
    }

    /// `-Re lambda / |lambda|`; 0 for a zero.
    pub fn damping_ratio(&self) -> f64 {
        if self.lambda.norm() > 0.0 { -self.lambda.re / self.lambda.norm() } else { 0.0 }
    }
}
