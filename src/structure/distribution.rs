//! From one file to every rank its piece of the mesh, and work that ranks divide.

use std::ops::Range;

use crate::Result;
use crate::contact::search::{Foot, Team};
use crate::mesh::{Element, Mesh, Piece, order};
use crate::native::{Comm, Lists, partition};

/// Gives every rank its piece of a mesh that the root alone has read: METIS shares out the nodes, which are numbered
/// rank by rank, and near each other within a rank. Collective.
///
/// # Errors
/// What befell the root when it read; METIS's.
pub fn distribute(comm: &Comm, read: impl FnOnce() -> Result<Mesh>) -> Result<Piece> {
    let whole = || {
        let mut mesh = read()?;
        let (nodes, offsets) = mesh.elements.all_nodes();
        let owner = partition(Lists { nodes, offsets }, mesh.nodes.len(), comm.size(), smallest_face(&mesh))?;
        let labels = order(&mesh.nodes, &owner);
        mesh.reorder(&labels);
        Ok(Some((mesh, owner, labels)))
    };
    let whole = comm.agree(if comm.is_root() { whole() } else { Ok(None) })?;
    let Some((mesh, owner, labels)) = whole else { return Ok(comm.receive_value(0)) };
    for rank in 1..comm.size() {
        comm.send_value(&Piece::of(&mesh, owned(&owner, rank), &labels), rank);
    }
    Ok(Piece::of(&mesh, owned(&owner, 0), &labels))
}

/// Number of nodes of the smallest face of any element: what neighbours share at least.
fn smallest_face(mesh: &Mesh) -> i32 {
    let of = |element: Element| element.shape().faces().map(<[usize]>::len).min();
    mesh.elements.iter().filter_map(of).min().unwrap_or(0) as i32
}

/// The nodes of a rank, where nodes are numbered rank by rank.
fn owned(owner: &[u32], rank: usize) -> Range<u32> {
    let below = |rank: usize| owner.iter().filter(|&&owner| (owner as usize) < rank).count() as u32;
    below(rank)..below(rank + 1)
}

/// Ranks search for contact points together.
impl Team for Comm {
    fn share(&self, n: usize) -> Range<usize> {
        self.rank() * n / self.size()..(self.rank() + 1) * n / self.size()
    }

    fn join(&self, own: Vec<Option<Foot>>) -> Vec<Option<Foot>> {
        self.join_values(own).concat()
    }

    fn largest(&self, values: &mut [f64]) {
        self.max_all(values);
    }
}
