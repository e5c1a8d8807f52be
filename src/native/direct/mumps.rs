//! MUMPS through its own interface: matrices, right-hand sides and solutions distributed over the ranks, in double or
//! single precision.
//!
//! PETSc's interface to MUMPS knows no single precision, cannot pass an ordering on several ranks, and sorts the
//! numbers of all entries of all solutions with every call. Here the way of the solutions to their owners ([`Route`])
//! is planned once for a factor: on the full demo brake, two ranks, a right-hand side of 32 takes 0.056 s in place of
//! 0.102 s, in single precision 0.022 s. Single precision halves time and memory of an LU (7.8 s and 2.8 GB of 15.6 s
//! and 5.3 GB).

use squeal_sys as sys;

use super::mumps_data::{Data, Real, Run, both};
use super::route::Route;
use super::{FactorKind, ordering};
use crate::native::petsc::error::check;
use crate::native::petsc::{Int, int};
use crate::native::{Comm, Matrix};
use crate::{Error, Result};

/// In which numbers a factor is made and solves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 64 bits: solutions as exact as the matrix's condition lets them be.
    #[default]
    Double,
    /// 32 bits: half the memory and time; solutions to a few digits, for preconditioning.
    Single,
}

/// Jobs by MUMPS's numbers.
const START: i32 = -1;
const END: i32 = -2;
const ANALYSE: i32 = 1;
const FACTORISE: i32 = 2;
const SOLVE: i32 = 3;

/// Orderings by MUMPS's numbers: one that is given, and METIS's, which this MUMPS does not have.
const GIVEN: i32 = 1;
const METIS: i32 = 5;
/// Analysis by all ranks: MUMPS gathers no graph, and orders by PT-SCOTCH or ParMETIS.
const PARALLEL: i32 = 2;

/// Names of MUMPS's orderings by their numbers: those by the first rank, of which the one that is given is METIS's, and
/// those by all ranks.
const ORDERINGS: [&str; 8] = ["AMD", "METIS", "AMF", "SCOTCH", "PORD", "METIS", "QAMD", "automatic"];
const PARALLEL_ORDERINGS: [&str; 3] = ["automatic", "PT-SCOTCH", "ParMETIS"];

/// MUMPS's own name for the folder of factors that do not fit into memory.
const OUT_OF_CORE: &str = "MUMPS_OOC_TMPDIR";

/// How many parameters of either kind there are.
const N_ICNTL: i32 = 60;
const N_CNTL: i32 = 15;

/// One matrix's factors, from the analysis on.
pub(in crate::native) struct Mumps {
    data: Data,
    kind: FactorKind,
    /// Keeps MPI alive as long as the factors.
    comm: Comm,
    /// Global numbers of this rank's equations, from 1.
    equations: Vec<i32>,
    /// Global numbers of the unknowns that MUMPS has on this rank.
    unknowns: Vec<i32>,
    route: Option<Route>,
    /// What this rank's rows, and columns of the same numbers, are multiplied with before MUMPS sees them.
    equilibration: Vec<f64>,
}

impl Drop for Mumps {
    fn drop(&mut self) {
        self.run(END);
    }
}

impl Mumps {
    /// Without any matrix. Collective.
    ///
    /// # Errors
    /// PETSc's, where an option `-mat_mumps_icntl_N` or `-mat_mumps_cntl_N` is no number.
    pub fn new(comm: &Comm, kind: FactorKind, precision: Precision) -> Result<Mumps> {
        let data = match precision {
            Precision::Double => Data::Double(Box::default()),
            Precision::Single => Data::Single(Box::default()),
        };
        let mut new = Mumps {
            data,
            kind,
            comm: comm.clone(),
            equations: Vec::new(),
            unknowns: Vec::new(),
            route: None,
            equilibration: Vec::new(),
        };
        both!(&mut new.data, id => {
            // SAFETY: a valid communicator.
            id.comm_fortran = unsafe { sys::squeal_comm_fortran(comm.raw()) };
            id.par = 1;
            id.sym = if kind == FactorKind::Symmetric { 2 } else { 0 };
        });
        new.run(START);
        new.keep_factors_in(OUT_OF_CORE);
        // Silent, unless the user asks for more.
        (1..=3).for_each(|stream| new.set_icntl(stream, -1));
        new.set_icntl(4, 0);
        // Equilibrated before: MUMPS's own scaling iterates over all entries.
        new.set_icntl(8, 0);
        new.take_options()?;
        // Everything distributed: matrix, right-hand sides, solutions.
        for (number, value) in [(18, 3), (20, 10), (21, 1)] {
            new.set_icntl(number, value);
        }
        Ok(new)
    }

