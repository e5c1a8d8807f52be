//! A pad on a sliding disc, pressed by a piston on a spring, all blocks, with damping of many kinds: Rayleigh's and a
//! dashpot, and what a test gives materials and spring.

use crate::support::{brake, pressed_pad};
use nalgebra::DMatrix;
use squeal::analysis::Sweep;
use squeal::assembly::System;
use squeal::equilibrium::Equilibrium;
use squeal::native::{Comm, Matrix};
use squeal::stability::Band;
use squeal::structure::FullModel;

/// All but the materials: the spring's loss factor is to follow `[[connector]]`.
const PARTS: &str = r#"
[part.disc]
material = "iron"
rayleigh = { alpha = 5.0, beta = 1e-7 }
[part.pad]
material = "lining"
[part.piston]
material = "steel"
[[tie]]
slave = "piston_z0"
master = "pad_z1"
[stability]
band = [0, 42000]
[[connector]]
name = "pin"
between = ["piston_z1", "ground"]
stiffness = [2e8, 1e8, 1e5]
rotational_stiffness = [1e3, 1e3, 1e3]
damping = [10, 20, 0]
"#;

pub const FRICTION: f64 = 0.4;
pub const BAND: [f64; 2] = [0.0, 42000.0];

/// The brake at its equilibrium, which has no damping, and moduli at rest.
pub struct DampedPad {
    pub brake: FullModel,
    pub system: System,
    pub equilibrium: Equilibrium,
}

impl DampedPad {
    /// With these materials "iron", "lining" and "steel", and another line of the connector.
    pub fn new(comm: &Comm, materials: &str, connector: &str) -> DampedPad {
        let brake = brake(&text(materials, connector), pressed_pad::mesh([2, 2, 1]));
        let system = assembled(comm, &brake);
        let equilibrium = Sweep::new(&system, &brake.interface, false).unwrap().equilibrium(FRICTION, &mut ()).unwrap();
        DampedPad { brake, system, equilibrium }
    }
}

/// The model's text.
pub fn text(materials: &str, connector: &str) -> String {
    format!("{}{materials}{PARTS}{connector}", pressed_pad::SLIDING)
}

pub fn assembled(comm: &Comm, brake: &FullModel) -> System {
    brake.assemble(comm, &brake.families().unwrap()).unwrap()
}

/// All modes of the band, their backward errors below 1e-10.
pub fn solved(sweep: &mut Sweep, equilibrium: &Equilibrium) -> Band {
    let band = sweep.modes(equilibrium, BAND, &mut ()).unwrap();
    assert!(band.count.agrees() && band.modes.len() > 4, "{:?}", band.count);
    assert!(band.modes.iter().all(|mode| mode.backward_error < 1e-10));
    band
}

/// The entries of a matrix on one rank.
pub fn dense(a: &Matrix) -> DMatrix<f64> {
    let mut values = DMatrix::zeros(a.n_local(), a.n_local());
    a.visit_rows(|row, columns, entries| {
        columns.iter().zip(entries).for_each(|(&column, &value)| values[(row, column as usize)] = value);
    })
    .unwrap();
    values
}
