//! Friction laws on a mass on a belt, through the public interface alone.
//!
//! ```text
//!          | load        z
//!       +--v--+          |_ x
//!   k,c-| m   |          springs k in x, y and z, damper c in x; x and z may be coupled
//!       +-----+          pressed on a belt, which slides along x at v
//!    ---------------> v
//! ```
//!
//! The motion along the belt: `m udd + (c + N dmu/dv) ud + k u = 0`, so that it loses stability exactly where
//! `dmu/dv N = -c` (Popp and Stelter, *Stick-slip vibrations and chaos*, Phil. Trans. R. Soc. A 332, 1990; Ibrahim,
//! *Friction-induced vibration, chatter, squeal and chaos*, Appl. Mech. Rev. 47, 1994).

use crate::support::assert_close;
use num_complex::Complex64;
use squeal::analysis::Sweep;
use squeal::assembly::{Connectivity, ElementMatrices, Elements, System};
use squeal::contact::law::{FrictionFactor, FrictionFunction, check_derivatives};
use squeal::contact::{
    ContactPair, ContactPoint, FrictionLaw, GapOperator, Interface, PointLaw, Statistics, Tangential, TangentialKind,
};
use squeal::mesh::Numbering;
use squeal::model::NormalLaw;
use squeal::model::friction::{FrictionCurve, FrictionTable, SpeedDecay, Stribeck};
use squeal::native::{Comm, Session};

const MASS: f64 = 2.0;
const DAMPING: f64 = 3.0;
const SPEED: f64 = 0.5;
const LOAD: f64 = 10.0;
const BAND: [f64; 2] = [0.0, 20.0];

/// The mass with its springs and damper; `coupling` is the stiffness between x and z.
struct Mass {
    coupling: f64,
}

impl Connectivity for Mass {
    fn len(&self) -> usize {
        1
    }

    fn nodes(&self, _: usize) -> &[u32] {
        &[0]
    }
}

impl Elements for Mass {
    fn matrices(&self, _: usize, out: &mut ElementMatrices) {
        out.m = vec![MASS, 0.0, 0.0, 0.0, MASS, 0.0, 0.0, 0.0, MASS];
        out.c = vec![DAMPING, 0.0, 0.0, 0.0, DAMPING, 0.0, 0.0, 0.0, DAMPING];
        out.k = vec![800.0, 0.0, self.coupling, 0.0, 5000.0, 0.0, self.coupling, 0.0, 300.0];
    }
}

/// The contact of the mass with the belt.
fn belt(friction_law: FrictionLaw) -> Interface {
    let normal_law = NormalLaw::Linear { stiffness: 400.0 };
    let law = PointLaw {
        weight: 1.0,
        normal: [0.0, 0.0, 1.0],
        gap: 0.0,
        correction: 0.0,
        wear: 0.0,
        touching: true,
        separation: true,
        normal_law: normal_law.clone(),
        tangential: Tangential::Sliding { direction: [1.0, 0.0, 0.0], speed: SPEED },
    };
    let pair = ContactPair {
        name: "belt".into(),
        slave: "mass".into(),
        master: "belt".into(),
        law: normal_law,
        friction: 0.3,
        friction_law,
        kind: TangentialKind::Sliding,
        separation: true,
        swept: true,
        wear: None,
        points: 0..1,
        statistics: Statistics::default(),
    };
    let mut gap_operator = GapOperator::new();
    gap_operator.push(&[0], &[[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]]);
    let points =
        vec![ContactPoint { pair: 0, places: vec![], nodes: vec![0], position: [0.0; 3], field_gap: 0.0, law }];
    Interface { pairs: vec![pair], points, gap_operator }
}

/// The normal force (N) and the eigenvalues at a friction value.
fn solve(comm: &Comm, law: &FrictionLaw, coupling: f64, friction: f64) -> (f64, Vec<Complex64>) {
    let interface = belt(law.clone());
    let nodes = Numbering::even(1, 0, 1);
    let contacts: [&dyn Connectivity; 1] = [&interface.gap_operator];
    let mut system = System::assemble(comm, &nodes, &[[false; 3]], &[&Mass { coupling }], &contacts).unwrap();
    system.add_load(&[(0, [0.0, 0.0, -LOAD])]).unwrap();
    let mut sweep = Sweep::new(&system, &interface, true).unwrap();
    let equilibrium = sweep.equilibrium(friction, &mut ()).unwrap();
    let band = sweep.modes(&equilibrium, BAND, &mut ()).unwrap();
    assert!(band.count.agrees());
    (equilibrium.responses[0].normal_force, band.modes.iter().map(|mode| mode.lambda).collect())
}

/// A decay that falls with the pressure, too: `phi = (r + (1 - r) exp(-v/v_0)) (1 - s q)`.
#[derive(Debug)]
struct Falling;

