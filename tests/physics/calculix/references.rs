//! What CalculiX's own results (`.dat.ref`) say of a deck, and what we find.
//!
//! Displacements at the end of the last static step, as `*NODE PRINT` has them, or the frequencies of a `*FREQUENCY`
//! step. Modes are those of the mass with CalculiX's points, which are fewer than ours: so nothing else differs.

use std::collections::{HashMap, HashSet};

use nalgebra::Vector3;
use squeal::analysis::Sweep;
use squeal::assembly::{ElementMatrices, Elements, System};
use squeal::contact::search::Alone;
use squeal::deck::elements::Class;
use squeal::deck::{self, Converted, Deck};
use squeal::mesh::{Numbering, Piece};
use squeal::model::{Inertia, Rotation};
use squeal::native::Comm;
use squeal::stability::Mode;
use squeal::structure::FullModel;

use super::TheirMass;

/// The band ends above the highest frequency of the reference by this factor.
const ABOVE: f64 = 1.2;

/// Displacements of nodes by their numbers, or frequencies.
pub enum Reference {
    Displacements(HashMap<u32, [f64; 3]>),
    /// Cycles per unit of time.
    Frequencies(Vec<f64>),
}

fn numbers(line: &str) -> Option<Vec<f64>> {
    line.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>().filter(|all| !all.is_empty())
}

/// The rows of numbers below a title, up to the next line of text.
fn rows<'t>(lines: impl Iterator<Item = &'t str>) -> Vec<Vec<f64>> {
    lines.skip_while(|line| numbers(line).is_none()).map_while(numbers).collect()
}

/// The eigenvalues, or else the displacements of all sets at the last time.
pub fn reference(text: &str) -> Option<Reference> {
    if let Some((_, table)) = text.rsplit_once("E I G E N V A L U E   O U T P U T") {
        // Number, eigenvalue, rad, cycles, imaginary part; with friction without the eigenvalue, not by rising values.
        let frequency = |row: Vec<f64>| match row.len() {
            4 => row[2],
            _ => row[1].max(0.0).sqrt() / std::f64::consts::TAU,
        };
        let mut frequencies: Vec<f64> = rows(table.lines()).into_iter().map(frequency).collect();
        frequencies.sort_by(f64::total_cmp);
        return Some(Reference::Frequencies(frequencies));
    }
    let lines: Vec<&str> = text.lines().collect();
    let title = |line: &&str| line.trim_start().starts_with("displacements (vx,vy,vz) for set");
    let time = |line: &str| line.split_whitespace().next_back().map(str::to_owned);
    let last = time(lines.iter().rfind(|line| title(line))?);
    let blocks = lines.iter().enumerate().filter(|(_, line)| title(line) && time(line) == last);
    let all = blocks.flat_map(|(at, _)| rows(lines[at + 1..].iter().copied()));
    Some(Reference::Displacements(all.map(|row| (row[0] as u32, [row[1], row[2], row[3]])).collect()))
}

/// Index in the mesh of each node of a deck without instances: those that solids use, in the order of the deck.
fn node_indices(deck: &Deck) -> HashMap<u32, usize> {
    let solids = deck.assembly.elements.iter().filter(|block| matches!(block.kind.class, Class::Solid(_)));
    let used: HashSet<u32> = solids.flat_map(|block| block.nodes.iter().copied()).collect();
    let mut numbers = Vec::new();
    let mut seen = HashSet::new();
    numbers.extend(deck.assembly.nodes.numbers.iter().filter(|&number| used.contains(number) && seen.insert(*number)));
    numbers.into_iter().zip(0..).collect()
}

/// The model of a deck.
pub fn model(converted: Converted) -> Result<FullModel, String> {
    let Converted { mut model, mesh, .. } = converted;
    deck::settle(&mut model, &mesh, |_| true);
    let nodes = Numbering::even(mesh.nodes.len(), 0, 1);
    FullModel::new(model, Piece { mesh, nodes }, &Alone).map_err(|error| error.to_string())
}

