//! `squeal stability`: complex modes for one friction or a sweep, followed from one to the next.

use std::f64::consts::TAU;
use std::time::Instant;

use crate::Result;
use crate::petsc::{Comm, Vector};
use crate::report::branches;
use crate::report::explain::{self, Explained};
use crate::report::folder::Folder;
use crate::report::tables::{self, ModeRow};
use crate::stability::{Band, Complex, Count, Mode};
use crate::sweep::{Costs, Friction, Snapshot, Source, Sweep, tracking_options, wider};
use crate::tracking::{Diagram, track};

use super::Run;
use super::results;
use super::study::{Outcome, Study, Visit, Walk};

pub fn run(comm: &Comm, run: &Run, band: Option<[f64; 2]>, anew: bool, branches: bool) -> Result<()> {
    let start = Instant::now();
    let mut study = Study::new(comm, run, "stability")?;
    let mut found = Found { band: study.subject.band(band)?, ..Found::default() };
    // Super-elements that are made anew have coordinates of their own, so that their modes cannot be compared.
    let follow = branches && !anew && study.frictions.len() > 1;
    if follow && !study.frictions.is_sorted_by(|a, b| a > b) {
        study.frictions.sort_by(f64::total_cmp);
    }
    let outcome = study.run(comm, |walk| match (anew, follow) {
        (false, true) => found.follow(walk),
        (false, false) => walk.study.frictions.iter().try_for_each(|&mu| walk.visit(mu, |visit| found.add(visit))),
        (true, _) => {
            walk.study.frictions.iter().try_for_each(|&mu| walk.visit(mu, |visit| found.add_reduced(comm, visit)))
        }
    })?;
    let summary = found.summary(&study, &outcome, start.elapsed().as_secs_f64(), comm.size());
    if let Some(folder) = &study.folder {
        found.write(folder)?;
        folder.write("details.txt", |out| out.write_all(outcome.record.text.as_bytes()))?;
    }
    study.finish(outcome, &summary)
}

/// The modes found so far.
#[derive(Default)]
struct Found {
    /// Hz.
    band: [f64; 2],
    /// Modes at the frictions asked for.
    rows: Vec<ModeRow>,
    /// The check of their number at each.
    counts: Vec<(f64, Count)>,
    /// Unstable modes at these frictions, with what explains them.
    explained: Vec<Explained>,
    /// Where modes are followed.
    diagram: Option<Diagram>,
}

impl Found {
    /// The modes at one friction.
    fn add(&mut self, visit: Visit) -> Result<String> {
        let modes = visit.sweep.modes(visit.equilibrium, self.band, &mut |event| visit.study.say(&event))?;
        let any_unstable = modes.modes.iter().any(Mode::is_unstable);
        let snapshot = any_unstable.then(|| Snapshot::of_unstable(visit.sweep, &modes, self.band[1])).transpose()?;
        self.report(visit, &modes, |visit, i, row| match &snapshot {
            Some(snapshot) => explained(visit, &modes.modes[i], row, snapshot.left(i)?),
            None => Ok(Vec::new()),
        })
    }

    /// The modes of the super-element that the brake is about the equilibrium.
    fn add_reduced(&mut self, comm: &Comm, visit: Visit) -> Result<String> {
        let (study, friction) = (visit.study, visit.equilibrium.friction);
        let subject = study.subject.reduce(visit.system, visit.equilibrium)?;
        let (band, system) = (subject.band(Some(self.band))?, subject.assemble(comm)?);
        let mut sweep = Sweep::new(&system, subject.interface())?;
        sweep.friction_damping = subject.friction_damping();
        let equilibrium = sweep.equilibrium(friction, &mut |event| study.say(&event))?;
        let modes = sweep.modes(&equilibrium, band, &mut |event| study.say(&event))?;
        self.report(visit, &modes, |_, i, row| {
            subject.draw(study.folder.as_ref(), &system, friction, (row.mode, &modes.modes[i]))?;
            Ok(Vec::new())
        })
    }

    /// Modes at all frictions, strung on branches, and at those in between that this needs.
    fn follow(&mut self, walk: &mut Walk) -> Result<()> {
        let (system, frictions, band) = (walk.system, &walk.study.frictions, self.band);
        let mut solve = |friction: f64| {
            let mut snapshot = None;
            walk.visit(friction, |visit| {
                let modes = visit.sweep.modes(visit.equilibrium, wider(band), &mut |event| visit.study.say(&event))?;
                let made = snapshot.insert(Snapshot::new(visit.sweep, &modes, band[1])?);
                self.report(visit, &modes, |visit, i, row| explained(visit, &modes.modes[i], row, made.left(i)?))
            })?;
            Ok(snapshot.expect("a visit without error has made it"))
        };
        let mut family = Friction { solve: &mut solve, m: &system.m, c: &system.c };
        let (diagram, outcome) = track(&mut family, frictions, &tracking_options(band));
        self.diagram = Some(diagram);
        outcome
    }

