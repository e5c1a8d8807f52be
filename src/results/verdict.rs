//! The one place that decides the verdict of a study: unstable, stable or unknown.
//!
//! The verdict is *stable* only where nothing casts doubt on it: modes were found in the band, their number is
//! confirmed, they were followed everywhere, and contact carries a force at every value. An instability is reported
//! with the doubts beside it.

use std::fmt::{self, Display};

use serde::Serialize;

use crate::stability::Count;

use super::{About, Results, Value};
use crate::equilibrium::PairForces;

/// The verdict of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// A mode is unstable by the criterion.
    Unstable,
    /// No mode is unstable by the criterion, and there is no doubt.
    Stable,
    /// No mode is unstable as far as is known.
    Unknown,
}

/// The verdict, and the doubts about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The answer.
    pub status: Status,
    /// The doubts, the gravest first.
    pub reasons: Vec<Doubt>,
}

/// What casts doubt on the modes found, or on there being no others. Values are those of the friction coefficient.
#[derive(Debug, Clone, PartialEq)]
pub enum Doubt {
    /// The model has neither a load nor an overlap.
    NoLoad,
    /// No sliding contact carries a force at these values.
    NoContact(Vec<f64>),
    /// No element of the model dissipates energy.
    Undamped,
    /// Doubtful properties of the model.
    Implausible(String),
    /// No mode lies in the band, Hz.
    NoModes([f64; 2]),
    /// The study ended early, for this reason.
    Ended(String),
    /// So many values of so many are missing.
    Missing(usize, usize),
    /// The number of modes at a value is not confirmed.
    NotConfirmed(f64, Count),
    /// The equilibria at these values have not converged.
    NotConverged(Vec<f64>),
    /// Modes could not be followed over these intervals.
    NotFollowed(Vec<[f64; 2]>),
}

impl Results {
    /// What the study says.
    pub fn verdict(&self) -> Verdict {
        let reasons = self.doubts();
        let counts = |value: &&Value| !self.about.unloaded && self.has_contact(value);
        let is_unstable = self.values.iter().filter(counts).any(|value| value.modes.iter().any(|mode| mode.unstable));
        let status = match (is_unstable, reasons.is_empty()) {
            (true, _) => Status::Unstable,
            (false, true) => Status::Stable,
            (false, false) => Status::Unknown,
        };
        Verdict { status, reasons }
    }

    fn has_contact(&self, value: &Value) -> bool {
        self.about.has_contact(&value.pairs)
    }

    fn doubts(&self) -> Vec<Doubt> {
        let friction_values = |wanted: &dyn Fn(&Value) -> bool| -> Vec<f64> {
            self.asked().filter(|value| wanted(value)).map(|value| value.friction).collect()
        };
        let open = friction_values(&|value| !self.has_contact(value));
        let not_converged = friction_values(&|value| value.steps.last().is_some_and(|step| !step.converged));
        let (n_asked, n_done) = (self.about.friction_values.len(), self.asked().count());
        let has_modes = n_done == 0 || self.asked().any(|value| !value.modes.is_empty());
        let intervals = self.diagram.as_ref().map_or_else(Vec::new, |diagram| diagram.doubtful.clone());
        let ended = self.failure.iter().map(|failure| Doubt::Ended(failure.reason.clone()));
        let when = |is_so: bool, doubt: Doubt| is_so.then_some(doubt);
        let first = [
            when(self.about.unloaded, Doubt::NoLoad),
            when(!open.is_empty(), Doubt::NoContact(open)),
            when(!has_modes, Doubt::NoModes(self.about.band)),
        ];
        let last = [
            when(n_done < n_asked, Doubt::Missing(n_asked.saturating_sub(n_done), n_asked)),
            when(!not_converged.is_empty(), Doubt::NotConverged(not_converged)),
            when(!intervals.is_empty(), Doubt::NotFollowed(intervals)),
            when(self.about.undamped && n_done > 0, Doubt::Undamped),
        ];
        let implausible = self.about.warnings.iter().cloned().map(Doubt::Implausible);
        let all = first.into_iter().flatten().chain(implausible).chain(ended);
        all.chain(self.unconfirmed()).chain(last.into_iter().flatten()).collect()
    }

    fn unconfirmed(&self) -> impl Iterator<Item = Doubt> {
        let counts = self.asked().filter_map(|value| Some((value.friction, value.count?)));
        counts.filter(|(_, count)| !count.agrees()).map(|(friction, count)| Doubt::NotConfirmed(friction, count))
    }
}

impl About {
    /// Whether a sliding contact carries a force; true where no pair slides.
    pub fn has_contact(&self, pairs: &[PairForces]) -> bool {
        let mut sliding = self.pairs.iter().zip(pairs).filter(|(pair, _)| pair.sliding).peekable();
        sliding.peek().is_none() || sliding.any(|(_, forces)| forces.is_pressed())
    }
}

impl Verdict {
    /// All reasons in one text.
    pub fn reason(&self) -> String {
        self.reasons.iter().map(|reason| format!("{reason}.")).collect::<Vec<_>>().join(" ")
    }
}

