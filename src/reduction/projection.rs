//! Matrices and vectors in a basis.

use nalgebra::DMatrix;

use super::linear::Linear;
use super::super_element::ViscoelasticTerm;
use crate::Result;
use crate::assembly::{System, ViscoelasticStiffness};
use crate::native::{Block, Matrix, Mck, Vector};
use crate::stability::Viscoelastic;

/// Columns in one pass over a matrix or factor.
pub(super) const PANEL: usize = 64;

/// The projections of the symmetric matrices, which grow with the basis.
#[derive(Default)]
pub(super) struct Projected {
    pub mass: DMatrix<f64>,
    pub stiffness: DMatrix<f64>,
    pub viscoelastic: Vec<DMatrix<f64>>,
}

impl Projected {
    /// Those of a basis that begins with the one they have.
    pub fn extended(mut self, basis: &Block, system: &System, linear: &Linear) -> Result<Projected> {
        self.viscoelastic.resize(system.viscoelastic.len(), DMatrix::zeros(0, 0));
        let laws = self.viscoelastic.into_iter().zip(&system.viscoelastic);
        Ok(Projected {
            mass: project(self.mass, basis, &system.m)?,
            stiffness: project(self.stiffness, basis, &linear.stiffness)?,
            viscoelastic: laws.map(|(known, own)| project(known, basis, &own.stiffness)).collect::<Result<_>>()?,
        })
    }

    /// The terms of a super-element.
    pub fn viscoelastic_terms(&self, system: &System) -> Vec<ViscoelasticTerm> {
        let term = |(own, matrix): (&ViscoelasticStiffness, &DMatrix<f64>)| ViscoelasticTerm {
            law: own.law.clone(),
            stiffness: matrix.as_slice().to_vec(),
        };
        system.viscoelastic.iter().zip(&self.viscoelastic).map(term).collect()
    }

    /// All of them, with the damping.
    pub fn matrices(self, basis: &Block, system: &System) -> Result<Mck<DMatrix<f64>>> {
        let g = system.g.as_ref().map(|g| project(DMatrix::zeros(0, 0), basis, g)).transpose()?;
        Ok(Mck { m: self.mass, c: project_damping(basis, system)?, k: self.stiffness, g })
    }

    /// With the stiffness of viscoelastic materials at the reference frequency.
    pub fn stiffness_at_reference(&self, viscoelastic: &Viscoelastic) -> DMatrix<f64> {
        let terms = viscoelastic.stiffnesses.iter().zip(&self.viscoelastic);
        terms.fold(self.stiffness.clone(), |sum, (own, matrix)| sum + (viscoelastic.rho(own) - 1.0) * matrix)
    }
}

/// Extends `known = T^T A T` of the first columns of T to all of them, A symmetric, panel by panel. Collective.
///
/// # Errors
/// PETSc's.
pub fn project(known: DMatrix<f64>, basis: &Block, a: &Matrix) -> Result<DMatrix<f64>> {
    let (n, done) = (basis.n_columns(), known.nrows());
    let mut product = known.resize(n, n, 0.0);
    for first in (done..n).step_by(PANEL) {
        let last = (first + PANEL).min(n);
        let columns = basis.leading_gram(last, &basis.columns(first..last).multiplied_by(a)?);
        for (j, column) in (first..last).zip(columns.chunks_exact(last)) {
            for (i, &value) in column[..=j].iter().enumerate() {
                (product[(i, j)], product[(j, i)]) = (value, value);
            }
        }
    }
    Ok(product)
}

/// `T^T C T`, which gyroscopic terms make unsymmetric.
fn project_damping(basis: &Block, system: &System) -> Result<DMatrix<f64>> {
    if !system.is_gyroscopic {
        return project(DMatrix::zeros(0, 0), basis, &system.c);
    }
    let n = basis.n_columns();
    let mut product = Vec::with_capacity(n * n);
    for first in (0..n).step_by(PANEL) {
        let last = (first + PANEL).min(n);
        product.extend(basis.gram(&basis.columns(first..last).multiplied_by(&system.c)?));
    }
    Ok(DMatrix::from_vec(n, n, product))
}

/// The load in a basis.
pub(super) struct ProjectedLoad {
    /// What load factors multiply, N.
    pub variable: Vec<f64>,
    /// What they do not, N.
    pub constant: Vec<f64>,
}

impl ProjectedLoad {
    pub fn new(basis: &Block, system: &System) -> Result<ProjectedLoad> {
        let (all, constant) = (shadow(basis, &system.load)?, shadow(basis, &system.constant_load)?);
        Ok(ProjectedLoad { variable: all.iter().zip(&constant).map(|(all, own)| all - own).collect(), constant })
    }
}

/// `T^T f`
pub(super) fn shadow(basis: &Block, f: &Vector) -> Result<Vec<f64>> {
    let mut column = Block::zeros(f.comm(), f.n_local(), 1);
    f.local(|values| column.column_mut(0).copy_from_slice(values))?;
    Ok(basis.gram(&column))
}
