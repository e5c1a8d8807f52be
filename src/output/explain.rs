//! What explains unstable modes, in a sentence.

use std::f64::consts::TAU;

use crate::results::{Kind, ModeData, Pair, Source};

/// A line: the sources of a mode's energy input, dissipation and kinetic energy, largest first.
pub fn sentence(friction: f64, mode: &ModeData) -> String {
    let sources = &mode.sources;
    format!(
        "{:.1} Hz at friction {friction}: energy input by {}; dissipation by {}; kinetic energy in {}",
        mode.frequency(),
        largest(sources, |source| source.share.energy_input.max(0.0)),
        largest(sources, |source| -source.share.dissipation),
        largest(sources, |source| source.share.kinetic),
    )
}

/// Relative change of a proposed contact stiffness.
const CHANGE: f64 = 0.1;

/// What a change of each proposed contact stiffness does to unstable modes at a friction value, to first order.
pub fn of_proposed(pairs: &[Pair], friction: f64, modes: &[&ModeData]) -> String {
    let sentence = |pair: &Pair| {
        let stiffness = pair.proposed_stiffness?;
        let effects: Vec<String> = modes.iter().filter_map(|mode| effect(&pair.name, mode)).collect();
        (!effects.is_empty()).then(|| {
            format!(
                "the contact stiffness of {} ({stiffness:.3e} N/m3) was proposed: to first order {:+.0} % changes, at \
                 friction {friction}, {}. Compare a run with another stiffness\n",
                pair.name,
                100.0 * CHANGE,
                effects.join(", ")
            )
        })
    };
    pairs.iter().filter_map(sentence).collect()
}

/// What it does to a mode; nothing where that is not known.
fn effect(contact: &str, mode: &ModeData) -> Option<String> {
    let source = mode.sources.iter().find(|source| source.kind == Kind::Contact && source.name == contact)?;
    let change = CHANGE * source.sensitivity?.stiffness;
    let (growth, hertz) = (change.re, change.im / TAU);
    Some(format!("the mode at {:.1} Hz by {growth:+.3} /s and {hertz:+.2} Hz", mode.frequency()))
}

/// The sources with most of something, in percent of its sum.
pub fn largest(sources: &[Source], of: impl Fn(&Source) -> f64) -> String {
    const SHOWN: usize = 3;
    let total: f64 = sources.iter().map(&of).sum();
    let mut shares: Vec<(&str, f64)> = sources.iter().map(|s| (s.name.as_str(), 100.0 * of(s) / total)).collect();
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let worth: Vec<String> = shares
        .iter()
        .take(SHOWN)
        .filter(|(_, share)| *share >= 1.0)
        .map(|(name, share)| format!("{name} {share:.0} %"))
        .collect();
    if worth.is_empty() { "nothing".into() } else { worth.join(", ") }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::stability::{Sensitivity, Share};

    fn source(name: &str, energy_input: f64, dissipation: f64, kinetic: f64) -> Source {
        let share = Share { kinetic, strain: 0.5, energy_input, dissipation };
        Source { kind: Kind::Contact, name: name.into(), share, sensitivity: None, friction: None }
    }

    #[test]
    fn the_largest_sources_are_named_and_what_takes_out_does_not_feed() {
        let sources = vec![source("a / b", 30.0, 0.0, 0.2), source("c", 10.0, -2.0, 0.8), source("d", -5.0, -6.0, 0.0)];
        let mode = ModeData { lambda: Complex64::new(8.0, TAU * 1786.04), sources, ..ModeData::default() };
        assert_eq!(
            sentence(0.5, &mode),
            "1786.0 Hz at friction 0.5: energy input by a / b 75 %, c 25 %; dissipation by d 75 %, c 25 %; kinetic energy in c 80 %, a / b 20 %"
        );
    }

    #[test]
    fn a_proposed_stiffness_has_its_influence_on_each_mode() {
        let mut own = source("a / b", 30.0, 0.0, 0.2);
        let zero = Complex64::ZERO;
        own.sensitivity = Some(Sensitivity { mass: zero, damping: zero, stiffness: Complex64::new(-20.0, TAU * 50.0) });
        let mode = ModeData { lambda: Complex64::new(8.0, TAU * 1784.0), sources: vec![own], ..ModeData::default() };
        let pair = |proposed_stiffness| Pair { name: "a / b".into(), proposed_stiffness, ..Pair::default() };
        let (other, friction) = (ModeData::default(), 0.5);
        let modes = [&mode, &other];
        assert_eq!(
            of_proposed(&[pair(Some(1.3e13))], friction, &modes),
            "the contact stiffness of a / b (1.300e13 N/m3) was proposed: to first order +10 % changes, at friction 0.5, \
             the mode at 1784.0 Hz by -2.000 /s and +5.00 Hz. Compare a run with another stiffness\n"
        );
        assert_eq!(of_proposed(&[pair(None)], friction, &modes), "");
    }
}
