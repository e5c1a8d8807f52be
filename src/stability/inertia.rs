//! How many modes the symmetric problem has below a frequency.
//!
//! By Sylvester's law of inertia that is the number of negative pivots of `A = S - omega^2 M`, S the stiffness with the contact tangent
//! without friction's coupling. From one friction to the next only the points that opened or closed change S, by a low rank:
//! `A' = A + U D U^T`. The bordered matrix `[A U; U^T -D^-1]` has two Schur complements (Haynsworth, Linear Algebra and its
//! Applications 1, 1968), so that
//!
//! ```text
//! n(A') = n(A) + n(-D^-1 - U^T A^-1 U) - n(-D^-1)       n: number of negative eigenvalues
//! ```
//!
//! and a factor of A serves for A' with one solve for each column of U that was not in the last one. The count is exact either way.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, Matrix3, SymmetricEigen};

use super::Pencil;
use crate::Result;
use crate::algebra::dot;
use crate::native::{Block, Factor, FactorKind, FactorStats};

/// A change of a point's tangent this much smaller than the tangent itself is none.
const NEGLIGIBLE: f64 = 1e-12;
/// Unit vectors whose components differ by no more are one: rounding.
const SAME_DIRECTION: f64 = 1e-14;
/// Changes at most: the small matrix of more takes longer than a factor.
const MOST_CHANGES: usize = 1000;
/// An eigenvalue of the small matrix this close to zero, relative to the largest, leaves its sign open.
const OPEN: f64 = 1e-9;

/// Counts modes, with the last factor for as long as it serves.
pub struct Inertia {
    factor: Factor,
    last: Option<Last>,
}

/// What the factor was made for.
struct Last {
    omega: f64,
    tangents: Vec<[[f64; 3]; 3]>,
    n_negative: usize,
    /// Solved for so far.
    responses: Vec<Response>,
}

/// What the points' gaps are where a unit force acts at one, with the factor's matrix.
struct Response {
    point: usize,
    direction: [f64; 3],
    gaps: Vec<[f64; 3]>,
}

impl Default for Inertia {
    fn default() -> Self {
        Inertia { factor: Factor::new(FactorKind::Symmetric), last: None }
    }
}

impl Inertia {
    /// Number of modes below a frequency, Hz. Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    pub fn n_below(&mut self, pencil: &Pencil, frequency: f64) -> Result<usize> {
        let omega = TAU * frequency;
        if let Some(n) = self.updated(pencil, omega)? {
            return Ok(n);
        }
        let mut shifted = pencil.symmetric_stiffness()?;
        shifted.axpy(-omega * omega, pencil.m)?;
        shifted.declare_symmetric()?;
        self.factor.factorise(&shifted)?;
        let n_negative = self.factor.n_negative()?;
        let tangents = pencil.points.map(|points| points.symmetric.to_vec());
        self.last = tangents.map(|tangents| Last { omega, tangents, n_negative, responses: Vec::new() });
        Ok(n_negative)
    }

    /// The count by the last factor; none where it was made for something too different.
    fn updated(&mut self, pencil: &Pencil, omega: f64) -> Result<Option<usize>> {
        let (Some(last), Some(points)) = (&mut self.last, pencil.points) else { return Ok(None) };
        if last.omega != omega || last.tangents.len() != points.symmetric.len() {
            return Ok(None);
        }
        let pairs = last.tangents.iter().zip(points.symmetric).enumerate();
        let changes: Vec<Change> = pairs.flat_map(|(a, (old, new))| changes(a, old, new)).collect();
        let is_new = |change: &&Change| !last.responses.iter().any(|response| response.sign(change) != 0.0);
        let unit = |change: &Change| (change.point, change.direction);
        let new: Vec<(usize, [f64; 3])> = changes.iter().filter(is_new).map(unit).collect();
        let price = Factor::PRICE_AMONG_MANY * new.len() as f64;
        if changes.len() > MOST_CHANGES || price > self.factor.solves_per_factorisation() {
            return Ok(None);
        }
        if changes.is_empty() {
            return Ok(Some(last.n_negative));
        }
        for columns in new.chunks(Block::AT_ONCE) {
            let solution = points.contacts.loads(pencil.k.comm(), columns).solved_by(&self.factor)?;
            for (j, &(point, direction)) in columns.iter().enumerate() {
                let gaps = points.contacts.gaps(&solution.vector(j)?)?;
                last.responses.push(Response { point, direction, gaps });
            }
        }
        let mut flexibility = Vec::with_capacity(changes.len().pow(2));
        for column in &changes {
            let known = last.responses.iter().map(|response| (response.sign(column), response));
            let Some((sign, response)) = known.into_iter().find(|(sign, _)| *sign != 0.0) else { return Ok(None) };
            let entry = |row: &Change| sign * dot(row.direction, response.gaps[row.point]);
            flexibility.extend(changes.iter().map(entry));
        }
        Ok(n_negative_after(last.n_negative, &changes, &flexibility))
    }

    /// Gives the memory of the factor back. Collective.
    pub fn release(&mut self) {
        self.factor.release();
        self.last = None;
    }

    /// Whether there is a factor. Not collective.
    pub fn is_made(&self) -> bool {
        self.factor.is_made()
    }

    /// What the factor has cost. Not collective.
    pub fn stats(&self) -> FactorStats {
        self.factor.stats()
    }
}

