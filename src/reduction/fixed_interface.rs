//! Fixed-interface modes: the lowest modes of `K x = omega^2 M x` on a subspace, by block Lanczos on the inverse.
//!
//! With `A r` the solution of the constrained static problem under r, the modes satisfy `A M x = theta x`, `theta =
//! 1/omega^2`, where `A M` is symmetric in the inner product of M. The block Krylov basis V (`V^T M V = I`) is
//! orthogonalised in full, twice; `T = V^T M A M V` gives the Ritz pairs `(theta, V s)`, whose residual is `|R s_last|`
//! with the block R that leads out of the space. Blocks ask the factor for many solves at once, and find the doublets
//! of a disc together.
//!
//! Source: G. H. Golub, R. Underwood, *The block Lanczos method for computing eigenvalues* (1977); Parlett, *The
//! symmetric eigenvalue problem*, ch. 13.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use crate::native::{Block, Matrix, Orthonormal, lapack};
use crate::{Error, Result};

/// Vectors of a block.
pub(super) const WIDTH: usize = 16;
/// Residual of a Ritz pair relative to theta; that of theta is its square.
const TOLERANCE: f64 = 1e-9;
/// The first mode above the limit need not be known better than this.
const FIRST_BEYOND_TOLERANCE: f64 = 1e-3;
/// New directions shorter than this, relative to what they were before orthogonalisation, are rounding.
const NEGLIGIBLE_DIRECTION: f64 = 1e-11;
/// Convergence is looked at after every so many blocks.
const BLOCKS_BETWEEN_CHECKS: usize = 2;
/// Basis vectors at most.
const MAX_BASIS: usize = 6000;

/// Modes with unit modal mass.
pub struct Modes {
    /// Frequencies, Hz, ascending.
    pub frequencies: Vec<f64>,
    /// Shapes, M-orthonormal.
    pub shapes: Block,
    /// Solves with the factor.
    pub n_solves: usize,
}

/// All modes below `limit` (Hz, may be infinite) of a space of dimension `n_dimensions`. `invert` is A; `start` holds
/// any vectors. Collective.
///
/// # Errors
/// Those of `invert`, PETSc's, and [`Error::NotConverged`].
pub fn below(
    limit: f64,
    n_dimensions: usize,
    mass: &Matrix,
    start: &Block,
    invert: &mut dyn FnMut(&Block) -> Result<Block>,
    progress: &mut dyn FnMut(usize),
) -> Result<Modes> {
    let mut basis = Basis::new(start);
    let mut next = invert(&start.multiplied_by(mass)?)?;
    let mut n_solves = start.n_columns();
    while basis.vectors.n_columns() <= MAX_BASIS {
        // T is known for the vectors that were inverted: all but those that come now.
        let n = basis.vectors.n_columns();
        let coupling = basis.extend(&mut next, mass, n_dimensions - n)?;
        progress(basis.vectors.n_columns());
        let is_whole = basis.vectors.n_columns() == n;
        if n > 0 && (is_whole || (n / WIDTH).is_multiple_of(BLOCKS_BETWEEN_CHECKS)) {
            let (values, vectors) = basis.ritz(n)?;
            let known = Known { values: &values, vectors: &vectors, coupling: &coupling };
            if is_whole || known.reaches(limit) {
                return Ok(basis.modes(&values, &vectors, limit, n_solves));
            }
        }
        let last = basis.vectors.columns(n..basis.vectors.n_columns());
        next = invert(&last.multiplied_by(mass)?)?;
        n_solves += last.n_columns();
    }
    Err(Error::not_converged(format!(
        "the fixed-interface modes below {limit} Hz did not converge with {MAX_BASIS} vectors. Give the reduction a lower band"
    )))
}

/// Ritz pairs with what they lack.
struct Known<'a> {
    values: &'a [f64],
    vectors: &'a DMatrix<f64>,
    coupling: &'a DMatrix<f64>,
}

impl Known<'_> {
    /// Whether all pairs below the limit are converged, and the first above it is in sight.
    fn reaches(&self, limit: f64) -> bool {
        let theta = (TAU * limit).powi(-2);
        for i in (0..self.values.len()).rev() {
            let beyond = self.values[i] < theta;
            if self.residual(i) > self.values[i] * if beyond { FIRST_BEYOND_TOLERANCE } else { TOLERANCE } {
                return false;
            }
            if beyond {
                return true;
            }
        }
        false
    }

    /// `|R s_last|`
    fn residual(&self, i: usize) -> f64 {
        let width = self.coupling.ncols();
        (self.coupling * self.vectors.column(i).rows(self.values.len() - width, width)).norm()
    }
}

/// The M-orthonormal basis V and `T = V^T M A M V`.
struct Basis {
    vectors: Block,
    projected: DMatrix<f64>,
    /// Width of the last block.
    last: usize,
}

impl Basis {
    fn new(like: &Block) -> Basis {
        Basis { vectors: like.columns(0..0), projected: DMatrix::zeros(0, 0), last: 0 }
    }

