//! All modes below a radius by one growing subspace: blocked solves, one projected problem, all residuals corrected together.
//!
//! With `P(lambda) = lambda^2 M + lambda C + K` and `S = P(sigma)^-1` for a real shift sigma (0 as a rule):
//!
//! 1. *Krylov blocks.* `V = [V_1 V_2 ...]`, `V_{j+1} = orth(S M V_j)` from random columns, until V has about twice as many
//!    columns as modes are expected: it holds the undamped, frictional shapes of the band to a few digits.
//! 2. *Rayleigh-Ritz.* `V^T P(lambda) V y = 0` is solved densely; `x = V y`.
//! 3. *Correction.* `t = S P(lambda) x` for every wanted mode at once. `|t| / |x|` is the error of x as S sees it: on a
//!    component of frequency omega_j it is `1 - (omega / omega_j)^2` times the component. Where it is above the tolerance
//!    t joins V, and 2 is repeated.
//!
//! Why: a solve with 16 or more right-hand sides costs a seventh of a single one (a pass over the factor is memory traffic), and so do the
//! products with K, C and M. Generalised Davidson with S for its preconditioner: Sleijpen, Booten, Fokkema and van der Vorst,
//! BIT 36 (1996), section 4.

use nalgebra::{DMatrix, SymmetricEigen};
use num_complex::Complex64;

use crate::petsc::eigen::{Found, Pair, Quadratic};
use crate::petsc::{Block, Comm, dense};
use crate::{Error, Result};

/// Columns of a Krylov block.
const BLOCK: usize = 16;
/// Columns of the Krylov space for each mode expected.
const KRYLOV: usize = 4;
/// Krylov blocks between two looks at the residuals.
const GROWTH: usize = 2;
/// Eigenvalues closer than this are one, followed from round to round.
const SAME: f64 = 1e-9;
/// Error of a mode's vector, `|t| / |x|`, at which it counts as found.
const TOLERANCE: f64 = 1e-11;
/// Rounds of correction before the search is given up.
const MAX_ROUNDS: usize = 20;
/// Directions this much smaller than the largest of their block add nothing.
const NEGLIGIBLE: f64 = 1e-7;

/// The subspace with what has been computed on it.
struct Subspace<'a> {
    problem: &'a Quadratic<'a>,
    v: Block,
    /// `P(sigma) V`, kept because P(sigma) is not symmetric.
    sv: Block,
    /// Projections of M, C + 2 sigma M and P(sigma).
    m: DMatrix<f64>,
    c: DMatrix<f64>,
    k: DMatrix<f64>,
    n_solves: usize,
}

/// A Ritz pair: eigenvalue and coefficients of its vector in V.
struct Ritz {
    lambda: Complex64,
    y: Vec<Complex64>,
}

/// All eigenpairs of the closed upper half plane with `|lambda - sigma| <= radius` (1/s), given about how many modes to expect there.
/// `progress` hears of (converged, wanted, solves). Collective.
///
/// # Errors
/// PETSc's and MUMPS's; [`Error::NotConverged`] after too many rounds.
pub fn solve(
    problem: &Quadratic,
    radius: f64,
    n_expected: usize,
    progress: &mut dyn FnMut(usize, usize, usize),
) -> Result<Found> {
    let mut space = Subspace::new(problem);
    let mut krylov = Krylov::start(&mut space, radius)?;
    let mut n_columns = KRYLOV * n_expected + 2 * BLOCK;
    let mut known: Vec<Complex64> = Vec::new();
    for round in 0..MAX_ROUNDS {
        krylov.grow(&mut space, n_columns)?;
        let within = |r: &Ritz| (r.lambda - problem.shift).norm() <= radius;
        let wanted: Vec<Ritz> = space.ritz()?.into_iter().filter(within).collect();
        let is_known = |r: &Ritz| known.iter().any(|z| (z - r.lambda).norm() <= SAME * z.norm());
        let (done, late): (Vec<usize>, Vec<usize>) = (0..wanted.len()).partition(|&i| is_known(&wanted[i]));
        let late: Vec<&Ritz> = late.into_iter().map(|i| &wanted[i]).collect();
        let (corrections, errors) = space.corrections(&late)?;
        let found = late.iter().zip(&errors).filter(|(_, e)| **e <= TOLERANCE).map(|(r, _)| r.lambda);
        known.extend(found);
        let n_late = errors.iter().filter(|&&e| e > TOLERANCE).count();
        if std::env::var("DBG").is_ok() {
            let mut e = errors.clone();
            e.sort_by(f64::total_cmp);
            eprintln!(
                "round {round} m {} wanted {} known {} late {n_late} directions {} err {:.1e} {:.1e} {:.1e}",
                space.v.n_columns(),
                wanted.len(),
                done.len(),
                corrections.n_columns(),
                e[0],
                e[e.len() / 2],
                e[e.len() - 1]
            );
        }
        progress(wanted.len() - n_late, wanted.len(), space.n_solves);
        if n_late == 0 {
            return space.found(&wanted, round);
        }
        space.extend(&corrections)?;
        n_columns = space.v.n_columns() + GROWTH * BLOCK;
    }
    Err(Error::NotConverged(format!("the eigensolver's corrections did not converge in {MAX_ROUNDS} rounds")))
}

