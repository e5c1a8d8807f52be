//! All modes within a radius by one growing subspace, with many right-hand sides at a time.
//!
//! With `P(lambda) = lambda^2 M + lambda C + K` and a factor of K:
//!
//! 1. *Krylov blocks.* `V = [V_1 V_2 ...]`, `V_{j+1} = orth(K^-1 M V_j)` from a few random columns, until V has about twice as
//!    many columns as modes are expected: it nearly holds the shapes of the undamped problem, friction included. Where a neighbouring pencil was
//!    solved before, V begins with its modes instead, those of some way beyond the radius included, and needs no solve for them.
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

use super::mode::backward_errors;
use super::space::{Basis, Problem, Ritz, SKETCH, Side, Space, Start};
use crate::native::petsc::eigen::{self, Found, Pair, Quadratic};
use crate::native::{Factor, FactorKind, Matrix};
use crate::{Error, Result};

/// Columns of a Krylov block.
const KRYLOV_BLOCK: usize = 16;
/// Columns of the Krylov space for each mode expected.
const KRYLOV: f64 = 1.4;
/// A neighbouring pencil's modes are of use up to this multiple of the radius: those beyond the band are what corrections by `K^-1` win slowly
/// (medium demo brake, frictions 0.6 and 0.7: 430 and 434 solves from nothing, 292 and 312 with 1, 262 and 290 with 1.3, 266 and 280 with 1.6).
const FAR: f64 = 1.3;
/// Relative change of an eigenvalue from round to round at which it rests. A round wins a factor of three to five, so that the error
/// left is below half the change.
const REST: f64 = 1e-9;
/// Backward error of an eigenpair that is found.
pub(super) const BACKWARD_ERROR: f64 = 1e-10;
/// Pairs whose vectors are looked at together.
const PAIRS_AT_ONCE: usize = 16;
/// Rounds of correction before the search is given up.
const MAX_ROUNDS: usize = 40;
/// How often the projected problem is asked for more eigenpairs than seem to be within the radius.
const MARGINS: [usize; 4] = [8, 24, 72, 216];

/// Rounds that most searches take.
const ROUNDS_EXPECTED: usize = 10;
/// Rounds that the left vectors of a few unstable modes take.
const LEFT_ROUNDS_EXPECTED: usize = 3;

/// Memory (MB) of a search for `n_modes` among `n_equations`: the basis, with room for its rounds, the vectors found, those that the next search
/// starts from, a round's right-hand sides, solutions and products, and what left vectors then add.
pub fn needs_mb(n_modes: usize, n_equations: usize) -> f64 {
    let right = n_krylov(n_modes) + (ROUNDS_EXPECTED + 5) * SKETCH + 2 * n_modes + n_far(n_modes);
    let left = LEFT_ROUNDS_EXPECTED * SKETCH + 6 * n_modes;
    let n_columns = right + left;
    8.0 * (n_columns * n_equations) as f64 / (1024.0 * 1024.0)
}

/// Columns of the Krylov space.
fn n_krylov(n_modes: usize) -> usize {
    (KRYLOV * n_modes as f64) as usize + 2 * KRYLOV_BLOCK
}

/// Columns that the next search starts from.
fn n_far(n_modes: usize) -> usize {
    (2.0 * FAR * n_modes as f64) as usize
}

/// What a search has found.
pub struct Outcome {
    /// Eigenpairs with the number of solves that they took.
    pub found: Found,
    /// Of the pairs.
    pub backward_errors: Vec<f64>,
    /// The space that holds their vectors.
    pub basis: Basis,
    /// What to start from with a neighbouring pencil.
    pub start: Start,
}

/// All eigenpairs of the closed upper half plane with `|lambda| <= radius` (1/s), given about how many modes to expect there.
/// It may `start` from what a search with a neighbouring pencil has left. `progress` hears of (at rest, wanted, solves). Collective.
///
/// # Errors
/// PETSc's and MUMPS's; [`Error::NotConverged`] after too many rounds.
pub fn solve(
    problem: &Problem,
    radius: f64,
    n_expected: usize,
    start: Option<Start>,
    progress: &mut dyn FnMut(usize, usize, usize),
) -> Result<Outcome> {
    let mut space = match start {
        Some(start) => Space::started(*problem, start, ROUNDS_EXPECTED * SKETCH)?,
        None => krylov(problem, n_expected)?,
    };
    let mut last: Vec<Complex64> = Vec::new();
    for _ in 0..MAX_ROUNDS {
        let ritz = ritz(&space, radius, n_expected)?;
        let rests = |r: &Ritz| last.iter().any(|z| (z - r.lambda).norm() <= REST * z.norm());
        let n_resting = ritz.iter().filter(|r| rests(r)).count();
        progress(n_resting, ritz.len(), space.n_solves);
        if n_resting == ritz.len() && last.len() == ritz.len() {
            let start = space.start(&with_far_ones(&space, &ritz, radius, n_expected)?)?;
            if let Some((found, backward_errors)) = accurate(&space, &start, &ritz)? {
                return Ok(Outcome { found, backward_errors, basis: space.into_basis(), start });
            }
        }
        let residuals = space.sketch(&worth_correcting(&ritz, rests))?;
        space.extend_by_solves(&residuals)?;
        last = ritz.iter().map(|r| r.lambda).collect();
    }
    Err(Error::not_converged(format!("the eigensolver's corrections did not converge in {MAX_ROUNDS} rounds")))
}

