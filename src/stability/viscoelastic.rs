//! Viscoelastic stiffnesses in the eigenproblem.
//!
//! ```text
//! P(lambda) = lambda^2 M + lambda C + K_0 + i G + sum_m (r_m(lambda) - rho_m) K_m      rho_m = Re r_m(i omega_0)
//! ```
//!
//! with the stiffnesses `K_m` at rest of the materials, and `K_0` the stiffness at a reference frequency `omega_0`, the
//! end of the band. That is what is factorised and counted: between 0 and `omega_0` each curve of eigenvalues of
//! `K(omega) - omega^2 M` crosses zero as often as those of `K_0 - omega^2 M` where the real parts of r rise, so that
//! the Sturm count at `omega_0` is the number of modes below.
//!
//! Modes begin with those of the *reference problem*, with `i Im r_m(i omega_0)` in the place of `r_m(lambda) - rho_m`
//! ([`super::nonlinear`]).

use num_complex::Complex64;

use crate::Result;
use crate::assembly::ViscoelasticStiffness;
use crate::native::Matrix;

/// What of a stiffness depends on the eigenvalue.
#[derive(Clone, Copy, Default)]
pub struct Viscoelastic<'a> {
    /// The laws and their stiffnesses at rest.
    pub stiffnesses: &'a [ViscoelasticStiffness],
    /// `omega_0`, rad/s: 0 for the stiffness at rest.
    pub reference: f64,
}

impl Viscoelastic<'_> {
    /// `r_m(lambda) - rho_m`
    pub fn coefficients(&self, lambda: Complex64) -> impl Iterator<Item = Complex64> {
        self.stiffnesses.iter().map(move |own| own.law.factor(lambda) - self.rho(own))
    }

    /// `dr_m / d lambda`
    pub fn slopes(&self, lambda: Complex64) -> impl Iterator<Item = Complex64> {
        self.stiffnesses.iter().map(move |own| own.law.slope(lambda))
    }

    /// `i Im r_m(i omega_0)`
    pub fn coefficients_at_reference(&self) -> impl Iterator<Item = Complex64> {
        let omega_0 = Complex64::new(0.0, self.reference);
        self.stiffnesses.iter().map(move |own| Complex64::new(0.0, own.law.factor(omega_0).im))
    }

    /// Makes a stiffness at rest that at the reference frequency: `K_0 = K + sum_m (rho_m - 1) K_m`. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn add_to(&self, k: &mut Matrix) -> Result<()> {
        self.stiffnesses.iter().try_for_each(|own| k.axpy(self.rho(own) - 1.0, &own.stiffness))
    }

    /// `rho_m`
    pub fn rho(&self, own: &ViscoelasticStiffness) -> f64 {
        own.law.factor(Complex64::new(0.0, self.reference)).re
    }
}
