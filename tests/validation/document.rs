//! `docs/validation.md`, written from runs.

use std::path::Path;

use squeal::native::{Comm, Session};

use super::table::{Case, document};
use super::{
    annulus, cattaneo_mindlin, contact_patch, hertz, konter, minimal_models, nafems_fv52, oberst_beam, pads_on_disc,
    sandwich_beam, td1, wear,
};

/// What the document begins with.
const PREFACE: &str = "# Validation

Every number of the tables below was computed by `make validation`, which writes this file. The references are exact solutions, published
values, and results of other programs. Each section is a case of `tests/validation/`, where a file tells its geometry, its source and
what may be expected. `make test` computes all of them again, TD-1 on its coarse mesh, and fails where a difference leaves the allowed range or
where a number is no longer the one below.

`make calculix` compares 30 modes of two models with CalculiX on the same mesh (`tests/physics/calculix.rs`).
";

/// The cases in the order of the document, but for TD-1.
const CASES: [fn(&Comm) -> Vec<Case>; 11] = [
    minimal_models::cases,
    pads_on_disc::cases,
    nafems_fv52::cases,
    annulus::cases,
    contact_patch::cases,
    hertz::cases,
    cattaneo_mindlin::cases,
    konter::cases,
    wear::cases,
    sandwich_beam::cases,
    oberst_beam::cases,
];

/// Writes the document. `make validation` runs it; it takes minutes.
#[test]
#[ignore = "writes docs/validation.md: make validation"]
fn write() {
    let comm = Session::start(&[]).unwrap();
    let cases = CASES.iter().flat_map(|cases| cases(&comm));
    let sections: Vec<String> = cases.map(|case| case.section()).chain([td1::section(&comm)]).collect();
    let file = document();
    std::fs::create_dir_all(file.parent().unwrap_or(Path::new("."))).unwrap();
    std::fs::write(file, format!("{PREFACE}\n{}", sections.join("\n"))).unwrap();
}
