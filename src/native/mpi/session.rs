//! MPI, PETSc and SLEPc from start to end, and the communicator.

use std::env;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr;
use std::rc::Rc;

use squeal_sys as sys;

use crate::native::petsc::error::{check, collect};
use crate::{Error, Result};

/// The one initialisation of MPI, PETSc and SLEPc that a process may have. Ends when the last handle is dropped.
pub struct Session {
    _private: (),
}

/// Options that hold for every run unless the user sets others: orderings by METIS, made on one rank.
const OPTIONS: &[(&str, &str)] =
    &[("-no_signal_handler", "1"), ("-skip_petscrc", "1"), ("-mat_mumps_icntl_7", "5"), ("-mat_mumps_icntl_28", "1")];

/// Where MUMPS puts factors that do not fit into memory: the user's choice, else the system's temporary folder.
const OUT_OF_CORE: &str = "MUMPS_OOC_TMPDIR";

impl Session {
    /// Starts MPI, PETSc and SLEPc. `options` are `(name, value)` pairs for PETSc's option database, names with their dash.
    ///
    /// # Errors
    /// Where PETSc refuses, or where the process has had a session before.
    pub fn start(options: &[(String, String)]) -> Result<Comm> {
        let mut finalized = 0;
        // SAFETY: MPI_Finalized may be called at any time.
        unsafe { sys::MPI_Finalized(&mut finalized) };
        if finalized != 0 {
            return Err(Error::library("MPI")("it has ended, and cannot be started again in this process"));
        }
        if env::var_os(OUT_OF_CORE).is_none() {
            // SAFETY: MPI has not started yet, and with it no thread that reads the environment.
            unsafe { env::set_var(OUT_OF_CORE, env::temp_dir()) };
        }
        let own = OPTIONS.iter().map(|(name, value)| (name.to_string(), value.to_string()));
        for (name, value) in own.chain(options.iter().cloned()) {
            set_option(&name, &value)?;
        }
        // SAFETY: no arguments are passed, so PETSc reads neither the command line nor a file.
        check(unsafe { sys::SlepcInitialize(ptr::null_mut(), ptr::null_mut(), ptr::null(), ptr::null()) })?;
        // SAFETY: `collect` has the signature of a handler and no context.
        check(unsafe { sys::PetscPushErrorHandler(Some(collect), ptr::null_mut()) })?;
        Ok(Comm::world(Rc::new(Session { _private: () })))
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: every handle holds this session, so none is alive any more.
        unsafe {
            sys::PetscPopErrorHandler();
            sys::SlepcFinalize();
        }
    }
}

/// PETSc and SLEPc with their versions and dates.
pub fn libraries() -> String {
    let version = |get: unsafe extern "C" fn(*mut c_char, usize) -> sys::PetscErrorCode| {
        let mut text = [0 as c_char; 256];
        // SAFETY: the library writes at most so many bytes, with a zero at the end; it needs no session.
        unsafe {
            get(text.as_mut_ptr(), text.len());
            CStr::from_ptr(text.as_ptr()).to_string_lossy().trim().to_owned()
        }
    };
    [version(sys::PetscGetVersion), version(sys::SlepcGetVersion)].join("; ")
}

fn set_option(name: &str, value: &str) -> Result<()> {
    let text = |s: &str| CString::new(s).map_err(|_| Error::input(format!("option {s:?} holds a NUL byte")));
    let (name, value) = (text(name)?, text(value)?);
    // SAFETY: both strings are NUL-terminated and live for the call; PETSc copies them.
    check(unsafe { sys::PetscOptionsSetValue(ptr::null_mut(), name.as_ptr(), value.as_ptr()) })
}

/// Bytes of a message at most: MPI counts with 32 bits.
const MESSAGE: usize = 1 << 30;

/// A communicator that keeps the session alive.
#[derive(Clone)]
pub struct Comm {
    raw: sys::MPI_Comm,
    rank: usize,
    size: usize,
    _session: Rc<Session>,
}

impl Comm {
    fn world(session: Rc<Session>) -> Comm {
        let (mut rank, mut size) = (0, 0);
        // SAFETY: MPI is initialised as long as the session lives.
        let raw = unsafe { sys::squeal_comm_world() };
        unsafe {
            sys::MPI_Comm_rank(raw, &mut rank);
            sys::MPI_Comm_size(raw, &mut size);
        }
        Comm { raw, rank: rank as usize, size: size as usize, _session: session }
    }

