//! `*CONTACT PAIR, ADJUST=SET`: nodes of the slave that start in contact are moved onto the master, without stress.
//!
//! ```text
//! x' = x - g n,   g = (x - x_m) . n
//! ```
//!
//! with the projection x_m of the node at x on the master and the master's normal n there. Overlaps are closed as gaps
//! are, whatever their size. A node that lies beside the master stays where it is.
//!
//! Source: Abaqus Keywords Reference Guide 6.14, `*CONTACT PAIR`; CalculiX CrunchiX 2.20 User's Manual, section 7.21.

use std::collections::{HashMap, HashSet};

use super::Conversion;
use super::bodies::check_inverted;
use crate::Result;
use crate::contact::search::{Alone, FoundPoint, Options, find_nodes};
use crate::deck::sets::Kind;
use crate::deck::types::{Adjust, ContactPair, Entry};

/// Largest lateral offset between a node and its projection, over the facet's size: beyond it the node stays.
const MAX_LATERAL_OFFSET: f64 = 1e-6;

/// The motion of a node onto the master.
struct NodeShift {
    /// The node, in the mesh.
    node: u32,
    /// `-g n`, m.
    vector: [f64; 3],
    /// |g|, m.
    length: f64,
}

impl Conversion<'_> {
    /// Moves the nodes of all pairs, in their order.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input): a set that is not there or has no node of the slave, and elements that
    /// the motion inverts.
    pub(super) fn adjust_nodes(&mut self) -> Result<()> {
        for pair in &self.deck.contact_pairs {
            let Some(Adjust::Nodes(set)) = &pair.adjust else { continue };
            let nodes = self.nodes_of_slave(pair, set)?;
            let shifts = self.shifts(pair, &nodes)?;
            self.move_nodes(&shifts);
            check_inverted(&self.assembly, &self.regions.mesh).map_err(|_| {
                let master = self.deck.spelled(&pair.master);
                let what = format_args!("ADJUST moves nodes onto {master} so far that elements turn inside out");
                self.assembly.error(pair.place, format_args!("{what}. Move the part in place of its nodes"))
            })?;
            self.note_adjusted(pair, set, nodes.len(), &shifts);
        }
        Ok(())
    }

    /// The nodes of a set that are on the slave of a pair, sorted.
    fn nodes_of_slave(&mut self, pair: &ContactPair, set: &str) -> Result<Vec<u32>> {
        let of_set = self.bodies.used(&self.assembly.set(Kind::Node, 0, &Entry::Name(set.into()), pair.place)?);
        let slave = self.surface_name(&pair.slave, pair.place)?;
        let of_slave: HashSet<u32> = self.regions.mesh.surfaces[&slave].nodes().collect();
        let both: Vec<u32> = of_set.into_iter().filter(|node| of_slave.contains(node)).collect();
        if both.is_empty() {
            let (set, slave) = (self.deck.spelled(set), self.deck.spelled(&pair.slave));
            let what = format_args!("no node of {set} is on the slave {slave} (ADJUST). Name nodes of the slave");
            return Err(self.assembly.error(pair.place, what));
        }
        Ok(both)
    }

    /// The shifts of those nodes that do not lie beside the master.
    fn shifts(&mut self, pair: &ContactPair, nodes: &[u32]) -> Result<Vec<NodeShift>> {
        let [slave, master] =
            [self.surface_name(&pair.slave, pair.place)?, self.surface_name(&pair.master, pair.place)?];
        let mesh = &self.regions.mesh;
        let everywhere = Options { search_distance: Some(f64::INFINITY) };
        let found = find_nodes(&mesh.surfaces[&slave], &mesh.surfaces[&master], &mesh.nodes, &everywhere, &Alone);
        let shift = |point: FoundPoint| {
            let (node, length) = (point.slave.nodes[0], point.gap.abs());
            let beside = (point.distance * point.distance - length * length).max(0.0).sqrt();
            let is_moved = beside <= MAX_LATERAL_OFFSET * point.size && nodes.binary_search(&node).is_ok();
            is_moved.then(|| NodeShift { node, vector: point.normal.map(|n| -point.gap * n), length })
        };
        Ok(found.points.into_iter().filter_map(shift).collect())
    }

    /// Moves nodes in the mesh and in the deck.
    fn move_nodes(&mut self, shifts: &[NodeShift]) {
        let vectors: HashMap<u32, [f64; 3]> = shifts.iter().map(|shift| (shift.node, shift.vector)).collect();
        let nodes = &mut self.regions.mesh.nodes;
        for (at, node) in self.assembly.coordinates.iter_mut().zip(&self.bodies.node_of) {
            let Some(vector) = vectors.get(node) else { continue };
            nodes[*node as usize].iter_mut().zip(vector).for_each(|(x, shift)| *x += shift);
            at.iter_mut().zip(vector).for_each(|(x, shift)| *x += shift / self.units.length);
        }
    }

    fn note_adjusted(&mut self, pair: &ContactPair, set: &str, n_nodes: usize, shifts: &[NodeShift]) {
        let (set, master) = (self.deck.spelled(set), self.deck.spelled(&pair.master));
        let farthest = shifts.iter().map(|shift| shift.length).fold(0.0, f64::max) / self.units.length;
        let beside = match n_nodes - shifts.len() {
            0 => String::new(),
            n => format!("; {n} lie beside it and stay"),
        };
        let n = shifts.len();
        self.notes
            .push(format!("ADJUST: {n} nodes of {set} are moved onto {master}, by {farthest:.2e} at most{beside}"));
    }
}
