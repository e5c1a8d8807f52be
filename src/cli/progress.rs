//! What a person at a terminal sees of long work; nothing where standard error is not a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::petsc::Comm;

/// A line that tells stage, detail and elapsed time, with a bar over the values of a sweep.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Shows `n` values to come; on the first rank only.
    pub fn new(comm: &Comm, n: usize) -> Progress {
        let bar = if comm.is_root() { ProgressBar::new(n as u64) } else { ProgressBar::hidden() };
        let template = "{spinner} [{elapsed}] {wide_bar} {pos}/{len} {msg} {eta} left";
        bar.set_style(ProgressStyle::with_template(template).expect("a valid template"));
        bar.enable_steady_tick(Duration::from_millis(200));
        Progress { bar }
    }

    /// Says what is being done.
    pub fn say(&self, message: impl Into<String>) {
        self.bar.set_message(message.into());
    }

    /// One more value is done.
    pub fn advance(&self) {
        self.bar.inc(1);
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
