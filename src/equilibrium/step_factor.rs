//! The tangent's factor, made again only where it pays.
//!
//! With `A_0 = L U` the tangent of an earlier iterate, the points F that have opened, closed, stuck or slipped since
//! differ by a low rank:
//!
//! ```text
//! A' = A_0 + sum_F B_a^T (D_a - D_a0) B_a = A_0 + U V^T
//! ```
//!
//! whose inverse is [`Woodbury`]'s, with W from solves with many right-hand sides at a time. What A' lacks, the smooth
//! change of friction and of slip directions, is left to GMRES with A' for its preconditioner. All that is paid since
//! the last factorisation is counted in solves; when it reaches the price of a factorisation, one is made.
//!
//! A factor in single precision takes half the time and memory, and GMRES the few digits that its solutions lack. Where
//! it does not, the factor is made in double precision from then on.

use nalgebra::DMatrix;

use super::contacts::Contacts;
use super::labelled_factor::{Label, LabelledFactor};
use super::woodbury::Woodbury;
use crate::Result;
use crate::contact::{Dyad, Response, TangentChange};
use crate::native::petsc::linear;
use crate::native::{Block, Factor, Matrix, Precision, Vector, machine};

/// Right-hand sides that updates may keep: more are not worth it, and each takes n doubles.
const MAX_UPDATES: usize = 200;
/// Share of the free memory that updates may take; while they grow there are two of them.
const UPDATE_SHARE_OF_MEMORY: f64 = 0.4;
/// Iterations at most with a tangent's own factor in single precision.
const MAX_OWN_ITERATIONS: usize = 20;
/// A change of tangent this much smaller than the tangents themselves is left to GMRES.
const CHANGE_LEFT_TO_GMRES: f64 = 1e-6;

/// The inverse of the factorised matrix with the current states of its points.
struct Update {
    change: TangentChange,
    inverse: Woodbury,
    /// What every point did when it was made.
    states: Vec<Response>,
}

/// A system `A x = b` with the current tangent.
pub(super) struct StepSystem<'s, 'a> {
    pub a: &'s Matrix,
    pub contacts: &'s Contacts<'a>,
    /// Of the residual, relative.
    pub tolerance: f64,
}

/// Solves with one tangent after the other.
pub(super) struct StepFactor {
    factor: LabelledFactor,
    /// What every point does in the current tangent.
    current: Vec<Response>,
    update: Option<Update>,
    n_iterations: usize,
}

impl StepFactor {
    pub(super) fn new(precision: Precision) -> StepFactor {
        StepFactor { factor: LabelledFactor::new(precision), current: Vec::new(), update: None, n_iterations: 0 }
    }

    /// Takes note of a new tangent's points.
    pub(super) fn set_points(&mut self, responses: Vec<Response>) {
        self.current = responses;
    }

    /// `x = A^-1 b`: exactly with A's own factor in double precision, else to the tolerance. Collective.
    pub(super) fn solve(&mut self, system: &StepSystem, b: &Vector, x: &mut Vector) -> Result<()> {
        if !self.factor.is_of(&Label::of(system.a)?) {
            if self.iterate(system, b, x)? {
                return Ok(());
            }
            self.factorise(system.a)?;
        }
        if !self.factor.factor().is_exact() {
            let mut inverse = |b: &Vector, x: &mut Vector| self.factor.factor().solve(b, x);
            if linear::gmres(system.a, &mut inverse, b, x, system.tolerance, MAX_OWN_ITERATIONS)?.is_some() {
                return Ok(());
            }
            self.factor.set_precision(Precision::Double);
            self.factorise(system.a)?;
        }
        self.factor.factor().solve(b, x)
    }

    /// Makes the current tangent's factor.
    fn factorise(&mut self, a: &Matrix) -> Result<()> {
        self.update = None;
        self.factor.factorise(a, Label::of(a)?, &self.current)
    }