/// The pairs, whose vectors a start spans, with their backward errors; none where one of these is too large.
fn accurate(space: &Space, start: &Start, ritz: &[Ritz]) -> Result<Option<(Found, Vec<f64>)>> {
    let (mut pairs, mut errors) = (Vec::new(), Vec::new());
    for ritz in ritz.chunks(PAIRS_AT_ONCE) {
        let lambdas: Vec<Complex64> = ritz.iter().map(|r| r.lambda).collect();
        let x = space.vectors_within(start, ritz);
        errors.extend(backward_errors(space.pencil(), &lambdas, &x)?);
        if errors.iter().any(|&error| error > BACKWARD_ERROR) {
            return Ok(None);
        }
        for (i, &lambda) in lambdas.iter().enumerate() {
            pairs.push(Pair { lambda, re: x.vector(2 * i)?, im: x.vector(2 * i + 1)? });
        }
    }
    let n_converged = pairs.iter().map(|p| if p.lambda.im > 0.0 { 2 } else { 1 }).sum();
    Ok(Some((Found { pairs, n_converged, n_solves: space.n_solves }, errors)))
}

/// All pairs, or only those that do not rest where these are few: then their residuals need no compression.
fn worth_correcting(ritz: &[Ritz], rests: impl Fn(&Ritz) -> bool) -> Vec<&Ritz> {
    let open: Vec<&Ritz> = ritz.iter().filter(|r| !rests(r)).collect();
    if open.is_empty() || 2 * open.len() > SKETCH { ritz.iter().collect() } else { open }
}

/// Krylov blocks of `K^-1 M`.
fn krylov<'a>(problem: &Problem<'a>, n_expected: usize) -> Result<Space<'a>> {
    let mut space = Space::with_room(*problem, Side::Right, n_krylov(n_expected) + ROUNDS_EXPECTED * SKETCH);
    let n_columns = n_krylov(n_expected).min(space.n_equations);
    let mut image = space.random(KRYLOV_BLOCK.min(space.n_equations)).multiplied_by(problem.pencil.m)?;
    while space.v.n_columns() < n_columns && image.n_columns() > 0 {
        image = space.extend_by_solves(&image)?;
    }
    Ok(space)
}

/// The pairs within the radius, and those within a multiple of it as well as the space has them.
fn with_far_ones(space: &Space, within: &[Ritz], radius: f64, n_expected: usize) -> Result<Vec<Ritz>> {
    let far = ritz(space, FAR * radius, n_far(n_expected) / 2)?;
    Ok(within.iter().cloned().chain(far.into_iter().filter(|r| r.lambda.norm() > radius)).collect())
}

/// The projected problem's pairs within the radius, by modulus.
fn ritz(space: &Space, radius: f64, n_expected: usize) -> Result<Vec<Ritz>> {
    let comm = space.v.comm().alone();
    let n = space.v.n_columns();
    // The same numbers on every rank, to the last bit.
    let small =
        |a: &DMatrix<f64>| Matrix::dense(&comm, n, &space.v.comm().broadcast(0, a.transpose().as_slice().to_vec()));
    let (m, c, k) = (small(&space.m)?, small(&space.c)?, small(&space.a)?);
    let mut factor = Factor::new(FactorKind::Unsymmetric);
    factor.factorise(&k)?;
    for margin in MARGINS {
        let n_wanted = (2 * (n_expected + margin)).min(2 * n);
        let options = eigen::Options { n_wanted, n_basis: 0, tolerance: 1e-13, max_restarts: 500, scale: 0.0 };
        let problem = Quadratic { m: &m, c: &c, k: &k, shift: 0.0, inverse: &|b, x| factor.solve(b, x) };
        let Some(found) = eigen::solve_or_none(&problem, &options, &mut |_, _| ())? else { continue };
        let reach = found.pairs.iter().map(|pair| pair.lambda.norm()).fold(0.0, f64::max);
        if reach > radius || found.n_converged >= 2 * n {
            return within(found, radius);
        }
    }
    Err(Error::not_converged("the eigensolver's projected problem has too many modes in the band"))
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
