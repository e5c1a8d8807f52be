//! Craig-Bampton reduction of a structure with sliding contacts.
//!
//! Without its sliding contacts, and with all others linearised about an equilibrium (closed points stick), the
//! structure is linear:
//!
//! ```text
//! K = K_elements + sum_other B_a^T D_a B_a          F = F_ext + sum_other B_a^T (f_a + D_a g_a)
//! ```
//!
//! Retained are the linear functionals `q_b = B u` of [`retained`]. Constraint modes and fixed-interface modes span the
//! displacements,
//!
//! ```text
//! u = Psi q_b + Phi q_m        B Psi = I,  K Psi = B^T L        K Phi = M Phi omega^2 + B^T N,  B Phi = 0
//! ```
//!
//! Both come from one symmetric factor, of `K_s = K + B^T diag(k) B` with the contacts' own stiffness for k: for any k
//!
//! ```text
//! Psi = K_s^-1 B^T S^-1,  S = B K_s^-1 B^T          A r = (I - Psi B) K_s^-1 r       solves K u + B^T n = r,  B u = 0
//! ```
//!
//! so that no stiff spring enters, and no second factor. Static forces on the retained coordinates are answered
//! exactly.
//!
//! What the modes left out would answer to the inertia of the constraint modes is, to first order in
//! `(omega/omega_limit)^2`, what they answer statically. So the basis gets the static answer to the inertia of those
//! motions `Psi Y` that matter, the modes Y of the reduced brake up to somewhat above half the limit: the *inertia
//! modes* `E = A M Psi Y`, one for each. They take the error of a frequency at half the limit from some 1e-3 to some
//! 1e-5.
//!
//! Viscoelastic materials have their stiffness at a reference frequency in `K_s`, that at rest in the reduced
//! stiffness, and a reduced stiffness `T^T K_m T` for each law. What the interior does as the stiffness changes is to
//! first order `A K_m T Y`, one for each law and each of these modes; and the equilibrium, at rest, adds `(I - Psi B)
//! u`. Both join the basis.
//!
//! Sources: R. R. Craig, M. C. C. Bampton, *Coupling of substructures for dynamic analyses*, AIAA Journal 6 (1968), eq.
//! 5-14; J.-G. Kim, P.-S. Lee, *An enhanced Craig-Bampton method*, Int. J. Numer. Meth. Engng 103 (2015) (the residual
//! term; here as vectors of the basis).

use std::f64::consts::TAU;
use std::time::Instant;

use nalgebra::DMatrix;
use serde::Serialize;

use crate::assembly::System;
use crate::contact::{GapOperator, Interface};
use crate::equilibrium::Equilibrium;
use crate::native::{Block, Factor, FactorKind, FactorStats, Mck, Noise, lapack};
use crate::stability::Viscoelastic;
use crate::{Error, Result};

use super::fixed_interface::{self, Modes};
use super::functionals::{Functionals, retained};
use super::linear::Linear;
use super::part_samples::{Nominal, PartSamples, SampleReport};
use super::projection::{PANEL, Projected, ProjectedLoad, shadow};
use super::super_element::ViscoelasticTerm;

/// Motions up to this part of the limit get residual modes: half of it, up to which a super-element is meant to be
/// used, and a margin, as the brake without residual modes is too stiff.
const REACH: f64 = 0.6;

/// Residual modes that add less than this part of themselves are left out.
const NEGLIGIBLE_ADDITION: f64 = 1e-6;

/// A structure to be reduced.
pub struct Structure<'a> {
    /// M, C, K and the load.
    pub system: &'a System,
    /// Its contacts.
    pub interface: &'a Interface,
    /// The equilibrium about which all contacts but the sliding ones are linearised.
    pub equilibrium: &'a Equilibrium,
    /// Lists of nodes whose mean motions are retained.
    pub loaded: &'a [Vec<u32>],
    /// Frequency at which the basis has the stiffness of viscoelastic materials, rad/s.
    pub reference: f64,
}

impl Structure<'_> {
    /// What of the stiffness depends on the frequency.
    pub(super) fn viscoelastic(&self) -> Viscoelastic<'_> {
        Viscoelastic { stiffnesses: &self.system.viscoelastic, reference: self.reference }
    }
}

/// What a reduction is doing.
#[derive(Debug, Clone, Copy)]
pub enum Event {
    /// Factorises the structure's stiffness.
    Factor,
    /// So many constraint modes of so many are done.
    Constraint(usize, usize),
    /// The search space of the fixed-interface modes has so many vectors.
    Fixed(usize),
    /// So many samples of other moduli and densities of so many are done.
    Sample(usize, usize),
    /// Projects the matrices.
    Project,
}

