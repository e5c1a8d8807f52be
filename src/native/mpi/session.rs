//! MPI, PETSc and SLEPc from start to end.

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::ptr;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};

use squeal_sys as sys;

use super::Comm;
use crate::native::blas;
use crate::native::petsc::error::{check, collect};
use crate::{Error, Result, hdf};

/// The one initialisation of MPI, PETSc and SLEPc that a process may have. Ends when the last handle is dropped.
pub struct Session {
    /// Copies of MPI's communicators of all ranks and of this rank alone, on which MPI returns its errors.
    pub(super) world: sys::MPI_Comm,
    pub(super) alone: sys::MPI_Comm,
    /// Those of groups of ranks, which end with the session.
    pub(super) groups: RefCell<Vec<sys::MPI_Comm>>,
}

/// Whether a session is alive.
static IS_ALIVE: AtomicBool = AtomicBool::new(false);

/// Options that hold for every run unless the user sets others: orderings by METIS, made on one rank.
const OPTIONS: &[(&str, &str)] =
    &[("-no_signal_handler", "1"), ("-skip_petscrc", "1"), ("-mat_mumps_icntl_7", "5"), ("-mat_mumps_icntl_28", "1")];

impl Session {
    /// Starts MPI, PETSc and SLEPc, after HDF5. `options` are `(name, value)` pairs for PETSc's option database, names
    /// with their dash.
    ///
    /// ```no_run
    /// let comm = squeal::Session::start(&[])?;
    /// println!("rank {} of {}", comm.rank(), comm.size());
    /// # Ok::<(), squeal::Error>(())
    /// ```
    ///
    /// # Errors
    /// Where a session is alive already, or MPI has ended in this process; PETSc's.
    pub fn start(options: &[(String, String)]) -> Result<Comm> {
        let mut has_ended = 0;
        // SAFETY: MPI_Finalized may be called at any time.
        unsafe { sys::MPI_Finalized(&mut has_ended) };
        if has_ended != 0 {
            return Err(Error::library("MPI")("it has ended, and cannot be started again in this process"));
        }
        if IS_ALIVE.swap(true, Ordering::AcqRel) {
            let reason = "a session is alive in this process; clone its communicator in place of a second session";
            return Err(Error::library("MPI")(reason));
        }
        Session::initialise(options).inspect_err(|_| IS_ALIVE.store(false, Ordering::Release)).map(Comm::world)
    }

    fn initialise(options: &[(String, String)]) -> Result<Rc<Session>> {
        // HDF5 that meets a running MPI ends itself within MPI_Finalize: see `hdf::start`.
        hdf::start();
        let own = OPTIONS.iter().map(|(name, value)| (name.to_string(), value.to_string()));
        for (name, value) in own.chain(options.iter().cloned()) {
            set_option(&name, &value)?;
        }
        // SAFETY: no arguments are passed, so PETSc reads neither the command line nor a file.
        check(unsafe { sys::SlepcInitialize(ptr::null_mut(), ptr::null_mut(), ptr::null(), ptr::null()) })?;
        blas::take_buffer()?;
        // SAFETY: `collect` has the signature of a handler and no context.
        check(unsafe { sys::PetscPushErrorHandler(Some(collect), ptr::null_mut()) })?;
        // SAFETY: MPI runs; both are constant handles.
        let [world, alone] = unsafe { [sys::squeal_comm_world(), sys::squeal_comm_self()] };
        let groups = RefCell::default();
        Ok(Rc::new(Session { world: with_codes(world)?, alone: with_codes(alone)?, groups }))
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: every handle holds this session, so none is alive any more; the copies are its own.
        unsafe {
            for group in self.groups.get_mut() {
                sys::MPI_Comm_free(group);
            }
            sys::MPI_Comm_free(&mut self.alone);
            sys::MPI_Comm_free(&mut self.world);
            sys::PetscPopErrorHandler();
            sys::SlepcFinalize();
        }
        IS_ALIVE.store(false, Ordering::Release);
    }
}

