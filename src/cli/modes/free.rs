//! The free modes of one part: undamped, held by nothing, as a tap test has them.

use std::f64::consts::TAU;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use nalgebra::DMatrix;
use serde_json::json;

use crate::assembly::System;
use crate::native::{Comm, Factor, FactorKind};
use crate::output::folder::Folder;
use crate::output::vtu::Values;
use crate::stability::{self, Count, Mode, Pencil, Solver};
use crate::sweep::{Brake, RigidMotions};
use crate::{Error, Result};

use super::super::Shell;
use super::super::progress::Progress;
use super::super::volume::Drawing;
use super::mac::{self, Measured};
use super::{Modes, folder, stem};

/// Where the search stands, in units of the band's end: K of a free part is singular.
const SHIFT: f64 = 0.31;
/// A mode with more of its kinetic energy in rigid motion than this is one.
const RIGID: f64 = 0.5;

pub fn run(shell: &Shell, arguments: &Modes, model: &Path, part: &str) -> Result<()> {
    let comm = shell.comm;
    if arguments.parameter.is_some() {
        return Err(Error::input("--parameter is for families of matrices: a part has none"));
    }
    let start = Instant::now();
    let measured = comm.agree(arguments.measured.as_deref().map(mac::read).transpose())?;
    let place = arguments.folder(&format!("{}-{part}", stem(model)));
    let progress = Progress::new(comm, 1, arguments.verbose);
    progress.say("reading and assembling");
    let brake = Brake::read_part(comm, model, part)?;
    let folder = folder(comm, &place, arguments.force)?;
    let system = brake.assemble(comm, &brake.families()?)?;
    let band = arguments.band.unwrap_or(brake.model.band);
    let mut hear = |converged: usize, wanted: usize, _| progress.say(format!("{converged} of {wanted} eigenvalues"));
    let found = Found::new(&brake, &system, band, &mut hear)?;
    let points = measured.as_ref().map(|measured| Points::new(&brake, comm, measured));
    let compared = match (&measured, &points) {
        (Some(measured), Some(points)) => Some(Compared::new(measured, points, &brake, &system, &found)?),
        _ => None,
    };
    for (i, mode) in found.elastic.iter().enumerate() {
        draw(folder.as_ref(), &brake, &system, i + 1, mode)?;
    }
    progress.finish();
    let summary = found.summary(&brake, part, &system, compared.as_ref())
        + &format!(
            "\n{:.1} s on {} rank{}\n",
            start.elapsed().as_secs_f64(),
            comm.size(),
            if comm.size() == 1 { "" } else { "s" }
        )
        + &files_text(&place, comm.size(), compared.is_some());
    let written = folder.map_or(Ok(()), |folder| found.write(folder, &summary, compared.as_ref()));
    comm.agree(written)?;
    let rigid = found.n_rigid;
    shell.tell(&summary, || json!({"part": part, "rigid_motions": rigid, "frequencies_hz": found.frequencies()}))
}

/// The modes of a band.
struct Found {
    band: [f64; 2],
    elastic: Vec<Mode>,
    /// Rigid motions among the modes, and the largest frequency (Hz) that rounding gives them.
    n_rigid: usize,
    rigid_noise: f64,
    count: Count,
}

impl Found {
    fn new(brake: &Brake, system: &System, band: [f64; 2], hear: &mut dyn FnMut(usize, usize, usize)) -> Result<Found> {
        let (m, k, undamped) = (&system.m, &system.k, system.c.zeros_like()?);
        let pencil = Pencil { m, c: &undamped, k, k_symmetric: k, points: None, symmetric_mc: true };
        let mut lu = Factor::new(FactorKind::Unsymmetric);
        let mut solver = Solver::shifted(SHIFT * TAU * band[1]);
        let all = stability::solve(&pencil, &mut lu, &mut solver, [0.0, band[1]], hear)?;
        let motions = RigidMotions::new(brake, system)?;
        let (mut elastic, mut weight, mut rigid_noise) = (Vec::new(), 0.0, 0.0_f64);
        for mode in all.modes {
            if motions.share(system, &mode)? > RIGID {
                // A pair of the upper half plane stands for one motion, a real eigenvalue for half of one.
                weight += if mode.lambda.im > 0.0 { 1.0 } else { 0.5 };
                rigid_noise = rigid_noise.max(mode.lambda.norm() / TAU);
            } else if mode.frequency() >= band[0] {
                elastic.push(mode);
            }
        }
        Ok(Found { band, elastic, n_rigid: weight as usize, rigid_noise, count: all.count })
    }

