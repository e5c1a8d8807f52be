//! TOAR in the modal coordinates of a reference, for densely stored problems.
//!
//! `K_0 = S + sum B_a^T D_0a B_a` is the symmetric stiffness, without friction's coupling, of the first problem seen.
//! With its modes, of energy 1, other problems of the structure are
//!
//! ```text
//! Phi^T K_0 Phi = I      Phi^T M Phi = diag(1 / omega^2)
//! Phi^T K Phi = I + sum Phi^T B_a^T (D_a - D_0a) B_a Phi = I + U V^T
//! ```
//!
//! where a sliding point's tangent differs by rank 1, and the inverse is [`Woodbury`]'s, or from a factor of the sum
//! where the rank is large. A step of a Krylov method then goes through C, U and V, where it went through M, C and a
//! factor of K, and no coordinate is left out. That K_0 becomes the identity, and not M, keeps the low modes' digits:
//! rounding is relative to each mode's energy, and not to the highest mode's.
//!
//! Why it is written by hand: the modes of 81 friction values of the full brake's super-element (782 coordinates) take
//! 18 s where TOAR with the factor of K took 30 s.

use nalgebra::{DMatrix, Matrix2};

use super::eigensolver::{Eigensolver, Search, SearchRequest, SearchResult, SolverKind};
use super::space::Side;
use super::toar::{complete, pep_options, with_wanted};
use super::{EigenOptions, FrozenPoints, Mode, QuadraticProblem};
use crate::contact::{Dyad, Tangent, TangentChange};
use crate::equilibrium::Woodbury;
use crate::native::petsc::eigen::{self, Found, Options, Pair, Quadratic};
use crate::native::{Block, Comm, Factor, FactorKind, Matrix, Mck, Vector, lapack};
use crate::{Error, Result};

/// An eigenvalue found twice differs by no more, relatively.
const EIGENVALUE_ROUNDING: f64 = 1e-9;
/// No other eigenvalue is as near as this, relatively, to one whose left vector is taken from a search of its own.
const MIN_SEPARATION: f64 = 1e-6;

/// Solves in modal coordinates, which the first problem gives.
pub(super) struct Modal {
    options: EigenOptions,
    coordinates: Option<Coordinates>,
    /// Of the last search.
    last: Option<Options>,
}

/// The reference, and what of a problem does not change with friction.
struct Coordinates {
    /// Modes of the reference as columns.
    phi: Block,
    /// `Phi^T K_0 Phi` and `Phi^T M Phi`.
    k: Matrix,
    m: Matrix,
    /// `D_0`, N/m.
    tangents: Vec<Tangent>,
    /// `Phi^T B_a^T`, three columns for each point.
    gaps: Vec<f64>,
    /// The damping seen last, and `Phi^T C Phi`.
    damping: Option<(Vec<f64>, Matrix)>,
}

/// Rank of a change, relative to the coordinates, from which the sum is factorised: a solve goes through `n^2` numbers
/// then, in place of `2 n rank + rank^2`.
const FACTORISED_FROM: f64 = 0.3;

/// `(I + U V^T)^-1`
enum Inverse {
    /// Of a low rank.
    Updated { v: Vec<f64>, rank: usize, woodbury: Woodbury },
    /// Of a large rank.
    Factorised(Box<Factor>),
}

impl Modal {
    pub fn new(options: EigenOptions) -> Modal {
        Modal { options, coordinates: None, last: None }
    }