    /// Where MUMPS puts factors that do not fit into memory: where the environment says, else the system's temporary
    /// folder.
    fn keep_factors_in(&mut self, variable: &str) {
        if std::env::var_os(variable).is_none() {
            let folder = std::env::temp_dir();
            both!(&mut self.data, id => copy_text(folder.as_os_str().as_encoded_bytes(), &mut id.ooc_tmpdir));
        }
    }

    /// Takes what the user wants of MUMPS, by PETSc's names for it.
    fn take_options(&mut self) -> Result<()> {
        let found = |flag: sys::PetscBool| flag == sys::PetscBool::PETSC_TRUE;
        let none = std::ptr::null_mut();
        for number in 1..=N_ICNTL {
            let mut value: Int = 0;
            let (name, mut flag) = (option("icntl", number), sys::PetscBool::PETSC_FALSE);
            // SAFETY: PETSC reads the name, and writes value and flag.
            check(unsafe { sys::PetscOptionsGetInt(none, std::ptr::null(), name.as_ptr(), &mut value, &mut flag) })?;
            if found(flag) {
                self.set_icntl(number, value as i32);
            }
        }
        for number in 1..=N_CNTL {
            let (name, mut value, mut flag) = (option("cntl", number), 0.0, sys::PetscBool::PETSC_FALSE);
            // SAFETY: as above.
            check(unsafe { sys::PetscOptionsGetReal(none, std::ptr::null(), name.as_ptr(), &mut value, &mut flag) })?;
            if found(flag) {
                both!(&mut self.data, id => id.cntl[number as usize - 1] = Real::of(value));
            }
        }
        Ok(())
    }

    fn run(&mut self, job: i32) {
        both!(&mut self.data, id => id.run(job));
    }

    /// Sets a control parameter, numbered from 1.
    pub fn set_icntl(&mut self, number: i32, value: i32) {
        both!(&mut self.data, id => id.icntl[number as usize - 1] = value);
    }

    /// A global information number, numbered from 1; large counts, which MUMPS gives as negative millions, are turned
    /// into counts.
    pub fn infog(&self, number: i32) -> f64 {
        let value = both!(&self.data, id => id.infog[number as usize - 1]);
        let counts = [3, 20, 29].contains(&number);
        if counts && value < 0 { -1e6 * f64::from(value) } else { f64::from(value) }
    }

