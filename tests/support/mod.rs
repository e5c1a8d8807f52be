//! What the tests share: block meshes of tetrahedra, brakes made of text and mesh, the program in a folder of its own,
//! a browser, assertions.
//!
//! A module of each test crate and not a crate of its own: Cargo would build the library twice for its unit tests.
#![allow(dead_code, reason = "every test crate takes its own part")]

pub mod as_deck;
pub mod block;
pub mod browser;
pub mod gmsh;
pub mod pad_on_disc;
pub mod pressed_pad;
pub mod program;

use std::path::{Path, PathBuf};

use squeal::contact::search::Alone;
use squeal::mesh::{Mesh, Numbering, Piece};
use squeal::model;
use squeal::structure::FullModel;

/// A file of tests/data.
pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// Requires `|found - expected| <= tolerance |expected|`, and prints what it saw.
#[track_caller]
pub fn assert_close(what: &str, found: f64, expected: f64, tolerance: f64) {
    let error = (found / expected - 1.0).abs();
    println!("{what}: {found:.10e} against {expected:.10e}, off by {error:.1e}, allowed {tolerance:.0e}");
    assert!(error <= tolerance, "{what}: {found} is not {expected} to {tolerance}");
}

/// A brake of a model's text and a mesh that needs no file.
pub fn brake(text: &str, mesh: Mesh) -> FullModel {
    let text = format!("[mesh]\nfile = \"none.msh\"\nunit = \"m\"\n{text}");
    let model = model::parse(&text, Path::new("test.toml")).unwrap();
    let nodes = Numbering::even(mesh.nodes.len(), 0, 1);
    FullModel::new(model, Piece { mesh, nodes }, &Alone).unwrap()
}

/// Nodes that satisfy a condition on their coordinates.
pub fn nodes_where(mesh: &Mesh, condition: impl Fn([f64; 3]) -> bool) -> Vec<u32> {
    (0..mesh.nodes.len() as u32).filter(|&n| condition(mesh.nodes[n as usize])).collect()
}

/// Places 0 to `size` of n cells: `n_fine` even ones up to `fine`, then each longer than the last by one factor.
pub fn graded(n: usize, n_fine: usize, fine: f64, size: f64) -> impl Fn(f64) -> f64 {
    let (step, m) = (fine / n_fine as f64, (n - n_fine) as f64);
    let length = move |q: f64, cells: f64| step * q * (q.powf(cells) - 1.0) / (q - 1.0);
    let (mut low, mut high) = (1.001, 20.0);
    for _ in 0..60 {
        let q = 0.5 * (low + high);
        if length(q, m) < size - fine { low = q } else { high = q }
    }
    move |s| {
        let cells = s * n as f64;
        let beyond = cells - n_fine as f64;
        if beyond <= 0.0 { step * cells } else { fine + length(low, beyond) }
    }
}
