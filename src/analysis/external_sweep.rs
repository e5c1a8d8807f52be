//! Modes of given matrices, at one value of their parameter or along it.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::family::{FrictionFamily, Snapshot, Vectors, widened};
use super::observer::{Event, Observer};
use crate::equilibrium::LabelledFactor;
use crate::matrices::{ExternalMatrices, Sums};
use crate::model::InstabilityCriterion;
use crate::native::{Factor, FactorKind, Mck, Precision};
use crate::stability::{
    self, Band, BandRequest, BandSolver, EigenOptions, Evidence, Mode, QuadraticProblem, Viscoelastic, condition,
    condition_at,
};
use crate::tracking::{Diagram, Options, track};
use crate::{Error, Result};

/// External matrices under analysis at one value after the other.
pub struct ExternalSweep<'a> {
    given: &'a ExternalMatrices,
    solver: BandSolver,
    lu: LabelledFactor,
    band: [f64; 2],
    evidence: Evidence,
}

/// The modes at one value of the parameter. Their vectors are those of the scaled problem, [`ExternalMatrices::scale`].
pub struct ExternalModes {
    /// The modes of the band.
    pub band: Band,
    /// Condition number of the matrix that was factorised, scaled as it is solved.
    pub condition: f64,
    /// Its shift, 1/s; 0 where it is K.
    pub shift: f64,
}

/// Above this condition number K counts as singular, as that of a free structure, and another shift is tried.
const NEARLY_SINGULAR: f64 = 1e13;
/// Where a factor costs nothing, others are tried from here on.
const GOOD: f64 = 1e4;
/// From here on nothing is left of sixteen digits.
const SINGULAR: f64 = 1e15;
/// Shifts that are tried, in units of the band's end. Without a common null vector of M, C and K few numbers are
/// eigenvalues.
const SHIFTS: [f64; 3] = [0.0, 0.31, 0.77];
/// Accuracy of left vectors.
const ACCURACY: f64 = 1e-7;
/// Hopf points are bracketed this closely, as a fraction of the parameter's range.
const BRACKET: f64 = 1e-6;

/// Up to so many rows a factor costs nothing.
const SMALL: usize = 1000;
/// Eigenvalues up to this fraction of the band's end are rigid-body modes: a double zero comes out as large as that.
const RIGID: f64 = 1e-5;

/// Whether an eigenvalue counts as zero where a band (Hz) is analysed.
pub fn is_rigid(lambda: Complex64, band: [f64; 2]) -> bool {
    lambda.norm() <= RIGID * TAU * band[1]
}

/// The places of the modes whose eigenvalues count as zero.
fn rigid_modes(modes: &[Mode], band: [f64; 2]) -> Vec<usize> {
    (0..modes.len()).filter(|&i| is_rigid(modes[i].lambda, band)).collect()
}

