//! Analyses a brake under a friction law of the program's own: friction that falls with sliding speed and pressure.
//!
//! ```text
//! cargo run --release --example friction_law
//! ```

use std::path::Path;

use squeal::analysis::{StabilityOptions, stability};
use squeal::contact::law::{FrictionFactor, FrictionFunction, FrictionLaw, check_derivatives};
use squeal::structure::FullModel;
use squeal::{Result, Session, Structure};

/// `phi(v, q) = exp(-v/v_0) / (1 + q/q_0)`, times the friction value.
#[derive(Debug)]
struct Falling {
    v_0: f64,
    q_0: f64,
}

impl FrictionFunction for Falling {
    fn factor(&self, v: f64, q: f64) -> FrictionFactor {
        let value = (-v / self.v_0).exp() / (1.0 + q / self.q_0);
        FrictionFactor { value, by_speed: -value / self.v_0, by_pressure: -value / (self.q_0 + q) }
    }
}

/// Runs the example.
pub fn main() -> Result<()> {
    let law = || Falling { v_0: 0.2, q_0: 50e6 };
    check_derivatives(&law(), &[0.1, 0.5, 1.0], &[1e5, 1e6, 1e7])?;

    let comm = Session::start(&[])?;
    let mut brake = FullModel::read(&comm, Path::new("tests/data/pads_on_disc.toml"))?;
    // The slope dmu/dv acts on the modes with friction damping alone.
    brake.model.friction_damping = true;
    let options = StabilityOptions {
        friction_values: Some(vec![0.1]),
        band: Some([0.0, 2000.0]),
        branches: false,
        ..StabilityOptions::default()
    };
    let mut brake = Structure::Full(Box::new(brake));
    let constant = stability(&comm, &brake, &options, &mut ())?;
    for pair in ["disc / inner pad", "disc / outer pad"] {
        brake.interface_mut().set_friction_law(pair, FrictionLaw::user(law()))?;
    }
    let falling = stability(&comm, &brake, &options, &mut ())?;
    for ((mu, number, before), (_, _, after)) in constant.modes().zip(falling.modes()) {
        let (before, after) = (before.growth_rate(), after.growth_rate());
        println!("mu_0 = {mu}: mode {number} grows by {before:+.2} 1/s at constant mu, {after:+.2} 1/s under the law");
    }
    let unstable = |results: &squeal::Results| results.modes().filter(|(_, _, mode)| mode.unstable).count();
    assert!(unstable(&constant) == 0 && unstable(&falling) > 0, "friction that falls with the speed excites modes");
    Ok(())
}
