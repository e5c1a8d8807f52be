//! How well the equilibrium and the modes of a Galerkin super-element solve the full model's equations.

use std::path::Path;

use nalgebra::DMatrix;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::assembly::{Prestress, System};
use crate::contact::Interface;
use crate::equilibrium::{Contacts, Equilibrium};
use crate::native::{Block, Comm, Factor, FactorKind, Matrix, Vector};
use crate::reduction::projection::project;
use crate::reduction::recovery::OuterSurface;
use crate::reduction::super_element::SuperElement;
use crate::results::{Certificate, CertifiedMode};
use crate::stability::{Approximation, corrections};
use crate::structure::{FullModel, ReducedModel, Structure};
use crate::{Error, Result};

use super::other_parts::OtherModel;
use super::sweep::Sweep;

/// Accuracy of the super-element's left vectors: an estimate needs no more.
const LEFT_ACCURACY: f64 = 1e-5;

/// The full model of a super-element, with what takes one to the other.
pub(super) struct Whole<'a> {
    /// M, C, K and the load.
    pub system: &'a System,
    /// The contacts.
    pub interface: &'a Interface,
    /// What makes the geometric stiffness of an equilibrium, where the model has prestress.
    pub prestress: Option<&'a Prestress<'a>>,
    /// The basis V of the super-element.
    pub basis: &'a Block,
    /// The factor of K_ref.
    pub factor: &'a Factor,
    /// `(V^T K_ref V)^-1`, where that is not I.
    pub inverse_metric: Option<DMatrix<f64>>,
}

/// Equilibrium and modes of a super-element, in its coordinates.
#[derive(Serialize, Deserialize, Default)]
struct ReducedSolution {
    friction: f64,
    equilibrium: Vec<f64>,
    lambdas: Vec<[f64; 2]>,
    right: Vec<f64>,
    left: Vec<f64>,
}

impl ReducedSolution {
    /// Of a super-element at some friction values, on one rank.
    fn at_all(alone: &Comm, reduced: &Structure, values: &[f64], band: [f64; 2]) -> Result<Vec<ReducedSolution>> {
        let (system, prestress) = (reduced.assemble(alone)?, reduced.prestress()?);
        let mut sweep = Sweep::of(reduced, &system, prestress.as_ref())?;
        values.iter().map(|&friction| ReducedSolution::at(&mut sweep, friction, band)).collect()
    }

    fn at(sweep: &mut Sweep, friction: f64, band: [f64; 2]) -> Result<ReducedSolution> {
        let equilibrium = sweep.equilibrium(friction, &mut ())?;
        let modes = sweep.modes(&equilibrium, band, &mut ())?.modes;
        let right = sweep.right_vectors(&modes)?.values().to_vec();
        let left = sweep.left_vectors(&modes, |_| LEFT_ACCURACY)?.values().to_vec();
        let lambdas = modes.iter().map(|mode| [mode.lambda.re, mode.lambda.im]).collect();
        Ok(ReducedSolution { friction, equilibrium: equilibrium.u.to_vec()?, lambdas, right, left })
    }
}

impl ReducedSolution {
    /// As [`ReducedSolution::at_all`], by the first rank for all. Collective.
    fn shared(comm: &Comm, reduced: &Structure, values: &[f64], band: [f64; 2]) -> Result<Vec<ReducedSolution>> {
        let alone = comm.alone();
        let solve = || ReducedSolution::at_all(&alone, reduced, values, band);
        let solutions = comm.agree(if comm.is_root() { solve() } else { Ok(Vec::new()) })?;
        Ok(comm.broadcast_value(0, solutions))
    }
}

/// Compares a super-element at some friction values with its full model, a model file. Collective.
///
/// # Errors
/// [`crate::Error::Input`] for a model that cannot be used; those of the solution; PETSc's and MUMPS's.
pub(super) fn certify(
    comm: &Comm,
    structure: &Structure,
    path: &Path,
    values: &[f64],
    band: [f64; 2],
) -> Result<Vec<Certificate>> {
    let Structure::Reduced(reduced) = structure else { return Ok(Vec::new()) };
    let (full, system, basis) = reduced.full(comm, path)?;
    let solutions = ReducedSolution::shared(comm, structure, values, band)?;
    let Some(middle) = solutions.get(solutions.len() / 2) else { return Ok(Vec::new()) };
    let mut factor = Factor::new(FactorKind::Symmetric);
    let (interface, basis) = (&full.interface, &basis);
    let equilibrium = equilibrium(&system, interface, basis, middle)?;
    let k_ref = Sweep::new(&system, interface, false)?.symmetric_stiffness(&equilibrium)?;
    factor.factorise(&k_ref)?;
    // V is not quite orthonormal: it was made with another K_ref, and is kept in single precision.
    let inverse_metric = Some(inverse_metric(&k_ref, basis)?);
    let prestress = full.prestress()?;
    let whole =
        Whole { system: &system, interface, prestress: prestress.as_ref(), basis, factor: &factor, inverse_metric };
    solutions.iter().map(|solution| whole.compare(solution, structure.friction_damping())).collect()
}

