//! A growing subspace with the projections of a pencil, for modes and for their left vectors.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::Pencil;
use crate::Result;
use crate::native::{Block, Factor, Noise};

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

/// What a search leaves for the next: orthonormal columns V with the projections of the pencil that they were found with.
pub(super) struct Start {
    v: Block,
    /// What combined the space's columns to V, which are orthonormal, too.
    q: DMatrix<f64>,
    m: DMatrix<f64>,
    c: DMatrix<f64>,
    k: DMatrix<f64>,
    /// The tangents of its contact points, and what M, C and the stiffness without contact were.
    tangents: Vec<[[f64; 3]; 3]>,
    versions: [[i64; 2]; 3],
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
#[derive(Clone)]
pub(super) struct Ritz {
    pub lambda: Complex64,
    pub re: Vec<f64>,
    pub im: Vec<f64>,
}

/// `[V W]^T B [V W]` from `V^T B V`, `[V W]^T B W` and `[V W]^T B^T W`.
fn joined(old: &DMatrix<f64>, columns: &DMatrix<f64>, rows: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, p) = (old.nrows(), columns.ncols());
    let mut new = DMatrix::zeros(n + p, n + p);
    new.view_mut((0, 0), (n, n)).copy_from(old);
    new.view_mut((n, 0), (p, n)).copy_from(&rows.rows(0, n).transpose());
    new.view_mut((0, n), (n + p, p)).copy_from(columns);
    new
}

