//! Rows of G while they are made.

use std::collections::HashMap;

use super::SetMotion;

/// Linear functionals of the displacements of some nodes, each a row.
pub struct Rows {
    nodes: Vec<u32>,
    /// Place of each node in the list.
    places: HashMap<u32, usize>,
    /// Three entries a node; a row ends with the last node that it has met.
    rows: Vec<Vec<f64>>,
}

impl Rows {
    /// So many rows of nothing.
    pub fn new(n_rows: usize) -> Rows {
        Rows { nodes: Vec::new(), places: HashMap::new(), rows: vec![Vec::new(); n_rows] }
    }

    /// Adds `v . u_node` to a row.
    pub fn add(&mut self, row: usize, node: u32, v: [f64; 3]) {
        let place = *self.places.entry(node).or_insert_with(|| {
            self.nodes.push(node);
            self.nodes.len() - 1
        });
        let row = &mut self.rows[row];
        row.resize(row.len().max(3 * place + 3), 0.0);
        row[3 * place..].iter_mut().zip(v).for_each(|(entry, v)| *entry += v);
    }

    /// Adds `factor B u_node` to the three rows from `first` on.
    pub fn add_block(&mut self, first: usize, node: u32, factor: f64, block: &[[f64; 3]; 3]) {
        block.iter().enumerate().for_each(|(i, line)| self.add(first + i, node, line.map(|entry| factor * entry)));
    }

    /// Adds a motion to six rows.
    pub fn add_motion(&mut self, motion: &SetMotion, sign: f64) {
        for (k, &node) in motion.nodes.iter().enumerate() {
            self.add_block(0, node, sign, &motion.motion.displacement[k]);
            self.add_block(3, node, sign, &motion.motion.rotation[k]);
        }
    }

    /// The nodes and the rows, all of one length.
    pub fn finish(mut self) -> (Vec<u32>, Vec<Vec<f64>>) {
        let n = 3 * self.nodes.len();
        self.rows.iter_mut().for_each(|row| row.resize(n, 0.0));
        (self.nodes, self.rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_that_comes_twice_has_one_place() {
        let mut rows = Rows::new(2);
        rows.add(1, 7, [1.0, 2.0, 3.0]);
        rows.add(0, 4, [0.0, 0.0, 5.0]);
        rows.add(1, 7, [-1.0, 0.0, 1.0]);
        let (nodes, rows) = rows.finish();
        assert_eq!(nodes, [7, 4]);
        assert_eq!(rows, [vec![0.0, 0.0, 0.0, 0.0, 0.0, 5.0], vec![0.0, 2.0, 4.0, 0.0, 0.0, 0.0]]);
    }
}
