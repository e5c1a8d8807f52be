//! What acts at a contact point.
//!
//! A law is four choices that do not depend on each other. A [`PointLaw`] has the normal law, whether the point may
//! open, and the kinematics in the tangent plane; the [`FrictionLaw`] is that of its pair. With the unit normal n of
//! the master, the initial gap, and the relative displacement g of the slave against the master,
//!
//! ```text
//! d = -(gap0 + n.g) + xi    penetration; gap0 counts as zero where the point may not open; xi only in reduced models
//! f = p(d) n + f_t          force on the slave; the master takes the opposite
//! D = -df/dg                so that K_contact = B^T D B, and the internal force is -B^T f
//! ```
//!
//! Three questions are asked of a point:
//!
//! - [`settle`]: how does it act while the brake is brought together, before there is any pressure?
//! - [`respond`]: how does it act by its true law?
//! - [`linearise`]: what is its tangent for stability, with its status frozen?

mod curves;
mod friction;
mod frozen;
mod normal;
mod settling;
mod tangential;

pub use friction::{Friction, FrictionFactor, FrictionFunction, FrictionLaw, check_derivatives};
pub use frozen::{friction_damping, linearise};
pub use settling::settle;
pub use tangential::{Tangential, respond};

use crate::model::NormalLaw;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// A contact point as its law sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct PointLaw {
    /// Weight w of the point, m2.
    pub weight: f64,
    /// Outward unit normal n of the master.
    pub normal: [f64; 3],
    /// Initial gap, m; negative where the surfaces overlap. Without meaning where the point may not open.
    pub gap: f64,
    /// Added to the penetration, m: what makes a reduced model's law give the full model's force. Else 0.
    pub correction: f64,
    /// Depth that is worn off while the point comes to its equilibrium, by pressure, m/Pa; 0 outside steps of wear.
    /// The normal law then acts on what is left of the penetration, `e + wear P(e) = d`.
    pub wear: f64,
    /// Whether the surfaces touch before they are loaded: [`settle`] closes such points.
    pub touching: bool,
    /// Whether the point may open.
    pub separation: bool,
    /// Pressure by penetration.
    pub normal_law: NormalLaw,
    /// What acts in the tangent plane.
    pub tangential: Tangential,
}

/// State of a contact point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Status {
    /// No contact, no force.
    Open,
    /// Closed and slipping or free to slip; the status of all closed sliding points.
    Slip,
    /// Closed and sticking.
    Stick,
}

/// What a contact point answers to a relative displacement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// Force f on the slave, N.
    pub force: [f64; 3],
    /// `D = -df/dg`, N/m, by rows; not symmetric with friction.
    pub tangent: [[f64; 3]; 3],
    /// Normal force p, N, positive in compression.
    pub normal_force: f64,
    /// State of the point.
    pub status: Status,
}

impl Response {
    /// An open point.
    pub(crate) const OPEN: Response =
        Response { force: [0.0; 3], tangent: [[0.0; 3]; 3], normal_force: 0.0, status: Status::Open };
}

impl PointLaw {
    /// n as a vector.
    fn n(&self) -> Vector3<f64> {
        self.normal.into()
    }

    /// Penetration `d = -(gap0 + n.g) + xi`, m, with the correction xi and without the initial gap where the point may
    /// not open.
    pub fn penetration(&self, g: [f64; 3]) -> f64 {
        let gap = if self.separation { self.gap } else { 0.0 };
        self.correction - (gap + self.n().dot(&Vector3::from(g)))
    }

    /// Projector on the tangent plane, `P = I - n n^T`.
    fn tangent_plane(&self) -> Matrix3<f64> {
        Matrix3::identity() - self.n() * self.n().transpose()
    }
}

/// A matrix by rows.
fn rows(m: Matrix3<f64>) -> [[f64; 3]; 3] {
    m.transpose().into()
}

#[cfg(test)]
mod testing {
    //! Points and derivatives for the tests of the laws.
    use super::*;
    use proptest::prelude::*;

    /// Unit vectors n and t, perpendicular.
    pub fn frame() -> impl Strategy<Value = [[f64; 3]; 2]> {
        (0.0..3.1, -3.1..3.1, -3.1..3.1).prop_map(|(polar, azimuth, turn): (f64, f64, f64)| {
            let rotation = nalgebra::Rotation3::from_euler_angles(polar, azimuth, turn);
            [(rotation * Vector3::z()).into(), (rotation * Vector3::x()).into()]
        })
    }

