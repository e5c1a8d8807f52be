//! `squeal check`: what a model is, before anything is computed.

use std::fmt::Write;
use std::path::Path;

use serde_json::{Value as Json, json};

use crate::Result;
use crate::equilibrium::tangent_precision;
use crate::mesh::quality::scaled_jacobian;
use crate::model::LoadKind;
use crate::native::{Comm, Factor, FactorKind};
use crate::output::contact_cells::ContactCells;
use crate::output::files::write_whole;
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
    let mut told = Told { text: format!("{}\n\n", brake.model.title), json: json!({"title": brake.model.title}) };
    parts(&mut told, comm, &brake);
    pairs(&mut told, &brake);
    if n_contacts.is_some() {
        layouts(&mut told, &brake);
    }
    supports(&mut told, &brake);
    if !shell.json {
        // What takes no time comes at once.
        shell.tell(&std::mem::take(&mut told.text), || Json::Null)?;
    }
    if let Some(file) = picture {
        comm.agree(if comm.is_root() { draw(file, &brake) } else { Ok(()) })?;
    }
    let warnings = plausibility::warnings(&brake, comm);
    shell.warn(&warnings);
    told.json["warnings"] = json!(warnings);
    brake.require_constrained(comm)?;
    memory(&mut told, comm, &brake)?;
    shell.tell(&told.text, || told.json.clone())
}

/// What is told, for people and for programs.
struct Told {
    text: String,
    json: Json,
}

/// Parts with tetrahedra, mass, centre and moments of inertia, and mesh quality. Collective.
fn parts(told: &mut Told, comm: &Comm, brake: &FullModel) {
    let (text, mut rows) = (&mut told.text, Vec::new());
    let mesh = &brake.mesh;
    let ends = |sign: f64| {
        let most = |i: usize| mesh.nodes.iter().map(|x| sign * x[i]).fold(f64::MIN, f64::max);
        let mut ends = [0, 1, 2].map(most);
        comm.max_all(&mut ends);
        ends
    };
    let (high, low) = (ends(1.0), ends(-1.0));
    let size = [0, 1, 2].map(|i| high[i] + low[i]);
    let (nodes, tets) = (brake.nodes.n_global(), comm.sum(brake.own_tets().count()));
    let _ =
        writeln!(text, "mesh: {nodes} nodes, {tets} tetrahedra, {} mm", size.map(|x| fixed(1e3 * x, 1)).join(" x "));
    told.json["mesh"] = json!({"nodes": nodes, "tetrahedra": tets, "size_m": size});
    let width = mesh.parts.iter().map(String::len).max().unwrap_or(4).max(4);
    let _ = writeln!(
        text,
        "{:width$}  {:>8}  {:>9}  {:>26}  {:>32}  {:>17}",
        "part", "tets", "mass kg", "centre mm", "inertia kg mm2 (xx yy zz)", "quality min / med"
    );
    for (i, name) in mesh.parts.iter().enumerate() {
        let own = brake.own_tets().filter(|&e| mesh.tet_part[e] as usize == i).map(|e| mesh.tet_nodes(e));
        let properties = brake.part_properties(comm, i);
        let quality = Ranked::new(comm, own.map(|x| scaled_jacobian(&x)).collect());
        let centre = properties.centre();
        let inertia = properties.inertia_about(centre);
        let millimetres = centre.map(|x| fixed(1e3 * x, 2)).join(" ");
        let moments = [0, 1, 2].map(|k| fixed(1e6 * inertia[k][k], 2)).join(" ");
        let n = quality.len();
        let (least, median) = (quality.nth(0), quality.nth(n / 2));
        let _ = writeln!(
            text,
            "{name:width$}  {n:>8}  {:>9.4}  {millimetres:>26}  {moments:>32}  {:>8.3} {:>8.3}",
            properties.mass, least, median
        );
        rows.push(json!({
            "part": name,
            "tetrahedra": n,
            "mass_kg": properties.mass,
            "centre_m": centre,
            "inertia_kg_m2": ([0, 1, 2].map(|k| inertia[k][k])),
            "quality_min": least,
            "quality_median": median,
        }));
    }
    told.json["parts"] = rows.into();
    text.push('\n');
}

/// Contact pairs with points, areas, gaps.
fn pairs(told: &mut Told, brake: &FullModel) {
    let (text, mut rows) = (&mut told.text, Vec::new());
    let pairs = &brake.interface.pairs;
    let width = pairs.iter().map(|pair| pair.name.len()).max().unwrap_or(4).max(4);
    let _ = writeln!(
        text,
        "{:width$}  {:>11}  {:>6}  {:>7}  {:>8}  {:>9}  {:>19}  {:>8}",
        "pair", "kind", "points", "dropped", "touching", "area mm2", "gap mm (min max)", "friction"
    );
    for pair in pairs {
        let s = &pair.statistics;
        let kind = format!("{:?}", pair.kind).to_lowercase();
        let gaps = format!("{:.2e} {:.2e}", 1e3 * s.gap[0], 1e3 * s.gap[1]);
        let _ = writeln!(
            text,
            "{:width$}  {:>11}  {:>6}  {:>7}  {:>8}  {:>9.2}  {gaps:>19}  {:>8}",
            pair.name,
            kind,
            pair.points.len(),
            s.dropped.len(),
            s.touching,
            1e6 * s.area,
            pair.friction
        );
        rows.push(json!({
            "pair": pair.name,
            "kind": kind,
            "points": pair.points.len(),
            "dropped": s.dropped.len(),
            "touching": s.touching,
            "area_m2": s.area,
            "gap_min_m": s.gap[0],
            "gap_max_m": s.gap[1],
            "friction": pair.friction,
        }));
    }
    told.json["pairs"] = rows.into();
    text.push('\n');
}

