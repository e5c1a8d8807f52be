//! Quadratic eigenproblems by SLEPc PEP with an inverse of ours inside.

use std::ffi::c_void;
use std::ptr;

use num_complex::Complex64;
use squeal_sys as sys;

use super::error::{Trap, check};
use super::vector::Borrowed;
use super::{Int, Matrix, PETSC_ERR_LIB, Vector};
use crate::native::{Comm, Mck};
use crate::{Error, Result};

/// `x = P(sigma)^-1 b`.
pub type Inverse<'a> = dyn Fn(&Vector, &mut Vector) -> Result<()> + 'a;

/// The polynomial `lambda^2 M + lambda C + K` and its inverse at a real shift.
pub struct Quadratic<'a> {
    /// M, C and K.
    pub matrices: Mck<&'a Matrix>,
    /// The real shift sigma.
    pub shift: f64,
    /// Of `sigma^2 M + sigma C + K`.
    pub inverse: &'a Inverse<'a>,
}

/// How the eigensolver is to run.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Eigenvalues wanted, those nearest to the shift (conjugates count separately).
    pub n_wanted: usize,
    /// Dimension of the search space (0: SLEPc's choice).
    pub n_basis: usize,
    /// Relative residual at which an eigenpair counts as converged.
    pub tolerance: f64,
    /// Restarts at most.
    pub max_restarts: usize,
    /// Angular frequency that counts as 1, 1/s (0: SLEPc's choice).
    pub scale: f64,
}

/// One eigenvalue with non-negative imaginary part, and its vector.
pub struct Pair {
    /// The eigenvalue, 1/s.
    pub lambda: Complex64,
    /// Real part of the vector.
    pub re: Vector,
    /// Imaginary part of the vector.
    pub im: Vector,
}

struct Context<'a> {
    inverse: &'a Inverse<'a>,
    comm: Comm,
    n_solves: usize,
    progress: &'a mut dyn FnMut(usize, usize),
    trap: Trap,
}

/// Owns a PEP for the length of a solve.
struct Pep(sys::PEP);

impl Drop for Pep {
    fn drop(&mut self) {
        // SAFETY: this handle owns the solver and the session is alive.
        unsafe { sys::PEPDestroy(&mut self.0) };
    }
}

/// What the solver found.
pub struct Found {
    /// The eigenpairs of the closed upper half plane, nearest to the shift first.
    pub pairs: Vec<Pair>,
    /// Number of eigenvalues that converged, conjugates counted.
    pub n_converged: usize,
    /// Applications of the inverse.
    pub n_solves: usize,
}

/// Eigenpairs nearest to the shift by TOAR (two-level orthogonal Arnoldi) on the inverted problem. `progress` hears of
/// (converged, solves). Options of the prefix `stability_` act (`-stability_pep_view`). None where LAPACK could not
/// reorder the projected problem (xTREXC, info 1: blocks too close to swap, as the defective zeros of several rigid
/// motions are): another search space does not meet the same blocks. Collective.
///
/// # Errors
/// PETSc's.
///
/// # Panics
/// Where `progress` panicked.
pub fn solve(problem: &Quadratic, options: &Options, progress: &mut dyn FnMut(usize, usize)) -> Result<Option<Found>> {
    let Mck { m, c, k, .. } = problem.matrices;
    let comm = k.comm().clone();
    let mut context =
        Context { inverse: problem.inverse, comm: comm.clone(), n_solves: 0, progress, trap: Trap::default() };
    let pointer = ptr::from_mut(&mut context).cast::<c_void>();
    let mut pep = Pep(ptr::null_mut());
    // SAFETY: `context` outlives the solver, and is reached through `pointer` only while PEPSolve runs.
    unsafe {
        check(sys::PEPCreate(comm.raw(), &mut pep.0))?;
        check(sys::PEPSetOptionsPrefix(pep.0, c"stability_".as_ptr()))?;
        let mut operators = [k.raw(), c.raw(), m.raw()];
        check(sys::PEPSetOperators(pep.0, 3, operators.as_mut_ptr()))?;
        configure(pep.0, problem.shift, options)?;
        use_inverse(pep.0, problem.shift, pointer)?;
        check(sys::PEPMonitorSet(pep.0, Some(monitor), pointer, None))?;
        check(sys::PEPSetFromOptions(pep.0))?;
        let code = sys::PEPSolve(pep.0);
        match (*pointer.cast::<Context>()).trap.release(code) {
            Err(error) if is_of_reordering(&error) => return Ok(None),
            outcome => outcome?,
        }
    }
    let n_solves = context.n_solves;
    collect(&pep, &comm, k.n_local(), n_solves).map(Some)
}

/// Functions of SLEPc that call xTREXC and no other routine of LAPACK.
const REORDERING: [&str; 2] = ["DSSort_NHEP_Total", "DSSortWithPermutation_NHEP_Private"];

/// Whether LAPACK, called to reorder a Schur form, is where an error comes from.
fn is_of_reordering(error: &Error) -> bool {
    let Error::Petsc { code: PETSC_ERR_LIB, frames, .. } = error else { return false };
    frames.first().is_some_and(|frame| REORDERING.contains(&frame.function.as_str()))
}