    fn summary(&self, brake: &Brake, part: &str, system: &System, compared: Option<&Compared>) -> String {
        let [from, to] = self.band;
        let n = system.dofs.n_global();
        let mut text =
            format!("{}: free modes of {part}, {from}-{to} Hz, {n} equations, undamped\n\n", brake.model.title);
        text += &format!("{} rigid motions, below {:.1e} Hz\n", self.n_rigid, self.rigid_noise);
        let Count { below, expected, found } = self.count;
        text += &match self.count.agrees() {
            true => format!(
                "{found} modes below {below:.1} Hz with them, as Sylvester's law of inertia has: none is missing\n"
            ),
            false => format!("{found} modes below {below:.1} Hz with them, {expected} by inertia: not confirmed\n"),
        };
        text += "\n  mode   frequency Hz  backward error\n";
        for (i, mode) in self.elastic.iter().enumerate() {
            text += &format!("  {:>4}  {:>13.4}  {:>14.1e}\n", i + 1, mode.frequency(), mode.backward_error);
        }
        text + &compared.map_or_else(String::new, |compared| compared.text(&self.frequencies()))
    }

    fn frequencies(&self) -> Vec<f64> {
        self.elastic.iter().map(Mode::frequency).collect()
    }

    fn write(&self, folder: Folder, summary: &str, compared: Option<&Compared>) -> Result<()> {
        folder.write("summary.txt", |out| out.write_all(summary.as_bytes()))?;
        folder.write("modes.csv", |out| {
            writeln!(out, "mode,frequency_hz,backward_error")?;
            for (i, mode) in self.elastic.iter().enumerate() {
                writeln!(out, "{},{:.15e},{:.2e}", i + 1, mode.frequency(), mode.backward_error)?;
            }
            Ok(())
        })?;
        if let Some(compared) = compared {
            folder.write("mac.csv", |out| compared.table(out, &self.frequencies()))?;
        }
        folder.finish()
    }
}

/// Writes a mode's shape. Collective; the root has the folder.
fn draw(folder: Option<&Folder>, brake: &Brake, system: &System, number: usize, mode: &Mode) -> Result<()> {
    let drawing = Drawing::new(brake);
    let shape = drawing.at_nodes(&system.nodal(&[&mode.re])?[0]);
    let name = format!("mode_{number:03}_{:.0}Hz", mode.frequency());
    drawing.write(system.k.comm(), folder, &name, vec![("real", Values::Vectors(&shape))], Vec::new())
}

fn files_text(place: &Path, ranks: usize, has_mac: bool) -> String {
    let shapes = if ranks == 1 { "mode_*.vtu" } else { "mode_*.pvtu" };
    let mut files = vec![("summary.txt", "this text"), ("modes.csv", "frequencies"), (shapes, "shapes, for ParaView")];
    files.extend(has_mac.then_some(("mac.csv", "every measured mode against every computed one")));
    let lines: String = files.iter().map(|(name, what)| format!("  {name:36}{what}\n")).collect();
    format!("\nresults in {}:\n{lines}", place.display())
}

/// The nodes nearest to the measured points.
struct Points {
    /// For each point the node where this rank has it, in its own numbers.
    nodes: Vec<Option<u32>>,
    /// The largest distance of a point from its node, m.
    distance: f64,
}

