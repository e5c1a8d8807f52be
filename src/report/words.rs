//! The answer in words: does it squeal, where, by which mechanism, and which changes lower the growth rate most.

use std::f64::consts::TAU;

use super::findings::{End, Findings, Instability, Range};
use crate::output::explain::largest;
use crate::results::{Kind, Source, Status};

/// The text about one instability.
#[derive(Debug)]
pub struct Answer {
    /// The frequency, the friction values, and the fastest growth.
    pub range: String,
    /// Where the kinetic energy is.
    pub moves: String,
    /// Coalescence of two modes, or loss of stability without it.
    pub mechanism: String,
    /// Sources of the energy input.
    pub input: String,
    /// Sources of the dissipation.
    pub dissipation: String,
    /// The changes that lower the growth rate most, to first order, the largest reduction first.
    pub remedies: Vec<String>,
}

/// Instabilities named in the first sentence.
const NAMED: usize = 3;

/// Does it squeal: one sentence.
pub fn headline(findings: &Findings) -> String {
    let (found, verdict) = (&findings.instabilities, findings.results.verdict());
    if findings.asked.is_empty() {
        return "No friction value has been analysed yet.".into();
    }
    match (verdict.status, &verdict.reasons[..]) {
        (Status::Stable, _) => return quiet(findings),
        (Status::Unknown, [gravest, ..]) => return format!("Unknown: {gravest}."),
        (Status::Unknown | Status::Unstable, _) => {}
    }
    let named: Vec<String> = found.iter().take(NAMED).map(|one| squeals(findings, one)).collect();
    let more = match found.len().saturating_sub(NAMED) {
        0 => String::new(),
        1 => ", and at one more frequency".into(),
        n => format!(", and at {n} more frequencies"),
    };
    format!("Squeals at {}{more}.", listed(&named, if more.is_empty() { ", and at " } else { ", at " }))
}

fn quiet(findings: &Findings) -> String {
    let values: Vec<_> = findings.asked.iter().map(|&v| &findings.results.values[v]).collect();
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return String::new() };
    let n = values.iter().map(|value| value.modes.len()).max().unwrap_or(0);
    let [from, to] = findings.results.about.band.map(frequency);
    let values = interval(first.friction, last.friction);
    format!("Quiet: all {n} modes from {from} to {to} are stable {values}.")
}

/// `2.40 kHz above mu = 0.27`.
fn squeals(findings: &Findings, one: &Instability) -> String {
    let all = [findings.asked.first(), findings.asked.last()].map(|v| v.map(|&v| findings.results.values[v].friction));
    let ranges: Vec<String> = one.ranges.iter().map(|range| reach(range, all)).collect();
    format!("{} {}", frequency(findings.mode(one.worst).frequency()), listed(&ranges, " and "))
}

/// The friction values of a range.
fn reach(range: &Range, all: [Option<f64>; 2]) -> String {
    let [from, to] = [range.from.value(), range.to.value()];
    match (range.from, range.to) {
        (End::Edge(_), End::Edge(_)) if from < to && all == [Some(from), Some(to)] => {
            format!("at all values from \u{3bc} = {from} to {to}")
        }
        (End::Hopf(_), End::Edge(_)) => format!("above \u{3bc} = {from:.2}"),
        (End::Edge(_), End::Hopf(_)) => format!("below \u{3bc} = {to:.2}"),
        (End::Hopf(_), End::Hopf(_)) => format!("between \u{3bc} = {from:.2} and {to:.2}"),
        (End::Seen(_, before), End::Edge(_)) => format!("from \u{3bc} = {from} (stable at {before})"),
        _ => interval(from, to),
    }
}

fn interval(from: f64, to: f64) -> String {
    if from == to { format!("at \u{3bc} = {from}") } else { format!("from \u{3bc} = {from} to {to}") }
}

