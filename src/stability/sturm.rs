//! The Sturm count: how many modes the symmetric problem has below a frequency.
//!
//! By Sylvester's law of inertia that is the number of negative pivots of `A = S - omega^2 M`, S the stiffness with the
//! contact tangent without friction's coupling. From one friction value to the next only the points that opened or
//! closed change S, by a low rank: `A' = A + V D V^T`. The bordered matrix `[A V; V^T -D^-1]` has two Schur complements
//! (Haynsworth, Linear Algebra and its Applications 1, 1968), so that
//!
//! ```text
//! n(A') = n(A) + n(-D^-1 - V^T A^-1 V) - n(-D^-1)       n: number of negative eigenvalues
//! ```
//!
//! and a factor of A serves for A' with one solve for each column of V that was not in the last one. The count is exact
//! either way.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::QuadraticProblem;
use crate::Result;
use crate::algebra::dot;
use crate::contact::{Dyad, Tangent, TangentChange};
use crate::native::{Block, Factor, FactorKind, FactorStats};

/// Unit vectors whose components differ by no more have one direction: rounding.
const DIRECTION_ROUNDING: f64 = 1e-14;
/// Rank of a change at most: the small matrix of more takes longer than a factor.
const MAX_RANK: usize = 1000;
/// An eigenvalue of the small matrix this close to zero, relative to the largest, leaves its sign open.
const MIN_EIGENVALUE: f64 = 1e-9;

/// Counts modes, with the last factor for as long as it serves.
pub struct SturmCount {
    factor: Factor,
    last: Option<Factorised>,
}

/// What the factor was made of.
struct Factorised {
    omega: f64,
    tangents: Vec<Tangent>,
    n_negative: usize,
    /// Solved for so far.
    columns: Vec<Flexibility>,
}

/// The gaps of all points where a unit force acts at one, with the factor's matrix: a column of `B A^-1 B^T`.
struct Flexibility {
    point: usize,
    direction: [f64; 3],
    gaps: Vec<[f64; 3]>,
}

impl Default for SturmCount {
    fn default() -> Self {
        SturmCount { factor: Factor::new(FactorKind::Symmetric), last: None }
    }
}

