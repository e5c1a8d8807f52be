//! The tangent's factor, made anew only where it pays.
//!
//! With `A_0 = L U` the tangent of an earlier iterate, the points F that have opened, closed, stuck or slipped since differ by a low rank:
//!
//! ```text
//! A' = A_0 + sum_F B_a^T (D_a - D_a0) B_a = A_0 + U V^T
//! A'^-1 = A_0^-1 - W (I + V^T W)^-1 V^T A_0^-1       W = A_0^-1 U
//! ```
//!
//! (Sherman, Morrison and Woodbury; Golub and Van Loan, Matrix Computations, 2.1.4). W comes from solves with many right-hand sides at
//! a time. What A' lacks, the smooth change of friction and of slip directions, is left to GMRES with A' for its preconditioner. All
//! that is paid since the last factorisation is counted in solves; when it reaches the price of a factorisation, one is made.
//!
//! A factor in single precision takes half the time and memory, and GMRES the few digits that its solutions lack. Where it does not, the
//! factor is made in double precision from then on.

use nalgebra::{DMatrix, DVector, Dyn, LU, Matrix3};

use super::contacts::Contacts;
use crate::Result;
use crate::contact::Response;
use crate::native::petsc::linear;
use crate::native::{Block, Factor, FactorKind, Matrix, Precision, Vector, machine};

/// Right-hand sides that updates may keep: more are not worth it, and each takes n doubles.
const MAX_UPDATES: usize = 200;
/// Share of the free memory that updates may take; while they grow there are two of them.
const SHARE_OF_MEMORY: f64 = 0.4;
/// Iterations at most with a tangent's own factor in single precision.
const MAX_OWN_ITERATIONS: usize = 20;
/// A change of tangent this much smaller than the tangents themselves is GMRES's.
const NEGLIGIBLE: f64 = 1e-6;

/// `D_a - D_a0` of a point as a sum of dyads, `left right^T`.
struct Dyad {
    point: usize,
    left: [f64; 3],
    right: [f64; 3],
}

/// The columns of the low-rank change and what its inverse needs.
struct Update {
    dyads: Vec<Dyad>,
    /// `W = A_0^-1 U`.
    w: Block,
    /// `I + V^T W`.
    capacitance: LU<f64, Dyn, Dyn>,
}

/// A factor with the tangents of the points that it was made for.
pub(super) struct StepFactor {
    factor: Factor,
    /// What every point did at the last factorisation.
    made_for: Vec<Response>,
    /// What every point does in the current tangent.
    current: Vec<Response>,
    /// What every point did when the update was made.
    updated_for: Vec<Response>,
    update: Option<Update>,
    /// Whether the factor is that of the current tangent.
    exact: bool,
    /// Paid since the last factorisation, in single solves.
    spent: f64,
    n_iterations: usize,
}

impl StepFactor {
    pub(super) fn new(precision: Precision) -> StepFactor {
        let mut factor = Factor::new(FactorKind::Unsymmetric);
        factor.set_precision(precision);
        StepFactor {
            factor,
            made_for: Vec::new(),
            current: Vec::new(),
            updated_for: Vec::new(),
            update: None,
            exact: false,
            spent: 0.0,
            n_iterations: 0,
        }
    }

    /// Hears of a new tangent and the points in it.
    pub(super) fn adopt(&mut self, responses: Vec<Response>) {
        self.current = responses;
        self.exact = false;
    }

    /// `x = A^-1 b`: exactly with an own factor in double precision, else to the relative tolerance. Collective.
    pub(super) fn solve(
        &mut self,
        a: &Matrix,
        b: &Vector,
        x: &mut Vector,
        tolerance: f64,
        contacts: &mut Contacts,
    ) -> Result<()> {
        if !self.exact {
            if self.iterate(a, b, x, tolerance, contacts)? {
                return Ok(());
            }
            self.factorise(a)?;
        }
        if !self.factor.is_exact() {
            let mut inverse = |b: &Vector, x: &mut Vector| self.factor.solve(b, x);
            if linear::gmres(a, &mut inverse, b, x, tolerance, MAX_OWN_ITERATIONS)?.is_some() {
                return Ok(());
            }
            self.factor.set_precision(Precision::Double);
            self.factorise(a)?;
        }
        self.factor.solve(b, x)
    }

