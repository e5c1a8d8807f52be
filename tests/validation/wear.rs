//! Wear of an annular pad: to which pressure does it run in?
//!
//! ```text
//!       ____p v v v____      Disc of radii 90 to 140 mm, 12 mm thick, fixed below, turning at 10 rad/s about its axis.
//!      |  pad | | pad  |     Pad of radii 100 to 130 mm, 10 mm thick, free along the axis, pressed by 2 MPa.
//!   |‾‾‾‾‾‾‾‾‾ | ‾‾‾‾‾‾‾‾‾|  Archard: dh/dt = k p v. The pad comes down as one, so that in the end dh/dt is the same
//!   |____disc__|_________|   everywhere: p v = const, p = F / (2 pi (b - a) r), whatever the elasticity.
//! ```
//!
//! Source: Archard, J. Appl. Phys. 24 (1953); the rule of uniform wear of clutches and disc brakes, e.g. Shigley,
//! *Mechanical engineering design*, 16-5.
//!
//! Goal: p v uniform to 1e-6; its value to 0.5 % of the closed form, which has exact circles; worn volume and Archard's
//! to rounding.

use std::f64::consts::PI;

use super::table::{Case, Row};
use crate::support::block::Block;
use crate::support::brake;
use squeal::analysis::{WearGoal, WearOptions, wear};
use squeal::mesh::Mesh;
use squeal::native::{Comm, Session};
use squeal::results::WearEnd;
use squeal::structure::Structure;

const MODEL: &str = r#"
[material.iron]
young = 110e9
poisson = 0.27
density = 7100
[material.lining]
young = 5e9
poisson = 0.25
density = 2600
[part.disc]
material = "iron"
[part.pad]
material = "lining"
[[fix]]
nodes = "disc_z0"
axes = "xyz"
[[fix]]
nodes = "pad_z1"
axes = "xy"
[[rotation]]
part = "disc"
axis = [0, 0, 1]
speed = 10
[[contact]]
slave = "pad_z0"
master = "disc_z1"
friction = 0.4
wear = 2e-14
LAW
[[load]]
on = "pad_z1"
pressure = 2e6
[stability]
band = [0, 1]
"#;
const RADII: [f64; 2] = [0.1, 0.13];

fn ring(part: &str, cells: [usize; 3], [inner, outer]: [f64; 2], [bottom, top]: [f64; 2], mesh: &mut Mesh) {
    let map = |x: [f64; 3]| {
        let (r, angle) = (inner + (outer - inner) * x[0], 2.0 * PI * x[1]);
        [r * angle.cos(), r * angle.sin(), bottom + (top - bottom) * x[2]]
    };
    Block { part, cells, wraps: true, map: &map }.add_to(mesh);
}

/// The worn pad under a normal law.
fn worn(comm: &Comm, law: &str, goal: WearGoal) -> squeal::results::Wear {
    let mut mesh = Mesh::default();
    ring("disc", [3, 20, 1], [0.09, 0.14], [-0.012, 0.0], &mut mesh);
    ring("pad", [3, 24, 1], RADII, [0.0, 0.01], &mut mesh);
    let mut brake = Structure::Full(Box::new(brake(&MODEL.replace("LAW", law), mesh)));
    wear(comm, &mut brake, &WearOptions { friction: None, goal, output: None }, &mut ()).unwrap()
}

fn annular_pad(comm: &Comm) -> Case {
    let worn = worn(comm, "law = { linear = 1e13 }", WearGoal::Uniform { tolerance: 1e-6 });
    assert_eq!(worn.end, WearEnd::Uniform);
    let (first, last) = (&worn.steps[0].pairs[0], &worn.steps[worn.steps.len() - 1].pairs[0]);
    println!("{} steps, spread from {:.3} to {:.1e}", worn.steps.len() - 1, first.spread, last.spread);
    assert!(first.spread > 0.05, "the pressure of a new pad is nearly uniform, and v is not");
    // F = p A, and p v = F Omega / (2 pi (b - a)) = p (a + b) Omega / 2
    let exact = 2e6 * 0.5 * (RADII[0] + RADII[1]) * 10.0;
    let percent = 1e-2;
    Case {
        title: "Wear of an annular pad",
        text: "A pad of radii 100 and 130 mm on a disc at 10 rad/s under 2 MPa, worn by Archard's law until the wear rate is uniform. \
               Reference: p v = F Ω / 2π(b − a) everywhere. The mesh has polygons in place of circles.",
        rows: vec![
            Row::new("smallest p v", "W/m²", last.smallest, exact, 0.5 * percent),
            Row::new("largest p v", "W/m²", last.largest, exact, 0.5 * percent),
            Row::new("standard deviation of p v over its mean", "1", last.spread, 0.0, 1e-6).scaled(1.0),
            Row::new("worn volume over Archard's", "1", last.volume / last.archard_volume, 1.0, 1e-12),
        ],
    }
}

pub fn cases(comm: &Comm) -> Vec<Case> {
    vec![annular_pad(comm)]
}

#[test]
fn an_annular_pad_runs_to_a_uniform_wear_rate() {
    annular_pad(&Session::start(&[]).unwrap()).verify();
}

/// The laws differ in penetration, not in the pressure at the end; and one long step comes near it.
#[test]
fn other_laws_and_one_long_step_come_to_the_same_pressure() {
    let comm = Session::start(&[]).unwrap();
    let uniform = WearGoal::Uniform { tolerance: 1e-6 };
    let linear = worn(&comm, "law = { linear = 1e13 }", uniform);
    let cubic = worn(&comm, "law = { cubic = [2e12, 1e24] }", uniform);
    let table = worn(&comm, "law = { table = [[0, 0], [1e-7, 5e5], [3e-7, 9e6]] }", uniform);
    let pressures = |worn: &squeal::results::Wear| worn.points.iter().map(|p| p.pressure_pa).collect::<Vec<_>>();
    let expected = pressures(&linear);
    for other in [cubic, table] {
        assert_eq!(other.end, WearEnd::Uniform);
        let off = pressures(&other).iter().zip(&expected).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        println!("pressures differ by {off:.1e}");
        assert!(off < 2e-5, "{off}");
    }
    let distance = linear.steps.last().unwrap().distance;
    let long = worn(&comm, "law = { linear = 1e13 }", WearGoal::Distance { distance: 1e3 * distance, n_steps: 1 });
    let last = &long.steps[1].pairs[0];
    assert!(last.spread < 1e-3, "{}", last.spread);
    assert!((last.volume / last.archard_volume - 1.0).abs() < 1e-12);
}