    /// Keeps the modes of the band and tells of them. Where the friction was asked for, `look` draws unstable ones, given by their place among
    /// `modes`, and explains them if it can.
    fn report(
        &mut self,
        mut visit: Visit,
        modes: &Band,
        mut look: impl FnMut(&mut Visit, usize, &ModeRow) -> Result<Vec<Source>>,
    ) -> Result<String> {
        let friction = visit.equilibrium.friction;
        let asked = visit.study.frictions.contains(&friction);
        let inside = |(_, mode): &(usize, &Mode)| (self.band[0]..=self.band[1]).contains(&mode.frequency());
        let (mut rows, mut sentences) = (Vec::new(), String::new());
        for (number, (i, mode)) in modes.modes.iter().enumerate().filter(inside).enumerate() {
            let row = ModeRow::new(friction, number, mode);
            rows.push(row.clone());
            let sources = if asked && row.unstable { look(&mut visit, i, &row)? } else { Vec::new() };
            if !sources.is_empty() {
                let explained = Explained { row, sources };
                sentences += &format!("  {}\n", explain::sentence(&explained));
                self.explained.push(explained);
            }
        }
        *visit.text += &(modes_text(&rows, &modes.count, modes.n_solves) + &sentences);
        let found = format!("{} modes, {} unstable", rows.len(), rows.iter().filter(|row| row.unstable).count());
        if asked {
            self.counts.push((friction, modes.count));
            self.rows.extend(rows);
        }
        Ok(found)
    }

    fn summary(&self, study: &Study, outcome: &Outcome, seconds: f64, ranks: usize) -> String {
        let [from, to] = self.band;
        let mut summary = format!("{}: complex modes {from}-{to} Hz\n\n", study.subject.title());
        if !self.counts.is_empty() {
            summary += &format!("{}\n{}\n", tables::sweep(&self.rows, &self.counts), tables::verdict(&self.rows));
        }
        let growth = |explained: &&Explained| explained.row.growth_rate;
        let strongest = self.explained.iter().max_by(|a, b| growth(a).total_cmp(&growth(b)));
        summary += &strongest.map_or_else(String::new, |explained| format!("{}\n", explain::sentence(explained)));
        summary += &self.diagram.as_ref().map_or_else(String::new, branches::summary);
        summary += &costs_text(&outcome.costs, seconds, ranks);
        let any_unstable = self.rows.iter().any(|row| row.unstable);
        let any = [!self.counts.is_empty(), any_unstable, !self.explained.is_empty(), self.diagram.is_some()];
        summary + &files_text(&study.place.display().to_string(), ranks, any)
    }

    fn write(&self, folder: &Folder) -> Result<()> {
        folder.write("modes.csv", |out| tables::modes(out, &self.rows))?;
        if !self.explained.is_empty() {
            results::csv_table(folder, "explained.csv", |out| explain::sources(out, &self.explained))?;
        }
        let Some(diagram) = &self.diagram else { return Ok(()) };
        let band = self.band.map(|f| TAU * f);
        folder.write("branches.csv", |out| branches::points(out, diagram, band))?;
        folder.write("hopf.csv", |out| branches::hopf(out, diagram))
    }
}

/// Draws an unstable mode and explains it.
fn explained(visit: &mut Visit, mode: &Mode, row: &ModeRow, [re, im]: [Vector; 2]) -> Result<Vec<Source>> {
    let (study, equilibrium) = (visit.study, visit.equilibrium);
    study.subject.draw(study.folder.as_ref(), visit.system, equilibrium.friction, (row.mode, mode))?;
    let right = (mode.lambda, Complex { re: &mode.re, im: &mode.im });
    study.subject.explain(visit.sweep, equilibrium, right, Complex { re: &re, im: &im })
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
        "\n{seconds:.1} s on {ranks} rank{}: equilibria {:.1} s, modes {:.1} s, left vectors {:.1} s; {} iterations with a neighbour's factor\n",
        if ranks == 1 { "" } else { "s" },
        costs.equilibria_seconds,
        costs.modes_seconds,
        costs.left_seconds,
        costs.n_iterations
    );
    let factors = [("LU", costs.lu), ("LDL^T", costs.symmetric)];
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
            cost.ordering_name()
        );
    }
    text
}

/// What is in the results folder: pictures of equilibria, of unstable modes, explanations, branches where there are any.
fn files_text(
    place: &str,
    ranks: usize,
    [any_equilibrium, any_unstable, any_explained, any_branch]: [bool; 4],
) -> String {
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
    let reasons = [("explained.csv", "energies, feed, damping, sensitivities")];
    let curves = [("branches.csv", "modes followed over friction"), ("hopf.csv", "where they become unstable")];
    let lines = TABLES
        .iter()
        .chain(curves.iter().filter(|_| any_branch))
        .chain(reasons.iter().filter(|_| any_explained))
        .chain(states.iter().filter(|_| any_equilibrium))
        .chain(shapes.iter().filter(|_| any_unstable))
        .map(|(name, what)| format!("  {name:36}{what}\n"));
    format!("\nresults in {place}:\n{}", lines.collect::<String>())
}
