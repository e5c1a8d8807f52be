//! Sweeps the friction coefficient of a brake and prints which modes become unstable.
//!
//! ```text
//! cargo run --release --example friction_sweep [MODEL.toml]
//! ```

use std::path::PathBuf;

use squeal::analysis::{StabilityOptions, stability};
use squeal::structure::StructureOptions;
use squeal::{Result, Session, Structure};

/// Runs the example.
pub fn main() -> Result<()> {
    let model = std::env::args().nth(1).filter(|name| name.ends_with(".toml"));
    let model = model.map_or_else(|| PathBuf::from("tests/data/pads_on_disc.toml"), PathBuf::from);
    let comm = Session::start(&[])?;
    let brake = Structure::read(&comm, &model, &StructureOptions::default())?;
    let options = StabilityOptions {
        friction_values: Some(vec![0.2, 0.4]),
        band: Some([0.0, 2000.0]),
        ..StabilityOptions::default()
    };
    let results = stability(&comm, &brake, &options, &mut ())?;
    for (mu, number, mode) in results.modes().filter(|(_, _, mode)| mode.unstable) {
        println!("mu = {mu}: mode {number}, {:.1} Hz, growth rate {:+.1} 1/s", mode.frequency(), mode.growth_rate());
    }
    for hopf in results.diagram.iter().flat_map(|diagram| &diagram.hopf) {
        println!("a mode changes stability between mu = {:.4} and {:.4}", hopf.bracket[0], hopf.bracket[1]);
    }
    Ok(())
}