/// What we find for a deck, of the kind of a reference. Centrifugal forces are those of CalculiX's points, of
/// linear statics at x and not at `x + u`. Linear modes have no prestress.
pub fn compute(
    comm: &Comm,
    deck: &Deck,
    brake: &FullModel,
    wanted: &Reference,
    is_linear: bool,
) -> Result<Reference, String> {
    let families = brake.families().unwrap();
    let inertia = Some(&families.turning as &dyn Elements).filter(|turning| !turning.is_empty());
    let their_mass = TheirMass::of(brake);
    let (solids, inertia) = match wanted {
        Reference::Displacements(_) => (&families.solids as &dyn Elements, inertia.filter(|_| !is_linear)),
        Reference::Frequencies(_) => (&their_mass as &dyn Elements, inertia),
    };
    let all: Vec<&dyn Elements> = [solids, &brake.joints].into_iter().chain(inertia).collect();
    let mut system = brake.assemble_families(comm, &all).unwrap();
    system.add_load(&centrifugal_forces(brake, &their_mass)).unwrap();
    match wanted {
        Reference::Displacements(_) => {
            let u = displacements(brake, &system)?;
            Ok(Reference::Displacements(node_indices(deck).into_iter().map(|(number, i)| (number, u[i])).collect()))
        }
        Reference::Frequencies(theirs) => Ok(Reference::Frequencies(frequencies(brake, &system, theirs, is_linear)?)),
    }
}

/// The centrifugal forces (N) with the mass of CalculiX's points.
fn centrifugal_forces(brake: &FullModel, masses: &TheirMass) -> Vec<(u32, [f64; 3])> {
    let (mut element, mut forces) = (ElementMatrices::default(), Vec::new());
    for (e, own) in brake.mesh.elements.iter().enumerate() {
        let part = &brake.mesh.parts[own.part as usize];
        let turns = |rotation: &&Rotation| rotation.part == *part && rotation.inertia != Inertia::None;
        let Some(rotation) = brake.model.rotations.iter().find(turns) else { continue };
        masses.matrices(e, &mut element);
        let omega = Vector3::from(rotation.angular_velocity());
        let at = |n: u32| omega.cross(&Vector3::from(rotation.velocity(brake.mesh.nodes[n as usize])));
        for (&node, row) in own.nodes.iter().zip(element.m.chunks_exact(own.nodes.len())) {
            let force: Vector3<f64> = row.iter().zip(own.nodes).map(|(m, &n)| -*m * at(n)).sum();
            forces.push((node, force.into()));
        }
    }
    forces
}

impl Reference {
    /// The largest difference from a reference: of displacements relative to its largest one, or of a frequency. Our
    /// modes may be more.
    pub fn difference(&self, theirs: &Reference) -> f64 {
        match (self, theirs) {
            (Reference::Displacements(ours), Reference::Displacements(theirs)) => {
                let (mut off, mut size) = (0.0_f64, 0.0_f64);
                for (number, theirs) in theirs {
                    // Nodes of no solid have no displacements of ours.
                    let Some(ours) = ours.get(number) else { continue };
                    (0..3).for_each(|i| {
                        off = off.max((ours[i] - theirs[i]).abs());
                        size = size.max(theirs[i].abs());
                    });
                }
                off / size
            }
            (Reference::Frequencies(ours), Reference::Frequencies(theirs)) if ours.len() >= theirs.len() => {
                ours.iter().zip(theirs).map(|(ours, theirs)| (ours / theirs - 1.0).abs()).fold(0.0, f64::max)
            }
            _ => f64::NAN,
        }
    }
}

fn displacements(brake: &FullModel, system: &System) -> Result<Vec<[f64; 3]>, String> {
    let mut sweep = Sweep::new(system, &brake.interface, false).map_err(|error| error.to_string())?;
    let own = brake.own_friction().map_err(|error| error.to_string())?;
    let equilibrium = sweep.equilibrium(own, &mut ()).map_err(|error| error.to_string())?;
    Ok(brake.displacements(system, &equilibrium.u).unwrap())
}

/// The frequencies below the highest reference, which is among them.
fn frequencies(brake: &FullModel, system: &System, theirs: &[f64], is_linear: bool) -> Result<Vec<f64>, String> {
    let prestress = brake.prestress().unwrap().filter(|_| !is_linear);
    let sweep = Sweep::new(system, &brake.interface, false).map_err(|error| error.to_string())?;
    let mut sweep = sweep.with_prestress(prestress.as_ref());
    let own = brake.own_friction().map_err(|error| error.to_string())?;
    let equilibrium = sweep.equilibrium(own, &mut ()).map_err(|error| error.to_string())?;
    let highest = theirs.iter().copied().fold(0.0, f64::max) * ABOVE;
    let band = sweep.modes(&equilibrium, [0.0, highest], &mut ()).map_err(|error| error.to_string())?;
    Ok(band.modes.iter().map(Mode::frequency).collect())
}
