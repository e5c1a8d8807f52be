//! The laws linearised for stability: status frozen as it was at the equilibrium.

use super::normal::two_sided;
use super::tangential::{frictionless, sliding, sticking};
use super::{PointLaw, Status, Tangential, rows};
use nalgebra::{Matrix3, Vector3};

/// Tangent D (N/m, by rows) of a point whose status is frozen, at the equilibrium's relative displacement `g`.
///
/// ```text
/// open                 D = 0
/// closed, sliding      D = p' (n + mu t) n^T
/// closed, frictionless D = p' n n^T
/// closed, other        D = p' n n^T + w k_t P      also where the equilibrium slips
/// ```
pub fn linearise(point: &PointLaw, friction: f64, g: [f64; 3], status: Status) -> [[f64; 3]; 3] {
    if status == Status::Open {
        return [[0.0; 3]; 3];
    }
    let normal = two_sided(point, point.penetration(g));
    let closed = match point.tangential {
        Tangential::Frictionless => frictionless(point, &normal),
        Tangential::Sliding { direction, .. } => sliding(point, &normal, friction, &direction.into()),
        Tangential::StickSlip { stick } => sticking(point, &normal, stick, &g.into()),
    };
    closed.tangent
}

/// Block of the friction damping, `(mu p/|v|) (I - n n^T - t t^T)`, N s/m, of a sliding point under the normal force p
/// (N); zero for other points and without pressure.
///
/// A motion across the sliding direction turns the velocity, and friction with it; what that takes out of the motion is
/// linear in its velocity.
pub fn friction_damping(point: &PointLaw, friction: f64, normal_force: f64) -> [[f64; 3]; 3] {
    let Tangential::Sliding { direction, speed } = point.tangential else {
        return [[0.0; 3]; 3];
    };
    let t = Vector3::from(direction);
    let across: Matrix3<f64> = point.tangent_plane() - t * t.transpose();
    rows(friction * normal_force.max(0.0) / speed * across)
}

#[cfg(test)]
mod tests {
    use super::super::respond;
    use super::super::testing::{displacement, distance, point};
    use super::*;
    use proptest::prelude::*;

    /// `D v`.
    fn times(d: [[f64; 3]; 3], v: Vector3<f64>) -> Vector3<f64> {
        Matrix3::from(d).transpose() * v
    }

    proptest! {
        #[test]
        fn the_frozen_tangent_is_the_true_one_unless_a_point_slips_elastically(
            point in point(), mu in 0.0..1.0, g in displacement(),
        ) {
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
        fn friction_damps_only_across_the_sliding_direction(
            point in point(), mu in 0.0..1.0, p in 0.0..5.0,
        ) {
            let c = friction_damping(&point, mu, p);
            let Tangential::Sliding { direction, speed } = point.tangential else {
                prop_assert_eq!(c, [[0.0; 3]; 3]);
                return Ok(());
            };
            let (n, t) = (point.n(), Vector3::from(direction));
            let across = n.cross(&t);
            let expected = mu * p / speed * across;
            prop_assert!(distance(times(c, across).into(), expected.into()) < 1e-13);
            prop_assert!(times(c, n).norm() < 1e-13 && times(c, t).norm() < 1e-13);
            prop_assert_eq!(friction_damping(&point, mu, -p), [[0.0; 3]; 3]);
        }

        #[test]
        fn friction_damping_is_how_the_friction_force_turns(
            point in point(), mu in 0.1..1.0, p in 0.1..5.0, velocity in displacement(),
        ) {
            let Tangential::Sliding { direction, speed } = point.tangential else {
                return Ok(());
            };
            // f_t = mu p w/|w| with w the master's velocity against the slave, v - P g'
            let v = speed * Vector3::from(direction);
            let force = |scale: f64| -> Vector3<f64> {
                let w: Vector3<f64> = v - scale * (point.tangent_plane() * Vector3::from(velocity));
                mu * p * w.normalize()
            };
            let h = 1e-5;
            let numerical = -(force(h) - force(-h)) / (2.0 * h);
            let exact = times(friction_damping(&point, mu, p), velocity.into());
            prop_assert!((numerical - exact).norm() < 1e-8);
        }
    }
}
