//! A growing subspace with the projections of a quadratic problem, for modes and for their left vectors.

#[cfg(test)]
mod tests;

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::QuadraticProblem;
use crate::Result;
use crate::contact::Tangent;
use crate::native::{Block, Factor, Matrix, Mck, Noise};

/// Random combinations of the residuals that join the space in a round.
pub(super) const SKETCH: usize = 32;
/// Directions this much smaller than the largest of their block are rounding.
const NEGLIGIBLE_DIRECTION: f64 = 1e-7;
/// Columns that keep at least this share of their length are projected off V but once.
const KEPT_LENGTH: f64 = 1e-4;
/// The place of K among the terms of the polynomial.
const STIFFNESS: usize = 2;
/// No residual counts for more than that of a mode this far down, relative to the highest.
const MIN_MODULUS: f64 = 0.01;

/// A problem with what its solution needs.
#[derive(Clone, Copy)]
pub(super) struct FactoredProblem<'a> {
    pub problem: &'a QuadraticProblem<'a>,
    /// The factor of the real part of `P(sigma)` at a real shift, exact or not.
    pub factor: &'a Factor,
    /// A number for each of this rank's dofs, whatever the number of ranks.
    pub labels: &'a [u64],
}

/// Whose modes are sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// `P(lambda) x = 0`.
    Right,
    /// `P(lambda)^T v = 0`.
    Left,
}

/// Orthonormal columns V with the projections `V^T M V`, `V^T C V`, `V^T K V`, `V^T G V` and of viscoelastic
/// stiffnesses.
pub(super) struct Basis {
    v: Block,
    projected: Vec<DMatrix<f64>>,
}

/// What a search leaves for the next: orthonormal columns V with the projections of the problem that they were found
/// with.
pub(super) struct Start {
    basis: Basis,
    /// What combined the space's columns to V, which are orthonormal, too.
    q: DMatrix<f64>,
    /// The tangents of its contact points.
    tangents: Vec<Tangent>,
    /// Of M, C, G and the stiffness without contact.
    versions: Mck<[i64; 2]>,
}

/// Orthonormal columns V with the projections of M, C, K, G and viscoelastic stiffnesses, or of their transposes for
/// left vectors.
pub(super) struct Space<'a> {
    searched: FactoredProblem<'a>,
    side: Side,
    pub v: Block,
    /// In the order of [`QuadraticProblem::all_matrices`].
    pub projected: Vec<DMatrix<f64>>,
    noise: Noise<'a>,
    /// On all ranks.
    pub n_dofs: usize,
    /// Right-hand sides solved for.
    pub n_solves: usize,
}

/// An eigenvalue with the coefficients of its vector in V.
#[derive(Clone)]
pub(super) struct Ritz {
    pub lambda: Complex64,
    pub re: Vec<f64>,
    pub im: Vec<f64>,
}

/// `[V W]^T A [V W]` from `V^T A V`, `[V W]^T A W` and `[V W]^T A^T W`.
fn joined(old: &DMatrix<f64>, columns: &DMatrix<f64>, rows: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, p) = (old.nrows(), columns.ncols());
    let mut new = DMatrix::zeros(n + p, n + p);
    new.view_mut((0, 0), (n, n)).copy_from(old);
    new.view_mut((n, 0), (p, n)).copy_from(&rows.rows(0, n).transpose());
    new.view_mut((0, n), (n + p, p)).copy_from(columns);
    new
}

/// Of M, C, G and the stiffness without contact.
fn versions(problem: &QuadraticProblem) -> Result<Mck<[i64; 2]>> {
    Mck { k: problem.k_symmetric, ..problem.matrices }.try_map(Matrix::version)
}

