//! All modes within a radius by one growing subspace, with many right-hand sides at a time.
//!
//! With `P(lambda) = lambda^2 M + lambda C + K` and a factor of K:
//!
//! 1. *Krylov blocks.* `V = [V_1 V_2 ...]`, `V_{j+1} = orth(K^-1 M V_j)` from a few random columns, until V has about twice as
//!    many columns as modes are expected: it holds the shapes of the undamped problem, friction included.
//! 2. *Rayleigh-Ritz.* `V^T P(lambda) V y = 0` is solved by TOAR like a full problem; `x = V y`.
//! 3. *Correction.* The residuals `R = [P(lambda_i) x_i]` of all wanted modes are what damping and a truncated Krylov space leave. The
//!    directions `K^-1 R` that V lacks have few that count (singular values fall by three decades in twenty), which random
//!    combinations find: `K^-1 (R Omega)` joins V. Steps 2 and 3 repeat until every eigenvalue rests and every backward error is small.
//!
//! Why: a pass over the factor is memory traffic for one right-hand side and arithmetic for 16, a quarter of the time each on
//! two ranks, and so are the products with C and M. Generalised Davidson with
//! `K^-1` for its preconditioner (Sleijpen, Booten, Fokkema and van der Vorst, BIT 36, 1996, section 4), its corrections compressed by a
//! randomised range finder (Halko, Martinsson and Tropp, SIAM Review 53, 2011, algorithm 4.1).

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::Pencil;
use super::mode::backward_errors;
use crate::petsc::eigen::{self, Found, Pair, Quadratic};
use crate::petsc::{Block, Factor, FactorKind, Matrix, Noise};
use crate::{Error, Result};

/// Columns of a Krylov block.
const KRYLOV_BLOCK: usize = 8;
/// Columns of the Krylov space for each mode expected.
const KRYLOV: f64 = 2.2;
/// Random combinations of the residuals that join the space in a round.
const SKETCH: usize = 24;
/// Relative change of an eigenvalue from round to round at which it rests. A round wins a factor of about five, so that the error
/// left is below the change.
const REST: f64 = 1e-7;
/// Backward error of an eigenpair that is found.
const BACKWARD_ERROR: f64 = 1e-10;
/// Rounds of correction before the search is given up.
const MAX_ROUNDS: usize = 40;
/// Directions this much smaller than the largest of their block add nothing.
const NEGLIGIBLE: f64 = 1e-7;
/// How often the projected problem is asked for more eigenpairs than seem to be within the radius.
const MARGINS: [usize; 4] = [8, 24, 72, 216];

/// A subspace with the projections of M, C and K.
struct Subspace<'a> {
    problem: &'a Problem<'a>,
    v: Block,
    /// `K V`, kept because K is not symmetric.
    kv: Block,
    m: DMatrix<f64>,
    c: DMatrix<f64>,
    k: DMatrix<f64>,
    noise: Noise<'a>,
    n_solves: usize,
}

/// A Ritz pair: eigenvalue and coefficients of its vector in V.
struct Ritz {
    lambda: Complex64,
    re: Vec<f64>,
    im: Vec<f64>,
}

/// A pencil with what its solution needs.
pub struct Problem<'a> {
    /// M, C and K.
    pub pencil: &'a Pencil<'a>,
    /// The factor of K.
    pub factor: &'a Factor,
    /// A number for each of this rank's equations, whatever the number of ranks.
    pub labels: &'a [u64],
}

/// Memory (MB) of a search for `n_modes` among `n_equations`: the basis and its image under K, with room for ten rounds.
pub fn needs_mb(n_modes: usize, n_equations: usize) -> f64 {
    let n_columns = n_krylov(n_modes) + 10 * SKETCH;
    2.0 * 8.0 * (n_columns * n_equations) as f64 / (1024.0 * 1024.0)
}

/// Columns of the Krylov space.
fn n_krylov(n_modes: usize) -> usize {
    (KRYLOV * n_modes as f64) as usize + 2 * KRYLOV_BLOCK
}

