//! The law while the brake is brought together.
//!
//! At u = 0 there is no pressure, so no Coulomb bound, and pads would be loose. The first steps therefore let every
//! point that touches hold its partner like a spring in both directions; the true laws take over from where that ends.

use super::normal::{Normal, two_sided};
use super::tangential::{frictionless, sticking};
use super::{PointLaw, Response, Tangential};

/// Force and tangent of a point while the brake settles.
///
/// A point that may open and does not touch is open. All others are closed in both directions: sliding points
/// without friction, stick-slip points with `-w k_t g_t` whatever the pressure.
pub fn settle(point: &PointLaw, g: [f64; 3]) -> Response {
    if point.separation && !point.touching {
        return Response::OPEN;
    }
    let normal: Normal = two_sided(point, point.penetration(g));
    match point.tangential {
        Tangential::Frictionless | Tangential::Sliding { .. } => frictionless(point, &normal),
        Tangential::StickSlip { stick } => sticking(point, &normal, stick, &g.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{SLIDING, at_penetration, displacement, point, point_with, tangent_error};
    use super::super::{Status, respond};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn tangents_are_derivatives_of_the_force(point in point(), g in displacement()) {
            prop_assert!(tangent_error(|g| settle(&point, g), g, 1e-6) < 1e-8);
        }

        #[test]
        fn only_points_that_touch_or_may_not_open_hold(point in point(), g in displacement()) {
            let answer = settle(&point, g);
            let holds = point.touching || !point.separation;
            prop_assert_eq!(answer.status != Status::Open, holds);
            // Nothing that holds is loose in the direction of the normal.
            let n = point.n();
            let along = n.dot(&(nalgebra::Matrix3::from(answer.tangent).transpose() * n));
            prop_assert_eq!(along > 0.0, holds);
        }

        #[test]
        fn a_closed_sliding_point_settles_as_it_acts_without_friction(
            mut point in point_with(SLIDING), g in displacement(), d in 0.01..1.0,
        ) {
            point.touching = true;
            let g = at_penetration(&point, g, d);
            prop_assert_eq!(settle(&point, g), respond(&point, 0.0, g));
        }
    }
}
