//! The eigenproblem `(lambda^2 M + lambda C + K + i G) x = 0` and its linear systems.
//!
//! With viscoelastic materials the stiffness depends on lambda: [`Viscoelastic`].

use std::array::from_fn;

use num_complex::Complex64;

use super::Viscoelastic;
use crate::Result;
use crate::algebra::dot;
use crate::contact::{Response, Tangent};
use crate::equilibrium::{Contacts, Label, LabelledFactor};
use crate::native::{Block, Comm, Factor, Matrix, Mck};

/// The matrices of `P(lambda) = lambda^2 M + lambda C + K + i G`, and what of the stiffness depends on lambda.
///
/// Structural damping `i G` is meant for the half plane `Im lambda > 0`: with it eigenvalues do not come as conjugate
/// pairs, and those of the other half plane mean nothing. What is factorised and counted is the real part.
pub struct QuadraticProblem<'a> {
    /// M, C, K and G, K with the tangent of contact and friction, and with viscoelastic stiffnesses at a reference
    /// frequency.
    pub matrices: Mck<&'a Matrix>,
    /// Symmetric stiffness, for counting: without friction, and without the points below.
    pub k_symmetric: &'a Matrix,
    /// Contact points that add to `k_symmetric`; the count follows their changes.
    pub points: Option<FrozenPoints<'a>>,
    /// Whether M, C and G are symmetric, so that K alone has to be transposed for left vectors.
    pub symmetric_mc: bool,
    /// What of the stiffness depends on lambda.
    pub viscoelastic: Viscoelastic<'a>,
}

/// Contact points with what each adds to the stiffness, its status frozen.
#[derive(Clone, Copy)]
pub struct FrozenPoints<'a> {
    /// Their places among the dofs.
    pub contacts: &'a Contacts<'a>,
    /// What each point does: its tangent D (N/m) has friction's coupling, which is all that makes the stiffness
    /// unsymmetric.
    pub responses: &'a [Response],
    /// Tangent without friction's coupling of each point, N/m.
    pub symmetric: &'a [Tangent],
}

impl<'a> QuadraticProblem<'a> {
    /// With symmetric matrices and without contact points.
    pub fn symmetric(matrices: Mck<&'a Matrix>) -> QuadraticProblem<'a> {
        let viscoelastic = Viscoelastic::default();
        QuadraticProblem { matrices, k_symmetric: matrices.k, points: None, symmetric_mc: true, viscoelastic }
    }

    /// Whether the stiffness is complex, so that eigenvalues do not come as conjugate pairs.
    pub fn is_complex(&self) -> bool {
        self.matrices.g.is_some() || !self.viscoelastic.stiffnesses.is_empty()
    }

    /// M, C, K, G where there is one, and the viscoelastic stiffnesses.
    pub fn all_matrices(&self) -> Vec<&'a Matrix> {
        let Mck { m, c, k, g } = self.matrices;
        let viscoelastic = self.viscoelastic.stiffnesses.iter().map(|own| &own.stiffness);
        [m, c, k].into_iter().chain(g).chain(viscoelastic).collect()
    }

    /// What each of them is multiplied by in `P(lambda)`.
    pub fn coefficients(&self, lambda: Complex64) -> Vec<Complex64> {
        let terms = self.matrices.terms(lambda).map(|(factor, _)| factor);
        terms.chain(self.viscoelastic.coefficients(lambda)).collect()
    }

    /// What each of them is multiplied by in `P'(lambda)`.
    pub fn slopes(&self, lambda: Complex64) -> Vec<Complex64> {
        let constant = [Complex64::ZERO, Complex64::ZERO].into_iter().take(1 + usize::from(self.matrices.g.is_some()));
        let quadratic = [2.0 * lambda, Complex64::ONE].into_iter().chain(constant);
        quadratic.chain(self.viscoelastic.slopes(lambda)).collect()
    }

    /// The communicator.
    pub fn comm(&self) -> &'a Comm {
        self.matrices.k.comm()
    }

    /// Number of rows on this rank. Not collective.
    pub fn n_local(&self) -> usize {
        self.matrices.k.n_local()
    }

    /// Number of rows. Collective.
    pub fn n_dofs(&self) -> usize {
        self.comm().sum(self.n_local())
    }

    /// The factor of `P(shift) - i G` at a real shift (1/s): made now, unless `factor` is that. Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    pub fn factorise<'f>(&self, shift: f64, factor: &'f mut LabelledFactor) -> Result<&'f Factor> {
        let Mck { m, c, k, .. } = self.matrices;
        let mut label = Label { shift, versions: vec![k.version()?] };
        if shift != 0.0 {
            label.versions.extend([m.version()?, c.version()?]);
        }
        if !factor.is_of(&label) {
            match shift {
                0.0 => factor.factorise(k, label, self.points.map_or(&[], |points| points.responses))?,
                _ => factor.factorise(&self.shifted(shift)?, label, &[])?,
            }
        }
        Ok(factor.factor())
    }

    /// `P(shift) - i G`: its real part. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn shifted(&self, shift: f64) -> Result<Matrix> {
        let mut sum = self.matrices.k.duplicate()?;
        sum.axpy(shift * shift, self.matrices.m)?;
        sum.axpy(shift, self.matrices.c)?;
        Ok(sum)
    }

    /// The stiffness with the points' tangents without friction's coupling: `S`, symmetric. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn symmetric_stiffness(&self) -> Result<Matrix> {
        let mut stiffness = self.k_symmetric.duplicate()?;
        if let Some(points) = self.points {
            points.contacts.add_blocks(points.symmetric.iter().copied(), &mut stiffness)?;
        }
        Ok(stiffness)
    }

    /// `K^T X - K X`: with contact points `-B^T (D - D^T) B X`, which takes their entries alone. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn skew_times(&self, x: &Block) -> Result<Block> {
        let Some(points) = self.points else {
            let mut difference = x.multiplied_by_transpose(self.matrices.k)?;
            difference.axpy(-1.0, &x.multiplied_by(self.matrices.k)?);
            return Ok(difference);
        };
        let skew = |d: Tangent| -> Tangent { from_fn(|i| from_fn(|j| d[j][i] - d[i][j])) };
        points.spread(points.tangents().map(skew), x)
    }
}

