//! An LU factor with a label: the matrix that it is of.
//!
//! One factor serves the steps to an equilibrium and the modes about it, so that there is one symbolic analysis and one
//! place in memory. Who needs the factor of a matrix compares labels and factorises where they differ; so it does not
//! matter what used the factor before.

use crate::Result;
use crate::contact::Response;
use crate::native::{Factor, FactorKind, Matrix, Precision};

/// Names the values of `sigma^2 M + sigma C + K` at a real shift sigma.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// The shift, 1/s.
    pub shift: f64,
    /// Versions ([`Matrix::version`]) of the matrices in the sum: K alone without a shift.
    pub versions: Vec<[i64; 2]>,
}

impl Label {
    /// The label of a matrix as it is.
    ///
    /// # Errors
    /// PETSc's.
    pub fn of(a: &Matrix) -> Result<Label> {
        Ok(Label { shift: 0.0, versions: vec![a.version()?] })
    }
}

/// What was factorised.
struct Made {
    label: Label,
    /// What the contact points do in the matrix; none where their tangents are not in it as they are.
    points: Vec<Response>,
    /// Paid since then, in single solves.
    spent: f64,
}

/// The owner of a factor.
pub struct LabelledFactor {
    factor: Factor,
    made: Option<Made>,
}

impl LabelledFactor {
    /// Nothing is factorised yet.
    pub fn new(precision: Precision) -> LabelledFactor {
        let mut factor = Factor::new(FactorKind::Unsymmetric);
        factor.set_precision(precision);
        LabelledFactor { factor, made: None }
    }

    /// Factorises a matrix in which contact points do what `points` says. Collective.
    ///
    /// # Errors
    /// PETSc's and MUMPS's; there is no factor then.
    pub fn factorise(&mut self, a: &Matrix, label: Label, points: &[Response]) -> Result<()> {
        self.made = None;
        self.factor.factorise(a)?;
        self.made = Some(Made { label, points: points.to_vec(), spent: 0.0 });
        Ok(())
    }

    /// Whether this is the factor of the matrix with a label. Not collective.
    pub fn is_of(&self, label: &Label) -> bool {
        self.made.as_ref().is_some_and(|made| made.label == *label)
    }

    /// The shift of what was factorised, 1/s; none where nothing is. Not collective.
    pub fn shift(&self) -> Option<f64> {
        self.made.as_ref().map(|made| made.label.shift)
    }

    /// What the contact points do in the factorised matrix: empty where nothing is factorised. Not collective.
    pub fn points(&self) -> &[Response] {
        self.made.as_ref().map_or(&[], |made| &made.points)
    }

    /// Solves that may still be paid before a factorisation is cheaper. Not collective.
    pub fn n_solves_left(&self) -> f64 {
        let spent = self.made.as_ref().map_or(0.0, |made| made.spent);
        self.factor.solves_per_factorisation() - spent
    }

    /// Counts what was paid, in single solves. Not collective.
    pub fn spend(&mut self, n_solves: f64) {
        if let Some(made) = &mut self.made {
            made.spent += n_solves;
        }
    }

    /// From now on factorises in this precision. Collective.
    pub fn set_precision(&mut self, precision: Precision) {
        self.factor.set_precision(precision);
        self.made = None;
    }

    /// Gives the memory back. Collective.
    pub fn release(&mut self) {
        self.factor.release();
        self.made = None;
    }

    /// From now on an analysis keeps the factor out of core unless so much memory is left beside it, MB. Not
    /// collective.
    pub fn leave_mb(&mut self, mb: f64) {
        self.factor.leave_mb(mb);
    }

    /// The factor, to solve with.
    pub fn factor(&self) -> &Factor {
        &self.factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::native::Session;

    #[test]
    fn a_factor_is_of_its_matrix_until_the_values_change() {
        let comm = Session::start(&[]).unwrap();
        let mut a = Matrix::dense(&comm, 2, &[2.0, 1.0, 0.0, 3.0]).unwrap();
        let mut factor = LabelledFactor::new(Precision::Double);
        assert!(!factor.is_of(&Label::of(&a).unwrap()));
        factor.factorise(&a, Label::of(&a).unwrap(), &[]).unwrap();
        assert!(factor.is_of(&Label::of(&a).unwrap()) && factor.shift() == Some(0.0));
        let other = Matrix::dense(&comm, 2, &[2.0, 1.0, 0.0, 3.0]).unwrap();
        assert!(!factor.is_of(&Label::of(&other).unwrap()), "another matrix, of whatever values");
        a.axpy(1.0, &other).unwrap();
        assert!(!factor.is_of(&Label::of(&a).unwrap()), "other values");
    }

    #[test]
    fn a_failed_factorisation_leaves_no_label() {
        let comm = Session::start(&[]).unwrap();
        let regular = Matrix::dense(&comm, 2, &[1.0, 0.0, 0.0, 1.0]).unwrap();
        let singular = Matrix::dense(&comm, 2, &[1.0; 4]).unwrap();
        let mut factor = LabelledFactor::new(Precision::Double);
        factor.factorise(&regular, Label::of(&regular).unwrap(), &[]).unwrap();
        assert!(factor.factorise(&singular, Label::of(&singular).unwrap(), &[]).is_err());
        assert!(!factor.is_of(&Label::of(&regular).unwrap()) && !factor.is_of(&Label::of(&singular).unwrap()));
    }

    #[test]
    fn a_factorisation_begins_a_new_account() {
        let comm = Session::start(&[]).unwrap();
        let n = 200;
        let identity: Vec<f64> = (0..n * n).map(|at| if at % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        let a = Matrix::dense(&comm, n, &identity).unwrap();
        let mut factor = LabelledFactor::new(Precision::Double);
        factor.factorise(&a, Label::of(&a).unwrap(), &[]).unwrap();
        let all = factor.n_solves_left();
        factor.spend(1.5);
        assert!((factor.n_solves_left() - (all - 1.5)).abs() < 1e-12);
        factor.factorise(&a, Label::of(&a).unwrap(), &[]).unwrap();
        assert_eq!(factor.n_solves_left(), all);
    }
}
