//! What all eigensolvers are asked for and give.

use std::f64::consts::TAU;

use super::QuadraticProblem;
use crate::Result;
use crate::equilibrium::LabelledFactor;
use crate::native::petsc::eigen::Pair;

/// A search for all eigenpairs of the closed upper half plane up to a frequency, and some beyond it.
#[derive(Debug, Clone, Copy)]
pub struct SearchRequest {
    /// About how many there are.
    pub n_modes: usize,
    /// The frequency, Hz.
    pub end: f64,
    /// Real shift at which the problem is inverted, 1/s.
    pub shift: f64,
    /// How often the band was searched before.
    pub attempt: usize,
}

/// What a search works on.
pub struct Search<'s> {
    /// The problem.
    pub problem: &'s QuadraticProblem<'s>,
    /// Becomes the factor of the problem at the shift, where the solver needs one.
    pub factor: &'s mut LabelledFactor,
    /// What is sought.
    pub request: SearchRequest,
    /// Is called while the search runs.
    pub progress: &'s mut OnProgress<'s>,
}

/// How far an eigensolver has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EigenProgress {
    /// Eigenvalues that are converged.
    pub n_converged: usize,
    /// Eigenvalues wanted.
    pub n_wanted: usize,
    /// Solves with the factor.
    pub n_solves: usize,
}

/// A callback that takes the progress.
pub type OnProgress<'p> = dyn FnMut(EigenProgress) + 'p;

/// The eigensolvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolverKind {
    /// `stability::toar`
    Toar,
    /// `stability::modal`
    Modal,
    /// `stability::blocked`
    Blocked,
}

/// Eigenpairs of the closed upper half plane, complete up to a frequency unless the solver has missed one.
pub struct SearchResult {
    /// Who found them.
    pub solver: SolverKind,
    /// The pairs.
    pub pairs: Vec<Pair>,
    /// Of the pairs.
    pub backward_errors: Vec<f64>,
    /// The frequency, Hz.
    pub reach: f64,
    /// Solves with the factor.
    pub n_solves: usize,
}

impl SearchResult {
    /// How many modes lie below a frequency, Hz: a pair of the upper half plane stands for one, a real eigenvalue for
    /// half of one.
    pub fn n_below(&self, frequency: f64) -> usize {
        let below = self.pairs.iter().filter(|pair| pair.lambda.norm() <= TAU * frequency);
        below.map(|pair| if pair.lambda.im > 0.0 { 1.0 } else { 0.5 }).sum::<f64>().round() as usize
    }

    /// Whether damping has made eigenvalues below a frequency, Hz, real.
    pub fn is_overdamped(&self, frequency: f64) -> bool {
        let mut below = self.pairs.iter().map(|pair| pair.lambda).filter(|lambda| lambda.norm() <= TAU * frequency);
        below.any(|lambda| lambda.im == 0.0 && lambda.re < 0.0)
    }
}

/// One of the solvers, which are interchangeable.
pub trait Eigensolver {
    /// Searches; none where the solver gives up. Whoever asks checks the number of modes. Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    fn search(&mut self, search: Search) -> Result<Option<SearchResult>>;
}