    /// Makes the current tangent's factor.
    fn factorise(&mut self, a: &Matrix) -> Result<()> {
        self.factor.factorise(a)?;
        self.made_for.clone_from(&self.current);
        self.update = None;
        self.exact = true;
        self.spent = 0.0;
        Ok(())
    }

    /// Tries GMRES with the updated old factor; tells whether it did.
    fn iterate(
        &mut self,
        a: &Matrix,
        b: &Vector,
        x: &mut Vector,
        tolerance: f64,
        contacts: &mut Contacts,
    ) -> Result<bool> {
        if self.made_for.is_empty() || !self.bring_up_to_date(b, contacts)? {
            return Ok(false);
        }
        let left = (self.factor.solves_per_factorisation() - self.spent).max(0.0) as usize;
        if left == 0 {
            return Ok(false);
        }
        let (factor, update) = (&self.factor, &self.update);
        let mut inverse = |b: &Vector, x: &mut Vector| apply(factor, update.as_ref(), b, x, contacts);
        let iterations = linear::gmres(a, &mut inverse, b, x, tolerance, left)?;
        self.n_iterations += iterations.unwrap_or(left);
        self.spent += iterations.unwrap_or(left) as f64;
        Ok(iterations.is_some())
    }

    /// Makes the update that of the current statuses, unless it costs too much; tells whether it did.
    fn bring_up_to_date(&mut self, like: &Vector, contacts: &mut Contacts) -> Result<bool> {
        let flipped = |a: &usize| self.made_for[*a].status != self.current[*a].status;
        let kept = |a: usize| self.updated_for.get(a).is_some_and(|old| old.status == self.current[a].status);
        let (old, old_columns) = self.update.take().map_or((Vec::new(), None), |old| (old.dyads, Some(old.w)));
        let still_true = old.into_iter().enumerate().filter(|(_, dyad)| flipped(&dyad.point) && kept(dyad.point));
        let (places, mut dyads): (Vec<usize>, Vec<Dyad>) = still_true.unzip();
        let known: Vec<usize> = dyads.iter().map(|dyad| dyad.point).collect();
        let new = (0..self.current.len()).filter(flipped).filter(|a| !known.contains(a));
        let new: Vec<Dyad> =
            new.flat_map(|a| dyads_of(a, &self.made_for[a].tangent, &self.current[a].tangent)).collect();
        let price = Factor::PRICE_AMONG_MANY * new.len() as f64;
        if dyads.len() + new.len() > room(like) || self.spent + price > self.factor.solves_per_factorisation() {
            return Ok(false);
        }
        self.spent += price;
        let mut w = Block::with_room(like.comm(), like.n_local(), dyads.len() + new.len());
        old_columns.iter().for_each(|old| places.iter().for_each(|&j| w.append(&old.columns(j..j + 1))));
        drop(old_columns);
        self.append_responses(&mut w, &new, contacts)?;
        dyads.extend(new);
        self.updated_for.clone_from(&self.current);
        if !dyads.is_empty() {
            let capacitance = capacitance(&dyads, &w, contacts)?.lu();
            self.update = Some(Update { dyads, w, capacitance });
        }
        Ok(true)
    }

    /// Appends `A_0^-1 B^T left` of each dyad.
    fn append_responses(&self, w: &mut Block, dyads: &[Dyad], contacts: &Contacts) -> Result<()> {
        let forces: Vec<(usize, [f64; 3])> = dyads.iter().map(|dyad| (dyad.point, dyad.left)).collect();
        forces.chunks(Block::AT_ONCE).try_for_each(|forces| {
            w.append(&contacts.loads(w.comm(), forces).solved_by(&self.factor)?);
            Ok(())
        })
    }

