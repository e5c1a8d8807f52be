//! `squeal check`: what a model is, before anything is computed.

use std::path::Path;

use crate::Result;
use crate::contact::interface::ContactPair;
use crate::equilibrium::tangent_precision;
use crate::mesh::quality::scaled_jacobian;
use crate::model::{Load, LoadKind};
use crate::native::{Comm, Factor, FactorKind};
use crate::output::contact_cells::ContactCells;
use crate::output::files::write_whole;
use crate::output::model_summary::{LayoutRow, LoadRow, MatrixSummary, MeshSummary, ModelSummary, PairRow, PartRow};
use crate::output::overwrite::may_write_file;
use crate::output::vtu;
use crate::structure::{FullModel, Ranked, plausibility};

use super::{Check, Shell};

pub fn run(shell: &Shell, arguments: &Check) -> Result<()> {
    let comm = shell.comm;
    let Check { model: path, contacts: n_contacts, output, force } = arguments;
    let (picture, n_contacts) = (output.as_deref(), *n_contacts);
    let may_draw = || picture.map_or(Ok(()), |file| may_write_file(file, &vtu::KIND, *force));
    comm.agree(if comm.is_root() { may_draw() } else { Ok(()) })?;
    let brake = FullModel::read_with_contacts(comm, path, n_contacts)?;
    let mut summary = summary(comm, &brake, n_contacts.is_some());
    let mut text = summary.text();
    if !shell.json {
        // What takes no time comes at once.
        shell.tell(&std::mem::take(&mut text), &())?;
    }
    if let Some(file) = picture {
        comm.agree(if comm.is_root() { draw(file, &brake) } else { Ok(()) })?;
    }
    summary.warnings = plausibility::warnings(&brake, comm);
    shell.warn(&summary.warnings);
    brake.require_constrained(comm)?;
    let matrix = matrix(comm, &brake)?;
    text += &matrix.text();
    summary.matrix = Some(matrix);
    shell.tell(&text, &summary)
}

/// All but the matrices. Collective.
fn summary(comm: &Comm, brake: &FullModel, with_layouts: bool) -> ModelSummary {
    let load = |load: &Load| LoadRow { load: load.name.clone(), on: load.on.clone(), what: amount(&load.kind) };
    let sliding = || brake.interface.pairs.iter().filter(|pair| pair.is_sliding());
    ModelSummary {
        title: brake.model.title.clone(),
        mesh: mesh(comm, brake),
        parts: (0..brake.mesh.parts.len()).map(|i| part(comm, brake, i)).collect(),
        pairs: brake.interface.pairs.iter().map(pair).collect(),
        layouts: with_layouts.then(|| sliding().map(|pair| layout(brake, pair)).collect()),
        held_displacements: brake.held.as_flattened().iter().filter(|&&h| h).count(),
        connectors: brake.links.len(),
        loads: brake.model.loads.iter().map(load).collect(),
        sum_of_loads_n: brake.loads.iter().fold([0.0; 3], |sum, (_, f)| [0, 1, 2].map(|i| sum[i] + f[i])),
        warnings: Vec::new(),
        matrix: None,
    }
}

fn mesh(comm: &Comm, brake: &FullModel) -> MeshSummary {
    let ends = |sign: f64| {
        let most = |i: usize| brake.mesh.nodes.iter().map(|x| sign * x[i]).fold(f64::MIN, f64::max);
        let mut ends = [0, 1, 2].map(most);
        comm.max_all(&mut ends);
        ends
    };
    let (high, low) = (ends(1.0), ends(-1.0));
    MeshSummary {
        nodes: brake.nodes.n_global(),
        tetrahedra: comm.sum(brake.own_tets().count()),
        size_m: [0, 1, 2].map(|i| high[i] + low[i]),
    }
}

/// Mass, centre, moments of inertia and mesh quality of a part. Collective.
fn part(comm: &Comm, brake: &FullModel, i: usize) -> PartRow {
    let mesh = &brake.mesh;
    let own = brake.own_tets().filter(|&e| mesh.tet_part[e] as usize == i).map(|e| mesh.tet_nodes(e));
    let properties = brake.part_properties(comm, i);
    let quality = Ranked::new(comm, own.map(|x| scaled_jacobian(&x)).collect());
    let centre = properties.centre();
    let inertia = properties.inertia_about(centre);
    PartRow {
        part: mesh.parts[i].clone(),
        tetrahedra: quality.len(),
        mass_kg: properties.mass,
        centre_m: centre,
        inertia_kg_m2: [0, 1, 2].map(|k| inertia[k][k]),
        quality_min: quality.nth(0),
        quality_median: quality.nth(quality.len() / 2),
    }
}

fn pair(pair: &ContactPair) -> PairRow {
    let statistics = &pair.statistics;
    PairRow {
        pair: pair.name.clone(),
        kind: format!("{:?}", pair.kind).to_lowercase(),
        points: pair.points.len(),
        dropped: statistics.dropped.len(),
        touching: statistics.touching,
        area_m2: statistics.area,
        gap_min_m: statistics.gap[0],
        gap_max_m: statistics.gap[1],
        friction: pair.friction,
    }
}

/// The reference nodes of a sliding pair.
fn layout(brake: &FullModel, pair: &ContactPair) -> LayoutRow {
    let own = &brake.interface.points[pair.points.clone()];
    let areas = || own.iter().map(|point| point.law.weight);
    let points = || own.iter().map(|point| point.nodes.len());
    LayoutRow {
        pair: pair.name.clone(),
        reference_nodes: own.len(),
        cell_area_min_m2: areas().fold(f64::INFINITY, f64::min),
        cell_area_mean_m2: areas().sum::<f64>() / own.len() as f64,
        cell_area_max_m2: areas().fold(0.0, f64::max),
        cell_points_min: points().min().unwrap_or(0),
        cell_points_max: points().max().unwrap_or(0),
    }
}

fn amount(kind: &LoadKind) -> String {
    let force = |f: &[f64; 3]| f.map(|f| f.to_string()).join(" ");
    match kind {
        LoadKind::ForceByNode(f) => format!("{} N, the same on each node", force(f)),
        LoadKind::ForceByArea(f) => format!("{} N, spread over the area", force(f)),
        LoadKind::Pressure(p) => format!("a pressure of {p} Pa"),
    }
}

/// Writes the cells of the reference nodes.
fn draw(file: &Path, brake: &FullModel) -> Result<()> {
    let picture = ContactCells::new(&brake.mesh, &brake.interface);
    write_whole(file, |mut out| picture.grid().write(&mut out))
}

/// Analyses the matrix without factorising it. Collective.
fn matrix(comm: &Comm, brake: &FullModel) -> Result<MatrixSummary> {
    let system = brake.assemble(comm, &brake.families()?)?;
    let mut factor = Factor::new(FactorKind::Unsymmetric);
    factor.set_precision(tangent_precision(&system));
    factor.analyse(&system.k)?;
    Ok(MatrixSummary {
        equations: system.dofs.n_global(),
        entries: system.k.n_entries()?,
        factor_gb: factor.stats().estimated_mb / 1024.0,
    })
}
