//! Friction laws: the friction coefficient as a function of sliding speed and pressure.
//!
//! ```text
//! mu(v, q) = mu_0 phi(v, q)         v: sliding speed, m/s     q = p/w: pressure, Pa
//! ```
//!
//! `mu_0` is the friction value of the contact pair, which a sweep changes; `phi` is the pair's [`FrictionLaw`]. So a
//! friction value of 0 is a contact without friction under every law, and what is linear in mu stays linear in `mu_0`.
//! The speed is that of the imposed motion at the point; a pair that does not slide has v = 0.

use crate::model::friction::FrictionCurve;
use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::sync::Arc;

/// `phi(v, q)` and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionFactor {
    /// phi, at least 0.
    pub value: f64,
    /// `d phi/dv`, s/m: enters C with friction damping.
    pub by_speed: f64,
    /// `d phi/dq`, 1/Pa: enters K.
    pub by_pressure: f64,
}

/// A friction law of a user's own; see `examples/friction_law.rs`.
///
/// The contract, for all `v >= 0` and `q >= 0`:
///
/// - phi and its derivatives are finite, and `phi >= 0`;
/// - phi is continuous, and smooth but at a few places: Newton's method uses `d phi/dq`;
/// - the same arguments give the same values on every rank and at every call.
///
/// [`check_derivatives`] compares the derivatives with differences.
pub trait FrictionFunction: Debug + Send + Sync {
    /// `phi(v, q)` with its derivatives, at a sliding speed (m/s) and a pressure (Pa).
    fn factor(&self, speed: f64, pressure: f64) -> FrictionFactor;
}

/// How the friction coefficient of a pair depends on sliding speed and pressure.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub enum FrictionLaw {
    /// Not at all: `phi = 1`.
    #[default]
    Constant,
    /// As the model file has it.
    Curve(FrictionCurve),
    /// As a function of the user's own gives it.
    #[serde(skip)]
    User(Arc<dyn FrictionFunction>),
    /// As a function of the user's own gave it, which the file of a super-element does not contain. Acts as a constant;
    /// the assembly of a super-element refuses it.
    Missing,
}

impl FrictionLaw {
    /// The law of a user's own function.
    pub fn user(function: impl FrictionFunction + 'static) -> FrictionLaw {
        FrictionLaw::User(Arc::new(function))
    }

    /// The law as a file can contain it: without a user's own function.
    pub fn storable(&self) -> FrictionLaw {
        if let FrictionLaw::User(_) = self { FrictionLaw::Missing } else { self.clone() }
    }

    /// Whether the friction coefficient may change with the pressure.
    pub fn depends_on_pressure(&self) -> bool {
        match self {
            FrictionLaw::Constant => false,
            FrictionLaw::Curve(FrictionCurve::Decay(_) | FrictionCurve::Stribeck(_)) => false,
            FrictionLaw::Curve(FrictionCurve::Table(table)) => table.pressures.len() > 1,
            FrictionLaw::User(_) | FrictionLaw::Missing => true,
        }
    }
}

/// The friction of a pair: friction value and law.
#[derive(Debug, Clone, Copy)]
pub struct Friction<'a> {
    /// `mu_0`
    pub value: f64,
    /// `phi`
    pub law: &'a FrictionLaw,
}

impl From<f64> for Friction<'static> {
    /// A constant friction coefficient.
    fn from(value: f64) -> Self {
        Friction { value, law: &FrictionLaw::Constant }
    }
}

/// A friction coefficient with its derivatives.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Coefficient {
    /// mu.
    pub mu: f64,
    /// `d(mu p)/dp = mu + q dmu/dq`.
    pub slope: f64,
    /// `dmu/dv`, s/m.
    pub by_speed: f64,
}

