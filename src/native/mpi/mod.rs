//! MPI: the session of a process and its communicator.

mod session;

pub use session::{Comm, Session, libraries};