/// All eigenpairs of the closed upper half plane with `|lambda| <= radius` (1/s), given about how many modes to expect there.
/// With their backward errors. `progress` hears of (at rest, wanted, solves). Collective.
///
/// # Errors
/// PETSc's and MUMPS's; [`Error::NotConverged`] after too many rounds.
pub fn solve(
    problem: &Problem,
    radius: f64,
    n_expected: usize,
    progress: &mut dyn FnMut(usize, usize, usize),
) -> Result<(Found, Vec<f64>)> {
    let mut space = Subspace::krylov(problem, n_expected)?;
    let mut last: Vec<Complex64> = Vec::new();
    for _ in 0..MAX_ROUNDS {
        let ritz = space.ritz(radius, n_expected)?;
        let rests = |r: &Ritz| last.iter().any(|z| (z - r.lambda).norm() <= REST * z.norm());
        let mut late: Vec<&Ritz> = ritz.iter().filter(|r| !rests(r)).collect();
        progress(ritz.len() - late.len(), ritz.len(), space.n_solves);
        let lambdas: Vec<Complex64> = ritz.iter().map(|r| r.lambda).collect();
        if late.is_empty() && last.len() == ritz.len() {
            let x = space.vectors(&ritz);
            let errors = backward_errors(problem.pencil, &lambdas, &x)?;
            late = ritz.iter().zip(&errors).filter(|(_, e)| **e > BACKWARD_ERROR).map(|(r, _)| r).collect();
            if late.is_empty() {
                return Ok((found(&lambdas, &x, space.n_solves)?, errors));
            }
        }
        if late.is_empty() {
            late = ritz.iter().collect();
        }
        let residuals = space.sketch(&late)?;
        space.extend_by_solves(residuals)?;
        last = lambdas;
    }
    Err(Error::NotConverged(format!("the eigensolver's corrections did not converge in {MAX_ROUNDS} rounds")))
}

