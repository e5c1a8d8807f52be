//! A super-element: a brake that has become one element with some hundred coordinates and node-to-node contacts.
//!
//! ```text
//! coordinates  [ slave points | master points | loaded points | fixed-interface modes | residual modes ]
//!              three a point, one a mode
//! nodes        three coordinates each, the last one filled up with constrained ones; coordinates that cannot move
//!              are constrained, too
//! contact      g_i = q_slave,i - q_master,i                                                   B = [I -I 0 0]
//! ```
//!
//! A Galerkin super-element ([`super::galerkin`]) has none of these coordinates, but those of a basis V: `u = V q`, and
//! every contact point of the full model moves with all of them, `B_r = B V`.
//!
//! It enters the assembly as an element among elements and its contacts are an [`Interface`], so everything above is
//! the full model's. Where the law of the contacts is another one than the full model's, the penetration of each gets a
//! correction xi so that at the full model's equilibrium it gives the full model's force: `p(d + xi) = p_full` (Fazio,
//! Nacivet, Sinou, eq. 11 and 12).

use crate::assembly::System;
use crate::contact::interface::ContactPair;
use crate::contact::{ContactPoint, GapOperator, Interface};
use crate::mesh::Numbering;
use crate::model::viscoelastic::ViscoelasticLaw;
use crate::model::{InstabilityCriterion, NormalLaw};
use crate::native::{Comm, Matrix};
use crate::{Error, Result};

use super::craig_bampton::{Reduced, Structure};
use super::made_for::MadeFor;
use super::member::Members;
use super::parts::PartMatrices;

/// Where a super-element comes from.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Origin {
    /// Title of the model.
    pub title: String,
    /// The model file.
    pub model: String,
    /// The mesh file.
    pub mesh: String,
    /// SHA-256 of its bytes.
    #[serde(rename = "mesh_sha256")]
    pub mesh_hash: String,
    /// The program and its version.
    pub program: String,
    /// Friction of the swept pairs at the equilibrium that it was made about.
    pub friction: f64,
    /// Free dofs of the full model.
    #[serde(rename = "dofs_of_the_model")]
    pub n_dofs: usize,
    /// Band that the model analyses, Hz.
    #[serde(rename = "band_hz")]
    pub band: [f64; 2],
    /// Fixed-interface modes are kept below this, Hz.
    #[serde(rename = "limit_hz")]
    pub limit: f64,
    /// Whether friction that turns with the velocity damps the modes.
    pub friction_damping: bool,
    /// Where modes of the full model were taken, of a Galerkin super-element.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub samples: Vec<Sample>,
    /// What counts as an unstable mode.
    #[serde(rename = "unstable", default)]
    pub criterion: InstabilityCriterion,
    /// Friction coefficient of the equilibrium whose geometric stiffness it has, where it has one.
    #[serde(rename = "prestress_at_friction", default, skip_serializing_if = "Option::is_none")]
    pub prestress_friction: Option<f64>,
    /// Other moduli and densities that the basis is made for, where there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made_for: Option<MadeFor>,
}

/// A state of the full model at which a Galerkin super-element has its equilibrium and modes.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sample {
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// Factor on the loads.
    pub pressure: f64,
    /// Factor on the normal stiffness of the swept pairs.
    pub contact_stiffness: f64,
}

impl Sample {
    /// At a friction value, under the model's own loads and contact stiffness.
    pub fn at(friction: f64) -> Sample {
        Sample { friction, pressure: 1.0, contact_stiffness: 1.0 }
    }
}

/// How the relative displacements `g = B_r q` at the contacts follow from the coordinates.
#[derive(Debug, Clone, PartialEq)]
pub enum ContactMotion {
    /// Slave points against master points, which are the first coordinates: `B_r = [I -I 0 0]`.
    Nodes,
    /// The entries of `B_r` by rows: three rows a contact, one entry a coordinate.
    Rows(Vec<f64>),
}

/// A contact between a slave point and a master point, with the full model's equilibrium there.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeContact {
    /// Pair, position and law.
    pub point: ContactPoint,
    /// Relative displacement at the equilibrium, m.
    pub displacement: [f64; 3],
    /// Normal force there, N.
    pub normal_force: f64,
}

/// The stiffness of all parts whose materials have the same viscoelastic law.
#[derive(Debug, Clone, PartialEq)]
pub struct ViscoelasticTerm {
    /// r.
    pub law: ViscoelasticLaw,
    /// At rest, N/m, part of the whole stiffness.
    pub stiffness: Vec<f64>,
}

