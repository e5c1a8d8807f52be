//! Parts that turn: a thin ring against Bryan's formula in both frames, the rotor of CalculiX's examples, and a brake
//! whose disc has inertia forces.
//!
//! ```text
//!  thin ring, n waves around, spin Omega:       w0 at rest, in the frame that turns with the ring
//!    w = sqrt(w0^2 + (n (n^2 - 1) Omega / (n^2 + 1))^2) -+ 2 n Omega / (n^2 + 1)       - forward, + backward wave
//!  seen from the fixed frame                    w + n Omega forward, w - n Omega backward
//! ```
//!
//! Source: G. H. Bryan, *On the beats in the vibrations of a revolving cylinder or bell*, Proc. Cambridge Phil. Soc. 7
//! (1890), 101; with the hoop stress of the rotation: Endo, Hatamura, Sakata and Taniguchi, J. Sound Vib. 92 (1984),
//! 261.
//!
//! Goal and, in brackets, measured: see each test.

use std::f64::consts::TAU;

use crate::support::block::Block;
use crate::support::{assert_close, brake};
use squeal::analysis::Sweep;
use squeal::element::ElementKind;
use squeal::mesh::Mesh;
use squeal::native::{Comm, Session};
use squeal::stability::Band;
use squeal::structure::FullModel;

/// The ring moves in its plane; a spring on its mean motion holds it and no wave of two lengths or more.
const RING: &str = r#"
[material.steel]
young = 210e9
poisson = 0.0
density = 7800
[part.ring]
material = "steel"
[[fix]]
nodes = "ring_z0"
axes = "z"
[[fix]]
nodes = "ring_z1"
axes = "z"
[[connector]]
between = ["ring_x1", "ground"]
stiffness = [1e5, 1e5, 0]
rotational_stiffness = [0, 0, 1e3]
[stability]
band = [0, 900]
"#;

const SPIN: f64 = 200.0;

/// Mean radius 100 mm, 2 mm thick, 4 mm wide.
fn ring(inertia: &str) -> FullModel {
    let mut mesh = Mesh::default();
    let map = |x: [f64; 3]| {
        let (r, angle) = (0.099 + 0.002 * x[0], TAU * x[1]);
        [r * angle.cos(), r * angle.sin(), 0.004 * x[2]]
    };
    Block { part: "ring", cells: [1, 40, 1], wraps: true, map: &map }.add_solids_to(&mut mesh, ElementKind::C3D20R);
    let rotation =
        format!("[[rotation]]\npart = \"ring\"\naxis = [0, 0, 1]\nspeed = {SPIN}\ninertia = \"{inertia}\"\n");
    brake(&RING.replace("[stability]", &format!("{rotation}[stability]")), mesh)
}

/// The modes about the equilibrium, all of them.
fn modes(comm: &Comm, brake: &FullModel) -> Band {
    let system = brake.assemble(comm, &brake.families().unwrap()).unwrap();
    let prestress = brake.prestress().unwrap();
    let mut sweep = Sweep::new(&system, &brake.interface, false).unwrap().with_prestress(prestress.as_ref());
    let equilibrium = sweep.equilibrium(0.0, &mut ()).unwrap();
    let band = sweep.modes(&equilibrium, brake.model.band, &mut ()).unwrap();
    for mode in &band.modes {
        println!("{:.6} Hz, growth {:.1e}, {:.1e}", mode.frequency(), mode.growth_rate(), mode.backward_error);
    }
    println!("{:?}", band.count);
    band
}

/// The frequency (rad/s) nearest to one expected.
fn nearest(band: &Band, expected: f64) -> f64 {
    let all = band.modes.iter().map(|mode| mode.lambda.im);
    all.min_by(|a, b| (a - expected).abs().total_cmp(&(b - expected).abs())).expect("modes in the band")
}

/// Bryan's formula with the ring's own frequencies at rest, in the rotating frame.
fn bryan(n: f64, at_rest: f64) -> [f64; 2] {
    let centre = at_rest.hypot(n * (n * n - 1.0) * SPIN / (n * n + 1.0));
    let split = 2.0 * n * SPIN / (n * n + 1.0);
    [centre - split, centre + split]
}

/// Of two, three and four waves, to 1e-3 of the frequency, the thickness over the radius squared [..].
#[test]
fn a_thin_ring_has_bryans_frequencies_in_both_frames() {
    let comm = Session::start(&[]).unwrap();
    let [still, turning, fixed] = ["none", "rotating_frame", "fixed_frame"].map(|inertia| modes(&comm, &ring(inertia)));
    for n in [2.0, 3.0, 4.0] {
        // E I / (rho A R^4) of a thin ring.
        let thin = (210e9 * 0.002_f64.powi(2) / 12.0 / 7800.0).sqrt() / 0.01;
        let theory = thin * n * (n * n - 1.0) / (n * n + 1.0_f64).sqrt();
        let at_rest = nearest(&still, theory);
        assert_close("at rest", at_rest, theory, 1e-3);
        let [forward, backward] = bryan(n, at_rest);
        let (in_frame, seen) = (|w: f64| nearest(&turning, w), |w: f64| nearest(&fixed, w));
        assert_close("forward wave", in_frame(forward), forward, 1e-3);
        assert_close("backward wave", in_frame(backward), backward, 1e-3);
        // One ring in two frames.
        let shift = n * SPIN;
        let seen_forward = seen(forward + shift);
        assert_close("forward wave, fixed frame", seen_forward, in_frame(forward) + shift, 3e-5);
        let seen_backward = seen((backward - shift).abs());
        assert_close("backward wave, fixed frame", seen_backward, (in_frame(backward) - shift).abs(), 3e-5);
    }
    for band in [turning, fixed] {
        assert!(band.modes.iter().all(|mode| mode.growth_rate().abs() < 1e-6 * mode.lambda.norm()));
    }
}
