//! What a person sees of an analysis: events as a progress line, and Ctrl-C as a request to stop.

use crate::analysis::{Event, Observer};
use crate::explore::{Outcome, PointResult};
use crate::model::ProposedStiffness;
use crate::output::text::friction;
use crate::reduction::craig_bampton;
use crate::results::{Value, WearStep};
use crate::stability::EigenProgress;

use super::interrupt::Interrupt;
use super::progress::Progress;
use super::{Shell, warning_line};

/// Shows events, and asks the analysis to stop after a signal.
pub struct Watch {
    progress: Progress,
    interrupt: Option<Interrupt>,
    /// Whether warnings are JSON documents.
    json: bool,
}

impl Watch {
    /// Shows events on the first rank.
    pub fn new(shell: &Shell, verbose: bool) -> Watch {
        Watch { progress: Progress::new(shell.comm, 1, verbose), interrupt: None, json: shell.json }
    }

    /// The same, for an analysis that stops when a signal asks for it: after the value at hand, or within seconds.
    pub fn with_signals(shell: &Shell, verbose: bool) -> Watch {
        let watch = Watch::new(shell, verbose);
        let notice =
            watch.progress.notice("stopping after this value, or within four seconds; a second signal stops at once");
        let farewell = watch.progress.notice(
            "stopped within a value, which is lost; finished values are kept. The same command goes on from there",
        );
        shell.interrupt.listen(notice, farewell);
        Watch { interrupt: Some(shell.interrupt.clone()), ..watch }
    }

    /// Removes the progress line.
    pub fn finish(&self) {
        self.progress.finish();
    }
}

impl Observer for Watch {
    fn event(&mut self, event: Event) {
        match event {
            Event::Planned(n) => self.progress.begin(n),
            Event::Inserted => self.progress.lengthen(),
            Event::Stage(what) => self.progress.show(what),
            Event::Resumed { place, n, unit } => self
                .progress
                .print(&format!("{place}: an earlier run has finished {n} {unit}; this run continues from there")),
            Event::Warning(text) => self.progress.print(&warning_line(text, self.json)),
            // In JSON the results have it.
            Event::Proposed { pair, stiffness } if !self.json => {
                let proposed = ProposedStiffness { contact: pair.to_owned(), stiffness, stick: None };
                self.progress.print(&proposed.to_string());
            }
            Event::Proposed { .. } => {}
            Event::Part { name, is_made } => {
                self.progress.print(&format!("{name}: {}", if is_made { "made before" } else { "begins" }));
            }
            Event::Replayed(value) => self.progress.skip(value.asked),
            Event::Newton { label, iteration, iterate } => {
                let (residual, closed) = (iterate.residual, iterate.counts.closed());
                self.progress.show(format!("{label}: iteration {iteration}, residual {residual:.1e}, {closed} closed"));
            }
            Event::Modes(EigenProgress { n_converged, n_wanted, n_solves }) => {
                self.progress.show(format!("modes: {n_converged} of {n_wanted} eigenvalues, {n_solves} solves"));
            }
            Event::Reduction(step) => self.progress.show(reduction_step(step)),
            Event::Finished(value) => self.progress.advance(&finished(value)),
            Event::Worn { step, is_replayed: false } => self.progress.advance(&worn(step)),
            Event::Worn { .. } | Event::Point { is_replayed: true, .. } => self.progress.skip(true),
            Event::Point { number, point, .. } => self.progress.advance(&finished_point(number, point)),
        }
    }

    fn stop_signal(&mut self) -> Option<i32> {
        self.interrupt.as_ref().and_then(Interrupt::signal)
    }
}

fn reduction_step(step: &craig_bampton::Event) -> String {
    match step {
        craig_bampton::Event::Factor => "factorising the structure without its sliding contacts".into(),
        craig_bampton::Event::Constraint(done, all) => format!("constraint modes: {done} of {all}"),
        craig_bampton::Event::Fixed(size) => format!("fixed-interface modes: a space of {size} vectors"),
        craig_bampton::Event::Sample(done, all) => format!("samples of moduli and densities: {done} of at most {all}"),
        craig_bampton::Event::Project => "projecting".into(),
    }
}

/// A finished point of a study in a few words.
fn finished_point(number: usize, point: &PointResult) -> String {
    let name = if number == 0 { "nominal point".to_owned() } else { format!("point {number}") };
    match &point.outcome {
        Outcome::Failed(reason) => format!("{name} has failed: {reason}"),
        Outcome::Modes(modes) => {
            let n_unstable = modes.iter().filter(|mode| mode.unstable).count();
            format!("{name}: {} modes, {n_unstable} unstable", modes.len())
        }
    }
}

/// A step of wear in a few words.
fn worn(step: &WearStep) -> String {
    format!("worn to {:.3e} m: p v differs by {:.2} %", step.distance, 100.0 * step.spread())
}

/// A finished value in a few words.
fn finished(value: &Value) -> String {
    let found = match value.count {
        Some(_) => {
            let n_unstable = value.modes.iter().filter(|mode| mode.unstable).count();
            format!("{} modes, {n_unstable} unstable", value.modes.len())
        }
        None => "equilibrium".into(),
    };
    format!("friction coefficient {}: {found}", friction(value.friction))
}
