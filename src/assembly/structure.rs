//! The full finite element structure as families of elements: tetrahedra by part, and connectors.

use crate::element::connector::{ConnectorError, Properties, RelativeMotion, relative_motion, weighted_product};
use crate::element::coupling::Cloud;
use crate::element::{tet10, tri6};
use crate::mesh::{Mesh, Surface};
use crate::model::{Connector, Load, LoadKind, Model, Part};
use crate::{Error, Result};

use super::{Connectivity, ElementMatrices, Elements};

/// The 10-node tetrahedra of a mesh with the materials of their parts.
pub struct Tets<'a> {
    mesh: &'a Mesh,
    /// Model part of each mesh part.
    parts: Vec<&'a Part>,
}

impl<'a> Tets<'a> {
    /// Matches the mesh's parts with the model's by name.
    ///
    /// # Errors
    /// [`Error::Input`] where a part of the mesh is not in the model.
    pub fn new(model: &'a Model, mesh: &'a Mesh) -> Result<Tets<'a>> {
        let part = |name: &String| {
            model.parts.iter().find(|part| part.name == *name).ok_or_else(|| {
                Error::input(format!("{}: the mesh's part {name:?} has no material", model.file.display()))
            })
        };
        Ok(Tets { mesh, parts: mesh.parts.iter().map(part).collect::<Result<_>>()? })
    }

    /// Coordinates of tetrahedron `e`.
    pub fn coordinates(&self, e: usize) -> [[f64; 3]; 10] {
        self.mesh.tets[e].map(|n| self.mesh.nodes[n as usize])
    }

    /// Model part of tetrahedron `e`.
    pub fn part(&self, e: usize) -> &'a Part {
        self.parts[self.mesh.tet_part[e] as usize]
    }
}

impl Connectivity for Tets<'_> {
    fn len(&self) -> usize {
        self.mesh.tets.len()
    }

    fn nodes(&self, e: usize) -> &[u32] {
        &self.mesh.tets[e]
    }
}

impl Elements for Tets<'_> {
    /// `C = alpha M + beta K` with the part's own coefficients.
    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        let (x, part) = (self.coordinates(e), self.part(e));
        let mut mass = [0.0; 100];
        out.reset(10);
        tet10::stiffness(&x, &part.material.elasticity, &mut out.k);
        tet10::scalar_mass(&x, part.material.density, &mut mass);
        for a in 0..10 {
            for b in 0..10 {
                for i in 0..3 {
                    out.m[30 * (3 * a + i) + 3 * b + i] = mass[10 * a + b];
                }
            }
        }
        let (alpha, beta) = (part.rayleigh.alpha, part.rayleigh.beta);
        if alpha != 0.0 || beta != 0.0 {
            for (c, (m, k)) in out.c.iter_mut().zip(out.m.iter().zip(&out.k)) {
                *c = alpha * m + beta * k;
            }
        }
    }
}

/// A connector on its mesh: two clouds of nodes with weights, and what acts between their mean motions.
pub struct Link {
    /// Nodes and weights of the two clouds. A surface's are its midside nodes with their contact weights, any other set's all
    /// nodes with equal weights.
    pub clouds: [(Vec<u32>, Vec<f64>); 2],
    /// The common reference point, m.
    pub reference: [f64; 3],
    /// Stiffness and damping.
    pub properties: Properties,
}

impl Link {
    /// The motion of the second cloud relative to the first: six rows on the nodes of both.
    ///
    /// # Errors
    /// Where a cloud lies on a line.
    pub fn motion(&self, mesh: &Mesh) -> std::result::Result<RelativeMotion, ConnectorError> {
        let points = self.clouds.each_ref().map(|(nodes, _)| coordinates(mesh, nodes));
        let cloud = |i: usize| Cloud { nodes: &points[i], weights: &self.clouds[i].1 };
        relative_motion([cloud(0), cloud(1)], self.reference)
    }

    /// The nodes of both clouds, as the columns of [`Link::motion`] have them.
    pub fn nodes(&self) -> Vec<u32> {
        self.clouds.iter().flat_map(|(nodes, _)| nodes.iter().copied()).collect()
    }

    fn new(connector: &Connector, mesh: &Mesh) -> std::result::Result<Link, String> {
        let set = |name: &String| cloud(mesh, name).ok_or_else(|| format!("the mesh has no {name:?}"));
        let clouds = [set(&connector.between[0])?, set(&connector.between[1])?];
        let centres = clouds.each_ref().map(|(nodes, weights)| centroid(&coordinates(mesh, nodes), weights));
        let middle = [0, 1, 2].map(|i| 0.5 * (centres[0][i] + centres[1][i]));
        let properties = Properties {
            stiffness: connector.stiffness,
            rotational_stiffness: connector.rotational_stiffness,
            damping: connector.damping,
            rotational_damping: [0.0; 3],
        };
        let link = Link { clouds, reference: connector.at.unwrap_or(middle), properties };
        link.motion(mesh).map_err(|error| error.to_string())?;
        Ok(link)
    }
}

/// The model's connectors on its mesh.
///
/// # Errors
/// [`Error::Input`] where a set is missing, or lies on a line.
pub fn links(model: &Model, mesh: &Mesh) -> Result<Vec<Link>> {
    let link = |connector: &Connector| {
        Link::new(connector, mesh).map_err(|message| {
            let (file, line, name) = (model.file.display(), connector.line, &connector.name);
            Error::input(format!("{file}:{line}: connector {name:?}: {message}"))
        })
    };
    model.connectors.iter().map(link).collect()
}