/// The answer for an instability, at the friction value where it grows fastest.
pub fn answer(findings: &Findings, one: &Instability) -> Answer {
    let mode = findings.mode(one.worst);
    let known = |words: String| if mode.sources.is_empty() { String::new() } else { words };
    let range = format!(
        "{}; largest growth rate at \u{3bc} = {}: {}\u{a0}/s (damping ratio {}\u{a0}%)",
        squeals(findings, one),
        findings.friction(one.worst),
        signed(format!("{:+.0}", mode.growth_rate())),
        signed(format!("{:.2}", 100.0 * mode.damping_ratio()))
    );
    Answer {
        range,
        moves: known(largest(&mode.sources, |source| source.share.kinetic)),
        mechanism: mechanism(findings, one),
        input: known(largest(&mode.sources, |source| source.share.energy_input.max(0.0))),
        dissipation: known(largest(&mode.sources, |source| -source.share.dissipation)),
        remedies: remedies(&mode.sources),
    }
}

/// The two modes that coalesce.
fn mechanism(findings: &Findings, one: &Instability) -> String {
    let Some(own) = one.branch else { return String::new() };
    let start = |b: usize| {
        let point = &findings.branches()[b].points[0];
        format!("{:.0} Hz", point.lambda.im / TAU)
    };
    let first = findings.branches()[own].points[0].value;
    match findings.onset(one) {
        Some(hopf) => match hopf.partner {
            Some(partner) => format!(
                "the modes at {} and {} (at \u{3bc} = {first}) coalesce at {} and \u{3bc} = {:.3}",
                start(own),
                start(partner.branch),
                frequency(hopf.omega / TAU),
                hopf.value
            ),
            None => format!(
                "the mode at {} (at \u{3bc} = {first}) loses stability without coalescence at \u{3bc} = {:.3}",
                start(own),
                hopf.value
            ),
        },
        None => "it is unstable from the first friction value, so its partner is unknown".into(),
    }
}

/// Relative change of stiffness, damping or mass in a remedy.
const CHANGE: f64 = 0.1;
/// Reduction of a friction coefficient in a remedy.
const LESS_FRICTION: f64 = 0.05;
/// Number of remedies in an answer.
const N_REMEDIES: usize = 4;
/// Remedies with less than this fraction of the largest reduction are left out.
const LEAST_EFFECT: f64 = 0.02;

/// The changes that lower the growth rate most, to first order.
fn remedies(sources: &[Source]) -> Vec<String> {
    let mut all: Vec<(f64, String)> = sources.iter().flat_map(changes).filter(|(effect, _)| *effect < 0.0).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = all.first().map_or(0.0, |(effect, _)| *effect);
    all.retain(|(effect, _)| *effect <= LEAST_EFFECT * best);
    all.iter().take(N_REMEDIES).map(|(effect, what)| format!("{what}: {} /s", signed(three(*effect)))).collect()
}

/// Changes of a source, each with its change of the growth rate, 1/s.
fn changes(source: &Source) -> Vec<(f64, String)> {
    let name = &source.name;
    let mut all = Vec::new();
    if let Some(s) = source.sensitivity.filter(|_| !source.kind.is_fixed()) {
        let percent = 100.0 * CHANGE;
        let stiffer = sign(s.stiffness.re < 0.0);
        all.push((-CHANGE * s.stiffness.re.abs(), format!("stiffness of {name} {stiffer}{percent} %")));
        all.push((CHANGE * s.damping.re, format!("damping of {name} +{percent} %")));
        if matches!(source.kind, Kind::Part | Kind::Mass) {
            let heavier = sign(s.mass.re < 0.0);
            all.push((-CHANGE * s.mass.re.abs(), format!("mass of {name} {heavier}{percent} %")));
        }
    }
    all.extend(
        source.friction.map(|slope| {
            (-LESS_FRICTION * slope.re, format!("friction coefficient of {name} \u{2212}{LESS_FRICTION}"))
        }),
    );
    all
}

/// Whatever limits the answer's validity.
pub fn cautions(findings: &Findings) -> Vec<String> {
    let results = findings.results;
    let mut all: Vec<String> = results.verdict().reasons.iter().map(|doubt| sentence(&doubt.to_string())).collect();
    if results.diagram.is_none() && findings.asked.len() > 1 && !findings.instabilities.is_empty() {
        all.push(
            "Modes were not followed over friction: instabilities are distinguished by their frequency alone.".into(),
        );
    }
    all
}

