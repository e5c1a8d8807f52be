//! The families of elements of a model on its mesh, solid elements by part and connectors, its constraints and its
//! loads.

use crate::contact::GapOperator;
use crate::contact::surface_points::nodal_weights;
use crate::element::connector::{RelativeMotion, relative_motion};
use crate::element::coupling::Cloud;
use crate::element::{facet, solid};
use crate::mesh::{Mesh, Surface};
use crate::model::{Connector, GROUND, Load, LoadKind, Model, Part, Place};
use crate::{Error, Result};

use super::{Connectivity, ElementMatrices, Elements};

/// The solid elements of a mesh with the materials of their parts.
pub struct Solids<'a> {
    mesh: &'a Mesh,
    /// Model part of each mesh part.
    parts: Vec<&'a Part>,
}

impl<'a> Solids<'a> {
    /// Matches the mesh's parts with the model's by name.
    ///
    /// # Errors
    /// [`Error::Input`] where a part of the mesh is not in the model.
    pub fn new(model: &'a Model, mesh: &'a Mesh) -> Result<Solids<'a>> {
        let part = |name: &String| {
            model.parts.iter().find(|part| part.name == *name).ok_or_else(|| {
                Error::input(format!("{}: the mesh's part {name:?} has no material", model.file.display()))
            })
        };
        Ok(Solids { mesh, parts: mesh.parts.iter().map(part).collect::<Result<_>>()? })
    }

    /// Von Mises stress (Pa) of the mean stress of element `e`, for nodal displacements `u` (m).
    pub fn von_mises(&self, e: usize, u: &[[f64; 3]]) -> f64 {
        let element = self.mesh.elements.get(e);
        let displacements: Vec<[f64; 3]> = element.nodes.iter().map(|&n| u[n as usize]).collect();
        let elasticity = &self.part(e).material.elasticity;
        let stress = solid::mean_stress(element.kind, &self.mesh.element_nodes(e), elasticity, &displacements);
        solid::von_mises(&stress)
    }

    /// Model part of element `e`.
    pub fn part(&self, e: usize) -> &'a Part {
        self.parts[self.mesh.elements.get(e).part as usize]
    }
}

impl Connectivity for Solids<'_> {
    fn len(&self) -> usize {
        self.mesh.elements.len()
    }

    fn nodes(&self, e: usize) -> &[u32] {
        self.mesh.elements.get(e).nodes
    }
}

impl Elements for Solids<'_> {
    fn mass_couples_axes(&self) -> bool {
        false
    }

    /// `C = alpha M + beta K` with the part's own coefficients; the mass does not couple axes.
    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        let (kind, x, part) = (self.mesh.elements.get(e).kind, self.mesh.element_nodes(e), self.part(e));
        let n = x.len();
        out.k.resize(9 * n * n, 0.0);
        out.m.resize(n * n, 0.0);
        solid::stiffness(kind, &x, &part.material.elasticity, &mut out.k);
        solid::scalar_mass(kind.shape(), &x, part.material.density, &mut out.m);
        let (alpha, beta) = (part.rayleigh.alpha, part.rayleigh.beta);
        out.c.clear();
        if alpha == 0.0 && beta == 0.0 {
            return;
        }
        out.c.extend(out.k.iter().map(|k| beta * k));
        for a in 0..n {
            for b in 0..n {
                (0..3).for_each(|i| out.c[3 * n * (3 * a + i) + 3 * b + i] += alpha * out.m[n * a + b]);
            }
        }
    }
}

/// A connector on its mesh: a spring and damper between the mean motions of two clouds of nodes.
///
/// A surface's cloud is its midsides (its corners where it is linear) with their shares of the area, any other set's
/// all nodes with equal weights.
pub struct ConnectorElement {
    /// The nodes of both clouds, one after the other.
    pub nodes: Vec<u32>,
    /// The motion of the second cloud relative to the first.
    pub motion: RelativeMotion,
    /// Stiffness along (N/m) and about (N m/rad) x, y, z.
    pub stiffness: [f64; 6],
    /// Damping along (N s/m) and about (N m s/rad) x, y, z.
    pub damping: [f64; 6],
}

