//! Contact layouts: a surface's points divided into cells of equal area.
//!
//! Recursive inertial bisection: the points are sorted along the principal axis of their inertia and cut where both
//! sides have the area of the cells they are to hold; so are the two sides, until one cell is left. Every point belongs
//! to exactly one cell; pieces of a surface that slots part are divided each on its own. A cell must span a plane, or
//! its reference node could not follow it: where the best cut leaves three points on a line, the next best is taken.
//!
//! Source: H. D. Simon, *Partitioning of unstructured problems for parallel processing*, Computing Systems in
//! Engineering 2 (1991).

use std::cmp::Ordering;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::element::coupling::{Cloud, mean_motion};

/// Points with areas, m and m2, and the connected piece of the surface that each lies on.
pub struct Points<'a> {
    /// Positions.
    pub positions: &'a [[f64; 3]],
    /// Areas, above zero.
    pub areas: &'a [f64],
    /// Pieces, by any number.
    pub pieces: &'a [usize],
}

/// Fewest points of a cell: three span a plane.
const FEWEST: usize = 3;
/// Cuts tried in search of cells that span a plane.
const PATIENCE: usize = 10_000;

/// Why there is no such layout.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LayoutError {
    /// Fewer than three points a cell.
    #[error("{n_cells} reference nodes need at least {} contact points, three each; there are {n_points}", 3 * .n_cells)]
    TooFine {
        /// Cells asked for.
        n_cells: usize,
        /// Points there are.
        n_points: usize,
    },
    /// A cell of which all points lie on a line, however the cuts are made.
    #[error(
        "the cell about ({:.2}, {:.2}, {:.2}) mm has its contact points on a line, so that its reference node could not follow it",
        1e3 * .centre[0], 1e3 * .centre[1], 1e3 * .centre[2]
    )]
    Collinear {
        /// Centre of the cell, m.
        centre: [f64; 3],
    },
}

/// Divides the points into `n_cells` cells of about equal area; each cell is a sorted list of points.
///
/// # Errors
/// [`LayoutError`] where a cell has not three points that span a plane.
pub fn cells(points: &Points, n_cells: usize) -> Result<Vec<Vec<usize>>, LayoutError> {
    // Numbers differ from one number of ranks to another, places do not.
    let mut all: Vec<usize> = (0..points.positions.len()).collect();
    let at = |a: usize| points.positions[a];
    all.sort_by(|&a, &b| (0..3).map(|i| at(a)[i].total_cmp(&at(b)[i])).fold(Ordering::Equal, Ordering::then));
    if all.len() < FEWEST * n_cells {
        return Err(LayoutError::TooFine { n_cells, n_points: all.len() });
    }
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    for &a in &all {
        match pieces.iter_mut().find(|piece| points.pieces[piece[0]] == points.pieces[a]) {
            Some(piece) => piece.push(a),
            None => pieces.push(vec![a]),
        }
    }
    if pieces.len() > n_cells {
        pieces = vec![all];
    }
    let areas: Vec<f64> = pieces.iter().map(|piece| area(points, piece)).collect();
    let mut cells = Vec::new();
    for (piece, n) in pieces.iter().zip(apportion(n_cells, &areas)) {
        if piece.len() < FEWEST * n {
            return Err(LayoutError::TooFine { n_cells: n, n_points: piece.len() });
        }
        let mut search = Search { points, patience: PATIENCE, failure: None };
        let found = search.divide(piece.clone(), n);
        cells.extend(found.ok_or_else(|| search.failure.expect("a search fails at a cell"))?);
    }
    cells.iter_mut().for_each(|cell| cell.sort_unstable());
    Ok(cells)
}

/// Shares `n` among areas by largest remainders, at least one each where there are enough.
pub fn apportion(n: usize, areas: &[f64]) -> Vec<usize> {
    let total: f64 = areas.iter().sum();
    let quota: Vec<f64> = areas.iter().map(|area| n as f64 * area / total).collect();
    let least = usize::from(n >= areas.len());
    let mut shares: Vec<usize> = quota.iter().map(|q| ((q + 1e-9) as usize).max(least)).collect();
    while shares.iter().sum::<usize>() != n {
        let lacks = |i: &usize| quota[*i] - shares[*i] as f64;
        let (all, rises) = (0..areas.len(), shares.iter().sum::<usize>() < n);
        let i = match rises {
            // Of equal remainders the first is served.
            true => all.rev().max_by(|i, j| lacks(i).total_cmp(&lacks(j))),
            false => all.filter(|&i| shares[i] > least).min_by(|i, j| lacks(i).total_cmp(&lacks(j))),
        };
        let i = i.expect("there is an area");
        shares[i] = if rises { shares[i] + 1 } else { shares[i] - 1 };
    }
    shares
}

fn area(points: &Points, members: &[usize]) -> f64 {
    members.iter().map(|&a| points.areas[a]).sum()
}

/// A search for cuts.
struct Search<'a> {
    points: &'a Points<'a>,
    patience: usize,
    failure: Option<LayoutError>,
}

