//! What explains unstable modes, as a table and in a sentence.

use std::f64::consts::TAU;
use std::io::Write;

use crate::results::{Kind, Source};
use crate::results::{ModeData, Results};

/// The word for a kind.
pub fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Part => "part",
        Kind::Connector => "connector",
        Kind::Contact => "contact",
    }
}

/// Shares and sensitivities as CSV, a row for each mode and source: shares of kinetic and strain energy; what it feeds in and takes out, as
/// contributions to the growth rate (1/s); and how growth rate (1/s) and frequency (Hz) follow its friction (by 1) and a factor on its
/// damping, stiffness and mass.
///
/// # Errors
/// The writer's.
pub fn sources(out: &mut dyn Write, results: &Results) -> csv::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let fixed = ["friction", "mode", "frequency_hz", "kind", "name"];
    let shares = ["kinetic_share", "strain_share", "fed_per_s", "damped_per_s"];
    let slopes = ["friction", "damping", "stiffness", "mass"]
        .map(|what| [format!("growth_per_{what}"), format!("frequency_per_{what}")]);
    let names = fixed.into_iter().chain(shares).map(String::from).chain(slopes.into_iter().flatten());
    table.write_record(names)?;
    for (friction, number, mode) in results.modes() {
        for source in &mode.sources {
            let mut record = vec![friction.to_string(), number.to_string(), format!("{:.9e}", mode.frequency())];
            record.extend([kind(source.kind).to_owned(), source.name.clone()]);
            let share = source.share;
            record.extend([share.kinetic, share.strain, share.fed, share.damped].map(|x| format!("{x:.9e}")));
            let sensitivity = source.sensitivity;
            let derivatives = [
                source.friction,
                sensitivity.map(|s| s.damping),
                sensitivity.map(|s| s.stiffness),
                sensitivity.map(|s| s.mass),
            ];
            for derivative in derivatives {
                let text = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.9e}"));
                record.extend([text(derivative.map(|z| z.re)), text(derivative.map(|z| z.im / TAU))]);
            }
            table.write_record(record)?;
        }
    }
    table.flush()?;
    Ok(())
}

/// A line: what feeds a mode, what damps it, and where it moves, largest first.
pub fn sentence(friction: f64, mode: &ModeData) -> String {
    let sources = &mode.sources;
    format!(
        "{:.1} Hz at friction {friction}: fed by {}; damped by {}; moves {}",
        mode.frequency(),
        largest(sources, |source| source.share.fed.max(0.0)),
        largest(sources, |source| -source.share.damped),
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
    use num_complex::Complex64;

    use super::*;
    use crate::results::Value;
    use crate::stability::Share;

    fn source(name: &str, fed: f64, damped: f64, kinetic: f64) -> Source {
        let share = Share { kinetic, strain: 0.5, fed, damped };
        Source { kind: Kind::Contact, name: name.into(), share, sensitivity: None, friction: None }
    }

    #[test]
    fn the_largest_sources_are_named_and_what_takes_out_does_not_feed() {
        let sources = vec![source("a / b", 30.0, 0.0, 0.2), source("c", 10.0, -2.0, 0.8), source("d", -5.0, -6.0, 0.0)];
        let mode = ModeData { lambda: Complex64::new(8.0, TAU * 1786.04), sources, ..ModeData::default() };
        assert_eq!(
            sentence(0.5, &mode),
            "1786.0 Hz at friction 0.5: fed by a / b 75 %, c 25 %; damped by d 75 %, c 25 %; moves c 80 %, a / b 20 %"
        );
        let value = Value { friction: 0.5, asked: true, modes: vec![mode], ..Value::default() };
        let mut out = Vec::new();
        super::sources(&mut out, &Results { values: vec![value], ..Results::default() }).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert_eq!(text.lines().count(), 4);
        assert!(text.lines().all(|line| line.split(',').count() == 17), "{text}");
    }
}
