//! Imposed motion: how fast, and which way, a turning master slides along its slave.

use super::law::Tangential;
use crate::model::Rotation;
use nalgebra::Vector3;

/// Speeds below this fraction of the motion's own scale are rounding.
const STILL: f64 = 1e-9;

/// The tangential law at `x` (m) of a pair whose master turns, in the plane with the unit normal `n`: direction t and
/// speed of
///
/// `|v| t = (I - n n^T) v` with `v = omega x (x - through)`
///
/// or no friction where nothing moves, as on the axis. `size` is the length (m) that tells whether x lies on the axis.
pub fn sliding(master: &Rotation, x: [f64; 3], n: [f64; 3], size: f64) -> Tangential {
    let (x, n) = (Vector3::from(x), Vector3::from(n));
    let omega = master.speed * Vector3::from(master.axis);
    let v = omega.cross(&(x - Vector3::from(master.through)));
    let tangential = v - n.dot(&v) * n;
    let speed = tangential.norm();
    if speed > STILL * (v.norm() + size * omega.norm()) {
        Tangential::Sliding { direction: (tangential / speed).into(), speed }
    } else {
        Tangential::Frictionless
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Inertia, Place};

    const UP: [f64; 3] = [0.0, 0.0, 1.0];

    /// Direction and speed on a disc that turns about z at 5 rad/s.
    fn on_disc(through: [f64; 3], x: [f64; 3], n: [f64; 3]) -> Option<(Vector3<f64>, f64)> {
        let disc = Rotation {
            part: "disc".into(),
            axis: UP,
            through,
            speed: 5.0,
            inertia: Inertia::None,
            place: Place::default(),
        };
        match sliding(&disc, x, n, 1e-3) {
            Tangential::Sliding { direction, speed } => Some((direction.into(), speed)),
            _ => None,
        }
    }

    #[test]
    fn a_turning_master_drags_along_the_circle() {
        let (t, speed) = on_disc([0.0, 0.1, 0.3], [0.0, 0.2, 0.0], UP).unwrap();
        assert!((t + Vector3::x()).norm() < 1e-15);
        assert!((speed - 0.5).abs() < 1e-15);
    }

    #[test]
    fn the_direction_lies_in_the_tangent_plane() {
        let n = [0.6, 0.0, 0.8];
        let (t, speed) = on_disc([0.0; 3], [0.1, -0.1, 0.0], n).unwrap();
        assert!(t.dot(&Vector3::from(n)).abs() < 1e-15);
        assert!((t.norm() - 1.0).abs() < 1e-15);
        assert!(speed < 0.5 * 0.1 * 2.0_f64.sqrt() * 10.0);
    }

    #[test]
    fn nothing_slides_on_the_axis() {
        assert_eq!(on_disc([0.0; 3], [1e-17, 0.0, 0.02], UP), None);
    }
}
