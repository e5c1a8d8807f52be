//! Which nodes share a tetrahedron: the graph behind sparsity patterns and partitions.

/// A graph in compressed rows: the neighbours of i are `neighbours[offsets[i]..offsets[i + 1]]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Csr {
    /// Where each row begins, and the total at the end.
    pub offsets: Vec<usize>,
    /// The rows one after another.
    pub neighbours: Vec<u32>,
}

impl Csr {
    /// Neighbours of i.
    pub fn row(&self, i: usize) -> &[u32] {
        &self.neighbours[self.offsets[i]..self.offsets[i + 1]]
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.offsets.len() - 1
    }
}

/// The nodes that share a tetrahedron with each node: ascending, each once, without the node itself.
///
/// # Panics
/// Where a tetrahedron has a node beyond `n_nodes`.
pub fn node_graph(n_nodes: usize, tets: &[[u32; 10]]) -> Csr {
    let tets_of = tets_of_nodes(n_nodes, tets);
    // seen[j] = i + 1 while row i is gathered: nothing needs to be cleared between rows.
    let mut seen = vec![0_u32; n_nodes];
    let mut graph = Csr { offsets: Vec::with_capacity(n_nodes + 1), neighbours: Vec::new() };
    graph.offsets.push(0);
    for i in 0..n_nodes {
        let begin = graph.neighbours.len();
        let mark = i as u32 + 1;
        seen[i] = mark;
        for &tet in tets_of.row(i) {
            for &j in &tets[tet as usize] {
                if seen[j as usize] != mark {
                    seen[j as usize] = mark;
                    graph.neighbours.push(j);
                }
            }
        }
        graph.neighbours[begin..].sort_unstable();
        graph.offsets.push(graph.neighbours.len());
    }
    graph
}

/// The tetrahedra of each node, ascending.
pub fn tets_of_nodes(n_nodes: usize, tets: &[[u32; 10]]) -> Csr {
    let mut offsets = vec![0_usize; n_nodes + 1];
    for &node in tets.as_flattened() {
        offsets[node as usize + 1] += 1;
    }
    for i in 0..n_nodes {
        offsets[i + 1] += offsets[i];
    }
    let mut next = offsets.clone();
    let mut neighbours = vec![0; tets.len() * 10];
    for (tet, nodes) in tets.iter().enumerate() {
        for &node in nodes {
            neighbours[next[node as usize]] = tet as u32;
            next[node as usize] += 1;
        }
    }
    Csr { offsets, neighbours }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_tetrahedra_that_share_a_face_make_one_graph() {
        // They share the nodes 0, 1, 2, 4, 5, 6; 14 is in none.
        let tets = [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], [0, 2, 1, 10, 6, 5, 4, 11, 12, 13]];
        let graph = node_graph(15, &tets);
        assert_eq!(graph.row(3), [0, 1, 2, 4, 5, 6, 7, 8, 9]);
        assert_eq!(graph.row(10), [0, 1, 2, 4, 5, 6, 11, 12, 13]);
        assert_eq!(graph.row(0), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13]);
        assert!(graph.row(14).is_empty());
        assert_eq!(graph.n_rows(), 15);
        assert_eq!(graph.offsets[15], 6 * 13 + 8 * 9);
        assert_eq!(tets_of_nodes(15, &tets).row(5), [0, 1]);
    }
}
