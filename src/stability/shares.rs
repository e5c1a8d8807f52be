//! What explains a mode: shares of its energy, energy input, dissipation, and sensitivities.
//!
//! With `m = x^H M x`, `c = x^H C x`, `k = x^H K x` the mode's equation gives `lambda^2 m + lambda c + k = 0`. M, C and
//! the symmetric part of K give real numbers; the imaginary part of k is friction's. So of the imaginary part of the
//! equation, with `lambda = a + i omega`,
//!
//! ```text
//! 2 a omega m + omega c + Im k = 0        a = -Im k / (2 omega m) - c / (2 m)
//! ```
//!
//! which is the balance of power: with the modal energy `E = omega^2 m / 2`, the energy input by friction is
//! `-omega Im k / 2`, the dissipation by damping `omega^2 c / 2`, and what remains is `2 a E`. Both sums go over parts,
//! connectors and contact pairs, so that the growth rate is a sum over them, too.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::forms::Forms;

/// What one part, connector or contact pair has in a mode.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Of the kinetic energy, `x^H M_p x / x^H M x`.
    #[serde(rename = "kinetic_share")]
    pub kinetic: f64,
    /// Of the strain energy, `Re x^H K_p x / Re x^H K x`.
    #[serde(rename = "strain_share")]
    pub strain: f64,
    /// Energy input by friction, as a contribution to the growth rate, 1/s; work over a cycle is `2 pi / omega * 2 E`
    /// times that.
    #[serde(rename = "energy_input_per_s")]
    pub energy_input: f64,
    /// Dissipation by damping, as a contribution to the growth rate, 1/s: not positive.
    #[serde(rename = "dissipation_per_s")]
    pub dissipation: f64,
}

/// The shares of all sources in a mode with eigenvalue `lambda`, from their forms with `y = x`. Their `energy_input`
/// and `dissipation` add up to the growth rate. For a real eigenvalue, which has no cycle, `energy_input` is 0.
pub fn shares(lambda: Complex64, forms: &[Forms]) -> Vec<Share> {
    let m: f64 = forms.iter().map(|form| form.m.re).sum();
    let k: f64 = forms.iter().map(|form| form.k.re).sum();
    let energy_input = |form: &Forms| if lambda.im > 0.0 { -form.k.im / (2.0 * lambda.im * m) } else { 0.0 };
    let share = |form: &Forms| Share {
        kinetic: form.m.re / m,
        strain: form.k.re / k,
        energy_input: energy_input(form),
        dissipation: -form.c.re / (2.0 * m),
    };
    forms.iter().map(share).collect()
}

/// How an eigenvalue follows a source's matrices: `d lambda / d ln` of its mass, damping and stiffness, 1/s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// To a factor on the mass.
    pub mass: Complex64,
    /// To a factor on the damping.
    pub damping: Complex64,
    /// To a factor on the stiffness, damping unchanged.
    pub stiffness: Complex64,
}

/// `y^H (2 lambda M + C) x`, from the forms of all sources with the left vector y.
pub fn self_product(lambda: Complex64, forms: &[Forms]) -> Complex64 {
    forms.iter().map(|form| 2.0 * lambda * form.m + form.c).sum()
}

/// Sensitivities of an eigenvalue to one source, `d lambda = -y^H dP x / y^H (2 lambda M + C) x`.
pub fn sensitivity(lambda: Complex64, form: &Forms, self_product: Complex64) -> Sensitivity {
    Sensitivity {
        mass: -lambda * lambda * form.m / self_product,
        damping: -lambda * form.c / self_product,
        stiffness: -form.k / self_product,
    }
}