impl FrictionFunction for Falling {
    fn factor(&self, speed: f64, pressure: f64) -> FrictionFactor {
        let falling = 0.6 * (-speed / 0.3).exp();
        let by_pressure = -0.03;
        let (of_speed, of_pressure) = (0.4 + falling, 1.0 + by_pressure * pressure);
        FrictionFactor {
            value: of_speed * of_pressure,
            by_speed: -falling / 0.3 * of_pressure,
            by_pressure: of_speed * by_pressure,
        }
    }
}

/// The motion along the belt has the growth rate `-(c + N dmu/dv) / 2m`, which changes sign at `dmu/dv N = -c`.
#[test]
fn a_mass_on_a_belt_loses_stability_where_the_slope_takes_up_the_damping() {
    let comm = Session::start(&[]).unwrap();
    let decay = SpeedDecay { kinetic_ratio: 0.4, decay: 1.0 / 0.3 };
    let stribeck = Stribeck { kinetic_ratio: 0.4, speed: 0.4, exponent: 2.0, viscous: 0.1 };
    // A table in which mu falls with pressure and speed.
    let table = FrictionTable {
        speeds: vec![0.0, 1.0],
        pressures: vec![0.0, 5.0, 20.0],
        values: vec![1.0, 0.95, 0.8, 0.7, 0.6, 0.5],
    };
    let curves = [FrictionCurve::Decay(decay), FrictionCurve::Stribeck(stribeck), FrictionCurve::Table(table)];
    let mut functions: Vec<(&dyn FrictionFunction, FrictionLaw)> = vec![(&Falling, FrictionLaw::user(Falling))];
    functions.extend(curves.iter().map(|curve| (curve as &dyn FrictionFunction, FrictionLaw::Curve(curve.clone()))));
    for (function, law) in functions {
        check_derivatives(function, &[0.1, SPEED, 2.0], &[1.0, LOAD]).unwrap();
        // Without coupling N does not depend on friction.
        let (n, _) = solve(&comm, &law, 0.0, 0.0);
        let slope = function.factor(SPEED, n).by_speed;
        let critical = -DAMPING / (n * slope);
        println!("N = {n} N, loses stability at mu_0 = {critical}");
        for ratio in [0.5, 0.999, 1.0, 1.001, 1.5] {
            let (_, lambdas) = solve(&comm, &law, 0.0, ratio * critical);
            let expected = -DAMPING * (1.0 - ratio) / (2.0 * MASS);
            let omega = (800.0 / MASS - expected * expected).sqrt();
            let exact = Complex64::new(expected, omega);
            let error = lambdas.iter().map(|lambda| (lambda - exact).norm()).fold(f64::INFINITY, f64::min);
            assert!(error < 1e-9 * omega, "{ratio}: {lambdas:?} without {exact}");
        }
    }
}

/// Small motions see `d(mu p)/dp` in place of mu: under a law with pressure the eigenvalues are those of the constant
/// coefficient `mu + q dmu/dq`, with x and z coupled as in mode coupling.
#[test]
fn pressure_enters_the_stiffness_by_the_slope_of_the_friction_force() {
    let comm = Session::start(&[]).unwrap();
    let still = |speed: f64| SpeedFree(Falling, speed);
    let law = FrictionLaw::user(still(SPEED));
    let (n, lambdas) = solve(&comm, &law, -150.0, 0.8);
    let FrictionFactor { value, by_pressure, .. } = Falling.factor(SPEED, n);
    // Friction damping across the sliding direction, along y, sees mu itself: y is left out by its frequency.
    let (_, constant) = solve(&comm, &FrictionLaw::Constant, -150.0, 0.8 * (value + n * by_pressure));
    let (_, without) = solve(&comm, &FrictionLaw::Constant, -150.0, 0.8 * value);
    let in_plane = |all: &[Complex64]| all.iter().copied().filter(|z| z.im < 45.0).collect::<Vec<_>>();
    let [lambdas, constant, without] = [lambdas, constant, without].map(|all| in_plane(&all));
    assert_eq!((lambdas.len(), constant.len()), (2, 2));
    for ((found, exact), other) in lambdas.iter().zip(&constant).zip(&without) {
        assert_close("eigenvalue", found.im, exact.im, 1e-10);
        assert!((found - exact).norm() < 1e-9 * exact.norm() && (found - other).norm() > 1e-4 * exact.norm());
    }
}

/// A law at one speed, without its slope there.
#[derive(Debug)]
struct SpeedFree(Falling, f64);

impl FrictionFunction for SpeedFree {
    fn factor(&self, _: f64, pressure: f64) -> FrictionFactor {
        FrictionFactor { by_speed: 0.0, ..self.0.factor(self.1, pressure) }
    }
}