    /// Whether the problem is real, densely stored and larger than the basis of a search. Not collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn suits(&self, problem: &QuadraticProblem, request: &SearchRequest) -> Result<bool> {
        let dense = request.shift == 0.0
            && problem.matrices.g.is_none()
            && problem.symmetric_mc
            && problem.points.is_some()
            && problem.matrices.k.is_dense()?;
        Ok(dense && self.pep_options(problem, request).n_basis < 2 * problem.n_dofs())
    }

    fn pep_options(&self, problem: &QuadraticProblem, request: &SearchRequest) -> Options {
        let options = pep_options(problem, request, self.options.modal_tolerance);
        let n_basis = (self.options.modal_basis_ratio * options.n_wanted as f64) as usize;
        Options { n_basis, scale: std::f64::consts::TAU * request.end, ..options }
    }

    /// `v` with `P(lambda)^T v = 0` for modes of the last problem solved: columns `2i` and `2i + 1` are the real and
    /// imaginary part for mode i. From a search of its own with K transposed; none where that does not find each
    /// eigenvalue again, apart from all others, or where the vectors do not solve the problem as right ones must: those
    /// of stiff sliding contacts have an energy so large that it takes digits.
    ///
    /// # Errors
    /// PETSc's.
    pub fn left_vectors(&mut self, problem: &QuadraticProblem, modes: &[Mode]) -> Result<Option<Block>> {
        let (Some(options), Some(coordinates)) = (self.last, &mut self.coordinates) else { return Ok(None) };
        let Some(found) = coordinates.search(problem, Side::Left, &options, &mut |_, _| ())? else { return Ok(None) };
        let mut vectors = Block::zeros(problem.comm(), problem.n_local(), 2 * modes.len());
        for (i, mode) in modes.iter().enumerate() {
            let is_near = |pair: &&Pair, share: f64| (pair.lambda - mode.lambda).norm() <= share * mode.lambda.norm();
            let mut near = found.pairs.iter().filter(|pair| is_near(pair, MIN_SEPARATION));
            let (Some(pair), None) = (near.next(), near.next()) else { return Ok(None) };
            if !is_near(&pair, EIGENVALUE_ROUNDING) {
                return Ok(None);
            }
            pair.re.local(|values| vectors.column_mut(2 * i).copy_from_slice(values))?;
            pair.im.local(|values| vectors.column_mut(2 * i + 1).copy_from_slice(values))?;
        }
        let is_accurate = joint_error(problem, modes, &vectors)? <= self.options.backward_error;
        Ok(is_accurate.then_some(vectors))
    }
}

impl Eigensolver for Modal {
    fn search(&mut self, search: Search) -> Result<Option<SearchResult>> {
        let Search { problem, request, progress, .. } = search;
        if self.coordinates.is_none() {
            self.coordinates = Coordinates::new(problem)?;
        }
        let options = self.pep_options(problem, &request);
        self.last = Some(options);
        let Some(coordinates) = &mut self.coordinates else { return Ok(None) };
        let mut progress = with_wanted(options.n_wanted, progress);
        let found = coordinates.search(problem, Side::Right, &options, &mut progress)?;
        let result = complete(problem, SolverKind::Modal, found)?;
        let is_accurate =
            |result: &SearchResult| result.backward_errors.iter().all(|&error| error <= self.options.backward_error);
        Ok(result.filter(is_accurate))
    }
}

impl Coordinates {
    /// Those that a problem's symmetric part gives; none where it is not stored densely, or its stiffness not positive
    /// definite.
    fn new(problem: &QuadraticProblem) -> Result<Option<Coordinates>> {
        let Some(points) = problem.points else { return Ok(None) };
        let k_0 = problem.symmetric_stiffness()?;
        let (Some(stiffness), Some(mut modes)) = (k_0.dense_values()?, problem.matrices.m.dense_values()?) else {
            return Ok(None);
        };
        let (comm, n) = (problem.comm(), problem.n_local());
        let Some(flexibilities) = lapack::generalised_eigen(n, &mut modes, stiffness) else { return Ok(None) };
        let phi = Block::from_columns(comm, n, modes);
        let unit = |e: usize| std::array::from_fn(|i| if i == e { 1.0 } else { 0.0 });
        let directions: Vec<(usize, [f64; 3])> =
            (0..3 * points.symmetric.len()).map(|j| (j / 3, unit(j % 3))).collect();
        let gaps = phi.gram(&points.contacts.loads(comm, &directions));
        let (k, m) = (Matrix::diagonal(comm, &vec![1.0; n])?, Matrix::diagonal(comm, &flexibilities)?);
        Ok(Some(Coordinates { phi, k, m, tangents: points.symmetric.to_vec(), gaps, damping: None }))
    }

