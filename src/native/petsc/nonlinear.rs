//! Newton's method with a line search, by PETSc SNES.

use std::ffi::{CStr, c_void};
use std::ptr;

use squeal_sys as sys;

use super::error::{Trap, check};
use super::line_search;
use super::vector::Borrowed;
use super::{Int, Matrix, Vector};
use crate::Result;
use crate::native::Comm;

/// What SNES asks of a problem `F(u) = 0`.
pub trait Problem {
    /// `r = F(u)`.
    ///
    /// # Errors
    /// Whatever makes the evaluation impossible; it comes out of [`solve`].
    fn residual(&mut self, u: &Vector, r: &mut Vector) -> Result<()>;

    /// Makes the tangent at `u` current in [`Problem::jacobian`], and whatever [`Problem::correct`] needs.
    ///
    /// # Errors
    /// Whatever makes the evaluation impossible; it comes out of [`solve`].
    fn linearise(&mut self, u: &Vector) -> Result<()>;

    /// The tangent matrix; always the same object.
    fn jacobian(&self) -> &Matrix;

    /// `du = J^-1 r`.
    ///
    /// # Errors
    /// Whatever makes the solution impossible; it comes out of [`solve`].
    fn correct(&mut self, r: &Vector, du: &mut Vector) -> Result<()>;

    /// Looks at an iterate (Euclidean norms of the residual and of the last step) and decides.
    fn judge(&mut self, iteration: usize, residual: f64, step: f64) -> Verdict;
}

/// Whether to go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Another step.
    Continue,
    /// Done.
    Converged,
    /// Given up.
    Diverged,
}

struct Context<'a> {
    problem: &'a mut dyn Problem,
    comm: Comm,
    trap: Trap,
    /// What the problem said of the last iterate.
    verdict: Verdict,
    /// The number of the last iterate.
    iteration: usize,
}

/// Owns a SNES for the length of a solve.
struct Snes(sys::SNES);

impl Drop for Snes {
    fn drop(&mut self) {
        // SAFETY: this handle owns the solver and the session is alive.
        unsafe { sys::SNESDestroy(&mut self.0) };
    }
}

/// Solves `F(u) = 0` from `u`, which ends as the last iterate whether or not it converged, and gives whether it did by
/// [`Problem::judge`]. Options of the prefix `equilibrium_` act (`-equilibrium_snes_monitor`). Collective.
///
/// # Errors
/// PETSc's, or what the problem's callbacks returned.
///
/// # Panics
/// Where a callback panicked.
pub fn solve(problem: &mut dyn Problem, u: &mut Vector, max_iterations: usize) -> Result<bool> {
    let comm = u.comm().clone();
    let residual = Vector::zeros(&comm, u.n_local())?;
    let jacobian = problem.jacobian().raw();
    let mut context =
        Context { problem, comm: comm.clone(), trap: Trap::default(), verdict: Verdict::Continue, iteration: 0 };
    let pointer = ptr::from_mut(&mut context).cast::<c_void>();
    let mut snes = Snes(ptr::null_mut());
    // SAFETY: `context` outlives the solver, and is reached through `pointer` only while SNESSolve runs.
    unsafe {
        check(sys::SNESCreate(comm.raw(), &mut snes.0))?;
        check(sys::SNESSetOptionsPrefix(snes.0, c"equilibrium_".as_ptr()))?;
        check(sys::SNESSetType(snes.0, c"newtonls".as_ptr()))?;
        check(sys::SNESSetFunction(snes.0, residual.raw(), Some(evaluate), pointer))?;
        check(sys::SNESSetJacobian(snes.0, jacobian, jacobian, Some(linearise), pointer))?;
        check(sys::SNESSetConvergenceTest(snes.0, Some(judge), pointer, None))?;
        check(sys::SNESSetTolerances(snes.0, 0.0, 0.0, 0.0, max_iterations as Int, Int::MAX))?;
        use_corrections(snes.0, pointer)?;
        check(sys::SNESSetFromOptions(snes.0))?;
        use_critical_lengths(snes.0, pointer)?;
        let code = sys::SNESSolve(snes.0, ptr::null_mut(), u.raw());
        (*pointer.cast::<Context>()).trap.release(code)?;
    }
    Ok(context.verdict == Verdict::Converged)
}

