//! Ctrl-C and its like: a run ends after the friction that it is at, and can go on later.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::petsc::Comm;
use crate::{Error, Result};

/// Hears of signals that ask a run to end.
pub struct Interrupt {
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    /// From now on the first SIGINT or SIGTERM is heard of, the second ends the process at once.
    ///
    /// # Errors
    /// The system's.
    pub fn listen() -> Result<Interrupt> {
        let (signal, again) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
        for number in [SIGINT, SIGTERM] {
            // In this order: the first signal finds the flag down, and raises it for the second.
            flag::register_conditional_shutdown(number, Error::SIGNAL + number, again.clone())
                .and_then(|_| flag::register(number, again.clone()))
                .and_then(|_| flag::register_usize(number, signal.clone(), number as usize))
                .map_err(|reason| Error::Library(format!("signal {number} cannot be listened to: {reason}")))?;
        }
        Ok(Interrupt { signal })
    }

    /// The signal that any rank has heard, if any. Collective.
    pub fn heard(&self, comm: &Comm) -> Option<i32> {
        let signal = comm.max(self.signal.load(Ordering::Relaxed) as f64) as i32;
        (signal > 0).then_some(signal)
    }
}
