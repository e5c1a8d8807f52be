//! Finds the flutter of Hoffmann's two-degree-of-freedom model from three matrix files of another program.
//!
//! Source: Hoffmann, Fischer, Allgaier, Gaul, Mechanics Research Communications 29, 2002: M = I, K = [[2, 1 - 4/3 mu],
//! [1, 2]]; the two modes couple at mu = 3/4.
//!
//! ```text
//! cargo run --release --example external_matrices
//! ```

use std::f64::consts::TAU;
use std::path::Path;

use squeal::analysis::{ExternalOptions, external_modes};
use squeal::matrices::family;
use squeal::model::InstabilityCriterion;
use squeal::{Error, Result, Session};

const FILES: [(&str, &str); 4] = [
    ("m.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 2 1\n"),
    ("k0.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 4\n1 1 2\n1 2 1\n2 1 1\n2 2 2\n"),
    ("k1.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 1\n1 2 1\n"),
    (
        "hoffmann.toml",
        "parameter = \"mu\"\n[[mass]]\nfile = \"m.mtx\"\n[[stiffness]]\nfile = \"k0.mtx\"\n\
         [[stiffness]]\nfile = \"k1.mtx\"\nfactor = \"-4/3*mu\"\n",
    ),
];

/// Runs the example.
pub fn main() -> Result<()> {
    let comm = Session::start(&[])?;
    let folder = tempfile::tempdir().map_err(Error::io(Path::new("a temporary folder")))?;
    for (name, text) in FILES {
        let path = folder.path().join(name);
        std::fs::write(&path, text).map_err(Error::io(&path))?;
    }
    let family = family::read(&folder.path().join("hoffmann.toml"))?;
    let options = ExternalOptions {
        band: [0.0, 1.0],
        criterion: InstabilityCriterion::default(),
        values: vec![0.5, 0.8],
        branches: true,
        shapes: false,
    };
    let results = external_modes(&comm, &family, &options, &mut ())?;
    for value in &results.values {
        for mode in &value.modes {
            println!(
                "mu = {}: omega {:.6} rad/s, growth rate {:+.6} 1/s",
                value.value,
                TAU * mode.frequency(),
                mode.lambda.re
            );
        }
    }
    let growing = results.values[1].modes.iter().find(|mode| mode.is_unstable);
    let growth = growing.map_or(0.0, |mode| mode.lambda.re);
    assert!((growth - 0.091098).abs() < 1e-6, "the exact growth rate at mu = 0.8");
    Ok(())
}
