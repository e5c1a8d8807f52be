//! Free modes of one part, as plain data.

use nalgebra::DMatrix;
use serde::Serialize;

use crate::stability::Count;

/// The free, undamped modes of a part.
#[derive(Debug, Clone)]
pub struct FreeModes {
    /// Title of the model.
    pub title: String,
    /// Name of the part.
    pub part: String,
    /// Free dofs.
    pub n_dofs: usize,
    /// Band analysed, Hz.
    pub band: [f64; 2],
    /// Rigid motions among the modes.
    pub n_rigid: usize,
    /// The largest frequency that rounding gives them, Hz.
    pub rigid_noise: f64,
    /// The check of the number of modes, rigid motions among them.
    pub count: Count,
    /// Elastic modes by frequency.
    pub modes: Vec<FreeMode>,
    /// Measured modes beside them.
    pub measured: Option<MeasuredComparison>,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Ranks that solved.
    pub n_ranks: usize,
}

/// An elastic mode.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct FreeMode {
    /// Hz.
    #[serde(rename = "frequency_hz")]
    pub frequency: f64,
    /// Normwise backward error.
    pub backward_error: f64,
}

/// Measured modes compared with computed ones.
#[derive(Debug, Clone)]
pub struct MeasuredComparison {
    /// Measured frequencies, Hz.
    pub frequencies: Vec<f64>,
    /// MAC of each measured mode (row) with each computed one.
    pub single: DMatrix<f64>,
    /// Computed modes of one frequency together.
    pub groups: Vec<Vec<usize>>,
    /// MAC of each measured mode (row) with the span of each group.
    pub grouped: DMatrix<f64>,
    /// The largest distance of a measured point from its node, in the mesh's unit.
    pub distance: f64,
}

impl FreeModes {
    /// Hz.
    pub fn frequencies(&self) -> Vec<f64> {
        self.modes.iter().map(|mode| mode.frequency).collect()
    }
}
