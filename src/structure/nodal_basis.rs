//! The basis of a super-element by nodes of the mesh, as its file keeps it: the same on any number of ranks.
//!
//! ```text
//! V_j at (3 label + axis)        single precision, zero where constrained
//! ```

use crate::Result;
use crate::assembly::System;
use crate::mesh::Numbering;
use crate::native::Block;

/// The columns of a basis one after the other, three displacements a node in the order of the mesh's file; on the root.
/// Collective.
pub fn gathered(system: &System, nodes: &Numbering, basis: &Block) -> Vec<f32> {
    let comm = basis.comm();
    let labels = comm.join(&positions(system));
    let width = if comm.is_root() { 3 * nodes.n_global() } else { 0 };
    let mut columns = vec![0.0; width * basis.n_columns()];
    for j in 0..basis.n_columns() {
        let own: Vec<f32> = basis.column(j).iter().map(|&u| u as f32).collect();
        let all = comm.join(&own);
        if let Some(column) = columns.get_mut(j * width..(j + 1) * width).filter(|column| !column.is_empty()) {
            labels.iter().zip(all).for_each(|(&label, u)| column[label as usize] = u);
        }
    }
    columns
}

/// The basis of so many columns that the root has by nodes. Collective.
///
/// # Errors
/// [`crate::Error::Input`] where it belongs to another mesh.
pub fn distributed(system: &System, nodes: &Numbering, columns: &[f32], n_columns: usize) -> Result<Block> {
    let (comm, width) = (system.k.comm(), 3 * nodes.n_global());
    let fits = !comm.is_root() || columns.len() == width * n_columns;
    let what = "the basis of the super-element belongs to another mesh. Give the model file that it was made of";
    comm.agree(if fits { Ok(()) } else { Err(crate::Error::input(what)) })?;
    let labels = positions(system);
    let mut values = Vec::with_capacity(labels.len() * n_columns);
    for j in 0..n_columns {
        let column = columns.get(j * width..(j + 1) * width).unwrap_or_default().to_vec();
        let column = comm.broadcast(0, column);
        values.extend(labels.iter().map(|&label| f64::from(column[label as usize])));
    }
    Ok(Block::from_columns(comm, labels.len(), values))
}

/// Where this rank's dofs stand in a column.
fn positions(system: &System) -> Vec<i64> {
    system.dofs.labels().into_iter().map(|label| label as i64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::testing::{ALONG_X, blocks_on_belt};
    use crate::native::Session;

    #[test]
    fn a_basis_by_nodes_is_the_basis() {
        let comm = Session::start(&[]).unwrap();
        let (system, _) = blocks_on_belt(&comm, 4, 0, ALONG_X);
        let nodes = Numbering::even(4, 0, 1);
        let basis = Block::from_columns(&comm, 12, (0..24).map(|i| 0.5 * f64::from(i)).collect());
        let columns = gathered(&system, &nodes, &basis);
        assert_eq!(distributed(&system, &nodes, &columns, 2).unwrap().values(), basis.values());
        let error = distributed(&system, &nodes, &columns[1..], 2).err().unwrap().to_string();
        assert!(error.contains("another mesh"), "{error}");
    }
}
