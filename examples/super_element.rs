//! Reduces a brake to a super-element and compares its modes with those of the full model.
//!
//! ```text
//! cargo run --release --example super_element
//! ```

use std::path::Path;

use squeal::analysis::{ReduceOptions, StabilityOptions, reduce, stability};
use squeal::structure::{FullModel, StructureOptions};
use squeal::{Error, Result, Session, Structure};

/// Runs the example.
pub fn main() -> Result<()> {
    let comm = Session::start(&[])?;
    let model = Path::new("tests/data/pads_on_disc.toml");
    let folder = tempfile::tempdir().map_err(Error::io(Path::new("a temporary folder")))?;
    let file = folder.path().join("pads.se.h5");

    let mut full = FullModel::read(&comm, model)?;
    full.reduce_contacts(12)?;
    let options =
        ReduceOptions { friction: Some(0.3), limit: Some(6000.0), for_study: None, file: file.clone(), force: false };
    let reduction = reduce(&comm, &full, &options, &mut ())?;
    println!("{} coordinates in place of {} dofs", reduction.element.n_coordinates(), reduction.element.origin.n_dofs);

    let options = StabilityOptions {
        friction_values: Some(vec![0.3]),
        band: Some([0.0, 2000.0]),
        branches: false,
        ..StabilityOptions::default()
    };
    let contacts = StructureOptions { contacts: Some(12), ..StructureOptions::default() };
    let full = stability(&comm, &Structure::read(&comm, model, &contacts)?, &options, &mut ())?;
    let reduced = stability(&comm, &Structure::read(&comm, &file, &StructureOptions::default())?, &options, &mut ())?;
    for ((_, number, full), (_, _, reduced)) in full.modes().zip(reduced.modes()) {
        println!("mode {number}: {:9.3} Hz, reduced {:9.3} Hz", full.frequency(), reduced.frequency());
        assert!((reduced.frequency() / full.frequency() - 1.0).abs() < 1e-3, "the super-element is as its model");
    }
    Ok(())
}
