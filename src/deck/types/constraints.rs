//! What joins nodes: ties, rigid bodies, equations, multi-point constraints, local axes.

use super::Entry;
use crate::model::Place;

/// Two surfaces that move as one.
#[derive(Debug)]
pub struct TieDefinition {
    /// Its name.
    pub name: String,
    /// Name of the slave surface.
    pub slave: String,
    /// Name of the master surface.
    pub master: String,
    /// Points farther away are not tied.
    pub tolerance: Option<f64>,
    /// Whether slave nodes are to be moved onto the master.
    pub adjust: bool,
    /// Where it stands.
    pub place: Place,
}

/// Nodes that follow a reference node rigidly.
#[derive(Debug)]
pub struct RigidDefinition {
    /// Set of nodes, or of elements of which all nodes follow.
    pub set: String,
    /// Whether the set is one of elements.
    pub of_elements: bool,
    /// The reference node.
    pub node: Entry,
    /// CalculiX's node of which the displacements are the rotations.
    pub rotation_node: Option<Entry>,
    /// Where it stands.
    pub place: Place,
}

/// A linear relation between displacements: `sum coefficient * displacement = 0`.
#[derive(Debug)]
pub struct EquationDefinition {
    /// Its terms.
    pub terms: Vec<TermDefinition>,
    /// Where it stands.
    pub place: Place,
}

/// A term of an equation.
#[derive(Debug)]
pub struct TermDefinition {
    /// A node, or a set: then there is an equation for each of its nodes.
    pub of: Entry,
    /// Displacement, 1 to 3; rotation, 4 to 6.
    pub axis: u8,
    /// What it is multiplied by.
    pub coefficient: f64,
}

/// Kinds of [`PointConstraint`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConstraintKind {
    /// A rigid beam between two nodes.
    Beam,
    /// The same displacements.
    Same,
}

/// A multi-point constraint.
#[derive(Debug)]
pub struct PointConstraint {
    /// Its kind.
    pub kind: ConstraintKind,
    /// The node or set that follows, and the node or set that it follows.
    pub nodes: [Entry; 2],
    /// Where it stands.
    pub place: Place,
}

/// Local axes of supports, loads and equations.
#[derive(Debug)]
pub struct Transform {
    /// Set of the nodes.
    pub set: String,
    /// Whether the axes are radial, tangential and axial.
    pub is_cylindrical: bool,
    /// A point on the first axis, or on the axis of the cylinder.
    pub a: [f64; 3],
    /// A point in the plane of the first two axes, or another one on the axis of the cylinder.
    pub b: [f64; 3],
    /// Where it stands.
    pub place: Place,
}

/// Components of a connector: three displacements and three rotations.
pub const N_COMPONENTS: usize = 6;

/// What connector elements of a set do.
#[derive(Debug)]
pub struct ConnectorSection {
    /// Set of elements.
    pub set: String,
    /// Types, such as CARTESIAN and ROTATION.
    pub types: Vec<String>,
    /// Name of the behaviour.
    pub behaviour: Option<String>,
    /// Name of its axes.
    pub orientation: Option<String>,
    /// Where it stands.
    pub place: Place,
}

/// Elasticity and damping of connectors.
#[derive(Debug)]
pub struct ConnectorBehaviour {
    /// Its name.
    pub name: String,
    /// Force over displacement, moment over rotation, by component.
    pub elasticity: [f64; N_COMPONENTS],
    /// Force over velocity, moment over angular velocity, by component.
    pub damping: [f64; N_COMPONENTS],
    /// Where it begins.
    pub place: Place,
}
