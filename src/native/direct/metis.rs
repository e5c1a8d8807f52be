//! Partition of a mesh by METIS.

use std::ptr;

use nix::sys::signal::{SigSet, SigmaskHow, Signal};
use squeal_sys as sys;

use crate::native::petsc::int;
use crate::{Error, Result};

/// Elements as lists of nodes, one after the other.
#[derive(Debug, Clone, Copy)]
pub struct Lists<'a> {
    /// The nodes of all elements.
    pub nodes: &'a [u32],
    /// Where each element's nodes start, and the end of the last.
    pub offsets: &'a [u32],
}

/// Shares out the nodes of a mesh, about as many to each part and with few elements across parts; gives each node its
/// part. Elements are neighbours where they share `n_common` nodes. Not collective; the same on every rank.
///
/// # Errors
/// [`Error::Input`] where the mesh has more than METIS's 32-bit numbers count; METIS's, with its code.
pub fn partition(elements: Lists, n_nodes: usize, n_parts: usize, n_common: i32) -> Result<Vec<u32>> {
    if n_parts == 1 {
        return Ok(vec![0; n_nodes]);
    }
    int("nodes of the elements", elements.nodes.len())?;
    let (mut n_elements, mut n, mut parts) =
        (elements.offsets.len() as i32 - 1, int("nodes", n_nodes)?, n_parts as i32);
    let mut offsets: Vec<i32> = elements.offsets.iter().map(|&at| at as i32).collect();
    let mut nodes: Vec<i32> = elements.nodes.iter().map(|&n| n as i32).collect();
    let (mut of_elements, mut of_nodes) = (vec![0_i32; n_elements as usize], vec![0_i32; n_nodes]);
    let (mut common, mut cut) = (n_common, 0);
    // SAFETY: the arrays have the lengths that METIS expects; null means "default" for the optional ones.
    let status = undisturbed(|| unsafe {
        sys::METIS_PartMeshDual(
            &mut n_elements,
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
            of_elements.as_mut_ptr(),
            of_nodes.as_mut_ptr(),
        )
    });
    if status != OK {
        return Err(Error::library("METIS")(format!(
            "PartMeshDual failed with code {status} on {n_elements} elements"
        )));
    }
    Ok(of_nodes.into_iter().map(|part| part as u32).collect())
}

/// What METIS returns where all is well.
const OK: i32 = 1;

/// Calls METIS with SIGTERM blocked for this thread: METIS has a handler of its own while it works, which takes the
/// signal for a failure and leaves METIS by a jump, from wherever it is. A signal waits until METIS has ended.
///
/// The handler is the process's: where another thread does not block the signal, METIS's handler runs there, and the
/// process crashes. The `squeal` program blocks it in all threads that it starts.
fn undisturbed(call: impl FnOnce() -> i32) -> i32 {
    let before = SigSet::from(Signal::SIGTERM).thread_swap_mask(SigmaskHow::SIG_BLOCK);
    // SAFETY: it reads handlers alone; METIS runs on one thread.
    unsafe { sys::squeal_keep_handlers() };
    let status = call();
    // SAFETY: the handlers that were kept.
    unsafe { sys::squeal_restore_handlers() };
    if let Ok(before) = before {
        let _ = before.thread_set_mask();
    }
    status
}

/// Who is whose neighbour, compressed.
pub(in crate::native) struct Graph {
    /// Where each vertex's list starts, and the end of the last.
    offsets: Vec<i32>,
    neighbours: Vec<i32>,
}

impl Graph {
    /// Two vertices are neighbours where one of them lists the other; lists rise and do not name their owner.
    ///
    /// # Errors
    /// [`Error::Input`] where there are more neighbours than METIS's 32-bit numbers count.
    pub(in crate::native) fn undirected(lists: &[Vec<u32>]) -> Result<Graph> {
        let mut listed_by = vec![Vec::new(); lists.len()];
        for (vertex, list) in lists.iter().enumerate() {
            list.iter().for_each(|&other| listed_by[other as usize].push(vertex as u32));
        }
        let (mut offsets, mut neighbours) = (vec![0], Vec::new());
        for (list, mut all) in lists.iter().zip(listed_by) {
            if *list != all {
                all.extend(list);
                all.sort_unstable();
                all.dedup();
            }
            neighbours.extend(all.into_iter().map(|vertex| vertex as i32));
            offsets.push(int("neighbours in the matrix's graph", neighbours.len())?);
        }
        Ok(Graph { offsets, neighbours })
    }
}

