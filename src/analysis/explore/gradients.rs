//! Derivatives of the nominal modes by left vectors.
//!
//! ```text
//! d lambda / dp = -y^H (dP/dp) x / y^H P'(lambda) x        P = lambda^2 M + lambda C + K + i G + viscoelastic terms
//! ```
//!
//! `dP/dp` is the difference of the matrices about the equilibria a little below and above the nominal value, which any
//! key of a model file has. It contains what the parameter changes in the matrices, and what it changes in the
//! equilibrium: contact status, contact stiffness of curved laws, prestress. It takes two equilibria a parameter and no
//! modes.

use num_complex::Complex64;

use crate::analysis::observer::{Event, Observer};
use crate::explore::{Difference, Gradient};
use crate::native::Block;
use crate::stability::{Approximation, QuadraticProblem};
use crate::{Error, Result};

use super::Run;
use super::groups::Groups;
use super::point::{at_equilibrium, of_point};

/// The nominal modes, with what turns a change of the matrices into one of the eigenvalues.
pub struct NominalVectors {
    /// Eigenvalues.
    pub lambdas: Vec<Complex64>,
    /// y, two columns a mode: real and imaginary part.
    pub left: Block,
    /// x
    pub right: Block,
    /// `y^H P'(lambda) x` of each mode.
    pub products: Vec<Complex64>,
    /// `y^H P(lambda) x` of each mode: 0 but for rounding.
    pub forms: Vec<Complex64>,
}

impl NominalVectors {
    /// Of modes of the problem. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        problem: &QuadraticProblem,
        lambdas: Vec<Complex64>,
        [left, right]: [Block; 2],
    ) -> Result<NominalVectors> {
        let mut own = NominalVectors { lambdas, left, right, products: Vec::new(), forms: Vec::new() };
        own.products = own.approximation().forms(problem, &|lambda| problem.slopes(lambda))?;
        own.forms = own.forms_of(problem)?;
        Ok(own)
    }

    /// `y^H P(lambda) x` of each mode with the matrices of a problem nearby. Collective.
    fn forms_of(&self, problem: &QuadraticProblem) -> Result<Vec<Complex64>> {
        if problem.comm().max(usize::from(problem.n_local() != self.right.n_local())) > 0 {
            return Err(Error::input("the parameter changes the dofs, so that there is no derivative"));
        }
        self.approximation().forms(problem, &|lambda| problem.coefficients(lambda))
    }

    fn approximation(&self) -> Approximation<'_> {
        Approximation { lambdas: &self.lambdas, right: &self.right, left: &self.left }
    }

    /// The derivative from the forms `step` below and above the nominal value, of which one may have failed.
    fn gradient(&self, step: f64, below: Result<Vec<Complex64>>, above: Result<Vec<Complex64>>) -> Gradient {
        let (from, to, length, difference) = match (below, above) {
            (Ok(below), Ok(above)) => (below, above, 2.0 * step, Difference::Central),
            (Err(_), Ok(above)) => (self.forms.clone(), above, step, Difference::Forward),
            (Ok(below), Err(_)) => (below, self.forms.clone(), step, Difference::Backward),
            (Err(reason), Err(_)) => {
                return Gradient { slopes: Vec::new(), difference: Difference::None(reason.to_string()) };
            }
        };
        let slope = |((to, from), product): ((&Complex64, &Complex64), &Complex64)| -(to - from) / (length * product);
        Gradient { slopes: to.iter().zip(&from).zip(&self.products).map(slope).collect(), difference }
    }
}

