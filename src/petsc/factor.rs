//! Direct factors: of sparse matrices by MUMPS, analysed once for a pattern and factorised again as often as values change; of
//! densely stored ones by LAPACK.

use std::cell::Cell;
use std::ptr;
use std::time::Instant;

use squeal_sys as sys;

use super::dense_factor::DenseFactor;
use super::error::check;
use super::{Comm, Matrix, Vector, memory};
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
    /// Ordering used, MUMPS's number (3 is SCOTCH, 4 PORD); none where the matrix is dense and LAPACK factorises it.
    pub ordering: Option<i32>,
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

/// Names of MUMPS's orderings.
const ORDERINGS: [&str; 8] = ["AMD", "user", "AMF", "SCOTCH", "PORD", "METIS", "QAMD", "automatic"];

impl FactorStats {
    /// Name of the ordering.
    pub fn ordering_name(&self) -> &'static str {
        self.ordering.map_or("none (dense)", |number| ORDERINGS.get(number as usize).unwrap_or(&"?"))
    }
}

/// A factorised matrix. The first factorisation analyses the pattern, which all later ones share.
pub struct Factor {
    kind: FactorKind,
    raw: sys::Mat,
    /// Keeps the session alive as long as the factor.
    comm: Option<Comm>,
    stats: FactorStats,
    /// The factor of a densely stored matrix, instead of MUMPS's.
    dense: Option<DenseFactor>,
    /// Memory that others will need beside it, MB.
    left_mb: f64,
    /// Passes, right-hand sides and seconds, counted by solves that leave the factor as it is.
    solves: Cell<(usize, usize, f64)>,
}

impl Drop for Factor {
    fn drop(&mut self) {
        if self.comm.is_some() {
            // SAFETY: this handle owns the factor, and the session is alive.
            unsafe { sys::MatDestroy(&mut self.raw) };
        }
    }
}

/// Percentage of extra workspace over MUMPS's estimate, and how often it is doubled when pivoting needs more.
const WORKSPACE: i32 = 30;
const WORKSPACE_TRIES: usize = 4;
/// What a factorisation touches of the memory that MUMPS estimates, extra workspace included: 0.78 to 0.80 on the demo brakes.
const TOUCHED: f64 = 0.82;

impl Factor {
    /// A factor to be; nothing is computed yet.
    pub fn new(kind: FactorKind) -> Factor {
        let (comm, stats, solves) = (None, FactorStats::default(), Cell::default());
        Factor { kind, raw: ptr::null_mut(), comm, stats, dense: None, left_mb: 0.0, solves }
    }

    /// Orders the equations and makes the symbolic factorisation, unless that is done. No values are used.
    ///
    /// # Errors
    /// PETSc's, MUMPS's with its code, or [`Error::Input`] where the machine has too little memory for the factor.
    pub fn analyse(&mut self, a: &Matrix) -> Result<()> {
        if !self.raw.is_null() {
            return Ok(());
        }
        let start = Instant::now();
        let kind_raw = match self.kind {
            FactorKind::Unsymmetric => sys::MatFactorType::MAT_FACTOR_LU,
            FactorKind::Symmetric => sys::MatFactorType::MAT_FACTOR_CHOLESKY,
        };
        // SAFETY: the handle is alive and the solver's name static.
        check(unsafe { sys::MatGetFactor(a.raw(), c"mumps".as_ptr(), kind_raw, &mut self.raw) })?;
        self.comm = Some(a.comm().clone());
        self.set_icntl(14, WORKSPACE)?;
        if self.kind == FactorKind::Symmetric {
            // The inertia is right only with null pivots detected, and on several ranks without a parallel root.
            self.set_icntl(24, 1)?;
            self.set_icntl(13, 1)?;
        }
        self.symbolic(a)?;
        self.stats.ordering = Some(self.infog(7)? as i32);
        self.stats.estimated_mb = self.infog(17)?;
        self.stats.n_analyses += 1;
        self.stats.analysis_seconds += start.elapsed().as_secs_f64();
        let [touched, reserved] = [TOUCHED, 1.0].map(|share| share * self.stats.estimated_mb + self.left_mb);
        if !memory::has_room(a.comm(), touched, reserved) {
            self.set_icntl(22, 1)?;
            self.stats.out_of_core = true;
            self.stats.estimated_mb = self.infog(27)?;
        }
        memory::require(a.comm(), self.stats.estimated_mb)
    }

