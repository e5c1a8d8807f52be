//! Joints: what joins bodies and adds to them without elements of the mesh.
//!
//! | joint | rows of G | weights |
//! |---|---|---|
//! | connector | motion of one node set relative to another, or to the ground | stiffness, damping, loss factor |
//! | tie | jumps between two surfaces, a facet of the slave at a time ([`tie`]) | penalty |
//! | rigid set | what distorts the set ([`rigid`]) | penalty |
//! | equation | `sum a_k u_k` | penalty |
//! | point mass | motion of a node set, about the principal axes | mass, moments of inertia |
//!
//! Each is one or more linear elements `K = G^T diag(k) G` ([`crate::element::linear`]), with the same rows for C, M.
//! A penalty is [`PENALTY`] times the stiffness of the elements beside it; so it gives way by 1e-4 of the deformation
//! of one layer of these elements.

pub mod neighbours;
pub mod rigid;
mod rows;
mod sets;
#[cfg(test)]
mod tests;
pub mod tie;

use nalgebra::{Matrix3, SymmetricEigen};

use crate::Result;
use crate::contact::search::Team;
use crate::element::linear::weighted_product;
use crate::mesh::{Mesh, Numbering};
use crate::model::{Connector, Equation, Model, PENALTY, Place, PointMass};

use super::{Connectivity, ElementMatrices, Elements};
use neighbours::Neighbours;
use rows::Rows;
pub use sets::{SetMotion, Sets};
use tie::TieSummary;

/// What a joint is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Spring and damper.
    Connector,
    /// Two surfaces that move as one.
    Tie,
    /// A node set that moves rigidly.
    RigidSet,
    /// A linear relation.
    Equation,
    /// A mass without a mesh.
    Mass,
}

impl std::fmt::Display for JointKind {
    /// The name of its table in a model file.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            JointKind::Connector => "connector",
            JointKind::Tie => "tie",
            JointKind::RigidSet => "rigid",
            JointKind::Equation => "equation",
            JointKind::Mass => "mass",
        })
    }
}

/// A linear element: rows of G on the dofs of its nodes, and for each row a stiffness, a damping and a mass.
#[derive(Debug, Clone)]
pub struct JointElement {
    /// Its nodes, each once.
    pub nodes: Vec<u32>,
    /// The rows of G, three entries a node.
    pub rows: Vec<Vec<f64>>,
    /// `k`, one a row.
    pub stiffness: Vec<f64>,
    /// `c`, one a row.
    pub damping: Vec<f64>,
    /// `m`, one a row.
    pub mass: Vec<f64>,
    /// Loss factor of its stiffness.
    pub loss_factor: f64,
    /// Its joint, an index in [`Joints::names`].
    pub joint: usize,
}

impl JointElement {
    /// An element of the first joint with a stiffness for each row, without damping and mass.
    fn springs(rows: Rows, stiffness: Vec<f64>) -> JointElement {
        let (nodes, rows) = rows.finish();
        let none = vec![0.0; rows.len()];
        JointElement { nodes, rows, stiffness, damping: none.clone(), mass: none, loss_factor: 0.0, joint: 0 }
    }

    /// The forces (N) that it exerts on what it stands on, `K u`, a force for each of its nodes.
    pub fn forces(&self, u: &[[f64; 3]]) -> Vec<(u32, [f64; 3])> {
        let own: Vec<f64> = self.nodes.iter().flat_map(|&n| u[n as usize]).collect();
        let mut forces = vec![0.0; own.len()];
        for (row, k) in self.rows.iter().zip(&self.stiffness) {
            let q: f64 = row.iter().zip(&own).map(|(g, u)| g * u).sum();
            forces.iter_mut().zip(row).for_each(|(force, g)| *force += g * k * q);
        }
        self.nodes.iter().copied().zip(forces.as_chunks().0.iter().copied()).collect()
    }
}

