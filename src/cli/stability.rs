//! `squeal stability`: complex modes for one friction or a sweep.

use std::time::Instant;

use crate::Result;
use crate::petsc::{Comm, ORDERING};
use crate::report::tables::{self, ModeRow};
use crate::stability::Count;
use crate::sweep::{Brake, Sweep};

use super::Run;
use super::progress::Progress;
use super::results;
use super::statics::{Record, save_last, say};

pub fn run(comm: &Comm, run: &Run, band: Option<[f64; 2]>) -> Result<()> {
    let start = Instant::now();
    let brake = Brake::read(comm, &run.model)?;
    brake.require_held()?;
    let frictions = brake.frictions(run.friction.as_ref().map(|list| list.0.as_slice()))?;
    let band = band.unwrap_or(brake.model.band);
    let folder = results::folder(comm, run, "stability")?;
    let progress = Progress::new(comm, frictions.len(), run.verbose);
    progress.say("assembling");
    let families = brake.families()?;
    let system = brake.assemble(comm, &families)?;
    let mut sweep = Sweep::new(&system, &brake.interface)?;
    let (mut modes, mut counts, mut record) = (Vec::new(), Vec::new(), Record::default());
    let mut failure = None;
    for &friction in &frictions {
        let outcome = sweep.equilibrium(friction, &mut |event| say(&progress, &event));
        let mut equilibrium = match outcome {
            Ok(equilibrium) => equilibrium,
            Err(error) => {
                record.add_steps(friction, sweep.path().steps());
                failure = Some(save_last(error, comm, &brake, &system, &sweep, folder.as_ref())?);
                break;
            }
        };
        record.add(&brake, &families, &system, &mut equilibrium, folder.as_ref())?;
        let found = sweep.modes(&equilibrium, band, &mut |event| say(&progress, &event))?;
        for (i, mode) in found.modes.iter().enumerate().filter(|(_, mode)| mode.is_unstable()) {
            results::write_mode(folder.as_ref(), &brake, &system, friction, (i + 1, mode))?;
        }
        let rows: Vec<ModeRow> =
            found.modes.iter().enumerate().map(|(i, mode)| ModeRow::new(friction, i, mode)).collect();
        record.text += &modes_text(&rows, &found.count, found.n_solves);
        let n_unstable = rows.iter().filter(|row| row.unstable).count();
        modes.extend(rows);
        counts.push((friction, found.count));
        progress.advance(&format!("friction {friction:.3}: {} modes, {n_unstable} unstable", found.modes.len()));
    }
    progress.finish();
    if let Some(folder) = folder {
        let place = run.folder("stability");
        let mut summary = format!("{}: complex modes {}-{} Hz\n\n", brake.model.title, band[0], band[1]);
        if !counts.is_empty() {
            summary += &tables::sweep(&modes, &counts);
            summary += &format!("\n{}\n", tables::verdict(&modes));
        }
        summary += &costs_text(&sweep, start.elapsed().as_secs_f64(), comm.size());
        let any_unstable = modes.iter().any(|row| row.unstable);
        summary += &files_text(&place.display().to_string(), !counts.is_empty(), any_unstable);
        folder.write("modes.csv", |out| tables::modes(out, &modes))?;
        record.write(&folder)?;
        folder.write("details.txt", |out| out.write_all(record.text.as_bytes()))?;
        results::write_summary(&folder, &summary, failure.as_ref())?;
        folder.finish()?;
        super::tell(&summary)?;
    }
    failure.map_or(Ok(()), Err)
}

/// The modes of one friction value, for people.
fn modes_text(rows: &[ModeRow], count: &Count, n_solves: usize) -> String {
    let mut text = format!(
        "  {} modes; below {:.1} Hz {} found, {} by inertia; {n_solves} solves\n  mode  frequency Hz  growth 1/s  damping %  backward error\n",
        rows.len(),
        count.below,
        count.found,
        count.expected
    );
    for row in rows {
        let mark = if row.unstable { "  unstable" } else { "" };
        text += &format!(
            "  {:>4}  {:>12.3}  {:>+10.3}  {:>9.4}  {:>14.1e}{mark}\n",
            row.mode,
            row.frequency,
            row.growth_rate,
            100.0 * row.damping_ratio,
            row.backward_error
        );
    }
    text
}

/// What the run cost: seconds of its stages, and each factor.
fn costs_text(sweep: &Sweep, seconds: f64, ranks: usize) -> String {
    let [equilibria, modes] = sweep.seconds();
    let mut text = format!(
        "\n{seconds:.1} s on {ranks} rank{}: equilibria {equilibria:.1} s, modes {modes:.1} s; {} iterations with a neighbour's factor\n",
        if ranks == 1 { "" } else { "s" },
        sweep.n_iterations()
    );
    let names = ["equilibrium LU", "modes LU", "modes LDL^T"];
    for (name, cost) in names.iter().zip(&sweep.costs()).filter(|(_, cost)| cost.n_factorisations > 0) {
        text += &format!(
            "{name}: {} analysis {:.1} s, {} factorisations {:.1} s, {:.0} M entries, {:.0} MB, ordering {}\n",
            cost.n_analyses,
            cost.analysis_seconds,
            cost.n_factorisations,
            cost.factorisation_seconds,
            1e-6 * cost.entries,
            cost.used_mb,
            ORDERING.get(cost.ordering as usize).unwrap_or(&"?")
        );
    }
    text
}

fn files_text(place: &str, any_equilibrium: bool, any_unstable: bool) -> String {
    const TABLES: [(&str, &str); 5] = [
        ("summary.txt", "this text"),
        ("modes.csv", "all modes"),
        ("contact.csv", "contact pairs"),
        ("convergence.csv", "Newton iterations"),
        ("details.txt", "equilibria and modes in words"),
    ];
    let states = [("equilibrium_*.vtu, contact_*.vtu", "displacements and contact, for ParaView")];
    let shapes = [("mode_*.vtu", "shapes of the unstable modes, for ParaView")];
    let pictures = states.iter().filter(|_| any_equilibrium).chain(shapes.iter().filter(|_| any_unstable));
    let lines = TABLES.iter().chain(pictures).map(|(name, what)| format!("  {name:34}{what}\n"));
    format!("\nresults in {place}:\n{}", lines.collect::<String>())
}
