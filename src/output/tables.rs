//! Tables: CSV for programs, aligned text for people.

use std::io::Write;

use crate::Result;
use crate::results::{ModeData, Results, Status, Value, Verdict};

use super::folder::Folder;

/// Writes a CSV file of a folder.
///
/// # Errors
/// The system's, with the file's path.
pub fn csv_file(folder: &Folder, name: &str, body: impl FnOnce(&mut dyn Write) -> csv::Result<()>) -> Result<()> {
    folder.write(name, |out| body(out).map_err(std::io::Error::other))
}

/// All modes as CSV: `friction, mode, frequency_hz, growth_rate_per_s, damping_ratio, backward_error, unstable`.
///
/// # Errors
/// The writer's.
pub fn modes(out: &mut dyn Write, results: &Results) -> std::io::Result<()> {
    writeln!(out, "friction,mode,frequency_hz,growth_rate_per_s,damping_ratio,backward_error,unstable")?;
    for (friction, number, mode) in results.modes() {
        let (hertz, growth, damping) = (mode.frequency(), mode.growth_rate(), mode.damping_ratio());
        let (error, unstable) = (mode.backward_error, u8::from(mode.unstable));
        writeln!(out, "{friction},{number},{hertz:.12e},{growth:.12e},{damping:.6e},{error:.2e},{unstable}")?;
    }
    Ok(())
}

/// Contact pairs as CSV: counts by status, forces in N, area in m2, pressure in Pa.
///
/// # Errors
/// The writer's.
pub fn pairs(out: &mut dyn Write, results: &Results) -> csv::Result<()> {
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
    let names = || results.about.pairs.iter().map(|pair| &pair.name);
    let rows = results.asked().flat_map(|value| names().zip(&value.pairs).map(|row| (value.friction, row)));
    for (friction, (pair, forces)) in rows {
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

/// Newton iterations as CSV, those of a failure too.
///
/// # Errors
/// The writer's.
pub fn convergence(out: &mut dyn Write, results: &Results) -> csv::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["friction", "step", "iteration", "relative_residual", "open", "stick", "slip", "changes"])?;
    let done = results.values.iter().map(|value| (value.friction, &value.steps));
    let failed = results.failure.iter().filter_map(|failure| Some((failure.friction?, &failure.steps)));
    for (friction, step) in
        done.chain(failed).flat_map(|(friction, steps)| steps.iter().map(move |step| (friction, step)))
    {
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
        text += &format!("{:>8.3}  {:>5}  {list}{doubt}\n", value.friction, value.modes.len());
    }
    text
}

/// The verdict: a line that says whether it squeals, where, from which friction on, and a line for each doubt.
pub fn verdict(results: &Results) -> String {
    let Verdict { status, reasons } = results.verdict();
    let (first, doubts) = match (status, &reasons[..]) {
        (Status::Unstable, doubts) => (instability(results), doubts),
        (Status::Unknown, [gravest, doubts @ ..]) => (format!("unknown: {gravest}"), doubts),
        (Status::Unknown | Status::Stable, _) => {
            ("stable: no mode of the band grows at these frictions".into(), &[][..])
        }
    };
    let doubts: String = doubts.iter().map(|doubt| format!("doubt: {doubt}\n")).collect();
    format!("{first}\n{doubts}")
}

/// Which mode grows first, and which one most: at the values asked for, else at those in between.
fn instability(results: &Results) -> String {
    let at = |value: &'_ Value| value.modes.iter().any(|mode| mode.unstable);
    let any_asked = results.asked().any(at);
    let values = || results.values.iter().filter(move |value| value.asked || !any_asked);
    let unstable = || values().flat_map(|value| value.modes.iter().filter(|m| m.unstable).map(|m| (value.friction, m)));
    let growth = |(_, mode): &(f64, &ModeData)| mode.growth_rate();
    let first = unstable().min_by(|a, b| a.0.total_cmp(&b.0).then(growth(b).total_cmp(&growth(a))));
    let Some((friction, mode)) = first else { return String::new() };
    let (at, worst) = unstable().max_by(|a, b| growth(a).total_cmp(&growth(b))).unwrap_or((friction, mode));
    format!(
        "unstable first at friction {friction}: {:.0} Hz; strongest {:.0} Hz at friction {at} ({:+.0} /s)",
        mode.frequency(),
        worst.frequency(),
        worst.growth_rate()
    )
}