/// A copy of a communicator on which MPI returns errors as codes. The original keeps MPI's own way, which ends all
/// ranks: MUMPS looks at no code. Collective.
fn with_codes(original: sys::MPI_Comm) -> Result<sys::MPI_Comm> {
    let mut copy = original;
    // SAFETY: MPI runs. The original's handler ends the process where the copy cannot be made.
    let codes = unsafe {
        [sys::MPI_Comm_dup(original, &mut copy), sys::MPI_Comm_set_errhandler(copy, sys::squeal_errors_return())]
    };
    match codes {
        [0, 0] => Ok(copy),
        _ => Err(Error::library("MPI")(format!("its communicator cannot be copied: codes {codes:?}"))),
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

/// All libraries that compute, with their versions, a line each. Needs no session.
pub fn all_libraries() -> String {
    let mut text = [0 as c_char; 4096];
    // SAFETY: the shim writes at most so many bytes, with a zero at the end; MPI's version is known before it starts.
    let others = unsafe {
        sys::squeal_libraries(text.as_mut_ptr(), text.len());
        CStr::from_ptr(text.as_ptr()).to_string_lossy().into_owned()
    };
    format!("{}\n{others}", libraries().replace("; ", "\n"))
}

fn set_option(name: &str, value: &str) -> Result<()> {
    let text = |s: &str| CString::new(s).map_err(|_| Error::input(format!("option {s:?} holds a NUL byte")));
    let (name, value) = (text(name)?, text(value)?);
    // SAFETY: both strings are NUL-terminated and live for the call; PETSc copies them.
    check(unsafe { sys::PetscOptionsSetValue(ptr::null_mut(), name.as_ptr(), value.as_ptr()) })
}

/// Those of some options, names with their dash, that nothing has asked PETSc's database for. Needs a session.
///
/// # Errors
/// PETSc's.
pub fn unused_options(options: &[(String, String)]) -> Result<Vec<&str>> {
    let mut unused = Vec::new();
    for (name, _) in options {
        let bare =
            CString::new(name.trim_start_matches('-')).map_err(|_| Error::input("an option holds a NUL byte"))?;
        let mut used = sys::PetscBool::PETSC_FALSE;
        // SAFETY: the name is NUL-terminated and lives for the call; the database is the session's.
        check(unsafe { sys::PetscOptionsUsed(ptr::null_mut(), bare.as_ptr(), &mut used) })?;
        if used == sys::PetscBool::PETSC_FALSE {
            unused.push(name.as_str());
        }
    }
    Ok(unused)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_that_nothing_asks_for_are_unused() {
        let options = [("-fitting", "7"), ("-unknown", "")].map(|(name, value)| (name.to_owned(), value.to_owned()));
        let _session = Session::start(&options).unwrap();
        let (mut value, mut found) = (0, sys::PetscBool::PETSC_FALSE);
        // SAFETY: both names are NUL-terminated; the results are written before the call returns.
        check(unsafe {
            sys::PetscOptionsGetInt(ptr::null_mut(), ptr::null(), c"-fitting".as_ptr(), &mut value, &mut found)
        })
        .unwrap();
        assert_eq!((value, unused_options(&options).unwrap()), (7, vec!["-unknown"]));
    }

    /// A session has the process to itself; after its end MPI does not start again.
    #[test]
    fn a_process_has_one_session() {
        let comm = Session::start(&[]).unwrap();
        let second = Session::start(&[]).err().expect("the first is alive");
        assert!(second.to_string().contains("a session is alive"), "{second}");
        let copy = comm.clone();
        drop(comm);
        assert!(Session::start(&[]).is_err(), "a copy of the communicator keeps it alive");
        assert_eq!(copy.sum(1.0), 1.0);
        drop(copy);
        let third = Session::start(&[]).err().expect("MPI has ended");
        assert!(third.to_string().contains("has ended"), "{third}");
    }

    const FORMAT: hdf::Format = hdf::Format { name: "a test of squeal", version: 1, advice: "" };

    fn write(folder: &tempfile::TempDir, name: &str) {
        let path = folder.path().join(name);
        hdf::create(&path, &FORMAT, |file| hdf::list(file, "x", &[1.0])).unwrap();
        let x: Vec<f64> = hdf::values(&hdf::open(&path, &FORMAT).unwrap(), "x").unwrap();
        assert_eq!(x, [1.0]);
    }

    /// A write that fails leaves HDF5 in the state in which its end within MPI_Finalize crashes.
    fn fail(folder: &tempfile::TempDir) {
        let path = folder.path().join("fails.h5");
        let twice = |file: &hdf5::File| hdf::list(file, "x", &[1.0]).and_then(|()| hdf::list(file, "x", &[1.0]));
        let failed = hdf::create(&path, &FORMAT, twice);
        assert!(failed.is_err() && !path.exists());
    }

    #[test]
    fn files_are_written_before_within_and_after_a_session() {
        let folder = tempfile::tempdir().unwrap();
        write(&folder, "before.h5");
        let comm = Session::start(&[]).unwrap();
        write(&folder, "within.h5");
        fail(&folder);
        assert_eq!(comm.sum(1_u8), 1);
        drop(comm);
        write(&folder, "after.h5");
    }

    #[test]
    fn files_are_written_where_a_session_started_first() {
        let folder = tempfile::tempdir().unwrap();
        let comm = Session::start(&[]).unwrap();
        write(&folder, "within.h5");
        fail(&folder);
        drop(comm);
        write(&folder, "after.h5");
    }
}
