//! Galerkin super-elements: the whole brake in a basis of its own equilibria and modes, with all of its contacts.
//!
//! ```text
//! u = V q      M_r = V^T M V,  C_r = V^T C V,  K_r = V^T K V,  F_r = V^T F      g = B V q
//! ```
//!
//! Nothing is linearised and nothing is averaged: every contact point has its law, weight, gap and status as in the
//! full model, and equilibrium and stability at any friction value, load and contact stiffness are the full model's, in
//! the space of V. V is spanned by
//!
//! - equilibria of the full model at several friction values,
//! - its modes at fewer of them, *right and left*: `y^H P(lambda) x` is then stationary, and the error of an eigenvalue
//!   the product of the errors of both vectors;
//! - static answers `K_ref^-1 B_a^T d` to forces at points that open or close among the equilibria: what a change of
//!   status does that lies between two samples.
//!
//! V is orthonormal in the energy of the brake at a reference equilibrium, `K_ref = K + sum B_a^T D_a B_a` without
//! friction's coupling, in which local indentation and motion of whole parts weigh alike.
//!
//! Source: Galerkin projection onto snapshots (Benner, Gugercin, Willcox, *A survey of projection-based model reduction
//! methods for parametric dynamical systems*, SIAM Review 57, 2015, sections 3 and 4).

use nalgebra::DMatrix;
use serde::Serialize;

use crate::Result;
use crate::assembly::System;
use crate::contact::{Interface, Response, Status, Tangential};
use crate::native::{Block, Matrix, Mck};

use super::fixed_interface::make_orthonormal;
use super::functionals::Functionals;
use super::parts::MatricesByPart;
use super::projection::ProjectedLoad;
use super::super_element::{ContactMotion, NodeContact, Origin, SuperElement};

/// A basis V with `V^T K_ref V = I`, which grows.
pub struct Basis<'a> {
    k_ref: &'a Matrix,
    vectors: Block,
    max_columns: usize,
}

impl<'a> Basis<'a> {
    /// Without vectors, in the layout of some; at most `max_columns` come into it.
    pub fn new(k_ref: &'a Matrix, like: &Block, max_columns: usize) -> Basis<'a> {
        Basis { k_ref, vectors: Block::with_room(like.comm(), like.n_local(), max_columns), max_columns }
    }

    /// Adds what some vectors add to the span, but for directions that are shorter than `negligible` of them. Gives how
    /// many were added. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add(&mut self, mut vectors: Block, negligible: f64) -> Result<usize> {
        let room = self.max_columns - self.vectors.n_columns();
        make_orthonormal(&self.vectors, &mut vectors, self.k_ref, negligible, room)?;
        self.vectors.append(&vectors);
        Ok(vectors.n_columns())
    }

    /// K_ref.
    pub fn k_ref(&self) -> &'a Matrix {
        self.k_ref
    }

    /// V.
    pub fn vectors(&self) -> &Block {
        &self.vectors
    }
}

/// Where the coordinates of a Galerkin super-element come from, and what they cost.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct BasisReport {
    /// Equilibria of the full model.
    pub equilibria: usize,
    /// Samples of its modes.
    pub mode_samples: usize,
    /// Contact points that are closed in some equilibria and open in others.
    pub switching_points: usize,
    /// Coordinates that equilibria gave.
    pub coordinates_of_equilibria: usize,
    /// Coordinates that modes gave.
    pub coordinates_of_modes: usize,
    /// How many of them samples of other moduli and densities gave.
    pub coordinates_of_parts: usize,
    /// Coordinates that static answers gave.
    pub coordinates_of_static_answers: usize,
    /// Spent on equilibria, s.
    pub equilibrium_seconds: f64,
    /// Spent on modes, s.
    pub mode_seconds: f64,
    /// Spent on their left vectors, s.
    pub left_seconds: f64,
    /// Spent on the basis, s.
    pub basis_seconds: f64,
    /// Spent on the projection of the matrices and of the surface, and on the file, s.
    pub projection_seconds: f64,
    /// Spent on the comparison with the full model, s.
    pub test_seconds: f64,
    /// All of it, s.
    pub seconds: f64,
}

