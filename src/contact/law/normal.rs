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
/// - table: `p = w P(d)`
pub(super) fn two_sided(point: &PointLaw, d: f64) -> Normal {
    let [pressure, slope] = point.normal_law.at(d);
    Normal { force: point.weight * pressure, stiffness: point.weight * slope }
}

impl PointLaw {
    /// Slope `dp/dd` of the normal law at the penetration d, N/m, whether or not the point is closed there.
    pub fn stiffness(&self, d: f64) -> f64 {
        two_sided(self, d).stiffness
    }

    /// The penetration (m) at which the law gives the normal force `p` (N): the root of `w P(d) = p`.
    pub fn penetration_under(&self, p: f64) -> f64 {
        if let NormalLaw::Table { rows } = &self.normal_law {
            return inverse(rows, p / self.weight);
        }
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

/// The penetration (m) at which a table has a pressure (Pa).
fn inverse(rows: &[[f64; 2]], pressure: f64) -> f64 {
    let above = rows.partition_point(|row| row[1] <= pressure).clamp(1, rows.len() - 1);
    let ([d0, p0], [d1, p1]) = (rows[above - 1], rows[above]);
    d0 + (pressure - p0) * (d1 - d0) / (p1 - p0)
}

/// The law as the point has it: none where it is open, that is where it may open and there is no pressure.
pub(super) fn normal(point: &PointLaw, d: f64) -> Option<Normal> {
    (d > point.normal_law.onset() || !point.separation).then(|| two_sided(point, d))
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
        // Linear between the rows and beyond them; open below the first.
        point.normal_law = NormalLaw::Table { rows: vec![[-0.1, 0.0], [0.1, 4.0], [0.2, 10.0]] };
        point.separation = true;
        assert_eq!(normal(&point, -0.1), None);
        for (d, force, stiffness) in [(0.0, 4.0, 40.0), (0.125, 11.0, 120.0), (0.3, 32.0, 120.0)] {
            let found = normal(&point, d).unwrap();
            assert!((found.force - force).abs() < 1e-13 && (found.stiffness - stiffness).abs() < 1e-12, "{found:?}");
        }
        point.separation = false;
        assert!((normal(&point, -0.3).unwrap().force + 8.0).abs() < 1e-13);
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
