//! What a person sees of long work: a bar where standard error is a terminal, else lines if they were asked for, else nothing.

use std::cell::Cell;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::native::Comm;

/// A line that tells stage, detail and elapsed time, with a bar over the values of a sweep.
pub struct Progress {
    bar: ProgressBar,
    start: Instant,
    /// Values that took no time.
    skipped: Cell<u64>,
    is_root: bool,
    /// Whether finished values are told on lines of their own.
    lines: bool,
    /// When the last line was written.
    told: Cell<Instant>,
}

/// Within a value that takes long, a line tells what is being done no more often than this.
const STILL_AT_WORK: Duration = Duration::from_secs(30);

impl Progress {
    /// Shows `n` values to come; on the first rank only.
    pub fn new(comm: &Comm, n: usize, verbose: bool) -> Progress {
        let bar = if comm.is_root() { ProgressBar::new(n as u64) } else { ProgressBar::hidden() };
        let template = "{spinner} [{elapsed}] {wide_bar} {pos}/{len} {msg} {eta} left";
        bar.set_style(ProgressStyle::with_template(template).expect("a valid template"));
        bar.enable_steady_tick(Duration::from_millis(200));
        let start = Instant::now();
        Progress {
            bar,
            start,
            told: Cell::new(start),
            skipped: Cell::new(0),
            is_root: comm.is_root(),
            lines: verbose && comm.is_root(),
        }
    }

    /// Says what is being done.
    pub fn say(&self, message: impl Into<String>) {
        let message = message.into();
        if self.told.get().elapsed() >= STILL_AT_WORK {
            self.tell(&message);
        }
        self.bar.set_message(message);
    }

    /// A line for those who asked for lines.
    fn tell(&self, line: &str) {
        self.told.set(Instant::now());
        if self.lines {
            let elapsed = self.start.elapsed().as_secs_f64();
            self.bar.suspend(|| eprintln!("[{elapsed:.0} s] {line}"));
        }
    }

    /// Something that writes a line whenever it is called, from any thread; nothing but on the first rank.
    pub fn teller(&self, line: &'static str) -> impl Fn() + Send + 'static {
        let (bar, is_root) = (self.bar.clone(), self.is_root);
        move || {
            if is_root {
                bar.suspend(|| eprintln!("{line}"));
            }
        }
    }

    /// One more value is to come than was said.
    pub fn lengthen(&self) {
        self.bar.inc_length(1);
    }

    /// One more value was done before, one of those to come or one more.
    pub fn skip(&self, was_to_come: bool) {
        if !was_to_come {
            self.lengthen();
        }
        self.skipped.set(self.skipped.get() + 1);
        self.bar.inc(1);
        self.bar.reset_eta();
    }

    /// One more value is done, which the text describes.
    pub fn advance(&self, done: &str) {
        self.bar.inc(1);
        let (position, length) = (self.bar.position(), self.bar.length().unwrap_or(0));
        let elapsed = self.start.elapsed().as_secs_f64();
        let computed = (position - self.skipped.get()) as f64;
        let left = elapsed / computed * length.saturating_sub(position) as f64;
        self.tell(&format!("{position}/{length} {done}; about {left:.0} s left"));
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
