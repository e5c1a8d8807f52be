//! A model's constraints and loads on its mesh.

use std::collections::BTreeMap;

use crate::Result;
use crate::element::facet;
use crate::mesh::{Mesh, Surface};
use crate::model::{Fix, Load, LoadKind, Model, Place};

use super::joints::Sets;
use super::{Elements, element_forces};

/// Which displacements of each node the model prescribes.
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

/// The prescribed displacements (m) that are not zero, by node.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) where a set is missing, or two supports prescribe different displacements.
pub fn prescribed(model: &Model, mesh: &Mesh) -> Result<BTreeMap<u32, [f64; 3]>> {
    if !model.fixes.iter().any(Fix::moves) {
        return Ok(BTreeMap::new());
    }
    let mut known: BTreeMap<(u32, usize), f64> = BTreeMap::new();
    for fix in &model.fixes {
        for n in nodes_of(model, mesh, &fix.nodes, fix.place)? {
            for axis in (0..3).filter(|&axis| fix.axes[axis]) {
                let value = *known.entry((n, axis)).or_insert(fix.displacement[axis]);
                if value != fix.displacement[axis] {
                    let what = format_args!(
                        "fix of {:?}: another [[fix]] prescribes another displacement {} of a node of both. Take the node \
                         out of one of the two sets",
                        fix.nodes,
                        ["x", "y", "z"][axis]
                    );
                    return Err(model.error(fix.place, what));
                }
            }
        }
    }
    let mut moved: BTreeMap<u32, [f64; 3]> = BTreeMap::new();
    for ((node, axis), value) in known.into_iter().filter(|(_, value)| *value != 0.0) {
        moved.entry(node).or_default()[axis] = value;
    }
    Ok(moved)
}

/// Adds the prescribed displacements (m, by node) to nodal ones, which are zero there.
pub fn add_prescribed(nodal: &mut [[f64; 3]], prescribed: &BTreeMap<u32, [f64; 3]>) {
    for (&node, moved) in prescribed {
        (0..3).for_each(|i| nodal[node as usize][i] += moved[i]);
    }
}

/// What prescribed displacements `u_c` (m, by node) do to the free dofs: forces `-K_e u_c` (N) of all elements of which
/// a node is moved.
pub fn forces_of_prescribed(families: &[&dyn Elements], prescribed: &BTreeMap<u32, [f64; 3]>) -> Vec<(u32, [f64; 3])> {
    let mut forces = Vec::new();
    if prescribed.is_empty() {
        return forces;
    }
    let u = |n: u32| prescribed.get(&n).copied().unwrap_or_default();
    element_forces(families, |n| prescribed.contains_key(&n), u, |n, force| forces.push((n, force.map(|f| -f))));
    forces
}

/// The nodal forces (N) of the model's loads, without gravity.
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
            // Each rank has its own elements: `weights`.
            LoadKind::Gravity(_) => {}
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::testing::model;
    use crate::model::Fix;

    #[test]
    fn prescribed_displacements_agree_where_two_supports_have_a_node_or_are_refused() {
        let mut mesh = Mesh { nodes: vec![[0.0; 3]; 3], ..Mesh::default() };
        mesh.node_sets.extend([("a".to_owned(), vec![0, 1]), ("b".to_owned(), vec![1, 2])]);
        let fix =
            |nodes: &str, axes, displacement| Fix { nodes: nodes.into(), axes, displacement, place: Place::default() };
        let of = |second: Fix| {
            let first = fix("a", [true, false, true], [0.5, 0.0, 0.0]);
            prescribed(&Model { fixes: vec![first, second], ..model(vec![], false) }, &mesh)
        };
        let both = of(fix("b", [true, true, false], [0.5, 2.0, 0.0])).unwrap();
        assert_eq!(both, BTreeMap::from([(0, [0.5, 0.0, 0.0]), (1, [0.5, 2.0, 0.0]), (2, [0.5, 2.0, 0.0])]));
        let message = of(fix("b", [true, false, false], [0.0; 3])).unwrap_err().to_string();
        assert!(message.contains("another [[fix]] prescribes another displacement x of a node of both"), "{message}");
    }
}
