//! Branches: modes followed along a parameter, Hopf points, and the modes that couple. Pure: knows neither PETSc nor
//! files.
//!
//! A [`Family`] is an eigenproblem `P(lambda; p) x = 0` that can be solved at any value of a scalar p: friction, a load
//! factor, a material constant, damping. With `z = (x, lambda x)` the state of a mode and `w` the dual state of its
//! left vector y,
//!
//! ```text
//! w_i^H z_j = y_i^H [(lambda_i + lambda_j) M + C] x_j
//! ```
//!
//! is zero for two different modes of one value (biorthogonality). Between two values a and b it gives how the modes of
//! b are made of those of a: with `G_ab` for left states of a and right states of b,
//!
//! ```text
//! Z_b = Z_a T    T = G_aa^-1 G_ab
//! ```
//!
//! (`transfer`). So both problems are known in one basis, as `A_a = diag(lambda_a)` and `A_b = T diag(lambda_b) T^-1`,
//! and the straight line `A(s) = (1 - s) A_a + s A_b` between them is a small model of everything that lies in between;
//! it is exact where the problem depends on p linearly. The eigenvalues of A(s) are followed in steps small enough that
//! every vector is recognised (`homotopy`, `matching`): so crossings are distinguished from veerings, and couplings
//! between both ends are found without a solve. Doublets are followed as subspaces. What the model leaves open is
//! solved again ([`track`]): the step is halved where modes of b are not made of those of a, and growth rates that pass
//! zero are bracketed by solves to [`Options::tolerance`].
//!
//! At the edges of the band modes come and go. Solutions should therefore reach a little beyond the band: what comes
//! and goes there is not missed. The lower edge 0 is no different: conjugates of low modes are what is beyond it, and
//! two of them that meet become two real eigenvalues.

mod diagram;
mod homotopy;
mod hopf;
mod matching;
mod node;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod track;
mod transfer;

pub use diagram::{Branch, Diagram, Hopf, Partner, Point};
pub use track::track;

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::Result;
use crate::model::InstabilityCriterion;

/// An eigenproblem that depends on one parameter.
pub trait Family {
    /// The modes at one value.
    type Modes;

    /// Solves at a value, to the last digits that its vectors have.
    ///
    /// # Errors
    /// Those of the solution; tracking ends with them.
    fn solve(&mut self, value: f64) -> Result<Self::Modes>;

    /// Eigenvalues (1/s), those of the band and some beyond both of its edges.
    fn eigenvalues<'m>(&self, modes: &'m Self::Modes) -> &'m [Complex64];

    /// `G_ij = y_i^H [(lambda_i + lambda_j) M + C] x_j`, left vectors of one value against right vectors of another or
    /// the same; M and C are those of the left vectors' value. All vectors are scaled to `x^H M x = y^H M y = 1`, in
    /// modulus.
    ///
    /// # Errors
    /// Those of the products.
    fn products(&mut self, left: &Self::Modes, right: &Self::Modes) -> Result<DMatrix<Complex64>>;
}

/// How modes are followed.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Band of angular frequencies (rad/s) in which no mode may be lost.
    pub band: [f64; 2],
    /// Hopf points are bracketed this closely, and no step is halved below it; in units of the parameter.
    pub tolerance: f64,
    /// What counts as unstable.
    pub criterion: InstabilityCriterion,
    /// Real eigenvalues up to this are rigid-body motions and no divergence, 1/s.
    pub rigid: f64,
}

impl Options {
    /// Growth rate above that from which an eigenvalue is unstable, 1/s.
    fn excess(&self, lambda: Complex64) -> f64 {
        lambda.re - self.criterion.limit(lambda, self.rigid)
    }

    fn in_band(&self, lambda: Complex64) -> bool {
        (self.band[0]..=self.band[1]).contains(&lambda.im)
    }
}
