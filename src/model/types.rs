//! What the model file says once it has been checked: names resolved within the file, SI units.

use std::fmt::Display;
use std::path::PathBuf;

use nalgebra::Matrix6;
use serde::{Deserialize, Serialize};

use super::elasticity::youngs;
use super::friction::FrictionCurve;
use super::gap_field::{GapField, StiffnessField};
use super::viscoelastic::ViscoelasticLaw;
use super::{Connector, Equation, InstabilityCriterion, Place, PointMass, RigidSet, Tie, names, paths};
use crate::algebra::{cross, scale, sub};
use crate::element::ElementKind;
use crate::{Error, Result};

/// Everything the user states about a brake, in SI units. Names of the mesh are still names here.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Model {
    /// The model file itself; names in messages refer to it.
    #[serde(with = "paths::one")]
    pub file: PathBuf,
    /// The files that places are in: the model file, and those of a deck.
    #[serde(with = "paths::many")]
    pub files: Vec<PathBuf>,
    /// A line for titles.
    pub title: String,
    /// The mesh file (absolute, or relative to the current directory).
    #[serde(with = "paths::one")]
    pub mesh_file: PathBuf,
    /// Metres per unit of the mesh file.
    pub mesh_unit: f64,
    /// The system of units of the mesh's file, where that is a deck and the system is named.
    pub unit_system: Option<String>,
    /// Where the mesh is named.
    pub mesh_place: Place,
    /// Parts, in the order of the file.
    pub parts: Vec<Part>,
    /// Fixed displacements.
    pub fixes: Vec<Fix>,
    /// Imposed velocity fields.
    pub rotations: Vec<Rotation>,
    /// Contact pairs.
    pub contacts: Vec<Contact>,
    /// Springs and dampers between mean motions.
    pub connectors: Vec<Connector>,
    /// Surfaces that move as one.
    pub ties: Vec<Tie>,
    /// Node sets that move rigidly.
    pub rigid_sets: Vec<RigidSet>,
    /// Masses without a mesh.
    pub masses: Vec<PointMass>,
    /// Linear relations between displacements.
    pub equations: Vec<Equation>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Frequency band of the modes wanted, Hz.
    pub band: [f64; 2],
    /// Whether friction that turns with the velocity damps the modes.
    pub friction_damping: bool,
    /// Whether the stress of the equilibrium stiffens the modes; where the file does not say, [`Model::has_prestress`].
    pub prestress: Option<bool>,
    /// What counts as an unstable mode.
    pub criterion: InstabilityCriterion,
    /// Names of the contacts whose friction a sweep changes (all sliding pairs where the file does not say).
    pub swept: Vec<String>,
    /// Friction values of the sweep (empty: as in the contacts).
    pub frictions: Vec<f64>,
    /// Where the sweep stands (line 0: there is none).
    pub sweep_place: Place,
    /// Contact reduction and super-element, where the file asks for them.
    pub reduction: Option<Reduction>,
}

impl Model {
    /// `file:line: message`.
    ///
    /// # Panics
    /// Where the place is in no file of the model.
    pub fn error(&self, place: Place, message: impl Display) -> Error {
        place.error(&self.files, message)
    }

    /// Whether anything takes energy out of its motions.
    pub fn is_damped(&self) -> bool {
        self.friction_damping
            || self.parts.iter().any(|part| part.rayleigh != Rayleigh::default())
            || self.connectors.iter().any(|connector| connector.damping != [0.0; 3])
            || self.has_structural_damping()
            || self.viscoelastic_part().is_some()
    }

    /// Whether modes have the geometric stiffness of the equilibrium: as the file says, else where a rotation has
    /// inertia.
    pub fn has_prestress(&self) -> bool {
        self.prestress.unwrap_or(self.rotations.iter().any(|rotation| rotation.inertia != Inertia::None))
    }

    /// Whether a material or a connector has a loss factor.
    pub fn has_structural_damping(&self) -> bool {
        self.parts.iter().any(|part| part.material.loss_factor != 0.0)
            || self.connectors.iter().any(|connector| connector.loss_factor != 0.0)
    }

    /// The first part with a viscoelastic material, where there is one.
    pub fn viscoelastic_part(&self) -> Option<&Part> {
        self.parts.iter().find(|part| part.material.viscoelastic.is_some())
    }

    /// Refuses a viscoelastic material for what has one stiffness whatever the frequency. `what` says what that is, as
    /// "the matrices written have one stiffness whatever the frequency".
    ///
    /// # Errors
    /// [`Error::Input`] that names part and material.
    pub fn require_no_viscoelastic(&self, what: &str) -> Result<()> {
        let Some(Part { name, material, place, .. }) = self.viscoelastic_part() else { return Ok(()) };
        let advice = "Give the material a young and a loss_factor at the frequency of interest";
        let message =
            format_args!("{what}, and the material {:?} of the part {name:?} is viscoelastic. {advice}", material.name);
        Err(self.error(*place, message))
    }