/// The reduced brake.
#[derive(Debug, Clone)]
pub struct SuperElement {
    /// Where it comes from.
    pub origin: Origin,
    /// The text of the model file, by whose keys a study changes it; of a deck there is none.
    pub model_text: Option<String>,
    /// Positions of the retained points, m: slaves, masters, loads.
    pub points: Vec<[f64; 3]>,
    /// Frequencies of the fixed-interface modes, Hz.
    pub frequencies: Vec<f64>,
    /// Mass, column-major, of as many rows as there are coordinates.
    pub mass: Vec<f64>,
    /// Damping.
    pub damping: Vec<f64>,
    /// Stiffness without the contacts, of viscoelastic materials that at rest.
    pub stiffness: Vec<f64>,
    /// What of it depends on the frequency: a term for each viscoelastic law.
    pub viscoelastic: Vec<ViscoelasticTerm>,
    /// Geometric stiffness of one equilibrium ([`Origin::prestress_friction`]), which modes have and equilibria do not.
    pub geometric_stiffness: Option<Vec<f64>>,
    /// Structural damping, where a stiffness has a loss factor.
    pub structural_damping: Option<Vec<f64>>,
    /// What each part adds to these matrices.
    pub parts: Vec<PartMatrices>,
    /// What else adds to them, in words; none where there is nothing else.
    pub rest: Option<String>,
    /// Generalised forces of the loads that a load factor multiplies.
    pub load: Vec<f64>,
    /// Generalised forces of all other loads, and of the contacts that were linearised.
    pub preload: Vec<f64>,
    /// The pairs whose contacts are kept: the sliding ones, or all.
    pub pairs: Vec<ContactPair>,
    /// Their contacts, pair by pair.
    pub contacts: Vec<NodeContact>,
    /// How the contacts move.
    pub motion: ContactMotion,
}