/// What a reduction has cost.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Costs {
    /// The one factor.
    #[serde(skip)]
    pub factor: FactorStats,
    /// Constraint modes, s.
    pub constraint_seconds: f64,
    /// Fixed-interface modes, s.
    #[serde(rename = "fixed_interface_seconds")]
    pub fixed_seconds: f64,
    /// Their solves.
    #[serde(rename = "fixed_interface_solves")]
    pub n_solves: usize,
    /// Residual modes and projection of M, C and K, s.
    pub projection_seconds: f64,
    /// Samples of other moduli and densities, s.
    pub sample_seconds: f64,
}

/// The reduced structure. Coordinates: three for each retained point, then one for each fixed-interface mode and each
/// residual mode.
pub struct Reduced {
    /// The retained points, as a gap operator.
    pub retained: GapOperator,
    /// The contact points that they belong to.
    pub contacts: Vec<usize>,
    /// Frequencies of the fixed-interface modes, Hz.
    pub frequencies: Vec<f64>,
    /// The basis `[Psi Phi E]`.
    pub basis: Block,
    /// `T^T M T`, `T^T C T`, `T^T K T` and `T^T G T`, K without the sliding contacts.
    pub matrices: Mck<DMatrix<f64>>,
    /// `T^T K_m T` at rest of each viscoelastic law, part of the stiffness.
    pub viscoelastic: Vec<ViscoelasticTerm>,
    /// `T^T F_ext` without the constant part, N.
    pub load: Vec<f64>,
    /// `T^T` times what the other contacts' forces are beside their linear part and the constant part of `F_ext`, N.
    pub preload: Vec<f64>,
    /// What samples of other moduli and densities found.
    pub samples: SampleReport,
    /// What it cost.
    pub costs: Costs,
}

/// Reduces a structure to its sliding contacts and its fixed-interface modes below `limit` (Hz, may be infinite).
/// Collective.
///
/// ```no_run
/// use squeal::Session;
/// use squeal::equilibrium::Path;
/// use squeal::reduction::craig_bampton::{Structure, reduce};
/// use squeal::structure::FullModel;
///
/// let comm = Session::start(&[])?;
/// let brake = FullModel::read_with_contacts(&comm, "brake.toml".as_ref(), Some(104))?;
/// let (system, interface) = (brake.assemble(&comm, &brake.families()?)?, &brake.interface);
/// let equilibrium = Path::new(&system, interface)?.advance(0.4, &mut |_, _, _| ())?;
/// let structure = Structure { system: &system, interface, equilibrium: &equilibrium, loaded: &[], reference: 0.0 };
/// let reduced = reduce(&structure, 12e3, &mut |_| ())?;
/// println!("{} coordinates", reduced.load.len());
/// # Ok::<(), squeal::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] where nothing slides or retained points are not independent; [`Error::NotConverged`]; PETSc's and
/// MUMPS's.
pub fn reduce(structure: &Structure, limit: f64, progress: &mut dyn FnMut(Event)) -> Result<Reduced> {
    reduce_for(structure, limit, &PartSamples::none(), progress)
}

/// As [`reduce`], in a basis that holds at other moduli and densities of the parts as well. Collective.
///
/// # Errors
/// Those of [`reduce`] and of the samples.
pub fn reduce_for(
    structure: &Structure,
    limit: f64,
    samples: &PartSamples,
    progress: &mut dyn FnMut(Event),
) -> Result<Reduced> {
    let system = structure.system;
    let (retained, contacts) = retained(structure.interface, structure.loaded);
    let functionals = &Functionals::new(&retained, system);
    let linear = &Linear::new(structure, &retained, &contacts)?;

    progress(Event::Factor);
    let mut factor = Factor::new(FactorKind::Symmetric);
    factor.factorise(&linear.supported)?;
    let mut costs = Costs { factor: factor.stats(), ..Costs::default() };
    let interior = Interior { functionals, factor: &factor, system };

    let start = Instant::now();
    let mut basis = interior.constraint_modes(progress)?;
    costs.constraint_seconds = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let modes = interior.modes(&basis, limit, progress)?;
    basis.append(&modes.shapes);
    (costs.fixed_seconds, costs.n_solves) = (start.elapsed().as_secs_f64(), modes.n_solves);

    progress(Event::Project);
    let start = Instant::now();
    let coarse = interior.add_answers(&mut basis, &modes, linear, (structure, limit))?;
    costs.projection_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let Modes { frequencies, shapes, .. } = modes;
    drop((factor, shapes)); // samples have factors of their own
    let nominal = Nominal { structure, functionals, linear, points: &retained, contacts: &contacts, limit };
    let samples = nominal.extend(&mut basis, samples, progress)?;
    costs.sample_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let projected = coarse.extended(&basis, system, linear)?;
    let viscoelastic = projected.viscoelastic_terms(system);
    let matrices = projected.matrices(&basis, system)?;
    costs.projection_seconds += start.elapsed().as_secs_f64();
    let ProjectedLoad { variable: load, constant } = ProjectedLoad::new(&basis, system)?;
    let preload = shadow(&basis, &linear.preload)?.iter().zip(constant).map(|(own, constant)| own + constant).collect();
    Ok(Reduced { retained, contacts, frequencies, basis, matrices, viscoelastic, load, preload, samples, costs })
}