    /// Linear and cubic laws of order one.
    pub fn law() -> impl Strategy<Value = NormalLaw> {
        prop_oneof![
            (0.5..3.0).prop_map(|stiffness| NormalLaw::Linear { stiffness }),
            (0.5..3.0, 0.0..2.0).prop_map(|(k1, k3)| NormalLaw::Cubic { k1, k3 }),
            // Its kinks are far from the penetrations of the tests.
            (0.5..3.0, 0.5..3.0)
                .prop_map(|(k, p)| NormalLaw::Table { rows: vec![[0.0, 0.0], [5.0, 5.0 * k], [6.0, 5.0 * k + p]] }),
        ]
    }

    /// A law that falls with speed and pressure, of order one.
    #[derive(Debug)]
    pub struct Falling;

    impl FrictionFunction for Falling {
        /// `phi = 1 / ((1 + v) (1 + q))`
        fn factor(&self, speed: f64, pressure: f64) -> FrictionFactor {
            let value = 1.0 / ((1.0 + speed) * (1.0 + pressure));
            FrictionFactor { value, by_speed: -value / (1.0 + speed), by_pressure: -value / (1.0 + pressure) }
        }
    }

    /// Constant laws and falling ones.
    pub fn friction_law() -> impl Strategy<Value = FrictionLaw> {
        prop_oneof![Just(FrictionLaw::Constant), Just(FrictionLaw::user(Falling))]
    }

    /// Points of every law.
    pub fn point() -> impl Strategy<Value = PointLaw> {
        prop_oneof![Just(Tangential::Frictionless), Just(SLIDING), stick_slip(),].prop_flat_map(point_with)
    }

    /// Sliding along a direction that [`point_with`] chooses.
    pub const SLIDING: Tangential = Tangential::Sliding { direction: [0.0; 3], speed: 2.0 };

    /// Elastic stick of order one with a bound.
    pub fn stick_slip() -> impl Strategy<Value = Tangential> {
        (0.5..3.0).prop_map(|stick| Tangential::StickSlip { stick })
    }

    /// Points with one tangential law; sliding ones get a direction in their tangent plane.
    pub fn point_with(tangential: Tangential) -> impl Strategy<Value = PointLaw> {
        let numbers = (0.5..2.0, -0.3..0.3, prop_oneof![Just(0.0), 0.0..2.0]);
        (frame(), law(), numbers, any::<bool>()).prop_map(move |([n, t], law, (weight, gap, wear), separation)| {
            let mut tangential = tangential;
            if let Tangential::Sliding { direction, .. } = &mut tangential {
                *direction = t;
            }
            PointLaw {
                weight,
                normal: n,
                gap,
                correction: 0.0,
                wear,
                touching: gap <= 0.0,
                separation,
                normal_law: law,
                tangential,
            }
        })
    }

    /// `g` moved along the normal so that the penetration is `d`.
    pub fn at_penetration(point: &PointLaw, g: [f64; 3], d: f64) -> [f64; 3] {
        (Vector3::from(g) + (point.penetration(g) - d) * point.n()).into()
    }

    /// Relative displacements of order one.
    pub fn displacement() -> impl Strategy<Value = [f64; 3]> {
        prop::array::uniform3(-1.0..1.0)
    }

    /// Largest difference between D and `-df/dg` by central differences with step `h`.
    pub fn tangent_error(respond: impl Fn([f64; 3]) -> Response, g: [f64; 3], h: f64) -> f64 {
        let tangent = respond(g).tangent;
        let mut error: f64 = 0.0;
        for j in 0..3 {
            let shifted = |sign: f64| {
                let mut g = g;
                g[j] += sign * h;
                respond(g).force
            };
            let (plus, minus) = (shifted(1.0), shifted(-1.0));
            for i in 0..3 {
                let numerical = -(plus[i] - minus[i]) / (2.0 * h);
                error = error.max((tangent[i][j] - numerical).abs());
            }
        }
        error
    }

    /// Distance of two forces.
    pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        (Vector3::from(a) - Vector3::from(b)).norm()
    }
}