/// Compares a super-element with other parts, at a friction value, with the full model with these parts; `reference` is
/// an equilibrium about which the model is stiff. Collective.
///
/// # Errors
/// Those of the solution; PETSc's and MUMPS's.
pub(super) fn certify_at(
    full: &FullModel,
    other: &OtherModel,
    (element, basis): (&SuperElement, &Block),
    reference: &Equilibrium,
    friction: f64,
) -> Result<Certificate> {
    let mut element = element.clone();
    other.changes.iter().try_for_each(|(part, change)| element.change_part(part, change))?;
    let reduced = ReducedModel::new(Path::new(""), element, OuterSurface::default());
    let (system, interface) = (full.assemble_as(basis.comm(), &other.model)?, &full.interface);
    let k_ref = Sweep::new(&system, interface, false)?.symmetric_stiffness(reference)?;
    let mut factor = Factor::new(FactorKind::Symmetric);
    factor.factorise(&k_ref)?;
    let inverse_metric = Some(inverse_metric(&k_ref, basis)?);
    let whole = Whole { system: &system, interface, prestress: None, basis, factor: &factor, inverse_metric };
    let all = whole.certify(&Structure::Reduced(Box::new(reduced)), &[friction], full.model.band)?;
    Ok(all.into_iter().next().expect("one friction value"))
}

/// `(V^T K_ref V)^-1`
fn inverse_metric(k_ref: &Matrix, basis: &Block) -> Result<DMatrix<f64>> {
    let metric = project(DMatrix::zeros(0, 0), basis, k_ref)?;
    let factor = metric.cholesky().ok_or_else(|| Error::Singular { found_by: "Cholesky of the basis".into() })?;
    Ok(factor.inverse())
}

/// The super-element's equilibrium with the full model's contacts. Collective.
fn equilibrium(
    system: &System,
    interface: &Interface,
    basis: &Block,
    solution: &ReducedSolution,
) -> Result<Equilibrium> {
    let u = basis.combined(&solution.equilibrium, 1).vector(0)?;
    let responses = Contacts::new(interface, system)?.respond(&u, &interface.stage(solution.friction))?;
    Ok(Equilibrium { u, responses, friction: solution.friction, steps: Vec::new() })
}

impl Whole<'_> {
    /// Solves a super-element at some friction values on the first rank, and compares with the full model there.
    /// Collective.
    ///
    /// # Errors
    /// Those of the solution; PETSc's and MUMPS's.
    pub(super) fn certify(&self, reduced: &Structure, values: &[f64], band: [f64; 2]) -> Result<Vec<Certificate>> {
        let solutions = ReducedSolution::shared(self.system.k.comm(), reduced, values, band)?;
        solutions.iter().map(|solution| self.compare(solution, reduced.friction_damping())).collect()
    }

    fn compare(&self, solution: &ReducedSolution, friction_damping: bool) -> Result<Certificate> {
        let friction = solution.friction;
        let lambdas: Vec<Complex64> = solution.lambdas.iter().map(|[re, im]| Complex64::new(*re, *im)).collect();
        let [right, left] =
            [&solution.right, &solution.left].map(|vectors| self.basis.combined(vectors, 2 * lambdas.len()));
        let equilibrium = equilibrium(self.system, self.interface, self.basis, solution)?;
        let equilibrium_error = self.equilibrium_error(&equilibrium)?;
        let mut sweep = Sweep::new(self.system, self.interface, friction_damping)?.with_prestress(self.prestress);
        let approximation = Approximation { lambdas: &lambdas, right: &right, left: &left };
        let corrections =
            sweep.linearise(&equilibrium, |problem| corrections(problem, &approximation, |r| self.answer(r)))?;
        let mode = |(&lambda, correction): (&Complex64, crate::stability::Correction)| CertifiedMode {
            lambda,
            corrected: correction.lambda,
            backward_error: correction.backward_error,
        };
        Ok(Certificate { friction, equilibrium_error, modes: lambdas.iter().zip(corrections).map(mode).collect() })
    }

    /// `(K_ref^-1 - V (V^T K_ref V)^-1 V^T) r`: the static answer of what the basis lacks.
    fn answer(&self, r: &Block) -> Result<Block> {
        let mut answer = r.solved_by(self.factor)?;
        let n = r.n_columns();
        let mut within = DMatrix::from_vec(self.basis.n_columns(), n, self.basis.gram(r));
        if let Some(inverse) = &self.inverse_metric {
            within = inverse * within;
        }
        answer.axpy(-1.0, &self.basis.combined(within.as_slice(), n));
        Ok(answer)
    }

    /// `sqrt(r^T K_ref^-1 r / u^T F)` with the residual r of the equilibrium: the length of its error in energy, to
    /// first order.
    fn equilibrium_error(&self, Equilibrium { u, responses, .. }: &Equilibrium) -> Result<f64> {
        let contacts = Contacts::new(self.interface, self.system)?;
        let mut r = self.system.zeros()?;
        self.system.k.multiply(u, &mut r)?;
        contacts.add_forces(responses, -1.0, &mut r)?;
        r.axpy(-1.0, &self.system.load)?;
        let comm = self.system.k.comm();
        let column = |v: &Vector| Ok(Block::from_columns(comm, v.n_local(), v.to_vec()?));
        let (r, u, load): (Block, Block, Block) = (column(&r)?, column(u)?, column(&self.system.load)?);
        let [error, energy] = [r.gram(&r.solved_by(self.factor)?)[0], u.gram(&load)[0]];
        Ok((error / energy.abs().max(f64::MIN_POSITIVE)).max(0.0).sqrt())
    }
}
