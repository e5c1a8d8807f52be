//! MUMPS's data structures of either precision, and their one call.

use squeal_sys as sys;

use crate::native::mpi::Datum;

/// MUMPS's data, which it finds where they were: they stay in their box.
pub(super) enum Data {
    Double(Box<sys::DMUMPS_STRUC_C>),
    Single(Box<sys::SMUMPS_STRUC_C>),
}

/// The same for both precisions.
macro_rules! both {
    ($data:expr, $id:ident => $body:expr) => {
        match $data {
            Data::Double($id) => $body,
            Data::Single($id) => $body,
        }
    };
}

/// A number of either precision.
pub(super) trait Real: Datum + Into<f64> {
    fn of(x: f64) -> Self;
}

impl Real for f64 {
    fn of(x: f64) -> f64 {
        x
    }
}

impl Real for f32 {
    fn of(x: f64) -> f32 {
        x as f32
    }
}

/// MUMPS's data of either precision.
pub(super) trait Run {
    /// Runs a job whose arrays are in place.
    fn run(&mut self, job: i32);
}

impl Run for sys::DMUMPS_STRUC_C {
    fn run(&mut self, job: i32) {
        self.job = job;
        // SAFETY: what the job reads and writes is in place.
        unsafe { sys::dmumps_c(self) };
    }
}

impl Run for sys::SMUMPS_STRUC_C {
    fn run(&mut self, job: i32) {
        self.job = job;
        // SAFETY: what the job reads and writes is in place.
        unsafe { sys::smumps_c(self) };
    }
}

pub(super) use both;
