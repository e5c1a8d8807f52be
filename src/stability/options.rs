//! Tolerances and thresholds of the eigensolution, with their defaults.

/// Backward error of a mode over the accuracy of its vector: stiff motions that a vector lacks weigh more in it.
const BACKWARD_ERROR_OF_VECTORS: f64 = 1e-3;

/// What shows that no mode is missing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Evidence {
    /// The Sturm count of the symmetric problem: what brakes have.
    #[default]
    SturmCount,
    /// For matrices of any structure, where a Sturm count proves nothing. A search finds all eigenvalues that there
    /// are; or as many modes as the search before, which was for fewer; or, where M is symmetric and so a Sturm count
    /// gives about how many there are (`estimated`), just as many.
    Repetition {
        /// Whether a Sturm count gives an estimate.
        estimated: bool,
    },
}

impl Evidence {
    /// Up to so many dofs [`Evidence::Repetition`] searches for all eigenvalues.
    pub const ALL_UP_TO: usize = 100;
}

/// How the modes of a band are searched for.
#[derive(Debug, Clone, Copy)]
pub struct EigenOptions {
    /// What shows that no mode is missing. Default: the Sturm count.
    pub evidence: Evidence,
    /// Searches before the band is given up. Default: 4.
    pub n_attempts: usize,
    /// Modes that the first search is for with [`Evidence::Repetition`] where nothing gives their number. Default: 10.
    pub n_guessed: usize,
    /// By this factor a shift that is not zero moves where TOAR gave up: about another shift it does not meet the same
    /// blocks. Default: 1.3.
    pub shift_growth: f64,
    /// The blocked search goes so far, relative to the band's end, so that the count finds a gap; farther in the second
    /// attempt, for friction that has carried a mode across that gap; then it is TOAR's turn. Default: 1.03, 1.12.
    pub band_margins: [f64; 2],
    /// Dofs from which the blocked search is used: below, a single solve costs too little. Default: 50 000.
    pub blocked_from: usize,
    /// Of the blocked search.
    pub blocked: BlockedOptions,
    /// Residual tolerance of TOAR: near double roots a residual of e is an error of sqrt(e) in the eigenvalue. Default:
    /// 1e-12.
    pub toar_tolerance: f64,
    /// The same in modal coordinates, with the band's end for the unit of frequency. Default: 1e-11, which leaves
    /// backward errors of 2e-14 and eigenvalues to 2e-12 (782 coordinates).
    pub modal_tolerance: f64,
    /// Basis of TOAR over the eigenvalues wanted in modal coordinates: next to products its own upkeep counts there,
    /// and half of SLEPc's basis takes half the time (782 coordinates). It restarts more often, which costs digits.
    /// Default: 1.3.
    pub modal_basis_ratio: f64,
    /// Up to so many left vectors in modal coordinates are sought one by one, more by a search of their own. Default:
    /// 6.
    pub n_left_one_by_one: usize,
    /// Rounds of corrections to left vectors at most; a round wins a factor of about five. Default: 40.
    pub max_left_rounds: usize,
    /// Largest backward error of an eigenpair that is found in modal coordinates. Default: 1e-10.
    pub backward_error: f64,
}

/// How the blocked search (`stability::blocked`) works.
#[derive(Debug, Clone, Copy)]
pub struct BlockedOptions {
    /// Columns of a Krylov block. Default: 16.
    pub krylov_block: usize,
    /// Columns of the Krylov space for each mode expected. Default: 1.4.
    pub krylov_per_mode: f64,
    /// An earlier search's modes are of use up to this multiple of the radius: those beyond the band are what
    /// corrections by `K^-1` win slowly. Default: 1.3 (medium demo brake, mu = 0.6 and 0.7: 430 and 434 solves without
    /// a start, 292 and 312 with 1, 262 and 290 with 1.3, 266 and 280 with 1.6).
    pub start_radius: f64,
    /// Relative change of an eigenvalue from round to round at which it is converged. A round wins a factor of three to
    /// five, so that the error left is below half the change: two searches differ by less than that. Default: 5e-10.
    pub eigenvalue_change: f64,
    /// The round, counted from zero, that corrects left vectors and not right ones: an eigenvalue's error is the
    /// product of both vectors' errors, and the first correction of a vector gains most. Default: 1.
    pub left_round: usize,
    /// Largest backward error of an eigenpair. Default: 1e-9.
    pub backward_error: f64,
    /// Rounds of correction before the search is given up. Default: 40.
    pub max_rounds: usize,
}

impl Default for BlockedOptions {
    fn default() -> Self {
        BlockedOptions {
            krylov_block: 16,
            krylov_per_mode: 1.4,
            start_radius: 1.3,
            eigenvalue_change: 5e-10,
            left_round: 1,
            backward_error: 1e-9,
            max_rounds: 40,
        }
    }
}

impl Default for EigenOptions {
    fn default() -> Self {
        EigenOptions {
            evidence: Evidence::SturmCount,
            n_attempts: 4,
            n_guessed: 10,
            shift_growth: 1.3,
            band_margins: [1.03, 1.12],
            blocked_from: 50_000,
            blocked: BlockedOptions::default(),
            toar_tolerance: 1e-12,
            modal_tolerance: 1e-11,
            modal_basis_ratio: 1.3,
            n_left_one_by_one: 6,
            max_left_rounds: 40,
            backward_error: 1e-10,
        }
    }
}

impl EigenOptions {
    /// The blocked search whatever the size.
    pub fn always_blocked() -> EigenOptions {
        EigenOptions { blocked_from: 0, ..EigenOptions::default() }
    }

    /// For modes whose vectors are needed to an accuracy alone: their eigenvalues have about its square as their error.
    /// Concerns the blocked search.
    pub fn with_vector_accuracy(accuracy: f64) -> EigenOptions {
        let mut options = EigenOptions::default();
        let own = &mut options.blocked;
        own.eigenvalue_change = (accuracy * accuracy).max(own.eigenvalue_change);
        own.backward_error = (BACKWARD_ERROR_OF_VECTORS * accuracy).max(own.backward_error);
        options
    }

    /// Modes beyond those expected that an attempt searches for: a few, and three times as many in the next attempt.
    pub(super) fn n_margin(&self, n_expected: usize, attempt: usize) -> usize {
        (4 + n_expected / 20) * 3_usize.pow(attempt as u32)
    }
}
