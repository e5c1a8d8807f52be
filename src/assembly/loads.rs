//! A model's constraints and loads on its mesh.

use crate::Result;
use crate::element::facet;
use crate::mesh::{Mesh, Surface};
use crate::model::{Load, LoadKind, Model, Place};

use super::joints::Sets;

/// Which displacements of each node the model holds at zero.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) where a set is missing.
pub fn constraints(model: &Model, mesh: &Mesh) -> Result<Vec<[bool; 3]>> {
    let mut constrained = vec![[false; 3]; mesh.nodes.len()];
    for fix in &model.fixes {
        for n in nodes_of(model, mesh, &fix.nodes, fix.place)? {
            (0..3).for_each(|i| constrained[n as usize][i] |= fix.axes[i]);
        }
    }
    Ok(constrained)
}

/// The nodal forces (N) of the model's loads.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) where a set is missing, a traction acts on something that is not a surface, or
/// a force at a point on nodes of one line.
pub fn loads(model: &Model, mesh: &Mesh, sets: &Sets) -> Result<Vec<(u32, [f64; 3])>> {
    let mut forces = Vec::new();
    for load in &model.loads {
        match load.kind {
            LoadKind::ForceByNode(total) => {
                let nodes = nodes_of(model, mesh, &load.on, load.place)?;
                let share = total.map(|f| f / nodes.len() as f64);
                forces.extend(nodes.into_iter().map(|n| (n, share)));
            }
            LoadKind::ForceByArea(total) => {
                let surface = surface_of(model, mesh, load)?;
                let area: f64 = surface.facets.iter().map(|f| facet::area(&f.positions(&mesh.nodes))).sum();
                let traction = total.map(|f| f / area);
                forces.extend(surface_load(mesh, surface, |x| facet::traction_load(x, traction)));
            }
            LoadKind::ForceAt { force, moment, at } => {
                let acting = std::array::from_fn(|i| if i < 3 { force[i] != 0.0 } else { moment[i - 3] != 0.0 });
                let spread = sets.motion(&load.on, at).and_then(|motion| {
                    motion.require(&load.on, acting)?;
                    Ok(motion.spread(force, moment))
                });
                let refuse = |message| model.error(load.place, format_args!("load {:?}: {message}", load.name));
                forces.extend(spread.map_err(refuse)?);
            }
            LoadKind::Pressure(pressure) => {
                let surface = surface_of(model, mesh, load)?;
                forces.extend(surface_load(mesh, surface, |x| facet::pressure_load(x, pressure)));
            }
        }
    }
    Ok(forces)
}

/// The nodal forces of all facets of a surface.
fn surface_load(
    mesh: &Mesh,
    surface: &Surface,
    of_facet: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]>,
) -> impl Iterator<Item = (u32, [f64; 3])> {
    surface.facets.iter().flat_map(move |facet| {
        facet.nodes().iter().copied().zip(of_facet(&facet.positions(&mesh.nodes))).collect::<Vec<_>>()
    })
}

fn nodes_of(model: &Model, mesh: &Mesh, name: &str, place: Place) -> Result<Vec<u32>> {
    mesh.node_set(name).ok_or_else(|| model.error(place, format_args!("the mesh has no {name:?}")))
}

fn surface_of<'a>(model: &Model, mesh: &'a Mesh, load: &Load) -> Result<&'a Surface> {
    mesh.surfaces.get(&load.on).ok_or_else(|| {
        model.error(load.place, format_args!("{:?} is not a surface of the mesh: a traction needs one", load.on))
    })
}
