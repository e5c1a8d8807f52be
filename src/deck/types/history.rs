//! Steps and what acts in them.

use super::{Entry, Friction};
use crate::model::Place;

/// A step.
#[derive(Debug)]
pub struct Step {
    /// What it computes.
    pub procedure: Procedure,
    /// Supports, loads, motions and changes of friction.
    pub actions: Vec<Action>,
    /// Whether its displacements are large.
    pub nlgeom: bool,
    /// Whether it starts from the state of the steps before.
    pub perturbation: bool,
    /// Where it begins.
    pub place: Place,
}

/// What a step computes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Procedure {
    /// Nothing yet.
    None,
    /// Equilibrium.
    Static,
    /// Real modes with their band, in cycles per unit of time.
    Frequency([Option<f64>; 2]),
    /// Complex modes.
    ComplexFrequency {
        /// Their band, in cycles per unit of time.
        band: [Option<f64>; 2],
        /// Whether friction damps.
        friction_damping: bool,
        /// Whether Coriolis forces act.
        coriolis: bool,
    },
}

impl Procedure {
    /// Whether modes are computed, which need masses.
    pub fn is_of_modes(self) -> bool {
        matches!(self, Procedure::Frequency(_) | Procedure::ComplexFrequency { .. })
    }
}

/// What acts from a step on.
#[derive(Debug)]
pub struct Action {
    /// What it is.
    pub what: ActionKind,
    /// Whether it replaces everything of its kind from earlier steps.
    pub is_new: bool,
    /// Where it stands.
    pub place: Place,
}

/// Kinds of [`Action`].
#[derive(Debug)]
pub enum ActionKind {
    /// A prescribed displacement of first to last axis; none: nothing is prescribed (a header alone).
    Boundary(Entry, [u8; 2], f64),
    /// A force along an axis on each node.
    Force(Entry, u8, f64),
    /// Pressure on a face of elements.
    FacePressure(Entry, u8, f64),
    /// Pressure on a surface.
    SurfacePressure(String, f64),
    /// Steady rotation of nodes.
    Rotation(Entry, Spin),
    /// Gravity of elements, of all where none are named: an acceleration.
    Gravity(Option<Entry>, [f64; 3]),
    /// Centrifugal force of elements.
    Centrifugal(Entry, Spin),
    /// Another friction of an interaction.
    Friction(String, Friction),
    /// A header without data: it may end what acted before.
    Nothing(NothingKind),
}

/// Which kind of action a header without data is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NothingKind {
    /// `*BOUNDARY`
    Boundary,
    /// `*CLOAD`
    Force,
    /// `*DLOAD`
    Distributed,
    /// `*DSLOAD`
    SurfacePressure,
}

/// A steady rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spin {
    /// Radians per unit of time.
    pub speed: f64,
    /// A point of the axis.
    pub from: [f64; 3],
    /// Another point of the axis, which gives its direction.
    pub to: [f64; 3],
}

/// A keyword that changes no result.
#[derive(Debug)]
pub struct Ignored {
    /// The keyword as it is spelled.
    pub keyword: String,
    /// How often it is there.
    pub times: usize,
    /// Where it is first.
    pub place: Place,
}