impl<'a> Subspace<'a> {
    fn new(problem: &'a Quadratic<'a>) -> Subspace<'a> {
        let empty = || Block::zeros(problem.k.comm(), problem.k.n_local(), 0);
        let none = || DMatrix::zeros(0, 0);
        Subspace { problem, v: empty(), sv: empty(), m: none(), c: none(), k: none(), n_solves: 0 }
    }

    /// Appends the directions of `w` that V lacks, orthonormal, and their projections. Gives `V^T w` for the new V.
    fn extend(&mut self, w: &Block) -> Result<DMatrix<f64>> {
        let original = w;
        let mut w = w.clone();
        for _ in 0..2 {
            let overlap = self.v.gram(&w);
            w.axpy(-1.0, &self.v.combined(&overlap, w.n_columns()));
            w = orthonormal(&w);
        }
        let overlap = self.v.gram(&w);
        w.axpy(-1.0, &self.v.combined(&overlap, w.n_columns()));
        let sigma = self.problem.shift;
        let mw = w.multiplied_by(self.problem.m)?;
        let cw = w.multiplied_by(self.problem.c)?;
        let mut sw = w.multiplied_by(self.problem.k)?;
        sw.axpy(sigma, &cw);
        sw.axpy(sigma * sigma, &mw);
        let mut shifted_cw = cw;
        shifted_cw.axpy(2.0 * sigma, &mw);
        let grow = |old: &DMatrix<f64>, image: &Block| symmetric_growth(old, &self.v, &w, image);
        (self.m, self.c) = (grow(&self.m, &mw), grow(&self.c, &shifted_cw));
        self.k = general_growth(&self.k, [&self.v, &w], [&self.sv, &sw]);
        self.v.append(&w);
        self.sv.append(&sw);
        Ok(DMatrix::from_vec(self.v.n_columns(), original.n_columns(), self.v.gram(original)))
    }

    /// `nu^2 M + nu (C + 2 sigma M) + P(sigma)` on V, by its inverse: `theta = s / nu`, `[theta y; y]` an eigenvector of
    /// `[-K^-1 C s, -K^-1 M s^2; I, 0]`, whose largest eigenvalues are the modes nearest to the shift.
    fn ritz(&self) -> Result<Vec<Ritz>> {
        let n = self.v.n_columns();
        let lu = self.k.clone().lu();
        let solve = |b: &DMatrix<f64>| {
            lu.solve(b).ok_or_else(|| Error::Library("the projected stiffness is singular".to_string()))
        };
        let (kc, km) = (solve(&self.c)?, solve(&self.m)?);
        let scale = 1.0 / km.norm().sqrt();
        let mut companion = DMatrix::zeros(2 * n, 2 * n);
        companion.view_mut((0, 0), (n, n)).copy_from(&(-scale * kc));
        companion.view_mut((0, n), (n, n)).copy_from(&(-scale * scale * km));
        companion.view_mut((n, 0), (n, n)).fill_with_identity();
        let pairs = dense::eigen(2 * n, companion.as_mut_slice())?;
        let ritz = pairs.into_iter().filter(|(theta, _)| theta.norm() > 0.0).map(|(theta, vector)| {
            let y = &vector[n..];
            let norm = y.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
            // Im theta >= 0 is Im lambda <= 0: the conjugate is the one above the axis.
            let lambda = (scale / theta).conj() + self.problem.shift;
            Ritz { lambda, y: y.iter().map(|z| z.conj() / norm).collect() }
        });
        let mut ritz: Vec<Ritz> = ritz.collect();
        ritz.sort_by(|a, b| a.lambda.norm().total_cmp(&b.lambda.norm()));
        Ok(ritz)
    }

    /// Vectors `x = V y`: columns 2i and 2i + 1 are real and imaginary part.
    fn vectors(&self, pairs: &[&Ritz]) -> Block {
        let parts = pairs.iter().flat_map(|r| r.y.iter().map(|z| z.re).chain(r.y.iter().map(|z| z.im)));
        self.v.combined(&parts.collect::<Vec<_>>(), 2 * pairs.len())
    }

    /// Directions of `t = S P(lambda) x` of all pairs, and `|t| / |x|` of each. The residuals have few independent directions (those
    /// of a Krylov space one block), so that only these are solved for.
    fn corrections(&mut self, pairs: &[&Ritz]) -> Result<(Block, Vec<f64>)> {
        let x = self.vectors(pairs);
        let mut r = x.multiplied_by(self.problem.k)?;
        let images = [(x.multiplied_by(self.problem.c)?, 1), (x.multiplied_by(self.problem.m)?, 2)];
        for (image, power) in &images {
            for (i, pair) in pairs.iter().enumerate() {
                add_complex_multiple(&mut r, image, i, pair.lambda.powi(*power));
            }
        }
        let q = orthonormal(&r);
        let t = q.solved_by(self.problem.factor)?;
        self.n_solves += t.n_columns();
        // S r = (S q) (q^T r), and |S r|^2 by the Gram matrix of S q
        let n = t.n_columns();
        let parts = DMatrix::from_vec(n, 2 * pairs.len(), q.gram(&r));
        let lengths = DMatrix::from_vec(n, n, t.gram(&t));
        let square = |j: usize| (parts.column(j).transpose() * &lengths * parts.column(j))[(0, 0)].max(0.0);
        // |x| = |y| = 1
        let errors = (0..pairs.len()).map(|i| (square(2 * i) + square(2 * i + 1)).sqrt()).collect();
        Ok((t, errors))
    }

    fn found(&self, pairs: &[Ritz], n_restarts: usize) -> Result<Found> {
        let x = self.vectors(&pairs.iter().collect::<Vec<_>>());
        let pair = |(i, r): (usize, &Ritz)| {
            Ok(Pair { lambda: r.lambda, re: x.vector(2 * i)?, im: x.vector(2 * i + 1)? })
        };
        let pairs = pairs.iter().enumerate().map(pair).collect::<Result<Vec<_>>>()?;
        let n_converged = pairs.iter().map(|p| if p.lambda.im > 0.0 { 2 } else { 1 }).sum();
        Ok(Found { pairs, n_converged, n_solves: self.n_solves, n_restarts })
    }
}