impl SturmCount {
    /// Number of modes below a frequency, Hz. Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    pub fn n_below(&mut self, problem: &QuadraticProblem, frequency: f64) -> Result<usize> {
        let omega = TAU * frequency;
        if let Some(n) = self.updated(problem, omega)? {
            return Ok(n);
        }
        let mut shifted = problem.symmetric_stiffness()?;
        shifted.axpy(-omega * omega, problem.matrices.m)?;
        shifted.declare_symmetric()?;
        self.factor.factorise(&shifted)?;
        let n_negative = self.factor.n_negative()?;
        let tangents = problem.points.map(|points| points.symmetric.to_vec());
        self.last = tangents.map(|tangents| Factorised { omega, tangents, n_negative, columns: Vec::new() });
        Ok(n_negative)
    }

    /// The count by the last factor; none where that is of something too different.
    fn updated(&mut self, problem: &QuadraticProblem, omega: f64) -> Result<Option<usize>> {
        let (Some(last), Some(points)) = (&mut self.last, problem.points) else { return Ok(None) };
        if last.omega != omega || last.tangents.len() != points.symmetric.len() {
            return Ok(None);
        }
        let pairs = last.tangents.iter().zip(points.symmetric).enumerate();
        let change = TangentChange::between(pairs.map(|(a, (old, new))| (a, old, new)), TangentChange::ROUNDING);
        let is_new = |dyad: &&Dyad| !last.columns.iter().any(|column| column.sign(dyad) != 0.0);
        let new: Vec<(usize, [f64; 3])> =
            change.dyads.iter().filter(is_new).map(|dyad| (dyad.point, dyad.right)).collect();
        let price = Factor::PRICE_AMONG_MANY * new.len() as f64;
        if change.rank() > MAX_RANK || price > self.factor.solves_per_factorisation() {
            return Ok(None);
        }
        if change.rank() == 0 {
            return Ok(Some(last.n_negative));
        }
        for forces in new.chunks(Block::AT_ONCE) {
            let solution = points.contacts.loads(problem.comm(), forces).solved_by(&self.factor)?;
            for (j, &(point, direction)) in forces.iter().enumerate() {
                let gaps = points.contacts.gaps(&solution.vector(j)?)?;
                last.columns.push(Flexibility { point, direction, gaps });
            }
        }
        Ok(last.flexibility(&change).and_then(|flexibility| n_negative_after(last.n_negative, &change, &flexibility)))
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

impl Factorised {
    /// `V^T A^-1 V` by columns; none where a column was not solved for.
    fn flexibility(&self, change: &TangentChange) -> Option<Vec<f64>> {
        let mut flexibility = Vec::with_capacity(change.rank().pow(2));
        for column in &change.dyads {
            let signs = self.columns.iter().map(|response| (response.sign(column), response));
            let (sign, response) = signs.into_iter().find(|(sign, _)| *sign != 0.0)?;
            flexibility.extend(change.dyads.iter().map(|row| sign * dot(row.right, response.gaps[row.point])));
        }
        Some(flexibility)
    }
}

impl Flexibility {
    /// The sign with which this is the column of a dyad's direction; 0 where it is another's.
    fn sign(&self, dyad: &Dyad) -> f64 {
        let sign = dot(self.direction, dyad.right).signum();
        let mut pairs = self.direction.iter().zip(&dyad.right);
        let is_same = self.point == dyad.point && pairs.all(|(a, b)| (a - sign * b).abs() <= DIRECTION_ROUNDING);
        if is_same { sign } else { 0.0 }
    }
}

/// `n(A) + n(-D^-1 - V^T A^-1 V) - n(-D^-1)`, with `V^T A^-1 V` by columns; none where an eigenvalue is too small for
/// its sign.
fn n_negative_after(before: usize, change: &TangentChange, flexibility: &[f64]) -> Option<usize> {
    let n = change.rank();
    let stiffness = |i: usize| change.dyads[i].stiffness();
    // D scaled out, so that the entries are of one size: T (-D^-1 - G) T with T = sqrt|D| keeps the inertia.
    let scale = |i: usize| stiffness(i).abs().sqrt();
    let entry = |i: usize, j: usize| {
        let own = if i == j { stiffness(i).signum() } else { 0.0 };
        -own - scale(i) * 0.5 * (flexibility[i + n * j] + flexibility[j + n * i]) * scale(j)
    };
    let eigenvalues = DMatrix::from_fn(n, n, entry).symmetric_eigenvalues();
    let largest = eigenvalues.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if eigenvalues.iter().any(|x| x.abs() < MIN_EIGENVALUE * largest) {
        return None;
    }
    let n_negative = eigenvalues.iter().filter(|&&x| x < 0.0).count();
    let n_stiffened = (0..n).filter(|&i| stiffness(i) > 0.0).count();
    (before + n_negative).checked_sub(n_stiffened)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;
    use crate::stability::testing::Blocks;
    use proptest::prelude::*;

    fn n_negative(a: &DMatrix<f64>) -> usize {
        a.clone().symmetric_eigenvalues().iter().filter(|&&x| x < 0.0).count()
    }

    /// A dyad of point 0 with a stiffness, its direction x.
    fn dyad(stiffness: f64) -> Dyad {
        Dyad { point: 0, left: [stiffness, 0.0, 0.0], right: [1.0, 0.0, 0.0] }
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
            let v = DMatrix::from_vec(9, 3, directions);
            let change = TangentChange { dyads: stiffnesses.iter().copied().map(dyad).collect() };
            let d = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(stiffnesses));
            let flexibility = v.transpose() * a.clone().lu().solve(&v).unwrap();
            let changed = &a + &v * d * v.transpose();
            if let Some(n) = n_negative_after(n_negative(&a), &change, flexibility.as_slice()) {
                prop_assert_eq!(n, n_negative(&changed));
            }
        }
    }

    #[test]
    fn a_sign_that_rounding_decides_is_left_open() {
        // 1 + (-1) 1: the changed matrix is singular.
        let change = TangentChange { dyads: vec![dyad(-1.0), dyad(-1.0)] };
        assert_eq!(n_negative_after(0, &change, &[1.0 - 1e-12, 0.0, 0.0, 0.5]), None);
        assert_eq!(n_negative_after(0, &change, &[1.0 + 1e-3, 0.0, 0.0, 0.5]), Some(1));
    }

    #[test]
    fn a_column_serves_its_direction_and_the_opposite_one() {
        let column = Flexibility { point: 2, direction: [0.6, 0.0, 0.8], gaps: Vec::new() };
        let sign = |point: usize, right: [f64; 3]| column.sign(&Dyad { point, left: right, right });
        assert_eq!(sign(2, [0.6, 0.0, 0.8]), 1.0);
        assert_eq!(sign(2, [-0.6, 0.0, -0.8]), -1.0);
        assert_eq!(sign(2, [0.6, 1e-8, 0.8]), 0.0);
        assert_eq!(sign(1, [0.6, 0.0, 0.8]), 0.0);
    }

    /// How many modes of blocks are below a frequency, by a count of their own.
    fn counted_alone(blocks: &Blocks, open: &[usize], frequency: f64) -> usize {
        blocks.with(0.5, open, |problem| SturmCount::default().n_below(problem, frequency).unwrap())
    }

    #[test]
    fn a_count_follows_points_that_open_with_the_factor_that_it_has() {
        let comm = Session::start(&[]).unwrap();
        let blocks = Blocks::dense(&comm, 40);
        let mut sturm = SturmCount::default();
        // Between the modes of closed and open blocks, so that opening changes the count.
        let counts: Vec<usize> = [&[][..], &[0, 1, 5], &[1, 5], &[1]]
            .iter()
            .map(|open| {
                let n = blocks.with(0.5, open, |problem| sturm.n_below(problem, 4.5).unwrap());
                assert_eq!(n, counted_alone(&blocks, open, 4.5));
                n
            })
            .collect();
        assert!(counts[0] != counts[1], "{counts:?}");
        assert_eq!(sturm.stats().n_factorisations, 1);
    }

    #[test]
    fn another_frequency_or_a_change_of_too_high_a_rank_needs_another_factor() {
        let comm = Session::start(&[]).unwrap();
        let blocks = Blocks::dense(&comm, 40);
        let mut sturm = SturmCount::default();
        let mut count = |open: &[usize], frequency: f64| {
            let n = blocks.with(0.5, open, |problem| sturm.n_below(problem, frequency).unwrap());
            assert_eq!(n, counted_alone(&blocks, open, frequency));
            sturm.stats().n_factorisations
        };
        let all: Vec<usize> = (0..40).collect();
        assert_eq!([count(&[], 4.5), count(&[], 4.6), count(&[], 4.6), count(&all, 4.6)], [1, 2, 2, 3]);
    }

    #[test]
    fn friction_alone_changes_nothing() {
        let comm = Session::start(&[]).unwrap();
        let blocks = Blocks::dense(&comm, 6);
        let mut sturm = SturmCount::default();
        let mut count = |mu: f64| blocks.with(mu, &[], |problem| sturm.n_below(problem, 4.5).unwrap());
        assert_eq!(count(0.1), count(0.9));
        assert_eq!(sturm.stats().n_factorisations, 1);
    }
}