    /// Eigenpairs of a problem with the same M, S and contact points, or of the transposed one.
    fn search(
        &mut self,
        problem: &QuadraticProblem,
        side: Side,
        options: &Options,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<Option<Found>> {
        let Some(points) = problem.points else { return Ok(None) };
        let Some(inverse) = self.inverse(&points, side)? else { return Ok(None) };
        self.set_damping(problem)?;
        let Some((_, c)) = &self.damping else { return Ok(None) };
        let solve = |b: &Vector, x: &mut Vector| inverse.solve(b, x);
        let quadratic = Quadratic { matrices: Mck::from([&self.m, c, &self.k]), shift: 0.0, inverse: &solve };
        let Some(found) = eigen::solve(&quadratic, options, progress)? else { return Ok(None) };
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

    /// `Phi^T C Phi`, projected again where C is another.
    fn set_damping(&mut self, problem: &QuadraticProblem) -> Result<()> {
        let c = problem.matrices.c;
        let Some(values) = c.dense_values()? else { return Ok(()) };
        if self.damping.as_ref().is_none_or(|(last, _)| *last != values) {
            let projected = self.phi.gram(&self.phi.multiplied_by(c)?);
            let n = self.phi.n_columns();
            // Stored by rows.
            let by_rows = DMatrix::from_vec(n, n, projected).transpose();
            self.damping = Some((values, Matrix::dense(c.comm(), n, by_rows.as_slice())?));
        }
        Ok(())
    }

    /// The inverse of I with what the tangents, or the transposed ones, add; none where the sum is singular.
    fn inverse(&self, points: &FrozenPoints, side: Side) -> Result<Option<Inverse>> {
        let pairs = self.tangents.iter().zip(points.responses).enumerate();
        let change = pairs.map(|(a, (old, new))| (a, old, &new.tangent));
        let change = TangentChange::between(change, TangentChange::ROUNDING);
        let (n, rank) = (self.phi.n_columns(), change.rank());
        let columns = |direction: fn(&Dyad) -> [f64; 3]| -> Vec<f64> {
            change.dyads.iter().flat_map(|dyad| self.load(dyad.point, direction(dyad))).collect()
        };
        let [mut u, mut v] = [columns(|dyad| dyad.left), columns(|dyad| dyad.right)];
        if side == Side::Left {
            std::mem::swap(&mut u, &mut v);
        }
        if rank as f64 > FACTORISED_FROM * n as f64 {
            return factorised(self.phi.comm(), n, &u, &v);
        }
        let mut projected = vec![0.0; rank * rank];
        lapack::multiply(true, [rank, n, rank], &v, &u, &mut projected);
        let w = Block::from_columns(self.phi.comm(), n, u);
        let woodbury = Woodbury::new(w, DMatrix::from_vec(rank, rank, projected));
        Ok(woodbury.map(|woodbury| Inverse::Updated { v, rank, woodbury }))
    }

    /// `Phi^T B_a^T f`
    fn load(&self, a: usize, f: [f64; 3]) -> impl Iterator<Item = f64> {
        let n = self.phi.n_columns();
        (0..n).map(move |i| (0..3).map(|e| self.gaps[(3 * a + e) * n + i] * f[e]).sum::<f64>())
    }
}

/// The factor of `I + U V^T`; none where that is singular.
fn factorised(comm: &Comm, n: usize, u: &[f64], v: &[f64]) -> Result<Option<Inverse>> {
    let mut transposed = DMatrix::<f64>::identity(n, n);
    lapack::add_product_with_transpose([n, u.len() / n, n], v, u, transposed.as_mut_slice());
    let mut factor = Factor::new(FactorKind::Unsymmetric);
    match factor.factorise(&Matrix::dense(comm, n, transposed.as_slice())?) {
        Err(Error::Singular { .. }) => Ok(None),
        outcome => outcome.map(|()| Some(Inverse::Factorised(Box::new(factor)))),
    }
}

impl Inverse {
    /// `x = (I + U V^T)^-1 b`
    fn solve(&self, b: &Vector, x: &mut Vector) -> Result<()> {
        match self {
            Inverse::Factorised(factor) => factor.solve(b, x),
            Inverse::Updated { v, rank, woodbury } => b.local(|b| {
                x.local_mut(|x| {
                    let mut projected = vec![0.0; *rank];
                    lapack::multiply(true, [*rank, b.len(), 1], v, b, &mut projected);
                    x.copy_from_slice(b);
                    woodbury.correct(&projected, x);
                })
            })?,
        }
    }
}

/// About the largest backward error of left vectors, at the price of one: of `sum_i P(lambda_i)^T v_i / s_i`,
/// `s_i = (|lambda_i|^2 |M| + |lambda_i| |C| + |K|) |v_i|`, maximum norms. At most the sum of all errors. Collective.
fn joint_error(problem: &QuadraticProblem, modes: &[Mode], v: &Block) -> Result<f64> {
    let Mck { m, c, k, .. } = problem.matrices;
    let norms = problem.matrices.try_map(Matrix::norm_inf)?;
    let modulus = |x: &Block, i: usize| {
        let entries = x.column(2 * i).iter().zip(x.column(2 * i + 1));
        x.comm().max(entries.map(|(re, im)| re.hypot(*im)).fold(0.0, f64::max))
    };
    // Real and imaginary part of the sums that K, C and M are multiplied with, as columns.
    let mut coefficients = DMatrix::zeros(v.n_columns(), 6);
    for (i, lambda) in modes.iter().map(|mode| mode.lambda).enumerate() {
        let scale = norms.k + norms.c * lambda.norm() + norms.m * lambda.norm_sqr();
        for power in 0..3 {
            let z = lambda.powi(power as i32) / (scale * modulus(v, i));
            let rotation = Matrix2::new(z.re, z.im, -z.im, z.re);
            coefficients.fixed_view_mut::<2, 2>(2 * i, 2 * power).copy_from(&rotation);
        }
    }
    let sums = v.combined(coefficients.as_slice(), 6);
    let mut residual = sums.columns(0..2).multiplied_by_transpose(k)?;
    residual.add_products(&[c], &sums, 2..4)?;
    residual.add_products(&[m], &sums, 4..6)?;
    Ok(modulus(&residual, 0))
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::equilibrium::LabelledFactor;
    use crate::native::{Precision, Session};
    use crate::stability::testing::Blocks;

    const BAND_END: f64 = 7.0;

    /// Solves blocks on a belt in modal coordinates and looks at the solver and the modes.
    fn with_modes(look: impl FnOnce(&QuadraticProblem, &mut Modal, &[Mode])) {
        let comm = Session::start(&[]).unwrap();
        Blocks::dense(&comm, 8).with(0.8, &[], |problem| {
            let mut modal = Modal::new(EigenOptions::default());
            let request = SearchRequest { n_modes: 10, end: BAND_END, shift: 0.0, attempt: 0 };
            let mut factor = LabelledFactor::new(Precision::Double);
            let search = Search { problem, factor: &mut factor, request, progress: &mut |_| () };
            let found = modal.search(search).unwrap().unwrap();
            let mode = |(Pair { lambda, re, im }, backward_error)| Mode { lambda, backward_error, re, im };
            let modes: Vec<Mode> = found.pairs.into_iter().zip(found.backward_errors).map(mode).collect();
            look(problem, &mut modal, &modes);
        });
    }

    #[test]
    fn left_vectors_that_are_not_accurate_are_given_up() {
        with_modes(|problem, modal, modes| {
            let vectors = modal.left_vectors(problem, modes).unwrap().expect("accurate vectors");
            let error = joint_error(problem, modes, &vectors).unwrap();
            modal.options.backward_error = 2.0 * error;
            assert!(modal.left_vectors(problem, modes).unwrap().is_some());
            modal.options.backward_error = 0.5 * error;
            assert!(modal.left_vectors(problem, modes).unwrap().is_none());
        });
    }

    #[test]
    fn the_joint_error_shows_the_one_vector_that_is_wrong() {
        with_modes(|problem, modal, modes| {
            let exact = modal.left_vectors(problem, modes).unwrap().expect("accurate vectors");
            assert!(joint_error(problem, modes, &exact).unwrap() < 1e-10);
            let [m, c, k] = problem.matrices.map(crate::stability::testing::entries).into_array();
            for i in 0..modes.len() {
                let mut wrong = exact.clone();
                wrong.column_mut(2 * i)[0] += 1e-4;
                let lambda = modes[i].lambda;
                let v = |row: usize| Complex64::new(wrong.column(2 * i)[row], wrong.column(2 * i + 1)[row]);
                let v = DMatrix::from_fn(m.nrows(), 1, |row, _| v(row));
                let [m, c, k] = [&m, &c, &k].map(|a| a.transpose().map(Complex64::from));
                let norm_inf = |a: &DMatrix<Complex64>| a.column_iter().map(|row| row.lp_norm(1)).fold(0.0, f64::max);
                let scale = lambda.norm_sqr() * norm_inf(&m) + lambda.norm() * norm_inf(&c) + norm_inf(&k);
                let residual = (m * lambda.powi(2) + c * lambda + k) * &v;
                let largest = |x: &DMatrix<Complex64>| x.iter().map(|z| z.norm()).fold(0.0, f64::max);
                let error = largest(&residual) / (scale * largest(&v));
                let joint = joint_error(problem, modes, &wrong).unwrap();
                assert!(error > 1e-8 && (joint / error - 1.0).abs() < 1e-3, "mode {i}: {joint:e}, {error:e}");
            }
        });
    }
}