/// The block Krylov space of the linearised, inverted problem, kept as coefficients on V (two-level orthogonal Arnoldi).
///
/// With `theta = s / (lambda - sigma)`, `(u, w) -> (-S (s C' u + s^2 M w), u)`: both halves of every block are `V T` and `V B`.
struct Krylov {
    top: DMatrix<f64>,
    bottom: DMatrix<f64>,
    /// Columns of the newest block.
    newest: usize,
    scale: f64,
}

impl Krylov {
    /// Random starting blocks for both halves.
    fn start(space: &mut Subspace, scale: f64) -> Result<Krylov> {
        let (comm, n_local) = (space.problem.k.comm(), space.problem.k.n_local());
        let n_total = comm.sum(n_local as f64) as usize;
        let block = BLOCK.min(n_total);
        let start = random(comm, n_local, (2 * block).min(n_total));
        let smooth = start.solved_by(space.problem.factor)?;
        space.n_solves += smooth.n_columns();
        space.extend(&smooth)?;
        let n = space.v.n_columns();
        let unit = |first: usize| DMatrix::from_fn(n, block, |i, j| f64::from(u8::from(i == (first + j) % n)));
        let mut krylov = Krylov { top: DMatrix::zeros(n, 0), bottom: DMatrix::zeros(n, 0), newest: 0, scale };
        krylov.append(unit(0), unit(n - block));
        Ok(krylov)
    }

    /// Adds blocks until V has so many columns, or nothing is left to add.
    fn grow(&mut self, space: &mut Subspace, n_columns: usize) -> Result<()> {
        let n_total = space.problem.k.comm().sum(space.problem.k.n_local() as f64) as usize;
        while space.v.n_columns() < n_columns.min(n_total) && self.newest > 0 {
            self.step(space)?;
        }
        Ok(())
    }

