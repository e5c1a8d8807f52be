//! Signals that ask the program to stop, and its end from any thread.

use std::sync::OnceLock;

use nix::libc;
use nix::sys::pthread::{Pthread, pthread_kill, pthread_self};
use nix::sys::signal::{SaFlags, SigAction, SigHandler, SigSet, Signal, raise, sigaction};

use crate::{Error, Result};

/// The thread that receives the signals.
static RECEIVER: OnceLock<Pthread> = OnceLock::new();

/// Passes SIGINT and SIGTERM to the thread that receives them.
extern "C" fn pass_on(number: libc::c_int) {
    if let (Some(receiver), Ok(signal)) = (RECEIVER.get(), Signal::try_from(number)) {
        let _ = pthread_kill(*receiver, signal);
    }
}

/// From now on a thread of its own receives SIGINT and SIGTERM, and calls `receive` with their numbers. Both are
/// blocked for the calling thread and those that it starts; where another thread gets one (OpenBLAS has threads before
/// the program begins), it passes it on. So no handler but that one runs: METIS has its own while it works, which
/// leaves METIS by a jump. A signal that was ignored stays ignored.
///
/// # Errors
/// The system's.
pub fn receive_stop_signals(receive: impl Fn(i32) + Send + 'static) -> Result<()> {
    let failed = |reason| Error::library("signals cannot be received")(reason);
    let action = SigAction::new(SigHandler::Handler(pass_on), SaFlags::SA_RESTART, SigSet::empty());
    let mut signals = SigSet::empty();
    for signal in [Signal::SIGINT, Signal::SIGTERM] {
        // SAFETY: the handler calls what may be called in one: an atomic read and `pthread_kill`.
        let before = unsafe { sigaction(signal, &action) }.map_err(failed)?;
        if matches!(before.handler(), SigHandler::SigIgn) {
            // SAFETY: what was there before.
            unsafe { sigaction(signal, &before) }.map_err(failed)?;
        } else {
            signals.add(signal);
        }
    }
    signals.thread_block().map_err(failed)?;
    std::thread::spawn(move || {
        let _ = RECEIVER.set(pthread_self());
        while let Ok(signal) = signals.wait() {
            receive(signal as i32);
        }
    });
    Ok(())
}

/// Ends the process by a signal, as if nothing had received it: a shell sees that.
pub fn end_by_signal(number: i32) -> ! {
    if let Ok(signal) = Signal::try_from(number) {
        let action = SigAction::new(SigHandler::SigDfl, SaFlags::empty(), SigSet::empty());
        // SAFETY: the default action is no handler.
        let _ = unsafe { sigaction(signal, &action) };
        let _ = SigSet::from(signal).thread_unblock();
        let _ = raise(signal);
    }
    end_process(128 + number)
}

/// Ends the process at once, without destructors: from any thread, and in any state of the libraries.
pub fn end_process(code: i32) -> ! {
    // SAFETY: it has no conditions.
    unsafe { libc::_exit(code) }
}
