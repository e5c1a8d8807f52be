//! The family of eigenproblems over the friction coefficient, as tracking sees it.

use std::cell::OnceCell;
use std::f64::consts::TAU;
use std::rc::{Rc, Weak};

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::sweep::Sweep;
use crate::Result;
use crate::assembly::ViscoelasticStiffness;
use crate::model::InstabilityCriterion;
use crate::model::viscoelastic::ViscoelasticLaw;
use crate::native::{Block, Matrix, Vector};
use crate::stability::{Band, RIGID_RATE, complex_product};
use crate::tracking::{Family, Options};

/// The modes at one value with right and left vectors, and what their products need.
pub struct Snapshot {
    /// Its number among those of a study, from 0.
    pub number: usize,
    spectrum: Spectrum,
    vectors: OnceCell<Vectors>,
    life: Rc<()>,
}

/// The eigenvalues of a snapshot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Spectrum {
    /// Modes as the eigensolver gave them, then the conjugates of low ones, where these are eigenvalues.
    pub lambdas: Vec<Complex64>,
    /// For each of them its place among the eigensolver's, and whether it is the conjugate.
    pub places: Vec<(usize, bool)>,
}

/// The vectors of a snapshot.
pub struct Vectors {
    /// Real and imaginary parts of the right vectors, two columns a mode, `x^H M x = 1`.
    pub right: Block,
    /// The left ones, `y^H M y = 1`.
    pub left: Block,
    /// The damping, where it is not the system's.
    pub c: Option<Matrix>,
    /// The mass, where it is not the system's.
    pub m: Option<Matrix>,
}

/// Eigenproblems over the friction coefficient of the swept pairs.
pub struct FrictionFamily<'f> {
    /// Finds equilibrium and modes.
    pub solutions: &'f mut dyn Solutions,
    /// Mass.
    pub m: &'f Matrix,
    /// Damping of the system.
    pub c: &'f Matrix,
    /// Stiffnesses of the system that depend on lambda.
    pub viscoelastic: &'f [ViscoelasticStiffness],
}

/// Where the modes at a value come from: a solve, and what an earlier run has kept. All are collective.
pub trait Solutions {
    /// Equilibrium, modes and their snapshot at a value of the friction coefficient.
    ///
    /// # Errors
    /// Those of the solution, with which tracking ends.
    fn solve(&mut self, friction: f64) -> Result<Snapshot>;

    /// The vectors of a snapshot that was made without, by its number.
    ///
    /// # Errors
    /// Where they cannot be had.
    fn vectors(&mut self, number: usize) -> Result<Vectors> {
        Err(crate::Error::library("resume")(format!("the vectors of snapshot {number} were not kept")))
    }

    /// The products of two snapshots' left and right vectors, where they are known.
    ///
    /// # Errors
    /// Where they cannot be read.
    fn known(&mut self, _numbers: [usize; 2]) -> Result<Option<DMatrix<Complex64>>> {
        Ok(None)
    }

    /// Hears of products.
    ///
    /// # Errors
    /// Where they cannot be kept.
    fn keep(&mut self, _numbers: [usize; 2], _products: &DMatrix<Complex64>) -> Result<()> {
        Ok(())
    }
}

impl<F: FnMut(f64) -> Result<Snapshot>> Solutions for F {
    fn solve(&mut self, friction: f64) -> Result<Snapshot> {
        self(friction)
    }
}

/// Modes are solved for up to this fraction beyond the band's end, and conjugates kept down to as far below zero: there
/// modes come and go unnoticed.
const BEYOND: f64 = 0.05;
/// Accuracy of left vectors that explain a mode: sensitivities are as exact.
const EXPLAINS: f64 = 1e-7;
/// Accuracy of left vectors that only recognise a mode at the next value.
const RECOGNISES: f64 = 1e-4;
/// Hopf points are bracketed to this, in the friction coefficient.
const TOLERANCE: f64 = 1e-3;

/// The band (Hz) to be solved for where modes of `band` are to be followed.
pub fn widened(band: [f64; 2]) -> [f64; 2] {
    let reach = BEYOND * band[1];
    [if band[0] > reach { band[0] - reach } else { 0.0 }, band[1] + reach]
}

/// How modes of a band (Hz) are followed over the friction coefficient.
pub fn tracking_options(band: [f64; 2], criterion: InstabilityCriterion) -> Options {
    Options { band: band.map(|f| TAU * f), tolerance: TOLERANCE, criterion, rigid: RIGID_RATE }
}

impl Snapshot {
    /// Left vectors of the modes that a sweep has just found, those of unstable modes to seven digits, and right
    /// vectors in the same form. Collective.
    ///
    /// # Errors
    /// See [`crate::stability::BandSolver::left_vectors`].
    pub fn new(sweep: &mut Sweep, band: &Band, end: f64) -> Result<Snapshot> {
        Snapshot::with(sweep, band, end, RECOGNISES)
    }

    /// As [`Snapshot::new`], where only unstable modes need left vectors: those of the others are not computed.
    /// Collective.
    ///
    /// # Errors
    /// See [`crate::stability::BandSolver::left_vectors`].
    pub fn of_unstable(sweep: &mut Sweep, band: &Band, end: f64) -> Result<Snapshot> {
        Snapshot::with(sweep, band, end, f64::INFINITY)
    }