    /// This process's number, from 0.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Number of processes.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Whether this process prints and writes.
    pub fn is_root(&self) -> bool {
        self.rank == 0
    }

    pub(in crate::native) fn raw(&self) -> sys::MPI_Comm {
        self.raw
    }

    /// Sum over the ranks.
    pub fn sum(&self, value: f64) -> f64 {
        // SAFETY: MPI_SUM is a constant handle.
        self.reduce(value, unsafe { sys::squeal_op_sum() })
    }

    /// Largest value of any rank.
    pub fn max(&self, value: f64) -> f64 {
        // SAFETY: MPI_MAX is a constant handle.
        self.reduce(value, unsafe { sys::squeal_op_max() })
    }

    fn reduce(&self, value: f64, op: sys::MPI_Op) -> f64 {
        let mut result = 0.0_f64;
        // SAFETY: one double in, one out, on every rank.
        unsafe {
            sys::MPI_Allreduce(
                ptr::from_ref(&value).cast::<c_void>(),
                ptr::from_mut(&mut result).cast::<c_void>(),
                1,
                sys::squeal_type_double(),
                op,
                self.raw,
            );
        }
        result
    }

    /// Elementwise largest value of any rank, in place.
    pub fn max_all(&self, values: &mut [f64]) {
        // SAFETY: MPI_MAX is a constant handle.
        self.reduce_all(values, unsafe { sys::squeal_op_max() });
    }

    /// Elementwise sum of an array over the ranks, in place.
    pub fn sum_all(&self, values: &mut [f64]) {
        // SAFETY: MPI_SUM is a constant handle.
        self.reduce_all(values, unsafe { sys::squeal_op_sum() });
    }

    fn reduce_all(&self, values: &mut [f64], op: sys::MPI_Op) {
        let input = values.to_vec();
        // SAFETY: both arrays have the same length, which all ranks share by contract.
        unsafe {
            sys::MPI_Allreduce(
                input.as_ptr().cast(),
                values.as_mut_ptr().cast(),
                values.len() as i32,
                sys::squeal_type_double(),
                op,
                self.raw,
            );
        }
    }

    /// This rank's own communicator.
    pub fn alone(&self) -> Comm {
        // SAFETY: a constant handle.
        Comm { raw: unsafe { sys::squeal_comm_self() }, rank: 0, size: 1, _session: self._session.clone() }
    }

    /// The first rank's values, on every rank. Collective.
    pub fn from_root(&self, values: &[f64]) -> Vec<f64> {
        let mut values = values.to_vec();
        // SAFETY: the array has the same length on all ranks by contract.
        unsafe {
            sys::MPI_Bcast(values.as_mut_ptr().cast(), values.len() as i32, sys::squeal_type_double(), 0, self.raw);
        }
        values
    }

    /// The values of all ranks, one rank's after the other's.
    pub fn join(&self, own: &[f64]) -> Vec<f64> {
        let mut counts = vec![0.0; self.size];
        counts[self.rank] = own.len() as f64;
        self.sum_all(&mut counts);
        let counts: Vec<i32> = counts.iter().map(|&n| n as i32).collect();
        let starts: Vec<i32> = (0..self.size).map(|rank| counts[..rank].iter().sum()).collect();
        let mut all = vec![0.0; counts.iter().sum::<i32>() as usize];
        // SAFETY: every rank sends as many values as all know of.
        unsafe {
            let double = sys::squeal_type_double();
            sys::MPI_Allgatherv(
                own.as_ptr().cast(),
                own.len() as i32,
                double,
                all.as_mut_ptr().cast(),
                counts.as_ptr(),
                starts.as_ptr(),
                double,
                self.raw,
            );
        }
        all
    }

