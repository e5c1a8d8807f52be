//! The analyses: what the command line does, as one call each.
//!
//! | call | from | to |
//! |---|---|---|
//! | [`propose_model`] | a mesh | the text of a model file, to be completed |
//! | [`model_summary`] | a full model | masses, contact pairs, mesh quality, loads, warnings |
//! | [`statics`] | a structure | equilibria over the friction coefficient |
//! | [`stability`] | a structure | complex modes of a band over the friction coefficient, branches and Hopf points |
//! | [`wear`] | a structure | worn gaps of its sliding pairs |
//! | [`reduce`] | a full model | a super-element and its file |
//! | [`study`] | a model file | contact layouts and super-elements compared with full contact |
//! | [`explore`] | the file of a study | modes at points of many parameters, and the probability of squeal |
//! | [`states`] | a file of states | modes of a model in each of them |
//! | [`export`] | a structure | M, C, K about an equilibrium as files |
//! | [`external_modes`] | matrices M, C, K of any program | modes of a band, along a parameter of them |
//! | [`free_modes`] | one part of a model | free modes, compared with measured ones |
//!
//! Each takes the communicator, what is analysed, options whose defaults are the files', and an [`Observer`], and gives
//! plain [`crate::results::Results`]. With [`Output`] the same call writes a results folder and can go on where an
//! earlier run has ended.

mod certificate;
mod check;
mod checkpoint;
mod explain;
mod explore;
mod export;
mod external;
mod external_sweep;
mod family;
mod free_modes;
mod galerkin;
mod measured;
mod mode_data;
mod observer;
mod other_parts;
mod part_keys;
mod proposal;
mod record;
mod reduce;
mod run;
mod snapshots;
mod stability;
mod start;
mod states;
mod statics;
mod study;
mod sweep;
#[cfg(test)]
mod tests;
mod unfinished;
mod wear;

pub use check::{matrix_summary, model_summary};
pub use explain::{explain, explain_full};
pub use explore::{ExploreOutput, explore};
pub use export::{ExportOptions, Exported, MatrixFormat, export};
pub use external::{ExternalOptions, external_modes};
pub use external_sweep::{ExternalModes, ExternalSweep};
pub use family::{FrictionFamily, Snapshot, Solutions, Spectrum, Vectors, tracking_options, widened};
pub use free_modes::{FreeModesOptions, free_modes};
pub use galerkin::{GalerkinOptions, GalerkinReduction, friction_samples, reduce_galerkin};
pub use measured::{Measured, read as read_measured};
pub use observer::{Event, Observer};
pub use proposal::propose_model;
pub use reduce::{ReduceOptions, Reduction, reduce, with_reference_contacts};
pub use stability::{StabilityOptions, stability};
pub use start::Output;
pub use states::{StateResults, StatesOptions, states};
pub use statics::{StaticOptions, statics};
pub use study::{StudyOptions, study};
pub use sweep::{Costs, Sweep};
pub use wear::{WearGoal, WearOptions, wear};
