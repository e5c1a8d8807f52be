//! `squeal stability`: complex modes for one friction or a sweep.

use std::time::Instant;

use crate::Result;
use crate::assembly::System;
use crate::petsc::{Comm, ORDERING};
use crate::report::tables::{self, ModeRow};
use crate::stability::{Band, Count};
use crate::sweep::{Costs, Sweep};

use super::Run;
use super::study::{Study, Visit};
use super::subject::Subject;

pub fn run(comm: &Comm, run: &Run, band: Option<[f64; 2]>, anew: bool) -> Result<()> {
    let start = Instant::now();
    let study = Study::new(comm, run, "stability")?;
    let band = study.subject.band(band)?;
    let (mut modes, mut counts) = (Vec::new(), Vec::new());
    let outcome = study.run(comm, |mut visit| {
        let (friction, n_before) = (visit.equilibrium.friction, modes.len());
        let found = if anew { reduced_modes(comm, &visit, band)? } else { full_modes(&mut visit, band)? };
        modes.extend(found.modes.iter().enumerate().map(|(i, mode)| ModeRow::new(friction, i, mode)));
        let rows = &modes[n_before..];
        *visit.text += &modes_text(rows, &found.count, found.n_solves);
        counts.push((friction, found.count));
        Ok(format!("{} modes, {} unstable", rows.len(), rows.iter().filter(|row| row.unstable).count()))
    })?;
    let mut summary = format!("{}: complex modes {}-{} Hz\n\n", study.subject.title(), band[0], band[1]);
    if !counts.is_empty() {
        summary += &format!("{}\n{}\n", tables::sweep(&modes, &counts), tables::verdict(&modes));
    }
    summary += &costs_text(&outcome.costs, start.elapsed().as_secs_f64(), comm.size());
    let any_unstable = modes.iter().any(|row| row.unstable);
    summary += &files_text(&study.place.display().to_string(), comm.size(), !counts.is_empty(), any_unstable);
    if let Some(folder) = &study.folder {
        folder.write("modes.csv", |out| tables::modes(out, &modes))?;
        folder.write("details.txt", |out| out.write_all(outcome.record.text.as_bytes()))?;
    }
    study.finish(outcome, &summary)
}

/// The modes about the equilibrium, the unstable ones drawn.
fn full_modes(visit: &mut Visit, band: [f64; 2]) -> Result<Band> {
    let found = visit.sweep.modes(visit.equilibrium, band, &mut |event| visit.study.say(&event))?;
    draw(visit.study, visit.study.subject.as_ref(), visit.system, visit.equilibrium.friction, &found)?;
    Ok(found)
}

/// The modes of the super-element that the brake is about the equilibrium.
fn reduced_modes(comm: &Comm, visit: &Visit, band: [f64; 2]) -> Result<Band> {
    let (study, friction) = (visit.study, visit.equilibrium.friction);
    let subject = study.subject.reduce(visit.system, visit.equilibrium)?;
    let (band, system) = (subject.band(Some(band))?, subject.assemble(comm)?);
    let mut sweep = Sweep::new(&system, subject.interface())?;
    sweep.friction_damping = subject.friction_damping();
    let equilibrium = sweep.equilibrium(friction, &mut |event| study.say(&event))?;
    let found = sweep.modes(&equilibrium, band, &mut |event| study.say(&event))?;
    draw(study, subject.as_ref(), &system, friction, &found)?;
    Ok(found)
}

fn draw(study: &Study, subject: &dyn Subject, system: &System, friction: f64, found: &Band) -> Result<()> {
    let unstable = found.modes.iter().enumerate().filter(|(_, mode)| mode.is_unstable());
    unstable.into_iter().try_for_each(|(i, mode)| subject.draw(study.folder.as_ref(), system, friction, (i + 1, mode)))
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
fn costs_text(costs: &Costs, seconds: f64, ranks: usize) -> String {
    let mut text = format!(
        "\n{seconds:.1} s on {ranks} rank{}: equilibria {:.1} s, modes {:.1} s; {} iterations with a neighbour's factor\n",
        if ranks == 1 { "" } else { "s" },
        costs.equilibria_seconds,
        costs.modes_seconds,
        costs.n_iterations
    );
    let factors = [("equilibrium LU", costs.tangent), ("modes LU", costs.stiffness), ("modes LDL^T", costs.symmetric)];
    for (name, cost) in factors.iter().filter(|(_, cost)| cost.n_factorisations > 0) {
        text += &format!(
            "{name}: {} analysis {:.1} s, {} factorisations {:.1} s, {} solves of {} right-hand sides {:.1} s; {:.0} M entries, \
             {:.0} MB of {:.0} MB estimated{}, ordering {}\n",
            cost.n_analyses,
            cost.analysis_seconds,
            cost.n_factorisations,
            cost.factorisation_seconds,
            cost.n_solves,
            cost.n_right_hand_sides,
            cost.solve_seconds,
            1e-6 * cost.entries,
            cost.used_mb,
            cost.estimated_mb,
            if cost.out_of_core { ", out of core" } else { "" },
            ORDERING.get(cost.ordering as usize).unwrap_or(&"?")
        );
    }
    text
}

fn files_text(place: &str, ranks: usize, any_equilibrium: bool, any_unstable: bool) -> String {
    const TABLES: [(&str, &str); 5] = [
        ("summary.txt", "this text"),
        ("modes.csv", "all modes"),
        ("contact.csv", "contact pairs"),
        ("convergence.csv", "Newton iterations"),
        ("details.txt", "equilibria and modes in words"),
    ];
    let [state, shape] = match ranks {
        1 => ["equilibrium_*.vtu, contact_*.vtu", "mode_*.vtu"],
        _ => ["equilibrium_*.pvtu, contact_*.vtu", "mode_*.pvtu"],
    };
    let states = [(state, "displacements and contact, for ParaView")];
    let shapes = [(shape, "shapes of the unstable modes, for ParaView")];
    let pictures = states.iter().filter(|_| any_equilibrium).chain(shapes.iter().filter(|_| any_unstable));
    let lines = TABLES.iter().chain(pictures).map(|(name, what)| format!("  {name:36}{what}\n"));
    format!("\nresults in {place}:\n{}", lines.collect::<String>())
}