impl<'a> Subspace<'a> {
    /// Krylov blocks of `K^-1 M`.
    fn krylov(problem: &'a Problem, n_expected: usize) -> Result<Subspace<'a>> {
        let (comm, n_local) = (problem.pencil.k.comm(), problem.pencil.k.n_local());
        let (empty, none) = (|| Block::zeros(comm, n_local, 0), || DMatrix::zeros(0, 0));
        let noise = Noise::new(problem.labels);
        let (v, kv) = (empty(), empty());
        let mut space = Subspace { problem, v, kv, m: none(), c: none(), k: none(), noise, n_solves: 0 };
        let n_total = comm.sum(n_local as f64) as usize;
        let n_columns = n_krylov(n_expected).min(n_total);
        let mut last = Block::zeros(comm, n_local, KRYLOV_BLOCK.min(n_total));
        (0..last.n_columns()).for_each(|j| space.noise.fill(last.column_mut(j)));
        let mut image = last.multiplied_by(problem.pencil.m)?;
        while space.v.n_columns() < n_columns && image.n_columns() > 0 {
            image = space.extend_by_solves(image)?;
        }
        Ok(space)
    }

    /// Appends `K^-1 R`, of which V lacks some directions W, orthonormal, and their projections. Gives `M W`.
    fn extend_by_solves(&mut self, mut r: Block) -> Result<Block> {
        let Problem { pencil, factor, .. } = *self.problem;
        let mut w = r.solved_by(factor)?;
        self.n_solves += w.n_columns();
        for _ in 0..2 {
            // K W is R, and whatever is done to W is done to it.
            let overlap = self.v.gram(&w);
            w.axpy(-1.0, &self.v.combined(&overlap, w.n_columns()));
            r.axpy(-1.0, &self.kv.combined(&overlap, r.n_columns()));
            let (basis, n) = w.orthonormalising(NEGLIGIBLE);
            (w, r) = (w.combined(&basis, n), r.combined(&basis, n));
        }
        let mw = w.multiplied_by(pencil.m)?;
        self.m = symmetric_growth(&self.m, &self.v, &w, &mw);
        self.c = symmetric_growth(&self.c, &self.v, &w, &w.multiplied_by(pencil.c)?);
        self.k = general_growth(&self.k, [&self.v, &w], [&self.kv, &r]);
        self.v.append(&w);
        self.kv.append(&r);
        Ok(mw)
    }

    /// The projected problem's pairs within the radius, by modulus.
    fn ritz(&self, radius: f64, n_expected: usize) -> Result<Vec<Ritz>> {
        let comm = self.v.comm().alone();
        let n = self.v.n_columns();
        // The same numbers on every rank, to the last bit.
        let small = |a: &DMatrix<f64>| Matrix::dense(&comm, n, &self.v.comm().from_root(a.transpose().as_slice()));
        let (m, c, k) = (small(&self.m)?, small(&self.c)?, small(&self.k)?);
        let mut factor = Factor::new(FactorKind::Unsymmetric);
        factor.factorise(&k)?;
        for margin in MARGINS {
            let n_wanted = (2 * (n_expected + margin)).min(2 * n);
            let options = eigen::Options { n_wanted, n_basis: 0, tolerance: 1e-13, max_restarts: 500 };
            let problem = Quadratic { m: &m, c: &c, k: &k, shift: 0.0, factor: &factor };
            let Some(found) = eigen::solve_or_none(&problem, &options, &mut |_, _| ())? else { continue };
            let reach = found.pairs.iter().map(|pair| pair.lambda.norm()).fold(0.0, f64::max);
            if reach > radius || found.n_converged >= 2 * n {
                return within(found, radius);
            }
        }
        Err(Error::NotConverged("the eigensolver's projected problem has too many modes in the band".into()))
    }

    /// Vectors `x = V y`: columns 2i and 2i + 1 are real and imaginary part.
    fn vectors(&self, ritz: &[Ritz]) -> Block {
        let y: Vec<f64> = ritz.iter().flat_map(|r| [&r.re, &r.im]).flatten().copied().collect();
        self.v.combined(&y, 2 * ritz.len())
    }

    /// Random combinations of the residuals' real and imaginary parts,
    /// `sum_i Re(z_ij^* P(lambda_i) V y_i)`, `z_ij` normal: column j is `K V a_j + C V b_j + M V d_j`.
    fn sketch(&mut self, ritz: &[&Ritz]) -> Result<Block> {
        let (n, noise, pencil) = (self.v.n_columns(), &mut self.noise, self.problem.pencil);
        let mut coefficients = [0, 1, 2].map(|_| vec![0.0; n * SKETCH]);
        for j in 0..SKETCH {
            for r in ritz {
                let z = Complex64::new(noise.normal(), noise.normal());
                for (power, a) in coefficients.iter_mut().enumerate() {
                    let factor = z.conj() * r.lambda.powu(power as u32);
                    let column = a[j * n..(j + 1) * n].iter_mut().zip(r.re.iter().zip(&r.im));
                    column.for_each(|(a, (re, im))| *a += factor.re * re - factor.im * im);
                }
            }
        }
        let [a, b, d] = coefficients;
        let mut sum = self.kv.combined(&a, SKETCH);
        sum.axpy(1.0, &self.v.combined(&b, SKETCH).multiplied_by(pencil.c)?);
        sum.axpy(1.0, &self.v.combined(&d, SKETCH).multiplied_by(pencil.m)?);
        Ok(sum)
    }
}

fn found(lambdas: &[Complex64], x: &Block, n_solves: usize) -> Result<Found> {
    let pair = |i: usize| Ok(Pair { lambda: lambdas[i], re: x.vector(2 * i)?, im: x.vector(2 * i + 1)? });
    let pairs = (0..lambdas.len()).map(pair).collect::<Result<Vec<_>>>()?;
    let n_converged = pairs.iter().map(|p| if p.lambda.im > 0.0 { 2 } else { 1 }).sum();
    Ok(Found { pairs, n_converged, n_solves })
}

/// The pairs with `|lambda| <= radius` by modulus, vectors of length 1.
fn within(found: Found, radius: f64) -> Result<Vec<Ritz>> {
    let mut ritz = Vec::new();
    for Pair { lambda, re, im } in found.pairs {
        if lambda.norm() <= radius {
            let (mut re, mut im) = (re.to_vec()?, im.to_vec()?);
            let norm = re.iter().chain(&im).map(|x| x * x).sum::<f64>().sqrt();
            re.iter_mut().chain(&mut im).for_each(|x| *x /= norm);
            ritz.push(Ritz { lambda, re, im });
        }
    }
    ritz.sort_by(|a, b| a.lambda.norm().total_cmp(&b.lambda.norm()));
    Ok(ritz)
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