/// The linear solver is one application of [`Problem::correct`].
unsafe fn use_corrections(snes: sys::SNES, context: *mut c_void) -> Result<()> {
    let (mut ksp, mut pc) = (ptr::null_mut(), ptr::null_mut());
    // SAFETY: the solver is alive; the strings are static.
    unsafe {
        check(sys::SNESGetKSP(snes, &mut ksp))?;
        check(sys::KSPSetType(ksp, c"preonly".as_ptr()))?;
        check(sys::KSPGetPC(ksp, &mut pc))?;
        check(sys::PCSetType(pc, c"shell".as_ptr()))?;
        check(sys::PCShellSetContext(pc, context))?;
        check(sys::PCShellSetApply(pc, Some(correct)))
    }
}

/// Each step is shortened by [`shorten`], whatever line search the options name.
unsafe fn use_critical_lengths(snes: sys::SNES, context: *mut c_void) -> Result<()> {
    let mut line = ptr::null_mut();
    // SAFETY: the solver is alive; the string is static.
    unsafe {
        check(sys::SNESGetLineSearch(snes, &mut line))?;
        check(sys::SNESLineSearchSetType(line, c"basic".as_ptr()))?;
        check(sys::SNESLineSearchSetPostCheck(line, Some(shorten), context))
    }
}

/// Runs a callback's body on the context behind `pointer`.
unsafe fn with_context(
    pointer: *mut c_void,
    name: &CStr,
    body: impl FnOnce(&mut dyn Problem, &Comm) -> Result<()>,
) -> sys::PetscErrorCode {
    // SAFETY: the pointer is the one that `solve` registered; SNES runs its callbacks one at a time.
    let context = unsafe { &mut *pointer.cast::<Context>() };
    let (problem, comm) = (&mut *context.problem, &context.comm);
    context.trap.guard(name, || body(problem, comm))
}

unsafe extern "C" fn evaluate(_: sys::SNES, u: sys::Vec, r: sys::Vec, pointer: *mut c_void) -> sys::PetscErrorCode {
    let body = |problem: &mut dyn Problem, comm: &Comm| {
        problem.residual(&*Borrowed::new(u, comm)?, Borrowed::new(r, comm)?.get_mut())
    };
    // SAFETY: see `with_context`.
    unsafe { with_context(pointer, c"residual", body) }
}

unsafe extern "C" fn linearise(
    _: sys::SNES,
    u: sys::Vec,
    _: sys::Mat,
    _: sys::Mat,
    pointer: *mut c_void,
) -> sys::PetscErrorCode {
    let body = |problem: &mut dyn Problem, comm: &Comm| problem.linearise(&*Borrowed::new(u, comm)?);
    // SAFETY: see `with_context`.
    unsafe { with_context(pointer, c"linearise", body) }
}

unsafe extern "C" fn correct(pc: sys::PC, r: sys::Vec, du: sys::Vec) -> sys::PetscErrorCode {
    let mut pointer: *mut c_void = ptr::null_mut();
    let body = |problem: &mut dyn Problem, comm: &Comm| {
        problem.correct(&*Borrowed::new(r, comm)?, Borrowed::new(du, comm)?.get_mut())
    };
    // SAFETY: the context is the one that `use_corrections` set.
    unsafe {
        match sys::PCShellGetContext(pc, ptr::from_mut(&mut pointer).cast()) {
            0 => with_context(pointer, c"correct", body),
            code => code,
        }
    }
}

