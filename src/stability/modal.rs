//! A densely stored pencil in the modal coordinates of a reference.
//!
//! `K_0 = S + sum B_a^T D_0a B_a` is the symmetric stiffness, without friction's coupling, of the first pencil seen. With its modes, of energy 1,
//! other pencils of the structure are
//!
//! ```text
//! Phi^T K_0 Phi = I      Phi^T M Phi = diag(1 / omega^2)      Phi^T K Phi = I + sum Phi^T B_a^T (D_a - D_0a) B_a Phi = I + U W^T
//! (I + U W^T)^-1 = I - U (I + W^T U)^-1 W^T
//! ```
//!
//! (Woodbury), where a sliding point's tangent differs by rank 1. A step of a Krylov method then goes through C, U and W, where it went through
//! M, C and a factor of K, and no coordinate is left out. That K_0 becomes the identity, and not M, keeps the low modes' digits: rounding is relative
//! to each mode's energy, and not to the highest mode's.

use nalgebra::{DMatrix, Matrix3};

use super::space::Side;
use super::{Mode, Pencil, Points};
use crate::Result;
use crate::native::petsc::eigen::{self, Found, Options, Pair, Quadratic};
use crate::native::{Block, Matrix, Vector, lapack};

/// A change of a point's tangent this much smaller than the tangent itself is none.
const NEGLIGIBLE: f64 = 1e-15;

/// An eigenvalue found twice differs by no more, relatively, and no other is as near as the second.
const SAME: f64 = 1e-9;
const APART: f64 = 1e-6;

/// The reference, and what of a pencil does not change with friction.
pub struct Modal {
    /// Modes of the reference as columns.
    phi: Block,
    /// `Phi^T K_0 Phi` and `Phi^T M Phi`.
    k: Matrix,
    m: Matrix,
    /// `D_0`, N/m.
    tangents: Vec<[[f64; 3]; 3]>,
    /// `Phi^T B_a^T`, three columns for each point.
    traces: Vec<f64>,
    /// The damping seen last, and `Phi^T C Phi`.
    damping: Option<(Vec<f64>, Matrix)>,
    /// Of the last search.
    options: Option<Options>,
}

/// `U (I + W^T U)^-1` and W, column by column.
struct Update {
    u: Vec<f64>,
    w: Vec<f64>,
}

