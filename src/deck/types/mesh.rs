//! Nodes, elements, sets and sections.

use crate::deck::elements::ElementKind;
use crate::model::Place;

/// Nodes, elements and what is defined on them, in numbers of its own.
#[derive(Debug, Default)]
pub struct Scope {
    /// Name of the part; empty outside parts.
    pub name: String,
    /// Where it begins.
    pub place: Place,
    /// Nodes.
    pub nodes: Nodes,
    /// Elements, a block for each `*ELEMENT`.
    pub elements: Vec<ElementBlock>,
    /// Sets of nodes; those of one name belong together.
    pub node_sets: Vec<SetDefinition>,
    /// Sets of elements; those of one name belong together.
    pub element_sets: Vec<SetDefinition>,
    /// Surfaces.
    pub surfaces: Vec<SurfaceDefinition>,
    /// Sections.
    pub sections: Vec<Section>,
    /// Axes of materials.
    pub orientations: Vec<Orientation>,
    /// Properties of springs, dashpots and masses.
    pub properties: Vec<Property>,
}

/// Numbers, coordinates and places of nodes.
#[derive(Debug, Default)]
pub struct Nodes {
    /// Their numbers in the deck.
    pub numbers: Vec<u32>,
    /// Their coordinates.
    pub coordinates: Vec<[f64; 3]>,
    /// Where they stand.
    pub places: Vec<Place>,
}

/// Elements of one kind.
#[derive(Debug)]
pub struct ElementBlock {
    /// Their kind.
    pub kind: &'static ElementKind,
    /// Their numbers in the deck.
    pub numbers: Vec<u32>,
    /// Numbers of their nodes, element by element.
    pub nodes: Vec<u32>,
    /// Where they stand.
    pub places: Vec<Place>,
}

/// A part of a set.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// One node or element.
    Number(u32),
    /// First, last and step of a range.
    Range(u32, u32, u32),
    /// All of another set, or `INSTANCE.NUMBER`.
    Name(Box<str>),
}

/// A set of nodes or elements, or what is added to it.
#[derive(Debug)]
pub struct SetDefinition {
    /// Its name.
    pub name: String,
    /// The instance whose numbers its entries are.
    pub instance: Option<String>,
    /// Its entries with their places.
    pub entries: Vec<(Entry, Place)>,
    /// Where it begins.
    pub place: Place,
}

/// Faces of elements, or nodes.
#[derive(Debug)]
pub struct SurfaceDefinition {
    /// Its name.
    pub name: String,
    /// Whether it consists of nodes.
    pub of_nodes: bool,
    /// The instance whose numbers and sets its items are.
    pub instance: Option<String>,
    /// Its items.
    pub items: Vec<SurfaceItem>,
    /// Where it begins.
    pub place: Place,
}

/// Faces of an element or of the elements of a set; nodes of a set.
#[derive(Debug)]
pub struct SurfaceItem {
    /// Number or name.
    pub of: Entry,
    /// Face, from 1; none: all faces on the skin.
    pub face: Option<u8>,
    /// Where it stands.
    pub place: Place,
}

/// The material of elements.
#[derive(Debug)]
pub struct Section {
    /// Set of elements.
    pub set: String,
    /// Name of the material.
    pub material: String,
    /// Name of the orientation.
    pub orientation: Option<String>,
    /// Where it stands.
    pub place: Place,
}

/// Axes of a material.
#[derive(Debug)]
pub struct Orientation {
    /// Its name.
    pub name: String,
    /// Whether the axes depend on the position.
    pub is_cylindrical: bool,
    /// A point on the first axis.
    pub a: [f64; 3],
    /// A point in the plane of the first two axes.
    pub b: [f64; 3],
    /// Where it stands.
    pub place: Place,
}

/// What springs, dashpots or masses of a set do.
#[derive(Debug)]
pub struct Property {
    /// What it is.
    pub kind: PropertyKind,
    /// Set of elements.
    pub set: String,
    /// Displacements (1 to 6) of the two ends; none for a spring along its line.
    pub dofs: Option<[u8; 2]>,
    /// Its constant, for a spring with the imaginary stiffness behind; the components 11, 22, 33, 12, 13, 23 of a
    /// rotary inertia.
    pub values: [f64; 6],
    /// Name of the axes along which it acts.
    pub orientation: Option<String>,
    /// Where it stands.
    pub place: Place,
}

/// Kinds of [`Property`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PropertyKind {
    /// Force over elongation.
    Spring,
    /// Force over velocity.
    Dashpot,
    /// Mass of a node.
    Mass,
    /// Rotary inertia of a node.
    RotaryInertia,
}

/// A part with its place in the assembly.
#[derive(Debug)]
pub struct Instance {
    /// Its name.
    pub name: String,
    /// Name of the part.
    pub part: String,
    /// Displacement, before the rotation.
    pub translation: [f64; 3],
    /// Rotation, if any.
    pub rotation: Option<Turn>,
    /// What is defined in the instance, beside the part.
    pub own: Scope,
    /// Where it begins.
    pub place: Place,
}

/// A rotation about an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// A point of the axis.
    pub from: [f64; 3],
    /// Another point of the axis, which gives its direction.
    pub to: [f64; 3],
    /// Angle, degrees, right-handed.
    pub degrees: f64,
}
