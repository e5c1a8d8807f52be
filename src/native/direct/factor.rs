//! Direct factors: of sparse matrices by MUMPS, analysed once for a pattern and factorised again as often as values
//! change; of densely stored ones by LAPACK.

use std::cell::{Cell, RefCell};
use std::time::Instant;

use super::mumps::{Mumps, Precision};
use crate::native::lapack::DenseFactor;
use crate::native::{Matrix, Vector, machine};
use crate::{Error, Result};

/// Which factors are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FactorKind {
    /// `L U`, for any matrix.
    Unsymmetric,
    /// `L D L^T`, for matrices declared symmetric; counts negative pivots (the inertia).
    Symmetric,
}

/// What a factor costs.
#[derive(Debug, Clone, Copy, Default)]
pub struct FactorStats {
    /// Name of the ordering; none where the matrix is dense and LAPACK factorises it.
    pub ordering: Option<&'static str>,
    /// Whether it is in single precision.
    pub single: bool,
    /// Entries in the factors.
    pub entries: f64,
    /// Floating-point operations of one numerical factorisation.
    pub flops: f64,
    /// Memory MUMPS estimates after the analysis, MB over all ranks.
    pub estimated_mb: f64,
    /// Whether the factor lies on disc: it did not fit into memory.
    pub out_of_core: bool,
    /// Memory MUMPS used, MB over all ranks.
    pub used_mb: f64,
    /// Number of analyses.
    pub n_analyses: usize,
    /// Number of numerical factorisations.
    pub n_factorisations: usize,
    /// Seconds of the analyses.
    pub analysis_seconds: f64,
    /// Seconds of the numerical factorisations.
    pub factorisation_seconds: f64,
    /// Number of passes over the factor.
    pub n_solves: usize,
    /// Number of right-hand sides of all passes.
    pub n_right_hand_sides: usize,
    /// Seconds of the passes.
    pub solve_seconds: f64,
}

impl FactorStats {
    /// Name of the ordering.
    pub fn ordering_name(&self) -> &'static str {
        self.ordering.unwrap_or("none (dense)")
    }
}

/// Whether double precision may do where this one did not: pivots that rounding makes zero, or so small that pivoting
/// outgrows its workspace. All else (PETSc's errors, short memory, an empty matrix) fails in double precision, too.
fn needs_double(precision: Precision, error: &Error) -> bool {
    precision == Precision::Single && error.is_numerical()
}

/// A factorised matrix. The first factorisation analyses the pattern, which all later ones share.
pub struct Factor {
    kind: FactorKind,
    precision: Precision,
    sparse: Option<RefCell<Mumps>>,
    stats: FactorStats,
    /// The factor of a densely stored matrix, instead of MUMPS's.
    dense: Option<DenseFactor>,
    /// Memory that others will need beside it, MB.
    left_mb: f64,
    /// Passes, right-hand sides and seconds, counted by solves that leave the factor as it is.
    solves: Cell<(usize, usize, f64)>,
}

/// Percentage of extra workspace over MUMPS's estimate, and how often it is doubled when pivoting needs more.
const WORKSPACE: i32 = 30;
const WORKSPACE_TRIES: usize = 4;
/// What a factorisation touches of the memory that MUMPS estimates, extra workspace included: 0.78 to 0.80 on the demo
/// brakes.
const TOUCHED: f64 = 0.82;

impl Factor {
    /// A factor to be, in double precision; nothing is computed yet.
    pub fn new(kind: FactorKind) -> Factor {
        let (stats, solves) = (FactorStats::default(), Cell::default());
        Factor { kind, precision: Precision::Double, sparse: None, stats, dense: None, left_mb: 0.0, solves }
    }

    /// Goes on in another precision, which a densely stored matrix's factor does not have: what is factorised is
    /// released. Collective.
    pub fn set_precision(&mut self, precision: Precision) {
        if self.precision != precision {
            self.precision = precision;
            self.release();
        }
    }

