//! Ties: two surfaces that move as one, also where their meshes do not match.
//!
//! Each node n of the slave is projected once on the master, as contact points are, on the point `x_p` of a facet with
//! the shape values `N_j`. Its jump counts the facet's mean rotation phi, so that a gap plays no role:
//!
//! ```text
//!   [u]_n = u_n - sum_j N_j u_j - phi x (x_n - x_p)
//! ```
//!
//! A rigid motion of both surfaces makes no jump. Between the nodes the jump is interpolated as the slave's
//! displacements are, and a facet of the slave has the energy
//!
//! ```text
//!   p/2 integral of [u].[u] dA = p/2 sum_ab [u]_a . [u]_b integral of N_a N_b dA
//! ```
//!
//! With the factor `L L^T` of that matrix of products the element has the rows `L^T [u]` and the stiffness p for each.
//! As many jumps are penalised as the slave has nodes: a tie does not lock, and no motion of the slave escapes it.
//! Where the meshes match node by node a uniform stress stays uniform, with the jump `sigma / p` everywhere.

use std::collections::{BTreeSet, HashMap};

use nalgebra::DMatrix;

use crate::algebra::{norm, product, skew, sub};
use crate::contact::NothingFound;
use crate::contact::search::{FoundPoint, Options, Team, find_nodes};
use crate::contact::surface_points::Place;
use crate::element::coupling::{Cloud, mean_motion};
use crate::element::facet;
use crate::mesh::{Facet, Mesh};
use crate::model::{Model, PENALTY, Tie, softest_young};

use super::JointElement;
use super::rows::Rows;

/// What became of a tie.
#[derive(Debug, Clone, PartialEq)]
pub struct TieSummary {
    /// Nodes of the slave that are tied.
    pub n_tied: usize,
    /// Nodes of the slave that are not: too far from the master, or on no facet of which all nodes are near it.
    pub n_dropped: usize,
    /// Area that is tied, m2.
    pub area: f64,
    /// Largest distance of a tied node from the master, m.
    pub distance: f64,
    /// Edge of a mean facet of the slave and of the master, m.
    pub sizes: [f64; 2],
    /// Penalty, N/m3.
    pub stiffness: f64,
}

/// Distances below this fraction of a facet's size are rounding: the point lies on the master.
const ON_MASTER: f64 = 1e-9;

/// The elements of a tie, one for each facet of the slave of which all nodes are near the master.
///
/// # Errors
/// A text where no facet is.
pub fn elements(
    model: &Model,
    mesh: &Mesh,
    tie: &Tie,
    team: &dyn Team,
) -> Result<(TieSummary, Vec<JointElement>), String> {
    let (slave, master) = (&mesh.surfaces[&tie.slave], &mesh.surfaces[&tie.master]);
    let search = |search_distance| find_nodes(slave, master, &mesh.nodes, &Options { search_distance }, team);
    let found = search(tie.search_distance);
    let near: HashMap<u32, &FoundPoint> =
        found.points.iter().filter_map(|point| Some((number(point.place)?, point))).collect();
    let is_tied = |facet: &&Facet| facet.nodes().iter().all(|n| near.contains_key(n));
    let tied: Vec<&Facet> = slave.facets.iter().filter(is_tied).collect();
    if tied.is_empty() {
        let Tie { slave, master, search_distance, .. } = tie;
        let reason =
            NothingFound { surfaces: [slave, master], search_distance: *search_distance, mesh_unit: model.mesh_unit };
        return Err(reason.text(&search(Some(f64::INFINITY))));
    }
    let area = |facet: &Facet| facet::area(&facet.positions(&mesh.nodes));
    let sizes = [slave, master].map(|surface| surface.facet_size(surface.facets.iter().map(area).sum()));
    let young = || softest_young(&model.parts, mesh, &[&tie.slave, &tie.master]);
    let stiffness = tie.stiffness.unwrap_or_else(|| PENALTY * young() / sizes[0]);
    let nodes: BTreeSet<u32> = tied.iter().flat_map(|facet| facet.nodes().iter().copied()).collect();
    let summary = TieSummary {
        n_tied: nodes.len(),
        n_dropped: found.points.len() + found.n_dropped - nodes.len(),
        area: tied.iter().map(|facet| area(facet)).sum(),
        distance: nodes.iter().map(|n| near[n].distance).fold(0.0, f64::max),
        sizes,
        stiffness,
    };
    let element = |facet: &&Facet| {
        let rows = jumps(mesh, facet, &near)?;
        let n_rows = 3 * facet.nodes().len();
        Ok(JointElement::springs(rows, vec![stiffness; n_rows]))
    };
    Ok((summary, tied.iter().map(element).collect::<Result<_, String>>()?))
}

fn number(place: Place) -> Option<u32> {
    match place {
        Place::Node(n) => Some(n),
        Place::Inside { .. } => None,
    }
}

/// The rows `L^T [u]` of a facet of the slave.
fn jumps(mesh: &Mesh, facet: &Facet, near: &HashMap<u32, &FoundPoint>) -> Result<Rows, String> {
    let n = facet.nodes().len();
    let products = DMatrix::from_row_slice(n, n, &facet::shape_products(&facet.positions(&mesh.nodes)));
    let factor = products.cholesky().ok_or("a facet of the slave has no area")?.unpack();
    let mut rows = Rows::new(3 * n);
    for (b, node) in facet.nodes().iter().enumerate() {
        let blocks = jump(mesh, *node, near[node]);
        for a in 0..=b {
            blocks.iter().for_each(|(node, block)| rows.add_block(3 * a, *node, factor[(b, a)], block));
        }
    }
    Ok(rows)
}

/// The blocks of the jump at a node of the slave.
fn jump(mesh: &Mesh, node: u32, point: &FoundPoint) -> Vec<(u32, [[f64; 3]; 3])> {
    let master = &point.master;
    let x: Vec<[f64; 3]> = master.nodes.iter().map(|&n| mesh.nodes[n as usize]).collect();
    let projection = [0, 1, 2].map(|i| x.iter().zip(&master.shape).map(|(x, shape)| shape * x[i]).sum());
    let lever = sub(point.position, projection);
    let mut blocks = vec![(node, diagonal(1.0))];
    blocks.extend(master.nodes.iter().zip(&master.shape).map(|(&n, &shape)| (n, diagonal(-shape))));
    if norm(lever) > ON_MASTER * point.size {
        let weights = vec![1.0; x.len()];
        // A facet spans a plane: it has a mean rotation.
        if let Ok(motion) = mean_motion(Cloud { nodes: &x, weights: &weights }, projection) {
            // - phi x d = [d]x phi = [d]x sum_j P_j u_j
            let turned = motion.rotation.iter().map(|block| product(&skew(lever), block));
            blocks.extend(master.nodes.iter().copied().zip(turned));
        }
    }
    blocks
}

/// `factor I`
fn diagonal(factor: f64) -> [[f64; 3]; 3] {
    [[factor, 0.0, 0.0], [0.0, factor, 0.0], [0.0, 0.0, factor]]
}