    /// The factor, to be made for points that do this; steps to come start from it.
    pub(super) fn lend(&mut self, made_for: Vec<Response>) -> &mut Factor {
        self.made_for = made_for;
        self.update = None;
        self.exact = false;
        self.spent = 0.0;
        &mut self.factor
    }

    /// Goes on in another precision. Collective.
    pub(super) fn set_precision(&mut self, precision: Precision) {
        self.factor.set_precision(precision);
        self.made_for.clear();
    }

    /// The factor.
    pub(super) fn factor(&self) -> &Factor {
        &self.factor
    }

    /// Iterations with updated old factors.
    pub(super) fn n_iterations(&self) -> usize {
        self.n_iterations
    }
}

/// How many columns an update may have. Collective.
fn room(like: &Vector) -> usize {
    let column_mb = 8.0 * like.comm().sum(like.n_local()) as f64 / (1024.0 * 1024.0);
    let room = SHARE_OF_MEMORY * machine::available_mb(like.comm()) / column_mb;
    MAX_UPDATES.min(room as usize)
}

/// `x = A'^-1 b`.
fn apply(factor: &Factor, update: Option<&Update>, b: &Vector, x: &mut Vector, contacts: &mut Contacts) -> Result<()> {
    factor.solve(b, x)?;
    let Some(Update { dyads, w, capacitance }) = update else { return Ok(()) };
    let y = capacitance.solve(&DVector::from_vec(projections(dyads, x, contacts)?));
    let y = y.ok_or_else(|| crate::Error::Singular { found_by: "the update of the tangent".into() })?;
    let correction = w.combined(y.as_slice(), 1);
    x.local_mut(|x| x.iter_mut().zip(correction.column(0)).for_each(|(x, c)| *x -= c))
}

/// `V^T z`, that is `right^T B_a z` of each dyad.
fn projections(dyads: &[Dyad], z: &Vector, contacts: &mut Contacts) -> Result<Vec<f64>> {
    let gaps = contacts.gaps(z)?;
    Ok(dyads.iter().map(|dyad| crate::algebra::dot(dyad.right, gaps[dyad.point])).collect())
}

/// `I + V^T W`.
fn capacitance(dyads: &[Dyad], w: &Block, contacts: &mut Contacts) -> Result<DMatrix<f64>> {
    let n = dyads.len();
    let mut matrix = DMatrix::identity(n, n);
    for j in 0..n {
        for (i, value) in projections(dyads, &w.vector(j)?, contacts)?.into_iter().enumerate() {
            matrix[(i, j)] += value;
        }
    }
    Ok(matrix)
}

/// `now - before` as dyads, by its singular values: one where a point opens or closes and slides.
fn dyads_of(point: usize, before: &[[f64; 3]; 3], now: &[[f64; 3]; 3]) -> Vec<Dyad> {
    let matrix = |rows: &[[f64; 3]; 3]| Matrix3::from(*rows).transpose();
    let (before, now) = (matrix(before), matrix(now));
    let smallest = NEGLIGIBLE * before.norm().max(now.norm());
    let svd = (now - before).svd(true, true);
    let (u, v_t) = (svd.u.expect("asked for"), svd.v_t.expect("asked for"));
    let dyad = |k: usize| Dyad {
        point,
        left: (svd.singular_values[k] * u.column(k)).into(),
        right: v_t.row(k).transpose().into(),
    };
    (0..3).filter(|&k| svd.singular_values[k] > smallest).map(dyad).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dyads_add_up_to_the_change() {
        let before = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
        let now = [[0.0, 1.0, 0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
        let dyads = dyads_of(3, &before, &now);
        assert_eq!(dyads.len(), 1, "only the first row changes");
        for i in 0..3 {
            for j in 0..3 {
                let sum: f64 = dyads.iter().map(|dyad| dyad.left[i] * dyad.right[j]).sum();
                assert!((sum - (now[i][j] - before[i][j])).abs() < 1e-14);
            }
        }
    }
}
