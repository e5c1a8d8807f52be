//! A growing subspace with the projections of a pencil, for modes and for their left vectors.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::Pencil;
use crate::Result;
use crate::petsc::{Block, Factor, Matrix, Noise};

/// Random combinations of the residuals that join the space in a round.
pub(super) const SKETCH: usize = 24;
/// Directions this much smaller than the largest of their block add nothing.
const NEGLIGIBLE: f64 = 1e-7;

/// A pencil with what its solution needs.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// M, C and K.
    pub pencil: &'a Pencil<'a>,
    /// The factor of K.
    pub factor: &'a Factor,
    /// A number for each of this rank's equations, whatever the number of ranks.
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

/// Orthonormal columns V with the projections of M, C and A; A is K, or its transpose for left vectors.
pub(super) struct Space<'a> {
    problem: Problem<'a>,
    side: Side,
    pub v: Block,
    /// `A V`, kept because A is not symmetric.
    av: Block,
    pub m: DMatrix<f64>,
    pub c: DMatrix<f64>,
    pub a: DMatrix<f64>,
    noise: Noise<'a>,
    /// On all ranks.
    pub n_equations: usize,
    /// Right-hand sides solved for.
    pub n_solves: usize,
}

/// An eigenvalue with the coefficients of its vector in V.
pub(super) struct Ritz {
    pub lambda: Complex64,
    pub re: Vec<f64>,
    pub im: Vec<f64>,
}

impl<'a> Space<'a> {
    /// Without any column.
    pub fn new(problem: Problem<'a>, side: Side) -> Space<'a> {
        let (comm, n_local) = (problem.pencil.k.comm(), problem.pencil.k.n_local());
        let none = || DMatrix::zeros(0, 0);
        let [v, av] = [0, 1].map(|_| Block::zeros(comm, n_local, 0));
        let (noise, n_equations) = (Noise::new(problem.labels), comm.sum(n_local as f64) as usize);
        Space { problem, side, v, av, m: none(), c: none(), a: none(), noise, n_equations, n_solves: 0 }
    }

    /// Columns without order.
    pub fn random(&mut self, n_columns: usize) -> Block {
        let mut block = Block::zeros(self.v.comm(), self.v.n_local(), n_columns);
        (0..n_columns).for_each(|j| self.noise.fill(block.column_mut(j)));
        block
    }

    /// `A^-1 R`.
    fn solved(&self, r: &Block) -> Result<Block> {
        match self.side {
            Side::Right => r.solved_by(self.problem.factor),
            Side::Left => r.solved_by_transpose(self.problem.factor),
        }
    }

    /// Appends columns, as far as V lacks them.
    ///
    /// # Errors
    /// PETSc's.
    pub fn extend_by(&mut self, w: Block) -> Result<Block> {
        let image = match self.side {
            Side::Right => w.multiplied_by(self.problem.pencil.k)?,
            Side::Left => w.multiplied_by_transpose(self.problem.pencil.k)?,
        };
        self.extend(w, image)
    }

    /// Appends `A^-1 R`, of which V lacks some directions W. Gives `M W`.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    pub fn extend_by_solves(&mut self, r: Block) -> Result<Block> {
        let w = self.solved(&r)?;
        self.n_solves += w.n_columns();
        self.extend(w, r)
    }

    /// Appends what V lacks of some columns W, orthonormal, and their projections, given `A W`. Gives `M W`.
    fn extend(&mut self, mut w: Block, mut aw: Block) -> Result<Block> {
        for _ in 0..2 {
            // Whatever is done to W is done to A W.
            let overlap = self.v.gram(&w);
            w.axpy(-1.0, &self.v.combined(&overlap, w.n_columns()));
            aw.axpy(-1.0, &self.av.combined(&overlap, aw.n_columns()));
            let (mut basis, mut n) = w.orthonormalising(NEGLIGIBLE);
            // No space has more directions than equations; what is beyond is rounding.
            n = n.min(self.n_equations - self.v.n_columns());
            basis.truncate(n * w.n_columns());
            (w, aw) = (w.combined(&basis, n), aw.combined(&basis, n));
        }
        let pencil = self.problem.pencil;
        let mw = w.multiplied_by(pencil.m)?;
        self.m = self.growth(&self.m, &w, pencil.m)?;
        self.c = self.growth(&self.c, &w, pencil.c)?;
        self.a = general_growth(&self.a, [&self.v, &w], [&self.av, &aw]);
        self.v.append(&w);
        self.av.append(&aw);
        Ok(mw)
    }

    /// `B X`, with B one of M and C or, for left vectors, its transpose.
    fn product(&self, b: &Matrix, x: &Block) -> Result<Block> {
        match self.side {
            Side::Left if !self.problem.pencil.symmetric_mc => x.multiplied_by_transpose(b),
            _ => x.multiplied_by(b),
        }
    }

