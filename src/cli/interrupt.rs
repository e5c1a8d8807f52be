//! Ctrl-C and SIGTERM: an analysis stops after the value at hand, and can continue later.

use std::sync::Arc;
use std::sync::atomic::{AtomicI32, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::exit;

use crate::{Error, ErrorKind, Result};

/// Receives the signals that ask a run to stop.
pub struct Interrupt {
    signal: Arc<AtomicI32>,
}

impl Interrupt {
    /// From now on the first SIGINT or SIGTERM is kept, and answered by `notice`; the second ends the process at once.
    ///
    /// # Errors
    /// The system's.
    pub fn listen(notice: impl Fn() + Send + 'static) -> Result<Interrupt> {
        let mut signals = Signals::new([SIGINT, SIGTERM]).map_err(Error::library("no handler for signals"))?;
        let signal = Arc::new(AtomicI32::new(0));
        let received = signal.clone();
        std::thread::spawn(move || {
            for number in signals.forever() {
                if received.swap(number, Ordering::Relaxed) != 0 {
                    exit(ErrorKind::SIGNAL + number);
                }
                notice();
            }
        });
        Ok(Interrupt { signal })
    }

    /// The signal that this process has received, if any.
    pub fn signal(&self) -> Option<i32> {
        Some(self.signal.load(Ordering::Relaxed)).filter(|&signal| signal > 0)
    }
}