/// The static problem with all retained points held.
struct Interior<'a> {
    functionals: &'a Functionals,
    factor: &'a Factor,
    system: &'a System,
}

impl Interior<'_> {
    /// `Psi = K_s^-1 B^T S^-1`
    fn constraint_modes(&self, progress: &mut dyn FnMut(Event)) -> Result<Block> {
        let n = self.functionals.len();
        let mut psi = Block::zeros(self.system.k.comm(), self.system.dofs.n_local(), n);
        let mut s = Vec::with_capacity(n * n);
        for first in (0..n).step_by(PANEL) {
            progress(Event::Constraint(first, n));
            let columns = self.functionals.transposed(first..(first + PANEL).min(n)).solved_by(self.factor)?;
            s.extend(self.functionals.apply(&columns));
            psi.set_columns(first, &columns);
        }
        psi.transform(&inverse(DMatrix::from_vec(n, n, s))?);
        Ok(psi)
    }

    /// `A r = (I - Psi B) K_s^-1 r`
    fn answer(&self, basis: &Block, r: &Block) -> Result<Block> {
        let mut u = r.solved_by(self.factor)?;
        self.functionals.hold(basis, &mut u);
        Ok(u)
    }

    /// Number of displacements that are free while the retained points are held.
    fn n_dimensions(&self) -> usize {
        self.system.dofs.n_global() - self.functionals.rank()
    }

    fn modes(&self, psi: &Block, limit: f64, progress: &mut dyn FnMut(Event)) -> Result<Modes> {
        let (n, mass) = (self.n_dimensions(), &self.system.m);
        let start = arbitrary(self.system, n.min(fixed_interface::WIDTH));
        let mut invert = |r: &Block| self.answer(psi, r);
        let mut modes =
            fixed_interface::below(limit, n, mass, &start, &mut invert, &mut |size| progress(Event::Fixed(size)))?;
        // Orthogonalisation has magnified what rounding left of B Phi.
        self.functionals.hold(psi, &mut modes.shapes);
        Ok(modes)
    }

    /// Adds residual modes and the answers of viscoelastic materials to a basis, which was projected without them.
    fn add_answers(
        &self,
        basis: &mut Block,
        modes: &Modes,
        linear: &Linear,
        (structure, limit): (&Structure, f64),
    ) -> Result<Projected> {
        let coarse = Projected::default().extended(basis, self.system, linear)?;
        let at_reference = coarse.stiffness_at_reference(&structure.viscoelastic());
        let (motions, _) = motions(&coarse.mass, &at_reference, &linear.contacts, REACH * limit)?;
        let residual = self.residual_modes(basis, &motions, modes)?;
        let answers = self.viscoelastic_answers(basis, &motions, [&modes.shapes, &residual], structure)?;
        basis.append(&residual);
        basis.append(&answers);
        Ok(coarse)
    }

    /// What the interior does under the inertia of some motions `Psi Y`, beside the modes: `A M Psi Y`, M-orthonormal.
    /// It has as many vectors as there is room for.
    fn residual_modes(&self, psi: &Block, motions: &DMatrix<f64>, modes: &Modes) -> Result<Block> {
        if motions.ncols() == 0 {
            return Ok(psi.columns(0..0));
        }
        let retained = motions.rows(0, self.functionals.len()).into_owned();
        let moved = psi.leading_combined(self.functionals.len(), retained.as_slice(), motions.ncols());
        let mut answer = self.answer(psi, &moved.multiplied_by(&self.system.m)?)?;
        let room = self.n_dimensions() - modes.frequencies.len();
        fixed_interface::make_orthonormal(&modes.shapes, &mut answer, &self.system.m, NEGLIGIBLE_ADDITION, room)?;
        self.functionals.hold(psi, &mut answer);
        Ok(answer)
    }

    /// What the interior does as the stiffness of viscoelastic materials changes in some motions, `A K_m T Y`, and in
    /// the equilibrium, beside what is `known` of it: M-orthonormal. None where no material is viscoelastic.
    fn viscoelastic_answers(
        &self,
        basis: &Block,
        motions: &DMatrix<f64>,
        known: [&Block; 2],
        structure: &Structure,
    ) -> Result<Block> {
        let (laws, u) = (&self.system.viscoelastic, &structure.equilibrium.u);
        if laws.is_empty() {
            return Ok(basis.columns(0..0));
        }
        let mut answers = Block::from_columns(u.comm(), u.n_local(), u.to_vec()?);
        self.functionals.hold(basis, &mut answers);
        let moved = basis.combined(motions.as_slice(), motions.ncols());
        for own in laws {
            answers.append(&self.answer(basis, &moved.multiplied_by(&own.stiffness)?)?);
        }
        let mut all = known[0].clone();
        all.append(known[1]);
        let room = self.n_dimensions() - all.n_columns();
        fixed_interface::make_orthonormal(&all, &mut answers, &self.system.m, NEGLIGIBLE_ADDITION, room)?;
        self.functionals.hold(basis, &mut answers);
        Ok(answers)
    }
}