    /// `[V W]^T B [V W]` from `V^T B V`, with B one of M and C or, for left vectors, its transpose.
    fn growth(&self, old: &DMatrix<f64>, w: &Block, b: &Matrix) -> Result<DMatrix<f64>> {
        let bw = self.product(b, w)?;
        let mut new = symmetric_growth(old, &self.v, w, &bw);
        if !self.problem.pencil.symmetric_mc {
            let (n, p) = (self.v.n_columns(), w.n_columns());
            let transposed = if self.side == Side::Left { w.multiplied_by(b)? } else { w.multiplied_by_transpose(b)? };
            // W^T B V = (V^T B^T W)^T
            let side = DMatrix::from_vec(n, p, self.v.gram(&transposed));
            new.view_mut((n, 0), (p, n)).copy_from(&side.transpose());
        }
        Ok(new)
    }

    /// Vectors `x = V y`: columns 2i and 2i + 1 are real and imaginary part. Where a vector has fewer coefficients than V columns, the others
    /// are zero.
    pub fn vectors(&self, ritz: &[Ritz]) -> Block {
        let n = self.v.n_columns();
        let padded = |part: &[f64]| part.iter().copied().chain(std::iter::repeat(0.0)).take(n).collect::<Vec<f64>>();
        let y: Vec<f64> = ritz.iter().flat_map(|r| [&r.re, &r.im]).flat_map(|part| padded(part)).collect();
        self.v.combined(&y, 2 * ritz.len())
    }

    /// Real and imaginary parts of the residuals where they are few, else random combinations of them,
    /// `sum_i Re(z_ij^* P(lambda_i) V y_i)`, `z_ij` normal: column j is `A V a_j + C V b_j + M V d_j`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn sketch(&mut self, ritz: &[&Ritz]) -> Result<Block> {
        let (n, pencil) = (self.v.n_columns(), self.problem.pencil);
        let n_columns = SKETCH.min(2 * ritz.len());
        let mut coefficients = [0, 1, 2].map(|_| vec![0.0; n * n_columns]);
        for j in 0..n_columns {
            for (i, r) in ritz.iter().enumerate() {
                let z = match (n_columns < SKETCH, j == 2 * i, j == 2 * i + 1) {
                    (true, true, _) => Complex64::ONE,
                    (true, _, true) => Complex64::I,
                    (true, ..) => continue,
                    (false, ..) => Complex64::new(self.noise.normal(), self.noise.normal()),
                };
                for (power, a) in coefficients.iter_mut().enumerate() {
                    let factor = z.conj() * r.lambda.powu(power as u32);
                    let column = a[j * n..(j + 1) * n].iter_mut().zip(r.re.iter().zip(&r.im));
                    column.for_each(|(a, (re, im))| *a += factor.re * re - factor.im * im);
                }
            }
        }
        let [a, b, d] = coefficients;
        let mut sum = self.av.combined(&a, n_columns);
        sum.axpy(1.0, &self.product(pencil.c, &self.v.combined(&b, n_columns))?);
        sum.axpy(1.0, &self.product(pencil.m, &self.v.combined(&d, n_columns))?);
        Ok(sum)
    }
}

/// `[V W]^T A [V W]` from `V^T A V` and `A W`, A symmetric.
fn symmetric_growth(old: &DMatrix<f64>, v: &Block, w: &Block, aw: &Block) -> DMatrix<f64> {
    let (n, p) = (v.n_columns(), w.n_columns());
    let mut new = DMatrix::zeros(n + p, n + p);
    let side = DMatrix::from_vec(n, p, v.gram(aw));
    new.view_mut((0, 0), (n, n)).copy_from(old);
    new.view_mut((0, n), (n, p)).copy_from(&side);
    new.view_mut((n, 0), (p, n)).copy_from(&side.transpose());
    new.view_mut((n, n), (p, p)).copy_from(&DMatrix::from_vec(p, p, w.gram(aw)));
    new
}

/// `[V W]^T A [V W]` from `V^T A V`, `A V` and `A W`.
fn general_growth(old: &DMatrix<f64>, [v, w]: [&Block; 2], [av, aw]: [&Block; 2]) -> DMatrix<f64> {
    let (n, p) = (v.n_columns(), w.n_columns());
    let mut new = DMatrix::zeros(n + p, n + p);
    new.view_mut((0, 0), (n, n)).copy_from(old);
    new.view_mut((0, n), (n, p)).copy_from(&DMatrix::from_vec(n, p, v.gram(aw)));
    new.view_mut((n, 0), (p, n)).copy_from(&DMatrix::from_vec(p, n, w.gram(av)));
    new.view_mut((n, n), (p, p)).copy_from(&DMatrix::from_vec(p, p, w.gram(aw)));
    new
}