/// A sentence without its full stop.
impl Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Doubt::NoLoad => write!(f, "no load presses the contacts together, so that there is no friction"),
            Doubt::NoContact(values) => {
                write!(f, "no sliding contact carries a force at \u{3bc} = {}: the loads close none", list(values))
            }
            Doubt::Undamped => write!(
                f,
                "the model has no damping: stable modes do not decay, so that a stable verdict means nothing. \
                 Give `loss_factor` to the materials, `rayleigh` to the parts, or `damping` to a connector"
            ),
            Doubt::Implausible(what) => write!(f, "{what}"),
            Doubt::NoModes([from, to]) => {
                write!(
                    f,
                    "no mode lies in the band from {from} to {to} Hz: look at the units of the model, or widen the band"
                )
            }
            Doubt::Ended(reason) => write!(f, "the study ended early: {}", reason.trim_end_matches('.')),
            Doubt::Missing(n, of) => write!(f, "the study is not complete: {n} of {of} friction values are missing"),
            Doubt::NotConfirmed(friction, Count { below, expected, found, by }) => write!(
                f,
                "at \u{3bc} = {friction} the number of modes is not confirmed: {found} found below {below:.0} Hz, \
                 {by} {expected}"
            ),
            Doubt::NotConverged(values) => {
                write!(f, "at \u{3bc} = {} the equilibrium has not converged", list(values))
            }
            Doubt::NotFollowed(intervals) => {
                let each = |[low, high]: &[f64; 2]| format!("{low:.4} to {high:.4}");
                let intervals: Vec<String> = intervals.iter().map(each).collect();
                write!(f, "not all modes could be followed from \u{3bc} = {}", shortened(&intervals))
            }
        }
    }
}

fn list(values: &[f64]) -> String {
    shortened(&values.iter().map(f64::to_string).collect::<Vec<_>>())
}

/// The first items, and how many more there are.
fn shortened(items: &[String]) -> String {
    const SHOWN: usize = 4;
    match items.len() {
        0..=SHOWN => items.join(", "),
        n => format!("{} and {} more", items[..SHOWN].join(", "), n - SHOWN),
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::super::{About, Failure, ModeData, Pair};
    use super::*;
    use crate::equilibrium::{Counts, PairForces, Step};
    use crate::stability::CountedBy;
    use crate::tracking::Diagram;

    fn mode(unstable: bool) -> ModeData {
        let lambda = Complex64::new(if unstable { 5.0 } else { -5.0 }, 6e3);
        ModeData { lambda, unstable, ..ModeData::default() }
    }

    /// A study of one value at which contact carries a force.
    fn study(unstable: bool) -> Results {
        let pairs = vec![Pair { sliding: true, ..Pair::default() }];
        let about = About { band: [0.0, 6000.0], friction_values: vec![0.4], pairs, ..About::default() };
        let forces =
            PairForces { counts: Counts { slip: 9, ..Counts::default() }, normal: 1000.0, ..PairForces::default() };
        let value =
            Value { friction: 0.4, asked: true, pairs: vec![forces], modes: vec![mode(unstable)], ..Value::default() };
        Results { about, values: vec![value], ..Results::default() }
    }

    /// The status and the only reason of a study that was changed.
    #[track_caller]
    fn message(change: impl FnOnce(&mut Results), unstable: bool) -> (Status, String) {
        let mut results = study(unstable);
        change(&mut results);
        let verdict = results.verdict();
        assert_eq!(verdict.reasons.len(), 1, "{verdict:?}");
        (verdict.status, verdict.reason())
    }

    #[test]
    fn without_doubt_it_is_stable_or_unstable() {
        for (unstable, status) in [(false, Status::Stable), (true, Status::Unstable)] {
            assert_eq!(study(unstable).verdict(), Verdict { status, reasons: vec![] });
        }
    }

    #[test]
    fn what_rounding_alone_closes_shows_nothing() {
        for unstable in [false, true] {
            let (status, reason) = message(|results| results.values[0].pairs[0].rounding = 2000.0, unstable);
            assert_eq!(status, Status::Unknown);
            assert!(reason.starts_with("no sliding contact carries a force at \u{3bc} = 0.4"), "{reason}");
            let (status, reason) = message(|results| results.about.unloaded = true, unstable);
            assert_eq!(status, Status::Unknown);
            assert!(reason.starts_with("no load presses"), "{reason}");
        }
    }

    #[test]
    fn what_was_not_looked_at_is_unknown_and_an_instability_stays_one() {
        let step = Step { label: String::new(), converged: false, iterations: vec![] };
        type Change<'a> = (&'a str, &'a dyn Fn(&mut Results));
        let changes: [Change; 8] = [
            ("the model has no damping", &|results| results.about.undamped = true),
            ("no mode lies in the band from 0 to 6000 Hz", &|results| results.values[0].modes.clear()),
            ("young is 210", &|results| results.about.warnings.push("young is 210".into())),
            ("ended early: out of luck.", &|results| {
                results.failure = Some(Failure { reason: "out of luck.".into(), ..Failure::default() });
            }),
            ("1 of 2 friction values are missing", &|results| results.about.friction_values.push(0.5)),
            ("2 found below 6000 Hz, Sturm count 3", &|results| {
                results.values[0].count =
                    Some(Count { below: 6000.0, expected: 3, found: 2, by: CountedBy::SturmCount });
            }),
            ("has not converged", &|results| results.values[0].steps.push(step.clone())),
            ("could be followed from \u{3bc} = 0.1000 to 0.2000", &|results| {
                results.diagram = Some(Diagram { doubtful: vec![[0.1, 0.2]], ..Diagram::default() });
            }),
        ];
        for (reason, change) in changes {
            let (status, text) = message(change, false);
            assert!(status == Status::Unknown && text.contains(reason), "{status:?} {text}");
            let no_modes = reason.starts_with("no mode");
            assert_eq!(message(change, true).0, if no_modes { Status::Unknown } else { Status::Unstable });
        }
    }
}