    /// From now on an analysis chooses to keep the factor out of core unless so much memory is left beside it, MB. Not collective.
    pub fn leave_mb(&mut self, mb: f64) {
        self.left_mb = mb;
    }

    /// Whether there is a factor. Not collective.
    pub fn is_made(&self) -> bool {
        !self.raw.is_null()
    }

    /// Gives the memory back; the next factorisation analyses anew. Collective.
    pub fn release(&mut self) {
        if self.comm.take().is_some() {
            // SAFETY: this handle owns the factor; PETSc sets the pointer to null.
            unsafe { sys::MatDestroy(&mut self.raw) };
        }
    }

    fn symbolic(&self, a: &Matrix) -> Result<()> {
        let mut info = sys::MatFactorInfo::default();
        let none = ptr::null_mut();
        // SAFETY: MUMPS orders by itself, so that no permutations are passed.
        unsafe {
            check(sys::MatFactorInfoInitialize(&mut info))?;
            check(match self.kind {
                FactorKind::Unsymmetric => sys::MatLUFactorSymbolic(self.raw, a.raw(), none, none, &info),
                FactorKind::Symmetric => sys::MatCholeskyFactorSymbolic(self.raw, a.raw(), none, &info),
            })?;
        }
        self.verdict("analysis")
    }

