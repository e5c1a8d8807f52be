//! The projected problem of the blocked search, all of whose pairs within a radius are found. With viscoelastic
//! materials what follows is about the reference problem, whose pairs [`super::nonlinear`] refines.
//!
//! Without structural damping it is real, and TOAR solves it like a full problem. With it `V^T (K + i G) V` is complex,
//! and LAPACK solves the companion matrix: with `lambda = sigma + s / mu`, `P` the projected polynomial, sigma the real
//! shift of the search and s a unit of frequency
//!
//! ```text
//! P(sigma + t) = t^2 M + t (2 sigma M + C) + P(sigma)
//!
//! [ -s P(sigma)^-1 (2 sigma M + C)   -s^2 P(sigma)^-1 M ] [ mu y ]      [ mu y ]
//! [  I                                0                 ] [    y ] = mu [    y ]
//! ```
//!
//! where the eigenvalues next to the shift are the largest. Those of the lower half plane, where `i G` would feed what
//! it has to damp, are left out. Rounding alone gives the eigenvalues of rigid motions an imaginary part: they count as
//! real ones, as without structural damping.

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::QuadraticProblem;
use super::nonlinear::{self, Projection};
use super::space::{Ritz, Space};
use crate::Result;
use crate::native::petsc::eigen::{self, Found, Pair, Quadratic};
use crate::native::{Factor, FactorKind, Matrix, Mck, lapack};

/// How many eigenpairs TOAR solves for beyond those expected within the radius, one number after the other.
const TOAR_MARGINS: [usize; 4] = [8, 24, 72, 216];
/// Imaginary parts up to this share of the radius are rounding.
const IMAGINARY_ROUNDING: f64 = 1e-9;

/// What is sought.
pub(super) struct Target {
    /// All pairs with `|lambda|` up to this, 1/s.
    pub radius: f64,
    /// About so many.
    pub n_expected: usize,
    /// The real shift of the search, 1/s.
    pub shift: f64,
}

/// The projected problem's pairs of the closed upper half plane within the radius, by modulus, vectors of length 1;
/// none where it has too many. Collective.
///
/// # Errors
/// PETSc's, LAPACK's.
pub(super) fn solve(space: &Space, target: &Target) -> Result<Option<Vec<Ritz>>> {
    let (comm, problem) = (space.v.comm(), space.problem());
    // The same numbers on every rank, to the last bit.
    let same = |a: &DMatrix<f64>| DMatrix::from_vec(a.nrows(), a.ncols(), comm.broadcast(0, a.as_slice().to_vec()));
    let matrices: Vec<DMatrix<f64>> = space.projected.iter().map(same).collect();
    let reference = reference_problem(problem, &matrices);
    let found = match reference.g {
        None => real_pairs(space, &reference, target)?,
        Some(_) if problem.viscoelastic.stiffnesses.is_empty() => Some(complex_pairs(&reference, target)?),
        Some(_) => {
            let projection = Projection { problem, matrices: &matrices };
            nonlinear::refine(&projection, &complex_pairs(&reference, target)?)?
        }
    };
    Ok(found.map(|mut ritz| {
        ritz.retain(|ritz| ritz.lambda.norm() <= target.radius);
        ritz.sort_by(|a, b| a.lambda.norm().total_cmp(&b.lambda.norm()));
        ritz
    }))
}

/// M, C, K and G with what viscoelastic materials dissipate at the reference frequency in G.
fn reference_problem(problem: &QuadraticProblem, matrices: &[DMatrix<f64>]) -> Mck<DMatrix<f64>> {
    let [m, c, k] = [0, 1, 2].map(|i| matrices[i].clone());
    let viscoelastic = &matrices[matrices.len() - problem.viscoelastic.stiffnesses.len()..];
    let mut g = problem.matrices.g.map(|_| matrices[3].clone());
    for (factor, stiffness) in problem.viscoelastic.coefficients_at_reference().zip(viscoelastic) {
        let g = g.get_or_insert_with(|| DMatrix::zeros(m.nrows(), m.ncols()));
        *g += factor.im * stiffness;
    }
    Mck { m, c, k, g }
}

/// By TOAR.
fn real_pairs(space: &Space, projected: &Mck<DMatrix<f64>>, target: &Target) -> Result<Option<Vec<Ritz>>> {
    let comm = space.v.comm().alone();
    let n = space.v.n_columns();
    let matrices = projected.as_ref().try_map(|a| Matrix::dense(&comm, n, a.transpose().as_slice()))?;
    let mut factor = Factor::new(FactorKind::Unsymmetric);
    factor.factorise(&matrices.k)?;
    for margin in TOAR_MARGINS {
        let n_wanted = (2 * (target.n_expected + margin)).min(2 * n);
        let options = eigen::Options { n_wanted, n_basis: 0, tolerance: 1e-13, max_restarts: 500, scale: 0.0 };
        let problem = Quadratic { matrices: matrices.as_ref(), shift: 0.0, inverse: &|b, x| factor.solve(b, x) };
        let Some(found) = eigen::solve(&problem, &options, &mut |_, _| ())? else { continue };
        let reach = found.pairs.iter().map(|pair| pair.lambda.norm()).fold(0.0, f64::max);
        if reach > target.radius || found.n_converged >= 2 * n {
            return within(found, target.radius).map(Some);
        }
    }
    Ok(None)
}

/// The pairs with `|lambda| <= radius`, vectors of length 1.
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
    Ok(ritz)
}

