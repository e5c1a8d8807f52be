//! What explains unstable modes, in a sentence.

use crate::results::{ModeData, Source};

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
    use std::f64::consts::TAU;

    use num_complex::Complex64;

    use super::*;
    use crate::results::Kind;
    use crate::stability::Share;

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
}
