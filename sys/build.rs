//! Finds PETSc, SLEPc, MUMPS, METIS and MPI, and generates the bindings that `squeal` uses: the functions of
//! `functions.txt`.
//!
//! In this order: `PETSC_DIR`, `PETSC_ARCH` and `SLEPC_DIR`; `PKG_CONFIG_PATH`; Debian's packages. `MUMPS_LIBRARIES`
//! and `METIS_LIBRARY` name other libraries than those found beside PETSc or in the system's folders.

use std::env;
use std::path::{Path, PathBuf};

/// Everything `squeal` calls, one name a line; whatever these need comes along.
const FUNCTIONS: &str = include_str!("functions.txt");

/// The double and the single precision of MUMPS; Debian's build with SCOTCH, before the plain one.
const MUMPS: [[&str; 2]; 2] = [["dmumps_ptscotch", "smumps_ptscotch"], ["dmumps", "smumps"]];

/// Where Debian keeps its configurations of PETSc and SLEPc.
const DEBIAN: [&str; 2] = ["/usr/lib/petscdir", "/usr/lib/slepcdir"];

/// Where libraries are that no package tells of.
const SYSTEM: [&str; 4] = ["/usr/local/lib", "/usr/lib/x86_64-linux-gnu", "/usr/lib64", "/usr/lib"];

fn main() {
    for name in ["PETSC_DIR", "PETSC_ARCH", "SLEPC_DIR", "PKG_CONFIG_PATH", "MUMPS_LIBRARIES", "METIS_LIBRARY"] {
        println!("cargo:rerun-if-env-changed={name}");
    }
    let folders: Vec<String> = package_folders().iter().map(|folder| folder.display().to_string()).collect();
    // SAFETY: a build script is single-threaded here.
    unsafe { env::set_var("PKG_CONFIG_PATH", folders.join(":")) };
    let found = [
        probe(&["slepc", "SLEPc"], "libslepc-real-dev"),
        probe(&["petsc", "PETSc"], "libpetsc-real-dev"),
        probe(&["mpi-c", "ompi-c", "mpich"], "libopenmpi-dev"),
    ];
    let libraries: Vec<PathBuf> = found.iter().flat_map(|library| library.link_paths.clone()).collect();
    link(&libraries);
    let includes: Vec<PathBuf> = found.into_iter().flat_map(|library| library.include_paths).collect();
    shim(&includes);
    bindings(&includes);
    for file in ["wrapper.h", "shim.c", "shim.h", "functions.txt"] {
        println!("cargo:rerun-if-changed={file}");
    }
}

/// Folders of pkg-config's files, the first to be looked at first.
fn package_folders() -> Vec<PathBuf> {
    let variable = |name: &str| env::var_os(name).filter(|value| !value.is_empty());
    let arch = variable("PETSC_ARCH").unwrap_or_default();
    let roots = ["SLEPC_DIR", "PETSC_DIR"].into_iter().filter_map(variable).map(PathBuf::from);
    let own = roots.flat_map(|root| [root.join(&arch), root]).map(|prefix| prefix.join("lib/pkgconfig"));
    let given: Vec<PathBuf> =
        variable("PKG_CONFIG_PATH").map_or(Vec::new(), |paths| env::split_paths(&paths).collect());
    own.chain(given).chain(debian()).collect()
}

/// Debian's configurations with real scalars and 32-bit indices: the alternative that the administrator has chosen,
/// then all others, the newest first. Complex ones may be installed beside them.
fn debian() -> Vec<PathBuf> {
    let entries = |folder: &Path| -> Vec<PathBuf> {
        let mut all: Vec<PathBuf> = folder.read_dir().into_iter().flatten().flatten().map(|e| e.path()).collect();
        all.sort();
        all.reverse();
        all
    };
    let ends = |path: &Path, end: &str| path.to_string_lossy().ends_with(end);
    let mut prefixes = Vec::new();
    for versions in DEBIAN.map(|folder| entries(Path::new(folder))) {
        prefixes.extend(versions.iter().filter(|path| ends(path, "-real")).cloned());
        let is_64 = |path: &&PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().contains("64-"));
        let below = versions.iter().filter(|path| !is_64(path)).flat_map(|version| entries(version));
        prefixes.extend(below.filter(|path| ends(path, "-real")));
    }
    prefixes.into_iter().map(|prefix| prefix.join("lib/pkgconfig")).collect()
}

/// The first of some names of a library that pkg-config knows.
fn probe(names: &[&str], package: &str) -> pkg_config::Library {
    let found = names.iter().map(|name| pkg_config::Config::new().probe(name)).find_map(Result::ok);
    found.unwrap_or_else(|| {
        panic!(
            "pkg-config does not find {}. Set PETSC_DIR, PETSC_ARCH and SLEPC_DIR, or PKG_CONFIG_PATH; on Debian: \
             apt-get install {package} (or `make setup`)",
            names[0]
        )
    })
}

/// Links MUMPS, METIS, LAPACK and BLAS, and leaves for the package's own build script what executables need: MUMPS's
/// names, ahead of those that PETSc asks for, and the folders where libraries lie at run time.
fn link(folders: &[PathBuf]) {
    let is_there = |name: &str| {
        let system = SYSTEM.iter().map(Path::new);
        folders
            .iter()
            .map(PathBuf::as_path)
            .chain(system)
            .any(|folder| ["so", "a", "dylib"].iter().any(|end| folder.join(format!("lib{name}.{end}")).exists()))
    };
    let found = MUMPS.iter().find(|names| is_there(names[0])).unwrap_or(&MUMPS[1]);
    let mumps = env::var("MUMPS_LIBRARIES").unwrap_or_else(|_| found.join(" "));
    let metis = env::var("METIS_LIBRARY").unwrap_or_else(|_| "metis".into());
    for library in mumps.split_whitespace().chain([metis.as_str(), "lapack", "blas"]) {
        println!("cargo:rustc-link-lib={library}");
    }
    let folders: Vec<String> = folders.iter().map(|folder| folder.display().to_string()).collect();
    println!("cargo:mumps={mumps}");
    println!("cargo:folders={}", folders.join(":"));
}

fn shim(includes: &[PathBuf]) {
    cc::Build::new()
        .file("shim.c")
        .includes(includes)
        .flag("-Werror=implicit-function-declaration")
        .compile("squeal_shim");
}

fn bindings(includes: &[PathBuf]) {
    let mut builder = bindgen::Builder::default()
        .header("wrapper.h")
        .clang_args(includes.iter().map(|path| format!("-I{}", path.display())))
        .default_enum_style(bindgen::EnumVariation::NewType { is_bitfield: false, is_global: false })
        .prepend_enum_name(false)
        .layout_tests(false)
        .generate_comments(false)
        .derive_default(true);
    for function in FUNCTIONS.lines() {
        builder = builder.allowlist_function(function);
    }
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR")).join("bindings.rs");
    builder
        .generate()
        .expect("bindgen reads PETSc's headers (needs libclang-dev)")
        .write_to_file(out)
        .expect("OUT_DIR is writable");
}
