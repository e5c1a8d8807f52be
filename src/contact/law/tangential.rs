//! The true laws: normal force with sliding, sticking or slipping in the tangent plane.

use super::friction::{Coefficient, Friction};
use super::normal::{Normal, normal};
use super::{PointLaw, Response, Status, rows};
use nalgebra::{Matrix3, Vector3};

/// What acts in the tangent plane of a closed point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tangential {
    /// Nothing.
    Frictionless,
    /// The master slides along for ever and drags the slave with `mu p t`.
    Sliding {
        /// Unit vector t of the master's velocity against the slave in the tangent plane.
        direction: [f64; 3],
        /// |v| of that velocity, m/s.
        speed: f64,
    },
    /// Elastic stick `-w k_t g_t` up to `mu p`.
    StickSlip {
        /// k_t, N/m3.
        stick: f64,
    },
}

/// Force and tangent of a point by its true law; `friction` is that of its pair, or a constant mu.
///
/// With `P = I - n n^T`, `g_t = P g`, `p' = dp/dd` and `mu' = d(mu p)/dp = mu + p dmu/dp`, which is mu where that is
/// constant:
///
/// ```text
/// open         f = 0                                  D = 0
/// frictionless f = p n                                D = p' n n^T
/// sliding      f = p n + mu p t                       D = p' (n + mu' t) n^T
/// stick        f = p n - w k_t g_t                    D = p' n n^T + w k_t P
/// slip         f = p n + mu p s,  s = -g_t/|g_t|      D = p' (n + mu' s) n^T + (mu p/|g_t|) (P - s s^T)
/// ```
///
/// A stick-slip point sticks while `w k_t |g_t| <= mu p`. Where p <= 0 (a point that may not open, in tension) the
/// bound is zero: it slips without a tangential force. A sliding point keeps `mu p t` in tension too, so that a
/// pair that may neither open nor stick is linear. Point forces are continuous everywhere; D jumps where the status
/// changes.
pub fn respond<'a>(point: &PointLaw, friction: impl Into<Friction<'a>>, g: [f64; 3]) -> Response {
    match normal(point, point.penetration(g)) {
        None => Response::OPEN,
        Some(normal) => closed(point, friction.into(), &normal, &g.into()),
    }
}

/// The response of a closed point.
fn closed(point: &PointLaw, friction: Friction, normal: &Normal, g: &Vector3<f64>) -> Response {
    let at = |speed: f64| friction.at(speed, normal.force / point.weight);
    match point.tangential {
        Tangential::Frictionless => frictionless(point, normal),
        Tangential::Sliding { direction, speed } => sliding(point, normal, at(speed), &direction.into()),
        Tangential::StickSlip { stick } => {
            let g_t = point.tangent_plane() * g;
            let coefficient = at(0.0);
            let bound = coefficient.mu * normal.force.max(0.0);
            if bound <= 0.0 {
                frictionless(point, normal)
            } else if point.weight * stick * g_t.norm() <= bound {
                sticking(point, normal, stick, g)
            } else {
                slipping(point, normal, coefficient, &g_t)
            }
        }
    }
}

/// `f = p n`, `D = p' n n^T`.
pub(super) fn frictionless(point: &PointLaw, normal: &Normal) -> Response {
    sliding(point, normal, Coefficient::default(), &Vector3::zeros())
}

/// `f = p (n + mu t)`, `D = p' (n + mu' t) n^T`.
pub(super) fn sliding(point: &PointLaw, normal: &Normal, friction: Coefficient, t: &Vector3<f64>) -> Response {
    dragged(point, normal, friction, t, Matrix3::zeros())
}

/// `f = p (n + mu s)`, `D = p' (n + mu' s) n^T + (mu p/|g_t|) (P - s s^T)`, with `s = -g_t/|g_t|`.
fn slipping(point: &PointLaw, normal: &Normal, friction: Coefficient, g_t: &Vector3<f64>) -> Response {
    let s = -g_t.normalize();
    let turning = friction.mu * normal.force / g_t.norm() * (point.tangent_plane() - s * s.transpose());
    dragged(point, normal, friction, &s, turning)
}

