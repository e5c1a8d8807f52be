//! Raw bindings of PETSc, SLEPc, MUMPS, METIS, LAPACK and MPI: the functions that `squeal` calls (`functions.txt`).
//!
//! Generated from the installed headers at build time: nothing here is written by hand except a small C shim
//! (`shim.c`) for what the headers offer as macros. The safe face of all this is `squeal::native`.
#![allow(non_camel_case_types, non_snake_case, non_upper_case_globals, missing_docs, clippy::all)]
#![allow(unnecessary_transmutes, unsafe_op_in_unsafe_fn)]

include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
