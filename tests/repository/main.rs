//! What holds for the repository as a whole: the order of the modules, sizes, documents.

mod architecture;
mod documentation;
mod examples;
mod sizes;
mod source;
#[path = "../support/mod.rs"]
mod support;