impl ConnectorElement {
    fn new(connector: &Connector, mesh: &Mesh) -> std::result::Result<ConnectorElement, String> {
        let set = |name: &String| cloud(mesh, name).ok_or_else(|| format!("the mesh has no {name:?}"));
        let [(first, first_weights), (second, second_weights)] =
            [set(&connector.between[0])?, set(&connector.between[1])?];
        let points = [coordinates(mesh, &first), coordinates(mesh, &second)];
        let clouds = [
            Cloud { nodes: &points[0], weights: &first_weights },
            Cloud { nodes: &points[1], weights: &second_weights },
        ];
        let centres = clouds.map(|cloud| cloud.centroid());
        let middle = [0, 1, 2].map(|i| 0.5 * (centres[0][i] + centres[1][i]));
        let motion = relative_motion(clouds, connector.at.unwrap_or(middle)).map_err(|error| error.to_string())?;
        let [[kx, ky, kz], [rx, ry, rz]] = [connector.stiffness, connector.rotational_stiffness];
        let [cx, cy, cz] = connector.damping;
        let nodes = [first, second].concat();
        Ok(ConnectorElement {
            nodes,
            motion,
            stiffness: [kx, ky, kz, rx, ry, rz],
            damping: [cx, cy, cz, 0.0, 0.0, 0.0],
        })
    }
}

/// The model's connectors on its mesh.
///
/// # Errors
/// [`Error::Input`] where a set is missing, or lies on a line.
pub fn connector_elements(model: &Model, mesh: &Mesh) -> Result<Vec<ConnectorElement>> {
    let element = |connector: &Connector| {
        ConnectorElement::new(connector, mesh)
            .map_err(|message| model.error(connector.place, format_args!("connector {:?}: {message}", connector.name)))
    };
    model.connectors.iter().map(element).collect()
}

impl Connectivity for Vec<ConnectorElement> {
    fn len(&self) -> usize {
        Vec::len(self)
    }

    fn nodes(&self, e: usize) -> &[u32] {
        &self[e].nodes
    }
}

impl Elements for Vec<ConnectorElement> {
    fn mass_couples_axes(&self) -> bool {
        false
    }

    fn matrices(&self, e: usize, out: &mut ElementMatrices) {
        let element = &self[e];
        out.m.clear();
        out.k = element.motion.weighted_product(element.stiffness);
        out.c = match element.damping {
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0] => Vec::new(),
            damping => element.motion.weighted_product(damping),
        };
    }
}

/// Contact points couple the nodes that their relative displacement depends on.
impl Connectivity for GapOperator {
    fn len(&self) -> usize {
        GapOperator::len(self)
    }

    fn nodes(&self, a: usize) -> &[u32] {
        self.point(a).0
    }
}

fn coordinates(mesh: &Mesh, nodes: &[u32]) -> Vec<[f64; 3]> {
    nodes.iter().map(|&n| mesh.nodes[n as usize]).collect()
}

/// Nodes of a named set with their weights.
fn cloud(mesh: &Mesh, name: &str) -> Option<(Vec<u32>, Vec<f64>)> {
    match mesh.surfaces.get(name) {
        Some(surface) => Some(nodal_weights(surface, &mesh.nodes).into_iter().unzip()),
        None => mesh.node_set(name).map(|nodes| {
            let n = nodes.len();
            (nodes, vec![1.0; n])
        }),
    }
}

/// Which displacements of each node the model holds at zero.
///
/// # Errors
/// [`Error::Input`] where a set is missing.
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
/// [`Error::Input`] where a set is missing, or a traction is asked of something that is not a surface.
pub fn loads(model: &Model, mesh: &Mesh) -> Result<Vec<(u32, [f64; 3])>> {
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
            LoadKind::ForceAt { .. } => return Err(unsupported(model, load.place)),
            LoadKind::Pressure(pressure) => {
                let surface = surface_of(model, mesh, load)?;
                forces.extend(surface_load(mesh, surface, |x| facet::pressure_load(x, pressure)));
            }
        }
    }
    Ok(forces)
}

/// Refuses what is not assembled yet.
///
/// # Errors
/// [`Error::Input`] that names the first of it.
pub fn require_supported(model: &Model, mesh: &Mesh) -> Result<()> {
    let ground = |end: &String| *end == GROUND && mesh.node_set(end).is_none();
    let grounded = model.connectors.iter().find(|connector| connector.between.iter().any(ground));
    let places = [
        model.ties.first().map(|own| own.place),
        model.rigid_bodies.first().map(|own| own.place),
        model.masses.first().map(|own| own.place),
        model.equations.first().map(|own| own.place),
        grounded.map(|own| own.place),
    ];
    places.into_iter().flatten().next().map_or(Ok(()), |place| Err(unsupported(model, place)))
}

fn unsupported(model: &Model, place: Place) -> Error {
    model.error(place, "ties, rigid sets, masses, equations, forces at points and the ground are not assembled yet")
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
