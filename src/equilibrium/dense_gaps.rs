//! The gap operator of a densely stored system whose contact points move with all of its dofs.
//!
//! ```text
//! g = B u          r += factor B^T f          K += sum_a B_a^T D_a B_a = U V^T
//! ```
//!
//! all by BLAS, B stored as `B^T`, by columns. The columns of U and V are those of the tangents' dyads ([`Dyad`]): one
//! for a sliding point. The last sum is kept, and only points whose tangent has changed since change it: 0.05 s where a
//! sum of all takes 0.3 s (1000 coordinates, 1526 points).

use std::cell::RefCell;

use crate::assembly::DofMap;
use crate::contact::{Dyad, GapOperator, Tangent, TangentChange};
use crate::native::lapack;

/// Entries of the gap operator, relative to those of a full one, from which it is stored as a full one.
const FULL_FROM: f64 = 0.5;
/// Dyads in one product.
const PANEL: usize = 512;

/// The gap operator as a full matrix.
pub(super) struct DenseGaps {
    n_dofs: usize,
    /// `B^T`, three columns for each point.
    transpose: Vec<f64>,
    sum: RefCell<Sum>,
}

/// A sum over the points, and their tangents.
struct Sum {
    tangents: Vec<Tangent>,
    values: Vec<f64>,
}

impl DenseGaps {
    /// Of a gap operator on dofs that are all on this rank; none where most of its entries would be zero.
    pub(super) fn new(gap_operator: &GapOperator, dofs: &DofMap) -> Option<DenseGaps> {
        let (n_points, n_dofs) = (gap_operator.len(), dofs.n_local());
        let n_entries: usize = (0..n_points).map(|a| gap_operator.point(a).0.len()).sum();
        if n_points == 0 || (n_entries as f64) < FULL_FROM * (n_points * dofs.n_nodes()) as f64 {
            return None;
        }
        let mut transpose = vec![0.0; 3 * n_points * n_dofs];
        for (a, columns) in transpose.chunks_exact_mut(3 * n_dofs).enumerate() {
            let (nodes, blocks) = gap_operator.point(a);
            for (&node, block) in nodes.iter().zip(blocks) {
                for (j, dof) in dofs.node_dofs(node).into_iter().enumerate().filter(|&(_, dof)| dof >= 0) {
                    (0..3).for_each(|i| columns[i * n_dofs + dof as usize] += block[i][j]);
                }
            }
        }
        let sum = Sum { tangents: vec![[[0.0; 3]; 3]; n_points], values: vec![0.0; n_dofs * n_dofs] };
        Some(DenseGaps { n_dofs, transpose, sum: RefCell::new(sum) })
    }

    /// `g = B u`
    pub(super) fn gaps(&self, u: &[f64]) -> Vec<[f64; 3]> {
        let mut gaps = vec![[0.0; 3]; self.transpose.len() / (3 * self.n_dofs)];
        let sizes = [3 * gaps.len(), self.n_dofs, 1];
        lapack::multiply(true, sizes, &self.transpose, u, gaps.as_flattened_mut());
        gaps
    }

    /// `r += B_a^T f`
    pub(super) fn spread(&self, a: usize, force: [f64; 3], r: &mut [f64]) {
        let columns = &self.transpose[3 * a * self.n_dofs..][..3 * self.n_dofs];
        lapack::add_product(false, [self.n_dofs, 3, 1], columns, &force, r);
    }

    /// `r += B^T f`
    pub(super) fn spread_all(&self, forces: &[[f64; 3]], r: &mut [f64]) {
        lapack::add_product(false, [self.n_dofs, 3 * forces.len(), 1], &self.transpose, forces.as_flattened(), r);
    }