    /// Name of the ordering used.
    pub fn ordering(&self) -> &'static str {
        let names = if self.infog(32) == f64::from(PARALLEL) { &PARALLEL_ORDERINGS[..] } else { &ORDERINGS };
        names.get(self.infog(7) as usize).unwrap_or(&"?")
    }

    /// A global real information number, numbered from 1.
    #[allow(clippy::useless_conversion)] // single or double precision
    pub fn rinfog(&self, number: i32) -> f64 {
        both!(&self.data, id => id.rinfog[number as usize - 1].into())
    }

    /// What MUMPS says of its last job.
    ///
    /// # Errors
    /// [`Error::Singular`], [`Error::OutOfMemory`], [`Error::Mumps`].
    pub fn verdict(&self, phase: &'static str) -> Result<()> {
        let estimated_mb = self.infog(17);
        both!(&self.data, id => verdict(phase, id.infog[0], id.infog[1], estimated_mb))
    }

    /// Orders the equations and makes the symbolic factorisation. Collective.
    ///
    /// # Errors
    /// PETSc's; [`Mumps::verdict`] tells MUMPS's.
    pub fn analyse(&mut self, a: &Matrix) -> Result<()> {
        let first = a.first_row()?;
        self.equations = (0..a.n_local()).map(|i| (first + i) as i32 + 1).collect();
        let n = int("a matrix's rows", self.comm.sum(a.n_local()))?;
        let by_metis = both!(&self.data, id => id.icntl[6] == METIS && id.icntl[27] != PARALLEL);
        let mut places = if by_metis { ordering::nested_dissection(a)? } else { Vec::new() };
        both!(&mut self.data, id => {
            id.n = n;
            if by_metis {
                id.icntl[6] = GIVEN;
                id.perm_in = places.as_mut_ptr();
            }
        });
        self.with_entries(a, ANALYSE, &|_, _, value| value)?;
        both!(&mut self.data, id => id.perm_in = std::ptr::null_mut());
        Ok(())
    }

    /// Factorises a matrix of the pattern analysed: as `S A S`, `s_i = 1/sqrt(max_j |a_ij|)`, in which units and the
    /// materials' stiffness make no difference to pivots, and symmetry and inertia are A's. Collective.
    ///
    /// # Errors
    /// PETSc's; [`Mumps::verdict`] tells MUMPS's.
    pub fn factorise(&mut self, a: &Matrix) -> Result<()> {
        self.route = None;
        let (first, mut largest) = (a.first_row()?, vec![0.0_f64; a.n_local()]);
        a.visit_entries(|row, _, value| largest[row - first] = largest[row - first].max(value.abs()))?;
        let scale = |largest: f64| if largest > 0.0 { largest.sqrt().recip() } else { 1.0 };
        self.equilibration = largest.into_iter().map(scale).collect();
        let all = self.comm.join(&self.equilibration);
        self.with_entries(a, FACTORISE, &|row, column, value| all[row] * value * all[column])
    }

    /// Runs a job with the entries of this rank's rows, given by `entry` of row, column and value: the upper triangle
    /// for a symmetric factor.
    fn with_entries(&mut self, a: &Matrix, job: i32, entry: &dyn Fn(usize, usize, f64) -> f64) -> Result<()> {
        let upper = self.kind == FactorKind::Symmetric;
        let n = a.with_parts(|parts| parts.iter().map(|part| part.values.len()).sum::<usize>())?;
        let n = if upper { n / 2 + a.n_local() } else { n };
        both!(&mut self.data, id => {
            let (mut rows, mut columns) = (Vec::with_capacity(n), Vec::with_capacity(n));
            let mut values = Vec::with_capacity(n);
            a.visit_entries(|row, column, value| {
                if !upper || column >= row {
                    rows.push(row as i32 + 1);
                    columns.push(column as i32 + 1);
                    values.push(Real::of(entry(row, column, value)));
                }
            })?;
            id.nnz_loc = rows.len() as i64;
            id.irn_loc = rows.as_mut_ptr();
            id.jcn_loc = columns.as_mut_ptr();
            id.a_loc = values.as_mut_ptr();
            id.run(job);
            id.irn_loc = std::ptr::null_mut();
            id.jcn_loc = std::ptr::null_mut();
            id.a_loc = std::ptr::null_mut();
        });
        Ok(())
    }

    /// `X = A^-1 B`, or with the transpose of A; columns of this rank's rows one after the other. Collective.
    ///
    /// # Errors
    /// MUMPS's.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64], n_columns: usize, transposed: bool) -> Result<()> {
        let n = self.equations.len();
        let n_unknowns = both!(&self.data, id => id.info[22]) as usize;
        self.unknowns.resize(n_unknowns, 0);
        self.set_icntl(9, i32::from(!transposed));
        // Columns at a largest entry of 1: single precision reaches from 1e-38 to 1e38.
        let mut scales: Vec<f64> =
            (0..n_columns).map(|j| largest(&b[j * n..(j + 1) * n], &self.equilibration)).collect();
        self.comm.max_all(&mut scales);
        scales.iter_mut().filter(|scale| **scale == 0.0).for_each(|scale| *scale = 1.0);
        both!(&mut self.data, id => {
            let mut right = scaled(b, &scales, &self.equilibration);
            let mut solution = vec![Real::of(0.0); n_unknowns.max(1) * n_columns];
            id.nrhs = n_columns as i32;
            id.nloc_rhs = n as i32;
            id.lrhs_loc = n.max(1) as i32;
            id.irhs_loc = self.equations.as_mut_ptr();
            id.rhs_loc = right.as_mut_ptr();
            id.lsol_loc = n_unknowns.max(1) as i32;
            id.isol_loc = self.unknowns.as_mut_ptr();
            id.sol_loc = solution.as_mut_ptr();
            id.run(SOLVE);
            drop(right);
            verdict("solution", id.infog[0], id.infog[1], f64::from(id.infog[16]))?;
            if self.route.is_none() {
                let first = self.equations.first().map_or(0, |&equation| equation as usize - 1);
                self.route = Some(Route::new(&self.comm, &self.unknowns, first, n));
            }
            let route = self.route.as_ref().expect("made above");
            route.bring(&self.comm, &solution, n_unknowns, x, [&scales, &self.equilibration]);
        });
        Ok(())
    }
}