/// Full friction along `s`; `turning` is what the change of direction adds to the tangent.
fn dragged(
    point: &PointLaw,
    normal: &Normal,
    friction: Coefficient,
    s: &Vector3<f64>,
    turning: Matrix3<f64>,
) -> Response {
    let n = point.n();
    Response {
        force: (normal.force * (n + friction.mu * s)).into(),
        tangent: rows(normal.stiffness * (n + friction.slope * s) * n.transpose() + turning),
        normal_force: normal.force,
        status: Status::Slip,
    }
}

/// `f = p n - w k_t g_t`, `D = p' n n^T + w k_t P`.
pub(super) fn sticking(point: &PointLaw, normal: &Normal, stick: f64, g: &Vector3<f64>) -> Response {
    let n = point.n();
    let elastic = point.weight * stick * point.tangent_plane();
    Response {
        force: (normal.force * n - elastic * g).into(),
        tangent: rows(normal.stiffness * n * n.transpose() + elastic),
        normal_force: normal.force,
        status: Status::Stick,
    }
}

#[cfg(test)]
mod tests {
    use super::super::friction::FrictionLaw;
    use super::super::normal::two_sided;
    use super::super::testing::{
        SLIDING, at_penetration, displacement, distance, friction_law, point, point_with, stick_slip, tangent_error,
    };
    use super::*;
    use proptest::prelude::*;

    /// `mu p`, N, of a point that does not slide, at the penetration `d`.
    fn bound(point: &PointLaw, friction: Friction, d: f64) -> f64 {
        let p = two_sided(point, d).force;
        friction.at(0.0, p / point.weight).mu * p
    }

    /// Distances from the two kinks, opening and the onset of slip: `|d|` and `| w k_t |g_t| - mu p |`.
    fn kinks(point: &PointLaw, friction: Friction, g: [f64; 3]) -> [f64; 2] {
        let d = point.penetration(g);
        let Tangential::StickSlip { stick } = point.tangential else {
            return [d.abs(), f64::INFINITY];
        };
        let g_t = (point.tangent_plane() * Vector3::from(g)).norm();
        [d.abs(), (point.weight * stick * g_t - bound(point, friction, d)).abs()]
    }

    /// `g` changed to the penetration `d` and, in the tangent plane, to a trial force of `ratio` times the bound.
    fn at_ratio(point: &PointLaw, friction: Friction, g: [f64; 3], d: f64, ratio: f64) -> [f64; 3] {
        let Tangential::StickSlip { stick } = point.tangential else {
            panic!("a stick-slip point is wanted");
        };
        let g = Vector3::from(at_penetration(point, g, d));
        let g_t = point.tangent_plane() * g;
        let limit = ratio * bound(point, friction, d) / (point.weight * stick);
        (g - g_t + limit * g_t.normalize()).into()
    }

    /// Points of every law whose tangential force has a bound.
    fn bounded() -> impl Strategy<Value = PointLaw> {
        let free = Just(Tangential::Frictionless);
        prop_oneof![free, Just(SLIDING), stick_slip()].prop_flat_map(point_with)
    }