impl Points {
    /// Collective.
    fn new(brake: &Brake, comm: &Comm, measured: &Measured) -> Points {
        let unit = brake.model.mesh_unit;
        let own: Vec<u32> = brake.nodes.owned().collect();
        let square = |x: &[f64; 3], n: u32| {
            let node = &brake.mesh.nodes[n as usize];
            (0..3).map(|i| (unit * x[i] - node[i]).powi(2)).sum::<f64>()
        };
        let nearest = |x: &[f64; 3]| own.iter().map(|&n| (square(x, n), n)).min_by(|a, b| a.0.total_cmp(&b.0));
        let own: Vec<Option<(f64, u32)>> = measured.points.iter().map(nearest).collect();
        let mut least: Vec<f64> =
            own.iter().map(|best| best.map_or(f64::NEG_INFINITY, |(square, _)| -square)).collect();
        comm.max_all(&mut least);
        // Of ranks with nodes equally near the first.
        let claims = |best: &Option<(f64, u32)>, least: &f64| best.is_some_and(|(square, _)| -square == *least);
        let rank = |claim: bool| if claim { -(comm.rank() as f64) } else { f64::NEG_INFINITY };
        let mut first: Vec<f64> = own.iter().zip(&least).map(|(best, least)| rank(claims(best, least))).collect();
        comm.max_all(&mut first);
        let mine = |(best, (least, first)): (Option<(f64, u32)>, (&f64, &f64))| {
            best.filter(|_| claims(&best, least) && -first == comm.rank() as f64).map(|(_, node)| node)
        };
        let distance = least.iter().fold(0.0, |largest: f64, least| largest.max((-least).sqrt()));
        Points { nodes: own.into_iter().zip(least.iter().zip(&first)).map(mine).collect(), distance }
    }
}

/// Measured modes against computed ones.
struct Compared {
    frequencies: Vec<f64>,
    /// MAC of each measured mode (row) with each computed one.
    single: DMatrix<f64>,
    /// Modes of one frequency together, and MAC of each measured mode with each such group.
    groups: Vec<std::ops::Range<usize>>,
    grouped: DMatrix<f64>,
    distance: f64,
}

impl Compared {
    /// Collective.
    fn new(measured: &Measured, points: &Points, brake: &Brake, system: &System, found: &Found) -> Result<Compared> {
        let (n_points, n_modes) = (measured.points.len(), found.elastic.len());
        let mut values = vec![0.0; n_points * n_modes];
        for (j, mode) in found.elastic.iter().enumerate() {
            let shape = system.nodal(&[&mode.re])?.remove(0);
            for (k, node) in points.nodes.iter().enumerate() {
                if let Some(n) = node {
                    let along = |i: usize| shape[*n as usize][i] * measured.directions[k][i];
                    values[j * n_points + k] = (0..3).map(along).sum();
                }
            }
        }
        system.k.comm().sum_all(&mut values);
        let computed = DMatrix::from_vec(n_points, n_modes, values);
        let groups = mac::groups(&found.frequencies());
        let of = |i: usize, columns: std::ops::Range<usize>| {
            mac::mac(&measured.modes[i].1, &computed.columns(columns.start, columns.len()).into_owned())
        };
        let n = measured.modes.len();
        Ok(Compared {
            frequencies: measured.modes.iter().map(|(frequency, _)| *frequency).collect(),
            single: DMatrix::from_fn(n, n_modes, |i, j| of(i, j..j + 1)),
            grouped: DMatrix::from_fn(n, groups.len(), |i, g| of(i, groups[g].clone())),
            groups,
            distance: points.distance / brake.model.mesh_unit,
        })
    }

    fn text(&self, computed: &[f64]) -> String {
        let mut text =
            format!("\nmeasured points are up to {:.3} (unit of the mesh) from their nodes\n", self.distance);
        text += "  measured Hz   computed Hz  difference %   MAC\n";
        for (i, measured) in self.frequencies.iter().enumerate() {
            let best = (0..self.groups.len()).max_by(|&a, &b| self.grouped[(i, a)].total_cmp(&self.grouped[(i, b)]));
            let Some(best) = best else { continue };
            let hertz = computed[self.groups[best].start];
            let together = if self.groups[best].len() > 1 { "  modes of one frequency together" } else { "" };
            let (off, mac) = (100.0 * (hertz / measured - 1.0), self.grouped[(i, best)]);
            text += &format!("  {measured:>11.2}   {hertz:>11.2}  {off:>+12.2}  {mac:>5.3}{together}\n");
        }
        text
    }

    /// Every measured mode against every computed one, alone and with those of its frequency.
    fn table(&self, out: &mut dyn Write, computed: &[f64]) -> std::io::Result<()> {
        writeln!(out, "measured_hz,mode,computed_hz,mac,mac_with_modes_of_its_frequency")?;
        for (i, measured) in self.frequencies.iter().enumerate() {
            for (g, group) in self.groups.iter().enumerate() {
                for j in group.clone() {
                    let (single, grouped) = (self.single[(i, j)], self.grouped[(i, g)]);
                    writeln!(out, "{measured},{},{:.9e},{single:.6},{grouped:.6}", j + 1, computed[j])?;
                }
            }
        }
        Ok(())
    }
}