/// The inverse of `S = B K_s^-1 B^T`, column-major.
///
/// A functional of held displacements alone is zero: its row gets a 1, which makes its constraint mode zero.
fn inverse(s: DMatrix<f64>) -> Result<Vec<f64>> {
    let mut symmetric = 0.5 * (&s + s.transpose());
    (0..s.nrows()).filter(|&i| s[(i, i)] == 0.0).for_each(|i| symmetric[(i, i)] = 1.0);
    let factor = symmetric.cholesky().ok_or_else(|| {
        Error::input(
            "the retained points of the reduction are not independent: two loads act on the same nodes, or a part is unconstrained. \
             `squeal check` shows loads and free parts",
        )
    })?;
    Ok(factor.inverse().as_slice().to_vec())
}

/// Vectors without any order, the same on any number of ranks.
fn arbitrary(system: &System, n_columns: usize) -> Block {
    let (mut block, labels) = (Block::zeros(system.k.comm(), system.dofs.n_local(), n_columns), system.dofs.labels());
    let mut noise = Noise::new(&labels);
    (0..n_columns).for_each(|j| noise.fill(block.column_mut(j)));
    block
}

/// How the retained points move in the modes below `limit` (Hz) of the brake reduced so far, its contacts closed as at
/// the equilibrium and without friction: a column of coordinates each, of unit modal mass, and the squares of their
/// angular frequencies.
pub(super) fn motions(
    mass: &DMatrix<f64>,
    stiffness: &DMatrix<f64>,
    contacts: &[[[f64; 3]; 3]],
    limit: f64,
) -> Result<(DMatrix<f64>, Vec<f64>)> {
    let mut k = stiffness.clone();
    for (c, d) in contacts.iter().enumerate() {
        let (slave, master) = (3 * c, 3 * (contacts.len() + c));
        for (row, column, sign) in
            [(slave, slave, 1.0), (slave, master, -1.0), (master, slave, -1.0), (master, master, 1.0)]
        {
            (0..9).for_each(|e| k[(row + e / 3, column + e % 3)] += sign * d[e / 3][e % 3]);
        }
    }
    // Coordinates that cannot move have no mass.
    let live: Vec<usize> = (0..mass.nrows()).filter(|&i| mass[(i, i)] > 0.0).collect();
    let [m, k] = [mass, &k].map(|a| a.select_rows(&live).select_columns(&live));
    // M = L L^T,  L^-1 K L^-T y = omega^2 y,  x = L^-T y
    let l = m.cholesky().ok_or_else(|| Error::Singular { found_by: "Cholesky of the reduced mass".into() })?.unpack();
    let half = l.solve_lower_triangular(&k).expect("the diagonal of L is positive");
    let mut y = l.solve_lower_triangular(&half.transpose()).expect("the diagonal of L is positive");
    let squares = lapack::symmetric_eigen(live.len(), y.as_mut_slice())?;
    let n_below = squares.iter().filter(|&&square| square < (TAU * limit).powi(2)).count();
    let x = l.tr_solve_lower_triangular(&y.columns(0, n_below)).expect("the diagonal of L is positive");
    let mut motions = DMatrix::zeros(mass.nrows(), n_below);
    live.iter().enumerate().for_each(|(row, &i)| motions.row_mut(i).copy_from(&x.row(row)));
    Ok((motions, squares[..n_below].to_vec()))
}