    /// The model of one part alone, which nothing constrains, touches or loads, so that there is nothing to sweep
    /// either.
    ///
    /// # Errors
    /// [`Error::Input`] where there is no such part.
    pub fn only(mut self, part: &str) -> Result<Model> {
        let names = self.parts.iter().map(|part| part.name.as_str());
        if !names.clone().any(|name| name == part) {
            let advice = names::advice(part, names);
            return Err(Error::input(format!("{}: no part is called {part:?}. {advice}", self.file.display())));
        }
        self.parts.retain(|own| own.name == part);
        self.fixes.clear();
        self.rotations.clear();
        self.contacts.clear();
        self.connectors.clear();
        self.ties.clear();
        self.rigid_sets.clear();
        self.masses.clear();
        self.equations.clear();
        self.loads.clear();
        self.swept.clear();
        self.frictions.clear();
        self.sweep_place = Place::default();
        self.reduction = None;
        Ok(self)
    }
}

/// A physical volume with its material.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Part {
    /// Name of the physical volume.
    pub name: String,
    /// Its material.
    pub material: Material,
    /// Mass- and stiffness-proportional damping, `C = alpha M + beta K` (1/s, s).
    pub rayleigh: Rayleigh,
    /// Kinds of its elements, one for each shape at most; elements of other shapes are of the kind that the mesh has.
    pub elements: Vec<ElementKind>,
    /// Where it stands.
    pub place: Place,
}

/// A linear elastic material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Name in the model file.
    pub name: String,
    /// Density, kg/m3.
    pub density: f64,
    /// Elasticity, Pa, row-major, in Voigt order xx yy zz xy yz zx with engineering shear strains, in global axes.
    pub elasticity: [[f64; 6]; 6],
    /// Loss factor `g` of structural damping: the stiffness is `K (1 + i g)`.
    pub loss_factor: f64,
    /// How the stiffness depends on frequency, where it does: the elasticity is then that at rest.
    pub viscoelastic: Option<ViscoelasticLaw>,
}

impl Material {
    /// The smallest and the largest of the three Young's moduli, Pa.
    pub fn youngs(&self) -> [f64; 2] {
        youngs(&Matrix6::from_fn(|i, j| self.elasticity[i][j]))
    }
}

/// Coefficients of proportional damping.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Rayleigh {
    /// Mass coefficient, 1/s.
    pub alpha: f64,
    /// Stiffness coefficient, s.
    pub beta: f64,
}

/// Displacements held at zero.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Fix {
    /// Physical surface, curve or point.
    pub nodes: String,
    /// Which of x, y, z.
    pub axes: [bool; 3],
    /// What the displacements are in the equilibrium, m; zero along the axes that are free.
    pub displacement: [f64; 3],
    /// Where it stands.
    pub place: Place,
}

impl Fix {
    /// Whether it prescribes a displacement other than zero.
    pub fn moves(&self) -> bool {
        self.displacement != [0.0; 3]
    }
}

/// Rigid rotation imposed on the velocity of a part.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Rotation {
    /// The turning part.
    pub part: String,
    /// Unit vector of the axis.
    pub axis: [f64; 3],
    /// A point of the axis, m.
    pub through: [f64; 3],
    /// Speed, rad/s, right-handed about the axis.
    pub speed: f64,
    /// The inertia forces of the rotation.
    pub inertia: Inertia,
    /// Where it stands.
    pub place: Place,
}

impl Rotation {
    /// Velocity (m/s) that the rotation has at a point (m): `Omega x (x - x_0)`.
    pub fn velocity(&self, x: [f64; 3]) -> [f64; 3] {
        cross(self.angular_velocity(), sub(x, self.through))
    }

    /// `Omega`, rad/s.
    pub fn angular_velocity(&self) -> [f64; 3] {
        scale(self.speed, self.axis)
    }
}

/// Which inertia forces of its rotation a part has, and how its motion is described.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "expected \"none\", \"fixed_frame\" or \"rotating_frame\"")]
pub enum Inertia {
    /// None: the part turns slowly against its vibrations.
    #[default]
    None,
    /// Those of a solid of revolution about the axis, seen from the fixed frame: its material flows through the mesh.
    FixedFrame,
    /// Those of a rotor, seen from a frame that turns with it, together with its mesh, supports and loads.
    RotatingFrame,
}

