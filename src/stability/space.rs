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
/// Columns keep at least this share of their length where V is left but once.
const CLEAR: f64 = 1e-4;
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

/// `V^T B W`, `W^T B V` and `W^T B W`.
struct Products {
    right: DMatrix<f64>,
    below: DMatrix<f64>,
    corner: DMatrix<f64>,
}

impl Products {
    /// `[V W]^T B [V W]` from `V^T B V`.
    fn joined_to(&self, old: &DMatrix<f64>) -> DMatrix<f64> {
        let (n, p) = self.right.shape();
        let mut new = DMatrix::zeros(n + p, n + p);
        new.view_mut((0, 0), (n, n)).copy_from(old);
        new.view_mut((0, n), (n, p)).copy_from(&self.right);
        new.view_mut((n, 0), (p, n)).copy_from(&self.below);
        new.view_mut((n, n), (p, p)).copy_from(&self.corner);
        new
    }
}

impl<'a> Space<'a> {
    /// Without any column.
    pub fn new(problem: Problem<'a>, side: Side) -> Space<'a> {
        Space::with_room(problem, side, 0)
    }

    /// Without any column, but room for some.
    pub fn with_room(problem: Problem<'a>, side: Side, n_columns: usize) -> Space<'a> {
        let (comm, n_local) = (problem.pencil.k.comm(), problem.pencil.k.n_local());
        let none = || DMatrix::zeros(0, 0);
        let v = Block::with_room(comm, n_local, n_columns);
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

    /// Appends `A^-1 R` as [`Space::extend_by_solves`], where the factor is in single precision with its digits squared: a residual is solved for,
    /// too. The factor is that of K. Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    pub fn extend_by_refined_solves(&mut self, r: &Block) -> Result<Block> {
        let mut x = self.solved(r)?;
        if !self.problem.factor.is_exact() {
            let mut residual = r.clone();
            residual.axpy(-1.0, &x.multiplied_by(self.problem.pencil.k)?);
            x.axpy(1.0, &self.solved(&residual)?);
        }
        self.n_solves += r.n_columns();
        self.extend(x)
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
    pub fn extend(&mut self, w: Block) -> Result<Block> {
        let w = self.what_is_new(w);
        let Pencil { m, c, .. } = *self.problem.pencil;
        let (mw, products) = self.products(m, &w)?;
        self.m = products.joined_to(&self.m);
        let (_, products) = self.products(c, &w)?;
        self.c = products.joined_to(&self.c);
        self.a = self.stiffness_products(&w)?.joined_to(&self.a);
        self.v.append(&w);
        Ok(mw)
    }

    /// An orthonormal basis of what V lacks of some columns. Projection on V and W needs independent columns and not orthogonal ones: V is
    /// left a second time only where that took most digits the first time, so that of V itself a part of 1e-5 may stay.
    fn what_is_new(&self, mut w: Block) -> Block {
        let mut is_clear = false;
        for _ in 0..2 {
            if !is_clear {
                let overlap = self.v.gram(&w);
                w.subtract(&self.v, &overlap);
                is_clear = w.lengths().into_iter().enumerate().all(|(j, length)| {
                    let taken = &overlap[j * self.v.n_columns()..(j + 1) * self.v.n_columns()];
                    length > CLEAR * taken.iter().map(|x| x * x).sum::<f64>().sqrt()
                });
            }
            let (mut basis, mut n) = w.orthonormalising(NEGLIGIBLE);
            // No space has more directions than equations; what is beyond is rounding.
            n = n.min(self.n_equations - self.v.n_columns());
            basis.truncate(n * w.n_columns());
            w = w.combined(&basis, n);
        }
        w
    }

    /// `B W`, and its products with V and W, with B one of M and C or, for left vectors, its transpose.
    fn products(&self, b: &Matrix, w: &Block) -> Result<(Block, Products)> {
        let product = w.multiplied_by(b)?;
        if self.problem.pencil.symmetric_mc {
            let right = self.v.gram(&product);
            let products = self.arranged(w, right.clone(), right, w.gram(&product));
            return Ok((product, products));
        }
        let (own, other) = self.own_first(product, w.multiplied_by_transpose(b)?);
        let products = self.arranged(w, self.v.gram(&own), self.v.gram(&other), w.gram(&own));
        Ok((own, products))
    }

    /// The products of `A W`. K and its transpose differ where contact points slide: a few rows tell the difference.
    fn stiffness_products(&self, w: &Block) -> Result<Products> {
        let kw = w.multiplied_by(self.problem.pencil.k)?;
        let (of_k, mut corner) = (self.v.gram(&kw), w.gram(&kw));
        let mut of_transpose = of_k.clone();
        let add = |to: &mut [f64], what: Vec<f64>| to.iter_mut().zip(what).for_each(|(x, y)| *x += y);
        let difference = self.problem.pencil.transposed_less_stiffness_times(w, &kw)?;
        add(&mut of_transpose, self.v.gram_of_few_rows(&difference));
        if self.side == Side::Left {
            add(&mut corner, w.gram_of_few_rows(&difference));
        }
        let (right, below) = self.own_first(of_k, of_transpose);
        Ok(self.arranged(w, right, below, corner))
    }

    /// What belongs to this side's own product and to the other one, of what belongs to that with a matrix and with its transpose.
    fn own_first<T>(&self, direct: T, transposed: T) -> (T, T) {
        match self.side {
            Side::Right => (direct, transposed),
            Side::Left => (transposed, direct),
        }
    }

    /// Column-major products as matrices.
    fn arranged(&self, w: &Block, right: Vec<f64>, below: Vec<f64>, corner: Vec<f64>) -> Products {
        let (n, p) = (self.v.n_columns(), w.n_columns());
        Products {
            right: DMatrix::from_vec(n, p, right),
            below: DMatrix::from_vec(n, p, below).transpose(),
            corner: DMatrix::from_vec(p, p, corner),
        }
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
            sum.axpy(1.0, &pencil.transposed_less_stiffness_times(&columns, &sum)?);
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