    proptest! {
        #[test]
        fn tangents_are_derivatives_of_the_force(
            point in point(), mu in 0.0..1.0, law in friction_law(), g in displacement(),
        ) {
            let (h, mu) = (1e-6, Friction { value: mu, law: &law });
            prop_assume!(kinks(&point, mu, g).into_iter().all(|k| k > 1e-4));
            let g_t = (point.tangent_plane() * Vector3::from(g)).norm();
            prop_assume!(g_t > 1e-2);
            prop_assert!(tangent_error(|g| respond(&point, mu, g), g, h) < 1e-6);
        }

        #[test]
        fn tangents_hold_on_both_sides_of_slip(
            point in stick_slip().prop_flat_map(point_with),
            mu in 0.1..1.0, law in friction_law(), g in displacement(), d in 0.1..1.0,
            side in prop::sample::select(vec![0.999, 1.001]),
        ) {
            let mu = Friction { value: mu, law: &law };
            let near = at_ratio(&point, mu, g, d, side);
            let expected = if side < 1.0 { Status::Stick } else { Status::Slip };
            prop_assert_eq!(respond(&point, mu, near).status, expected);
            prop_assert!(tangent_error(|g| respond(&point, mu, g), near, 1e-7) < 1e-5);
        }

        #[test]
        fn the_force_is_continuous_from_stick_to_slip(
            point in stick_slip().prop_flat_map(point_with),
            mu in 0.1..1.0, law in friction_law(), g in displacement(), d in 0.1..1.0,
        ) {
            let mu = Friction { value: mu, law: &law };
            let [stick, slip] = [1.0 - 1e-9, 1.0 + 1e-9]
                .map(|ratio| respond(&point, mu, at_ratio(&point, mu, g, d, ratio)));
            prop_assert_ne!(stick.status, slip.status);
            prop_assert!(distance(stick.force, slip.force) < 1e-7);
        }

        #[test]
        fn the_force_is_continuous_from_closed_to_open(
            mut point in bounded(), mu in 0.0..1.0, law in friction_law(), g in displacement(),
        ) {
            let mu = Friction { value: mu, law: &law };
            point.separation = true;
            let closed = respond(&point, mu, at_penetration(&point, g, 1e-9));
            let open = respond(&point, mu, at_penetration(&point, g, -1e-9));
            prop_assert_eq!(open, Response::OPEN);
            prop_assert_ne!(closed.status, Status::Open);
            prop_assert!(distance(closed.force, [0.0; 3]) < 1e-7);
        }

        #[test]
        fn friction_never_exceeds_its_bound(
            point in bounded(), mu in 0.0..1.0, g in displacement(),
        ) {
            let answer = respond(&point, mu, g);
            let f_t = point.tangent_plane() * Vector3::from(answer.force);
            prop_assert!(f_t.norm() <= mu * answer.normal_force.abs() + 1e-12);
            let along_n = point.n().dot(&Vector3::from(answer.force));
            prop_assert!((along_n - answer.normal_force).abs() < 1e-12);
        }

        #[test]
        fn a_point_that_may_not_open_ignores_its_gap_and_pulls(
            mut point in point(), mu in 0.0..1.0, g in displacement(), gap in -1.0..1.0,
        ) {
            point.separation = false;
            let answer = respond(&point, mu, g);
            point.gap = gap;
            prop_assert_eq!(answer, respond(&point, mu, g));
            prop_assert_ne!(answer.status, Status::Open);
            let opening = point.n().dot(&Vector3::from(g));
            prop_assert!(answer.normal_force * opening <= 0.0);
            if matches!(point.tangential, Tangential::StickSlip { .. }) && opening > 0.0 {
                prop_assert!((point.tangent_plane() * Vector3::from(answer.force)).norm() < 1e-14);
            }
        }
    }

    #[test]
    fn pressure_and_speed_enter_by_their_units() {
        let point = belt_point();
        let law = FrictionLaw::user(super::super::testing::Falling);
        // w = 1e-5 m2, p = 20 N, so q = 2e6 Pa; v = 0.5 m/s
        let answer = respond(&point, Friction { value: 0.4, law: &law }, [0.0, 0.0, 1e-7]);
        let mu = 0.4 / (1.5 * (1.0 + 2e6));
        assert!((answer.force[0] / (mu * answer.normal_force) - 1.0).abs() < 1e-12);
    }

    /// A point that slides along x at 0.5 m/s, pressed along -z.
    fn belt_point() -> PointLaw {
        PointLaw {
            weight: 1e-5,
            normal: [0.0, 0.0, -1.0],
            gap: 0.0,
            correction: 0.0,
            wear: 0.0,
            touching: true,
            separation: true,
            normal_law: crate::model::NormalLaw::Linear { stiffness: 2e13 },
            tangential: Tangential::Sliding { direction: [1.0, 0.0, 0.0], speed: 0.5 },
        }
    }

    #[test]
    fn sliding_drags_the_slave_along_the_master() {
        let point = belt_point();
        let answer = respond(&point, 0.4, [0.0, 0.0, 1e-7]);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
        assert!(close(answer.normal_force, 20.0));
        assert!(close(answer.force[0], 8.0) && close(answer.force[2], -20.0));
        assert!(close(answer.tangent[2][2], 2e8) && close(answer.tangent[0][2], -0.8e8));
        assert_eq!(answer.tangent[2][0], 0.0);
    }
}