/// Copies a text, with a zero at its end, where it fits; else nothing, and MUMPS takes its own default.
fn copy_text(text: &[u8], field: &mut [std::ffi::c_char]) {
    if text.len() < field.len() {
        let with_end = text.iter().chain(&[0]);
        field.iter_mut().zip(with_end).for_each(|(to, &from)| *to = from as std::ffi::c_char);
    }
}

/// PETSc's name of an option of MUMPS.
fn option(kind: &str, number: i32) -> std::ffi::CString {
    std::ffi::CString::new(format!("-mat_mumps_{kind}_{number}")).expect("no zero in it")
}

/// Columns over their scales, times the rows' scales.
fn scaled<T: Real>(columns: &[f64], scales: &[f64], rows: &[f64]) -> Vec<T> {
    let (n, mut all) = (rows.len(), Vec::with_capacity(columns.len()));
    for (j, scale) in scales.iter().enumerate() {
        all.extend(columns[j * n..(j + 1) * n].iter().zip(rows).map(|(x, s)| T::of(x * s / scale)));
    }
    all
}

/// The largest modulus of a column times the rows' scales.
fn largest(column: &[f64], rows: &[f64]) -> f64 {
    column.iter().zip(rows).fold(0.0, |largest, (x, s)| (x * s).abs().max(largest))
}

/// From MUMPS's codes to errors. `estimated_mb`: what the analysis has estimated, zero before it.
fn verdict(phase: &'static str, code: i32, detail: i32, estimated_mb: f64) -> Result<()> {
    let codes = || format!("MUMPS's {phase}, INFOG(1) = {code}, INFOG(2) = {detail}");
    match code {
        0.. => Ok(()),
        -5 | -7 | -13 => {
            let needed_mb = Some(estimated_mb).filter(|mb| *mb > 0.0);
            let needs = needed_mb.map_or(String::new(), |mb| format!("; the factor needs about {:.2} GB", mb / 1024.0));
            Err(Error::OutOfMemory { what: codes() + &needs, needed_mb })
        }
        -6 | -10 => Err(Error::Singular { found_by: codes() }),
        _ => Err(Error::Mumps { phase, code, detail }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ErrorKind;

    #[test]
    fn codes_become_kinds() {
        let of = |code| verdict("factorisation", code, 7, 512.0).map_err(|error| error.kind());
        assert_eq!((of(0), of(2)), (Ok(()), Ok(())));
        for (codes, kind) in [
            (&[-6, -10][..], ErrorKind::Singular),
            (&[-5, -7, -13], ErrorKind::OutOfMemory),
            (&[-9, -16, -53], ErrorKind::Library),
        ] {
            assert!(codes.iter().all(|&code| of(code) == Err(kind)), "{kind:?}");
        }
        let short = verdict("factorisation", -13, 7, 512.0).unwrap_err().to_string();
        assert!(short.contains("needs about 0.50 GB"), "{short}");
        assert!(!verdict("analysis", -7, 7, 0.0).unwrap_err().to_string().contains("needs about"));
    }

    #[test]
    fn a_folder_that_does_not_fit_leaves_mumps_its_default() {
        let mut field = [1 as std::ffi::c_char; 5];
        copy_text(b"/tmp", &mut field);
        assert_eq!(field.map(|c| c as u8), *b"/tmp\0");
        let mut field = [1 as std::ffi::c_char; 4];
        copy_text(b"/tmp", &mut field);
        assert_eq!(field, [1; 4]);
    }
}