/// `stiffness direction direction^T` has joined a point's tangent.
struct Change {
    point: usize,
    direction: [f64; 3],
    stiffness: f64,
}

impl Response {
    /// The sign with which this is the response to a change's direction; 0 where it is to another's.
    fn sign(&self, change: &Change) -> f64 {
        let sign = dot(self.direction, change.direction).signum();
        let mut pairs = self.direction.iter().zip(&change.direction);
        let is_same = self.point == change.point && pairs.all(|(a, b)| (a - sign * b).abs() <= SAME_DIRECTION);
        if is_same { sign } else { 0.0 }
    }
}

/// The change of a symmetric tangent along its principal directions.
fn changes(point: usize, old: &[[f64; 3]; 3], new: &[[f64; 3]; 3]) -> Vec<Change> {
    if old == new {
        return Vec::new();
    }
    let (old, new) = (Matrix3::from(*old), Matrix3::from(*new));
    let smallest = NEGLIGIBLE * old.norm().max(new.norm());
    let eigen = SymmetricEigen::new(0.5 * ((new - old) + (new - old).transpose()));
    let change = |k: usize| Change {
        point,
        direction: eigen.eigenvectors.column(k).into_owned().into(),
        stiffness: eigen.eigenvalues[k],
    };
    (0..3).map(change).filter(|change| change.stiffness.abs() > smallest).collect()
}

/// `n(A) + n(-D^-1 - U^T A^-1 U) - n(-D^-1)`, with `U^T A^-1 U` by columns; none where an eigenvalue is too small for its sign.
fn n_negative_after(before: usize, changes: &[Change], flexibility: &[f64]) -> Option<usize> {
    let n = changes.len();
    // D scaled out, so that the entries are of one size: T (-D^-1 - G) T with T = sqrt|D| keeps the inertia.
    let scale = |i: usize| changes[i].stiffness.abs().sqrt();
    let entry = |i: usize, j: usize| {
        let own = if i == j { changes[i].stiffness.signum() } else { 0.0 };
        -own - scale(i) * 0.5 * (flexibility[i + n * j] + flexibility[j + n * i]) * scale(j)
    };
    let eigenvalues = DMatrix::from_fn(n, n, entry).symmetric_eigenvalues();
    if eigenvalues.iter().any(|x| x.abs() < OPEN * eigenvalues.amax()) {
        return None;
    }
    let negative = eigenvalues.iter().filter(|&&x| x < 0.0).count();
    let stiffened = changes.iter().filter(|change| change.stiffness > 0.0).count();
    (before + negative).checked_sub(stiffened)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn n_negative(a: &DMatrix<f64>) -> usize {
        a.clone().symmetric_eigenvalues().iter().filter(|&&x| x < 0.0).count()
    }

    proptest! {
        #[test]
        fn an_update_counts_like_the_changed_matrix(
            diagonal in prop::collection::vec(-1.0..1.0_f64, 9),
            stiffnesses in prop::collection::vec(prop_oneof![-3.0..-0.1, 0.1..3.0], 3),
            directions in prop::collection::vec(-1.0..1.0, 27),
        ) {
            prop_assume!(diagonal.iter().all(|x: &f64| x.abs() > 1e-6));
            let a = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(diagonal));
            let u = DMatrix::from_vec(9, 3, directions);
            let changes: Vec<Change> =
                stiffnesses.iter().map(|&stiffness| Change { point: 0, direction: [0.0; 3], stiffness }).collect();
            let d = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(stiffnesses));
            let flexibility = u.transpose() * a.clone().lu().solve(&u).unwrap();
            let changed = &a + &u * d * u.transpose();
            if let Some(n) = n_negative_after(n_negative(&a), &changes, flexibility.as_slice()) {
                prop_assert_eq!(n, n_negative(&changed));
            }
        }
    }

    #[test]
    fn a_response_serves_its_direction_and_the_opposite_one() {
        let response = Response { point: 2, direction: [0.6, 0.0, 0.8], gaps: Vec::new() };
        let sign = |point: usize, direction: [f64; 3]| response.sign(&Change { point, direction, stiffness: 1.0 });
        assert_eq!(sign(2, [0.6, 0.0, 0.8]), 1.0);
        assert_eq!(sign(2, [-0.6, 0.0, -0.8]), -1.0);
        assert_eq!(sign(2, [0.6, 1e-8, 0.8]), 0.0);
        assert_eq!(sign(1, [0.6, 0.0, 0.8]), 0.0);
    }

    #[test]
    fn a_point_that_opens_is_one_change_along_its_normal() {
        let closed = [[0.0; 3], [0.0; 3], [0.0, 0.0, 5.0]];
        let changes = changes(4, &closed, &[[0.0; 3]; 3]);
        assert_eq!(changes.len(), 1);
        assert_eq!((changes[0].point, changes[0].stiffness), (4, -5.0));
        assert!((changes[0].direction[2].abs() - 1.0).abs() < 1e-15);
    }
}
