//! A growing subspace with the projections of a pencil, for modes and for their left vectors.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::Pencil;
use crate::Result;
use crate::petsc::{Block, Factor, Matrix, Noise};

/// Random combinations of the residuals that join the space in a round.
pub(super) const SKETCH: usize = 32;
/// Directions this much smaller than the largest of their block add nothing.
const NEGLIGIBLE: f64 = 1e-7;
/// No residual counts for more than that of a mode this far down, relative to the highest.
const LOWEST: f64 = 0.01;

/// A pencil with what its solution needs.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// M, C and K.
    pub pencil: &'a Pencil<'a>,
    /// The factor of `P(sigma)` at a real shift, exact or not.
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

/// Orthonormal columns V with the projections `V^T M V`, `V^T C V` and `V^T K V`.
pub struct Basis {
    v: Block,
    m: DMatrix<f64>,
    c: DMatrix<f64>,
    k: DMatrix<f64>,
}

/// Orthonormal columns V with the projections of M, C and A; A is K, or all are transposed for left vectors.
pub(super) struct Space<'a> {
    problem: Problem<'a>,
    side: Side,
    pub v: Block,
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
        let v = Block::zeros(comm, n_local, 0);
        let (noise, n_equations) = (Noise::new(problem.labels), comm.sum(n_local as f64) as usize);
        Space { problem, side, v, m: none(), c: none(), a: none(), noise, n_equations, n_solves: 0 }
    }

    /// For left vectors, with the columns that a search for right ones has left.
    pub fn of_left_vectors(problem: Problem<'a>, basis: Basis) -> Space<'a> {
        let Basis { v, m, c, k } = basis;
        Space { v, m: m.transpose(), c: c.transpose(), a: k.transpose(), ..Space::new(problem, Side::Left) }
    }

    /// For left vectors, spanned by some columns.
    pub fn spanned(problem: Problem<'a>, columns: Block) -> Result<Space<'a>> {
        let mut space = Space::new(problem, Side::Left);
        space.extend(columns)?;
        Ok(space)
    }

    /// What is left of a space of right vectors.
    pub fn into_basis(self) -> Basis {
        let Space { v, m, c, a: k, .. } = self;
        Basis { v, m, c, k }
    }

    /// M, C and K.
    pub fn pencil(&self) -> &Pencil<'a> {
        self.problem.pencil
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

    /// Appends `A^-1 R`, as far as V lacks it: W. Gives `M W`.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    pub fn extend_by_solves(&mut self, r: &Block) -> Result<Block> {
        self.n_solves += r.n_columns();
        self.extend(self.solved(r)?)
    }

    /// Appends what V lacks of some columns W, orthonormal, and their projections. Gives `M W`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn extend(&mut self, mut w: Block) -> Result<Block> {
        for _ in 0..2 {
            let overlap = self.v.gram(&w);
            w.subtract(&self.v, &overlap);
            let (mut basis, mut n) = w.orthonormalising(NEGLIGIBLE);
            // No space has more directions than equations; what is beyond is rounding.
            n = n.min(self.n_equations - self.v.n_columns());
            basis.truncate(n * w.n_columns());
            w = w.combined(&basis, n);
        }
        let Pencil { m, c, k, .. } = *self.problem.pencil;
        let (mw, below) = self.images(m, &w)?;
        self.m = self.growth(&self.m, &w, &mw, below.as_ref());
        let (cw, below) = self.images(c, &w)?;
        self.c = self.growth(&self.c, &w, &cw, below.as_ref());
        drop((cw, below));
        let kw = w.multiplied_by(k)?;
        let transposed = self.problem.pencil.transposed_stiffness_times(&w, &kw)?;
        let (aw, below) = self.own_first(kw, transposed);
        self.a = self.growth(&self.a, &w, &aw, Some(&below));
        self.v.append(&w);
        Ok(mw)
    }

    /// `B X` with B one of M and C or, for left vectors, its transpose; and `B^T X` where that is something else.
    fn images(&self, b: &Matrix, x: &Block) -> Result<(Block, Option<Block>)> {
        let product = x.multiplied_by(b)?;
        if self.problem.pencil.symmetric_mc {
            return Ok((product, None));
        }
        let (own, other) = self.own_first(product, x.multiplied_by_transpose(b)?);
        Ok((own, Some(other)))
    }

    /// The product of this side, then the other one, of those with a matrix and with its transpose.
    fn own_first(&self, product: Block, transposed: Block) -> (Block, Block) {
        match self.side {
            Side::Right => (product, transposed),
            Side::Left => (transposed, product),
        }
    }

    /// `[V W]^T B [V W]` from `V^T B V`, `B W` and `B^T W`, which is the same where it is not given.
    fn growth(&self, old: &DMatrix<f64>, w: &Block, bw: &Block, transposed: Option<&Block>) -> DMatrix<f64> {
        let (n, p) = (self.v.n_columns(), w.n_columns());
        let mut new = DMatrix::zeros(n + p, n + p);
        new.view_mut((0, 0), (n, n)).copy_from(old);
        let right = DMatrix::from_vec(n, p, self.v.gram(bw));
        // W^T B V = (V^T B^T W)^T
        let below = transposed.map(|transposed| DMatrix::from_vec(n, p, self.v.gram(transposed)));
        new.view_mut((n, 0), (p, n)).copy_from(&below.as_ref().unwrap_or(&right).transpose());
        new.view_mut((0, n), (n, p)).copy_from(&right);
        new.view_mut((n, n), (p, p)).copy_from(&DMatrix::from_vec(p, p, w.gram(bw)));
        new
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
    /// `sum_i Re(z_ij^* P(lambda_i) V y_i)`, `z_ij` normal with the deviation `|lambda_i|^-2`, which makes residuals count as they
    /// change eigenvalues, relatively. Column j is `K V a_j + C V b_j + M V c_j`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn sketch(&mut self, ritz: &[&Ritz]) -> Result<Block> {
        let (n, pencil) = (self.v.n_columns(), self.problem.pencil);
        let n_columns = SKETCH.min(2 * ritz.len());
        let largest = ritz.iter().map(|r| r.lambda.norm()).fold(0.0, f64::max);
        // A rigid motion's zero counts like a low mode.
        let deviation = |r: &Ritz| r.lambda.norm().max(LOWEST * largest).powi(-2);
        let mut coefficients = [0, 1, 2].map(|power| (power, vec![0.0; n * n_columns]));
        for j in 0..n_columns {
            for (i, r) in ritz.iter().enumerate() {
                let z = match (n_columns < SKETCH, j == 2 * i, j == 2 * i + 1) {
                    (true, true, _) => Complex64::ONE,
                    (true, _, true) => Complex64::I,
                    (true, ..) => continue,
                    (false, ..) => deviation(r) * Complex64::new(self.noise.normal(), self.noise.normal()),
                };
                for (power, a) in &mut coefficients {
                    let factor = z.conj() * r.lambda.powi(*power);
                    let column = a[j * n..(j + 1) * n].iter_mut().zip(r.re.iter().zip(&r.im));
                    column.for_each(|(a, (re, im))| *a += factor.re * re - factor.im * im);
                }
            }
        }
        let columns = self.v.combined(&coefficients[0].1, n_columns);
        let mut sum = columns.multiplied_by(pencil.k)?;
        if self.side == Side::Left {
            sum = pencil.transposed_stiffness_times(&columns, &sum)?;
        }
        for (matrix, (_, coefficients)) in [pencil.c, pencil.m].into_iter().zip(&coefficients[1..]) {
            let columns = self.v.combined(coefficients, n_columns);
            let product = match self.side {
                Side::Left if !pencil.symmetric_mc => columns.multiplied_by_transpose(matrix)?,
                _ => columns.multiplied_by(matrix)?,
            };
            sum.axpy(1.0, &product);
        }
        Ok(sum)
    }
}