/// The joints of a model on its mesh; every rank has all of them.
#[derive(Debug, Clone, Default)]
pub struct Joints {
    /// Kind and name of each joint: connectors, ties, rigid sets, equations, masses, in the order of the model.
    pub names: Vec<(JointKind, String)>,
    /// Their elements, joint by joint.
    pub elements: Vec<JointElement>,
    /// What the search found for each tie.
    pub ties: Vec<TieSummary>,
}

impl Joints {
    /// Puts the joints of a model on a mesh of which each of the team has a piece; all of the team have the same.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) with the model's line: nodes on one line, a tie without points.
    pub fn new(model: &Model, mesh: &Mesh, nodes: &Numbering, sets: &Sets, team: &dyn Team) -> Result<Joints> {
        let mut joints = Joints::default();
        for own in &model.connectors {
            let element = connector(sets, own).map(|element| vec![element]);
            joints.add(model, JointName { kind: JointKind::Connector, name: &own.name, place: own.place }, element)?;
        }
        for own in &model.ties {
            let tied = tie::elements(model, mesh, own, team).map(|(summary, elements)| {
                joints.ties.push(summary);
                elements
            });
            joints.add(model, JointName { kind: JointKind::Tie, name: &own.name, place: own.place }, tied)?;
        }
        let points = model.equations.iter().map(|own| equation_nodes(mesh, own)).collect::<Vec<_>>();
        let penalised = sets.rigid_nodes().chain(points.iter().flatten().copied());
        let neighbours = Neighbours::new(model, mesh, nodes, penalised, team)?;
        for (own, set) in model.rigid_sets.iter().zip(&sets.rigid_sets) {
            let elements = rigid::elements(mesh, set, &neighbours);
            joints.add(
                model,
                JointName { kind: JointKind::RigidSet, name: &own.name, place: own.place },
                Ok(elements),
            )?;
        }
        for (own, nodes) in model.equations.iter().zip(&points) {
            let elements = vec![equation(own, nodes, &neighbours)];
            joints.add(
                model,
                JointName { kind: JointKind::Equation, name: &own.name, place: own.place },
                Ok(elements),
            )?;
        }
        for own in &model.masses {
            let element = point_mass(sets, own).map(|element| vec![element]);
            joints.add(model, JointName { kind: JointKind::Mass, name: &own.name, place: own.place }, element)?;
        }
        Ok(joints)
    }

    /// Adds the elements of a joint, or says what is wrong with it.
    fn add(
        &mut self,
        model: &Model,
        JointName { kind, name, place }: JointName,
        elements: std::result::Result<Vec<JointElement>, String>,
    ) -> Result<()> {
        let joint = self.names.len();
        self.names.push((kind, name.to_owned()));
        let refuse = |message| model.error(place, format_args!("{kind} {name:?}: {message}"));
        self.elements.extend(elements.map_err(refuse)?.into_iter().map(|own| JointElement { joint, ..own }));
        Ok(())
    }

    /// Number of joints of a kind.
    pub fn count(&self, kind: JointKind) -> usize {
        self.names.iter().filter(|(own, _)| *own == kind).count()
    }

    /// Number of elements of each joint.
    pub fn n_elements(&self) -> Vec<usize> {
        let mut counts = vec![0; self.names.len()];
        self.elements.iter().for_each(|element| counts[element.joint] += 1);
        counts
    }
}

/// What a joint of a model is called.
struct JointName<'a> {
    kind: JointKind,
    name: &'a str,
    /// Where it stands in the model.
    place: Place,
}

impl Connectivity for Joints {
    fn len(&self) -> usize {
        self.elements.len()
    }

    fn nodes(&self, e: usize) -> &[u32] {
        &self.elements[e].nodes
    }
}

impl Elements for Joints {
    fn mass_couples_axes(&self) -> bool {
        self.elements.iter().any(|element| has_entry(&element.mass))
    }

    fn has_structural_damping(&self) -> bool {
        self.elements.iter().any(|element| element.loss_factor != 0.0)
    }

    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        let JointElement { rows, stiffness, damping, mass, loss_factor, .. } = &self.elements[e];
        let product_or_none = |w: &[f64]| if has_entry(w) { weighted_product(rows, w) } else { Vec::new() };
        out.k = weighted_product(rows, stiffness);
        out.c = product_or_none(damping);
        out.m = product_or_none(mass);
        out.g.clear();
        if *loss_factor != 0.0 {
            out.g.extend(out.k.iter().map(|k| loss_factor * k));
        }
    }
}

