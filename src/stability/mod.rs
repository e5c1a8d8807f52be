//! Complex modes about an equilibrium: `(lambda^2 M + lambda C + K + i G) x = 0`, all of a frequency band.
//!
//! [`QuadraticProblem`] is the linearised problem, with friction's unsymmetric part in K, with structural damping G
//! where a stiffness has a loss factor, and with stiffnesses that depend on lambda where a material is viscoelastic
//! ([`Viscoelastic`]). [`BandSolver::solve_band`] chooses an eigensolver, searches, counts, and widens the search until
//! no mode is missing:
//!
//! | eigensolver | method | used for |
//! |---|---|---|
//! | `blocked` | a growing subspace, many right-hand sides at a time | large problems; complex stiffnesses |
//! | `modal` | TOAR in the modal coordinates of a reference | super-elements |
//! | `toar` | SLEPc's TOAR about a real shift: one real factor serves the band | all others, the last resort |
//!
//! Each mode has its backward error; their number is compared with the Sturm count of the symmetric problem
//! (`count`). [`BandSolver::left_vectors`] finds their left vectors. Tolerances and thresholds are in
//! [`EigenOptions`].

mod band;
mod blocked;
mod condition;
mod correction;
mod count;
mod eigensolver;
mod forms;
mod left;
mod linearise;
mod memory;
mod modal;
mod mode;
mod nonlinear;
mod options;
mod problem;
mod projected;
mod shares;
mod space;
mod sturm;
#[cfg(test)]
mod testing;
mod toar;
mod viscoelastic;

pub use band::{Band, BandReport, BandRequest, BandSolver};
pub use condition::{condition, condition_at};
pub use correction::{Approximation, Correction, corrections};
pub use count::{Count, CountedBy};
pub use eigensolver::{EigenProgress, Eigensolver, OnProgress, Search, SearchRequest, SearchResult, SolverKind};
pub use forms::{Complex, Forms, Sources, complex_product, of_contacts, of_elements};
pub use left::right_vectors;
pub use linearise::{LinearTerms, Linearised, with_friction_damping};
pub use mode::{Mode, RIGID_RATE};
pub use options::{BlockedOptions, EigenOptions, Evidence};
pub use problem::{FrozenPoints, QuadraticProblem};
pub use shares::{Sensitivity, Share, self_product, sensitivity, shares};
pub use viscoelastic::Viscoelastic;
