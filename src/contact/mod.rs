//! Contact: where surfaces meet (search), how a body is seen there (trace), and what acts (laws).

mod facet;
pub mod law;
mod projection;
pub mod search;
#[cfg(test)]
mod testing;
pub mod trace;

pub use trace::Trace;