impl<'a> Space<'a> {
    /// Without any column, but memory for some.
    pub fn with_capacity(searched: FactoredProblem<'a>, side: Side, n_columns: usize) -> Space<'a> {
        let problem = searched.problem;
        let v = Block::with_room(problem.comm(), problem.n_local(), n_columns);
        let projected = vec![DMatrix::zeros(0, 0); problem.all_matrices().len()];
        let (noise, n_dofs) = (Noise::new(searched.labels), problem.n_dofs());
        Space { searched, side, v, projected, noise, n_dofs, n_solves: 0 }
    }

    /// For left vectors, with the columns that a search for right ones has left.
    pub fn of_left_vectors(searched: FactoredProblem<'a>, basis: Basis) -> Space<'a> {
        let Basis { v, projected } = basis;
        let mut space = Space { v, projected, ..Space::with_capacity(searched, Side::Right, 0) };
        space.transpose();
        space
    }

    /// For left vectors, spanned by some columns.
    pub fn spanned(searched: FactoredProblem<'a>, columns: Block) -> Result<Space<'a>> {
        let mut space = Space::with_capacity(searched, Side::Left, 0);
        space.extend(columns)?;
        Ok(space)
    }

    /// Begins with what another search for right vectors has left, with memory for some columns more. Where the problem
    /// differs from that search's in contact alone, so do the projections. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn started(searched: FactoredProblem<'a>, start: Start, n_columns: usize) -> Result<Space<'a>> {
        let Basis { v, mut projected } = start.basis;
        let mut space = Space::with_capacity(searched, Side::Right, v.n_columns() + n_columns);
        let points = searched.problem.points.filter(|points| points.responses.len() == start.tangents.len());
        match points {
            Some(points) if versions(searched.problem)? == start.versions => {
                let change = v.gram_of_few_rows(&points.change_times(&start.tangents, &v)?);
                projected[STIFFNESS] += DMatrix::from_vec(v.n_columns(), v.n_columns(), change);
                space.projected = projected;
                space.v.append(&v);
            }
            _ => {
                space.append(v)?;
            }
        }
        Ok(space)
    }

    /// What the next search may start from: combinations of V's columns that span some vectors.
    ///
    /// # Errors
    /// PETSc's.
    pub fn start(&self, ritz: &[Ritz]) -> Result<Start> {
        let q = self.coefficients(ritz).qr().q();
        let projected = self.projected.iter().map(|a| q.tr_mul(&(a * &q))).collect();
        let v = self.v.combined(q.as_slice(), q.ncols());
        let tangents = self.problem().points.map_or(Vec::new(), |points| points.tangents().collect());
        Ok(Start { basis: Basis { v, projected }, q, tangents, versions: versions(self.problem())? })
    }

    /// What is left of a space of right vectors.
    pub fn into_basis(self) -> Basis {
        Basis { v: self.v, projected: self.projected }
    }

    /// Exchanges right and left: from now on the space is one for the transposed problem.
    pub fn transpose(&mut self) {
        self.side = if self.side == Side::Left { Side::Right } else { Side::Left };
        self.projected.iter_mut().for_each(|a| *a = a.transpose());
    }

    /// The problem.
    pub fn problem(&self) -> &'a QuadraticProblem<'a> {
        self.searched.problem
    }

    /// Columns without order.
    pub fn random(&mut self, n_columns: usize) -> Block {
        let mut block = Block::zeros(self.v.comm(), self.v.n_local(), n_columns);
        (0..n_columns).for_each(|j| self.noise.fill(block.column_mut(j)));
        block
    }

    /// Appends `K^-1 R` (`K^-T R` for left vectors) as far as V lacks it: W. Gives `M W`.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    pub fn extend_by_solves(&mut self, r: &Block) -> Result<Block> {
        self.n_solves += r.n_columns();
        self.extend(match self.side {
            Side::Right => r.solved_by(self.searched.factor)?,
            Side::Left => r.solved_by_transpose(self.searched.factor)?,
        })
    }

    /// Appends what V lacks of some columns W, orthonormal, and their projections. Gives `M W`, transposed for left
    /// vectors.
    ///
    /// # Errors
    /// PETSc's.
    pub fn extend(&mut self, w: Block) -> Result<Block> {
        self.append(self.what_is_new(w)?)
    }

    /// Appends columns W that are orthonormal, to V as among themselves, and their projections. Gives `M W`, transposed
    /// for left vectors.
    ///
    /// # Errors
    /// PETSc's.
    fn append(&mut self, w: Block) -> Result<Block> {
        self.v.append(&w);
        let (n, p) = (self.v.n_columns(), w.n_columns());
        let mut images = self.images(&w)?;
        // One pass over V for all images: it is the longest of the operands.
        let products = self.v.gram(&images);
        let product = |i: usize| DMatrix::from_column_slice(n, p, &products[i * n * p..(i + 1) * n * p]);
        let n_matrices = self.projected.len();
        let direct: Vec<DMatrix<f64>> = (0..n_matrices).map(product).collect();
        // K and its transpose differ where contact points slide: a few rows hold the difference. Viscoelastic
        // stiffnesses are symmetric.
        let mut transposed = direct.clone();
        let skew = self.v.gram_of_few_rows(&self.problem().skew_times(&w)?);
        transposed[STIFFNESS] += DMatrix::from_vec(n, p, skew);
        for ((place, _), own) in self.unsymmetric().into_iter().zip(n_matrices..) {
            transposed[place] = product(own);
        }
        let (columns, rows) = match self.side {
            Side::Right => (direct, transposed),
            Side::Left => (transposed, direct),
        };
        let old = self.projected.iter().zip(columns.iter().zip(&rows));
        self.projected = old.map(|(old, (new, new_t))| joined(old, new, new_t)).collect();
        images.truncate(p);
        Ok(images)
    }

    /// `M W`, `C W`, `K W` and so on side by side, then the transposed ones of the matrices that are not symmetric.
    fn images(&self, w: &Block) -> Result<Block> {
        let (direct, transposed, p) = (self.problem().all_matrices(), self.unsymmetric(), w.n_columns());
        let mut images = Block::zeros(w.comm(), w.n_local(), (direct.len() + transposed.len()) * p);
        images.add_products(&direct, w, 0..p)?;
        for (i, (_, matrix)) in (direct.len()..).zip(transposed) {
            images.set_columns(i * p, &w.multiplied_by_transpose(matrix)?);
        }
        Ok(images)
    }

    /// Where M, C and G are not symmetric, these, with their places among the terms.
    fn unsymmetric(&self) -> Vec<(usize, &'a Matrix)> {
        let Mck { m, c, g, .. } = self.problem().matrices;
        let all = [(0, m), (1, c)].into_iter().chain(g.map(|g| (STIFFNESS + 1, g)));
        all.filter(|_| !self.problem().symmetric_mc).collect()
    }

    /// An orthonormal basis of what V lacks of some columns. Projection on V and W needs independent columns and not
    /// orthogonal ones: V is left a second time only where that took most digits the first time, so that of V itself a
    /// part of 1e-5 may stay.
    fn what_is_new(&self, mut w: Block) -> Result<Block> {
        let mut is_clear = false;
        for _ in 0..2 {
            if !is_clear {
                let overlap = self.v.gram(&w);
                w.subtract(&self.v, &overlap);
                is_clear = w.lengths().into_iter().enumerate().all(|(j, length)| {
                    let taken = &overlap[j * self.v.n_columns()..(j + 1) * self.v.n_columns()];
                    length > KEPT_LENGTH * taken.iter().map(|x| x * x).sum::<f64>().sqrt()
                });
            }
            // No space has more directions than dofs; what is beyond is rounding.
            w = w.orthonormalised(NEGLIGIBLE_DIRECTION, self.n_dofs - self.v.n_columns())?;
        }
        Ok(w)
    }

    /// Vectors `x = V y`: columns 2i and 2i + 1 are real and imaginary part. Where a vector has fewer coefficients than
    /// V columns, the others are zero.
    pub fn vectors(&self, ritz: &[Ritz]) -> Block {
        self.v.combined(self.coefficients(ritz).as_slice(), 2 * ritz.len())
    }

    /// Vectors `x = V y` that a start spans, in the same form.
    pub fn vectors_within(&self, start: &Start, ritz: &[Ritz]) -> Block {
        start.basis.v.combined(start.q.tr_mul(&self.coefficients(ritz)).as_slice(), 2 * ritz.len())
    }

    /// Real and imaginary parts of y as columns.
    fn coefficients(&self, ritz: &[Ritz]) -> DMatrix<f64> {
        let entry = |row: usize, column: usize| {
            let part = if column.is_multiple_of(2) { &ritz[column / 2].re } else { &ritz[column / 2].im };
            part.get(row).copied().unwrap_or_default()
        };
        DMatrix::from_fn(self.v.n_columns(), 2 * ritz.len(), entry)
    }

    /// Real and imaginary parts of the residuals where they are few, else random combinations of them, `sum_i Re(z_ij^*
    /// P(lambda_i) V y_i)`, `z_ij` normal with the deviation `|lambda_i|^-2`, which makes residuals count as they
    /// change eigenvalues, relatively. Column j is `M V a_j + C V b_j + K V c_j + G V d_j`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn sketch(&mut self, ritz: &[&Ritz]) -> Result<Block> {
        let (n, problem) = (self.v.n_columns(), self.problem());
        let matrices = problem.all_matrices();
        let weights = self.sketch_weights(ritz);
        let n_columns = weights.ncols();
        let mut coefficients = vec![0.0; matrices.len() * n * n_columns];
        for (j, (i, r)) in (0..n_columns).flat_map(|j| ritz.iter().enumerate().map(move |pair| (j, pair))) {
            let z = weights[(i, j)];
            if z == Complex64::ZERO {
                continue;
            }
            for (term, factor) in problem.coefficients(r.lambda).into_iter().enumerate() {
                let factor = z.conj() * factor;
                let column = &mut coefficients[(term * n_columns + j) * n..][..n];
                let column = column.iter_mut().zip(r.re.iter().zip(&r.im));
                column.for_each(|(a, (re, im))| *a += factor.re * re - factor.im * im);
            }
        }
        let columns = self.v.combined(&coefficients, matrices.len() * n_columns);
        let of = |term: usize| term * n_columns..(term + 1) * n_columns;
        let mut sum = Block::zeros(columns.comm(), columns.n_local(), n_columns);
        for (term, matrix) in matrices.into_iter().enumerate() {
            match self.side {
                Side::Left if !problem.symmetric_mc => {
                    sum.axpy(1.0, &columns.columns(of(term)).multiplied_by_transpose(matrix)?);
                }
                _ => sum.add_products(&[matrix], &columns, of(term))?,
            }
        }
        if self.side == Side::Left && problem.symmetric_mc {
            sum.axpy(1.0, &problem.skew_times(&columns.columns(of(STIFFNESS)))?);
        }
        Ok(sum)
    }

    /// `z_ij`: by rows for vectors, by columns for the sketch.
    fn sketch_weights(&mut self, ritz: &[&Ritz]) -> DMatrix<Complex64> {
        if 2 * ritz.len() < SKETCH {
            let part = |i: usize, j: usize| match j.checked_sub(2 * i) {
                Some(0) => Complex64::ONE,
                Some(1) => Complex64::I,
                _ => Complex64::ZERO,
            };
            return DMatrix::from_fn(ritz.len(), 2 * ritz.len(), part);
        }
        let largest = ritz.iter().map(|r| r.lambda.norm()).fold(0.0, f64::max);
        // A rigid-body mode's zero counts like a low mode.
        let deviation = |r: &Ritz| r.lambda.norm().max(MIN_MODULUS * largest).powi(-2);
        let noise = &mut self.noise;
        let mut normal = |i: usize, _| deviation(ritz[i]) * Complex64::new(noise.normal(), noise.normal());
        DMatrix::from_fn(ritz.len(), SKETCH, &mut normal)
    }
}