    /// Whether solutions are as exact as the matrix's condition lets them be, and not only good for preconditioning.
    /// Not collective.
    pub fn is_exact(&self) -> bool {
        self.precision == Precision::Double || self.dense.is_some()
    }

    /// Orders the equations and makes the symbolic factorisation, unless that is done. No values are used.
    ///
    /// # Errors
    /// PETSc's, MUMPS's with its code, or [`Error::Input`] where the machine has too little memory for the factor.
    pub fn analyse(&mut self, a: &Matrix) -> Result<()> {
        if self.sparse.is_some() {
            return Ok(());
        }
        let start = Instant::now();
        let mut mumps = Mumps::new(a.comm(), self.kind, self.precision)?;
        mumps.set_icntl(14, WORKSPACE);
        if self.kind == FactorKind::Symmetric {
            // The inertia is right only with null pivots detected, and on several ranks without a parallel root.
            mumps.set_icntl(24, 1);
            mumps.set_icntl(13, 1);
        }
        mumps.analyse(a)?;
        mumps.verdict("analysis")?;
        self.stats.ordering = Some(mumps.ordering());
        self.stats.single = self.precision == Precision::Single;
        self.stats.estimated_mb = mumps.infog(17);
        self.stats.n_analyses += 1;
        self.stats.analysis_seconds += start.elapsed().as_secs_f64();
        let [touched, reserved] = [TOUCHED, 1.0].map(|share| share * self.stats.estimated_mb + self.left_mb);
        if !machine::has_room(a.comm(), touched, reserved) {
            mumps.set_icntl(22, 1);
            self.stats.out_of_core = true;
            self.stats.estimated_mb = mumps.infog(27);
        }
        self.sparse = Some(RefCell::new(mumps));
        machine::require(a.comm(), self.stats.estimated_mb)
    }

    /// From now on an analysis chooses to keep the factor out of core unless so much memory is left beside it, MB. Not
    /// collective.
    pub fn leave_mb(&mut self, mb: f64) {
        self.left_mb = mb;
    }

    /// Whether there is a factor. Not collective.
    pub fn is_made(&self) -> bool {
        self.sparse.is_some()
    }

    /// Gives the memory back; the next factorisation analyses anew. Collective.
    pub fn release(&mut self) {
        self.sparse = None;
    }

    /// Factorises the values of `a`, whose pattern is that of all earlier calls. Workspace is enlarged where pivoting
    /// needs it, and where single precision does not do, double precision serves from then on.
    ///
    /// # Errors
    /// PETSc's, and MUMPS's with its code.
    pub fn factorise(&mut self, a: &Matrix) -> Result<()> {
        if let Some(values) = a.dense_values()? {
            return self.factorise_dense(a.n_local(), values);
        }
        match self.factorise_sparse(a) {
            Err(error) if needs_double(self.precision, &error) => {
                self.set_precision(Precision::Double);
                self.factorise_sparse(a)
            }
            outcome => outcome,
        }
    }