fn has_entry(weights: &[f64]) -> bool {
    weights.iter().any(|w| *w != 0.0)
}

/// `q = [u_R, phi]_second - [u_R, phi]_first` at the connector's point, along its axes.
fn connector(sets: &Sets, connector: &Connector) -> std::result::Result<JointElement, String> {
    let ends: Vec<(&String, f64)> =
        connector.between.iter().zip([-1.0, 1.0]).filter(|(end, _)| !sets.is_ground(end)).collect();
    let centres = ends.iter().map(|(end, _)| sets.centroid(end)).collect::<std::result::Result<Vec<_>, _>>()?;
    let share = 1.0 / centres.len() as f64;
    let middle = [0, 1, 2].map(|i| share * centres.iter().map(|centre| centre[i]).sum::<f64>());
    let at = connector.at.unwrap_or(middle);
    let mut rows = Rows::new(6);
    let stiffness = [connector.stiffness, connector.rotational_stiffness].concat();
    let damping = [connector.damping, [0.0; 3]].concat();
    let acting = std::array::from_fn(|i| stiffness[i] != 0.0 || damping[i] != 0.0);
    for (end, sign) in ends {
        let mut motion = sets.motion(end, Some(at))?;
        connector.axes.iter().for_each(|axes| motion.turn(axes));
        motion.require(end, acting)?;
        rows.add_motion(&motion, sign);
    }
    let loss_factor = connector.loss_factor;
    Ok(JointElement { damping, loss_factor, ..JointElement::springs(rows, stiffness) })
}

/// The nodes of an equation's terms, which the model's check has found to be one each.
fn equation_nodes(mesh: &Mesh, equation: &Equation) -> Vec<u32> {
    equation.terms.iter().flat_map(|term| mesh.node_set(&term.node).unwrap_or_default()).collect()
}

/// `q = sum_k a_k u_k / |a|` with the penalty of the stiffest of its nodes.
fn equation(equation: &Equation, nodes: &[u32], neighbours: &Neighbours) -> JointElement {
    let length = equation.terms.iter().map(|term| term.coefficient.powi(2)).sum::<f64>().sqrt();
    let mut rows = Rows::new(1);
    for (term, &node) in equation.terms.iter().zip(nodes) {
        let mut direction = [0.0; 3];
        direction[term.axis] = term.coefficient / length;
        rows.add(0, node, direction);
    }
    let around = neighbours.around(nodes);
    JointElement::springs(rows, vec![PENALTY * around.young * around.size])
}

/// `q = [R u_R, R phi]` with the principal axes of the inertia, the rows of R, on which it is diagonal.
fn point_mass(sets: &Sets, mass: &PointMass) -> std::result::Result<JointElement, String> {
    let mut motion = sets.motion(&mass.nodes, mass.at)?;
    let (has_mass, has_inertia) = (mass.mass != 0.0, mass.inertia != [0.0; 6]);
    motion.require(&mass.nodes, std::array::from_fn(|i| if i < 3 { has_mass } else { has_inertia }))?;
    let matrix = PointMass::matrix(mass.mass, mass.inertia);
    let inertia: Matrix3<f64> = matrix.fixed_view::<3, 3>(3, 3).into_owned();
    let principal = SymmetricEigen::new(inertia);
    motion.turn(&[0, 1, 2].map(|i| principal.eigenvectors.column(i).into_owned().into()));
    let mut rows = Rows::new(6);
    rows.add_motion(&motion, 1.0);
    // The moment of a rod about its axis may be below 0 by rounding.
    let moments = principal.eigenvalues.iter().map(|moment| moment.max(0.0));
    let masses = std::iter::repeat_n(mass.mass, 3).chain(moments).collect();
    Ok(JointElement { mass: masses, ..JointElement::springs(rows, vec![0.0; 6]) })
}
