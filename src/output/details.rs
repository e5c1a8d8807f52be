//! Equilibria and modes in words, one friction after the other.

use super::explain;
use crate::results::{ModeData, Pair, Results, Value};
use crate::stability::Count;

/// All frictions: Newton steps, contact pairs, checks, modes.
pub fn text(results: &Results) -> String {
    results.values.iter().map(|value| equilibrium(value, &results.about.pairs) + &modes(value)).collect()
}

fn equilibrium(value: &Value, pairs: &[Pair]) -> String {
    let mut text = format!("\nfriction {:.3}\n", value.friction);
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
    let width = pairs.iter().map(|pair| pair.name.len()).max().unwrap_or(4).max(4);
    text += &format!(
        "  {:width$}  {:>6} {:>6} {:>6}  {:>12} {:>14} {:>10}\n",
        "pair", "open", "stick", "slip", "normal N", "tangential N", "peak MPa"
    );
    for (pair, forces) in pairs.iter().zip(&value.pairs) {
        let counts = forces.counts;
        text += &format!(
            "  {:width$}  {:>6} {:>6} {:>6}  {:>12.2} {:>14.2} {:>10.3}\n",
            pair.name,
            counts.open,
            counts.stick,
            counts.slip,
            forces.normal,
            forces.tangential,
            1e-6 * forces.peak_pressure
        );
    }
    value.checks.lines().fold(text, |text, line| text + "  " + line + "\n")
}

fn modes(value: &Value) -> String {
    let Some(Count { below, expected, found }) = value.count else { return String::new() };
    let mut text = format!(
        "  {} modes; below {below:.1} Hz {found} found, Sturm count {expected}\n  mode  frequency Hz  growth 1/s  damping %  backward error\n",
        value.modes.len(),
    );
    for (number, mode) in (1..).zip(&value.modes) {
        text += &line(number, mode);
    }
    for mode in value.modes.iter().filter(|mode| !mode.sources.is_empty()) {
        text += &format!("  {}\n", explain::sentence(value.friction, mode));
    }
    text
}

fn line(number: usize, mode: &ModeData) -> String {
    format!(
        "  {number:>4}  {:>12.3}  {:>+10.3}  {:>9.4}  {:>14.1e}{}\n",
        mode.frequency(),
        mode.growth_rate(),
        100.0 * mode.damping_ratio(),
        mode.backward_error,
        if mode.unstable { "  unstable" } else { "" }
    )
}
