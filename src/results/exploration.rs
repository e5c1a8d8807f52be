//! What a study of many parameters has found.

use serde::Serialize;

use super::{About, Shape, Surface};
use crate::explore::{Answers, Gradient, ModePlace, PointModel, PointResult};

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
    /// The model file of the point with the largest growth rate; none of a super-element whose parts do not change.
    pub worst: Option<PointModel>,
    /// Reference pairs of the layout that was analysed, where there are any.
    pub contacts: Option<usize>,
    /// The random fields, in the order of the study.
    pub fields: Vec<FieldShare>,
    /// Where shapes are known, without samples; empty where there are none.
    pub surface: Surface,
    /// Those shapes that matter most, for a page; the results file has all.
    pub shapes: Vec<PointShape>,
}

/// The shape of a mode at a point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointShape {
    /// The mode.
    pub place: ModePlace,
    /// At all nodes of the surface.
    pub shape: Shape,
}

/// What the modes of a random field have of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FieldShare {
    /// Its name.
    pub name: String,
    /// Number of contact points that it covers.
    pub n_points: usize,
    /// Number of its modes.
    pub n_modes: usize,
    /// The share of its variance that they have together.
    pub share: f64,
}