/// Of M, C and the stiffness without contact.
fn versions(pencil: &Pencil) -> Result<[[i64; 2]; 3]> {
    Ok([pencil.m.version()?, pencil.c.version()?, pencil.k_symmetric.version()?])
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
        let (noise, n_equations) = (Noise::new(problem.labels), comm.sum(n_local));
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

    /// Begins with what another search for right vectors has left, with room for some columns more. Where the pencil differs from that search's in
    /// contact alone, so do the projections. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn started(problem: Problem<'a>, start: Start, n_columns: usize) -> Result<Space<'a>> {
        let mut space = Space::with_room(problem, Side::Right, start.v.n_columns() + n_columns);
        let points = problem.pencil.points.filter(|points| points.tangents.len() == start.tangents.len());
        match points {
            Some(points) if versions(problem.pencil)? == start.versions => {
                let change = start.v.gram_of_few_rows(&points.change_times(&start.tangents, &start.v)?);
                let n = start.v.n_columns();
                (space.m, space.c, space.a) = (start.m, start.c, start.k + DMatrix::from_vec(n, n, change));
                space.v.append(&start.v);
            }
            _ => {
                space.append(start.v)?;
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
        let projected = |a: &DMatrix<f64>| q.tr_mul(&(a * &q));
        let [m, c, k] = [&self.m, &self.c, &self.a].map(projected);
        let pencil = self.problem.pencil;
        let tangents = pencil.points.map_or(Vec::new(), |points| points.tangents.to_vec());
        let v = self.v.combined(q.as_slice(), q.ncols());
        Ok(Start { v, q, m, c, k, tangents, versions: versions(pencil)? })
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

    /// Appends what V lacks of some columns W, orthonormal, and their projections. Gives `M W`, transposed for left vectors.
    ///
    /// # Errors
    /// PETSc's.
    pub fn extend(&mut self, w: Block) -> Result<Block> {
        self.append(self.what_is_new(w)?)
    }

    /// Appends columns W that are orthonormal, to V as among themselves, and their projections. Gives `M W`, transposed for left vectors.
    ///
    /// # Errors
    /// PETSc's.
    pub fn append(&mut self, w: Block) -> Result<Block> {
        self.v.append(&w);
        let (n, p) = (self.v.n_columns(), w.n_columns());
        let mut images = self.images(&w)?;
        // One pass over V for all images: it is the longest of the operands.
        let products = self.v.gram(&images);
        let product = |i: usize| DMatrix::from_column_slice(n, p, &products[i * n * p..][..n * p]);
        let [m, c, k] = [0, 1, 2].map(product);
        let [m_t, c_t] = match self.problem.pencil.symmetric_mc {
            true => [m.clone(), c.clone()],
            false => [3, 4].map(product),
        };
        // K and its transpose differ where contact points slide: a few rows tell the difference.
        let difference = self.v.gram_of_few_rows(&self.problem.pencil.transposed_less_stiffness_times(&w)?);
        let k_t = &k + DMatrix::from_vec(n, p, difference);
        let (direct, transposed) = ([m, c, k], [m_t, c_t, k_t]);
        let ([m, c, a], [m_t, c_t, a_t]) = match self.side {
            Side::Right => (direct, transposed),
            Side::Left => (transposed, direct),
        };
        self.m = joined(&self.m, &m, &m_t);
        self.c = joined(&self.c, &c, &c_t);
        self.a = joined(&self.a, &a, &a_t);
        images.truncate(p);
        Ok(images)
    }

    /// `M W`, `C W` and `K W` side by side; where M and C are not symmetric, `M^T W` and `C^T W`, too.
    fn images(&self, w: &Block) -> Result<Block> {
        let Pencil { m, c, k, symmetric_mc, .. } = *self.problem.pencil;
        let p = w.n_columns();
        let mut images = Block::zeros(w.comm(), w.n_local(), if symmetric_mc { 3 * p } else { 5 * p });
        images.add_products(&[m, c, k], w, 0..p)?;
        if !symmetric_mc {
            images.set_columns(3 * p, &w.multiplied_by_transpose(m)?);
            images.set_columns(4 * p, &w.multiplied_by_transpose(c)?);
        }
        Ok(images)
    }

    /// An orthonormal basis of what V lacks of some columns. Projection on V and W needs independent columns and not orthogonal ones: V is
    /// left a second time only where that took most digits the first time, so that of V itself a part of 1e-5 may stay.
    fn what_is_new(&self, mut w: Block) -> Result<Block> {
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
            let (mut basis, mut n) = w.orthonormalising(NEGLIGIBLE)?;
            // No space has more directions than equations; what is beyond is rounding.
            n = n.min(self.n_equations - self.v.n_columns());
            basis.truncate(n * w.n_columns());
            w = w.combined(&basis, n);
        }
        Ok(w)
    }

    /// Vectors `x = V y`: columns 2i and 2i + 1 are real and imaginary part. Where a vector has fewer coefficients than V columns, the others
    /// are zero.
    pub fn vectors(&self, ritz: &[Ritz]) -> Block {
        self.v.combined(self.coefficients(ritz).as_slice(), 2 * ritz.len())
    }

    /// Vectors `x = V y` that a start spans, in the same form.
    pub fn vectors_within(&self, start: &Start, ritz: &[Ritz]) -> Block {
        start.v.combined(start.q.tr_mul(&self.coefficients(ritz)).as_slice(), 2 * ritz.len())
    }

    /// Real and imaginary parts of y as columns.
    fn coefficients(&self, ritz: &[Ritz]) -> DMatrix<f64> {
        let entry = |row: usize, column: usize| {
            let part = if column.is_multiple_of(2) { &ritz[column / 2].re } else { &ritz[column / 2].im };
            part.get(row).copied().unwrap_or_default()
        };
        DMatrix::from_fn(self.v.n_columns(), 2 * ritz.len(), entry)
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
        let mut coefficients = vec![0.0; 3 * n * n_columns];
        for j in 0..n_columns {
            for (i, r) in ritz.iter().enumerate() {
                let z = match (n_columns < SKETCH, j == 2 * i, j == 2 * i + 1) {
                    (true, true, _) => Complex64::ONE,
                    (true, _, true) => Complex64::I,
                    (true, ..) => continue,
                    (false, ..) => deviation(r) * Complex64::new(self.noise.normal(), self.noise.normal()),
                };
                for power in 0..3 {
                    let factor = z.conj() * r.lambda.powi(power as i32);
                    let column = &mut coefficients[(power * n_columns + j) * n..][..n];
                    let column = column.iter_mut().zip(r.re.iter().zip(&r.im));
                    column.for_each(|(a, (re, im))| *a += factor.re * re - factor.im * im);
                }
            }
        }
        let columns = self.v.combined(&coefficients, 3 * n_columns);
        let of = |power: usize| power * n_columns..(power + 1) * n_columns;
        let mut sum = Block::zeros(columns.comm(), columns.n_local(), n_columns);
        sum.add_products(&[pencil.k], &columns, of(0))?;
        if self.side == Side::Left {
            sum.axpy(1.0, &pencil.transposed_less_stiffness_times(&columns.columns(of(0)))?);
        }
        for (matrix, power) in [(pencil.c, 1), (pencil.m, 2)] {
            match self.side {
                Side::Left if !pencil.symmetric_mc => {
                    sum.axpy(1.0, &columns.columns(of(power)).multiplied_by_transpose(matrix)?);
                }
                _ => sum.add_products(&[matrix], &columns, of(power))?,
            }
        }
        Ok(sum)
    }
}
