//! Vectors that a Craig-Bampton basis lacks where parts have other moduli and densities.
//!
//! At a sample of such values, with the matrices K' (all contacts closed) and M', a mode `T y` of the reduced brake is
//! improved by a step of inverse iteration, `u = omega^2 K'^-1 M' T y`. Its interior part, with the retained points
//! held, is to be in the basis:
//!
//! ```text
//! v = (I - Psi B) u / omega        w = v - Q Q^T K v,  Q spans [Phi E ...],  Q^T K Q = I        e = w^T K' w
//! ```
//!
//! e is the part of the energy of the mode that the basis lacks: to first order what `omega^2` is too large by,
//! relative to itself, so that half of it is the error of the frequency. As w is the shortest in the nominal K and not
//! in K', e is rather too large. All w of a sample together are reduced to the directions with most energy (proper
//! orthogonal decomposition) before they join the basis. The displacements under the loads are taken in as one more
//! vector. The first samples make the basis, the last ones find nothing more to add: they are its test.
//!
//! The estimate is of the modes at the samples, without damping and friction, with all sliding contacts closed as at
//! the nominal equilibrium. It cannot see points between the samples, contacts that open or close as parts change, nor
//! modes that the basis lacks as a whole: one step of inverse iteration starts from the modes that it has.
//!
//! Source: Galerkin projection onto snapshots (Benner, Gugercin, Willcox, SIAM Review 57, 2015, sections 3 and 4).

use nalgebra::DMatrix;
use serde::Serialize;

use crate::assembly::System;
use crate::contact::GapOperator;
use crate::native::{Block, Factor, FactorKind, Matrix, lapack};
use crate::{Error, Result};

use super::craig_bampton::{Event, Structure, motions};
use super::fixed_interface::make_orthonormal;
use super::functionals::Functionals;
use super::linear::Linear;
use super::made_for::{AGREEING_SAMPLES, SMALL_ERROR};
use super::projection::Projected;

/// Directions with less than this part of a mode's energy are left out.
const NEGLIGIBLE_ENERGY: f64 = 1e-5;
/// Directions shorter than this are rounding.
const ROUNDING: f64 = 1e-7;

/// The structure with other moduli and densities of its parts.
pub struct PartSamples<'a> {
    /// Number of samples at most.
    pub n_samples: usize,
    /// Number of samples at least, before those that agree end the work.
    pub min_samples: usize,
    /// Its matrices at one of them. Collective.
    pub system: &'a dyn Fn(usize) -> Result<System>,
}

impl PartSamples<'_> {
    /// None: the basis is for the structure as it is.
    pub fn none() -> PartSamples<'static> {
        PartSamples { n_samples: 0, min_samples: 0, system: &|_| unreachable!("there is no sample") }
    }
}

/// What the samples found and added.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SampleReport {
    /// Largest relative error of a frequency at each sample, estimated before its vectors joined the basis.
    pub errors: Vec<f64>,
    /// Coordinates that they gave.
    pub n_added: usize,
}

impl SampleReport {
    /// Whether there are so many samples, and the last ones agreed with the basis.
    fn agrees(&self, min_samples: usize) -> bool {
        self.errors.len() >= min_samples.max(AGREEING_SAMPLES)
            && self.errors.iter().rev().take(AGREEING_SAMPLES).all(|&error| error < SMALL_ERROR)
    }
}

/// The structure whose basis is to serve other parts.
pub(super) struct Nominal<'a> {
    pub structure: &'a Structure<'a>,
    pub functionals: &'a Functionals,
    pub linear: &'a Linear,
    /// What is retained.
    pub points: &'a GapOperator,
    /// The contact points that they belong to.
    pub contacts: &'a [usize],
    /// Modes below half of this matter, Hz.
    pub limit: f64,
}

impl Nominal<'_> {
    /// Extends a basis by what the modes at the samples lack in it. Collective.
    ///
    /// # Errors
    /// PETSc's, MUMPS's and LAPACK's, and those of the systems.
    pub(super) fn extend(
        &self,
        basis: &mut Block,
        samples: &PartSamples,
        progress: &mut dyn FnMut(Event),
    ) -> Result<SampleReport> {
        let mut report = SampleReport::default();
        if samples.n_samples == 0 {
            return Ok(report);
        }
        let mut span = basis.columns(self.functionals.len()..basis.n_columns());
        let room = span.n_columns();
        make_orthonormal(&basis.columns(0..0), &mut span, &self.linear.supported, ROUNDING, room)?;
        for i in 0..samples.n_samples {
            progress(Event::Sample(i, samples.n_samples));
            let (mut missing, varied) = self.vectors(basis, &(samples.system)(i)?)?;
            report.errors.push(0.5 * reduce_to_missing(&span, &self.linear.supported, &varied, &mut missing)?);
            report.n_added += missing.n_columns();
            span.append(&missing);
            basis.append(&missing);
            if report.agrees(samples.min_samples) {
                break;
            }
        }
        Ok(report)
    }

    /// `(I - Psi B) u / omega` of the displacements under the loads, with their work in place of omega^2, and of the
    /// modes at a sample; and K' there.
    fn vectors(&self, basis: &Block, system: &System) -> Result<(Block, Matrix)> {
        let own = Structure { system, ..*self.structure };
        let varied = Linear::new(&own, self.points, self.contacts)?;
        let projected = Projected::default().extended(basis, system, &varied)?;
        let at_reference = projected.stiffness_at_reference(&own.viscoelastic());
        let (y, squares) = motions(&projected.mass, &at_reference, &varied.contacts, 0.5 * self.limit)?;
        let closed = varied.closed(&own, self.contacts)?;
        let mut factor = Factor::new(FactorKind::Symmetric);
        factor.factorise(&closed)?;
        let scaled = y * DMatrix::from_diagonal(&angular_frequencies(&squares)?.into());
        let moved = basis.combined(scaled.as_slice(), scaled.ncols()).multiplied_by(&system.m)?;
        let mut vectors = self.static_answer(&factor)?;
        vectors.append(&moved.solved_by(&factor)?);
        self.functionals.hold(basis, &mut vectors);
        Ok((vectors, closed))
    }

    /// `u / sqrt(u^T F)` under the loads F.
    fn static_answer(&self, factor: &Factor) -> Result<Block> {
        let mut force = Block::zeros(self.linear.preload.comm(), self.linear.preload.n_local(), 1);
        for f in [&self.structure.system.load, &self.linear.preload] {
            f.local(|own| force.column_mut(0).iter_mut().zip(own).for_each(|(sum, f)| *sum += f))?;
        }
        let mut u = force.solved_by(factor)?;
        let work = u.gram(&force)[0];
        let scale = if work > 0.0 { work.sqrt().recip() } else { 0.0 };
        u.column_mut(0).iter_mut().for_each(|u| *u *= scale);
        Ok(u)
    }
}

