//! The tangent's factor, made anew only where it pays.
//!
//! A tangent that differs from the factorised one at few contact points is solved by GMRES with the old factor: each opened or closed
//! point is an outlier that takes an iteration or two. Iterations may cost half a factorisation. One that differs at many is factorised anew.

use crate::Result;
use crate::contact::Status;
use crate::petsc::{Factor, FactorKind, FactorStats, Matrix, Vector, linear};

/// Share of a factorisation's cost that iterations with an old factor may take.
const SHARE: f64 = 0.5;
/// Iterations that a point of changed status takes, about.
const ITERATIONS_A_POINT: f64 = 1.5;

/// A factor with the statuses that it was made for.
pub(super) struct StepFactor {
    factor: Factor,
    /// Status of every point at the last factorisation.
    made_for: Option<Vec<Status>>,
    /// Status of every point in the current tangent.
    current: Vec<Status>,
    /// Whether the factor is that of the current tangent.
    exact: bool,
    n_iterations: usize,
}

impl StepFactor {
    pub(super) fn new() -> StepFactor {
        let factor = Factor::new(FactorKind::Unsymmetric);
        StepFactor { factor, made_for: None, current: Vec::new(), exact: false, n_iterations: 0 }
    }

    /// Hears of a new tangent and the statuses in it.
    pub(super) fn adopt(&mut self, statuses: Vec<Status>) {
        self.current = statuses;
        self.exact = false;
    }

    /// `x = A^-1 b`: with an old factor to the relative tolerance, else exactly.
    pub(super) fn solve(&mut self, a: &Matrix, b: &Vector, x: &mut Vector, tolerance: f64) -> Result<()> {
        let budget = (SHARE * self.factor.solves_per_factorisation()) as usize;
        if !self.exact && self.is_near(budget) {
            let iterations = linear::gmres(a, &self.factor, b, x, tolerance, budget)?;
            self.n_iterations += iterations.unwrap_or(budget);
            if iterations.is_some() {
                return Ok(());
            }
        }
        if !self.exact {
            self.factor.factorise(a)?;
            self.made_for = Some(self.current.clone());
            self.exact = true;
        }
        self.factor.solve(b, x)
    }

    fn is_near(&self, budget: usize) -> bool {
        let changed = |old: &Vec<Status>| old.iter().zip(&self.current).filter(|(a, b)| a != b).count();
        // Of a small matrix a factor costs less than the first iteration.
        let is_near = |old| ITERATIONS_A_POINT * changed(old) as f64 <= budget as f64;
        budget > 0 && self.made_for.as_ref().is_some_and(is_near)
    }

    pub(super) fn costs(&self) -> (FactorStats, usize) {
        (self.factor.stats(), self.n_iterations)
    }
}
