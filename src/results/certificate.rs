//! How well a super-element solves the full model's equations, as plain data.

use std::f64::consts::TAU;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::model::InstabilityCriterion;
use crate::stability::RIGID_RATE;

/// Equilibrium and modes of a super-element at a friction value, compared with the full model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// Friction coefficient of the swept pairs.
    pub friction: f64,
    /// Length of the equilibrium's error in energy, relative to the equilibrium.
    pub equilibrium_error: f64,
    /// By frequency.
    pub modes: Vec<CertifiedMode>,
}

/// A mode of a super-element.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CertifiedMode {
    /// Its eigenvalue, 1/s.
    pub lambda: Complex64,
    /// That of the full model, to first order, 1/s.
    pub corrected: Complex64,
    /// Backward error against the full model.
    pub backward_error: f64,
}

impl Certificate {
    /// The largest error of a frequency, relative.
    pub fn frequency_error(&self) -> f64 {
        let error = |mode: &CertifiedMode| (mode.corrected.im / mode.lambda.im - 1.0).abs();
        self.modes.iter().filter(|mode| mode.lambda.im > 0.0).map(error).fold(0.0, f64::max)
    }

    /// The largest error of a growth rate, 1/s.
    pub fn growth_error(&self) -> f64 {
        self.modes.iter().map(|mode| (mode.corrected.re - mode.lambda.re).abs()).fold(0.0, f64::max)
    }

    /// The largest backward error.
    pub fn backward_error(&self) -> f64 {
        self.modes.iter().map(|mode| mode.backward_error).fold(0.0, f64::max)
    }

    /// For people: one line, with the modes that are unstable by a criterion or become stable or unstable by the
    /// correction.
    pub fn text(&self, criterion: InstabilityCriterion) -> String {
        let is_unstable = |z: Complex64| z.re > criterion.limit(z, RIGID_RATE);
        let mode = |mode: &CertifiedMode| {
            let [before, after] = [mode.lambda, mode.corrected];
            let verdict = if is_unstable(before) == is_unstable(after) { "" } else { ", not so in the full model" };
            format!("{:.1} Hz ({:+.1} /s, corrected {:+.1} /s{verdict})", before.im / TAU, before.re, after.re)
        };
        let shown: Vec<String> =
            self.modes.iter().filter(|m| is_unstable(m.lambda) || is_unstable(m.corrected)).map(mode).collect();
        let shown = if shown.is_empty() { "none".to_owned() } else { shown.join(", ") };
        format!(
            "   {:.4} {:6}   {:9.1e} {:11.5} {:12.2}    {:9.1e}   {shown}",
            self.friction,
            self.modes.len(),
            self.equilibrium_error,
            100.0 * self.frequency_error(),
            self.growth_error(),
            self.backward_error(),
        )
    }

    /// The lines above those of [`Certificate::text`].
    pub const HEAD: &'static str = "\
         friction  modes equilibrium  frequency  growth rate     backward   unstable modes: growth rate\n\
         \x20                     error   error, %   error, 1/s        error\n";
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(lambda: [f64; 2], corrected: [f64; 2], backward_error: f64) -> CertifiedMode {
        let [lambda, corrected] = [lambda, corrected].map(|[re, im]| Complex64::new(re, im));
        CertifiedMode { lambda, corrected, backward_error }
    }

    #[test]
    fn errors_are_those_of_the_worst_mode() {
        let modes = vec![mode([1.0, 100.0], [-2.0, 101.0], 1e-7), mode([-5.0, 200.0], [-5.5, 200.5], 1e-6)];
        let certificate = Certificate { friction: 0.3, equilibrium_error: 1e-5, modes };
        assert!((certificate.frequency_error() - 0.01).abs() < 1e-12);
        assert_eq!((certificate.growth_error(), certificate.backward_error()), (3.0, 1e-6));
        let text = certificate.text(InstabilityCriterion::default());
        assert!(text.contains("15.9 Hz (+1.0 /s, corrected -2.0 /s, not so in the full model)"), "{text}");
        assert!(!text.contains("31.8 Hz"), "{text}");
    }
}
