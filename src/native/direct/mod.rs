//! Direct factors of sparse matrices by MUMPS, with orderings by METIS, and of densely stored ones by LAPACK.

mod factor;
mod metis;
mod mumps;
mod mumps_data;
mod ordering;
mod route;

pub use factor::{Factor, FactorKind, FactorStats};
pub use metis::{Lists, partition};
pub use mumps::Precision;
