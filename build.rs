//! Links MUMPS's build with SCOTCH into every executable, ahead of the plain build that PETSc itself asks for, so that
//! all calls find it, PETSc's too, which name its symbols only at run time: hence `--no-as-needed`.

fn main() {
    println!("cargo:rustc-link-arg=-Wl,--push-state,--no-as-needed,-ldmumps_ptscotch,-lsmumps_ptscotch,--pop-state");
    println!("cargo:rerun-if-changed=build.rs");
}
