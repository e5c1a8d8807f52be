//! What explains a mode: shares of its energy, energy input, dissipation, and sensitivities.
//!
//! With `m = x^H M x`, `c = x^H C x`, `k = x^H K x`, `g = x^H G x` the mode's equation gives
//! `lambda^2 m + lambda c + k + i g = 0`. M, C, G and the symmetric part of K give real numbers; the imaginary part of
//! k is friction's. So of the imaginary part of the equation, with `lambda = a + i omega`,
//!
//! ```text
//! 2 a omega m + omega c + Im k + g = 0        a = -Im k / (2 omega m) - c / (2 m) - g / (2 omega m)
//! ```
//!
//! which is the balance of power: with the modal energy `E = omega^2 m / 2`, the energy input by friction is
//! `-omega Im k / 2`, the dissipation by damping `omega^2 c / 2 + omega g / 2`, and what remains is `2 a E`. Both sums
//! go over parts, connectors and contact pairs, so that the growth rate is a sum over them, too. Gyroscopic terms make
//! c complex and do no work: `a Im c` joins the first term, so that `2 m + Im c / omega` is in the place of `2 m`.

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
    /// Dissipation by damping and loss factors, as a contribution to the growth rate, 1/s: not positive.
    #[serde(rename = "dissipation_per_s")]
    pub dissipation: f64,
}

/// The shares of all sources in a mode with eigenvalue `lambda`, from their forms with `y = x`. Their `energy_input`
/// and `dissipation` add up to the growth rate. For a real eigenvalue, which has no cycle, `energy_input` is 0, and
/// loss factors dissipate nothing.
pub fn shares(lambda: Complex64, forms: &[Forms]) -> Vec<Share> {
    let m: f64 = forms.iter().map(|form| form.m.re).sum();
    let k: f64 = forms.iter().map(|form| form.k.re).sum();
    // Im(lambda c) = omega Re c + a Im c, the second of gyroscopic terms.
    let gyroscopic: f64 = forms.iter().map(|form| form.c.im).sum();
    let size = 2.0 * m + if lambda.im > 0.0 { gyroscopic / lambda.im } else { 0.0 };
    // What the imaginary part of a stiffness contributes to the growth rate.
    let imaginary = |k: f64| if lambda.im > 0.0 { -k / (lambda.im * size) } else { 0.0 };
    let share = |form: &Forms| Share {
        kinetic: form.m.re / m,
        strain: form.k.re / k,
        energy_input: imaginary(form.k.im),
        dissipation: -form.c.re / size + form.g.map_or(0.0, |g| imaginary(g.re)),
    };
    forms.iter().map(share).collect()
}

/// How an eigenvalue follows a source's matrices: `d lambda / d ln` of its mass, damping and stiffness, 1/s. Damping is
/// C and G alike.
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
        damping: -(lambda * form.c + form.g.map_or(Complex64::ZERO, |g| Complex64::I * g)) / self_product,
        stiffness: -form.k / self_product,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mass on a damper and a spring with a loss factor: `lambda^2 m + lambda c + k (1 + i g) = 0`.
    fn eigenvalue([m, c, k, g]: [f64; 4]) -> Complex64 {
        let [c, k] = [Complex64::from(c), k * Complex64::new(1.0, g)];
        // The principal root has a negative imaginary part here.
        (-c - (c * c - 4.0 * m * k).sqrt()) / (2.0 * m)
    }

    /// The forms of the vector 1.
    fn forms([m, c, k, g]: [f64; 4]) -> Forms {
        let [m, c, k, g] = [m, c, k, g * k].map(Complex64::from);
        Forms { m, c, k, g: Some(g) }
    }

    const OSCILLATOR: [f64; 4] = [2.0, 3.0, 5000.0, 0.1];

    #[test]
    fn damper_and_loss_factor_dissipate_all_that_a_mode_loses() {
        let (lambda, all) = (eigenvalue(OSCILLATOR), forms(OSCILLATOR));
        let share = shares(lambda, &[all])[0];
        assert!(lambda.im > 0.0 && (share.dissipation - lambda.re).abs() < 1e-11 && share.energy_input == 0.0);
        let without = shares(lambda, &[Forms { g: None, ..all }])[0].dissipation;
        let loss = share.dissipation - without;
        assert!((loss + 0.1 * 5000.0 / (2.0 * lambda.im * 2.0)).abs() < 1e-11, "{loss}");
    }

    /// Two masses of 2 kg on springs and dampers, coupled by a gyroscope: in circular motion `x = (1, +-i)` has
    /// `x^H C x = 2 c -+ 2 i g`.
    #[test]
    fn gyroscopic_terms_do_no_work() {
        let (m, c, k, g) = (2.0, 3.0, 5000.0, 40.0);
        for sense in [1.0, -1.0] {
            let coupled = Complex64::new(c, sense * g);
            let lambda = (-coupled + (coupled * coupled - 4.0 * m * k).sqrt()) / (2.0 * m);
            let lambda = if lambda.im > 0.0 { lambda } else { -coupled / m - lambda };
            let of = |c: Complex64, m: f64, k: f64| Forms { m: m.into(), c, k: k.into(), g: None };
            let damped = shares(
                lambda,
                &[of((2.0 * c).into(), 2.0 * m, 2.0 * k), of(Complex64::new(0.0, sense * 2.0 * g), 0.0, 0.0)],
            );
            assert!(lambda.im > 0.0 && (damped[0].dissipation - lambda.re).abs() < 1e-11, "{damped:?} {lambda}");
            assert_eq!(damped[1].dissipation, 0.0);
        }
    }

    #[test]
    fn sensitivities_are_the_derivatives_of_the_eigenvalue() {
        let (lambda, all) = (eigenvalue(OSCILLATOR), forms(OSCILLATOR));
        let found = sensitivity(lambda, &all, self_product(lambda, &[all]));
        let difference = |change: fn(f64, [f64; 4]) -> [f64; 4]| {
            const STEP: f64 = 1e-5;
            let [above, below] = [1.0 + STEP, 1.0 - STEP].map(|factor| eigenvalue(change(factor, OSCILLATOR)));
            (above - below) / (2.0 * STEP)
        };
        let mass = difference(|factor, [m, c, k, g]| [factor * m, c, k, g]);
        let damping = difference(|factor, [m, c, k, g]| [m, factor * c, k, factor * g]);
        // The damping unchanged: g k is that before.
        let stiffness = difference(|factor, [m, c, k, g]| [m, c, factor * k, g / factor]);
        for (found, exact) in [(found.mass, mass), (found.damping, damping), (found.stiffness, stiffness)] {
            assert!((found - exact).norm() < 1e-7 * lambda.norm(), "{found} {exact}");
        }
    }
}
