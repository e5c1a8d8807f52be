//! Ctrl-C and SIGTERM: an analysis stops after the value at hand if that ends within seconds, else at once. Either way
//! the finished values are on the disk, and the analysis can continue later.

use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use crate::native::signals::{end_by_signal, end_process, receive_stop_signals};
use crate::{ErrorKind, Result};

/// Seconds that the value at hand has after a signal. A factorisation or a search for modes, which may take hours,
/// cannot be interrupted; but a finished value is written as a whole, so that the process may end at any moment.
const GRACE: Duration = Duration::from_secs(4);
/// Time to say so: nobody may be reading.
const LAST_WORDS: Duration = Duration::from_millis(200);

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
    /// From now on SIGINT and SIGTERM are received. To be called before the program starts threads. A signal ends the
    /// process until [`Self::listen`] is called.
    ///
    /// # Errors
    /// The system's.
    pub fn receive() -> Result<Interrupt> {
        let received = Arc::new(Received::default());
        let own = received.clone();
        receive_stop_signals(move |number| own.receive(number))?;
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
        let Some(answer) = self.answer.get() else { end_by_signal(number) };
        if self.signal.compare_exchange(0, number, Ordering::Relaxed, Ordering::Relaxed).is_err() {
            end_process(ErrorKind::SIGNAL + number);
        }
        let later = self.clone();
        // Before anything is printed, which may wait for a reader.
        std::thread::spawn(move || {
            std::thread::sleep(GRACE);
            std::thread::spawn(move || later.answer.get().map(|answer| (answer.farewell)()));
            std::thread::sleep(LAST_WORDS);
            end_process(ErrorKind::SIGNAL + number);
        });
        (answer.notice)();
    }
}
