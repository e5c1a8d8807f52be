//! Ctrl-C and its like: a run ends after the friction that it is at, and can go on later.

use std::sync::Arc;
use std::sync::atomic::{AtomicI32, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::exit;

use crate::native::Comm;
use crate::{Error, Result};

/// Hears of signals that ask a run to end.
pub struct Interrupt {
    signal: Arc<AtomicI32>,
}

impl Interrupt {
    /// From now on the first SIGINT or SIGTERM is heard of, and answered by `tell`; the second ends the process at once.
    ///
    /// # Errors
    /// The system's.
    pub fn listen(tell: impl Fn() + Send + 'static) -> Result<Interrupt> {
        let mut signals = Signals::new([SIGINT, SIGTERM])
            .map_err(|reason| Error::Library(format!("signals cannot be listened to: {reason}")))?;
        let signal = Arc::new(AtomicI32::new(0));
        let heard = signal.clone();
        std::thread::spawn(move || {
            for number in signals.forever() {
                if heard.swap(number, Ordering::Relaxed) != 0 {
                    exit(Error::SIGNAL + number);
                }
                tell();
            }
        });
        Ok(Interrupt { signal })
    }

    /// The signal that any rank has heard, if any. Collective.
    pub fn heard(&self, comm: &Comm) -> Option<i32> {
        let signal = comm.max(f64::from(self.signal.load(Ordering::Relaxed))) as i32;
        (signal > 0).then_some(signal)
    }
}