    /// Tries GMRES with the updated old factor; gives whether it converged.
    fn iterate(&mut self, system: &StepSystem, b: &Vector, x: &mut Vector) -> Result<bool> {
        if self.factor.points().is_empty() || !self.bring_up_to_date(b, system.contacts)? {
            return Ok(false);
        }
        let n_left = self.factor.n_solves_left().max(0.0) as usize;
        if n_left == 0 {
            return Ok(false);
        }
        let (factor, update) = (self.factor.factor(), self.update.as_ref());
        let mut inverse = |b: &Vector, x: &mut Vector| apply(factor, update, b, x, system.contacts);
        let iterations = linear::gmres(system.a, &mut inverse, b, x, system.tolerance, n_left)?;
        self.n_iterations += iterations.unwrap_or(n_left);
        self.factor.spend(iterations.unwrap_or(n_left) as f64);
        Ok(iterations.is_some())
    }

    /// Makes the update that of the current states, unless it costs too much or its matrix is singular; gives whether
    /// it did.
    fn bring_up_to_date(&mut self, like: &Vector, contacts: &Contacts) -> Result<bool> {
        let (points, old) = (self.factor.points(), self.update.take());
        let has_flipped = |a: usize| points[a].status != self.current[a].status;
        let is_kept = |old: &Update, a: usize| has_flipped(a) && old.states[a].status == self.current[a].status;
        let kept: Vec<(usize, Dyad)> = old.iter().flat_map(|old| old.kept(|a| is_kept(old, a))).collect();
        let is_new = |a: &usize| has_flipped(*a) && !kept.iter().any(|(_, dyad)| dyad.point == *a);
        let changed = (0..points.len()).filter(is_new).map(|a| (a, &points[a].tangent, &self.current[a].tangent));
        let new = TangentChange::between(changed, CHANGE_LEFT_TO_GMRES);
        let (rank, price) = (kept.len() + new.rank(), Factor::PRICE_AMONG_MANY * new.rank() as f64);
        if rank > max_rank(like) || price > self.factor.n_solves_left() {
            return Ok(false);
        }
        self.factor.spend(price);
        let mut w = Block::with_room(like.comm(), like.n_local(), rank);
        if let Some(old) = old {
            let columns = old.inverse.into_columns();
            kept.iter().for_each(|&(j, _)| w.append(&columns.columns(j..j + 1)));
        }
        for forces in new.lefts().chunks(Block::AT_ONCE) {
            w.append(&contacts.loads(w.comm(), forces).solved_by(self.factor.factor())?);
        }
        let dyads = kept.into_iter().map(|(_, dyad)| dyad).chain(new.dyads).collect();
        self.set_update(TangentChange { dyads }, w, contacts)
    }

    /// Makes an update of a change and W; gives whether its matrix is regular.
    fn set_update(&mut self, change: TangentChange, w: Block, contacts: &Contacts) -> Result<bool> {
        if change.rank() == 0 {
            return Ok(true);
        }
        let mut projected = Vec::new();
        for j in 0..w.n_columns() {
            projected.extend(change.projections(&contacts.gaps(&w.vector(j)?)?));
        }
        let inverse = Woodbury::new(w, DMatrix::from_vec(change.rank(), change.rank(), projected));
        self.update = inverse.map(|inverse| Update { change, inverse, states: self.current.clone() });
        Ok(self.update.is_some())
    }

    /// The factor, for matrices of others; what updates it for the steps is dropped.
    pub(super) fn labelled(&mut self) -> &mut LabelledFactor {
        self.update = None;
        &mut self.factor
    }

    /// The factor.
    pub(super) fn factor(&self) -> &Factor {
        self.factor.factor()
    }

    /// Iterations with updated old factors.
    pub(super) fn n_iterations(&self) -> usize {
        self.n_iterations
    }
}

impl Update {
    /// Dyads of points that meet a condition, with their columns in W.
    fn kept(&self, is_kept: impl Fn(usize) -> bool) -> Vec<(usize, Dyad)> {
        self.change.dyads.iter().copied().enumerate().filter(|(_, dyad)| is_kept(dyad.point)).collect()
    }
}

