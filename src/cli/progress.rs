//! What a person sees of long work: a bar where standard error is a terminal, else lines if they were asked for, else
//! nothing.

use std::cell::Cell;
use std::io::{Write, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::native::Comm;
use crate::native::machine::peak_mb;
use crate::output::text::printable;

/// A line with stage, detail and elapsed time, and a bar over the values of a sweep.
pub struct Progress {
    bar: ProgressBar,
    start: Instant,
    /// When the values at hand began.
    began: Cell<Instant>,
    /// Values that took no time.
    n_skipped: Cell<u64>,
    is_root: bool,
    /// Whether finished values get lines of their own.
    has_lines: bool,
    /// When the last line was printed.
    printed: Cell<Instant>,
}

/// Within a value that takes long, a line says what is being done no more often than this.
const LINE_INTERVAL: Duration = Duration::from_secs(30);

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
            began: Cell::new(start),
            printed: Cell::new(start),
            n_skipped: Cell::new(0),
            is_root: comm.is_root(),
            has_lines: verbose && comm.is_root(),
        }
    }

    /// Shows what is being done.
    pub fn show(&self, message: impl Into<String>) {
        let message = message.into();
        if self.printed.get().elapsed() >= LINE_INTERVAL {
            self.line(&message);
        }
        self.bar.set_message(message);
    }

    /// A line for those who asked for lines.
    fn line(&self, text: &str) {
        self.printed.set(Instant::now());
        if self.has_lines {
            let elapsed = self.start.elapsed().as_secs_f64();
            self.bar.suspend(|| write_line(&format!("[{elapsed:.0} s] {text}")));
        }
    }

    /// Prints a line for everybody, on the first rank.
    pub fn print(&self, line: &str) {
        if self.is_root {
            self.bar.suspend(|| write_line(&printable(line)));
        }
    }

    /// Something that prints a line whenever it is called, from any thread; nothing but on the first rank.
    pub fn notice(&self, line: &'static str) -> impl Fn() + Send + Sync + 'static {
        let (bar, is_root) = (self.bar.clone(), self.is_root);
        move || {
            if is_root {
                bar.suspend(|| write_line(line));
            }
        }
    }

    /// So many values are to come, of a sweep that begins.
    pub fn begin(&self, n: usize) {
        self.bar.set_length(n as u64);
        self.bar.set_position(0);
        self.bar.reset_eta();
        self.n_skipped.set(0);
        self.began.set(Instant::now());
    }

    /// One more value is to come.
    pub fn lengthen(&self) {
        self.bar.inc_length(1);
    }

    /// One more value was done before, one of those to come or one more.
    pub fn skip(&self, was_to_come: bool) {
        if !was_to_come {
            self.lengthen();
        }
        self.n_skipped.set(self.n_skipped.get() + 1);
        self.bar.inc(1);
        self.bar.reset_eta();
    }

    /// One more value is done, which the text describes.
    pub fn advance(&self, done: &str) {
        self.bar.inc(1);
        self.line(&self.state(done));
    }

    /// How many values are done, and the time left.
    fn state(&self, done: &str) -> String {
        let (position, length) = (self.bar.position(), self.bar.length().unwrap_or(0));
        let elapsed = self.began.get().elapsed().as_secs_f64();
        let n_computed = (position - self.n_skipped.get()) as f64;
        let left = elapsed / n_computed * length.saturating_sub(position) as f64;
        format!("{position}/{length} {done}; about {left:.0} s left")
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// A line for each finished stage of a command, for those who asked for lines.
pub struct Stages<'a> {
    comm: &'a Comm,
    has_lines: bool,
    /// When the last stage ended.
    last: Instant,
}

impl<'a> Stages<'a> {
    /// The first stage begins.
    pub fn new(comm: &'a Comm, verbose: bool) -> Stages<'a> {
        Stages { comm, has_lines: verbose, last: Instant::now() }
    }

    /// A stage has ended, and the next begins: prints the seconds that it took, and the most memory that all ranks
    /// together have had so far. Collective.
    pub fn end(&mut self, stage: &str) {
        if !self.has_lines {
            return;
        }
        let peak_gb = peak_mb(self.comm) / 1024.0;
        if self.comm.is_root() {
            let seconds = self.last.elapsed().as_secs_f64();
            write_line(&format!("{stage}: {seconds:.1} s, peak memory {peak_gb:.2} GB"));
        }
        self.last = Instant::now();
    }
}

/// Writes a line to standard error. That nobody reads it any more is no error.
fn write_line(line: &str) {
    let _ = writeln!(stderr(), "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    #[test]
    fn each_sweep_of_a_command_is_counted_from_its_begin() {
        let comm = Session::start(&[]).unwrap();
        let progress = Progress::new(&comm, 0, false);
        progress.begin(2);
        progress.skip(true);
        progress.advance("first sweep");
        assert!(progress.state("now").starts_with("2/2 now"));
        progress.begin(3);
        progress.advance("second sweep");
        assert!(progress.state("now").starts_with("1/3 now"), "{}", progress.state("now"));
        progress.skip(false);
        assert!(progress.state("now").starts_with("2/4 now"));
    }
}
