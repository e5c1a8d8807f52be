//! What explains a mode, source by source: parts, joints, contact pairs.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::stability::{Sensitivity, Share};

/// What a source of energy, damping and stiffness is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A part of the mesh.
    #[default]
    Part,
    /// A connector.
    Connector,
    /// A tie of two surfaces.
    Tie,
    /// A rigid set.
    Rigid,
    /// An equation.
    Equation,
    /// A point mass.
    Mass,
    /// A contact pair.
    Contact,
    /// What no part and no contact pair of a super-element has: its joints, and contacts that were linearised.
    Rest,
}

impl Kind {
    /// Whether its stiffness is no property of the brake that could be changed: a penalty, or a sum of several.
    pub fn is_fixed(self) -> bool {
        matches!(self, Kind::Tie | Kind::Rigid | Kind::Equation | Kind::Rest)
    }
}

/// A part, joint or contact pair and its role in a mode.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// What it is.
    pub kind: Kind,
    /// Its name in the model.
    pub name: String,
    /// Its shares of the energies, its energy input and dissipation.
    pub share: Share,
    /// How the eigenvalue follows it, where the left vector is known.
    pub sensitivity: Option<Sensitivity>,
    /// How the eigenvalue follows a contact pair's friction at this equilibrium, `d lambda / d mu`, 1/s.
    pub friction: Option<Complex64>,
}
