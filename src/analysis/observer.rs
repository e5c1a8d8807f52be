//! What a caller sees of an analysis while it runs.

use crate::equilibrium::Iteration;
use crate::explore::PointResult;
use crate::model::ProposedStiffness;
use crate::native::Comm;
use crate::reduction::craig_bampton;
use crate::results::{Value, WearStep};
use crate::stability::EigenProgress;
use crate::structure::{FullModel, plausibility};

/// What happens in an analysis.
#[derive(Clone, Copy)]
pub enum Event<'a> {
    /// A stage begins, such as the assembly.
    Stage(&'a str),
    /// So many values are found in what an earlier run has left.
    Resumed {
        /// Where its results will be.
        place: &'a str,
        /// Number of them, which need not be computed again.
        n: usize,
        /// What they are, in the plural: values, points or steps.
        unit: &'a str,
    },
    /// The model has something that can hardly be meant.
    Warning(&'a str),
    /// The user gives no stiffness of a contact pair.
    Proposed {
        /// Name of the pair.
        pair: &'a str,
        /// The stiffness that the program proposes, N/m3.
        stiffness: f64,
    },
    /// So many values are to be analysed.
    Planned(usize),
    /// A value is analysed beside those asked for.
    Inserted,
    /// A value is taken from an earlier run.
    Replayed(&'a Value),
    /// A Newton iterate of the step with this label.
    Newton {
        /// What is solved.
        label: &'a str,
        /// Number of the iterate, from 0.
        iteration: usize,
        /// Its residual and contact status.
        iterate: &'a Iteration,
    },
    /// The eigensolver works.
    Modes(EigenProgress),
    /// A part of a study begins, or was made before.
    Part {
        /// Its name.
        name: &'a str,
        /// Whether it need not be made again.
        is_made: bool,
    },
    /// A step of a reduction.
    Reduction(&'a craig_bampton::Event),
    /// A value is finished.
    Finished(&'a Value),
    /// A step of wear is finished.
    Worn {
        /// What is worn off.
        step: &'a WearStep,
        /// Whether an earlier run has found it.
        is_replayed: bool,
    },
    /// A point of a study of many parameters is finished.
    Point {
        /// Its number, from 1; 0 for the nominal point.
        number: usize,
        /// What was found.
        point: &'a PointResult,
        /// Whether an earlier run has found it.
        is_replayed: bool,
    },
}

/// Follows an analysis. Only [`Observer::stop_signal`] has a say in it.
pub trait Observer {
    /// Is called with everything that happens, on every rank.
    fn event(&mut self, event: Event);

    /// The number of a signal that asks this rank to stop; the analysis ends after the value at hand, on all ranks,
    /// with [`crate::Error::Interrupted`].
    fn stop_signal(&mut self) -> Option<i32> {
        None
    }
}

/// The signal that asks any rank to stop. Collective.
pub(super) fn stop_signal(comm: &Comm, observer: &mut dyn Observer) -> Option<i32> {
    Some(comm.max(observer.stop_signal().unwrap_or(0))).filter(|&signal| signal != 0)
}

/// Reports what a model has that can hardly be meant, and what the program proposes. Collective.
pub(super) fn warn(comm: &Comm, model: &FullModel, observer: &mut dyn Observer) {
    plausibility::warnings(model, comm).iter().for_each(|warning| observer.event(Event::Warning(warning)));
    for ProposedStiffness { contact, stiffness, .. } in model.model.proposed(&model.mesh) {
        observer.event(Event::Proposed { pair: &contact, stiffness });
    }
}

/// Follows nothing.
impl Observer for () {
    fn event(&mut self, _: Event) {}
}
