//! Contact: where surfaces meet (search) and how a body is seen there (trace).

mod facet;
mod projection;
pub mod search;
#[cfg(test)]
mod testing;
pub mod trace;

pub use trace::Trace;