impl SuperElement {
    /// Puts together what was reduced, with what the parts add to it; `loaded` are the positions of the load points.
    /// Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        origin: Origin,
        structure: &Structure,
        reduced: &Reduced,
        parts: Vec<PartMatrices>,
        loaded: &[[f64; 3]],
    ) -> Result<SuperElement> {
        let interface = structure.interface;
        let gaps = crate::equilibrium::Contacts::new(interface, structure.system)?.gaps(&structure.equilibrium.u)?;
        let (mut pairs, mut contacts): (Vec<ContactPair>, Vec<NodeContact>) = (Vec::new(), Vec::new());
        for pair in interface.pairs.iter().filter(|pair| pair.is_sliding()) {
            let first = contacts.len();
            for a in pair.points.clone() {
                let nodes = vec![contacts.len() as u32];
                let point = ContactPoint { pair: pairs.len(), nodes, ..interface.points[a].clone() };
                let normal_force = structure.equilibrium.responses[a].normal_force;
                contacts.push(NodeContact { point, displacement: gaps[a], normal_force });
            }
            pairs.push(ContactPair { points: first..contacts.len(), ..pair.clone() });
        }
        let slaves = contacts.iter().map(|contact| contact.point.position);
        // The partner is where the reference node projects: a gap away.
        let masters = contacts.iter().map(|NodeContact { point, .. }| {
            std::array::from_fn(|i| point.position[i] - point.law.gap * point.law.normal[i])
        });
        Ok(SuperElement {
            origin,
            model_text: None,
            points: slaves.chain(masters).chain(loaded.iter().copied()).collect(),
            frequencies: reduced.frequencies.clone(),
            mass: reduced.matrices.m.as_slice().to_vec(),
            damping: reduced.matrices.c.transpose().as_slice().to_vec(),
            stiffness: reduced.matrices.k.as_slice().to_vec(),
            viscoelastic: reduced.viscoelastic.clone(),
            geometric_stiffness: None,
            structural_damping: reduced.matrices.g.as_ref().map(|g| g.as_slice().to_vec()),
            parts,
            rest: Some("joints and other contacts".into()),
            load: reduced.load.clone(),
            preload: reduced.preload.clone(),
            pairs,
            contacts,
            motion: ContactMotion::Nodes,
        })
    }

    /// Whether the coordinates are those of a Galerkin basis.
    pub fn is_galerkin(&self) -> bool {
        matches!(self.motion, ContactMotion::Rows(_))
    }

    /// Number of coordinates.
    pub fn n_coordinates(&self) -> usize {
        self.load.len()
    }

    /// Number of residual modes among the coordinates.
    pub fn n_residual_modes(&self) -> usize {
        self.n_coordinates() - 3 * self.points.len() - self.frequencies.len()
    }

    /// The contacts, under the full model's law or another one (of node-to-node elements: N/m and N/m3), corrected to
    /// the full model's forces.
    pub fn interface(&self, law: Option<NormalLaw>) -> Interface {
        let gap_operator = self.gap_operator();
        let pairs = self
            .pairs
            .iter()
            .map(|pair| ContactPair { law: law.as_ref().unwrap_or(&pair.law).clone(), ..pair.clone() })
            .collect();
        Interface {
            pairs,
            points: self.contacts.iter().map(|contact| contact.under(law.as_ref())).collect(),
            gap_operator,
        }
    }

    fn gap_operator(&self) -> GapOperator {
        let mut gap_operator = GapOperator::new();
        match &self.motion {
            ContactMotion::Nodes => {
                let (n, identity) =
                    (self.contacts.len() as u32, |s: f64| [[s, 0.0, 0.0], [0.0, s, 0.0], [0.0, 0.0, s]]);
                (0..n).for_each(|i| gap_operator.push(&[i, n + i], &[identity(1.0), identity(-1.0)]));
            }
            ContactMotion::Rows(rows) => {
                let n = self.n_coordinates();
                let nodes: Vec<u32> = (0..n.div_ceil(3) as u32).collect();
                for rows in rows.chunks_exact(3 * n) {
                    let entry = |i: usize, at: usize| if at < n { rows[i * n + at] } else { 0.0 };
                    let block = |&node: &u32| [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, 3 * node as usize + j)));
                    gap_operator.push(&nodes, &nodes.iter().map(block).collect::<Vec<_>>());
                }
            }
        }
        gap_operator
    }

    /// The assembled system under `factor` times those loads that a load factor multiplies. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where a friction law is missing; METIS's and PETSc's.
    pub fn assemble(&self, comm: &Comm, interface: &Interface, factor: f64) -> Result<System> {
        interface.require_friction_laws()?;
        let n = self.n_coordinates();
        let is_held = |i: usize| i >= n || self.mass[i * n + i] == 0.0;
        let held: Vec<[bool; 3]> = (0..n.div_ceil(3)).map(|node| [0, 1, 2].map(|i| is_held(3 * node + i))).collect();
        let mut system = {
            let nodes = Numbering::even(held.len(), comm.rank(), comm.size());
            // The element couples all coordinates already.
            System::assemble(comm, &nodes, &held, &[&Members::new(self)], &[])?
        };
        // Every coordinate couples with every other.
        let viscoelastic = system.viscoelastic.iter_mut().map(|own| &mut own.stiffness);
        let matrices = [&mut system.k, &mut system.m, &mut system.c].into_iter().chain(&mut system.g);
        matrices.chain(viscoelastic).try_for_each(Matrix::store_dense)?;
        let force = |i: usize| self.load.get(i).map_or(0.0, |load| factor * load + self.preload[i]);
        let forces: Vec<_> = (0..held.len()).map(|n| (n as u32, [0, 1, 2].map(|i| force(3 * n + i)))).collect();
        system.add_load(&forces)?;
        Ok(system)
    }

    /// Whether the damping has gyroscopic terms: whether it is not symmetric.
    pub fn is_gyroscopic(&self) -> bool {
        let n = self.n_coordinates();
        (0..n).any(|i| (0..i).any(|j| self.damping[n * i + j] != self.damping[n * j + i]))
    }

    /// Refuses a band that the modes kept do not cover; gives a warning where they cover it poorly.
    ///
    /// # Errors
    /// [`Error::Input`] from the limit of the fixed-interface modes on.
    pub fn require_band(&self, band: [f64; 2]) -> Result<Option<String>> {
        let (end, limit) = (band[1], self.origin.limit);
        if self.is_galerkin() {
            let what =
                format!("the super-element has modes up to {limit} Hz only, and modes up to {end} Hz are asked for");
            return if end > limit {
                Err(Error::input(format!("{what}. Make one of a model with a wider band")))
            } else {
                Ok(None)
            };
        }
        let advice = "Make one with a higher [reduction] band";
        if end > limit {
            return Err(Error::input(format!(
                "the super-element holds fixed-interface modes up to {limit} Hz only, and modes up to {end} Hz are asked for. {advice}"
            )));
        }
        let poor =
            format!("modes above {} Hz are less exact: fixed-interface modes end at {limit} Hz. {advice}", 0.5 * limit);
        Ok((end > 0.5 * limit * (1.0 + 1e-12)).then_some(poor))
    }
}

impl NodeContact {
    /// The contact point under a law.
    fn under(&self, law: Option<&NormalLaw>) -> ContactPoint {
        let mut point = self.point.clone();
        if let Some(law) = law {
            point.law.normal_law = law.times(1.0 / point.law.weight);
        }
        if self.normal_force != 0.0 {
            // p(d + xi) = p_full
            point.law.correction +=
                point.law.penetration_under(self.normal_force) - point.law.penetration(self.displacement);
        }
        point
    }
}