    fn step(&mut self, space: &mut Subspace) -> Result<()> {
        let first = self.top.ncols() - self.newest;
        let half = |t: &DMatrix<f64>| {
            let newest = t.columns(first, self.newest).clone_owned();
            newest.resize_vertically(space.v.n_columns(), 0.0)
        };
        let (top, bottom) = (half(&self.top), half(&self.bottom));
        let u = space.v.combined(top.as_slice(), self.newest);
        let w = space.v.combined(bottom.as_slice(), self.newest);
        let (s, sigma, problem) = (self.scale, space.problem.shift, space.problem);
        let mut rhs = w.multiplied_by(problem.m)?;
        rhs.scale(-s * s);
        rhs.axpy(-s, &u.multiplied_by(problem.c)?);
        if sigma != 0.0 {
            rhs.axpy(-2.0 * s * sigma, &u.multiplied_by(problem.m)?);
        }
        let image = rhs.solved_by(problem.factor)?;
        space.n_solves += image.n_columns();
        let coordinates = space.extend(&image)?;
        let n = space.v.n_columns();
        self.append(coordinates, top.resize_vertically(n, 0.0));
        Ok(())
    }

    /// Orthonormalises a block of both halves against all before, and appends it.
    fn append(&mut self, top: DMatrix<f64>, bottom: DMatrix<f64>) {
        let n = top.nrows();
        let stack = |t: DMatrix<f64>, b: DMatrix<f64>| {
            let mut both = DMatrix::zeros(2 * n, t.ncols());
            both.rows_mut(0, n).copy_from(&t);
            both.rows_mut(n, n).copy_from(&b);
            both
        };
        let pad = |m: &DMatrix<f64>| m.clone().resize_vertically(n, 0.0);
        let basis = stack(pad(&self.top), pad(&self.bottom));
        let mut block = stack(top, bottom);
        for _ in 0..2 {
            block -= &basis * basis.tr_mul(&block);
            block = &block * whitening(&block.tr_mul(&block));
        }
        self.newest = block.ncols();
        let join = |old: DMatrix<f64>, new: DMatrix<f64>| {
            let (first, more) = (old.ncols(), new.ncols());
            let mut all = old.resize_horizontally(first + more, 0.0);
            all.columns_mut(first, more).copy_from(&new);
            all
        };
        self.top = join(pad(&self.top), block.rows(0, n).clone_owned());
        self.bottom = join(pad(&self.bottom), block.rows(n, n).clone_owned());
    }
}

/// `r_i += factor image_i` for the complex column i kept as two real ones.
fn add_complex_multiple(r: &mut Block, image: &Block, i: usize, factor: Complex64) {
    let (re, im) = (image.column(2 * i), image.column(2 * i + 1));
    let add = |target: &mut [f64], a: f64, b: f64| {
        target.iter_mut().zip(re.iter().zip(im)).for_each(|(t, (x, y))| *t += a * x + b * y);
    };
    add(r.column_mut(2 * i), factor.re, -factor.im);
    add(r.column_mut(2 * i + 1), factor.im, factor.re);
}

/// An orthonormal basis of the span of the columns; negligible directions are dropped.
fn orthonormal(w: &Block) -> Block {
    let n = w.n_columns();
    let whitening = whitening(&DMatrix::from_vec(n, n, w.gram(w)));
    w.combined(whitening.as_slice(), whitening.ncols())
}

/// T with `T^T G T = I` for the Gram matrix G of some columns, scaled to length 1 first; directions that are negligible then are
/// left out (Stathopoulos and Wu, SIAM J. Sci. Comput. 23 (2002), SVQB).
fn whitening(gram: &DMatrix<f64>) -> DMatrix<f64> {
    let n = gram.ncols();
    let scale: Vec<f64> = (0..n).map(|j| 1.0 / gram[(j, j)].sqrt().max(f64::MIN_POSITIVE)).collect();
    let eigen = SymmetricEigen::new(DMatrix::from_fn(n, n, |i, j| scale[i] * gram[(i, j)] * scale[j]));
    let largest = eigen.eigenvalues.iter().fold(0.0_f64, |m, &x| m.max(x));
    let kept: Vec<usize> = (0..n).filter(|&j| eigen.eigenvalues[j] > NEGLIGIBLE * NEGLIGIBLE * largest).collect();
    DMatrix::from_fn(n, kept.len(), |i, j| {
        scale[i] * eigen.eigenvectors[(i, kept[j])] / eigen.eigenvalues[kept[j]].sqrt()
    })
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

/// Reproducible noise in [-1, 1): splitmix64 on the column and the rank's row.
fn random(comm: &Comm, n_local: usize, n_columns: usize) -> Block {
    let mut block = Block::zeros(comm, n_local, n_columns);
    let mut state = (comm.rank() as u64).wrapping_mul(0x5851_f42d_4c95_7f2d);
    for value in block.values_mut() {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        *value = ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
    }
    block
}
