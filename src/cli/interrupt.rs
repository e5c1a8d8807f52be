//! Ctrl-C and SIGTERM: an analysis stops after the value at hand if that ends within seconds, else at once. Either way
//! the finished values are on the disk, and the analysis can continue later.

use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use nix::sys::signal::{SigSet, Signal};

use crate::native::end_process;
use crate::{Error, ErrorKind, Result};

/// Seconds that the value at hand has after a signal. A factorisation or a search for modes, which may take hours,
/// cannot be interrupted; but a finished value is written as a whole, so that the process may end at any moment.
const GRACE: Duration = Duration::from_secs(4);

/// Receives the signals that ask a program to stop.
#[derive(Clone)]
pub struct Interrupt {
    received: Arc<Received>,
}

#[derive(Default)]
struct Received {
    /// The number of the first signal, or zero.
    signal: AtomicI32,
    answer: OnceLock<Answer>,
}

/// What is said when a signal comes, and when [`GRACE`] ends.
struct Answer {
    notice: Box<dyn Fn() + Send + Sync>,
    farewell: Box<dyn Fn() + Send + Sync>,
}

impl Interrupt {
    /// From now on SIGINT and SIGTERM reach a thread of this object and no handler: METIS has one of its own while it
    /// works, which leaves METIS by a jump. To be called before the program has other threads, which inherit what is
    /// blocked. A signal ends the process until [`Self::listen`] is called.
    ///
    /// # Errors
    /// The system's.
    pub fn receive() -> Result<Interrupt> {
        let signals = SigSet::from_iter([Signal::SIGINT, Signal::SIGTERM]);
        signals.thread_block().map_err(Error::library("signals cannot be blocked"))?;
        let received = Arc::new(Received::default());
        let inner = received.clone();
        std::thread::spawn(move || {
            while let Ok(signal) = signals.wait() {
                inner.receive(signal as i32);
            }
        });
        Ok(Interrupt { received })
    }

    /// From now on the first signal is kept, and answered by `notice`. The second ends the process at once, and so does
    /// the end of [`GRACE`], after `farewell`. Only the first call counts.
    pub fn listen(&self, notice: impl Fn() + Send + Sync + 'static, farewell: impl Fn() + Send + Sync + 'static) {
        let _ = self.received.answer.set(Answer { notice: Box::new(notice), farewell: Box::new(farewell) });
    }

    /// The signal that this process has received, if any.
    pub fn signal(&self) -> Option<i32> {
        Some(self.received.signal.load(Ordering::Relaxed)).filter(|&signal| signal > 0)
    }
}

impl Received {
    fn receive(self: &Arc<Self>, number: i32) {
        let is_first = self.signal.swap(number, Ordering::Relaxed) == 0;
        let answer = self.answer.get().filter(|_| is_first);
        let Some(answer) = answer else { end_process(ErrorKind::SIGNAL + number) };
        (answer.notice)();
        let later = self.clone();
        std::thread::spawn(move || {
            std::thread::sleep(GRACE);
            if let Some(answer) = later.answer.get() {
                (answer.farewell)();
            }
            end_process(ErrorKind::SIGNAL + number);
        });
    }
}
