//! The low-rank change of contact tangents.
//!
//! Points that open, close, stick or slip, or whose friction coefficient changes, change the stiffness by
//!
//! ```text
//! sum_a B_a^T (D_a - D_a0) B_a = U V^T        D_a - D_a0 = sum_k left_k right_k^T,  |right_k| = 1
//! ```
//!
//! with one dyad where a sliding point opens or closes, and at most three. They come from the singular values of the
//! change; where it is symmetric, from its eigenvalues, so that `left = lambda right` with the sign of lambda.

use nalgebra::{Matrix3, SymmetricEigen};

use crate::algebra::dot;

/// A tangent `D = -df/dg` of a point, N/m, by rows.
pub type Tangent = [[f64; 3]; 3];

/// A term `left right^T` of the change of a point's tangent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dyad {
    /// The contact point.
    pub point: usize,
    /// Force on the point for a unit of the gap along `right`, N/m.
    pub left: [f64; 3],
    /// Direction of the gap, of length 1.
    pub right: [f64; 3],
}

impl Dyad {
    /// `left . right`, N/m: the eigenvalue where the change is symmetric.
    pub fn stiffness(&self) -> f64 {
        dot(self.left, self.right)
    }
}

/// The change of the tangents of some points, as dyads.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TangentChange {
    /// Its terms, point by point.
    pub dyads: Vec<Dyad>,
}

impl TangentChange {
    /// A change this much smaller than the tangents themselves is rounding.
    pub const ROUNDING: f64 = 1e-12;

    /// The change of points from one tangent to another; what is `negligible` relative to a point's tangents is left
    /// out.
    pub fn between<'t>(
        tangents: impl Iterator<Item = (usize, &'t Tangent, &'t Tangent)>,
        negligible: f64,
    ) -> TangentChange {
        let changed = tangents.filter(|(_, before, now)| before != now);
        TangentChange {
            dyads: changed.flat_map(|(point, before, now)| dyads(point, before, now, negligible)).collect(),
        }
    }

    /// Number of dyads, the rank of the change.
    pub fn rank(&self) -> usize {
        self.dyads.len()
    }

    /// Points and forces whose loads are the columns of U.
    pub fn lefts(&self) -> Vec<(usize, [f64; 3])> {
        self.dyads.iter().map(|dyad| (dyad.point, dyad.left)).collect()
    }

    /// Points and directions whose loads are the columns of V.
    pub fn rights(&self) -> Vec<(usize, [f64; 3])> {
        self.dyads.iter().map(|dyad| (dyad.point, dyad.right)).collect()
    }

    /// `V^T x` from the gaps of x at all points.
    pub fn projections(&self, gaps: &[[f64; 3]]) -> Vec<f64> {
        self.dyads.iter().map(|dyad| dot(dyad.right, gaps[dyad.point])).collect()
    }
}

/// `now - before` as dyads.
fn dyads(point: usize, before: &Tangent, now: &Tangent, negligible: f64) -> Vec<Dyad> {
    // Stored by columns: `from` takes rows for columns.
    let [before, now] = [before, now].map(|rows| Matrix3::from(*rows).transpose());
    let (change, smallest) = (now - before, negligible * before.norm().max(now.norm()));
    if (change - change.transpose()).norm() <= smallest {
        let eigen = SymmetricEigen::new(0.5 * (change + change.transpose()));
        let direction = |k: usize| eigen.eigenvectors.column(k).into_owned();
        let dyad =
            |k: usize| Dyad { point, left: (eigen.eigenvalues[k] * direction(k)).into(), right: direction(k).into() };
        return (0..3).filter(|&k| eigen.eigenvalues[k].abs() > smallest).map(dyad).collect();
    }
    let svd = change.svd(true, true);
    let (u, v_t) = (svd.u.expect("computed above"), svd.v_t.expect("computed above"));
    let left = |k: usize| svd.singular_values[k] * u.column(k);
    let dyad = |k: usize| Dyad { point, left: left(k).into(), right: v_t.row(k).transpose().into() };
    (0..3).filter(|&k| svd.singular_values[k] > smallest).map(dyad).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NONE: Tangent = [[0.0; 3]; 3];

    fn change(before: &Tangent, now: &Tangent) -> TangentChange {
        TangentChange::between([(3, before, now)].into_iter(), TangentChange::ROUNDING)
    }

    fn tangent() -> impl Strategy<Value = Tangent> {
        prop::array::uniform3(prop::array::uniform3(-1.0..1.0))
    }

    proptest! {
        #[test]
        fn dyads_add_up_to_the_change(before in tangent(), now in tangent(), symmetric in any::<bool>()) {
            let transposed = |d: &Tangent| [0, 1, 2].map(|i| [0, 1, 2].map(|j| d[j][i]));
            let now = if symmetric {
                let (now, other, t) = (now, transposed(&now), transposed(&before));
                [0, 1, 2].map(|i| [0, 1, 2].map(|j| before[i][j] + now[i][j] + other[i][j] + t[i][j] - t[i][j]))
            } else {
                now
            };
            let dyads = change(&before, &now).dyads;
            for i in 0..3 {
                for j in 0..3 {
                    let sum: f64 = dyads.iter().map(|dyad| dyad.left[i] * dyad.right[j]).sum();
                    prop_assert!((sum - (now[i][j] - before[i][j])).abs() < 1e-12);
                }
            }
            prop_assert!(dyads.iter().all(|dyad| dyad.point == 3 && (dot(dyad.right, dyad.right) - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn a_sliding_point_that_closes_is_one_dyad() {
        // p' (n + mu t) n^T with n = z, t = x
        let closed = [[0.0, 0.0, 2.0], [0.0, 0.0, 0.0], [0.0, 0.0, 5.0]];
        let [dyad] = change(&NONE, &closed).dyads[..] else { panic!("one dyad") };
        assert!((dyad.right[2].abs() - 1.0).abs() < 1e-15, "{dyad:?}");
        assert!((dyad.stiffness() - 5.0).abs() < 1e-14);
    }

    #[test]
    fn a_symmetric_change_keeps_the_signs_of_its_eigenvalues() {
        // Singular values 1 and 1 alone would leave the two directions open.
        let now = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
        let mut stiffnesses: Vec<f64> = change(&NONE, &now).dyads.iter().map(Dyad::stiffness).collect();
        stiffnesses.sort_by(f64::total_cmp);
        assert_eq!(stiffnesses.len(), 2);
        assert!((stiffnesses[0] + 1.0).abs() < 1e-15 && (stiffnesses[1] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn what_is_negligible_is_left_out() {
        let before = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut now = before;
        now[0][1] = 1e-9;
        let rank = |negligible: f64| TangentChange::between([(0, &before, &now)].into_iter(), negligible).rank();
        assert_eq!([rank(1e-6), rank(1e-12)], [0, 1]);
    }
}
