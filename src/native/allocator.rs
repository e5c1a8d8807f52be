//! Memory of the program itself.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;

use crate::ErrorKind;

use super::signals::end_process;

/// The system's allocator, which ends the process with a message where there is no memory: Rust's own aborts it, and
/// Open MPI prints the stack of a process that aborts.
pub struct Allocator;

// SAFETY: all is the system's; a process that has ended uses no pointer.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are the system's.
        not_null(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        not_null(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        not_null(unsafe { System.realloc(pointer, layout, size) }, size)
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

fn not_null(pointer: *mut u8, size: usize) -> *mut u8 {
    if pointer.is_null() {
        end(size);
    }
    pointer
}

/// Ends the process without allocating.
fn end(size: usize) -> ! {
    let mut text = [0; 256];
    let mut rest = &mut text[..];
    let _ = writeln!(
        rest,
        "error: too little memory: {:.1} MB more could not be allocated. A coarser mesh, other programs closed, a higher \
         limit or a machine with more memory help",
        size as f64 / 1e6
    );
    let n_left = rest.len();
    let _ = std::io::stderr().write_all(&text[..text.len() - n_left]);
    end_process(ErrorKind::OutOfMemory.exit_code())
}
