//! Modes of external matrices, as plain data.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::matrices::Symmetry;
use crate::model::InstabilityCriterion;
use crate::stability::{Count, Evidence};
use crate::tracking::Diagram;

/// Modes of external matrices at the values of their parameter.
#[derive(Debug, Clone)]
pub struct ExternalResults {
    /// What the matrices are called.
    pub title: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Whether any matrix depends on it.
    pub varies: bool,
    /// Rows that are solved.
    pub n_dofs: usize,
    /// Rows left out because they are constrained.
    pub n_constrained: usize,
    /// Which matrices are symmetric.
    pub symmetry: Symmetry,
    /// Whether there is a C.
    pub is_damped: bool,
    /// Whether there is a G.
    pub has_structural_damping: bool,
    /// Band analysed, Hz.
    pub band: [f64; 2],
    /// What counts as an unstable mode.
    pub criterion: InstabilityCriterion,
    /// What shows that no mode is missing.
    pub evidence: Evidence,
    /// One value after the other.
    pub values: Vec<ExternalValue>,
    /// Modes followed over the parameter.
    pub diagram: Option<Diagram>,
    /// Remarks for the summary, a line each.
    pub notes: Vec<String>,
    /// Number of each row in the files, from 0.
    pub rows: Vec<usize>,
    /// Node and degree of freedom of each row, where the files have names.
    pub names: Option<Vec<(i64, i32)>>,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Ranks that solved.
    pub n_ranks: usize,
}

/// The modes at one value of the parameter.
#[derive(Debug, Clone)]
pub struct ExternalValue {
    /// The value.
    pub value: f64,
    /// By frequency.
    pub modes: Vec<ExternalMode>,
    /// The check of their number.
    pub count: Count,
    /// Condition number of the matrix that was factorised, scaled as it is solved.
    pub condition: f64,
    /// Its shift, 1/s; 0 where it is K.
    pub shift: f64,
    /// Real and imaginary parts of all modes on all rows, where they are asked for; the largest entry of each mode has
    /// modulus 1.
    pub shapes: Vec<[Vec<f64>; 2]>,
}

/// A mode.
#[derive(Debug, Clone, PartialEq)]
pub struct ExternalMode {
    /// Its number, from 1.
    pub number: usize,
    /// The eigenvalue, 1/s.
    pub lambda: Complex64,
    /// Backward error of the scaled problem.
    pub backward_error: f64,
    /// Whether it is unstable by the criterion, and no rigid-body mode.
    pub is_unstable: bool,
    /// Row of the matrices in which its vector is largest, from 1.
    pub largest_row: usize,
    /// Node and degree of freedom there, where rows have names.
    pub largest_dof: Option<(i64, i32)>,
}

impl ExternalMode {
    /// Hz.
    pub fn frequency(&self) -> f64 {
        self.lambda.im / TAU
    }

    /// `-Re lambda / |lambda|`.
    pub fn damping_ratio(&self) -> f64 {
        -self.lambda.re / self.lambda.norm().max(f64::MIN_POSITIVE)
    }
}