/// By LAPACK.
fn complex_pairs(projected: &Mck<DMatrix<f64>>, target: &Target) -> Result<Vec<Ritz>> {
    let n = projected.m.nrows();
    let lapack::Eigen { values, vectors } = lapack::eigen(companion(projected, target)?)?;
    let mut ritz = Vec::new();
    for (i, mu) in values.into_iter().enumerate() {
        let mut lambda = target.shift + target.radius / mu;
        if lambda.im.abs() <= IMAGINARY_ROUNDING * target.radius {
            lambda.im = 0.0;
        }
        // No number where mu is zero, as it is for infinite eigenvalues of a singular mass.
        if lambda.norm() <= target.radius && lambda.im >= 0.0 {
            let y = vectors.view((0, i), (n, 1));
            let norm = y.norm();
            let (re, im) = y.iter().map(|z| (z.re / norm, z.im / norm)).unzip();
            ritz.push(Ritz { lambda, re, im });
        }
    }
    Ok(ritz)
}

/// The companion matrix, its unit of frequency the radius.
fn companion(projected: &Mck<DMatrix<f64>>, target: &Target) -> Result<DMatrix<Complex64>> {
    let (n, Target { radius, shift, .. }) = (projected.m.nrows(), target);
    let mut at_shift = DMatrix::from_element(n, n, Complex64::ZERO);
    for (factor, a) in projected.as_ref().terms((*shift).into()) {
        at_shift.zip_apply(a, |z, x| *z += factor * x);
    }
    let mut blocks = DMatrix::from_element(n, 2 * n, Complex64::ZERO);
    for (at, entry) in blocks.as_mut_slice().iter_mut().enumerate() {
        let (at, is_first) = (at % (n * n), at < n * n);
        let (m, c) = (projected.m.as_slice()[at], projected.c.as_slice()[at]);
        *entry = if is_first { -radius * (2.0 * shift * m + c) } else { -radius * radius * m }.into();
    }
    if !lapack::solve_complex(n, at_shift.as_mut_slice(), blocks.as_mut_slice()) {
        return Err(crate::Error::Singular { found_by: "LAPACK's factorisation of the projected problem".into() });
    }
    let mut companion = DMatrix::from_element(2 * n, 2 * n, Complex64::ZERO);
    companion.rows_mut(0, n).copy_from(&blocks);
    companion.view_mut((n, 0), (n, n)).fill_with_identity();
    Ok(companion)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagonal(values: &[f64]) -> DMatrix<f64> {
        DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(values))
    }

    /// Pairs of unit masses on springs with loss factors, by modulus.
    fn pairs(k: &[f64], loss_factors: &[f64], shift: f64) -> Vec<Ritz> {
        let g: Vec<f64> = k.iter().zip(loss_factors).map(|(k, g)| k * g).collect();
        let projected = Mck {
            m: diagonal(&vec![1.0; k.len()]),
            c: diagonal(&vec![0.0; k.len()]),
            k: diagonal(k),
            g: Some(diagonal(&g)),
        };
        let mut found = complex_pairs(&projected, &Target { radius: 25.0, n_expected: 2, shift }).unwrap();
        found.sort_by(|a, b| a.lambda.norm().total_cmp(&b.lambda.norm()));
        found
    }

    #[test]
    fn eigenvalues_are_those_of_complex_springs_in_the_upper_half_plane() {
        for shift in [0.0, 7.0] {
            let found = pairs(&[100.0, 400.0, 900.0], &[0.1, 0.3, 0.2], shift);
            let exact =
                [(10.0, 0.1), (20.0, 0.3)].map(|(omega, g)| omega * Complex64::I * Complex64::new(1.0, g).sqrt());
            assert_eq!(found.len(), 2, "30 is beyond the radius");
            for (i, (found, exact)) in found.iter().zip(exact).enumerate() {
                assert!((found.lambda - exact).norm() < 1e-12, "{} {exact}", found.lambda);
                assert!((found.re[i].hypot(found.im[i]) - 1.0).abs() < 1e-12);
            }
        }
    }

    /// The zeros of a rigid motion count as two real eigenvalues or as one pair, which is one mode either way.
    #[test]
    fn a_rigid_motion_is_one_mode() {
        let found = pairs(&[0.0, 400.0], &[0.1, 0.3], 7.0);
        let halves: usize = found[..found.len() - 1].iter().map(|r| if r.lambda.im > 0.0 { 2 } else { 1 }).sum();
        assert!(halves == 2 && found[0].lambda.norm() < 1e-5, "{:?}", found[0].lambda);
    }

    #[test]
    fn a_real_eigenvalue_keeps_no_imaginary_part() {
        // A free mass on a damper beside a spring with a loss factor: 0 and -5.
        let projected = Mck {
            m: diagonal(&[1.0, 1.0]),
            c: diagonal(&[5.0, 0.0]),
            k: diagonal(&[0.0, 400.0]),
            g: Some(diagonal(&[0.0, 40.0])),
        };
        let mut found = complex_pairs(&projected, &Target { radius: 25.0, n_expected: 2, shift: 7.0 }).unwrap();
        found.sort_by(|a, b| a.lambda.norm().total_cmp(&b.lambda.norm()));
        let lambdas: Vec<Complex64> = found.iter().map(|r| r.lambda).collect();
        assert!(lambdas.len() == 3 && lambdas[..2].iter().all(|z| z.im == 0.0), "{lambdas:?}");
        assert!(lambdas[0].norm() < 1e-9 && (lambdas[1] + 5.0).norm() < 1e-9, "{lambdas:?}");
    }
}