impl<'a> ExternalSweep<'a> {
    /// An analysis of a band, Hz.
    pub fn new(given: &'a ExternalMatrices, band: [f64; 2]) -> ExternalSweep<'a> {
        let symmetry = given.symmetry;
        let evidence = match (symmetry.mass, symmetry.damping && symmetry.stiffness && symmetry.structural) {
            (true, true) => Evidence::SturmCount,
            (estimated, _) => Evidence::Repetition { estimated },
        };
        let options = EigenOptions { evidence, ..EigenOptions::default() };
        let solver = BandSolver::new(options, given.labels());
        ExternalSweep { given, solver, lu: LabelledFactor::new(Precision::Double), band, evidence }
    }

    /// What shows that no mode is missing.
    pub fn evidence(&self) -> Evidence {
        self.evidence
    }

    /// All modes of the band at a value of the parameter. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] where the problem is singular; see [`BandSolver::solve_band`].
    pub fn modes(&mut self, value: f64, observer: &mut dyn Observer) -> Result<ExternalModes> {
        let sums = self.given.at(value)?;
        self.modes_of(&sums, self.band, observer)
    }

    fn modes_of(&mut self, sums: &Sums, band: [f64; 2], observer: &mut dyn Observer) -> Result<ExternalModes> {
        let problem = self.problem(sums);
        let (shift, condition) = self.choose_shift(&problem)?;
        let mut progress = |progress| observer.event(Event::Modes(progress));
        let band = self.solver.solve_band(&problem, &mut self.lu, &BandRequest { band, shift }, &mut progress)?;
        Ok(ExternalModes { band, condition, shift })
    }

    fn problem<'s>(&self, sums: &'s Sums) -> QuadraticProblem<'s> {
        let Sums { m, c, k, g, k_symmetric } = sums;
        let symmetry = self.given.symmetry;
        let symmetric_mc = symmetry.mass && symmetry.damping && symmetry.structural;
        let k_symmetric = k_symmetric.as_ref().unwrap_or(k);
        let viscoelastic = Viscoelastic::default();
        QuadraticProblem {
            matrices: Mck { m, c, k, g: g.as_ref() },
            k_symmetric,
            points: None,
            symmetric_mc,
            viscoelastic,
        }
    }

    /// The first shift at which `P(shift)` can be inverted, and the condition number there.
    fn choose_shift(&mut self, problem: &QuadraticProblem) -> Result<(f64, f64)> {
        let mut best = (0.0, f64::INFINITY);
        let enough = if self.given.n <= SMALL { GOOD } else { NEARLY_SINGULAR };
        for share in SHIFTS {
            let shift = share * TAU * self.band[1];
            let condition = condition_at(shift, problem, &mut self.lu)?;
            if condition <= enough {
                return Ok((shift, condition));
            }
            if condition < best.1 {
                best = (shift, condition);
            }
        }
        if best.1 >= SINGULAR {
            return Err(Error::input(
                "the eigenproblem is singular: lambda^2 M + lambda C + K can be inverted for no lambda, as where M, C and K have a common null \
                 vector. Hold or leave out what neither mass nor stiffness resists",
            ));
        }
        Ok(best)
    }

    /// Modes at all values, followed as branches, with their Hopf points; `each` is given those of every value that is
    /// solved. Where the first value has rigid-body modes, eigenvalues that count as zero are left out at all values;
    /// elsewhere an eigenvalue may pass zero, which is a divergence. Collective.
    ///
    /// # Errors
    /// See [`ExternalSweep::modes`] and [`track`]. What was found before an error is in the diagram.
    pub fn follow(
        &mut self,
        values: &[f64],
        criterion: InstabilityCriterion,
        mut each: impl FnMut(f64, &ExternalModes) -> Result<()>,
        observer: &mut dyn Observer,
    ) -> Result<(Diagram, Result<()>)> {
        let (given, band) = (self.given, self.band);
        let mut is_free = None;
        let first = given.at(values[0])?;
        let mut solve = |value: f64| {
            let sums = given.at(value)?;
            let modes = self.modes_of(&sums, widened(band), observer)?;
            each(value, &modes)?;
            let found = &modes.band.modes;
            let left = self.solver.left_vectors(&self.problem(&sums), &mut self.lu, found, |_| ACCURACY)?;
            let right = stability::right_vectors(&sums.m, found)?;
            let mut rigid = rigid_modes(found, band);
            if !*is_free.get_or_insert(!rigid.is_empty()) {
                rigid.clear();
            }
            Ok(Snapshot::of(&modes.band, band[1], &rigid, Vectors { right, left, c: Some(sums.c), m: Some(sums.m) }))
        };
        let mut family = FrictionFamily { solutions: &mut solve, m: &first.m, c: &first.c, viscoelastic: &[] };
        let range = values.iter().fold([f64::MAX, f64::MIN], |[low, high], v| [low.min(*v), high.max(*v)]);
        let tolerance = BRACKET * (range[1] - range[0]);
        let options = Options { band: band.map(|f| TAU * f), tolerance, criterion, rigid: 0.0 };
        Ok(track(&mut family, values, &options))
    }

    /// Why modes cannot be followed from a value on; none where they can: left and right vectors are compared in the
    /// norm of M, which has to be symmetric and positive. Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's.
    pub fn cannot_follow(&self, value: f64) -> Result<Option<&'static str>> {
        if !self.given.symmetry.mass {
            return Ok(Some("M is not symmetric"));
        }
        let mut m = self.given.at(value)?.m;
        m.declare_symmetric()?;
        let mut factor = Factor::new(FactorKind::Symmetric);
        factor.factorise(&m)?;
        let is_positive = factor.n_negative()? == 0 && condition(&m, &factor)? < SINGULAR;
        Ok(if is_positive { None } else { Some("M is not positive definite") })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrices::family::Coefficient;
    use crate::matrices::{Role, Term};
    use crate::native::Session;

    /// Looks at an analysis up to 2 Hz of matrices of two rows.
    fn with_sweep<T>(m: [f64; 4], k: [f64; 4], look: impl FnOnce(&mut ExternalSweep) -> T) -> T {
        let (comm, place) = (Session::start(&[]).unwrap(), tempfile::TempDir::new().unwrap());
        let term = |(role, a, name): (Role, [f64; 4], &str)| {
            let entries: String = (0..4).map(|i| format!("{} {} {}\n", 1 + i / 2, 1 + i % 2, a[i])).collect();
            let file = place.path().join(name);
            std::fs::write(&file, format!("%%MatrixMarket matrix coordinate real general\n2 2 4\n{entries}")).unwrap();
            Term { role, file, factor: Coefficient::one() }
        };
        let terms: Vec<Term> = [(Role::Mass, m, "m.mtx"), (Role::Stiffness, k, "k.mtx")].map(term).into();
        let given = ExternalMatrices::read(&comm, &terms, TAU).unwrap();
        look(&mut ExternalSweep::new(&given, [0.0, 2.0]))
    }

    const UNIT: [f64; 4] = [1.0, 0.0, 0.0, 1.0];
    const SPRINGS: [f64; 4] = [40.0, -10.0, -10.0, 40.0];

    #[test]
    fn a_regular_stiffness_is_inverted_as_it_is() {
        with_sweep(UNIT, SPRINGS, |sweep| assert_eq!(sweep.modes(0.0, &mut ()).unwrap().shift, 0.0));
    }

    #[test]
    fn a_singular_stiffness_moves_the_shift() {
        with_sweep(UNIT, [10.0, -10.0, -10.0, 10.0], |sweep| {
            let found = sweep.modes(0.0, &mut ()).unwrap();
            assert!((found.shift - 0.31 * TAU * 2.0).abs() < 1e-12 && found.condition <= GOOD);
            assert!(found.band.modes.iter().any(|mode| (mode.lambda.im - 20_f64.sqrt()).abs() < 1e-9));
        });
    }

    #[test]
    fn a_common_null_vector_is_refused() {
        let ones = [1.0; 4];
        let error = with_sweep(ones, ones, |sweep| sweep.modes(0.0, &mut ()).err().unwrap().to_string());
        assert!(error.contains("the eigenproblem is singular"), "{error}");
    }

    #[test]
    fn modes_are_followed_in_the_norm_of_a_positive_mass_alone() {
        with_sweep(UNIT, SPRINGS, |sweep| assert_eq!(sweep.cannot_follow(0.0).unwrap(), None));
    }

    #[test]
    fn an_indefinite_mass_is_no_norm() {
        with_sweep([1.0, 0.0, 0.0, -1.0], SPRINGS, |sweep| {
            assert_eq!(sweep.cannot_follow(0.0).unwrap(), Some("M is not positive definite"));
        });
    }

    #[test]
    fn an_unsymmetric_mass_is_no_norm_and_leaves_no_count() {
        with_sweep([1.0, 0.5, 0.0, 1.0], SPRINGS, |sweep| {
            assert_eq!(sweep.cannot_follow(0.0).unwrap(), Some("M is not symmetric"));
            assert_eq!(sweep.evidence(), Evidence::Repetition { estimated: false });
        });
    }

    #[test]
    fn the_sturm_count_is_evidence_for_symmetric_matrices_alone() {
        with_sweep(UNIT, [40.0, 10.0, -10.0, 40.0], |sweep| {
            assert_eq!(sweep.evidence(), Evidence::Repetition { estimated: true });
        });
    }
}
