//! Imposed motion: how fast, and which way, a master slides along its slave.

use crate::model::Model;
use nalgebra::Vector3;

/// Speeds below this fraction of the motion's own scale are rounding.
const STILL: f64 = 1e-9;

/// The velocity field of one part: the sum of the rotations imposed on it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
    /// Angular velocity omega (rad/s) and a point of the axis (m) of each rotation.
    rotations: Vec<(Vector3<f64>, Vector3<f64>)>,
}

impl Motion {
    /// The motion that the model imposes on a part.
    pub fn of(model: &Model, part: &str) -> Self {
        let own = model.rotations.iter().filter(|r| r.part == part);
        let rotations = own.map(|r| (r.speed * Vector3::from(r.axis), r.through.into()));
        Motion { rotations: rotations.collect() }
    }

    /// `v = sum omega x (x - through)`, m/s.
    fn velocity(&self, x: &Vector3<f64>) -> Vector3<f64> {
        let terms = self.rotations.iter();
        terms.map(|(omega, through)| omega.cross(&(x - through))).sum()
    }

    /// `sum |omega|`, rad/s.
    fn spin(&self) -> f64 {
        self.rotations.iter().map(|(omega, _)| omega.norm()).sum()
    }
}

/// Direction t and speed of the master against the slave at `x`, in the plane with the unit normal `n`:
/// `|v| t = (I - n n^T)(v_master - v_slave)`.
///
/// `None` where they do not move against each other: neither turns, both turn alike, or `x` lies on the axis. `size` is the
/// length (m) that tells whether x lies on the axis.
pub(super) fn sliding(slave: &Motion, master: &Motion, x: [f64; 3], n: [f64; 3], size: f64) -> Option<([f64; 3], f64)> {
    let (x, n) = (Vector3::from(x), Vector3::from(n));
    let (v_slave, v_master) = (slave.velocity(&x), master.velocity(&x));
    let v = v_master - v_slave;
    let tangential = v - n.dot(&v) * n;
    let speed = tangential.norm();
    let scale = v_slave.norm() + v_master.norm() + size * (slave.spin() + master.spin());
    (speed > STILL * scale).then(|| ((tangential / speed).into(), speed))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn about_z(omega: f64, through: [f64; 3]) -> Motion {
        Motion { rotations: vec![(Vector3::new(0.0, 0.0, omega), through.into())] }
    }

    const REST: Motion = Motion { rotations: Vec::new() };
    const UP: [f64; 3] = [0.0, 0.0, 1.0];

    #[test]
    fn a_turning_master_drags_along_the_circle() {
        let disc = about_z(5.0, [0.0, 0.1, 0.3]);
        let (t, speed) = sliding(&REST, &disc, [0.0, 0.2, 0.0], UP, 1e-3).unwrap();
        assert!((Vector3::from(t) + Vector3::x()).norm() < 1e-15);
        assert!((speed - 0.5).abs() < 1e-15);
    }

    #[test]
    fn a_turning_slave_is_dragged_against_its_own_velocity() {
        let disc = about_z(5.0, [0.0; 3]);
        let (t, _) = sliding(&disc, &REST, [0.2, 0.0, 0.0], UP, 1e-3).unwrap();
        assert!((Vector3::from(t) + Vector3::y()).norm() < 1e-15);
    }

    #[test]
    fn the_direction_lies_in_the_tangent_plane() {
        let disc = about_z(5.0, [0.0; 3]);
        let n = [0.6, 0.0, 0.8];
        let (t, speed) = sliding(&REST, &disc, [0.1, -0.1, 0.0], n, 1e-3).unwrap();
        assert!(Vector3::from(t).dot(&Vector3::from(n)).abs() < 1e-15);
        assert!((Vector3::from(t).norm() - 1.0).abs() < 1e-15);
        assert!(speed < 0.5 * 0.1 * 2.0_f64.sqrt() * 10.0);
    }

    #[test]
    fn nothing_slides_at_rest_on_the_axis_or_where_both_turn_alike() {
        let disc = about_z(5.0, [0.0; 3]);
        let hat = about_z(5.0, [0.0, 0.0, 0.07]);
        let x = [0.1, 0.03, 0.01];
        assert_eq!(sliding(&REST, &REST, x, UP, 1e-3), None);
        assert_eq!(sliding(&disc, &hat, x, UP, 1e-3), None);
        assert_eq!(sliding(&REST, &disc, [1e-17, 0.0, 0.02], UP, 1e-3), None);
    }
}