/// The forces on points whose static answers are added: along the normal and the direction of sliding, or along all
/// axes where a closed point sticks. Given the responses of all points at several equilibria, these are the points that
/// are closed in some and open in others.
pub fn switching_forces(interface: &Interface, equilibria: &[&[Response]]) -> Vec<(usize, [f64; 3])> {
    let is_open = |responses: &&[Response], a: usize| responses[a].status == Status::Open;
    let switches = |a: &usize| {
        let n_open = equilibria.iter().filter(|responses| is_open(responses, *a)).count();
        n_open > 0 && n_open < equilibria.len()
    };
    let forces = |a: usize| {
        let law = &interface.points[a].law;
        let directions = match law.tangential {
            Tangential::Frictionless => vec![law.normal],
            Tangential::Sliding { direction, .. } => vec![law.normal, direction],
            Tangential::StickSlip { .. } => vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        directions.into_iter().map(move |direction| (a, direction))
    };
    (0..interface.points.len()).filter(switches).flat_map(forces).collect()
}

/// The super-element of a structure in a basis, with the matrices that it has there and with all contact points of its
/// interface. Collective.
///
/// # Errors
/// PETSc's.
pub fn super_element(
    system: &System,
    interface: &Interface,
    basis: &Block,
    matrices: MatricesByPart,
    origin: Origin,
) -> Result<SuperElement> {
    let contact = |(a, point): (usize, &crate::contact::ContactPoint)| {
        let mut point = point.clone();
        point.nodes = vec![a as u32];
        NodeContact { point, displacement: [0.0; 3], normal_force: 0.0 }
    };
    let ProjectedLoad { variable, constant } = ProjectedLoad::new(basis, system)?;
    let Mck { m, c, k, g } = matrices.total();
    Ok(SuperElement {
        origin,
        model_text: None,
        points: Vec::new(),
        frequencies: Vec::new(),
        mass: m,
        damping: c,
        stiffness: k,
        viscoelastic: matrices.viscoelastic(),
        geometric_stiffness: None,
        structural_damping: g,
        rest: matrices.has_rest().then_some(matrices.rest_name),
        parts: matrices.parts,
        preload: constant,
        load: variable,
        pairs: interface.pairs.clone(),
        contacts: interface.points.iter().enumerate().map(contact).collect(),
        motion: ContactMotion::Rows(by_rows(Functionals::new(&interface.gap_operator, system).apply(basis), basis)),
    })
}

/// `B V` by rows from its columns.
fn by_rows(columns: Vec<f64>, basis: &Block) -> Vec<f64> {
    let n = basis.n_columns();
    DMatrix::from_vec(columns.len() / n.max(1), n, columns).transpose().as_slice().to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::testing::{ALONG_X, blocks_on_belt};
    use crate::equilibrium::{Equilibrium, Path};
    use crate::native::{Comm, Session};
    use crate::reduction::projection::project;
    use crate::reduction::testing::origin;

    const N: usize = 4;

    fn columns(comm: &Comm, columns: &[[f64; 3 * N]]) -> Block {
        Block::from_columns(comm, 3 * N, columns.concat())
    }

    #[test]
    fn a_basis_takes_in_what_it_lacks_and_is_orthonormal_in_energy() {
        let comm = Session::start(&[]).unwrap();
        let (system, _) = blocks_on_belt(&comm, N, 0, ALONG_X);
        let unit = |i: usize, x: f64| std::array::from_fn(|j| if i == j { x } else { 0.0 });
        let mixed = |x: f64| std::array::from_fn(|j| [1.0, x].get(j).copied().unwrap_or(0.0));
        let mut basis = Basis::new(&system.k, &columns(&comm, &[]), 4);
        assert_eq!(basis.add(columns(&comm, &[unit(0, 1.0), unit(0, 1e-9)]), 1e-6).unwrap(), 1, "one direction");
        assert_eq!(basis.add(columns(&comm, &[mixed(1e-4)]), 1e-2).unwrap(), 0, "negligible");
        assert_eq!(basis.add(columns(&comm, &[mixed(1e-4)]), 1e-6).unwrap(), 1);
        assert_eq!(basis.add(columns(&comm, &[unit(1, 1.0)]), 1e-6).unwrap(), 0, "in the span");
        let many: Vec<_> = (4..9).map(|i| unit(i, 1.0)).collect();
        assert_eq!(basis.add(columns(&comm, &many), 1e-6).unwrap(), 2, "no more than there is place for");
        let v = basis.vectors();
        let gram = DMatrix::from_vec(4, 4, v.gram(&v.multiplied_by(&system.k).unwrap()));
        assert!((gram - DMatrix::identity(4, 4)).amax() < 1e-12);
    }

    #[test]
    fn forces_act_at_points_that_switch() {
        let comm = Session::start(&[]).unwrap();
        let (_, mut interface) = blocks_on_belt(&comm, N, 0, ALONG_X);
        let response = |status| Response { status, ..Response::OPEN };
        let statuses = |all: [Status; N]| all.map(response);
        let (open, slip, stick) = (Status::Open, Status::Slip, Status::Stick);
        let [first, second] = [statuses([slip, open, slip, open]), statuses([slip, slip, open, open])];
        let forces = switching_forces(&interface, &[&first, &second]);
        let (n, t) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        assert_eq!(forces, [(1, n), (1, t), (2, n), (2, t)]);
        assert!(switching_forces(&interface, &[&statuses([slip; N]), &statuses([stick; N])]).is_empty(), "none opens");
        interface.points[1].law.tangential = Tangential::StickSlip { stick: 1.0 };
        interface.points[2].law.tangential = Tangential::Frictionless;
        let points: Vec<usize> = switching_forces(&interface, &[&first, &second]).iter().map(|force| force.0).collect();
        assert_eq!(points, [1, 1, 1, 2]);
    }

    fn at(system: &System, interface: &Interface, mu: f64) -> Equilibrium {
        Path::new(system, interface).unwrap().advance(mu, &mut |_, _, _| ()).unwrap()
    }

    /// The equilibrium that the basis has is found, though the coordinates are few; at another friction value a
    /// complete basis gives the full model's.
    #[test]
    fn equilibria_of_the_basis_and_of_a_complete_one_are_the_full_models() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = blocks_on_belt(&comm, N, 1, ALONG_X);
        let own: Vec<f64> = at(&system, &interface, 0.3).u.to_vec().unwrap();
        let few = {
            let mut basis = Basis::new(&system.k, &columns(&comm, &[]), 12);
            let unit = |i: usize| std::array::from_fn(|j| f64::from(u8::from(i == j)));
            basis.add(columns(&comm, &[own.clone().try_into().unwrap(), unit(2), unit(7)]), 1e-6).unwrap();
            basis.vectors().clone()
        };
        let all: Vec<_> = (0..3 * N).map(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)))).collect();
        for (basis, mu) in [(few, 0.3), (columns(&comm, &all), 0.3), (columns(&comm, &all), 0.5)] {
            let projected = |a: &Matrix| project(DMatrix::zeros(0, 0), &basis, a).unwrap().as_slice().to_vec();
            let matrices = MatricesByPart {
                parts: Vec::new(),
                rest: system.matrices().map(projected),
                rest_name: "blocks".into(),
            };
            let element = super_element(&system, &interface, &basis, matrices, origin()).unwrap();
            let contacts = element.interface(None);
            let reduced = element.assemble(&comm, &contacts, 1.0).unwrap();
            let q = at(&reduced, &contacts, mu).u.to_vec().unwrap();
            let u = basis.combined(&q, 1);
            let full = at(&system, &interface, mu).u.to_vec().unwrap();
            assert!(u.column(0).iter().zip(&full).all(|(a, b)| (a - b).abs() < 1e-10), "{} at {mu}", basis.n_columns());
        }
    }
}
