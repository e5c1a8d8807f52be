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
///
/// In a step of wear, whose depth `c P` grows with the pressure, the law acts on what is left of the penetration:
///
/// ```text
/// e + c P(e) = d      p = w P(e)      dp/dd = w P' / (1 + c P')
/// ```
pub(super) fn two_sided(point: &PointLaw, d: f64) -> Normal {
    let c = point.wear;
    let [pressure, slope] = point.normal_law.at(if c == 0.0 { d } else { unworn(&point.normal_law, c, d) });
    Normal { force: point.weight * pressure, stiffness: point.weight * slope / (1.0 + c * slope) }
}

/// The penetration e (m) that is left of d (m) beside the wear `c P(e)`.
fn unworn(law: &NormalLaw, c: f64, d: f64) -> f64 {
    match *law {
        NormalLaw::Linear { stiffness } => d / (1.0 + c * stiffness),
        NormalLaw::Cubic { k1, .. } => {
            let residual = |e: f64| {
                let [pressure, slope] = law.at(e);
                [e + c * pressure - d, 1.0 + c * slope]
            };
            root(d / (1.0 + c * k1), residual)
        }
        NormalLaw::Table { ref rows } => {
            let worn = |row: &[f64; 2]| row[0] + c * row[1];
            let above = rows.partition_point(|row| worn(row) <= d).clamp(1, rows.len() - 1);
            let (low, high) = (&rows[above - 1], &rows[above]);
            low[0] + (d - worn(low)) * (high[0] - low[0]) / (worn(high) - worn(low))
        }
    }
}

/// The root of an odd function whose slope rises with the distance from 0, by Newton's method from beyond the root.
fn root(start: f64, residual_and_slope: impl Fn(f64) -> [f64; 2]) -> f64 {
    let mut x = start;
    for _ in 0..100 {
        let [residual, slope] = residual_and_slope(x);
        let step = residual / slope;
        x -= step;
        if step.abs() <= 4.0 * f64::EPSILON * x.abs() {
            break;
        }
    }
    x
}

impl PointLaw {
    /// Slope `dp/dd` of the normal law at the penetration d, N/m, whether or not the point is closed there.
    pub fn stiffness(&self, d: f64) -> f64 {
        two_sided(self, d).stiffness
    }

    /// The penetration (m) at which the law gives the normal force `p` (N): the root of `w P(e) = p`, and the wear
    /// `c P(e)` beside it.
    pub fn penetration_under(&self, p: f64) -> f64 {
        let (law, pressure) = (&self.normal_law, p / self.weight);
        let unworn = match law {
            NormalLaw::Linear { stiffness } => pressure / stiffness,
            NormalLaw::Cubic { k1, .. } => root(pressure / k1, |e| {
                let [own, slope] = law.at(e);
                [own - pressure, slope]
            }),
            NormalLaw::Table { rows } => inverse(rows, pressure),
        };
        unworn + self.wear * pressure
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

    fn plain() -> PointLaw {
        PointLaw {
            weight: 2.0,
            normal: [0.0, 0.0, 1.0],
            gap: 0.0,
            correction: 0.0,
            wear: 0.0,
            touching: true,
            separation: true,
            normal_law: NormalLaw::Linear { stiffness: 3.0 },
            tangential: super::super::Tangential::Frictionless,
        }
    }

    #[test]
    fn laws_have_their_closed_forms() {
        let mut point = plain();
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

    #[test]
    fn a_step_of_wear_leaves_the_law_what_is_not_worn_off() {
        // 5 (k e, k1 e + k3 e^3 or a table at e) = 5 p, and d = e + 0.25 p
        let table = NormalLaw::Table { rows: vec![[0.1, 0.0], [0.3, 4.0], [0.4, 16.0]] };
        let cubic = NormalLaw::Cubic { k1: 2.0, k3: 3.0 };
        for law in [NormalLaw::Linear { stiffness: 7.0 }, cubic, table] {
            for e in [-0.4, 0.2, 0.35, 2.0] {
                let [pressure, slope] = law.at(e);
                let d = e + 0.25 * pressure;
                let worn = PointLaw { weight: 5.0, wear: 0.25, normal_law: law.clone(), ..plain() };
                let found = two_sided(&worn, d);
                assert!((found.force - 5.0 * pressure).abs() < 1e-12 * (1.0 + pressure.abs()), "{law:?} at {e}");
                let expected = 5.0 * slope / (1.0 + 0.25 * slope);
                assert!((found.stiffness - expected).abs() < 1e-11 * expected, "{law:?} at {e}");
            }
        }
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
