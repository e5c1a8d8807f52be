//! Build facts: the run path of the libraries and what `--version` tells of the build.

fn main() {
    println!("cargo:rustc-link-arg=-Wl,--no-as-needed");
    println!("cargo:rerun-if-changed=build.rs");
}