impl Run<'_> {
    /// The derivatives by parameters that the groups share out, with their numbers, from the displacements of the
    /// nominal equilibrium. Collective in the group.
    ///
    /// # Errors
    /// Those that are not of a point.
    pub(super) fn gradients(
        &self,
        vectors: &NominalVectors,
        displacements: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Vec<(usize, Gradient)>> {
        let (nominal, comm) = (&self.values[0], &self.groups.own);
        let is_own = |i: usize| i % self.groups.n_groups() == self.groups.number();
        let mut gradients = Vec::new();
        for (i, parameter) in self.study.parameters.iter().enumerate().filter(|(i, _)| is_own(*i)) {
            let Some(step) = parameter.step(nominal[i]) else {
                let difference = Difference::None("the parameter is 0 everywhere".to_owned());
                gradients.push((i, Gradient { slopes: Vec::new(), difference }));
                continue;
            };
            let mut forms = |sign: f64| {
                observer.event(Event::Stage(&format!("derivatives by {}", parameter.name)));
                let mut values = nominal.clone();
                values[i] += sign * step;
                let found = self.subject.structure(comm, &values).and_then(|(structure, friction)| {
                    let brake = (&structure, friction);
                    at_equilibrium(comm, brake, Some(displacements), observer, |sweep, equilibrium, _| {
                        sweep.linearise(equilibrium, |problem| vectors.forms_of(problem))
                    })
                });
                unless_fatal(&self.groups, found)
            };
            let (below, above) = (forms(-1.0)?, forms(1.0)?);
            gradients.push((i, vectors.gradient(step, below, above)));
        }
        Ok(gradients)
    }
}

/// A result whose error is that of a point, or the error that ends the study.
fn unless_fatal<T>(groups: &Groups, found: Result<T>) -> Result<Result<T>> {
    match found {
        // A reason is the same on all ranks.
        Err(error) => {
            let reason = of_point(groups, error)?.to_string();
            Ok(Err(Error::input(groups.own.broadcast_value(0, reason))))
        }
        Ok(found) => Ok(Ok(found)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::{Matrix, Mck, Session};

    /// One mass on a spring: `lambda^2 m + k = 0`, `d lambda / dk = -1 / (2 lambda m)`.
    #[test]
    fn a_spring_has_its_derivative_on_both_sides_and_on_one() {
        let comm = Session::start(&[]).unwrap();
        let matrix = |value: f64| Matrix::dense(&comm, 1, &[value]).unwrap();
        let (m, c, k) = (matrix(2.0), matrix(0.0), matrix(50.0));
        let lambda = Complex64::new(0.0, 5.0);
        let column = |re: f64, im: f64| Block::from_columns(&comm, 1, vec![re, im]);
        let vectors = |k: &Matrix, act: &dyn Fn(&QuadraticProblem)| {
            act(&QuadraticProblem::symmetric(Mck::from([&m, &c, k])));
        };
        vectors(&k, &|problem| {
            let own = NominalVectors::new(problem, vec![lambda], [column(0.6, 0.8), column(1.0, -2.0)]).unwrap();
            assert!(own.forms[0].norm() < 1e-12);
            let at = |value: f64| {
                let (k, mut found) = (matrix(value), Vec::new());
                found.extend(own.forms_of(&QuadraticProblem::symmetric(Mck::from([&m, &c, &k]))).unwrap());
                Ok(found)
            };
            let lost = || Err(Error::not_converged("lost"));
            let expected = -1.0 / (4.0 * lambda);
            for (found, difference) in [
                (own.gradient(0.5, at(49.5), at(50.5)), Difference::Central),
                (own.gradient(0.5, lost(), at(50.5)), Difference::Forward),
                (own.gradient(0.5, at(49.5), lost()), Difference::Backward),
            ] {
                assert!((found.slopes[0] - expected).norm() < 1e-12 && found.difference == difference, "{found:?}");
            }
            let none = own.gradient(0.5, lost(), lost());
            assert!(none.slopes.is_empty() && none.difference.text().contains("lost"));
        });
    }

    #[test]
    fn an_error_of_a_point_continues_and_a_full_disk_ends_the_study() {
        let comm = Session::start(&[]).unwrap();
        let groups = Groups::new(&comm, 1).unwrap();
        assert!(unless_fatal::<()>(&groups, Err(Error::input("density"))).unwrap().is_err());
        assert!(unless_fatal(&groups, Ok(1)).unwrap().is_ok());
        let full = Error::io("disc".as_ref())(std::io::ErrorKind::StorageFull.into());
        assert!(unless_fatal::<()>(&groups, Err(full)).is_err());
    }
}
