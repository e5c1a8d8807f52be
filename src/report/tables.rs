//! Tables: CSV for programs, aligned text for people.

use std::io::Write;

use crate::equilibrium::{PairForces, Step};
use crate::stability::{Count, Mode};

/// One mode of one friction value.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeRow {
    /// Friction of the swept pairs.
    pub friction: f64,
    /// Number of the mode in the band, from 1.
    pub mode: usize,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Growth rate, 1/s.
    pub growth_rate: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Backward error.
    pub backward_error: f64,
    /// Whether it grows.
    pub unstable: bool,
}

impl ModeRow {
    /// The row of a mode.
    pub fn new(friction: f64, index: usize, mode: &Mode) -> ModeRow {
        ModeRow {
            friction,
            mode: index + 1,
            frequency: mode.frequency(),
            growth_rate: mode.growth_rate(),
            damping_ratio: mode.damping_ratio(),
            backward_error: mode.backward_error,
            unstable: mode.is_unstable(),
        }
    }
}

/// All modes as CSV: `friction, mode, frequency_hz, growth_rate_per_s, damping_ratio, backward_error, unstable`.
///
/// # Errors
/// The writer's.
pub fn modes(out: &mut dyn Write, rows: &[ModeRow]) -> std::io::Result<()> {
    writeln!(out, "friction,mode,frequency_hz,growth_rate_per_s,damping_ratio,backward_error,unstable")?;
    for row in rows {
        let ModeRow { friction, mode, frequency, growth_rate, damping_ratio, backward_error, unstable } = row;
        writeln!(
            out,
            "{friction},{mode},{frequency:.12e},{growth_rate:.12e},{damping_ratio:.6e},{backward_error:.2e},{}",
            u8::from(*unstable)
        )?;
    }
    Ok(())
}

/// What the contact pairs of one friction value carry.
#[derive(Debug, Clone)]
pub struct PairRow {
    /// Friction of the swept pairs.
    pub friction: f64,
    /// Name of the pair.
    pub pair: String,
    /// What it carries.
    pub forces: PairForces,
}

/// Contact pairs as CSV: counts by status, forces in N, area in m2, pressure in Pa.
///
/// # Errors
/// The writer's.
pub fn pairs(out: &mut dyn Write, rows: &[PairRow]) -> csv::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record([
        "friction",
        "pair",
        "open",
        "stick",
        "slip",
        "normal_force_n",
        "tangential_force_n",
        "closed_area_m2",
        "peak_pressure_pa",
        "peak_force_n",
    ])?;
    for PairRow { friction, pair, forces } in rows {
        let counts = forces.counts;
        let numbers = [forces.normal, forces.tangential, forces.closed_area, forces.peak_pressure, forces.peak_force];
        let mut record = vec![friction.to_string(), pair.clone()];
        record.extend([counts.open, counts.stick, counts.slip].map(|n| n.to_string()));
        record.extend(numbers.map(|x| format!("{x:.12e}")));
        table.write_record(record)?;
    }
    table.flush()?;
    Ok(())
}

/// Newton iterations as CSV.
///
/// # Errors
/// The writer's.
pub fn convergence(out: &mut dyn Write, steps: &[(f64, Step)]) -> csv::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["friction", "step", "iteration", "relative_residual", "open", "stick", "slip", "changes"])?;
    for (friction, step) in steps {
        for (i, it) in step.iterations.iter().enumerate() {
            let counts = [it.counts.open, it.counts.stick, it.counts.slip, it.flips.iter().sum()];
            let mut record = vec![friction.to_string(), step.label.clone(), i.to_string()];
            record.push(format!("{:.3e}", it.residual));
            record.extend(counts.map(|n| n.to_string()));
            table.write_record(record)?;
        }
    }
    table.flush()?;
    Ok(())
}

/// A line a friction value: how many modes, which of them grow.
pub fn sweep(rows: &[ModeRow], counts: &[(f64, Count)]) -> String {
    let mut text = String::from("friction  modes  unstable modes: frequency (growth rate, damping ratio)\n");
    for (friction, count) in counts {
        let own: Vec<&ModeRow> = rows.iter().filter(|row| row.friction == *friction).collect();
        let unstable: Vec<String> = own
            .iter()
            .filter(|row| row.unstable)
            .map(|row| {
                format!("{:.1} Hz ({:+.1} /s, {:.2} %)", row.frequency, row.growth_rate, 100.0 * row.damping_ratio)
            })
            .collect();
        let list = if unstable.is_empty() { "none".into() } else { unstable.join(", ") };
        let doubt = if count.agrees() { "" } else { "  (number of modes not confirmed)" };
        text += &format!("{friction:>8.3}  {:>5}  {list}{doubt}\n", own.len());
    }
    text
}

/// A sentence: does it squeal, where, from which friction on.
pub fn verdict(rows: &[ModeRow]) -> String {
    let first = rows
        .iter()
        .filter(|row| row.unstable)
        .min_by(|a, b| a.friction.total_cmp(&b.friction).then(b.growth_rate.total_cmp(&a.growth_rate)));
    match first {
        Some(row) => {
            let worst = rows
                .iter()
                .filter(|r| r.unstable)
                .max_by(|a, b| a.growth_rate.total_cmp(&b.growth_rate))
                .unwrap_or(row);
            format!(
                "unstable first at friction {}: {:.0} Hz; strongest {:.0} Hz at friction {} ({:+.0} /s)",
                row.friction, row.frequency, worst.frequency, worst.friction, worst.growth_rate
            )
        }
        None => "stable: no mode of the band grows at these frictions".into(),
    }
}