/// Springs and dampers between mean motions of node sets.
pub struct Connectors {
    members: Vec<(Vec<u32>, ElementMatrices)>,
}

impl Connectors {
    /// Computes the matrices of links.
    pub fn new(links: &[Link], mesh: &Mesh) -> Connectors {
        let member = |link: &Link| {
            let rows = link.motion(mesh).expect("checked when the link was made").rows;
            let p = &link.properties;
            let k = weighted_product(&rows, p.stiffness, p.rotational_stiffness);
            let c = weighted_product(&rows, p.damping, p.rotational_damping);
            let m = vec![0.0; k.len()];
            (link.nodes(), ElementMatrices { k, m, c })
        };
        Connectors { members: links.iter().map(member).collect() }
    }
}

impl Connectivity for Connectors {
    fn len(&self) -> usize {
        self.members.len()
    }

    fn nodes(&self, e: usize) -> &[u32] {
        &self.members[e].0
    }
}

impl Elements for Connectors {
    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        out.clone_from(&self.members[e].1);
    }
}

fn coordinates(mesh: &Mesh, nodes: &[u32]) -> Vec<[f64; 3]> {
    nodes.iter().map(|&n| mesh.nodes[n as usize]).collect()
}

fn centroid(points: &[[f64; 3]], weights: &[f64]) -> [f64; 3] {
    let total: f64 = weights.iter().sum();
    [0, 1, 2].map(|i| points.iter().zip(weights).map(|(x, w)| w * x[i]).sum::<f64>() / total)
}

/// Nodes of a named set with their weights.
fn cloud(mesh: &Mesh, name: &str) -> Option<(Vec<u32>, Vec<f64>)> {
    match mesh.surfaces.get(name) {
        Some(surface) => Some(midside_weights(mesh, surface)),
        None => mesh.node_set(name).map(|nodes| {
            let n = nodes.len();
            (nodes, vec![1.0; n])
        }),
    }
}

/// `w_a = sum of A_facet / 3` over the facets around each midside node.
fn midside_weights(mesh: &Mesh, surface: &Surface) -> (Vec<u32>, Vec<f64>) {
    let mut weights = std::collections::BTreeMap::new();
    for facet in &surface.facets {
        let third = tri6::area(&facet.map(|n| mesh.nodes[n as usize])) / 3.0;
        facet[3..].iter().for_each(|&n| *weights.entry(n).or_insert(0.0) += third);
    }
    weights.into_iter().unzip()
}

/// Which displacements of each node the model holds at zero.
///
/// # Errors
/// [`Error::Input`] where a set is missing.
pub fn held(model: &Model, mesh: &Mesh) -> Result<Vec<[bool; 3]>> {
    let mut held = vec![[false; 3]; mesh.nodes.len()];
    for fix in &model.fixes {
        for n in nodes_of(model, mesh, &fix.nodes, fix.line)? {
            (0..3).for_each(|i| held[n as usize][i] |= fix.axes[i]);
        }
    }
    Ok(held)
}

/// The nodal forces (N) of the model's loads.
///
/// # Errors
/// [`Error::Input`] where a set is missing, or a traction is asked of something that is not a surface.
pub fn loads(model: &Model, mesh: &Mesh) -> Result<Vec<(u32, [f64; 3])>> {
    let mut forces = Vec::new();
    for load in &model.loads {
        match load.kind {
            LoadKind::ForceByNode(total) => {
                let nodes = nodes_of(model, mesh, &load.on, load.line)?;
                let share = total.map(|f| f / nodes.len() as f64);
                forces.extend(nodes.into_iter().map(|n| (n, share)));
            }
            LoadKind::ForceByArea(total) => {
                let surface = surface_of(model, mesh, load)?;
                let facets: Vec<_> = surface.facets.iter().map(|f| (f, f.map(|n| mesh.nodes[n as usize]))).collect();
                let area: f64 = facets.iter().map(|(_, x)| tri6::area(x)).sum();
                let traction = total.map(|f| f / area);
                forces.extend(facets.iter().flat_map(|(f, x)| f.iter().copied().zip(tri6::traction_load(x, traction))));
            }
            LoadKind::Pressure(pressure) => {
                for facet in &surface_of(model, mesh, load)?.facets {
                    let x = facet.map(|n| mesh.nodes[n as usize]);
                    forces.extend(facet.iter().copied().zip(tri6::pressure_load(&x, pressure)));
                }
            }
        }
    }
    Ok(forces)
}

fn nodes_of(model: &Model, mesh: &Mesh, name: &str, line: usize) -> Result<Vec<u32>> {
    mesh.node_set(name)
        .ok_or_else(|| Error::input(format!("{}:{line}: the mesh has no {name:?}", model.file.display())))
}

fn surface_of<'a>(model: &Model, mesh: &'a Mesh, load: &Load) -> Result<&'a Surface> {
    mesh.surfaces.get(&load.on).ok_or_else(|| {
        let (file, line, on) = (model.file.display(), load.line, &load.on);
        Error::input(format!("{file}:{line}: {on:?} is not a surface of the mesh: a traction needs one"))
    })
}
