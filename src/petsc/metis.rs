//! Partition of a graph by METIS.

use std::ptr;

use squeal_sys as sys;

use crate::{Error, Result};

/// Cuts a graph into `n_parts` of about equal vertex counts with few edges between them; gives each vertex its part.
///
/// The graph is CSR with `offsets.len() - 1` vertices, symmetric and without loops. Not collective; the same on every rank.
///
/// # Errors
/// METIS's, with its code.
pub fn partition(offsets: &[i32], neighbours: &[i32], n_parts: usize) -> Result<Vec<u32>> {
    let mut n = offsets.len() as i32 - 1;
    if n_parts == 1 {
        return Ok(vec![0; n as usize]);
    }
    let mut part = vec![0_i32; n as usize];
    let (mut offsets, mut neighbours) = (offsets.to_vec(), neighbours.to_vec());
    let (mut n_constraints, mut parts, mut cut) = (1, n_parts as i32, 0);
    // SAFETY: the arrays have the lengths that METIS expects; null means "default" for the optional ones.
    let status = unsafe {
        sys::METIS_PartGraphKway(
            &mut n,
            &mut n_constraints,
            offsets.as_mut_ptr(),
            neighbours.as_mut_ptr(),
            ptr::null_mut(),
            ptr::null_mut(),
            ptr::null_mut(),
            &mut parts,
            ptr::null_mut(),
            ptr::null_mut(),
            ptr::null_mut(),
            &mut cut,
            part.as_mut_ptr(),
        )
    };
    if status != 1 {
        return Err(Error::Library(format!("METIS_PartGraphKway failed with code {status} on {n} vertices")));
    }
    Ok(part.into_iter().map(|p| p as u32).collect())
}