    /// With the accuracy of stable modes' left vectors.
    fn with(sweep: &mut Sweep, band: &Band, end: f64, of_stable: f64) -> Result<Snapshot> {
        let left = sweep.left_vectors(&band.modes, |mode| if mode.grows() { EXPLAINS } else { of_stable })?;
        let right = sweep.right_vectors(&band.modes)?;
        Ok(Snapshot::of(band, end, &[], Vectors { right, left, c: sweep.own_damping()?, m: None }))
    }

    /// The modes of a band with their vectors.
    /// Those at the places `rigid` are left out: rounding alone moves rigid-body modes.
    pub(super) fn of(band: &Band, end: f64, rigid: &[usize], vectors: Vectors) -> Snapshot {
        let followed: Vec<usize> = (0..band.modes.len()).filter(|i| !rigid.contains(i)).collect();
        let low = |i: &usize| {
            let omega = band.modes[*i].lambda.im;
            band.has_conjugates && omega > 0.0 && omega < BEYOND * TAU * end
        };
        let places: Vec<(usize, bool)> = followed
            .iter()
            .map(|&i| (i, false))
            .chain(followed.iter().copied().filter(low).map(|i| (i, true)))
            .collect();
        let lambda = |&(i, conjugate): &(usize, bool)| {
            let lambda = band.modes[i].lambda;
            if conjugate { lambda.conj() } else { lambda }
        };
        let spectrum = Spectrum { lambdas: places.iter().map(lambda).collect(), places };
        Snapshot { vectors: OnceCell::from(vectors), ..Snapshot::kept(0, spectrum) }
    }

    /// A snapshot whose vectors come from [`Solutions::vectors`] when they are needed.
    pub fn kept(number: usize, spectrum: Spectrum) -> Snapshot {
        Snapshot { number, spectrum, vectors: OnceCell::new(), life: Rc::new(()) }
    }

    /// The eigenvalues.
    pub fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// The vectors, where they are here.
    pub fn vectors(&self) -> Option<&Vectors> {
        self.vectors.get()
    }

    /// What dies with the snapshot.
    pub fn life(&self) -> Weak<()> {
        Rc::downgrade(&self.life)
    }

    /// Real and imaginary part of the left vector of the i-th mode that the eigensolver gave.
    ///
    /// # Errors
    /// PETSc's.
    ///
    /// # Panics
    /// Where the snapshot has no vectors; that of [`Snapshot::new`] has.
    pub fn left(&self, i: usize) -> Result<[Vector; 2]> {
        let left = &self.vectors().expect("made with its vectors").left;
        Ok([left.vector(2 * i)?, left.vector(2 * i + 1)?])
    }
}

impl FrictionFamily<'_> {
    fn vectors<'s>(&mut self, snapshot: &'s Snapshot) -> Result<&'s Vectors> {
        if snapshot.vectors.get().is_none() {
            let vectors = self.solutions.vectors(snapshot.number)?;
            return Ok(snapshot.vectors.get_or_init(|| vectors));
        }
        Ok(snapshot.vectors.get().expect("looked at above"))
    }
}

impl Family for FrictionFamily<'_> {
    type Modes = Snapshot;

    fn solve(&mut self, value: f64) -> Result<Snapshot> {
        self.solutions.solve(value)
    }

    fn eigenvalues<'m>(&self, modes: &'m Snapshot) -> &'m [Complex64] {
        &modes.spectrum.lambdas
    }

    fn products(&mut self, left: &Snapshot, right: &Snapshot) -> Result<DMatrix<Complex64>> {
        let numbers = [left.number, right.number];
        if let Some(known) = self.solutions.known(numbers)? {
            return Ok(known);
        }
        let (y, x) = (self.vectors(left)?, self.vectors(right)?);
        let product = |matrix: &Matrix| -> Result<DMatrix<f64>> {
            let product = y.left.gram(&x.right.multiplied_by(matrix)?);
            Ok(DMatrix::from_vec(y.left.n_columns(), x.right.n_columns(), product))
        };
        let m = product(y.m.as_ref().unwrap_or(self.m))?;
        let c = product(y.c.as_ref().unwrap_or(self.c))?;
        let viscoelastic = self.viscoelastic.iter().map(|own| Ok((&own.law, product(&own.stiffness)?)));
        let viscoelastic: Vec<(&ViscoelasticLaw, DMatrix<f64>)> = viscoelastic.collect::<Result<_>>()?;
        let [left, right] = [&left.spectrum, &right.spectrum];
        let products = DMatrix::from_fn(left.lambdas.len(), right.lambdas.len(), |i, j| {
            let with = |a: &DMatrix<f64>| complex_product(a, left.places[i], right.places[j]);
            let lambdas = [left.lambdas[i], right.lambdas[j]];
            let of_laws = viscoelastic.iter().map(|(law, k)| divided_difference(law, lambdas) * with(k));
            (lambdas[0] + lambdas[1]) * with(&m) + with(&c) + of_laws.sum::<Complex64>()
        });
        self.solutions.keep(numbers, &products)?;
        Ok(products)
    }
}

/// `(r(a) - r(b)) / (a - b)`, with which the products of different modes of one problem are zero.
fn divided_difference(law: &ViscoelasticLaw, [a, b]: [Complex64; 2]) -> Complex64 {
    const ONE_EIGENVALUE: f64 = 1e-6;
    match (a - b).norm() <= ONE_EIGENVALUE * a.norm() {
        true => law.slope(a),
        false => (law.factor(a) - law.factor(b)) / (a - b),
    }
}
