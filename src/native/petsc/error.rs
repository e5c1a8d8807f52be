//! From PETSc's error codes and frames to [`Error`].

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use squeal_sys as sys;

use crate::error::Frame;
use crate::{Error, Result};

/// PETSc's `PETSC_ERR_MEM`.
const OUT_OF_MEMORY: sys::PetscErrorCode = 55;

/// The error under way: its message and the functions that it has passed through, the innermost first.
#[derive(Default)]
struct Stack {
    message: String,
    frames: Vec<Frame>,
}

thread_local! {
    static STACK: RefCell<Stack> = const { RefCell::new(Stack { message: String::new(), frames: Vec::new() }) };
}

/// Collects one frame of PETSc's error stack; the innermost comes first and carries the message.
pub(in crate::native) unsafe extern "C" fn collect(
    _comm: sys::MPI_Comm,
    line: c_int,
    function: *const c_char,
    file: *const c_char,
    code: sys::PetscErrorCode,
    kind: sys::PetscErrorType,
    message: *const c_char,
    _context: *mut c_void,
) -> sys::PetscErrorCode {
    let text = |pointer: *const c_char| {
        if pointer.is_null() {
            return String::new();
        }
        // SAFETY: PETSc passes NUL-terminated strings that live for the call.
        unsafe { CStr::from_ptr(pointer) }.to_string_lossy().trim().to_owned()
    };
    let frame = Frame { function: text(function), file: text(file), line };
    STACK.with_borrow_mut(|stack| {
        if kind == sys::PetscErrorType::PETSC_ERROR_INITIAL {
            *stack = Stack { message: text(message), frames: Vec::new() };
        }
        stack.frames.push(frame);
    });
    code
}

/// The one door: a code of 0 passes, any other becomes an error with the frames collected on the way.
pub(in crate::native) fn check(code: sys::PetscErrorCode) -> Result<()> {
    if code == 0 {
        return Ok(());
    }
    let Stack { message, frames } = STACK.with_borrow_mut(std::mem::take);
    Err(short_memory(code, &frames).unwrap_or(Error::Petsc { code, message, frames }))
}

/// What PETSc reports where it can allocate no memory. Its functions then return a line number in place of the code, so
/// the functions themselves are looked at.
fn short_memory(code: sys::PetscErrorCode, frames: &[Frame]) -> Option<Error> {
    let is_allocator = |frame: &&Frame| frame.function.starts_with("PetscMalloc");
    let n_allocators = frames.iter().take_while(is_allocator).count();
    if n_allocators == 0 && code != OUT_OF_MEMORY {
        return None;
    }
    let whose = frames.get(n_allocators).map_or("PETSc", |frame| frame.function.as_str());
    Some(Error::OutOfMemory { what: format!("{whose} of PETSc could not allocate what it needs"), needed_mb: None })
}

/// Carries an error or a panic across PETSc's C frames.
#[derive(Default)]
pub(in crate::native) struct Trap {
    error: Option<Error>,
    panic: Option<Box<dyn Any + Send>>,
}

impl Trap {
    /// Runs a callback's body; what goes wrong is kept here and PETSc is told to unwind.
    pub(in crate::native) fn guard(&mut self, name: &CStr, body: impl FnOnce() -> Result<()>) -> sys::PetscErrorCode {
        let message = match catch_unwind(AssertUnwindSafe(body)) {
            Ok(Ok(())) => return 0,
            Ok(Err(error)) => {
                self.error = Some(error);
                c"error in a callback"
            }
            Err(panic) => {
                self.panic = Some(panic);
                c"panic in a callback"
            }
        };
        // SAFETY: both strings are NUL-terminated and static for the call.
        unsafe { sys::squeal_raise(name.as_ptr(), message.as_ptr()) }
    }

    /// What the solve comes to: the callback's own panic or error first, PETSc's second.
    pub(in crate::native) fn release(&mut self, code: sys::PetscErrorCode) -> Result<()> {
        let outcome = check(code);
        if let Some(panic) = self.panic.take() {
            resume_unwind(panic);
        }
        match self.error.take() {
            Some(error) => Err(error),
            None => outcome,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ErrorKind;

    fn frames(functions: &[&str]) -> Vec<Frame> {
        functions.iter().map(|name| Frame { function: (*name).into(), file: "mal.c".into(), line: 55 }).collect()
    }

    #[test]
    fn short_memory_is_known_by_its_code_or_by_the_function_that_allocates() {
        let short = short_memory(4865, &frames(&["PetscMallocAlign", "PetscMallocA", "MatDuplicate"])).unwrap();
        assert!(
            short.kind() == ErrorKind::OutOfMemory && short.to_string().contains("MatDuplicate of PETSc"),
            "{short}"
        );
        assert!(short_memory(OUT_OF_MEMORY, &frames(&["MatLUFactor", "PetscMallocA"])).is_some());
        assert!(short_memory(63, &frames(&["MatLUFactor", "PetscMallocA"])).is_none());
    }
}