unsafe fn configure(pep: sys::PEP, shift: f64, options: &Options) -> Result<()> {
    let or_default = |n: usize| if n == 0 { super::DETERMINE } else { n as Int };
    let (wanted, basis) = (options.n_wanted as Int, or_default(options.n_basis));
    let (decide, none) = (super::DETERMINE, ptr::null_mut());
    // SAFETY: the solver is alive; the strings are static.
    unsafe {
        check(sys::PEPSetType(pep, c"toar".as_ptr()))?;
        check(sys::PEPSetProblemType(pep, sys::PEPProblemType::PEP_GENERAL))?;
        check(sys::PEPSetTarget(pep, shift))?;
        check(sys::PEPSetWhichEigenpairs(pep, sys::PEPWhich::PEP_TARGET_MAGNITUDE))?;
        check(sys::PEPSetDimensions(pep, wanted, basis, decide))?;
        check(sys::PEPSetTolerances(pep, options.tolerance, options.max_restarts as Int))?;
        check(sys::PEPSetScale(
            pep,
            sys::PEPScale::PEP_SCALE_SCALAR,
            if options.scale == 0.0 { decide as f64 } else { options.scale },
            none,
            none,
            decide,
            decide as f64,
        ))
    }
}

/// The spectral transformation inverts with ours.
unsafe fn use_inverse(pep: sys::PEP, shift: f64, context: *mut c_void) -> Result<()> {
    let (mut st, mut ksp, mut pc) = (ptr::null_mut(), ptr::null_mut(), ptr::null_mut());
    // SAFETY: the solver is alive; the strings are static.
    unsafe {
        check(sys::PEPGetST(pep, &mut st))?;
        check(sys::STSetType(st, c"sinvert".as_ptr()))?;
        check(sys::STSetShift(st, shift))?;
        check(sys::STGetKSP(st, &mut ksp))?;
        check(sys::KSPSetType(ksp, c"preonly".as_ptr()))?;
        check(sys::KSPGetPC(ksp, &mut pc))?;
        check(sys::PCSetType(pc, c"shell".as_ptr()))?;
        check(sys::PCShellSetContext(pc, context))?;
        check(sys::PCShellSetApply(pc, Some(apply)))
    }
}

unsafe extern "C" fn apply(pc: sys::PC, b: sys::Vec, x: sys::Vec) -> sys::PetscErrorCode {
    let mut pointer: *mut c_void = ptr::null_mut();
    // SAFETY: the shell is alive.
    let code = unsafe { sys::PCShellGetContext(pc, ptr::from_mut(&mut pointer).cast()) };
    if code != 0 {
        return code;
    }
    // SAFETY: the context is the one that `use_inverse` set; PEP runs its callbacks one at a time.
    let context = unsafe { &mut *pointer.cast::<Context>() };
    context.n_solves += 1;
    let (inverse, comm) = (context.inverse, &context.comm);
    context.trap.guard(c"solve", || inverse(&*Borrowed::new(b, comm)?, Borrowed::new(x, comm)?.get_mut()))
}

unsafe extern "C" fn monitor(
    _: sys::PEP,
    _restart: sys::PetscInt,
    n_converged: sys::PetscInt,
    _re: *mut f64,
    _im: *mut f64,
    _errors: *mut f64,
    _n: sys::PetscInt,
    pointer: *mut c_void,
) -> sys::PetscErrorCode {
    // SAFETY: the pointer is the one that `solve` registered.
    let context = unsafe { &mut *pointer.cast::<Context>() };
    let (progress, n_solves) = (&mut *context.progress, context.n_solves);
    context.trap.guard(c"progress", || {
        progress(n_converged as usize, n_solves);
        Ok(())
    })
}

/// Real eigenpairs of PETSc's real arithmetic, translated once: conjugates come as neighbours, the first is kept.
fn collect(pep: &Pep, comm: &Comm, n_local: usize, n_solves: usize) -> Result<Found> {
    let mut n_converged = 0;
    // SAFETY: the solver is alive.
    check(unsafe { sys::PEPGetConverged(pep.0, &mut n_converged) })?;
    let mut pairs = Vec::new();
    for i in 0..n_converged {
        let (re, im) = (Vector::zeros(comm, n_local)?, Vector::zeros(comm, n_local)?);
        let (mut a, mut omega) = (0.0, 0.0);
        // SAFETY: the vectors are alive and of the problem's size.
        check(unsafe { sys::PEPGetEigenpair(pep.0, i, &mut a, &mut omega, re.raw(), im.raw()) })?;
        if omega >= 0.0 {
            pairs.push(Pair { lambda: Complex64::new(a, omega), re, im });
        }
    }
    Ok(Found { pairs, n_converged: n_converged as usize, n_solves })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Frame;

    #[test]
    fn only_a_schur_form_that_cannot_be_reordered_is_given_up() {
        let error = |code: i32, function: &str| {
            let frame = |function: &str| Frame { function: function.into(), file: "dsnhep.c".into(), line: 1 };
            Error::Petsc { code, message: String::new(), frames: vec![frame(function), frame("DSSort")] }
        };
        assert!(is_of_reordering(&error(PETSC_ERR_LIB, "DSSort_NHEP_Total")));
        assert!(!is_of_reordering(&error(PETSC_ERR_LIB, "DSSolve_NHEP_Private")));
        assert!(!is_of_reordering(&error(62, "DSSort_NHEP_Total")));
        assert!(!is_of_reordering(&Error::not_converged("DSSort_NHEP_Total")));
    }
}
