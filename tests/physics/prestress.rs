//! The geometric stiffness of the equilibrium: a beam under an axial force.
//!
//! ```text
//!   |o======================o|-> u      both ends guided: they move across, and do not turn
//!   f^2 = f0^2 (1 + P L^2 / (pi^2 E I))       of the first mode, a cosine; P = E A u / L; zero at Euler's load
//! ```
//!
//! Source: Blevins, *Formulas for Natural Frequency and Mode Shape* (1979), 8.1.4, and the same factor for the guided
//! beam, whose mode is a cosine in place of a sine.
//!
//! Goal and, in brackets, measured: see the test.

use std::f64::consts::PI;

use crate::support::block::Block;
use crate::support::{assert_close, brake};
use squeal::analysis::Sweep;
use squeal::element::ElementKind;
use squeal::mesh::Mesh;
use squeal::native::{Comm, Session};

const LENGTH: f64 = 1.0;
const THICKNESS: f64 = 0.01;

/// A spring on the mean motion across holds the beam, and no cosine.
const BEAM: &str = r#"
[material.steel]
young = 200e9
poisson = 0.0
density = 8000
[part.beam]
material = "steel"
[[fix]]
nodes = "beam_x0"
axes = "x"
[[fix]]
nodes = "beam_x1"
axes = "x"
displacement = [PULL, 0, 0]
[[fix]]
nodes = "beam_y0"
axes = "y"
[[connector]]
between = ["beam_z1", "ground"]
stiffness = [0, 0, 1e8]
[stability]
band = [0, 200]
prestress = true
"#;

/// The square of the first frequency of bending, rad/s, where the end moves.
fn first(comm: &Comm, kind: ElementKind, pull: f64) -> f64 {
    let mut mesh = Mesh::default();
    let map = |x: [f64; 3]| [LENGTH * x[0], 0.02 * x[1], THICKNESS * x[2]];
    Block { part: "beam", cells: [16, 1, 1], wraps: false, map: &map }.add_solids_to(&mut mesh, kind);
    let beam = brake(&BEAM.replace("PULL", &format!("{pull:e}")), mesh);
    let system = beam.assemble(comm, &beam.families().unwrap()).unwrap();
    let prestress = beam.prestress().unwrap();
    let mut sweep = Sweep::new(&system, &beam.interface, false).unwrap().with_prestress(prestress.as_ref());
    let equilibrium = sweep.equilibrium(0.0, &mut ()).unwrap();
    let band = sweep.modes(&equilibrium, beam.model.band, &mut ()).unwrap();
    assert!(band.count.agrees(), "{:?}", band.count);
    band.modes[0].lambda.im.powi(2)
}

/// Tension of one Euler load and compression of half of it, with all kinds of element that bend: to 4e-3 [3.0e-3], of
/// which the beam's shear is 1e-4 and the rest the elements.
#[test]
fn an_axial_force_changes_the_frequency_of_a_beam_as_theory_has_it() {
    let comm = Session::start(&[]).unwrap();
    use ElementKind::{C3D8I, C3D10, C3D15, C3D20, C3D20R};
    for kind in [C3D10, C3D15, C3D20, C3D20R, C3D8I] {
        // The strain of Euler's load, pi^2 I / (A L^2).
        let euler = (PI * THICKNESS / LENGTH).powi(2) / 12.0;
        let at_rest = first(&comm, kind, 0.0);
        for load in [1.0, -0.5] {
            let found = first(&comm, kind, load * euler * LENGTH) / at_rest;
            assert_close(&format!("{kind:?} under {load} Euler loads"), found, 1.0 + load, 4e-3);
        }
    }
}

/// With prestress the Sturm count is of `K + K_g`, and nothing follows the contact points alone from one equilibrium to
/// the next; without it, all stays as it is.
#[test]
fn the_count_has_the_geometric_stiffness() {
    let comm = Session::start(&[]).unwrap();
    for is_on in [true, false] {
        let text = BEAM.replace("PULL", "1e-4").replace("prestress = true", &format!("prestress = {is_on}"));
        let mut mesh = Mesh::default();
        let map = |x: [f64; 3]| [LENGTH * x[0], 0.02 * x[1], THICKNESS * x[2]];
        Block { part: "beam", cells: [4, 1, 1], wraps: false, map: &map }.add_solids_to(&mut mesh, ElementKind::C3D20R);
        let beam = brake(&text, mesh);
        let system = beam.assemble(&comm, &beam.families().unwrap()).unwrap();
        let prestress = beam.prestress().unwrap();
        let mut sweep = Sweep::new(&system, &beam.interface, false).unwrap().with_prestress(prestress.as_ref());
        let equilibrium = sweep.equilibrium(0.0, &mut ()).unwrap();
        let changes = sweep.linearise(&equilibrium, |problem| {
            assert_eq!(problem.points.is_none(), is_on);
            let mut change = problem.symmetric_stiffness()?;
            change.axpy(-1.0, &system.k)?;
            Ok(change.norm_inf()? > 0.0)
        });
        assert_eq!(changes.unwrap(), is_on);
    }
}
