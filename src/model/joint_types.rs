//! What joins parts and adds to them, once it has been checked: connectors, ties, rigid sets, point masses, equations.

use nalgebra::Matrix6;
use serde::{Deserialize, Serialize};

use super::Place;
use super::elasticity::is_positive_semidefinite;

/// What a connector names as its other end where that does not move; a node set of this name comes first.
pub const GROUND: &str = "ground";

/// Spring and damper between the rigid motions that two node sets make on average, or of one set and the ground.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Connector {
    /// Name in tables.
    pub name: String,
    /// The two node sets; one of them may be [`GROUND`].
    pub between: [String; 2],
    /// The common reference point, m; the middle of the two centroids where the file does not say.
    pub at: Option<[f64; 3]>,
    /// Unit vectors of its axes x, y, z, where they are not the mesh's.
    pub axes: Option<[[f64; 3]; 3]>,
    /// Translational stiffness by axis, N/m.
    pub stiffness: [f64; 3],
    /// Rotational stiffness by axis, N m/rad.
    pub rotational_stiffness: [f64; 3],
    /// Translational damping by axis, N s/m.
    pub damping: [f64; 3],
    /// Loss factor `g` of both stiffnesses: structural damping.
    pub loss_factor: f64,
    /// Where it stands.
    pub place: Place,
}

/// Two surfaces that move as one, also where their meshes do not match.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Tie {
    /// Name in tables.
    pub name: String,
    /// Surface on which the tied points lie.
    pub slave: String,
    /// Surface that they follow.
    pub master: String,
    /// Points farther than this from the master are not tied, m.
    pub search_distance: Option<f64>,
    /// Penalty stiffness, N/m3; by the neighbouring elements where the file does not say.
    pub stiffness: Option<f64>,
    /// Where it stands.
    pub place: Place,
}

/// A node set that moves rigidly.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RigidSet {
    /// Name in tables.
    pub name: String,
    /// Physical surface or node set.
    pub nodes: String,
    /// Where it stands.
    pub place: Place,
}

/// A rigid mass without a mesh that follows the mean motion of a node set.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PointMass {
    /// Name in tables.
    pub name: String,
    /// Physical surface or node set.
    pub nodes: String,
    /// Its centre of mass, m; the set's centroid where the file does not say.
    pub at: Option<[f64; 3]>,
    /// Mass, kg.
    pub mass: f64,
    /// Inertia tensor about the centre of mass, kg m2: xx, yy, zz, xy, yz, zx, such that the kinetic energy of a
    /// rotation is `w^T I w / 2`.
    pub inertia: [f64; 6],
    /// Where it stands.
    pub place: Place,
}

impl PointMass {
    /// What is wrong with an inertia that is not [possible](PointMass::is_possible).
    pub const NEGATIVE_MOMENT: &str = "inertia has a negative principal moment";

    /// Whether an inertia has no negative principal moment. That of a thin rod, 0 about its axis, is possible.
    pub fn is_possible(inertia: [f64; 6]) -> bool {
        is_positive_semidefinite(&PointMass::matrix(0.0, inertia))
    }

    /// The 6x6 mass (kg, kg m2) of a rigid body of this mass and inertia about its centre of mass.
    pub fn matrix(mass: f64, [xx, yy, zz, xy, yz, zx]: [f64; 6]) -> Matrix6<f64> {
        let mut matrix = Matrix6::from_diagonal(&[mass, mass, mass, xx, yy, zz].into());
        for (i, j, product) in [(3, 4, xy), (4, 5, yz), (5, 3, zx)] {
            (matrix[(i, j)], matrix[(j, i)]) = (product, product);
        }
        matrix
    }
}

/// A linear relation between displacements, `sum_k a_k u_k = 0`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Equation {
    /// Name in tables.
    pub name: String,
    /// Its terms, two at least.
    pub terms: Vec<EquationTerm>,
    /// Where it stands.
    pub place: Place,
}

/// One displacement of an equation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EquationTerm {
    /// A node set of one node.
    pub node: String,
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// `a_k`, not zero.
    pub coefficient: f64,
}
