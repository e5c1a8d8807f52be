//! The sweep as a table for people, and its outcome in a sentence.

use super::text::friction;
use crate::results::{Certificate, ModeData, Results, Status, Value, Verdict};

/// A line a friction value: how many modes, which of them grow.
pub fn sweep(results: &Results) -> String {
    let mut text = String::from("friction  modes  unstable modes: frequency (growth rate, damping ratio)\n");
    for value in results.asked() {
        let unstable: Vec<String> = value
            .modes
            .iter()
            .filter(|mode| mode.unstable)
            .map(|mode| {
                let (hertz, growth, damping) = (mode.frequency(), mode.growth_rate(), 100.0 * mode.damping_ratio());
                format!("{hertz:.1} Hz ({growth:+.1} /s, {damping:.2} %)")
            })
            .collect();
        let list = if unstable.is_empty() { "none".into() } else { unstable.join(", ") };
        let doubt =
            if value.count.is_some_and(|count| !count.agrees()) { "  (number of modes not confirmed)" } else { "" };
        text += &format!("{:>8}  {:>5}  {list}{doubt}\n", friction(value.friction), value.modes.len());
    }
    text
}

/// How well a super-element solves the full model's equations, a line a friction value; empty where that was not asked
/// for.
pub fn certificates(results: &Results) -> String {
    let certificates: Vec<&Certificate> = results.asked().filter_map(|value| value.certificate.as_ref()).collect();
    if certificates.is_empty() {
        return String::new();
    }
    let line = |certificate: &&Certificate| certificate.text(results.about.criterion) + "\n";
    let lines: String = certificates.iter().map(line).collect();
    format!("\ncompared with the full model, by the residuals of its equations:\n{}{lines}", Certificate::HEAD)
}

/// The verdict: a line that says whether it squeals, where, from which friction on, and a line for each doubt.
pub fn verdict(results: &Results) -> String {
    let Verdict { status, reasons } = results.verdict();
    let (first, doubts) = match (status, &reasons[..]) {
        (Status::Unstable, doubts) => (instability(results), doubts),
        (Status::Unknown, [gravest, doubts @ ..]) => (format!("unknown: {gravest}"), doubts),
        (Status::Unknown | Status::Stable, _) => {
            ("stable: no mode of the band is unstable at these friction values".into(), &[][..])
        }
    };
    let doubts: String = doubts.iter().map(|doubt| format!("doubt: {doubt}\n")).collect();
    format!("{first}\n{doubts}criterion of instability: {}\n", results.about.criterion)
}

/// Which mode grows first, and which one most: at the values asked for, else at those in between.
fn instability(results: &Results) -> String {
    let at = |value: &'_ Value| value.modes.iter().any(|mode| mode.unstable);
    let any_asked = results.asked().any(at);
    let values = || results.values.iter().filter(move |value| value.asked || !any_asked);
    let unstable = || values().flat_map(|value| value.modes.iter().filter(|m| m.unstable).map(|m| (value.friction, m)));
    let growth = |(_, mode): &(f64, &ModeData)| mode.growth_rate();
    let first = unstable().min_by(|a, b| a.0.total_cmp(&b.0).then(growth(b).total_cmp(&growth(a))));
    let Some((from, mode)) = first else { return String::new() };
    let (at, worst) = unstable().max_by(|a, b| growth(a).total_cmp(&growth(b))).unwrap_or((from, mode));
    format!(
        "unstable first at friction {from}: {:.0} Hz; strongest {:.0} Hz at friction {at} ({:+.0} /s)",
        mode.frequency(),
        worst.frequency(),
        worst.growth_rate()
    )
}