    /// Factorises the values of `a`, whose pattern is that of all earlier calls. Workspace is enlarged where pivoting needs it.
    ///
    /// # Errors
    /// PETSc's, and MUMPS's with its code.
    pub fn factorise(&mut self, a: &Matrix) -> Result<()> {
        if let Some(values) = a.dense_values()? {
            return self.factorise_dense(a.n_local(), values);
        }
        self.analyse(a)?;
        let start = Instant::now();
        let mut workspace = WORKSPACE;
        for attempt in 0..WORKSPACE_TRIES {
            self.numeric(a)?;
            if !matches!(self.infog(1)? as i32, -8 | -9 | -11 | -12 | -14 | -15) || attempt + 1 == WORKSPACE_TRIES {
                break;
            }
            workspace *= 2;
            self.set_icntl(14, workspace)?;
        }
        self.verdict("factorisation")?;
        self.stats.entries = self.infog(29)?;
        self.stats.used_mb = self.infog(22)?;
        self.stats.flops = self.rinfog(3)?;
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
    pub(super) fn dense(&self) -> Option<&DenseFactor> {
        self.dense.as_ref()
    }

    fn numeric(&self, a: &Matrix) -> Result<()> {
        let mut info = sys::MatFactorInfo::default();
        // SAFETY: the factor was analysed for this pattern.
        unsafe {
            check(sys::MatFactorInfoInitialize(&mut info))?;
            check(match self.kind {
                FactorKind::Unsymmetric => sys::MatLUFactorNumeric(self.raw, a.raw(), &info),
                FactorKind::Symmetric => sys::MatCholeskyFactorNumeric(self.raw, a.raw(), &info),
            })
        }
    }

    fn set_icntl(&self, index: i32, value: i32) -> Result<()> {
        // SAFETY: the handle is a MUMPS factor.
        check(unsafe { sys::MatMumpsSetIcntl(self.raw, index, value) })
    }

    /// MUMPS's global real information number.
    fn rinfog(&self, index: i32) -> Result<f64> {
        let mut value = 0.0;
        // SAFETY: the handle is a MUMPS factor.
        check(unsafe { sys::MatMumpsGetRinfog(self.raw, index, &mut value) })?;
        Ok(value)
    }

    /// MUMPS's global information number; large counts, which MUMPS gives as negative millions, are turned into counts.
    fn infog(&self, index: i32) -> Result<f64> {
        let mut value = 0;
        // SAFETY: the handle is a MUMPS factor.
        check(unsafe { sys::MatMumpsGetInfog(self.raw, index, &mut value) })?;
        let counts = [3, 20, 29].contains(&index);
        Ok(if counts && value < 0 { -1e6 * f64::from(value) } else { f64::from(value) })
    }

    /// MUMPS fails silently through PETSc: its own code is looked at each time.
    fn verdict(&self, phase: &str) -> Result<()> {
        let (code, detail) = (self.infog(1)? as i32, self.infog(2)?);
        if code >= 0 {
            return Ok(());
        }
        let meaning = match code {
            -5 | -7 | -13 => "not enough memory; use a smaller mesh or a machine with more",
            -8 | -9 | -11 | -12 | -14 | -15 => "its workspace was too small even after enlarging",
            -6 | -10 => "the matrix is singular: a part is held by nothing, or the load has reached a limit point",
            -16 => "the matrix is empty",
            _ => "see MUMPS's manual, INFOG(1)",
        };
        Err(Error::Library(format!("MUMPS {phase} failed with INFOG(1) = {code}, INFOG(2) = {detail}: {meaning}")))
    }

    /// `x = A^-1 b`.
    ///
    /// # Errors
    /// PETSc's, and MUMPS's with its code.
    pub fn solve(&self, b: &Vector, x: &mut Vector) -> Result<()> {
        let start = Instant::now();
        if let Some(dense) = &self.dense {
            x.copy_from(b)?;
            x.local_mut(|x| dense.solve(x, false))?;
            self.count(1, start);
            return Ok(());
        }
        // SAFETY: all handles are alive.
        check(unsafe { sys::MatSolve(self.raw, b.raw(), x.raw()) })?;
        self.count(1, start);
        self.verdict("solve")
    }

    fn count(&self, n_right_hand_sides: usize, start: Instant) {
        let (n, n_all, seconds) = self.solves.get();
        self.solves.set((n + 1, n_all + n_right_hand_sides, seconds + start.elapsed().as_secs_f64()));
    }

    /// Dense right-hand sides and solutions of one shape, with A or its transpose.
    pub(super) fn solve_dense(&self, b: sys::Mat, x: sys::Mat, n_columns: usize, transposed: bool) -> Result<()> {
        let start = Instant::now();
        // ICNTL(9): 1 solves with A, anything else with its transpose.
        self.set_icntl(9, i32::from(!transposed))?;
        // SAFETY: both are dense matrices of the factor's row layout.
        let outcome = check(unsafe { sys::MatMatSolve(self.raw, b, x) });
        self.set_icntl(9, 1)?;
        outcome?;
        self.count(n_columns, start);
        self.verdict("solve")
    }

    /// Number of negative pivots of a symmetric factor: how many eigenvalues of the matrix are negative.
    ///
    /// # Errors
    /// PETSc's.
    pub fn n_negative(&self) -> Result<usize> {
        debug_assert_eq!(self.kind, FactorKind::Symmetric);
        if let Some(dense) = &self.dense {
            return Ok(dense.n_negative());
        }
        Ok(self.infog(12)? as usize)
    }

    /// How many solves cost about as much as one factorisation. A factorisation is bound by arithmetic and a solve, two
    /// operations an entry, by memory, which is taken for the time of 33 operations an entry: an estimate on the low side (18 for the medium
    /// demo brake, where `make bench` gave 2.32 s against 0.086 s, a ratio of 27). From counts and not from clocks, so that a run
    /// repeats itself. Not collective.
    pub fn solves_per_factorisation(&self) -> f64 {
        self.stats.flops / (33.0 * self.stats.entries.max(1.0))
    }

    /// What this factor has cost so far. Not collective.
    pub fn stats(&self) -> FactorStats {
        let (n_solves, n_right_hand_sides, solve_seconds) = self.solves.get();
        FactorStats { n_solves, n_right_hand_sides, solve_seconds, ..self.stats }
    }
}