    /// What each rank has for this one, from what this one has for each. Collective.
    ///
    /// # Panics
    /// Where there is not one part for each rank.
    pub fn exchange(&self, parts: &[Vec<f64>]) -> Vec<Vec<f64>> {
        assert_eq!(parts.len(), self.size);
        let sizes: Vec<i32> = parts.iter().map(|part| part.len() as i32).collect();
        let mut their_sizes = vec![0; self.size];
        // SAFETY: one number for and from each rank.
        unsafe {
            let int = sys::squeal_type_int();
            sys::MPI_Alltoall(sizes.as_ptr().cast(), 1, int, their_sizes.as_mut_ptr().cast(), 1, int, self.raw);
        }
        let starts = |sizes: &[i32]| -> Vec<i32> { (0..self.size).map(|rank| sizes[..rank].iter().sum()).collect() };
        let (own, own_starts, their_starts) = (parts.concat(), starts(&sizes), starts(&their_sizes));
        let mut theirs = vec![0.0; their_sizes.iter().sum::<i32>() as usize];
        // SAFETY: sizes and starts were exchanged above.
        unsafe {
            let double = sys::squeal_type_double();
            sys::MPI_Alltoallv(
                own.as_ptr().cast(),
                sizes.as_ptr(),
                own_starts.as_ptr(),
                double,
                theirs.as_mut_ptr().cast(),
                their_sizes.as_ptr(),
                their_starts.as_ptr(),
                double,
                self.raw,
            );
        }
        let part = |(&start, &size): (&i32, &i32)| theirs[start as usize..][..size as usize].to_vec();
        their_starts.iter().zip(&their_sizes).map(part).collect()
    }

    /// Sends bytes to a rank, which must be receiving them. Not collective.
    pub fn send(&self, bytes: &[u8], to: usize) {
        let length = (bytes.len() as u64).to_le_bytes();
        for part in std::iter::once(&length[..]).chain(bytes.chunks(MESSAGE)) {
            // SAFETY: the bytes stay where they are until they are sent.
            unsafe {
                let byte = sys::squeal_type_byte();
                sys::MPI_Send(part.as_ptr().cast(), part.len() as i32, byte, to as i32, 0, self.raw);
            }
        }
    }

    /// The bytes that a rank sends. Not collective.
    pub fn receive(&self, from: usize) -> Vec<u8> {
        let mut length = [0; 8];
        self.receive_into(&mut length, from);
        let mut bytes = vec![0; u64::from_le_bytes(length) as usize];
        bytes.chunks_mut(MESSAGE).for_each(|part| self.receive_into(part, from));
        bytes
    }

    fn receive_into(&self, part: &mut [u8], from: usize) {
        let mut status = sys::MPI_Status::default();
        // SAFETY: the sender sends as many bytes as there is room for.
        unsafe {
            let byte = sys::squeal_type_byte();
            sys::MPI_Recv(part.as_mut_ptr().cast(), part.len() as i32, byte, from as i32, 0, self.raw, &mut status);
        }
    }

    /// Waits for all ranks.
    pub fn barrier(&self) {
        // SAFETY: a valid communicator.
        unsafe { sys::MPI_Barrier(self.raw) };
    }

    /// All ranks go on only if each of them may: the error of the first rank that has one becomes everyone's, so that none is left
    /// waiting and any of them can tell it.
    ///
    /// # Errors
    /// [`Error::Agreed`]; on one rank its own error.
    pub fn agree<T>(&self, result: Result<T>) -> Result<T> {
        let own = result.as_ref().err();
        let speaker = -self.max(own.map_or(f64::NEG_INFINITY, |_| -(self.rank as f64)));
        if self.size == 1 || speaker.is_infinite() {
            return result;
        }
        let error = own.map(|error| (error.kind(), error.to_string()));
        let bytes = error.and_then(|error| postcard::to_stdvec(&error).ok()).unwrap_or_default();
        let bytes = self.broadcast(speaker as usize, bytes);
        let (kind, text) = postcard::from_bytes(&bytes).map_err(Error::library("postcard"))?;
        Err(Error::Agreed { kind, text })
    }

    /// The bytes of one rank, on every rank.
    pub fn broadcast(&self, from: usize, mut bytes: Vec<u8>) -> Vec<u8> {
        let length = if self.rank == from { bytes.len() as f64 } else { 0.0 };
        bytes.resize(self.max(length) as usize, 0);
        // SAFETY: the array has the same length on all ranks.
        unsafe {
            sys::MPI_Bcast(
                bytes.as_mut_ptr().cast(),
                bytes.len() as i32,
                sys::squeal_type_byte(),
                from as i32,
                self.raw,
            );
        }
        bytes
    }

    /// Ends all ranks at once with this exit code.
    pub fn abort(&self, code: i32) -> ! {
        // SAFETY: a valid communicator; the call does not return.
        unsafe { sys::MPI_Abort(self.raw, code) };
        std::process::exit(code)
    }
}
