//! Krylov solution of a linear system whose factor is that of a neighbouring matrix, by PETSc KSP.

use std::ffi::c_void;
use std::ptr;

use squeal_sys as sys;

use super::error::{Trap, check};
use super::vector::Borrowed;
use super::{Int, Matrix, Vector};
use crate::Result;
use crate::native::Comm;

/// `x = M^-1 b` for a neighbour M of the matrix.
pub type Inverse<'a> = &'a mut dyn FnMut(&Vector, &mut Vector) -> Result<()>;

struct Context<'a> {
    inverse: Inverse<'a>,
    comm: Comm,
    trap: Trap,
}

/// Owns a KSP for the length of a solve.
struct Ksp(sys::KSP);

impl Drop for Ksp {
    fn drop(&mut self) {
        // SAFETY: this handle owns the solver and the session is alive.
        unsafe { sys::KSPDestroy(&mut self.0) };
    }
}

/// Solves `A x = b` by GMRES, right-preconditioned with the factor of a neighbour of A, from `x = 0` to a relative
/// residual of `tolerance`. Gives the number of iterations, or none where `max_iterations` did not do. Collective.
///
/// # Errors
/// PETSc's and MUMPS's.
pub fn gmres(
    a: &Matrix,
    neighbour: Inverse,
    b: &Vector,
    x: &mut Vector,
    tolerance: f64,
    max_iterations: usize,
) -> Result<Option<usize>> {
    let comm = b.comm().clone();
    let mut context = Context { inverse: neighbour, comm: comm.clone(), trap: Trap::default() };
    let pointer = ptr::from_mut(&mut context).cast::<c_void>();
    let mut ksp = Ksp(ptr::null_mut());
    let (most, keep) = (max_iterations as Int, super::DEFAULT as f64);
    let (mut reason, mut iterations) = (sys::KSPConvergedReason(0), 0);
    // SAFETY: `context` outlives the solver, and is reached through `pointer` only while KSPSolve runs.
    unsafe {
        let mut pc = ptr::null_mut();
        check(sys::KSPCreate(comm.raw(), &mut ksp.0))?;
        check(sys::KSPSetOperators(ksp.0, a.raw(), a.raw()))?;
        check(sys::KSPSetType(ksp.0, c"gmres".as_ptr()))?;
        check(sys::KSPGMRESSetRestart(ksp.0, most))?;
        check(sys::KSPSetPCSide(ksp.0, sys::PCSide::PC_RIGHT))?;
        check(sys::KSPSetTolerances(ksp.0, tolerance, 0.0, keep, most))?;
        check(sys::KSPGetPC(ksp.0, &mut pc))?;
        check(sys::PCSetType(pc, c"shell".as_ptr()))?;
        check(sys::PCShellSetContext(pc, pointer))?;
        check(sys::PCShellSetApply(pc, Some(apply)))?;
        let code = sys::KSPSolve(ksp.0, b.raw(), x.raw());
        (*pointer.cast::<Context>()).trap.release(code)?;
        check(sys::KSPGetConvergedReason(ksp.0, &mut reason))?;
        check(sys::KSPGetIterationNumber(ksp.0, &mut iterations))?;
    }
    Ok((reason.0 > 0).then_some(iterations as usize))
}

unsafe extern "C" fn apply(pc: sys::PC, b: sys::Vec, x: sys::Vec) -> sys::PetscErrorCode {
    let mut pointer: *mut c_void = ptr::null_mut();
    // SAFETY: the shell is alive.
    let code = unsafe { sys::PCShellGetContext(pc, ptr::from_mut(&mut pointer).cast()) };
    if code != 0 {
        return code;
    }
    // SAFETY: the context is the one that `gmres` set; KSP runs its callbacks one at a time.
    let context = unsafe { &mut *pointer.cast::<Context>() };
    let (inverse, comm) = (&mut context.inverse, &context.comm);
    context.trap.guard(c"solve", || inverse(&*Borrowed::new(b, comm)?, Borrowed::new(x, comm)?.get_mut()))
}