/// omega of their squares.
fn angular_frequencies(squares: &[f64]) -> Result<Vec<f64>> {
    if squares.iter().any(|square| !(*square > 0.0 && square.is_finite())) {
        return Err(Error::Singular { found_by: "a mode without stiffness at a sample of other parts".into() });
    }
    Ok(squares.iter().map(|square| square.sqrt()).collect())
}

/// Takes what a K-orthonormal span has out of some vectors, and reduces the rest to the directions with energy in K',
/// K-orthonormal. Gives the largest energy of what a mode lacked; the first vector is no mode.
fn reduce_to_missing(span: &Block, k: &Matrix, varied: &Matrix, vectors: &mut Block) -> Result<f64> {
    for _ in 0..2 {
        let h = span.gram(&vectors.multiplied_by(k)?);
        vectors.axpy(-1.0, &span.combined(&h, vectors.n_columns()));
    }
    let m = vectors.n_columns();
    let gram = DMatrix::from_vec(m, m, vectors.gram(&vectors.multiplied_by(varied)?));
    let largest = largest_energy(&gram.diagonal().as_slice()[1..])?;
    let mut directions = 0.5 * (&gram + gram.transpose());
    let energies = lapack::symmetric_eigen(m, directions.as_mut_slice())?;
    let kept: Vec<usize> = (0..m).filter(|&i| energies[i] > NEGLIGIBLE_ENERGY).collect();
    *vectors = vectors.combined(directions.select_columns(&kept).as_slice(), kept.len());
    make_orthonormal(span, vectors, k, ROUNDING, kept.len())?;
    Ok(largest)
}

/// The largest energy of some vectors.
fn largest_energy(energies: &[f64]) -> Result<f64> {
    if energies.iter().any(|energy| !energy.is_finite()) {
        return Err(Error::not_converged("a mode at a sample of other parts is not finite"));
    }
    Ok(energies.iter().copied().fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    #[test]
    fn two_samples_in_succession_have_to_agree() {
        let report = |errors: &[f64]| SampleReport { errors: errors.to_vec(), n_added: 0 };
        assert!(report(&[1e-2, 9e-5, 2e-5]).agrees(3));
        assert!(!report(&[1e-2, 9e-5, 2e-5]).agrees(4), "as many as there are parameters, and two");
        assert!(!report(&[1e-5]).agrees(0), "one is not enough");
        assert!(!report(&[1e-5, 1e-5, 2e-4, 1e-5]).agrees(0), "the last two count");
    }

    #[test]
    fn what_has_no_frequency_or_energy_is_refused() {
        assert_eq!(angular_frequencies(&[4.0, 9.0]).unwrap(), [2.0, 3.0]);
        for wrong in [0.0, -1e-9, f64::NAN, f64::INFINITY] {
            assert!(angular_frequencies(&[4.0, wrong]).is_err(), "{wrong}");
        }
        assert_eq!(largest_energy(&[0.1, 0.3, 0.2]).unwrap(), 0.3);
        assert!(largest_energy(&[0.1, f64::NAN]).is_err() && largest_energy(&[f64::INFINITY]).is_err());
    }

    /// What a mode lacks has the energy of the sample's stiffness, ten times the nominal one in the third direction.
    #[test]
    fn the_missing_energy_is_that_of_the_stiffened_part() {
        let comm = Session::start(&[]).unwrap();
        let column = |values: [f64; 3]| Block::from_columns(&comm, 3, values.to_vec());
        let [k, varied] =
            [[1.0, 1.0, 1.0], [1.0, 1.0, 10.0]].map(|diagonal| Matrix::diagonal(&comm, &diagonal).unwrap());
        let span = column([1.0, 0.0, 0.0]);
        let mut vectors = column([1.0, 0.0, 0.0]);
        vectors.append(&column([0.8, 0.0, 0.1]));
        vectors.append(&column([0.8, 0.1, 0.0]));
        let largest = reduce_to_missing(&span, &k, &varied, &mut vectors).unwrap();
        assert!((largest - 0.1).abs() < 1e-12, "{largest}");
        assert_eq!(vectors.n_columns(), 2);
        let gram = DMatrix::from_vec(2, 2, vectors.gram(&vectors));
        assert!((gram - DMatrix::identity(2, 2)).amax() < 1e-12 && span.gram(&vectors).iter().all(|h| h.abs() < 1e-12));
    }
}