impl Friction<'_> {
    /// mu at a sliding speed (m/s) and a pressure (Pa); tension counts as no pressure.
    pub(super) fn at(&self, speed: f64, pressure: f64) -> Coefficient {
        let pressure = pressure.max(0.0);
        let FrictionFactor { value, by_speed, by_pressure } = match self.law {
            FrictionLaw::Constant | FrictionLaw::Missing => {
                return Coefficient { mu: self.value, slope: self.value, by_speed: 0.0 };
            }
            FrictionLaw::Curve(curve) => curve.factor(speed, pressure),
            FrictionLaw::User(function) => function.factor(speed, pressure),
        };
        Coefficient {
            mu: self.value * value,
            slope: self.value * (value + pressure * by_pressure),
            by_speed: self.value * by_speed,
        }
    }
}

/// Largest difference between a derivative and its central difference, as a fraction of phi or of what the derivative
/// adds to it.
const DERIVATIVE_TOLERANCE: f64 = 1e-6;

/// Compares the derivatives of a friction function with central differences, at all pairs of some speeds (m/s) and
/// pressures (Pa), all of them above 0 and away from kinks of the function.
///
/// # Errors
/// [`Error::Input`] with the first derivative that is wrong, or value that is not finite or below 0.
pub fn check_derivatives(function: &dyn FrictionFunction, speeds: &[f64], pressures: &[f64]) -> Result<()> {
    // x dphi/dx = (phi(x + h x) - phi(x - h x)) / 2h
    const H: f64 = 1e-5;
    let difference = |phi: &dyn Fn(f64) -> FrictionFactor| (phi(1.0 + H).value - phi(1.0 - H).value) / (2.0 * H);
    for (&v, &q) in speeds.iter().flat_map(|v| pressures.iter().map(move |q| (v, q))) {
        let refuse = |what: String| Err(Error::input(format!("friction law: {what} at v = {v} m/s, q = {q} Pa")));
        let FrictionFactor { value, by_speed, by_pressure } = function.factor(v, q);
        if !(value.is_finite() && value >= 0.0) {
            return refuse(format!("phi = {value}, which must be finite and not below 0,"));
        }
        let by_v = ("v", v, by_speed, difference(&|x| function.factor(x * v, q)));
        let by_q = ("q", q, by_pressure, difference(&|x| function.factor(v, x * q)));
        for (name, x, derivative, numerical) in [by_v, by_q] {
            // False for NaN.
            let agrees = (x * derivative - numerical).abs() <= DERIVATIVE_TOLERANCE * value.max(numerical.abs());
            if !agrees {
                let numerical = numerical / x;
                return refuse(format!("dphi/d{name} = {derivative:e}, but differences of phi give {numerical:e},"));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::testing::Falling;
    use super::*;

    const SPEEDS: [f64; 3] = [0.01, 0.5, 3.0];
    const PRESSURES: [f64; 3] = [0.01, 1.0, 20.0];

    #[test]
    fn derivatives_are_those_of_the_value() {
        check_derivatives(&Falling, &SPEEDS, &PRESSURES).unwrap();
    }

    #[derive(Debug)]
    struct Wrong(FrictionFactor);

    impl FrictionFunction for Wrong {
        fn factor(&self, speed: f64, pressure: f64) -> FrictionFactor {
            let Wrong(error) = self;
            let FrictionFactor { value, by_speed, by_pressure } = Falling.factor(speed, pressure);
            FrictionFactor {
                value: value + error.value,
                by_speed: by_speed * (1.0 + error.by_speed),
                by_pressure: by_pressure * (1.0 + error.by_pressure),
            }
        }
    }

    #[test]
    fn wrong_derivatives_and_values_are_refused() {
        let right = FrictionFactor { value: 0.0, by_speed: 0.0, by_pressure: 0.0 };
        let said = |error| check_derivatives(&Wrong(error), &[0.5], &[1.0]).map_err(|error| error.to_string());
        assert_eq!(said(right), Ok(()));
        let starts = |error, text: &str| {
            let said = said(error).unwrap_err();
            assert!(said.starts_with(&format!("friction law: {text}")), "{said}");
        };
        starts(FrictionFactor { by_speed: 1e-3, ..right }, "dphi/dv");
        starts(FrictionFactor { by_pressure: f64::NAN, ..right }, "dphi/dq");
        starts(FrictionFactor { value: -9.0, ..right }, "phi = -");
    }
}
