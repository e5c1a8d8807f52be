//! Links MUMPS into every executable, ahead of the plain build that PETSc itself asks for, so that all calls find it,
//! PETSc's too, which name its symbols only at run time: hence `--no-as-needed`. Libraries outside the system's folders
//! are found again at run time.

use std::env;

fn main() {
    let mumps = env::var("DEP_PETSC_MUMPS").expect("squeal-sys has found MUMPS");
    let names: String = mumps.split_whitespace().map(|name| format!("-l{name},")).collect();
    println!("cargo:rustc-link-arg=-Wl,--push-state,--no-as-needed,{names}--pop-state");
    let folders = env::var("DEP_PETSC_FOLDERS").unwrap_or_default();
    for folder in folders.split(':').filter(|folder| !folder.is_empty()) {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{folder}");
    }
    println!("cargo:rerun-if-changed=build.rs");
}
