//! The friction laws of model files as functions of sliding speed and pressure, with their derivatives.

use super::friction::{FrictionFactor, FrictionFunction};
use crate::model::GridInterval;
use crate::model::friction::{FrictionCurve, FrictionTable, SpeedDecay, Stribeck};

impl FrictionFunction for FrictionCurve {
    fn factor(&self, speed: f64, pressure: f64) -> FrictionFactor {
        match self {
            FrictionCurve::Decay(decay) => decay.factor(speed, pressure),
            FrictionCurve::Stribeck(stribeck) => stribeck.factor(speed, pressure),
            FrictionCurve::Table(table) => table.factor(speed, pressure),
        }
    }
}

impl FrictionFunction for SpeedDecay {
    /// `phi = r + (1 - r) exp(-d v)`.
    fn factor(&self, speed: f64, _: f64) -> FrictionFactor {
        let falling = (1.0 - self.kinetic_ratio) * (-self.decay * speed).exp();
        FrictionFactor { value: self.kinetic_ratio + falling, by_speed: -self.decay * falling, by_pressure: 0.0 }
    }
}

impl FrictionFunction for Stribeck {
    /// With `s = v / v_s`: `phi = r + (1 - r) exp(-s^delta) + b v`,
    /// `dphi/dv = -(1 - r) delta/v_s s^(delta - 1) exp(-s^delta) + b`.
    fn factor(&self, speed: f64, _: f64) -> FrictionFactor {
        let s = speed / self.speed;
        let falling = (1.0 - self.kinetic_ratio) * (-s.powf(self.exponent)).exp();
        let slope = self.exponent / self.speed * s.powf(self.exponent - 1.0);
        FrictionFactor {
            value: self.kinetic_ratio + falling + self.viscous * speed,
            by_speed: self.viscous - slope * falling,
            by_pressure: 0.0,
        }
    }
}

impl FrictionFunction for FrictionTable {
    /// With a and b the fractions of the way between the neighbours of v and q in the grid,
    /// `phi = (1 - a) ((1 - b) phi_00 + b phi_01) + a ((1 - b) phi_10 + b phi_11)`. Where a slope jumps it is that of
    /// the greater argument; beyond the grid it is 0.
    fn factor(&self, speed: f64, pressure: f64) -> FrictionFactor {
        let (at_speed, at_pressure) =
            (GridInterval::around(&self.speeds, speed), GridInterval::around(&self.pressures, pressure));
        let phi = |i: usize, j: usize| self.values[i * self.pressures.len() + j];
        let along = |i: usize| at_pressure.between(phi(i, at_pressure.lower), phi(i, at_pressure.upper));
        let across = |j: usize| at_speed.between(phi(at_speed.lower, j), phi(at_speed.upper, j));
        FrictionFactor {
            value: at_speed.between(along(at_speed.lower), along(at_speed.upper)),
            by_speed: at_speed.slope(along(at_speed.lower), along(at_speed.upper)),
            by_pressure: at_pressure.slope(across(at_pressure.lower), across(at_pressure.upper)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::friction::{Friction, FrictionLaw, check_derivatives};
    use super::*;

    const SPEEDS: [f64; 4] = [0.01, 0.5, 1.5, 3.0];
    const PRESSURES: [f64; 3] = [0.01, 1.5, 20.0];

    const STRIBECK: Stribeck = Stribeck { kinetic_ratio: 0.6, speed: 0.4, exponent: 1.5, viscous: 0.05 };

    fn table() -> FrictionTable {
        FrictionTable {
            speeds: vec![0.0, 1.0, 2.0],
            pressures: vec![1.0, 3.0],
            values: vec![1.0, 0.9, 0.8, 0.75, 0.7, 0.6],
        }
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        let decay = SpeedDecay { kinetic_ratio: 0.6, decay: 0.5 };
        for curve in [FrictionCurve::Decay(decay), FrictionCurve::Stribeck(STRIBECK), FrictionCurve::Table(table())] {
            check_derivatives(&curve, &SPEEDS, &PRESSURES).unwrap();
        }
    }

    #[test]
    fn a_decay_goes_from_the_static_to_the_kinetic_coefficient() {
        let law = FrictionLaw::Curve(FrictionCurve::Decay(SpeedDecay { kinetic_ratio: 0.75, decay: 2.0 }));
        let friction = Friction { value: 0.6, law: &law };
        assert!((friction.at(0.0, 1e6).mu - 0.6).abs() < 1e-15);
        assert!((friction.at(100.0, 1e6).mu - 0.45).abs() < 1e-15);
        // mu = 0.45 + 0.15 exp(-2 v), dmu/dv = -0.3 exp(-2 v)
        let half = friction.at(0.5, 1e6);
        assert!((half.mu - 0.45 - 0.15 * (-1.0f64).exp()).abs() < 1e-15);
        assert!((half.by_speed + 0.3 * (-1.0f64).exp()).abs() < 1e-15);
    }

    #[test]
    fn stribecks_curve_begins_at_one_falls_and_rises() {
        assert_eq!(STRIBECK.factor(0.0, 0.0).value, 1.0);
        assert!(STRIBECK.factor(0.1, 0.0).by_speed < 0.0);
        let far = STRIBECK.factor(20.0, 0.0);
        assert!((far.value - 1.6).abs() < 1e-12 && (far.by_speed - 0.05).abs() < 1e-12);
        // s = 1: phi = 0.6 + 0.4/e + 0.02, dphi/dv = 0.05 - 1.5/0.4 0.4/e
        let at_one = STRIBECK.factor(0.4, 0.0);
        let e = std::f64::consts::E;
        assert!((at_one.value - 0.62 - 0.4 / e).abs() < 1e-15 && (at_one.by_speed - 0.05 + 1.5 / e).abs() < 1e-14);
    }

    #[test]
    fn a_table_has_its_values_at_the_grid_and_keeps_them_beyond() {
        let table = table();
        let at = |v: f64, q: f64| table.factor(v, q);
        for (i, &v) in table.speeds.iter().enumerate() {
            for (j, &q) in table.pressures.iter().enumerate() {
                assert_eq!(at(v, q).value, table.values[2 * i + j]);
            }
        }
        // Means of 1, 0.9, 0.8 and 0.75; slopes (0.775 - 0.95) / 1 and (0.825 - 0.9) / 2.
        let middle = at(0.5, 2.0);
        let all = [middle.value - 0.8625, middle.by_speed + 0.175, middle.by_pressure + 0.0375];
        assert!(all.iter().all(|x| x.abs() < 1e-15), "{all:?}");
        assert_eq!(at(9.0, 0.5), FrictionFactor { value: 0.7, by_speed: 0.0, by_pressure: 0.0 });
        assert_eq!(at(-1.0, 9.0), FrictionFactor { value: 0.9, by_speed: 0.0, by_pressure: 0.0 });
        // At a kink the slope is that of the greater argument.
        assert!((at(1.0, 1.0).by_speed + 0.1).abs() < 1e-15);
    }
}