/// A capital letter and a full stop.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

/// Three digits in Hz or kHz.
pub fn frequency(hertz: f64) -> String {
    let (value, unit) = if hertz < 999.5 { (hertz, "Hz") } else { (hertz / 1000.0, "kHz") };
    let decimals = if unit == "Hz" || value >= 99.95 {
        0
    } else if value >= 9.995 {
        1
    } else {
        2
    };
    format!("{value:.decimals$} {unit}")
}

/// The sign of an increase or a decrease.
fn sign(is_increase: bool) -> char {
    if is_increase { '+' } else { '\u{2212}' }
}

/// Keeps a value of mu on one line.
pub fn unbroken(text: &str) -> String {
    text.replace("\u{3bc} = ", "\u{3bc}\u{a0}=\u{a0}")
}

/// A number with a true minus sign.
fn signed(number: String) -> String {
    number.replace('-', "\u{2212}")
}

/// A small number with a digit more than a large one.
fn three(x: f64) -> String {
    if x.abs() < 9.95 { format!("{x:+.1}") } else { format!("{x:+.0}") }
}

/// `a, b` and a last separator.
fn listed(items: &[String], last: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., end] => format!("{}{last}{end}", first.join(", at ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Results;
    use crate::results::testing;

    #[test]
    fn the_first_sentence_has_frequencies_and_friction_values() {
        let results = testing::results();
        let sentence = headline(&Findings::new(&results));
        assert_eq!(
            sentence,
            "Squeals at 2.40 kHz above \u{3bc} = 0.27, and at 3.70 kHz between \u{3bc} = 0.19 and 0.56."
        );
        let alone = Results { diagram: None, ..results.clone() };
        let sentence = headline(&Findings::new(&alone));
        assert_eq!(
            sentence,
            "Squeals at 2.40 kHz from \u{3bc} = 0.3 (stable at 0.2), and at 3.70 kHz from \u{3bc} = 0.2 to 0.5."
        );
        let mut one = alone.clone();
        one.values.retain(|value| value.friction == 0.5);
        one.about.friction_values = vec![0.5];
        assert!(headline(&Findings::new(&one)).starts_with("Squeals at 2.40 kHz at \u{3bc} = 0.5, and at"));
        one.values[0].modes.retain(|mode| !mode.unstable);
        assert_eq!(
            headline(&Findings::new(&one)),
            "Quiet: all 6 modes from 0 Hz to 6.00 kHz are stable at \u{3bc} = 0.5."
        );
    }

    #[test]
    fn an_answer_names_partner_parts_contacts_and_remedies() {
        let results = testing::results();
        let findings = Findings::new(&results);
        let answers = findings.instabilities.iter().map(|one| format!("{:#?}\n", answer(&findings, one)));
        insta::assert_snapshot!(answers.collect::<String>());
    }

    #[test]
    fn penalties_are_no_remedies_and_masses_are() {
        let results = testing::results();
        let mut sources = results.values.iter().flat_map(|value| &value.modes).flat_map(|mode| &mode.sources);
        let part = sources.find(|source| source.kind == Kind::Part && source.sensitivity.is_some()).unwrap();
        let n_changes = |kind| changes(&Source { kind, ..part.clone() }).len();
        assert_eq!([Kind::Part, Kind::Mass, Kind::Connector].map(n_changes), [3, 3, 2]);
        assert_eq!([Kind::Tie, Kind::Rigid, Kind::Equation, Kind::Rest].map(n_changes), [0, 0, 0, 0]);
    }

    #[test]
    fn cautions_come_with_doubt_only() {
        let mut results = testing::results();
        assert_eq!(cautions(&Findings::new(&results)), Vec::<String>::new());
        results.values[3].count.as_mut().unwrap().found -= 1;
        results.values[4].steps[0].converged = false;
        results.diagram.as_mut().unwrap().doubtful.push([0.1, 0.2]);
        results.about.friction_values.push(0.9);
        let followed = cautions(&Findings::new(&results));
        results.diagram = None;
        insta::assert_snapshot!(
            [followed, cautions(&Findings::new(&results))].map(|list| list.join("\n")).join("\n\n")
        );
    }
}
