//! Too little memory, at whatever moment, ends a run with what it lacks.

use std::process::Command;

use crate::support::program::{Finished, Place};

/// A run whose address space is limited, MB.
fn limited(place: &Place, megabytes: usize) -> Finished {
    let program = assert_cmd::cargo::cargo_bin("squeal");
    let run = "stability brake.toml --friction=0.4 --band=0:1200 --no-branches --force -o run";
    let script = format!("ulimit -v {}; exec timeout 200 {} {run}", 1024 * megabytes, program.display());
    let mut command = Command::new("bash");
    command.args(["-c", &script]).current_dir(place.path("")).env("OPENBLAS_NUM_THREADS", "1");
    command.output().unwrap().into()
}

/// MPI cannot start in less than 300 MB, and with 2 GB the run is finished. In between it ends where it first lacks
/// memory: in Rust, PETSc, OpenBLAS (which waits for ever where its buffer is not taken at the start) or MUMPS.
#[test]
fn short_memory_is_said_wherever_it_is_met() {
    let place = Place::pads();
    let mut n_short = 0;
    for megabytes in (300..800).step_by(50).chain([2048]) {
        let Finished { code, err, .. } = limited(&place, megabytes);
        println!("{megabytes} MB: {code} {}", err.trim_end());
        assert!(code == 0 || code == 2 && err.contains("error: too little memory: "), "{megabytes} MB: {code} {err}");
        assert!(!err.contains("backtrace") && !err.contains("PetscMalloc"), "{megabytes} MB: {err}");
        assert!(code == 0 || !place.path("run").exists(), "nothing half written");
        n_short += usize::from(code == 2);
        assert!(code == 0 || megabytes < 2048);
    }
    assert!(n_short >= 3, "{n_short}");
}
