//! Equilibria and modes at one friction coefficient after the other.
//!
//! [`Sweep`] owns what all values share: the system, its contact evaluation, the factors' analysis, the last
//! equilibrium. Each call of [`Sweep::equilibrium`] and [`Sweep::modes`] adds one value.

use std::f64::consts::TAU;
use std::time::Instant;

use super::observer::{Event, Observer};
use crate::assembly::{Prestress, System};
use crate::contact::interface::Interface;
use crate::equilibrium::{Equilibrium, LinearSystem, Path};
use crate::native::{Block, FactorStats, Matrix, Precision, Vector};
use crate::stability::{self, Band, BandSolver, Count, EigenOptions, LinearTerms, Linearised, Mode, QuadraticProblem};
use crate::structure::Structure;
use crate::{ErrorKind, Result};

/// A structure under analysis at one friction coefficient after the other.
pub struct Sweep<'a> {
    /// The system.
    pub(super) system: &'a System,
    pub(super) path: Path<'a>,
    solver: BandSolver,
    linearised: Linearised,
    /// What the modes have beside contact.
    pub(super) terms: LinearTerms<'a>,
    /// Spent on equilibria, modes and left vectors.
    seconds: [f64; 3],
}

/// What a sweep has cost.
#[derive(Debug, Clone, Copy, Default)]
pub struct Costs {
    /// Spent on equilibria, s.
    pub equilibria_seconds: f64,
    /// Spent on modes, s.
    pub modes_seconds: f64,
    /// Spent on left vectors, s.
    pub left_seconds: f64,
    /// LU of the equilibria's tangents and of the modes' stiffness: one factor for both.
    pub lu: FactorStats,
    /// Iterations of the equilibria's linear systems with factors of neighbouring tangents.
    pub n_iterations: usize,
    /// Symmetric factor that counts modes.
    pub symmetric: FactorStats,
}

impl Costs {
    /// All stages and each factor as text, after a run of `seconds` on `ranks` ranks.
    pub fn text(&self, seconds: f64, ranks: usize) -> String {
        let mut text = format!(
            "{seconds:.1} s on {ranks} rank{}: equilibria {:.1} s, modes {:.1} s, left vectors {:.1} s; {} iterations with a previous factor\n",
            if ranks == 1 { "" } else { "s" },
            self.equilibria_seconds,
            self.modes_seconds,
            self.left_seconds,
            self.n_iterations
        );
        let factors = [("LU", self.lu), ("LDL^T", self.symmetric)];
        for (name, cost) in factors.iter().filter(|(_, cost)| cost.n_factorisations > 0) {
            text += &format!(
                "{name}{}: {} analysis {:.1} s, {} factorisations {:.1} s, {} solves of {} right-hand sides {:.1} s; {:.0} M entries, \
                 {:.0} MB of {:.0} MB estimated{}, ordering {}\n",
                if cost.single { " in single precision" } else { "" },
                cost.n_analyses,
                cost.analysis_seconds,
                cost.n_factorisations,
                cost.factorisation_seconds,
                cost.n_solves,
                cost.n_right_hand_sides,
                cost.solve_seconds,
                1e-6 * cost.entries,
                cost.used_mb,
                cost.estimated_mb,
                if cost.out_of_core { ", out of core" } else { "" },
                cost.ordering_name()
            );
        }
        text
    }
}

