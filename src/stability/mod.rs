//! Complex modes about an equilibrium: `(lambda^2 M + lambda C + K) x = 0`, all of a frequency band.
//!
//! [`Pencil`] is the linearised problem, with friction's unsymmetric part in K. [`solve`] finds the band's modes by SLEPc's PEP
//! (TOAR, inverted about a real shift, so that one real factor serves the whole band; for super-elements in modal coordinates), by blocks of
//! right-hand sides where a model is large, gives each its backward error, and
//! checks their number against the inertia of the symmetric problem, so that none is missed. [`Solver::left_vectors`] finds their left vectors.

mod band;
mod condition;
mod explain;
mod forms;
mod inertia;
mod left;
mod linearise;
mod modal;
mod mode;
mod search;
mod solver;
mod space;

pub use band::{Band, Count, solve};
pub use condition::condition;
pub use explain::{Sensitivity, Share, self_product, sensitivity, shares};
pub use forms::{Complex, Forms, Sources, of_contacts, of_elements};
pub use left::right_vectors;
pub use linearise::{Linearised, with_friction_damping};
pub use mode::{Mode, Pencil, Points, UNSTABLE_RATIO, growth_threshold};
pub use solver::{Evidence, Solver};
pub use space::{Basis, Problem};
