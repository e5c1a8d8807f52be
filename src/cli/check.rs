//! `squeal check`: what a model is, before anything is computed.

use std::fmt::Write;
use std::path::Path;

use crate::Result;
use crate::element::tet10::{MassProperties, mass_properties};
use crate::mesh::quality;
use crate::model::LoadKind;
use crate::petsc::{Comm, Factor, FactorKind};

use crate::sweep::Brake;

pub fn run(comm: &Comm, path: &Path) -> Result<()> {
    let brake = Brake::read(comm, path)?;
    let mut text = format!("{}\n\n", brake.model.title);
    parts(&mut text, &brake);
    pairs(&mut text, &brake);
    supports(&mut text, &brake);
    tell(comm, &text)?;
    brake.require_held()?;
    memory(comm, &brake)
}

/// Parts with nodes, mass, centre and principal moments of inertia, and mesh quality.
fn parts(text: &mut String, brake: &Brake) {
    let mesh = &brake.mesh;
    let size = [0, 1, 2].map(|i| {
        let x = || mesh.nodes.iter().map(|node| node[i]);
        fixed(1e3 * (x().fold(f64::MIN, f64::max) - x().fold(f64::MAX, f64::min)), 1)
    });
    let (nodes, tets) = (mesh.nodes.len(), mesh.tets.len());
    let _ = writeln!(text, "mesh: {nodes} nodes, {tets} tetrahedra, {} mm", size.join(" x "));
    let width = mesh.parts.iter().map(String::len).max().unwrap_or(4).max(4);
    let _ = writeln!(
        text,
        "{:width$}  {:>8}  {:>9}  {:>26}  {:>32}  {:>17}",
        "part", "tets", "mass kg", "centre mm", "inertia kg mm2 (xx yy zz)", "quality min / med"
    );
    let quality = quality::quality(mesh);
    for (i, name) in mesh.parts.iter().enumerate() {
        let part = brake.model.parts.iter().find(|part| part.name == *name).expect("checked against the mesh");
        let mut properties = MassProperties::default();
        let own = mesh.tets.iter().zip(&mesh.tet_part).filter(|(_, p)| **p as usize == i);
        for (tet, _) in own.clone() {
            properties += mass_properties(&tet.map(|n| mesh.nodes[n as usize]), part.material.density);
        }
        let centre = properties.centre();
        let inertia = properties.inertia_about(centre);
        let millimetres = centre.map(|x| fixed(1e3 * x, 2)).join(" ");
        let moments = [0, 1, 2].map(|k| fixed(1e6 * inertia[k][k], 2)).join(" ");
        let _ = writeln!(
            text,
            "{name:width$}  {:>8}  {:>9.4}  {millimetres:>26}  {moments:>32}  {:>8.3} {:>8.3}",
            own.count(),
            properties.mass,
            quality[i].min,
            quality[i].median
        );
    }
    text.push('\n');
}

/// Contact pairs with points, areas, gaps.
fn pairs(text: &mut String, brake: &Brake) {
    let pairs = &brake.interface.pairs;
    let width = pairs.iter().map(|pair| pair.name.len()).max().unwrap_or(4).max(4);
    let _ = writeln!(
        text,
        "{:width$}  {:>11}  {:>6}  {:>7}  {:>8}  {:>9}  {:>19}  {:>8}",
        "pair", "kind", "points", "dropped", "touching", "area mm2", "gap mm (min max)", "friction"
    );
    for pair in pairs {
        let s = &pair.statistics;
        let gaps = format!("{:.2e} {:.2e}", 1e3 * s.gap[0], 1e3 * s.gap[1]);
        let _ = writeln!(
            text,
            "{:width$}  {:>11}  {:>6}  {:>7}  {:>8}  {:>9.2}  {gaps:>19}  {:>8}",
            pair.name,
            format!("{:?}", pair.kind).to_lowercase(),
            pair.points.len(),
            s.dropped.len(),
            s.touching,
            1e6 * s.area,
            pair.friction
        );
    }
    text.push('\n');
}

fn supports(text: &mut String, brake: &Brake) {
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
    }
    let _ = writeln!(text, "sum of the loads: {} N\n", total.map(|f| fixed(f, 3)).join(" "));
}

/// Analyses the matrix without factorising it.
fn memory(comm: &Comm, brake: &Brake) -> Result<()> {
    let families = brake.families()?;
    let system = brake.assemble(comm, &families)?;
    let mut factor = Factor::new(FactorKind::Unsymmetric);
    factor.analyse(&system.k)?;
    let stats = factor.stats();
    let entries = system.k.n_entries()?;
    let text = format!(
        "{} equations, {:.1} M entries in K; the LU factor will take about {:.1} GB\n",
        system.dofs.n_global(),
        1e-6 * entries,
        stats.estimated_mb / 1024.0
    );
    tell(comm, &text)
}

fn tell(comm: &Comm, text: &str) -> Result<()> {
    if comm.is_root() { super::tell(text) } else { Ok(()) }
}

/// A number of so many decimals, where rounding leaves no `-0.00`.
fn fixed(x: f64, decimals: i32) -> String {
    let rounded = (x * 10_f64.powi(decimals)).round() + 0.0;
    format!("{:.*}", decimals as usize, rounded / 10_f64.powi(decimals))
}