    /// `values += sum_a B_a^T D_a B_a`, by columns.
    pub(super) fn add_stiffness(&self, tangents: Vec<Tangent>, values: &mut [f64]) {
        let mut sum = self.sum.borrow_mut();
        let pairs = sum.tangents.iter().zip(&tangents).enumerate().map(|(a, (old, new))| (a, old, new));
        let change = TangentChange::between(pairs, TangentChange::ROUNDING);
        for dyads in change.dyads.chunks(PANEL) {
            let columns = |direction: fn(&Dyad) -> [f64; 3]| {
                let mut columns = vec![0.0; self.n_dofs * dyads.len()];
                for (column, dyad) in columns.chunks_exact_mut(self.n_dofs).zip(dyads) {
                    self.spread(dyad.point, direction(dyad), column);
                }
                columns
            };
            let [u, v] = [columns(|dyad| dyad.left), columns(|dyad| dyad.right)];
            lapack::add_product_with_transpose([self.n_dofs, dyads.len(), self.n_dofs], &u, &v, &mut sum.values);
        }
        sum.tangents = tangents;
        values.iter_mut().zip(&sum.values).for_each(|(value, sum)| *value += sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Numbering;

    /// Three points on two nodes of which one displacement is constrained, no two entries alike.
    fn points() -> (GapOperator, DofMap) {
        let mut gap_operator = GapOperator::new();
        for a in 0..3 {
            let block =
                |n: usize| [0, 1, 2].map(|i| [0, 1, 2].map(|j| (1.0 + (7 * a + 5 * n + 3 * i + j) as f64).sin()));
            gap_operator.push(&[1, 0], &[block(1), block(0)]);
        }
        (gap_operator, DofMap::new(&Numbering::even(2, 0, 1), &[[false, true, false], [false; 3]]))
    }

    const U: [f64; 5] = [1.0, -2.0, 0.5, 3.0, -1.0];

    #[test]
    fn gaps_and_forces_are_those_of_the_gap_operator() {
        let (gap_operator, dofs) = points();
        let dense = DenseGaps::new(&gap_operator, &dofs).expect("every point moves with every node");
        let nodal = dofs.nodal(&U);
        let gaps = dense.gaps(&U);
        let forces = [[1.0, 2.0, -1.0], [0.5, 0.0, 4.0], [-3.0, 1.0, 1.0]];
        let (mut all, mut each) = ([0.0; 5], [0.0; 5]);
        dense.spread_all(&forces, &mut all);
        for a in 0..3 {
            let expected = gap_operator.gap(a, |n| nodal[n as usize]);
            assert!((0..3).all(|i| (gaps[a][i] - expected[i]).abs() < 1e-14));
            dense.spread(a, forces[a], &mut each);
        }
        // f . B u = u . B^T f
        let work: f64 = gaps.as_flattened().iter().zip(forces.as_flattened()).map(|(g, f)| g * f).sum();
        assert!((work - U.iter().zip(all).map(|(u, r)| u * r).sum::<f64>()).abs() < 1e-13);
        assert!(all.iter().zip(each).all(|(a, b)| (a - b).abs() < 1e-14));
    }

    /// A sum after others is what it would be at first.
    #[test]
    fn the_stiffness_follows_the_tangents() {
        let (gap_operator, dofs) = points();
        let dense = DenseGaps::new(&gap_operator, &dofs).unwrap();
        let tangent = |seed: f64| [0, 1, 2].map(|i| [0, 1, 2].map(|j| (seed + f64::from(3 * i + j)).cos()));
        let none = [[0.0; 3]; 3];
        for tangents in [[tangent(1.0), tangent(2.0), none], [tangent(1.0), none, tangent(3.0)], [none; 3]] {
            let mut values = vec![1.0; 25];
            dense.add_stiffness(tangents.to_vec(), &mut values);
            let mut expected = [[1.0; 5]; 5];
            for (column, unit) in expected.iter_mut().zip(0..5) {
                let nodal = dofs.nodal(&[0, 1, 2, 3, 4].map(|i| if i == unit { 1.0 } else { 0.0 }));
                for (a, d) in tangents.iter().enumerate() {
                    let g = gap_operator.gap(a, |n| nodal[n as usize]);
                    dense.spread(a, d.map(|row| crate::algebra::dot(row, g)), column);
                }
            }
            assert!(values.iter().zip(expected.as_flattened()).all(|(x, y)| (x - y).abs() < 1e-13));
        }
    }

    #[test]
    fn a_gap_operator_of_few_entries_is_left_sparse() {
        let mut gap_operator = GapOperator::new();
        let eye = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        (0..4).for_each(|n| gap_operator.push(&[n], &[eye]));
        let dofs = DofMap::new(&Numbering::even(4, 0, 1), &[[false; 3]; 4]);
        assert!(DenseGaps::new(&gap_operator, &dofs).is_none());
        assert!(DenseGaps::new(&GapOperator::new(), &dofs).is_none());
    }
}
