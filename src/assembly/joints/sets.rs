//! The mean motions of node sets: what connectors, point masses and forces at points act on.

use crate::Result;
use crate::algebra::{dot, norm, product};
use crate::contact::surface_points::nodal_weights;
use crate::element::coupling::{Cloud, MeanMotion, mean_motion};
use crate::mesh::{Mesh, Numbering};
use crate::model::{GROUND, Model};

use super::rigid::{RigidNodes, base};

/// The named node sets of a mesh, and which of them move rigidly.
pub struct Sets<'a> {
    mesh: &'a Mesh,
    /// The model's rigid sets, in its order.
    pub rigid_sets: Vec<RigidNodes>,
}

/// The mean motion of a node set.
pub struct SetMotion {
    /// The nodes that it depends on.
    pub nodes: Vec<u32>,
    /// Their blocks.
    pub motion: MeanMotion,
    /// Of a set of one node, which does not rotate: the way from it to the reference point, m.
    lever: Option<[f64; 3]>,
}

/// A way across an axis below this fraction of the distance from the origin is rounding.
const ON_AXIS: f64 = 1e-6;

impl SetMotion {
    /// Refuses what one node cannot take: a moment, and a force off its line; `acting` says what acts, along and about
    /// x, y, z.
    ///
    /// # Errors
    /// A text.
    pub fn require(&self, name: &str, acting: [bool; 6]) -> std::result::Result<(), String> {
        let Some(lever) = self.lever else { return Ok(()) };
        if acting[3..].contains(&true) {
            return Err(format!("{name:?} is one node, which does not rotate; name nodes that span a plane"));
        }
        let is_across = |i: usize| (0..3).any(|j| j != i && lever[j] != 0.0);
        match (0..3).any(|i| acting[i] && is_across(i)) {
            true => Err(format!(
                "{name:?} is one node, and the force does not pass through it. Leave out `at`, or name nodes that span a plane"
            )),
            false => Ok(()),
        }
    }

    /// Nodal forces (N) with this resultant (N) and moment (N m) at the reference point.
    pub fn spread(&self, force: [f64; 3], moment: [f64; 3]) -> Vec<(u32, [f64; 3])> {
        self.nodes.iter().copied().zip(self.motion.spread(force, moment)).collect()
    }

    /// Takes displacement and rotation along other axes, the rows of R: `R u_R` and `R phi`.
    pub fn turn(&mut self, axes: &[[f64; 3]; 3]) {
        let blocks = self.motion.displacement.iter_mut().chain(&mut self.motion.rotation);
        blocks.for_each(|block| *block = product(axes, block));
        if let Some(lever) = &mut self.lever {
            let (turned, size) = (axes.map(|axis| dot(axis, *lever)), norm(*lever));
            *lever = turned.map(|x| if x.abs() > ON_AXIS * size { x } else { 0.0 });
        }
    }
}

/// Nodes with weights.
struct WeightedNodes {
    nodes: Vec<u32>,
    weights: Vec<f64>,
    /// Coordinates, m.
    positions: Vec<[f64; 3]>,
}

impl WeightedNodes {
    fn cloud(&self) -> Cloud<'_> {
        Cloud { nodes: &self.positions, weights: &self.weights }
    }
}

impl<'a> Sets<'a> {
    /// The sets of a mesh under a model.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) where a rigid set is missing or lies on a line.
    pub fn new(model: &Model, mesh: &'a Mesh, numbering: &Numbering) -> Result<Sets<'a>> {
        let mut rigid_sets = Vec::new();
        for own in &model.rigid_sets {
            let set = mesh.node_set(&own.nodes).ok_or_else(|| missing(&own.nodes)).and_then(|nodes| {
                let base = base(&nodes, &mesh.nodes, numbering.labels())?;
                Ok(RigidNodes { nodes, base })
            });
            let refuse = |message: String| model.error(own.place, format_args!("rigid {:?}: {message}", own.name));
            rigid_sets.push(set.map_err(refuse)?);
        }
        Ok(Sets { mesh, rigid_sets })
    }

    /// Whether a name stands for what does not move.
    pub fn is_ground(&self, name: &str) -> bool {
        name == GROUND && self.mesh.node_set(name).is_none()
    }

    /// The nodes of all rigid sets.
    pub fn rigid_nodes(&self) -> impl Iterator<Item = u32> + '_ {
        self.rigid_sets.iter().flat_map(|set| set.nodes.iter().copied())
    }

    /// The centroid of a set, m.
    ///
    /// # Errors
    /// A text where there is no such set.
    pub fn centroid(&self, name: &str) -> std::result::Result<[f64; 3], String> {
        self.weighted(name).map(|own| own.cloud().centroid())
    }

    /// The mean motion of a set at a point (m), or at its centroid. A set within a rigid set has that of the rigid
    /// set's base, so that sets of thousands of nodes are cheap. A set of one node has its displacement and no
    /// rotation: [`SetMotion::require`].
    ///
    /// # Errors
    /// A text: there is no such set, or it lies on a line.
    pub fn motion(&self, name: &str, at: Option<[f64; 3]>) -> std::result::Result<SetMotion, String> {
        let own = self.weighted(name)?;
        let at = at.unwrap_or_else(|| own.cloud().centroid());
        let is_within = |set: &&RigidNodes| own.nodes.iter().all(|node| set.nodes.binary_search(node).is_ok());
        let acting = match self.rigid_sets.iter().find(is_within) {
            Some(set) => self.alike(set.base.to_vec()),
            None => own,
        };
        if let [x] = acting.positions[..] {
            let significant = |x: f64, from: f64| if (x - from).abs() > ON_AXIS * norm(at) { x - from } else { 0.0 };
            let lever = [0, 1, 2].map(|i| significant(at[i], x[i]));
            let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let motion = MeanMotion { displacement: vec![identity], rotation: vec![[[0.0; 3]; 3]] };
            return Ok(SetMotion { nodes: acting.nodes, motion, lever: Some(lever) });
        }
        let motion = mean_motion(acting.cloud(), at).map_err(|error| format!("{name:?}: {error}"))?;
        Ok(SetMotion { nodes: acting.nodes, motion, lever: None })
    }

    /// The nodes of a set with their weights: of a surface the midsides (the corners where it is linear) with their
    /// shares of the area, of any other set all nodes with equal weights.
    fn weighted(&self, name: &str) -> std::result::Result<WeightedNodes, String> {
        let Some(surface) = self.mesh.surfaces.get(name) else {
            return self.mesh.node_set(name).map(|nodes| self.alike(nodes)).ok_or_else(|| missing(name));
        };
        let (nodes, weights) = nodal_weights(surface, &self.mesh.nodes).into_iter().unzip();
        Ok(WeightedNodes { weights, ..self.alike(nodes) })
    }

    /// Nodes with equal weights.
    fn alike(&self, nodes: Vec<u32>) -> WeightedNodes {
        let positions = nodes.iter().map(|&n| self.mesh.nodes[n as usize]).collect();
        WeightedNodes { weights: vec![1.0; nodes.len()], nodes, positions }
    }
}

fn missing(name: &str) -> String {
    format!("the mesh has no {name:?}")
}
