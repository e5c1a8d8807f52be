//! The laws linearised for stability: status frozen as it was at the equilibrium.

use super::friction::Friction;
use super::normal::two_sided;
use super::tangential::{frictionless, sliding, sticking};
use super::{PointLaw, Status, Tangential, rows};
use nalgebra::{Matrix3, Vector3};

/// Tangent D (N/m, by rows) of a point whose status is frozen, at the equilibrium's relative displacement `g`.
///
/// ```text
/// open                 D = 0
/// closed, sliding      D = p' (n + mu' t) n^T    mu' = d(mu p)/dp, mu of a constant law
/// closed, frictionless D = p' n n^T
/// closed, other        D = p' n n^T + w k_t P      also where the equilibrium slips
/// ```
pub fn linearise<'a>(
    point: &PointLaw,
    friction: impl Into<Friction<'a>>,
    g: [f64; 3],
    status: Status,
) -> [[f64; 3]; 3] {
    if status == Status::Open {
        return [[0.0; 3]; 3];
    }
    let normal = two_sided(point, point.penetration(g));
    let closed = match point.tangential {
        Tangential::Frictionless => frictionless(point, &normal),
        Tangential::Sliding { direction, speed } => {
            let coefficient = friction.into().at(speed, normal.force / point.weight);
            sliding(point, &normal, coefficient, &direction.into())
        }
        Tangential::StickSlip { stick } => sticking(point, &normal, stick, &g.into()),
    };
    closed.tangent
}

/// Block of the friction damping, N s/m, of a sliding point under the normal force p (N); zero for other points and
/// without pressure:
///
/// ```text
/// p [(mu/v) (I - n n^T - t t^T) + (dmu/dv) t t^T]
/// ```
///
/// A motion across the sliding direction turns the velocity, and friction with it, which dissipates energy. A motion
/// along it changes the speed v: where mu falls with v, that feeds energy into the motion.
pub fn friction_damping<'a>(point: &PointLaw, friction: impl Into<Friction<'a>>, normal_force: f64) -> [[f64; 3]; 3] {
    let Tangential::Sliding { direction, speed } = point.tangential else {
        return [[0.0; 3]; 3];
    };
    let (t, p) = (Vector3::from(direction), normal_force.max(0.0));
    let along = t * t.transpose();
    let across: Matrix3<f64> = point.tangent_plane() - along;
    let friction = friction.into().at(speed, p / point.weight);
    rows(friction.mu * p / speed * across + friction.by_speed * p * along)
}

#[cfg(test)]
mod tests {
    use super::super::respond;
    use super::super::testing::{displacement, distance, friction_law, point};
    use super::*;
    use proptest::prelude::*;

    /// `D v`.
    fn times(d: [[f64; 3]; 3], v: Vector3<f64>) -> Vector3<f64> {
        Matrix3::from(d).transpose() * v
    }

    proptest! {
        #[test]
        fn the_frozen_tangent_is_the_true_one_unless_a_point_slips_elastically(
            point in point(), mu in 0.0..1.0, law in friction_law(), g in displacement(),
        ) {
            let mu = Friction { value: mu, law: &law };
            let answer = respond(&point, mu, g);
            let frozen = linearise(&point, mu, g, answer.status);
            if matches!(point.tangential, Tangential::StickSlip { .. }) && answer.status == Status::Slip {
                let stuck = linearise(&point, mu, g, Status::Stick);
                prop_assert_eq!(frozen, stuck);
            } else {
                prop_assert_eq!(frozen, answer.tangent);
            }
        }

        #[test]
        fn constant_friction_damps_only_across_the_sliding_direction(
            point in point(), mu in 0.0..1.0, p in 0.0..5.0,
        ) {
            let c = friction_damping(&point, mu, p);
            let Tangential::Sliding { direction, speed } = point.tangential else {
                prop_assert_eq!(c, [[0.0; 3]; 3]);
                return Ok(());
            };
            let (n, t) = (point.n(), Vector3::from(direction));
            let across = n.cross(&t);
            let expected: Vector3<f64> = mu * p / speed * across;
            prop_assert!(distance(times(c, across).into(), expected.into()) < 1e-13);
            prop_assert!(times(c, n).norm() < 1e-13 && times(c, t).norm() < 1e-13);
            prop_assert_eq!(friction_damping(&point, mu, -p), [[0.0; 3]; 3]);
        }

        #[test]
        fn friction_damping_is_how_the_friction_force_follows_the_velocity(
            point in point(), mu in 0.1..1.0, p in 0.1..5.0, law in friction_law(), velocity in displacement(),
        ) {
            let friction = Friction { value: mu, law: &law };
            let Tangential::Sliding { direction, speed } = point.tangential else {
                return Ok(());
            };
            // f_t = mu(|w|) p w/|w| with w the master's velocity against the slave, v - P g'
            let v = speed * Vector3::from(direction);
            let force = |scale: f64| -> Vector3<f64> {
                let w: Vector3<f64> = v - scale * (point.tangent_plane() * Vector3::from(velocity));
                friction.at(w.norm(), p / point.weight).mu * p * w.normalize()
            };
            let h = 1e-5;
            let numerical = -(force(h) - force(-h)) / (2.0 * h);
            let exact = times(friction_damping(&point, friction, p), velocity.into());
            prop_assert!((numerical - exact).norm() < 1e-8);
        }
    }
}
