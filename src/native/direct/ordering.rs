//! In which order equations are eliminated: nested dissection of the matrix's graph by METIS.
//!
//! Debian builds MUMPS without METIS, so that its order is made here and handed over: on the full demo brake 1.3 s less
//! for an analysis than MUMPS's SCOTCH and 1.1 s less for an LU in single precision (3.7 of 5.0 s, 7.8 of 8.9 s, two
//! ranks). PETSc cannot pass an order on several ranks. Neighbouring rows with entries in the same columns, such as the
//! three of a node, are one vertex of the graph, with their number for its weight. The graph is put together on the
//! first rank, as MUMPS does for its own orderings.

use super::metis::{self, Graph};
use crate::Result;
use crate::native::{Comm, Matrix};

/// For each equation of all ranks its place in the order, from 1, on the first rank; nothing on the others. Collective.
///
/// # Errors
/// PETSc's and METIS's.
pub(in crate::native) fn nested_dissection(a: &Matrix) -> Result<Vec<i32>> {
    let comm = a.comm();
    let rows = columns_of_rows(a)?;
    let firsts: Vec<usize> = (0..rows.len()).filter(|&i| i == 0 || rows[i] != rows[i - 1]).collect();
    let first_row = a.first_row()?;
    let starts = comm.join(&firsts.iter().map(|&i| first_row + i).collect::<Vec<_>>());
    let n_equations = comm.sum(rows.len());
    let vertex_of = vertices(&starts, n_equations);
    let own = firsts.iter().map(|&i| neighbours(&rows[i], &vertex_of, vertex_of[first_row + i]));
    let lists = to_first_rank(comm, own);
    if !comm.is_root() {
        return Ok(Vec::new());
    }
    let ends = starts.iter().skip(1).copied().chain([n_equations]);
    let weights: Vec<i32> = starts.iter().zip(ends).map(|(start, end)| (end - start) as i32).collect();
    let order = metis::nested_dissection(&Graph::undirected(&lists)?, &weights)?;
    Ok(places(&order, &starts, &weights, n_equations))
}

/// Global columns of each of this rank's rows.
fn columns_of_rows(a: &Matrix) -> Result<Vec<Vec<u32>>> {
    let (mut rows, first) = (vec![Vec::new(); a.n_local()], a.first_row()?);
    a.visit_entries(|row, column, _| rows[row - first].push(column as u32))?;
    Ok(rows)
}

/// The vertex of each equation; vertices start at these equations.
fn vertices(starts: &[usize], n_equations: usize) -> Vec<u32> {
    let mut vertex_of = vec![0; n_equations];
    for (vertex, &start) in starts.iter().enumerate() {
        let end = starts.get(vertex + 1).copied().unwrap_or(n_equations);
        vertex_of[start..end].fill(vertex as u32);
    }
    vertex_of
}

/// The vertices of some columns but `own`, rising.
fn neighbours(columns: &[u32], vertex_of: &[u32], own: u32) -> Vec<u32> {
    let mut list: Vec<u32> = columns.iter().map(|&column| vertex_of[column as usize]).filter(|&v| v != own).collect();
    list.sort_unstable();
    list.dedup();
    list
}

/// The lists of all ranks, one rank's after the other's, on the first rank.
fn to_first_rank(comm: &Comm, lists: impl Iterator<Item = Vec<u32>>) -> Vec<Vec<u32>> {
    let mut parts = vec![Vec::new(); comm.size()];
    for list in lists {
        parts[0].push(list.len() as u32);
        parts[0].extend(list);
    }
    let (mut all, received) = (Vec::new(), comm.exchange(&parts).concat());
    let mut values = received.into_iter();
    while let Some(length) = values.next() {
        all.push(values.by_ref().take(length as usize).collect());
    }
    all
}

/// The equations' places, from 1, where vertices are eliminated in this order.
fn places(order: &[i32], starts: &[usize], weights: &[i32], n_equations: usize) -> Vec<i32> {
    let (mut places, mut next) = (vec![0; n_equations], 1);
    for &vertex in order {
        let (start, weight) = (starts[vertex as usize], weights[vertex as usize]);
        for place in &mut places[start..start + weight as usize] {
            *place = next;
            next += 1;
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_of_a_vertex_are_eliminated_together() {
        assert_eq!(vertices(&[0, 3, 4], 6), [0, 0, 0, 1, 2, 2]);
        assert_eq!(neighbours(&[0, 1, 2, 3, 4, 5], &[0, 0, 0, 1, 2, 2], 0), [1, 2]);
        assert_eq!(places(&[2, 0, 1], &[0, 3, 4], &[3, 1, 2], 6), [3, 4, 5, 6, 1, 2]);
    }
}