/// How many columns an update may have. Collective.
fn max_rank(like: &Vector) -> usize {
    let column_mb = 8.0 * like.comm().sum(like.n_local()) as f64 / (1024.0 * 1024.0);
    let n_columns = UPDATE_SHARE_OF_MEMORY * machine::available_mb(like.comm()) / column_mb;
    MAX_UPDATES.min(n_columns as usize)
}

/// `x = A'^-1 b`.
fn apply(factor: &Factor, update: Option<&Update>, b: &Vector, x: &mut Vector, contacts: &Contacts) -> Result<()> {
    factor.solve(b, x)?;
    let Some(Update { change, inverse, .. }) = update else { return Ok(()) };
    let projected = change.projections(&contacts.gaps(x)?);
    x.local_mut(|x| inverse.correct(&projected, x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::System;
    use crate::contact::{Interface, Stage, Tangential};
    use crate::equilibrium::testing::{ALONG_X, blocks_on_belt};
    use crate::native::Session;

    /// A tangent after the other of one structure, solved for with one factor.
    struct Tangents<'a> {
        system: &'a System,
        contacts: Contacts<'a>,
        a: Matrix,
        factor: StepFactor,
    }

    impl<'a> Tangents<'a> {
        fn new(system: &'a System, interface: &'a Interface) -> Tangents<'a> {
            let contacts = Contacts::new(interface, system).unwrap();
            let (a, factor) = (system.k.duplicate().unwrap(), StepFactor::new(Precision::Double));
            Tangents { system, contacts, a, factor }
        }

        /// Solves with the tangent in which the points of `open` are open, at a friction value. Gives the residual.
        fn solve(&mut self, open: &[usize], mu: f64) -> f64 {
            let mut u = vec![0.0; self.a.n_local()];
            (0..u.len() / 3).for_each(|i| u[3 * i + 2] = if open.contains(&i) { 1.0 } else { -1.0 });
            let u = Vector::from_local(self.system.k.comm(), &u).unwrap();
            let stage = Stage::Solve { friction: vec![mu] };
            let responses = self.contacts.respond(&u, &stage).unwrap();
            self.a.copy_from(&self.system.k).unwrap();
            self.contacts.add_blocks(responses.iter().map(|r| r.tangent), &mut self.a).unwrap();
            self.factor.set_points(responses);
            let b: Vec<f64> = (0..self.a.n_local()).map(|i| 1.0 + (i % 5) as f64).collect();
            let b = Vector::from_local(self.system.k.comm(), &b).unwrap();
            let [mut x, mut r] = [b.duplicate().unwrap(), b.duplicate().unwrap()];
            let system = StepSystem { a: &self.a, contacts: &self.contacts, tolerance: 1e-8 };
            self.factor.solve(&system, &b, &mut x).unwrap();
            self.a.multiply(&x, &mut r).unwrap();
            r.axpy(-1.0, &b).unwrap();
            r.norm().unwrap() / b.norm().unwrap()
        }

        fn n_factorisations(&self) -> usize {
            self.factor.factor().stats().n_factorisations
        }
    }

    /// 40 blocks: a factorisation of 120 dofs is worth two or three solves, or a change of rank up to 16.
    const N: usize = 40;

    fn dense(comm: &crate::native::Comm, tangential: Tangential) -> (System, Interface) {
        let (mut system, interface) = blocks_on_belt(comm, N, 0, tangential);
        system.k.store_dense().unwrap();
        (system, interface)
    }

    #[test]
    fn a_tangents_own_factor_solves_exactly_and_is_made_once() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = dense(&comm, ALONG_X);
        let mut tangents = Tangents::new(&system, &interface);
        assert!(tangents.solve(&[], 0.2) < 1e-12);
        assert_eq!((tangents.n_factorisations(), tangents.factor.n_iterations()), (1, 0));
    }

    #[test]
    fn points_that_open_update_the_old_factor() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = dense(&comm, ALONG_X);
        let mut tangents = Tangents::new(&system, &interface);
        tangents.solve(&[], 0.2);
        assert!(tangents.solve(&[3, 17], 0.2) < 1e-8);
        assert_eq!(tangents.n_factorisations(), 1, "two dyads are cheaper than a factorisation");
        assert_eq!(tangents.factor.n_iterations(), 1, "and exact: one iteration");
        assert_eq!(tangents.factor.update.as_ref().unwrap().change.rank(), 2);
    }

    #[test]
    fn an_update_keeps_the_columns_of_points_that_stay_changed() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = dense(&comm, ALONG_X);
        let mut tangents = Tangents::new(&system, &interface);
        tangents.solve(&[], 0.2);
        tangents.solve(&[3], 0.2);
        let left = tangents.factor.factor.n_solves_left();
        assert!(tangents.solve(&[3, 17], 0.2) < 1e-8);
        let paid = left - tangents.factor.factor.n_solves_left();
        assert!((paid - (1.0 + Factor::PRICE_AMONG_MANY)).abs() < 1e-12, "one column and one iteration: {paid}");
        let update = tangents.factor.update.as_ref().unwrap();
        assert_eq!(update.change.dyads.iter().map(|dyad| dyad.point).collect::<Vec<_>>(), [3, 17]);
        assert_eq!(tangents.n_factorisations(), 1);
    }

    #[test]
    fn a_smooth_change_is_left_to_gmres() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = dense(&comm, ALONG_X);
        let mut tangents = Tangents::new(&system, &interface);
        tangents.solve(&[], 0.2);
        tangents.factor.labelled().spend(-100.0);
        assert!(tangents.solve(&[], 0.25) < 1e-8);
        assert!(tangents.n_factorisations() == 1 && tangents.factor.update.is_none());
        assert!((1..100).contains(&tangents.factor.n_iterations()));
    }

    #[test]
    fn a_change_that_costs_more_than_a_factorisation_makes_one() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = dense(&comm, ALONG_X);
        let mut tangents = Tangents::new(&system, &interface);
        tangents.solve(&[], 0.2);
        let all: Vec<usize> = (0..N).collect();
        assert!(tangents.solve(&all, 0.2) < 1e-12);
        assert_eq!((tangents.n_factorisations(), tangents.factor.n_iterations()), (2, 0));
    }

    #[test]
    fn a_change_that_costs_more_than_a_factorisation_is_not_solved_for() {
        let comm = Session::start(&[]).unwrap();
        // Stored sparsely, whose right-hand sides are counted.
        let (system, interface) = blocks_on_belt(&comm, N, 0, ALONG_X);
        let mut tangents = Tangents::new(&system, &interface);
        tangents.solve(&[], 0.2);
        tangents.solve(&(0..N).collect::<Vec<_>>(), 0.2);
        let stats = tangents.factor.factor().stats();
        assert_eq!((stats.n_factorisations, stats.n_right_hand_sides), (2, 2));
    }

    #[test]
    fn a_spent_account_makes_a_factorisation() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = dense(&comm, ALONG_X);
        let mut tangents = Tangents::new(&system, &interface);
        tangents.solve(&[], 0.2);
        let left = tangents.factor.factor.n_solves_left();
        tangents.factor.factor.spend(left - 0.5);
        assert!(tangents.solve(&[3], 0.2) < 1e-12);
        assert_eq!((tangents.n_factorisations(), tangents.factor.n_iterations()), (2, 0));
    }

    #[test]
    fn lent_to_others_the_factor_keeps_its_label_and_loses_its_update() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = dense(&comm, ALONG_X);
        let mut tangents = Tangents::new(&system, &interface);
        tangents.solve(&[], 0.2);
        tangents.solve(&[3], 0.2);
        let open =
            tangents.factor.labelled().points().iter().filter(|r| r.status == crate::contact::Status::Open).count();
        assert_eq!(open, 0, "the factor is still that of the first tangent");
        assert!(tangents.factor.update.is_none());
        assert!(tangents.solve(&[3], 0.2) < 1e-8);
        assert_eq!(tangents.n_factorisations(), 1);
    }
}