impl Search<'_> {
    /// The cells of some points; none where no cut does.
    fn divide(&mut self, members: Vec<usize>, n_cells: usize) -> Option<Vec<Vec<usize>>> {
        if n_cells == 1 {
            return self.spans(&members).then(|| vec![members]);
        }
        let left = n_cells / 2;
        for axis in self.axes(&members) {
            let sorted = self.sorted(&members, axis);
            for cut in self.cuts(&sorted, left, n_cells) {
                self.patience = self.patience.checked_sub(1)?;
                let Some(mut cells) = self.divide(sorted[..cut].to_vec(), left) else { continue };
                let Some(others) = self.divide(sorted[cut..].to_vec(), n_cells - left) else { continue };
                cells.extend(others);
                return Some(cells);
            }
        }
        None
    }

    fn spans(&mut self, members: &[usize]) -> bool {
        let nodes: Vec<[f64; 3]> = members.iter().map(|&a| self.points.positions[a]).collect();
        let weights: Vec<f64> = members.iter().map(|&a| self.points.areas[a]).collect();
        let cloud = Cloud { nodes: &nodes, weights: &weights };
        let spans = mean_motion(cloud, cloud.centroid()).is_ok();
        if !spans {
            self.failure = Some(LayoutError::Collinear { centre: cloud.centroid() });
        }
        spans
    }

    /// The two principal axes along which the points extend most, the longest first.
    fn axes(&self, members: &[usize]) -> [Vector3<f64>; 2] {
        let total = area(self.points, members);
        let weighted =
            || members.iter().map(|&a| (Vector3::from(self.points.positions[a]), self.points.areas[a] / total));
        let centre: Vector3<f64> = weighted().map(|(x, w)| w * x).sum();
        let spread: Matrix3<f64> = weighted().map(|(x, w)| w * (x - centre) * (x - centre).transpose()).sum();
        let eigen = SymmetricEigen::new(spread);
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
        [order[0], order[1]].map(|i| {
            let axis: Vector3<f64> = eigen.eigenvectors.column(i).into();
            // An axis and its opposite are the same: the cells' order should not depend on which one LAPACK's like
            // gives.
            axis * axis[axis.iamax()].signum()
        })
    }

    fn sorted(&self, members: &[usize], axis: Vector3<f64>) -> Vec<usize> {
        let along = |a: usize| axis.dot(&Vector3::from(self.points.positions[a]));
        let mut sorted = members.to_vec();
        sorted.sort_by(|&a, &b| along(a).total_cmp(&along(b)));
        sorted
    }

    /// Where to cut so that `left` of `n_cells` cells lie before: the best place by area, then those next to it.
    fn cuts(&self, sorted: &[usize], left: usize, n_cells: usize) -> Vec<usize> {
        let goal = area(self.points, sorted) * left as f64 / n_cells as f64;
        let (low, high) = (FEWEST * left, sorted.len() - FEWEST * (n_cells - left));
        let mut before = area(self.points, &sorted[..low]);
        let mut best = (low, (before - goal).abs());
        for cut in low + 1..=high {
            before += self.points.areas[sorted[cut - 1]];
            if (before - goal).abs() < best.1 {
                best = (cut, (before - goal).abs());
            }
        }
        let nearby = [0, 1, -1, 2, -2].map(|shift| best.0 as isize + shift);
        nearby.into_iter().filter(|cut| (low as isize..=high as isize).contains(cut)).map(|cut| cut as usize).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A `width x height` grid with unit areas, in pieces of `piece` columns.
    fn grid(width: usize, height: usize, piece: usize) -> (Vec<[f64; 3]>, Vec<f64>, Vec<usize>) {
        let at = (0..width * height).map(|i| (i % width, i / width));
        let positions = at.clone().map(|(i, j)| [i as f64, j as f64, 0.3]).collect();
        (positions, vec![1.0; width * height], at.map(|(i, _)| i / piece).collect())
    }

    fn divide(grid: &(Vec<[f64; 3]>, Vec<f64>, Vec<usize>), n: usize) -> Result<Vec<Vec<usize>>, LayoutError> {
        cells(&Points { positions: &grid.0, areas: &grid.1, pieces: &grid.2 }, n)
    }

    #[test]
    fn every_point_is_in_one_cell_and_areas_are_even() {
        let grid = grid(24, 15, 24);
        for n in [1, 6, 22, 52, 106] {
            let cells = divide(&grid, n).unwrap();
            assert_eq!(cells.len(), n);
            let mut all = cells.concat();
            all.sort_unstable();
            assert_eq!(all, (0..360).collect::<Vec<_>>());
            let mean = 360.0 / n as f64;
            // Each of the cuts above a cell may be off by half a point.
            assert!(cells.iter().all(|cell| (cell.len() as f64 - mean).abs() <= 1.0), "{n}");
        }
    }

    #[test]
    fn no_cell_reaches_across_a_slot() {
        let grid = grid(20, 10, 12);
        let cells = divide(&grid, 10).unwrap();
        for cell in &cells {
            assert!(cell.iter().all(|&a| grid.2[a] == grid.2[cell[0]]));
        }
        // 12 and 8 columns: six and four cells.
        assert_eq!(cells.iter().filter(|cell| grid.2[cell[0]] == 0).count(), 6);
    }

    #[test]
    fn cells_span_a_plane_even_of_three_or_four_points() {
        let grid = grid(9, 7, 9);
        assert_eq!(divide(&grid, 18).unwrap().len(), 18);
    }

    #[test]
    fn too_many_nodes_and_points_on_a_line_are_refused() {
        assert_eq!(divide(&grid(4, 4, 4), 6), Err(LayoutError::TooFine { n_cells: 6, n_points: 16 }));
        let line = grid(12, 1, 12);
        let refused = divide(&line, 2).unwrap_err();
        assert!(matches!(refused, LayoutError::Collinear { .. }));
        assert!(refused.to_string().contains("300.00) mm"), "{refused}");
    }

    #[test]
    fn shares_add_up_and_follow_the_areas() {
        assert_eq!(apportion(104, &[1.0, 1.0]), [52, 52]);
        assert_eq!(apportion(105, &[1.0, 1.0]), [53, 52]);
        assert_eq!(apportion(10, &[8.0, 1.0, 1.0]), [8, 1, 1]);
        assert_eq!(apportion(5, &[98.0, 1.0, 1.0]), [3, 1, 1]);
    }
}