/// A contact pair.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Contact {
    /// Name in tables.
    pub name: String,
    /// Surface on which the contact points lie.
    pub slave: String,
    /// Physical surface that they meet.
    pub master: String,
    /// Normal law; none where the program is to propose one ([`Model::normal_law`]).
    pub law: Option<NormalLaw>,
    /// Coefficient of friction: the static one, or a table's first, where it depends on anything.
    pub friction: f64,
    /// How the coefficient depends on sliding speed and pressure, where it does.
    pub friction_curve: Option<FrictionCurve>,
    /// Elastic stick, N/m3; none on pairs that slide for ever, and where it is to be proposed ([`Model::stick`]).
    pub stick: Option<f64>,
    /// Whether the pair may open.
    pub separation: bool,
    /// Points farther than this from the master are dropped, m.
    pub search_distance: Option<f64>,
    /// Initial gaps up to this are closed, m.
    pub adjust: f64,
    /// Initial gap of all points in place of the mesh's, m; below 0 an overlap.
    pub clearance: Option<f64>,
    /// Added to the initial gap, point by point: a measured topography, or what is worn off.
    pub gap_field: Option<GapField>,
    /// Multiplies the normal law, point by point.
    pub stiffness_field: Option<StiffnessField>,
    /// Archard's coefficient `k/H`, m2/N: depth worn off by pressure and sliding distance.
    pub wear: Option<f64>,
    /// Where it stands.
    pub place: Place,
}

/// Pressure as a function of penetration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum NormalLaw {
    /// `p = w k_n d`, k_n in N/m3.
    Linear {
        /// Penalty stiffness, N/m3.
        stiffness: f64,
    },
    /// `p = w (k_1 d + k_3 d^3)`.
    Cubic {
        /// Linear coefficient, N/m3.
        k1: f64,
        /// Cubic coefficient, N/m5.
        k3: f64,
    },
    /// `p = w P(d)`, linear between the rows of a table and beyond them.
    Table {
        /// Rising penetrations (m) with their rising pressures (Pa); the first pressure is 0.
        rows: Vec<[f64; 2]>,
    },
}

impl NormalLaw {
    /// A factor times the law: a law of forces (N/m, N/m3) divided by an area (m2) is one of pressures.
    pub fn times(&self, factor: f64) -> NormalLaw {
        match *self {
            NormalLaw::Linear { stiffness } => NormalLaw::Linear { stiffness: factor * stiffness },
            NormalLaw::Cubic { k1, k3 } => NormalLaw::Cubic { k1: factor * k1, k3: factor * k3 },
            NormalLaw::Table { ref rows } => {
                NormalLaw::Table { rows: rows.iter().map(|[d, p]| [*d, factor * p]).collect() }
            }
        }
    }

    /// Pressure (Pa) and its slope (N/m3) at the penetration d (m), on both sides of the first contact.
    pub fn at(&self, d: f64) -> [f64; 2] {
        match *self {
            NormalLaw::Linear { stiffness: k } => [k * d, k],
            NormalLaw::Cubic { k1, k3 } => [k1 * d + k3 * d.powi(3), k1 + 3.0 * k3 * d.powi(2)],
            NormalLaw::Table { ref rows } => {
                let above = rows.partition_point(|row| row[0] <= d).clamp(1, rows.len() - 1);
                let ([d0, p0], [d1, p1]) = (rows[above - 1], rows[above]);
                let slope = (p1 - p0) / (d1 - d0);
                [p0 + slope * (d - d0), slope]
            }
        }
    }

    /// The penetration (m) from which on there is pressure: 0, or that of a table's first row.
    pub fn onset(&self) -> f64 {
        if let NormalLaw::Table { rows } = self { rows[0][0] } else { 0.0 }
    }

    /// The slope where the pressure begins, N/m3.
    pub fn initial_stiffness(&self) -> f64 {
        self.at(self.onset())[1]
    }
}

/// An external load.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Load {
    /// Name in tables.
    pub name: String,
    /// Physical surface or node set; of gravity a part or point mass, empty for all of them.
    pub on: String,
    /// What acts.
    pub kind: LoadKind,
    /// Where it stands.
    pub place: Place,
}

/// The kinds of load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum LoadKind {
    /// A total force (N), the same on each node.
    ForceByNode([f64; 3]),
    /// A total force (N), spread as a uniform traction.
    ForceByArea([f64; 3]),
    /// A force (N) and a moment (N m) at a point (m; the set's centroid where the file does not say), spread over the
    /// nodes without stiffening them.
    ForceAt {
        /// Force, N.
        force: [f64; 3],
        /// Moment about the point, N m.
        moment: [f64; 3],
        /// The point, m.
        at: Option<[f64; 3]>,
    },
    /// Pressure (Pa), positive into the body.
    Pressure(f64),
    /// The weight of parts and point masses in this acceleration (m/s2).
    Gravity([f64; 3]),
}

/// How the structure is reduced to a super-element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reduction {
    /// Number of reference pairs over all sliding contacts together.
    pub contacts: usize,
    /// Band of the fixed-interface modes that are kept, Hz.
    pub band: [f64; 2],
    /// Where it stands.
    pub place: Place,
}
