//! Equilibria and modes in words, one friction value after the other.

use super::explain;
use super::text::{aligned, friction};
use crate::equilibrium::{Counts, PairForces};
use crate::results::{ModeData, Pair, Results, Value};
use crate::stability::Count;

/// All friction values: Newton steps, contact pairs, checks, modes.
pub fn text(results: &Results) -> String {
    results.values.iter().map(|value| equilibrium(value, &results.about.pairs) + &modes(value)).collect()
}

fn equilibrium(value: &Value, pairs: &[Pair]) -> String {
    let mut text = format!("\nfriction {}\n", friction(value.friction));
    for step in &value.steps {
        let last = step.iterations.last().expect("a step has its start");
        text += &format!(
            "  {}: {} iterations, residual {:.1e}, {} open, {} sticking, {} slipping\n",
            step.label,
            step.iterations.len() - 1,
            last.residual,
            last.counts.open,
            last.counts.stick,
            last.counts.slip
        );
    }
    let row = |(pair, forces): (&Pair, &PairForces)| {
        let (Counts { open, stick, slip }, name) = (forces.counts, &pair.name);
        let (normal, tangential, peak) = (forces.normal, forces.tangential, 1e-6 * forces.peak_pressure);
        format!("  {name}\t{open}\t{stick}\t{slip}\t{normal:.2}\t{tangential:.2}\t{peak:.3}")
    };
    let rows = pairs.iter().zip(&value.pairs).map(row);
    text += &aligned("  pair\topen\tstick\tslip\tnormal N\ttangential N\tpeak MPa", rows);
    value.checks.lines().fold(text, |text, line| text + "  " + line + "\n")
}

fn modes(value: &Value) -> String {
    let Some(Count { below, expected, found, by }) = value.count else { return String::new() };
    let row = |(number, mode): (usize, &ModeData)| {
        let (hertz, growth, damping) = (mode.frequency(), mode.growth_rate(), 100.0 * mode.damping_ratio());
        let (error, mark) = (mode.backward_error, if mode.unstable { "unstable" } else { "" });
        format!("  {number}\t{hertz:.3}\t{growth:+.3}\t{damping:.4}\t{error:.1e}\t{mark}")
    };
    let mut text = format!("  {} modes; below {below:.1} Hz {found} found, {by} {expected}\n", value.modes.len());
    let rows = (1..).zip(&value.modes).map(row);
    text += &aligned("  mode\tfrequency Hz\tgrowth 1/s\tdamping %\tbackward error\t", rows);
    for mode in value.modes.iter().filter(|mode| !mode.sources.is_empty()) {
        text += &format!("  {}\n", explain::sentence(value.friction, mode));
    }
    text
}
