//! Partition of a mesh by METIS.

use std::ptr;

use squeal_sys as sys;

use crate::{Error, Result};

/// Nodes that two 10-node tetrahedra share at a face.
const NODES_OF_A_FACE: i32 = 6;

/// Shares out the nodes of a mesh of 10-node tetrahedra, about as many to each part and with few tetrahedra across parts; gives each
/// node its part. Tetrahedra are neighbours where they share a face. Not collective; the same on every rank.
///
/// # Errors
/// METIS's, with its code.
pub fn partition(tets: &[[u32; 10]], n_nodes: usize, n_parts: usize) -> Result<Vec<u32>> {
    if n_parts == 1 {
        return Ok(vec![0; n_nodes]);
    }
    let (mut n_tets, mut n, mut parts) = (tets.len() as i32, n_nodes as i32, n_parts as i32);
    let mut offsets: Vec<i32> = (0..=n_tets).map(|e| 10 * e).collect();
    let mut nodes: Vec<i32> = tets.as_flattened().iter().map(|&n| n as i32).collect();
    let (mut of_tets, mut of_nodes) = (vec![0_i32; tets.len()], vec![0_i32; n_nodes]);
    let (mut common, mut cut) = (NODES_OF_A_FACE, 0);
    // SAFETY: the arrays have the lengths that METIS expects; null means "default" for the optional ones.
    let status = unsafe {
        sys::METIS_PartMeshDual(
            &mut n_tets,
            &mut n,
            offsets.as_mut_ptr(),
            nodes.as_mut_ptr(),
            ptr::null_mut(),
            ptr::null_mut(),
            &mut common,
            &mut parts,
            ptr::null_mut(),
            ptr::null_mut(),
            &mut cut,
            of_tets.as_mut_ptr(),
            of_nodes.as_mut_ptr(),
        )
    };
    if status != 1 {
        return Err(Error::Library(format!("METIS_PartMeshDual failed with code {status} on {n_tets} tetrahedra")));
    }
    Ok(of_nodes.into_iter().map(|part| part as u32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of tetrahedra, each with a face in common with the next: the six nodes that all but the first and last four of
    /// neighbours' lists share.
    #[test]
    fn a_chain_is_cut_once_and_evenly() {
        let chain: Vec<[u32; 10]> = (0..40).map(|e| std::array::from_fn(|a| 4 * e + a as u32)).collect();
        let part = partition(&chain, 166, 2).unwrap();
        let changes = part.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let first = part.iter().filter(|&&p| p == part[0]).count();
        assert_eq!(changes, 1, "{part:?}");
        assert!((75..=91).contains(&first), "{first} of 166 nodes");
        assert_eq!(partition(&chain, 166, 1).unwrap(), vec![0; 166]);
    }
}
