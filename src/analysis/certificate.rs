//! How well the equilibrium and the modes of a Galerkin super-element solve the full model's equations.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::assembly::System;
use crate::contact::{Interface, Response};
use crate::equilibrium::{Contacts, Equilibrium};
use crate::native::{Block, Comm, Factor, Vector};
use crate::results::{Certificate, CertifiedMode};
use crate::stability::{Approximation, corrections};
use crate::structure::Structure;

use super::sweep::Sweep;

/// Accuracy of the super-element's left vectors: an estimate needs no more.
const LEFT_ACCURACY: f64 = 1e-5;

/// The full model of a super-element, with what takes one to the other.
pub(super) struct Whole<'a> {
    /// M, C, K and the load.
    pub system: &'a System,
    /// The contacts.
    pub interface: &'a Interface,
    /// The basis V of the super-element.
    pub basis: &'a Block,
    /// The factor of K_ref, with `V^T K_ref V = I`.
    pub factor: &'a Factor,
}

/// Equilibrium and modes of a super-element, in its coordinates.
#[derive(Serialize, Deserialize, Default)]
struct ReducedSolution {
    equilibrium: Vec<f64>,
    lambdas: Vec<[f64; 2]>,
    right: Vec<f64>,
    left: Vec<f64>,
}

impl ReducedSolution {
    /// Of a super-element at a friction value, on one rank.
    fn new(alone: &Comm, reduced: &Structure, friction: f64, band: [f64; 2]) -> Result<ReducedSolution> {
        let system = reduced.assemble(alone)?;
        let mut sweep = Sweep::new(&system, reduced.interface(), reduced.friction_damping())?;
        let equilibrium = sweep.equilibrium(friction, &mut ())?;
        let modes = sweep.modes(&equilibrium, band, &mut ())?.modes;
        let right = sweep.right_vectors(&modes)?.values().to_vec();
        let left = sweep.left_vectors(&modes, |_| LEFT_ACCURACY)?.values().to_vec();
        let lambdas = modes.iter().map(|mode| [mode.lambda.re, mode.lambda.im]).collect();
        Ok(ReducedSolution { equilibrium: equilibrium.u.to_vec()?, lambdas, right, left })
    }
}

impl Whole<'_> {
    /// Solves a super-element at a friction value on the first rank, and compares with the full model there.
    /// Collective.
    ///
    /// # Errors
    /// Those of the solution; PETSc's and MUMPS's.
    pub(super) fn certify(&self, reduced: &Structure, friction: f64, band: [f64; 2]) -> Result<Certificate> {
        let comm = self.system.k.comm();
        let alone = comm.alone();
        let solve = || ReducedSolution::new(&alone, reduced, friction, band);
        let solution = comm.agree(if comm.is_root() { solve() } else { Ok(ReducedSolution::default()) })?;
        let solution = comm.broadcast_value(0, solution);
        let lambdas: Vec<Complex64> = solution.lambdas.iter().map(|[re, im]| Complex64::new(*re, *im)).collect();
        let [right, left] =
            [&solution.right, &solution.left].map(|vectors| self.basis.combined(vectors, 2 * lambdas.len()));
        let u = self.basis.combined(&solution.equilibrium, 1).vector(0)?;
        let contacts = Contacts::new(self.interface, self.system)?;
        let responses = contacts.respond(&u, &self.interface.stage(friction))?;
        let equilibrium_error = self.equilibrium_error(&u, &contacts, &responses)?;
        let equilibrium = Equilibrium { u, responses, friction, steps: Vec::new() };
        let mut sweep = Sweep::new(self.system, self.interface, reduced.friction_damping())?;
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

    /// `(K_ref^-1 - V V^T) r`: the static answer of what the basis lacks.
    fn answer(&self, r: &Block) -> Result<Block> {
        let mut answer = r.solved_by(self.factor)?;
        let within = self.basis.gram(r);
        answer.axpy(-1.0, &self.basis.combined(&within, r.n_columns()));
        Ok(answer)
    }

    /// `sqrt(r^T K_ref^-1 r / u^T F)` with the residual r of the equilibrium: the length of its error in energy, to
    /// first order.
    fn equilibrium_error(&self, u: &Vector, contacts: &Contacts, responses: &[Response]) -> Result<f64> {
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
