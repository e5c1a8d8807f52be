//! Cases that somebody else has solved: exactly, in print, or with another program. A file each, with its source,
//! sketch and goal.
//!
//! Every case is computed by one function, whose numbers a test holds against theirs and against `docs/validation.md`;
//! so the document cannot drift. `make validation` writes it ([`document`]).

mod annulus;
mod cattaneo_mindlin;
mod contact_patch;
mod deck;
mod document;
mod hertz;
mod konter;
mod minimal_models;
mod nafems_fv52;
mod oberst_beam;
mod pads_on_disc;
mod sandwich_beam;
mod sensitivity;
#[path = "../support/mod.rs"]
mod support;
mod table;
mod td1;
mod wear;