/// The reference nodes of the sliding pairs: how many, and how even their cells are.
fn layouts(told: &mut Told, brake: &FullModel) {
    let (text, mut rows) = (&mut told.text, Vec::new());
    for pair in brake.interface.pairs.iter().filter(|pair| pair.is_sliding()) {
        let own = &brake.interface.points[pair.points.clone()];
        let areas = || own.iter().map(|point| point.law.weight);
        let area = [areas().fold(f64::INFINITY, f64::min), areas().fold(0.0, f64::max)];
        let mean = areas().sum::<f64>() / own.len() as f64;
        let points = || own.iter().map(|point| point.nodes.len());
        let points = [points().min().unwrap_or(0), points().max().unwrap_or(0)];
        let _ = writeln!(
            text,
            "{}: {} reference nodes, cells of {:.1} to {:.1} mm2 (mean {:.1}) with {} to {} contact points",
            pair.name,
            own.len(),
            1e6 * area[0],
            1e6 * area[1],
            1e6 * mean,
            points[0],
            points[1]
        );
        rows.push(json!({
            "pair": pair.name,
            "reference_nodes": own.len(),
            "cell_area_min_m2": area[0],
            "cell_area_mean_m2": mean,
            "cell_area_max_m2": area[1],
            "cell_points_min": points[0],
            "cell_points_max": points[1],
        }));
    }
    told.json["layouts"] = rows.into();
    text.push('\n');
}

/// Writes the cells of the reference nodes.
fn draw(file: &Path, brake: &FullModel) -> Result<()> {
    let picture = ContactCells::new(&brake.mesh, &brake.interface);
    write_whole(file, |mut out| picture.grid().write(&mut out))
}

fn supports(told: &mut Told, brake: &FullModel) {
    let (text, mut rows) = (&mut told.text, Vec::new());
    let held = brake.held.as_flattened().iter().filter(|&&h| h).count();
    let total = brake.loads.iter().fold([0.0; 3], |sum, (_, f)| [0, 1, 2].map(|i| sum[i] + f[i]));
    let _ = writeln!(text, "{} held displacements, {} connectors", held, brake.links.len());
    for load in &brake.model.loads {
        let force = |f: [f64; 3]| f.map(|f| f.to_string()).join(" ");
        let what = match load.kind {
            LoadKind::ForceByNode(f) => format!("{} N, the same on each node", force(f)),
            LoadKind::ForceByArea(f) => format!("{} N, spread over the area", force(f)),
            LoadKind::Pressure(p) => format!("a pressure of {p} Pa"),
        };
        let _ = writeln!(text, "load {:?} on {}: {what}", load.name, load.on);
        rows.push(json!({"load": load.name, "on": load.on, "what": what}));
    }
    told.json["held_displacements"] = held.into();
    told.json["connectors"] = brake.links.len().into();
    told.json["loads"] = rows.into();
    told.json["sum_of_loads_n"] = json!(total);
    let _ = writeln!(text, "sum of the loads: {} N\n", total.map(|f| fixed(f, 3)).join(" "));
}

/// Analyses the matrix without factorising it.
fn memory(told: &mut Told, comm: &Comm, brake: &FullModel) -> Result<()> {
    let families = brake.families()?;
    let system = brake.assemble(comm, &families)?;
    let mut factor = Factor::new(FactorKind::Unsymmetric);
    factor.set_precision(tangent_precision(&system));
    factor.analyse(&system.k)?;
    let stats = factor.stats();
    let entries = system.k.n_entries()?;
    let (n, gigabytes) = (system.dofs.n_global(), stats.estimated_mb / 1024.0);
    let _ = writeln!(
        told.text,
        "{n} equations, {:.1} M entries in K; the LU factor will take about {gigabytes:.1} GB",
        1e-6 * entries
    );
    told.json["equations"] = n.into();
    told.json["entries"] = entries.into();
    told.json["factor_gb"] = gigabytes.into();
    Ok(())
}

/// A number of so many decimals, where rounding leaves no `-0.00`.
fn fixed(x: f64, decimals: i32) -> String {
    let rounded = (x * 10_f64.powi(decimals)).round() + 0.0;
    format!("{:.*}", decimals as usize, rounded / 10_f64.powi(decimals))
}