/// The vertices in an order of elimination that fills little. Not collective.
///
/// # Errors
/// METIS's, with its code.
pub(in crate::native) fn nested_dissection(graph: &Graph, weights: &[i32]) -> Result<Vec<i32>> {
    let mut n = weights.len() as i32;
    let (mut order, mut places) = (vec![0_i32; weights.len()], vec![0_i32; weights.len()]);
    // SAFETY: METIS reads the graph and the weights, and writes the two permutations; null means "default" for the
    // options.
    let status = undisturbed(|| unsafe {
        sys::METIS_NodeND(
            &mut n,
            graph.offsets.as_ptr().cast_mut(),
            graph.neighbours.as_ptr().cast_mut(),
            weights.as_ptr().cast_mut(),
            ptr::null_mut(),
            order.as_mut_ptr(),
            places.as_mut_ptr(),
        )
    });
    match status {
        // An error that METIS raises as a signal has waited, too.
        OK if is_permutation(&order) => Ok(order),
        _ => Err(Error::library("METIS")(format!("NodeND failed with code {status} on {n} vertices"))),
    }
}

fn is_permutation(order: &[i32]) -> bool {
    let mut is_met = vec![false; order.len()];
    order.iter().all(|&at| {
        usize::try_from(at).ok().and_then(|at| is_met.get_mut(at)).is_some_and(|met| !std::mem::replace(met, true))
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    use nix::sys::pthread::{pthread_kill, pthread_self};
    use nix::sys::signal::{SigHandler, signal};

    use super::*;

    /// A square of 400 by 400 vertices, which takes METIS about a second; the signal goes to the thread on which METIS
    /// works.
    #[test]
    fn a_signal_that_comes_while_metis_works_waits_for_its_end() {
        const N: u32 = 400;
        static N_CAME: AtomicUsize = AtomicUsize::new(0);
        extern "C" fn count(_: i32) {
            N_CAME.fetch_add(1, Ordering::Relaxed);
        }
        let neighbours = |v: u32| {
            let right = (v % N + 1 < N).then_some(v + 1);
            right.into_iter().chain((v + N < N * N).then_some(v + N)).collect()
        };
        let graph = Graph::undirected(&(0..N * N).map(neighbours).collect::<Vec<_>>()).unwrap();
        // SAFETY: the handler counts and does nothing else.
        unsafe { signal(Signal::SIGTERM, SigHandler::Handler(count)) }.unwrap();
        for n_came in 1..=2 {
            std::thread::scope(|scope| {
                let metis = pthread_self();
                scope.spawn(move || {
                    std::thread::sleep(Duration::from_millis(100));
                    pthread_kill(metis, Signal::SIGTERM).unwrap();
                });
                let order = nested_dissection(&graph, &vec![1; (N * N) as usize]).unwrap();
                assert_eq!(order.len(), (N * N) as usize);
            });
            assert_eq!(N_CAME.load(Ordering::Relaxed), n_came);
        }
    }

    #[test]
    fn what_is_no_order_is_seen() {
        assert!(is_permutation(&[2, 0, 1]) && is_permutation(&[]));
        for wrong in [[0, 0, 1], [0, 1, 3], [0, 1, -1]] {
            assert!(!is_permutation(&wrong));
        }
    }

    /// A chain of tetrahedra, each with a face in common with the next: the six nodes that all but the first and last
    /// four of neighbours' lists share.
    #[test]
    fn a_chain_is_cut_once_and_evenly() {
        let nodes: Vec<u32> = (0..40).flat_map(|e| 4 * e..4 * e + 10).collect();
        let offsets: Vec<u32> = (0..=40).map(|e| 10 * e).collect();
        let chain = Lists { nodes: &nodes, offsets: &offsets };
        let part = partition(chain, 166, 2, 6).unwrap();
        let changes = part.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let first = part.iter().filter(|&&p| p == part[0]).count();
        assert_eq!(changes, 1, "{part:?}");
        assert!((75..=91).contains(&first), "{first} of 166 nodes");
        assert_eq!(partition(chain, 166, 1, 6).unwrap(), vec![0; 166]);
    }

    /// Two cliques of five with one vertex between them, which only one of each lists.
    #[test]
    fn what_separates_is_eliminated_last() {
        let clique = |first: u32| (first..first + 5).map(move |v| (first..first + 5).filter(|&w| w != v).collect());
        let mut lists: Vec<Vec<u32>> = clique(0).chain(clique(5)).collect();
        lists.push(vec![4, 5]);
        let graph = Graph::undirected(&lists).unwrap();
        assert_eq!(graph.neighbours[graph.offsets[4] as usize..graph.offsets[5] as usize], [0, 1, 2, 3, 10]);
        let order = nested_dissection(&graph, &[1; 11]).unwrap();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..11).collect::<Vec<_>>());
        let sides: Vec<i32> = order.iter().filter(|&&v| v < 10).map(|&v| v / 5).collect();
        assert!(sides.windows(2).filter(|pair| pair[0] != pair[1]).count() <= 1 || order[10] == 10, "{order:?}");
    }
}