    /// Takes in `next = A M V_last`: its part within the basis is a block column of T, the rest (`max_columns` vectors
    /// at most) extends the basis. Gives R with `next = V (V^T M next) + V_new R`.
    fn extend(&mut self, next: &mut Block, mass: &Matrix, max_columns: usize) -> Result<DMatrix<f64>> {
        let n = self.vectors.n_columns();
        let before = squares(next, mass)?.diagonal().max().sqrt();
        let mut within = DMatrix::zeros(n, next.n_columns());
        for _ in 0..2 {
            within += remove(&self.vectors, next, mass)?;
        }
        self.adopt(&within);
        let mut r = normalise(next, mass, before * NEGLIGIBLE_DIRECTION, max_columns)?;
        if next.n_columns() > 0 {
            // What was short is long now, and so are its errors.
            remove(&self.vectors, next, mass)?;
            r = normalise(next, mass, 0.5, max_columns)? * r;
        }
        self.last = next.n_columns();
        self.vectors.append(next);
        Ok(r)
    }

    /// Writes the last block column of T, and the same as a row.
    fn adopt(&mut self, column: &DMatrix<f64>) {
        let n = column.nrows();
        if n == 0 {
            return;
        }
        let first = n - self.last;
        let mut t = std::mem::replace(&mut self.projected, DMatrix::zeros(0, 0)).resize(n, n, 0.0);
        t.view_mut((0, first), (n, self.last)).copy_from(column);
        t.view_mut((first, 0), (self.last, n)).copy_from(&column.transpose());
        self.projected = t;
    }

    /// Ritz values, ascending, and vectors of the first n basis vectors.
    fn ritz(&self, n: usize) -> Result<(Vec<f64>, DMatrix<f64>)> {
        let t = self.projected.view((0, 0), (n, n));
        let mut vectors = 0.5 * (t + t.transpose());
        let values = lapack::symmetric_eigen(n, vectors.as_mut_slice())?;
        Ok((values, vectors))
    }

    /// The modes below the limit.
    fn modes(&self, values: &[f64], vectors: &DMatrix<f64>, limit: f64, n_solves: usize) -> Modes {
        let n = values.len();
        let theta = (TAU * limit).powi(-2);
        // The largest theta is the lowest frequency.
        let wanted: Vec<usize> = (0..n).rev().filter(|&i| values[i] > theta).collect();
        let coefficients: Vec<f64> = wanted.iter().flat_map(|&i| vectors.as_slice()[i * n..][..n].to_vec()).collect();
        let shapes = self.vectors.columns(0..n).combined(&coefficients, wanted.len());
        let frequencies = wanted.iter().map(|&i| values[i].powf(-0.5) / TAU).collect();
        Modes { frequencies, shapes, n_solves }
    }
}

/// `w -= V (V^T M w)`; gives `V^T M w`.
fn remove(v: &Block, w: &mut Block, mass: &Matrix) -> Result<DMatrix<f64>> {
    let n = v.n_columns();
    if n == 0 {
        return Ok(DMatrix::zeros(0, w.n_columns()));
    }
    let h = v.gram(&w.multiplied_by(mass)?);
    w.axpy(-1.0, &v.combined(&h, w.n_columns()));
    Ok(DMatrix::from_vec(n, w.n_columns(), h))
}

/// Makes the columns of w M-orthonormal to each other and to those of v, which are M-orthonormal; at most `max_columns`
/// of them stay, and none that adds less than `shortest` of itself (1e-7 at least: rounding). Collective.
///
/// # Errors
/// PETSc's.
pub fn make_orthonormal(v: &Block, w: &mut Block, mass: &Matrix, shortest: f64, max_columns: usize) -> Result<()> {
    if w.n_columns() == 0 {
        return Ok(());
    }
    let lengths = squares(w, mass)?.diagonal().map(|square| square.sqrt().max(f64::MIN_POSITIVE));
    *w = w.combined(DMatrix::from_diagonal(&lengths.map(f64::recip)).as_slice(), w.n_columns());
    for shortest in [shortest, 0.5] {
        remove(v, w, mass)?;
        normalise(w, mass, shortest, max_columns)?;
        if w.n_columns() == 0 {
            return Ok(());
        }
    }
    Ok(())
}

/// `w^T M w`, symmetric.
fn squares(w: &Block, mass: &Matrix) -> Result<DMatrix<f64>> {
    let n = w.n_columns();
    let g = DMatrix::from_vec(n, n, w.gram(&w.multiplied_by(mass)?));
    Ok(0.5 * (&g + g.transpose()))
}

/// Makes w M-orthonormal, leaving out directions shorter than `shortest` and all but the `max_columns` longest; gives R
/// with `w_before = w R` up to those.
fn normalise(w: &mut Block, mass: &Matrix, shortest: f64, max_columns: usize) -> Result<DMatrix<f64>> {
    let Orthonormal { q, r } = Orthonormal::new(squares(w, mass)?, |_| shortest, max_columns)?;
    *w = w.combined(q.as_slice(), q.ncols());
    Ok(r)
}
