//! What a study of many parameters has found.

use super::About;
use crate::explore::{Answers, Gradient, PointResult};

/// What a study of many parameters has found.
#[derive(Debug, Clone)]
pub struct Exploration {
    /// What was analysed.
    pub about: About,
    /// The nominal point, then those of the design.
    pub points: Vec<PointResult>,
    /// Derivatives of the nominal modes by each parameter; none where they are not asked for, or the nominal point has
    /// failed.
    pub gradients: Vec<Gradient>,
    /// Probabilities and indices over all points.
    pub answers: Answers,
    /// The model file of the point with the largest growth rate; none of a super-element.
    pub worst: Option<String>,
}
