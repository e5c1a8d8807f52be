//! Finds Debian's real PETSc and SLEPc, MUMPS, METIS and MPI, and generates the bindings that `squeal` uses.

use std::env;
use std::path::PathBuf;

/// The real-scalar flavour is pinned even where the complex packages are installed side by side.
const REAL: &str = "/usr/lib/slepcdir/slepc-real/lib/pkgconfig:/usr/lib/petscdir/petsc-real/lib/pkgconfig:\
    /usr/lib/slepcdir/slepc3.18/x86_64-linux-gnu-real/lib/pkgconfig:\
    /usr/lib/petscdir/petsc3.18/x86_64-linux-gnu-real/lib/pkgconfig";

/// Everything `squeal` calls; whatever these need comes along.
const FUNCTIONS: &[&str] = &[
    "MPI_(Initialized|Finalized|Comm_rank|Comm_size|Allreduce|Allgather|Allgatherv|Alltoall|Alltoallv|Bcast|Send|Recv|Barrier|Abort)",
    "Petsc(InitializeNoArguments|OptionsSetValue|OptionsClearValue|OptionsGetInt|OptionsGetReal|PushErrorHandler|PopErrorHandler|Error|GetVersion)",
    "PetscObject(TypeCompare|GetId|StateGet|SetName|SetOptionsPrefix|GetOptionsPrefix|Reference)",
    "Slepc(Initialize|InitializeNoArguments|Finalize|GetVersion)",
    "Vec(Create|CreateMPI|CreateSeq|CreateMPIWithArray|CreateSeqWithArray|Destroy|Duplicate|Copy|Set|Scale|AXPY|AYPX|WAXPY|Dot|Norm|MDot|PointwiseMult)",
    "Vec(GetArray|RestoreArray|GetArrayRead|RestoreArrayRead|GetLocalSize|GetSize|GetOwnershipRange|SetValues|AssemblyBegin|AssemblyEnd)",
    "VecScatter(Create|CreateToAll|CreateToZero|Begin|End|Destroy)",
    "IS(CreateGeneral|CreateStride|Destroy)",
    "Mat(Create|SetSizes|SetType|SetOption|SetUp|Destroy|Duplicate|Copy|Scale|AXPY|AYPX|Mult|MultTranspose|MultAdd|Norm|Zero.*|GetInfo|GetSize|GetLocalSize)",
    "Mat(CreateSeqAIJWithArrays|CreateMPIAIJWithSplitArrays|MPIAIJGetSeqAIJ|SeqAIJGetArray|SeqAIJRestoreArray|SeqAIJGetArrayRead|SeqAIJRestoreArrayRead|SetValues|AssemblyBegin|AssemblyEnd|GetOwnershipRange|GetRow|RestoreRow|GetRowIJ|RestoreRowIJ|ConvertIfNeeded)",
    "Mat(MatMult|TransposeMatMult|CreateShell|ShellSetOperation|ShellSetContext|ShellGetContext|CreateDense|DenseGetArray|DenseGetArrayRead|DenseRestoreArrayRead|Convert|DenseRestoreArray|DenseGetLDA|GetRowMaxAbs|GetRowSumAbs)",
    "[ds]mumps_c",
    "KSP(Create|Destroy|Solve|GMRESSetRestart|SetPCSide|SetType|SetPC|GetPC|SetTolerances|SetFromOptions|GetConvergedReason|GetIterationNumber|SetOperators|SetNormType)",
    "PC(SetType|ShellSetApply|ShellSetApplyTranspose|ShellSetContext|ShellGetContext|ShellSetName)",
    "SNES(Create|Destroy|SetType|SetFunction|SetJacobian|SetConvergenceTest|SetTolerances|SetFromOptions|SetOptionsPrefix|Solve|GetKSP|GetLineSearch)",
    "SNES(GetConvergedReason|GetIterationNumber|GetFunctionNorm|MonitorSet|SetFunctionDomainError|SetMaxLinearSolveFailures|GetSolution|LineSearchSetType|LineSearchSetTolerances|LineSearchGetLambda|GetNumberFunctionEvals)",
    "PEP(Create|Destroy|SetOperators|SetProblemType|SetType|SetDimensions|SetTarget|SetWhichEigenpairs|SetTolerances|SetScale|SetRefine|SetExtract|SetFromOptions|SetOptionsPrefix)",
    "PEP(Solve|GetST|GetConverged|GetEigenpair|GetIterationNumber|GetConvergedReason|MonitorSet|SetStoppingTestFunction|StoppingBasic|SetInitialSpace|SetConvergenceTest|TOARSetRestart|TOARSetLocking|GetDimensions)",
    "ST(SetType|SetShift|GetKSP|SetMatMode|SetMatStructure|SetTransform|SetFromOptions)",
    "d(gemm|gemv|syev|sygvd|getrf|getrs|sytrf|sytrs|trsv)_",
    "zgesv_",
    "METIS_(PartMeshDual|NodeND)",
    "squeal_.*",
];

fn main() {
    let path = env::var("PKG_CONFIG_PATH").unwrap_or_default();
    // SAFETY: a build script is single-threaded here.
    unsafe { env::set_var("PKG_CONFIG_PATH", format!("{REAL}:{path}")) };
    for library in ["dmumps_ptscotch", "smumps_ptscotch", "metis", "lapack", "blas"] {
        println!("cargo:rustc-link-lib={library}");
    }
    let slepc = probe("slepc", "libslepc-real-dev");
    let petsc = probe("petsc", "libpetsc-real-dev");
    let mpi = probe("mpi-c", "libopenmpi-dev");
    let includes: Vec<PathBuf> = [slepc, petsc, mpi].into_iter().flat_map(|library| library.include_paths).collect();
    shim(&includes);
    bindings(&includes);
    println!("cargo:rerun-if-changed=wrapper.h");
    println!("cargo:rerun-if-changed=shim.c");
    println!("cargo:rerun-if-changed=shim.h");
}

fn probe(name: &str, package: &str) -> pkg_config::Library {
    pkg_config::Config::new()
        .probe(name)
        .unwrap_or_else(|error| panic!("{name} is missing: apt-get install {package} (or run `make setup`)\n{error}"))
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
    for function in FUNCTIONS {
        builder = builder.allowlist_function(function);
    }
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR")).join("bindings.rs");
    builder
        .generate()
        .expect("bindgen reads PETSc's headers (needs libclang-dev)")
        .write_to_file(out)
        .expect("OUT_DIR is writable");
}
