//! Materials, laws of contact and what ties parts together.

use super::Entry;
use crate::model::Place;

/// A material.
#[derive(Debug)]
pub struct Material {
    /// Its name.
    pub name: String,
    /// Its elasticity.
    pub elastic: Option<Elastic>,
    /// Its density and the place of it.
    pub density: Option<(f64, Place)>,
    /// Damping proportional to mass.
    pub alpha: f64,
    /// Damping proportional to stiffness.
    pub beta: f64,
    /// Loss factor of structural damping.
    pub structural: f64,
    /// Where it begins.
    pub place: Place,
}

/// The constants below `*ELASTIC`, in the order of the deck.
#[derive(Debug)]
pub struct Elastic {
    /// Which constants they are.
    pub kind: ElasticKind,
    /// Their values.
    pub constants: Vec<f64>,
    /// Where they begin.
    pub place: Place,
}

/// Kinds of [`Elastic`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElasticKind {
    /// E, nu.
    Isotropic,
    /// E1, E2, E3, nu12, nu13, nu23, G12, G13, G23.
    EngineeringConstants,
    /// D1111, D1122, D2222, D1133, D2233, D3333, D1212, D1313, D2323.
    Orthotropic,
    /// The upper triangle by columns, in the order 11 22 33 12 13 23.
    Anisotropic,
}

impl ElasticKind {
    /// All kinds with their names and the numbers of their constants.
    pub const ALL: [(&'static str, ElasticKind, usize); 6] = [
        ("ISOTROPIC", ElasticKind::Isotropic, 2),
        ("ISO", ElasticKind::Isotropic, 2),
        ("ENGINEERINGCONSTANTS", ElasticKind::EngineeringConstants, 9),
        ("ORTHOTROPIC", ElasticKind::Orthotropic, 9),
        ("ORTHO", ElasticKind::Orthotropic, 9),
        ("ANISOTROPIC", ElasticKind::Anisotropic, 21),
    ];
}

/// A law of contact.
#[derive(Debug)]
pub struct Interaction {
    /// Its name.
    pub name: String,
    /// Pressure over overlap.
    pub behaviour: Behaviour,
    /// Whether the surfaces cannot part.
    pub no_separation: bool,
    /// Friction, if any.
    pub friction: Option<Friction>,
    /// Where it begins.
    pub place: Place,
}

/// Pressure as a function of the overlap.
#[derive(Debug, PartialEq)]
pub enum Behaviour {
    /// As stiff as the program finds right: HARD, or nothing said.
    Hard,
    /// Pressure over overlap.
    Linear(f64, Place),
    /// Pairs of pressure and overlap.
    Table(Vec<[f64; 2]>, Place),
    /// The surfaces move as one, with this stress over relative displacement.
    Tied(f64),
}

/// Coulomb friction.
#[derive(Debug, Clone)]
pub struct Friction {
    /// Coefficient; the static one, or the first of a table.
    pub coefficient: f64,
    /// How it depends on other things.
    pub dependence: Dependence,
    /// Tangential stress over slip while sticking.
    pub stick: Option<f64>,
    /// Where it stands.
    pub place: Place,
}

/// How a friction coefficient depends on other things.
#[derive(Debug, Clone, PartialEq)]
pub enum Dependence {
    /// Not at all.
    None,
    /// It falls with the slip rate v: `mu_k + (mu_s - mu_k) exp(-d v)`.
    Decay {
        /// `mu_k`
        kinetic: f64,
        /// d
        decay: f64,
    },
    /// Rows of coefficient, slip rate, pressure and temperature.
    Table(Vec<[f64; 4]>),
}

/// A contact pair.
#[derive(Debug)]
pub struct ContactPair {
    /// Name of the slave surface.
    pub slave: String,
    /// Name of the master surface.
    pub master: String,
    /// Name of the interaction.
    pub interaction: String,
    /// Which part of the slave starts in contact, if any.
    pub adjust: Option<Adjust>,
    /// Whether the surfaces move as one.
    pub tied: bool,
    /// Where it stands.
    pub place: Place,
}

/// Which part of a slave starts in contact.
#[derive(Debug, Clone, PartialEq)]
pub enum Adjust {
    /// Where the gap is this or less.
    Within(f64),
    /// The nodes of the set of this name.
    Nodes(String),
}

/// The initial gap of a contact pair, in place of the mesh's.
#[derive(Debug)]
pub struct Clearance {
    /// Name of the slave surface.
    pub slave: String,
    /// Name of the master surface.
    pub master: String,
    /// The gap.
    pub value: f64,
    /// Where it stands.
    pub place: Place,
}

/// A surface that follows a reference node.
#[derive(Debug)]
pub struct Coupling {
    /// Number of the reference node, or a set of it.
    pub node: Entry,
    /// The surface.
    pub surface: String,
    /// Whether the surface is rigid, rather than following on average.
    pub is_kinematic: bool,
    /// Which displacements and rotations (1 to 6) it couples; none named: all.
    pub dofs: Vec<[u8; 2]>,
    /// Where it stands.
    pub place: Place,
}