impl<'a> Sweep<'a> {
    /// A sweep that starts from rest; with `friction_damping` the friction that turns with the velocity damps the
    /// modes. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(system: &'a System, interface: &'a Interface, friction_damping: bool) -> Result<Sweep<'a>> {
        Ok(Sweep {
            system,
            path: Path::new(system, interface)?,
            solver: BandSolver::new(EigenOptions::default(), system.dofs.labels()),
            linearised: Linearised::default(),
            terms: LinearTerms { friction_damping, ..LinearTerms::default() },
            seconds: [0.0; 3],
        })
    }

    /// The sweep of a structure, its modes with the structure's friction damping, and prestress where it is given.
    /// Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn of(structure: &'a Structure, system: &'a System, prestress: Option<&'a Prestress<'a>>) -> Result<Sweep<'a>> {
        let sweep = Sweep::new(system, structure.interface(), structure.friction_damping())?;
        Ok(sweep.with_prestress(prestress))
    }

    /// The same, whose modes have the geometric stiffness of the equilibrium, where one is given.
    pub fn with_prestress(mut self, prestress: Option<&'a Prestress<'a>>) -> Sweep<'a> {
        self.terms.prestress = prestress;
        self
    }

    /// The equilibrium at a friction coefficient of the swept pairs, from the last one. Collective.
    ///
    /// # Errors
    /// See [`Path::advance`].
    pub fn equilibrium(&mut self, friction: f64, observer: &mut dyn Observer) -> Result<Equilibrium> {
        let start = Instant::now();
        // Its memory is needed.
        self.solver.release_search_space();
        let outcome = self.path.advance(friction, &mut |label, iteration, iterate| {
            observer.event(Event::Newton { label, iteration, iterate });
        });
        self.seconds[0] += start.elapsed().as_secs_f64();
        outcome
    }

    /// All modes of a band (Hz) about an equilibrium, their reference frequency the band's end. Collective.
    ///
    /// # Errors
    /// See [`BandSolver::solve_band`].
    pub fn modes(&mut self, equilibrium: &Equilibrium, band: [f64; 2], observer: &mut dyn Observer) -> Result<Band> {
        let start = Instant::now();
        self.terms.reference = TAU * band[1];
        let LinearSystem { contacts, tangent, factor } = self.path.linear_system();
        self.linearised = Linearised::new(self.system, contacts, equilibrium, self.terms, tangent)?;
        let problem = self.linearised.problem(self.system, contacts, tangent);
        let mut progress = |progress| observer.event(Event::Modes(progress));
        let outcome = self.solver.solve_band(&problem, factor, &band.into(), &mut progress);
        self.seconds[1] += start.elapsed().as_secs_f64();
        outcome
    }

    /// As [`Sweep::equilibrium`], from displacements that are near it; from rest where Newton's method does not
    /// converge from there. Collective.
    ///
    /// # Errors
    /// See [`Path::advance`].
    pub fn equilibrium_near(&mut self, u: Vector, friction: f64, observer: &mut dyn Observer) -> Result<Equilibrium> {
        self.restore(vec![(friction, u)], None);
        match self.equilibrium(friction, observer) {
            Err(error) if error.kind() == ErrorKind::NotConverged => {
                self.restore(Vec::new(), None);
                self.equilibrium(friction, observer)
            }
            outcome => outcome,
        }
    }

    /// Makes M, C and K about an equilibrium, and lends them to `look`. Collective.
    ///
    /// # Errors
    /// PETSc's; those of `look`.
    pub fn linearise<T>(
        &mut self,
        equilibrium: &Equilibrium,
        look: impl FnOnce(&QuadraticProblem) -> Result<T>,
    ) -> Result<T> {
        let LinearSystem { contacts, tangent, .. } = self.path.linear_system();
        self.linearised = Linearised::new(self.system, contacts, equilibrium, self.terms, tangent)?;
        look(&self.linearised.problem(self.system, contacts, tangent))
    }

    /// The stiffness about an equilibrium without friction's coupling. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn symmetric_stiffness(&mut self, equilibrium: &Equilibrium) -> Result<Matrix> {
        let mut stiffness = self.linearise(equilibrium, |problem| problem.symmetric_stiffness())?;
        stiffness.declare_symmetric()?;
        Ok(stiffness)
    }

    /// Goes about it as for a large structure, whatever the size: with blocks of right-hand sides
    /// ([`EigenOptions::always_blocked`]) and factors in single precision. Collective.
    pub fn solve_as_large(&mut self) {
        self.search_by(EigenOptions::always_blocked());
        self.path.set_precision(Precision::Single);
    }

    /// From now on finds modes by other tolerances than the default ones.
    pub fn search_by(&mut self, options: EigenOptions) {
        self.solver = BandSolver::new(options, self.system.dofs.labels());
    }

    /// Left vectors of the modes of the last [`Sweep::modes`], each to the accuracy asked for. Collective.
    ///
    /// # Errors
    /// See [`BandSolver::left_vectors`].
    pub fn left_vectors(&mut self, modes: &[Mode], accuracy: impl Fn(&Mode) -> f64) -> Result<Block> {
        let start = Instant::now();
        let LinearSystem { contacts, tangent, factor } = self.path.linear_system();
        let problem = self.linearised.problem(self.system, contacts, tangent);
        let outcome = self.solver.left_vectors(&problem, factor, modes, accuracy);
        self.seconds[2] += start.elapsed().as_secs_f64();
        outcome
    }

    /// Right vectors of such modes in the same form. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn right_vectors(&self, modes: &[Mode]) -> Result<Block> {
        stability::right_vectors(&self.system.m, modes)
    }

    /// The damping of the last modes, where friction has its part in it.
    ///
    /// # Errors
    /// PETSc's.
    pub fn own_damping(&self) -> Result<Option<Matrix>> {
        self.linearised.c.as_ref().map(Matrix::duplicate).transpose()
    }

    /// The damping about an equilibrium that is known by its displacements, where friction has its part in it.
    /// Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn damping_at(&mut self, friction: f64, u: &Vector) -> Result<Option<Matrix>> {
        let contacts = self.path.contacts();
        let responses = contacts.respond(u, &contacts.interface().stage(friction))?;
        let damped = || stability::with_friction_damping(self.system, contacts, friction, &responses);
        self.terms.friction_damping.then(damped).transpose()
    }

    /// The equilibria from which the path goes on: [`Path::states`].
    pub fn states(&self) -> Vec<(f64, &Vector)> {
        self.path.states()
    }

    /// Puts the path back to where it was ([`Path::restore`]), and the count of modes to where the last one was taken.
    pub fn restore(&mut self, states: Vec<(f64, Vector)>, count: Option<&Count>) {
        self.path.restore(states);
        count.into_iter().for_each(|count| self.solver.resume(count));
    }

    /// The last state tried, for output after a failure.
    pub fn path(&self) -> &Path<'a> {
        &self.path
    }

    /// What the sweep has cost so far.
    pub fn costs(&self) -> Costs {
        Costs {
            equilibria_seconds: self.seconds[0],
            modes_seconds: self.seconds[1],
            left_seconds: self.seconds[2],
            lu: self.path.factor().stats(),
            n_iterations: self.path.n_iterations(),
            symmetric: self.solver.count_stats(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::testing::{ALONG_X, blocks_on_belt};
    use crate::native::Session;

    #[test]
    fn an_equilibrium_is_found_from_displacements_near_it_and_from_rest_where_these_are_useless() {
        let comm = Session::start(&[]).unwrap();
        let (system, interface) = blocks_on_belt(&comm, 4, 1, ALONG_X);
        let from_rest = Sweep::new(&system, &interface, false).unwrap().equilibrium(0.3, &mut ()).unwrap();
        let expected = from_rest.u.to_vec().unwrap();
        let mut useless = system.zeros().unwrap();
        useless.local_mut(|values| values.fill(f64::NAN)).unwrap();
        for (start, n_steps) in [(from_rest.u.duplicate().unwrap(), 1), (useless, from_rest.steps.len() + 1)] {
            let mut sweep = Sweep::new(&system, &interface, false).unwrap();
            let found = sweep.equilibrium_near(start, 0.3, &mut ()).unwrap();
            assert!(found.u.to_vec().unwrap().iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9));
            assert_eq!(found.steps.len(), n_steps);
        }
    }
}