impl FrozenPoints<'_> {
    /// D of each point.
    pub fn tangents(&self) -> impl Iterator<Item = Tangent> {
        self.responses.iter().map(|response| response.tangent)
    }

    /// How the points' part of the stiffness has changed since they had other tangents, times X: `B^T (D - D_before) B
    /// X`. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn change_times(&self, before: &[Tangent], x: &Block) -> Result<Block> {
        let change = |(now, before): (Tangent, &Tangent)| from_fn(|i| from_fn(|j| now[i][j] - before[i][j]));
        self.spread(self.tangents().zip(before).map(change), x)
    }

    /// `B^T E B X`, E with a block for each point.
    fn spread(&self, blocks: impl Iterator<Item = Tangent>, x: &Block) -> Result<Block> {
        let blocks: Vec<(usize, Tangent)> = blocks.enumerate().filter(|(_, block)| *block != [[0.0; 3]; 3]).collect();
        let mut product = Block::zeros(x.comm(), x.n_local(), x.n_columns());
        for j in 0..x.n_columns() {
            let gaps = self.contacts.gaps(&x.vector(j)?)?;
            for (a, block) in &blocks {
                self.contacts.spread_into(*a, block.map(|row| dot(row, gaps[*a])), 1.0, product.column_mut(j));
            }
        }
        Ok(product)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::native::{Precision, Session};
    use crate::stability::testing::{Blocks, entries};

    #[test]
    fn a_factor_is_made_once_for_a_problem_and_a_shift() {
        let comm = Session::start(&[]).unwrap();
        let blocks = Blocks::new(&comm, 4);
        let mut factor = LabelledFactor::new(Precision::Double);
        let mut n_made = |problem: &QuadraticProblem, shift: f64| {
            problem.factorise(shift, &mut factor).unwrap();
            factor.factor().stats().n_factorisations
        };
        let first = |problem: &QuadraticProblem| {
            [
                n_made(problem, 0.0),
                n_made(problem, 0.0),
                n_made(problem, 3.0),
                n_made(problem, 3.0),
                n_made(problem, 0.0),
            ]
        };
        assert_eq!(blocks.with(0.5, &[], first), [1, 1, 2, 2, 3]);
        assert_eq!(blocks.with(0.5, &[], |problem| n_made(problem, 0.0)), 4, "another matrix");
    }

    #[test]
    fn the_label_has_the_points_only_where_their_tangents_are_factorised_as_they_are() {
        let comm = Session::start(&[]).unwrap();
        let blocks = Blocks::new(&comm, 4);
        let mut factor = LabelledFactor::new(Precision::Double);
        blocks.with(0.5, &[], |problem| {
            problem.factorise(0.0, &mut factor).unwrap();
            assert_eq!(factor.points(), problem.points.unwrap().responses);
            problem.factorise(2.0, &mut factor).unwrap();
            assert!(factor.points().is_empty() && factor.shift() == Some(2.0));
        });
    }

    #[test]
    fn the_factor_at_a_shift_inverts_the_polynomial_there() {
        let comm = Session::start(&[]).unwrap();
        let blocks = Blocks::new(&comm, 4);
        let mut factor = LabelledFactor::new(Precision::Double);
        blocks.with(0.5, &[], |problem| {
            let [m, c, k] = problem.matrices.map(entries).into_array();
            let shifted = entries(&problem.shifted(3.0).unwrap());
            assert!((&shifted - (9.0 * m + 3.0 * c + k)).norm() < 1e-10);
            let b = Block::from_columns(&comm, 12, (0..12).map(f64::from).collect());
            let x = b.solved_by(problem.factorise(3.0, &mut factor).unwrap()).unwrap();
            let residual =
                shifted * DMatrix::from_column_slice(12, 1, x.values()) - DMatrix::from_column_slice(12, 1, b.values());
            assert!(residual.norm() < 1e-10);
        });
    }

    #[test]
    fn contact_points_give_what_the_matrices_would() {
        let comm = Session::start(&[]).unwrap();
        let blocks = Blocks::new(&comm, 4);
        let x = Block::from_columns(&comm, 12, (0..24).map(|i| f64::from(i).sin()).collect());
        let values = |block: Block| DMatrix::from_column_slice(12, 2, block.values());
        let (first, before) = blocks.with(0.5, &[], |problem| {
            let k = entries(problem.matrices.k);
            let skew = values(problem.skew_times(&x).unwrap());
            assert!((skew - (k.transpose() - &k) * values(x.clone())).norm() < 1e-10);
            let plain = QuadraticProblem { points: None, ..*problem };
            let skew = values(plain.skew_times(&x).unwrap());
            assert!((skew - (k.transpose() - &k) * values(x.clone())).norm() < 1e-10);
            assert!((entries(&problem.symmetric_stiffness().unwrap()) - &k).norm() > 1.0);
            (k, problem.points.unwrap().tangents().collect::<Vec<_>>())
        });
        blocks.with(0.7, &[2], |problem| {
            let change = values(problem.points.unwrap().change_times(&before, &x).unwrap());
            assert!((change - (entries(problem.matrices.k) - &first) * values(x.clone())).norm() < 1e-10);
        });
    }
}