/// `w = x - l y` with the step y and the length l of [`line_search`]; SNES comes with l = 1. The first step is taken
/// whole: it leads from the start, which may belong to another stiffness, to where the points that are closed there
/// carry the loads.
unsafe extern "C" fn shorten(
    line: sys::SNESLineSearch,
    x: sys::Vec,
    y: sys::Vec,
    w: sys::Vec,
    _: *mut sys::PetscBool,
    is_changed: *mut sys::PetscBool,
    pointer: *mut c_void,
) -> sys::PetscErrorCode {
    let body = |problem: &mut dyn Problem, comm: &Comm| {
        let mut f = ptr::null_mut();
        let none = ptr::null_mut();
        // SAFETY: SNES passes the line search that calls; only the residual at x is asked for.
        check(unsafe { sys::SNESLineSearchGetVecs(line, none, &mut f, none, none, none) })?;
        let [x, y, f] = [Borrowed::new(x, comm)?, Borrowed::new(y, comm)?, Borrowed::new(f, comm)?];
        let [mut trial, mut residual] = [x.duplicate()?, x.duplicate()?];
        let length = line_search::critical_length(f.dot(&y)?, |length| {
            trial.copy_from(&x)?;
            trial.axpy(-length, &y)?;
            problem.residual(&trial, &mut residual)?;
            residual.dot(&y)
        })?;
        if length != 1.0 {
            Borrowed::new(w, comm)?.get_mut().copy_from(&trial)?;
            // SAFETY: SNES passes a valid place for the answer.
            unsafe { *is_changed = sys::PetscBool::PETSC_TRUE };
        }
        Ok(())
    };
    // SAFETY: see `with_context`.
    unsafe {
        if (*pointer.cast::<Context>()).iteration == 0 {
            return 0;
        }
        with_context(pointer, c"shorten", body)
    }
}

unsafe extern "C" fn judge(
    _: sys::SNES,
    iteration: sys::PetscInt,
    _u: f64,
    step: f64,
    residual: f64,
    reason: *mut sys::SNESConvergedReason,
    pointer: *mut c_void,
) -> sys::PetscErrorCode {
    let mut verdict = Verdict::Diverged;
    let body = |problem: &mut dyn Problem, _: &Comm| {
        verdict = problem.judge(iteration as usize, residual, step);
        let value = match verdict {
            Verdict::Continue => sys::SNESConvergedReason::SNES_CONVERGED_ITERATING,
            Verdict::Converged => sys::SNESConvergedReason::SNES_CONVERGED_FNORM_ABS,
            Verdict::Diverged => sys::SNESConvergedReason::SNES_DIVERGED_DTOL,
        };
        // SAFETY: SNES passes a valid place for the answer.
        unsafe { *reason = value };
        Ok(())
    };
    // SAFETY: see `with_context`.
    unsafe {
        let code = with_context(pointer, c"judge", body);
        let context = &mut *pointer.cast::<Context>();
        (context.verdict, context.iteration) = (verdict, iteration as usize);
        code
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    /// `arctan u = 0` on one rank, whose whole steps grow from 1.4 on.
    struct ArcTangent {
        jacobian: Matrix,
        /// Where it was evaluated last, and the slope there.
        u: f64,
        slope: f64,
        iterates: Vec<f64>,
    }

    impl Problem for ArcTangent {
        fn residual(&mut self, u: &Vector, r: &mut Vector) -> Result<()> {
            self.u = u.to_vec()?[0];
            r.local_mut(|r| r[0] = self.u.atan())
        }

        fn linearise(&mut self, u: &Vector) -> Result<()> {
            let u = u.to_vec()?[0];
            self.slope = 1.0 / (1.0 + u * u);
            Ok(())
        }

        fn jacobian(&self) -> &Matrix {
            &self.jacobian
        }

        fn correct(&mut self, r: &Vector, du: &mut Vector) -> Result<()> {
            let r = r.to_vec()?[0];
            du.local_mut(|du| du[0] = r / self.slope)
        }

        fn judge(&mut self, _: usize, residual: f64, _: f64) -> Verdict {
            self.iterates.push(self.u);
            if residual < 1e-12 { Verdict::Converged } else { Verdict::Continue }
        }
    }

    #[test]
    fn the_first_step_is_whole_and_later_ones_are_shortened() {
        let comm = Session::start(&[]).unwrap();
        let jacobian = Matrix::dense(&comm, 1, &[1.0]).unwrap();
        let mut problem = ArcTangent { jacobian, u: 0.0, slope: 1.0, iterates: Vec::new() };
        let mut u = Vector::from_local(&comm, &[2.0]).unwrap();
        assert!(solve(&mut problem, &mut u, 20).unwrap());
        let whole = |u: f64| u - u.atan() * (1.0 + u * u);
        let found = &problem.iterates;
        assert!((found[1] - whole(2.0)).abs() < 1e-12 && found[1].abs() > 2.0, "{found:?}");
        assert!(found[2].abs() < found[1].abs() && whole(found[1]).abs() > 10.0, "{found:?}");
        assert!(found.len() < 8, "{found:?}");
    }
}
