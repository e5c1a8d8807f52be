//! What a deck says, keyword by keyword, in its own units, numbers and names; every datum has its place.
//!
//! Names are in capital letters, as both programs compare them; [`Deck::spelled`] gives them back as they were first
//! written.

mod constraints;
mod history;
mod mesh;
mod physics;

use std::collections::HashMap;
use std::path::PathBuf;

pub use constraints::{
    ConnectorBehaviour, ConnectorSection, ConstraintKind, EquationDefinition, N_COMPONENTS, PointConstraint,
    RigidDefinition, TermDefinition, TieDefinition, Transform,
};
pub use history::{Action, ActionKind, Ignored, NothingKind, Procedure, Spin, Step};
pub use mesh::{
    ElementBlock, Entry, Instance, Nodes, Orientation, Property, PropertyKind, Scope, Section, SetDefinition,
    SurfaceDefinition, SurfaceItem, Turn,
};
pub use physics::{
    Adjust, Behaviour, Clearance, ContactPair, Coupling, Dependence, Elastic, ElasticKind, Friction, Interaction,
    Material,
};

/// A deck.
#[derive(Debug, Default)]
pub struct Deck {
    /// The deck and the files that it includes.
    pub files: Vec<PathBuf>,
    /// Lines in all files.
    pub n_lines: usize,
    /// The first line below `*HEADING`.
    pub title: Option<String>,
    /// What stands outside parts and instances: all of a deck without `*PART`.
    pub assembly: Scope,
    /// The parts.
    pub parts: Vec<Scope>,
    /// The instances of the parts.
    pub instances: Vec<Instance>,
    /// The materials.
    pub materials: Vec<Material>,
    /// Last values of the amplitudes, by name.
    pub amplitudes: HashMap<String, f64>,
    /// Laws of contact.
    pub interactions: Vec<Interaction>,
    /// Contact pairs.
    pub contact_pairs: Vec<ContactPair>,
    /// Initial gaps of contact pairs.
    pub clearances: Vec<Clearance>,
    /// Couplings of a reference node.
    pub couplings: Vec<Coupling>,
    /// Surfaces that move as one.
    pub ties: Vec<TieDefinition>,
    /// Nodes that follow a reference node rigidly.
    pub rigid_bodies: Vec<RigidDefinition>,
    /// Linear relations between displacements.
    pub equations: Vec<EquationDefinition>,
    /// Multi-point constraints.
    pub point_constraints: Vec<PointConstraint>,
    /// Local axes of supports, loads and equations.
    pub transforms: Vec<Transform>,
    /// What connector elements do.
    pub connector_sections: Vec<ConnectorSection>,
    /// Elasticity and damping of connectors.
    pub connector_behaviours: Vec<ConnectorBehaviour>,
    /// Supports, loads and motions outside steps.
    pub initial: Vec<Action>,
    /// The steps.
    pub steps: Vec<Step>,
    /// Keywords that change no result, with their first places, in the order of the deck.
    pub ignored: Vec<Ignored>,
    /// What a reader should know: how a keyword was understood.
    pub notes: Vec<String>,
    /// The first spelling of each name.
    pub spellings: HashMap<String, String>,
}

impl Deck {
    /// A name as it was first written.
    pub fn spelled(&self, name: &str) -> String {
        let parts: Vec<&str> =
            name.split('.').map(|part| self.spellings.get(part).map_or(part, String::as_str)).collect();
        self.spellings.get(name).cloned().unwrap_or_else(|| parts.join("."))
    }
}