impl Modal {
    /// The coordinates that a pencil's symmetric part gives; none where it is not stored densely, or its stiffness not positive definite.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(pencil: &Pencil) -> Result<Option<Modal>> {
        let Some(points) = pencil.points else { return Ok(None) };
        let k_0 = pencil.symmetric_stiffness()?;
        let (Some(stiffness), Some(mut modes)) = (k_0.dense_values()?, pencil.m.dense_values()?) else {
            return Ok(None);
        };
        let (comm, n) = (pencil.k.comm(), pencil.k.n_local());
        let Some(flexibilities) = lapack::generalised_eigen(n, &mut modes, stiffness) else { return Ok(None) };
        let phi = Block::from_columns(comm, n, modes);
        let unit = |e: usize| std::array::from_fn(|i| if i == e { 1.0 } else { 0.0 });
        let directions: Vec<(usize, [f64; 3])> =
            (0..3 * points.symmetric.len()).map(|j| (j / 3, unit(j % 3))).collect();
        let traces = phi.gram(&points.contacts.loads(comm, &directions));
        let (k, m) = (Matrix::diagonal(comm, &vec![1.0; n])?, Matrix::diagonal(comm, &flexibilities)?);
        Ok(Some(Modal { phi, k, m, tangents: points.symmetric.to_vec(), traces, damping: None, options: None }))
    }

    /// Eigenpairs of a pencil with the same M, S and contact points, as [`eigen::solve_or_none`] finds them.
    ///
    /// # Errors
    /// PETSc's.
    pub fn solve(
        &mut self,
        pencil: &Pencil,
        options: &Options,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<Option<Found>> {
        self.options = Some(*options);
        self.search(pencil, Side::Right, options, progress)
    }

    /// `v` with `P(lambda)^T v = 0` for modes of the last pencil solved: columns `2i` and `2i + 1` are the real and imaginary part for mode i. From a
    /// search of its own with K transposed; none where that does not find each eigenvalue again, apart from all others.
    ///
    /// # Errors
    /// PETSc's.
    pub fn left_vectors(&mut self, pencil: &Pencil, modes: &[Mode]) -> Result<Option<Block>> {
        let Some(options) = self.options else { return Ok(None) };
        let Some(found) = self.search(pencil, Side::Left, &options, &mut |_, _| ())? else { return Ok(None) };
        let mut vectors = Block::zeros(pencil.k.comm(), pencil.k.n_local(), 2 * modes.len());
        for (i, mode) in modes.iter().enumerate() {
            let near = |pair: &&Pair, share: f64| (pair.lambda - mode.lambda).norm() <= share * mode.lambda.norm();
            let mut neighbours = found.pairs.iter().filter(|pair| near(pair, APART));
            let (Some(pair), None) = (neighbours.next(), neighbours.next()) else { return Ok(None) };
            if !near(&pair, SAME) {
                return Ok(None);
            }
            pair.re.local(|values| vectors.column_mut(2 * i).copy_from_slice(values))?;
            pair.im.local(|values| vectors.column_mut(2 * i + 1).copy_from_slice(values))?;
        }
        Ok(Some(vectors))
    }

    /// Eigenpairs of a pencil, or of the transposed one.
    fn search(
        &mut self,
        pencil: &Pencil,
        side: Side,
        options: &Options,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<Option<Found>> {
        let Some(points) = pencil.points.filter(|_| pencil.symmetric_mc) else { return Ok(None) };
        let Some(update) = self.update(&points, side) else { return Ok(None) };
        self.bring_damping(pencil)?;
        let Some((_, c)) = &self.damping else { return Ok(None) };
        let inverse = |b: &Vector, x: &mut Vector| b.local(|b| x.local_mut(|x| update.solve(b, x)))?;
        let problem = Quadratic { m: &self.m, c, k: &self.k, shift: 0.0, inverse: &inverse };
        let Some(found) = eigen::solve_or_none(&problem, options, progress)? else { return Ok(None) };
        let mut coordinates = Vec::new();
        for vector in found.pairs.iter().flat_map(|pair| [&pair.re, &pair.im]) {
            vector.local(|values| coordinates.extend_from_slice(values))?;
        }
        let vectors = self.phi.combined(&coordinates, 2 * found.pairs.len());
        let pair = |(i, pair): (usize, &Pair)| {
            Ok(Pair { lambda: pair.lambda, re: vectors.vector(2 * i)?, im: vectors.vector(2 * i + 1)? })
        };
        let pairs = found.pairs.iter().enumerate().map(pair).collect::<Result<Vec<Pair>>>()?;
        Ok(Some(Found { pairs, ..found }))
    }

    /// `Phi^T C Phi`, made anew where C is another.
    fn bring_damping(&mut self, pencil: &Pencil) -> Result<()> {
        let Some(values) = pencil.c.dense_values()? else { return Ok(()) };
        if self.damping.as_ref().is_none_or(|(last, _)| *last != values) {
            let projected = self.phi.gram(&self.phi.multiplied_by(pencil.c)?);
            let n = self.phi.n_columns();
            // Stored by rows.
            let by_rows = DMatrix::from_vec(n, n, projected).transpose();
            self.damping = Some((values, Matrix::dense(pencil.c.comm(), n, by_rows.as_slice())?));
        }
        Ok(())
    }

    /// What the tangents, or the transposed ones, add to `I`; none where the sum is singular.
    fn update(&self, points: &Points, side: Side) -> Option<Update> {
        let n = self.phi.n_columns();
        let (mut u, mut w) = (Vec::new(), Vec::new());
        let pairs = self.tangents.iter().zip(points.tangents).enumerate();
        for (a, (old, new)) in pairs.filter(|(_, (old, new))| old != new) {
            // Stored by columns: `from` would take these rows for columns.
            let [old, new] = [old, new].map(|d| Matrix3::from(*d).transpose());
            let svd = (new - old).svd(true, true);
            let (left, right) = svd.u.zip(svd.v_t)?;
            for k in (0..3).filter(|&k| svd.singular_values[k] > NEGLIGIBLE * old.norm().max(new.norm())) {
                let along = |direction: [f64; 3], columns: &mut Vec<f64>| {
                    let trace = |i: usize| (0..3).map(|e| self.traces[(3 * a + e) * n + i] * direction[e]).sum::<f64>();
                    columns.extend((0..n).map(trace));
                };
                along((left.column(k) * svd.singular_values[k]).into(), &mut u);
                along(right.row(k).transpose().into(), &mut w);
            }
        }
        if side == Side::Left {
            std::mem::swap(&mut u, &mut w);
        }
        let rank = u.len() / n.max(1);
        let mut small = vec![0.0; rank * rank];
        lapack::multiply(true, [rank, n, rank], &w, &u, &mut small);
        let inverse = (DMatrix::identity(rank, rank) + DMatrix::from_vec(rank, rank, small)).try_inverse()?;
        let mut scaled = vec![0.0; u.len()];
        lapack::multiply(false, [n, rank, rank], &u, inverse.as_slice(), &mut scaled);
        Some(Update { u: scaled, w })
    }
}

impl Update {
    /// `x = b - U (I + W^T U)^-1 W^T b`
    fn solve(&self, b: &[f64], x: &mut [f64]) {
        let (n, rank) = (b.len(), self.w.len() / b.len().max(1));
        let mut coefficients = vec![0.0; rank];
        lapack::multiply(true, [rank, n, 1], &self.w, b, &mut coefficients);
        x.copy_from_slice(b);
        lapack::subtract_product([n, rank, 1], &self.u, &coefficients, x);
    }
}
