//! MPI: the session of a process and its communicator.
//!
//! [`Comm`] carries numbers of any type of [`Datum`], and through one byte format ([`Comm::broadcast_value`] and its
//! sisters) whatever serde can serialise. Every call's code is looked at, by [`Comm`] alone: an error ends all ranks,
//! see there.

mod comm;
mod datum;
mod session;
mod values;

pub use comm::{Comm, MaxLoc};
pub use datum::Datum;
pub use session::{Session, all_libraries, libraries, unused_options};
