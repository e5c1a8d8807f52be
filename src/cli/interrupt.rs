//! Ctrl-C and SIGTERM: an analysis stops after the value at hand if that ends within seconds, else at once. Either way
//! the finished values are on the disk, and the analysis can continue later.

use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::exit;

use crate::{Error, ErrorKind, Result};

/// Seconds that the value at hand has after a signal. A factorisation or a search for modes, which may take hours,
/// cannot be interrupted; but a finished value is written as a whole, so that the process may end at any moment.
const GRACE: Duration = Duration::from_secs(4);

/// Receives the signals that ask a run to stop.
pub struct Interrupt {
    signal: Arc<AtomicI32>,
}

impl Interrupt {
    /// From now on the first SIGINT or SIGTERM is kept, and answered by `notice`. The second ends the process at once,
    /// and so does the end of [`GRACE`], after `farewell`.
    ///
    /// # Errors
    /// The system's.
    pub fn listen(notice: impl Fn() + Send + 'static, farewell: impl Fn() + Send + 'static) -> Result<Interrupt> {
        let mut signals = Signals::new([SIGINT, SIGTERM]).map_err(Error::library("no handler for signals"))?;
        let signal = Arc::new(AtomicI32::new(0));
        let received = signal.clone();
        let farewell = Arc::new(Mutex::new(farewell));
        std::thread::spawn(move || {
            for number in signals.forever() {
                if received.swap(number, Ordering::Relaxed) != 0 {
                    exit(ErrorKind::SIGNAL + number);
                }
                notice();
                let farewell = farewell.clone();
                std::thread::spawn(move || {
                    std::thread::sleep(GRACE);
                    if let Ok(farewell) = farewell.lock() {
                        farewell();
                    }
                    exit(ErrorKind::SIGNAL + number);
                });
            }
        });
        Ok(Interrupt { signal })
    }

    /// The signal that this process has received, if any.
    pub fn signal(&self) -> Option<i32> {
        Some(self.signal.load(Ordering::Relaxed)).filter(|&signal| signal > 0)
    }
}
