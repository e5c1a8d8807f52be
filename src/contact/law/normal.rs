//! The normal laws: force by penetration.

use super::PointLaw;
use crate::model::NormalLaw;

/// Normal force and its derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Normal {
    /// p, N.
    pub force: f64,
    /// dp/dd, N/m.
    pub stiffness: f64,
}

/// The law on both sides of d = 0: pulls where d < 0.
///
/// - linear: `p = w k d`
/// - cubic: `p = w (k1 d + k3 d^3)`
pub(super) fn two_sided(point: &PointLaw, d: f64) -> Normal {
    let w = point.weight;
    match point.normal_law {
        NormalLaw::Linear { stiffness: k } => Normal { force: w * k * d, stiffness: w * k },
        NormalLaw::Cubic { k1, k3 } => {
            Normal { force: w * (k1 * d + k3 * d.powi(3)), stiffness: w * (k1 + 3.0 * k3 * d.powi(2)) }
        }
    }
}

impl PointLaw {
    /// Slope `dp/dd` of the normal law at the penetration d, N/m, whether or not the point is closed there.
    pub fn stiffness(&self, d: f64) -> f64 {
        two_sided(self, d).stiffness
    }

    /// The penetration (m) at which the law gives the normal force `p` (N): the root of `w (k_1 d + k_3 d^3) = p`.
    pub fn penetration_under(&self, p: f64) -> f64 {
        let mut d = p / self.stiffness(0.0);
        // |p(d)| grows ever faster with |d|, so that Newton comes down on the root from one side.
        for _ in 0..100 {
            let Normal { force, stiffness } = two_sided(self, d);
            let step = (force - p) / stiffness;
            d -= step;
            if step.abs() <= 4.0 * f64::EPSILON * d.abs() {
                break;
            }
        }
        d
    }
}

/// The law as the point has it: none where it is open, that is where it may open and `d <= 0`.
pub(super) fn normal(point: &PointLaw, d: f64) -> Option<Normal> {
    (d > 0.0 || !point.separation).then(|| two_sided(point, d))
}

#[cfg(test)]
mod tests {
    use super::super::testing::point;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn laws_have_their_closed_forms() {
        let mut point = PointLaw {
            weight: 2.0,
            normal: [0.0, 0.0, 1.0],
            gap: 0.0,
            correction: 0.0,
            touching: true,
            separation: true,
            normal_law: NormalLaw::Linear { stiffness: 3.0 },
            tangential: super::super::Tangential::Frictionless,
        };
        let linear = Normal { force: 3.0, stiffness: 6.0 };
        assert_eq!(normal(&point, 0.5), Some(linear));
        assert_eq!(normal(&point, -0.5), None);
        point.normal_law = NormalLaw::Cubic { k1: 3.0, k3: 4.0 };
        let cubic = Normal { force: 4.0, stiffness: 12.0 };
        assert_eq!(normal(&point, 0.5), Some(cubic));
        point.separation = false;
        assert_eq!(normal(&point, -0.5).unwrap().force, -4.0);
    }

    proptest! {
        #[test]
        fn stiffness_is_the_derivative_of_the_force(point in point(), d in -1.0..1.0) {
            let h = 1e-5;
            let difference = two_sided(&point, d + h).force - two_sided(&point, d - h).force;
            prop_assert!((difference / (2.0 * h) - two_sided(&point, d).stiffness).abs() < 1e-8);
        }

        #[test]
        fn the_penetration_under_a_force_gives_that_force(point in point(), p in -10.0..10.0) {
            let d = point.penetration_under(p);
            prop_assert!((two_sided(&point, d).force - p).abs() < 1e-13 * (1.0 + p.abs()));
        }
    }
}