    fn factorise_sparse(&mut self, a: &Matrix) -> Result<()> {
        self.analyse(a)?;
        let start = Instant::now();
        let mumps = self.sparse.as_mut().expect("analysed above").get_mut();
        let mut workspace = WORKSPACE;
        for attempt in 0..WORKSPACE_TRIES {
            mumps.factorise(a)?;
            if !Error::MUMPS_WORKSPACE.contains(&(mumps.infog(1) as i32)) || attempt + 1 == WORKSPACE_TRIES {
                break;
            }
            workspace *= 2;
            mumps.set_icntl(14, workspace);
        }
        mumps.verdict("factorisation")?;
        self.stats.entries = mumps.infog(29);
        self.stats.used_mb = mumps.infog(22);
        self.stats.flops = mumps.rinfog(3);
        self.stats.n_factorisations += 1;
        self.stats.factorisation_seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    fn factorise_dense(&mut self, n: usize, values: Vec<f64>) -> Result<()> {
        let start = Instant::now();
        let factor = self.dense.insert(DenseFactor::new(self.kind, n, values)?);
        self.stats.entries = factor.n_entries() as f64;
        self.stats.used_mb = self.stats.entries * 8.0 / (1024.0 * 1024.0);
        self.stats.flops = factor.flops();
        self.stats.n_factorisations += 1;
        self.stats.factorisation_seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// The factor of a densely stored matrix.
    pub(in crate::native) fn dense(&self) -> Option<&DenseFactor> {
        self.dense.as_ref()
    }

    /// `x = A^-1 b`.
    ///
    /// # Errors
    /// PETSc's, and MUMPS's with its code.
    ///
    /// # Panics
    /// Where nothing is factorised.
    pub fn solve(&self, b: &Vector, x: &mut Vector) -> Result<()> {
        let start = Instant::now();
        if let Some(dense) = &self.dense {
            x.copy_from(b)?;
            x.local_mut(|x| dense.solve(x, false))?;
            self.count(1, start);
            return Ok(());
        }
        let b = b.to_vec()?;
        x.local_mut(|x| self.solve_columns(&b, x, 1, false))?
    }

    fn count(&self, n_right_hand_sides: usize, start: Instant) {
        let (n, n_all, seconds) = self.solves.get();
        self.solves.set((n + 1, n_all + n_right_hand_sides, seconds + start.elapsed().as_secs_f64()));
    }

    /// This rank's rows of right-hand sides and solutions, column after column, with A or its transpose.
    pub(in crate::native) fn solve_columns(
        &self,
        b: &[f64],
        x: &mut [f64],
        n_columns: usize,
        transposed: bool,
    ) -> Result<()> {
        let start = Instant::now();
        self.sparse.as_ref().expect("factorised before").borrow_mut().solve(b, x, n_columns, transposed)?;
        self.count(n_columns, start);
        Ok(())
    }

    /// Number of negative pivots of a symmetric factor: how many eigenvalues of the matrix are negative.
    ///
    /// # Errors
    /// PETSc's.
    ///
    /// # Panics
    /// Where nothing is factorised.
    pub fn n_negative(&self) -> Result<usize> {
        debug_assert_eq!(self.kind, FactorKind::Symmetric);
        if let Some(dense) = &self.dense {
            return Ok(dense.n_negative());
        }
        Ok(self.sparse.as_ref().expect("factorised before").borrow().infog(12) as usize)
    }

    /// Price of a right-hand side among many, in single solves: an eighth on the full demo brake, two ranks, in either
    /// precision.
    pub const PRICE_AMONG_MANY: f64 = 0.15;

    /// How many solves cost about as much as one factorisation. A factorisation is bound by arithmetic and a solve, two
    /// operations an entry, by memory, which is taken for the time of 33 operations an entry: an estimate on the low
    /// side (18 for the medium demo brake, where `make bench` gave 2.32 s against 0.086 s, a ratio of 27). From counts
    /// and not from clocks, so that a run repeats itself. Not collective.
    pub fn solves_per_factorisation(&self) -> f64 {
        self.stats.flops / (33.0 * self.stats.entries.max(1.0))
    }

    /// What this factor has cost so far. Not collective.
    pub fn stats(&self) -> FactorStats {
        let (n_solves, n_right_hand_sides, solve_seconds) = self.solves.get();
        FactorStats { n_solves, n_right_hand_sides, solve_seconds, ..self.stats }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn double_precision_is_tried_for_numerical_reasons_only() {
        let singular = Error::Singular { found_by: "MUMPS".into() };
        assert!(needs_double(Precision::Single, &singular));
        assert!(!needs_double(Precision::Double, &singular));
        assert!(needs_double(Precision::Single, &Error::Mumps { phase: "factorisation", code: -9, detail: 0 }));
        assert!(!needs_double(Precision::Single, &Error::Mumps { phase: "factorisation", code: -16, detail: 0 }));
        let short = Error::OutOfMemory { what: "the factor".into(), needed_mb: None };
        assert!(!needs_double(Precision::Single, &short));
    }
}
