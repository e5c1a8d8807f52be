//! Small problems with known modes for the tests of this module.

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::{LinearTerms, Linearised, QuadraticProblem, SearchResult, SolverKind};
use crate::assembly::{System, ViscoelasticStiffness};
use crate::contact::{Interface, Stage};
use crate::equilibrium::testing::{ALONG_X, belt, blocks, blocks_on_belt, system};
use crate::equilibrium::{Contacts, Equilibrium};
use crate::model::viscoelastic::ViscoelasticLaw;
use crate::native::petsc::eigen::Pair;
use crate::native::{Comm, Matrix, Mck, Vector, lapack};

/// A densely stored diagonal matrix.
pub fn diagonal(comm: &Comm, values: &[f64]) -> Matrix {
    dense(comm, &DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(values)))
}

/// A densely stored matrix.
pub fn dense(comm: &Comm, a: &DMatrix<f64>) -> Matrix {
    Matrix::dense(comm, a.nrows(), a.transpose().as_slice()).unwrap()
}

/// Unit masses on springs with these frequencies, Hz.
pub fn masses(comm: &Comm, frequencies: &[f64]) -> Mck<Matrix> {
    let of = |value: fn(&f64) -> f64| diagonal(comm, &frequencies.iter().map(value).collect::<Vec<_>>());
    Mck::from([of(|_| 1.0), of(|_| 0.0), of(|f| (TAU * f).powi(2))])
}

/// What a search has found: undamped modes (Hz) up to a frequency, with vectors of one row.
pub fn found(comm: &Comm, frequencies: &[f64], reach: f64) -> SearchResult {
    let one = || Vector::from_local(comm, &[1.0]).unwrap();
    let pair = |f: &f64| Pair { lambda: Complex64::new(0.0, TAU * f), re: one(), im: one() };
    SearchResult {
        solver: SolverKind::Toar,
        pairs: frequencies.iter().map(pair).collect(),
        backward_errors: vec![0.0; frequencies.len()],
        reach,
        n_solves: 5,
    }
}

/// Blocks on a belt, linearised.
pub struct Blocks {
    pub system: System,
    pub interface: Interface,
    /// Frequency of viscoelastic stiffnesses, Hz.
    pub reference: f64,
}

impl Blocks {
    /// Stored sparsely.
    pub fn new(comm: &Comm, n: usize) -> Blocks {
        let (system, interface) = blocks_on_belt(comm, n, 0, ALONG_X);
        Blocks { system, interface, reference: 0.0 }
    }

    /// With loss factors between 0.02 and 0.1, another one for each neighbouring dof.
    pub fn with_structural_damping(comm: &Comm, n: usize) -> Blocks {
        let (interface, real) = (belt(n, ALONG_X), blocks(n));
        let loss = |i: usize| 0.02 * (1 + i % 5) as f64;
        let own = |i: usize, j: usize| if i == j { loss(i) * real.k[(i, i)] } else { 0.0 };
        let g = Some(DMatrix::from_fn(3 * n, 3 * n, own));
        let system = system(comm, Mck { g, ..real }, &interface.gap_operator, &[]);
        Blocks { system, interface, reference: 0.0 }
    }

    /// With a law for a share of each dof's spring, one law for the dofs with an even number and another for the odd
    /// ones.
    pub fn with_viscoelastic(comm: &Comm, n: usize, laws: [ViscoelasticLaw; 2], share: f64) -> Blocks {
        let mut blocks = Blocks::new(comm, n);
        for (i, law) in laws.into_iter().enumerate() {
            let real = self::blocks(n);
            let own = |row: usize, j: usize| if row == j && row % 2 == i { share * real.k[(row, row)] } else { 0.0 };
            let g = Some(DMatrix::from_fn(3 * n, 3 * n, own));
            let stiffness = system(comm, Mck { g, ..real }, &blocks.interface.gap_operator, &[]).g.unwrap();
            blocks.system.viscoelastic.push(ViscoelasticStiffness { law, stiffness });
        }
        blocks
    }

    /// Stored densely.
    pub fn dense(comm: &Comm, n: usize) -> Blocks {
        let mut blocks = Blocks::new(comm, n);
        let System { m, c, k, .. } = &mut blocks.system;
        [m, c, k].into_iter().for_each(|a| a.store_dense().unwrap());
        blocks
    }

    /// The problem at a friction value where some of the blocks are off the belt.
    pub fn with<T>(&self, mu: f64, open: &[usize], look: impl FnOnce(&QuadraticProblem) -> T) -> T {
        let contacts = Contacts::new(&self.interface, &self.system).unwrap();
        let mut u = vec![0.0; self.system.dofs.n_local()];
        (0..u.len() / 3).for_each(|i| u[3 * i + 2] = if open.contains(&i) { 1.0 } else { -1.0 });
        let u = Vector::from_local(self.system.k.comm(), &u).unwrap();
        let responses = contacts.respond(&u, &Stage::Solve { friction: vec![mu] }).unwrap();
        let equilibrium = Equilibrium { u, responses, friction: mu, steps: Vec::new() };
        let mut k = self.system.k.duplicate().unwrap();
        let terms = LinearTerms { reference: TAU * self.reference, ..LinearTerms::default() };
        let linearised = Linearised::new(&self.system, &contacts, &equilibrium, terms, &mut k).unwrap();
        look(&linearised.problem(&self.system, &contacts, &k))
    }
}

/// The entries of a matrix on one rank.
pub fn entries(a: &Matrix) -> DMatrix<f64> {
    let mut values = DMatrix::zeros(a.n_local(), a.n_local());
    let visit = |row: usize, columns: &[i32], entries: &[f64]| {
        columns.iter().zip(entries).for_each(|(&column, &value)| values[(row, column as usize)] = value);
    };
    a.visit_rows(visit).unwrap();
    values
}

/// All eigenvalues of the closed upper half plane with a modulus up to a frequency (Hz), by the companion matrix: by
/// frequency, then by growth.
pub fn eigenvalues(problem: &QuadraticProblem, end: f64) -> Vec<Complex64> {
    eigenvalues_of(problem.matrices.map(entries), end)
}

/// The same of dense matrices.
pub fn eigenvalues_of(Mck { m, c, k, g }: Mck<DMatrix<f64>>, end: f64) -> Vec<Complex64> {
    let (n, inverse) = (m.nrows(), m.try_inverse().unwrap());
    let mut companion = DMatrix::zeros(2 * n, 2 * n);
    companion.view_mut((0, n), (n, n)).fill_with_identity();
    companion.view_mut((n, 0), (n, n)).copy_from(&(-&inverse * k));
    companion.view_mut((n, n), (n, n)).copy_from(&(-&inverse * c));
    let all = match g {
        None => companion.complex_eigenvalues().as_slice().to_vec(),
        Some(g) => {
            let mut companion = companion.map(Complex64::from);
            let imaginary = (-inverse * g).map(|x| Complex64::new(0.0, x));
            companion.view_mut((n, 0), (n, n)).zip_apply(&imaginary, |z, x| *z += x);
            lapack::eigen(companion).unwrap().values
        }
    };
    let mut within: Vec<Complex64> = all.iter().copied().filter(|z| z.im >= 0.0 && z.norm() <= TAU * end).collect();
    within.sort_by(|a, b| (a.im, a.re).partial_cmp(&(b.im, b.re)).unwrap());
    within
}
